//! Furniture of the seminar room; each piece stands on the floor around the origin, people sit at
//! +z and look towards -z.

use glam::{Vec3, vec3};

use super::super::shapes::{Draft, Faces};
use super::{Paints, TABLE_HEIGHT};
use crate::scene::MaterialId;

/// A table on four legs with a board before the knees: 27 polygons.
pub(super) fn table(d: &mut Draft, width: f32, wood: MaterialId, steel: MaterialId) {
    const TOP: f32 = 0.03;
    const DEPTH: f32 = 0.62;
    let under = TABLE_HEIGHT - TOP;
    d.block(vec3(0.0, under, 0.0), vec3(width, TOP, DEPTH), Faces::NONE, wood);
    let (x, z) = (0.5 * width - 0.05, 0.5 * DEPTH - 0.05);
    for [x, z] in [[-x, -z], [x, -z], [-x, z], [x, z]] {
        d.block(vec3(x, 0.0, z), vec3(0.04, under, 0.04), Faces::ENDS, steel);
    }
    d.cuboid(vec3(0.03 - x, 0.36, -z - 0.01), vec3(x - 0.03, under, 0.01 - z), Faces::TOP, wood);
}

/// A chair with a bent seat and back: 36 polygons.
pub(super) fn chair(d: &mut Draft, p: &Paints) {
    const SEAT: f32 = 0.44;
    d.block(vec3(0.0, SEAT - 0.025, 0.0), vec3(0.42, 0.025, 0.42), Faces::NONE, p.seat);
    for [x, z] in [[-0.18, -0.18], [0.18, -0.18], [-0.18, 0.18], [0.18, 0.18]] {
        d.block(vec3(x, 0.0, z), vec3(0.028, SEAT - 0.025, 0.028), Faces::ENDS, p.steel);
    }
    for x in [-0.15, 0.15] {
        d.block(vec3(x, SEAT, 0.19), vec3(0.03, 0.16, 0.02), Faces::ENDS, p.steel);
    }
    d.block(vec3(0.0, SEAT + 0.16, 0.19), vec3(0.42, 0.24, 0.025), Faces::NONE, p.seat);
}

/// A lectern with a slanted top and a manuscript on it.
pub(super) fn lectern(d: &mut Draft, p: &Paints) {
    let (low, high, x, z) = (1.02, 1.14, 0.26, 0.2);
    d.cuboid(vec3(-x, 0.0, -z), vec3(x, 0.06, z), Faces::BOTTOM, p.wood);
    d.block(vec3(0.0, 0.06, 0.0), vec3(0.4, 0.9, 0.28), Faces::ENDS, p.wood);
    // The desk rises towards the audience, at -z.
    let [a, b, c, e] = [vec3(-x, low, z), vec3(x, low, z), vec3(x, high, -z), vec3(-x, high, -z)];
    let [fa, fb, fc, fe] = [a, b, c, e].map(|corner| corner.with_y(0.96));
    d.quad([a, b, c, e], p.wood);
    d.quad([fe, fc, fb, fa], p.wood);
    d.quad([fa, fb, b, a], p.wood);
    d.quad([fc, fe, e, c], p.wood);
    d.quad([fb, fc, c, b], p.wood);
    d.quad([fe, fa, a, e], p.wood);
    let slant = (c - b).normalize();
    let lift = Vec3::X.cross(slant) * -0.003;
    let sheet = [vec3(-0.105, 0.0, 0.0), vec3(0.105, 0.0, 0.0)].map(|across| {
        let near = vec3(0.0, low, z) + across + slant * 0.05;
        [near, near + slant * 0.297]
    });
    let [[a, e], [b, c]] = sheet;
    let [la, lb, lc, le] = [a, b, c, e].map(|corner| corner - lift);
    d.quad([la, lb, lc, le], p.paper);
    for [from, to, top_to, top_from] in [[a, b, lb, la], [b, c, lc, lb], [c, e, le, lc], [e, a, la, le]] {
        d.quad([from, to, top_to, top_from], p.paper);
    }
}

/// A projector below the ceiling (y = 0), which looks towards -z.
pub(super) fn projector(d: &mut Draft, p: &Paints) {
    d.cuboid(vec3(-0.02, -0.5, -0.02), vec3(0.02, 0.0, 0.02), Faces::ENDS, p.steel);
    d.cuboid(vec3(-0.19, -0.62, -0.16), vec3(0.19, -0.5, 0.16), Faces::NONE, p.white);
    d.cuboid(vec3(0.05, -0.59, -0.2), vec3(0.12, -0.53, -0.16), Faces::FRONT, p.dark);
}
