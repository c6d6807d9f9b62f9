//! Furniture of both rooms: windows, doors, radiators, ceiling lamps, clocks, books, paper,
//! bottles.
//!
//! Things at a wall are drawn with x along the wall, y up and z into the room, the wall being z =
//! 0; things on a table stand on y = 0; lamps hang from y = 0.

use glam::{Affine3, Quat, Vec3, vec3};

use super::shapes::{Draft, Faces};
use crate::scene::MaterialId;

/// Materials of a window.
#[derive(Clone, Copy)]
pub(super) struct WindowPaint {
    pub(super) reveal: MaterialId,
    pub(super) frame: MaterialId,
    /// Sends daylight into the room.
    pub(super) pane: MaterialId,
    pub(super) sill: MaterialId,
}

/// A window in an opening of `width` × `height` whose left lower corner is the origin: reveal,
/// frame with `columns` × `rows` panes, and a sill that sticks out.
pub(super) fn window(d: &mut Draft, [width, height]: [f32; 2], [columns, rows]: [usize; 2], paint: WindowPaint) {
    const DEPTH: f32 = 0.18;
    const FRAME: f32 = 0.06;
    const BAR: f32 = 0.05;
    let (w, h, back, front) = (width, height, -DEPTH, FRAME - DEPTH);
    d.group("reveal", |d| {
        d.quad([vec3(0., 0., 0.), vec3(w, 0., 0.), vec3(w, 0., front), vec3(0., 0., front)], paint.reveal);
        d.quad([vec3(0., h, front), vec3(w, h, front), vec3(w, h, 0.), vec3(0., h, 0.)], paint.reveal);
        d.quad([vec3(0., 0., 0.), vec3(0., 0., front), vec3(0., h, front), vec3(0., h, 0.)], paint.reveal);
        d.quad([vec3(w, 0., front), vec3(w, 0., 0.), vec3(w, h, 0.), vec3(w, h, front)], paint.reveal);
        d.cuboid(vec3(-0.04, -0.03, 0.0), vec3(w + 0.04, 0.0, 0.16), Faces::BACK, paint.sill);
    });
    // Panes close the bars at the back: nothing is drawn beyond them, where it is dark.
    let pane_depth = back;
    let lights = |count: usize, length: f32| -> Vec<[f32; 2]> {
        let light = (length - 2.0 * FRAME - BAR * (count - 1) as f32) / count as f32;
        let start = |index: usize| FRAME + (light + BAR) * index as f32;
        (0..count).map(|index| [start(index), start(index) + light]).collect()
    };
    let (columns, rows) = (lights(columns, w), lights(rows, h));
    d.group("frame", |d| {
        // What bars meet at is not drawn below them.
        d.cuboid(vec3(0., 0., back), vec3(FRAME, h, front), !Faces::FRONT, paint.frame);
        d.cuboid(vec3(0., FRAME, back), vec3(FRAME, h - FRAME, front), !Faces::RIGHT, paint.frame);
        d.cuboid(vec3(w - FRAME, 0., back), vec3(w, h, front), !Faces::FRONT, paint.frame);
        d.cuboid(vec3(w - FRAME, FRAME, back), vec3(w, h - FRAME, front), !Faces::LEFT, paint.frame);
        let lying = |y0: f32, y1: f32| [vec3(FRAME, y0, back), vec3(w - FRAME, y1, front)];
        let [lower, upper] = lying(0.0, FRAME);
        d.cuboid(lower, upper, !(Faces::TOP | Faces::FRONT), paint.frame);
        let [lower, upper] = lying(h - FRAME, h);
        d.cuboid(lower, upper, !(Faces::BOTTOM | Faces::FRONT), paint.frame);
        for pair in columns.windows(2) {
            let [lower, upper] = [vec3(pair[0][1], FRAME, back), vec3(pair[1][0], h - FRAME, front)];
            d.cuboid(lower, upper, Faces::BACK | Faces::ENDS, paint.frame);
        }
        for column in &columns {
            for pair in rows.windows(2) {
                let [lower, upper] = [vec3(column[0], pair[0][1], back), vec3(column[1], pair[1][0], front)];
                d.cuboid(lower, upper, Faces::BACK | Faces::LEFT | Faces::RIGHT, paint.frame);
            }
        }
    });
    d.group("panes", |d| {
        for [x0, x1] in columns {
            for &[y0, y1] in &rows {
                d.quad([[x0, y0], [x1, y0], [x1, y1], [x0, y1]].map(|[x, y]| vec3(x, y, pane_depth)), paint.pane);
            }
        }
    });
}

/// A panelled door in its frame, on the wall; the origin is the middle of the threshold.
pub(super) fn door(d: &mut Draft, [width, height]: [f32; 2], leaf: MaterialId, frame: MaterialId, metal: MaterialId) {
    const FRAME: f32 = 0.08;
    const DEPTH: f32 = 0.06;
    let half = 0.5 * width;
    d.group("frame", |d| {
        let shut = Faces::BACK | Faces::ENDS;
        d.cuboid(vec3(-half - FRAME, 0.0, 0.0), vec3(-half, height, DEPTH), shut, frame);
        d.cuboid(vec3(half, 0.0, 0.0), vec3(half + FRAME, height, DEPTH), shut, frame);
        d.cuboid(vec3(-half - FRAME, height, 0.0), vec3(half + FRAME, height + FRAME, DEPTH), Faces::BACK, frame);
    });
    d.group("leaf", |d| {
        const FACE: f32 = 0.02;
        d.cuboid(vec3(-half, 0.0, 0.0), vec3(half, height, FACE), !Faces::FRONT, leaf);
        for [low, high] in [[0.12, 0.42], [0.5, 0.94]] {
            let [lower, upper] =
                [vec3(-half + 0.12, low * height, FACE), vec3(half - 0.12, high * height, FACE + 0.012)];
            d.cuboid(lower, upper, Faces::BACK, leaf);
        }
        let plate = vec3(half - 0.09, 1.0, FACE);
        d.cuboid(plate, plate + vec3(0.04, 0.14, 0.008), Faces::BACK, metal);
        d.cuboid(plate + vec3(-0.09, 0.08, 0.038), plate + vec3(0.03, 0.098, 0.052), Faces::NONE, metal);
        d.cuboid(
            plate + vec3(0.012, 0.082, 0.008),
            plate + vec3(0.028, 0.096, 0.038),
            Faces::BACK | Faces::FRONT,
            metal,
        );
    });
}

/// A skirting board along a wall between `from` and `to`, whose ends touch something.
pub(super) fn skirting(d: &mut Draft, [from, to]: [f32; 2], material: MaterialId) {
    let seen = Faces::TOP | Faces::FRONT;
    d.cuboid(vec3(from, 0.0, 0.0), vec3(to, 0.08, SKIRTING_DEPTH), !seen, material);
}

/// How far a skirting board stands out from its wall, m.
pub(super) const SKIRTING_DEPTH: f32 = 0.015;

/// A radiator before the wall, between x = 0 and `width`, with upright ribs.
pub(super) fn radiator(d: &mut Draft, width: f32, [low, high]: [f32; 2], ribs: usize, material: MaterialId) {
    d.cuboid(vec3(0.0, low, 0.04), vec3(width, high, 0.08), Faces::NONE, material);
    let pitch = width / ribs as f32;
    for rib in 0..ribs {
        let x = pitch * rib as f32;
        let [lower, upper] = [vec3(x + 0.2 * pitch, low + 0.03, 0.08), vec3(x + 0.8 * pitch, high - 0.03, 0.11)];
        d.cuboid(lower, upper, Faces::BACK, material);
    }
}

/// A fluorescent lamp under the ceiling, `length` along z, with two bright strips.
pub(super) fn ceiling_lamp(d: &mut Draft, [width, length]: [f32; 2], housing: MaterialId, light: MaterialId) {
    const DROP: f32 = 0.07;
    let (x, z) = (0.5 * width, 0.5 * length);
    d.cuboid(vec3(-x, -DROP, -z), vec3(x, 0.0, z), Faces::ENDS, housing);
    let strips = [-1.0, -0.8, -0.12, 0.12, 0.8, 1.0].map(|share| share * x);
    for (index, strip) in strips.windows(2).enumerate() {
        let material = if index % 2 == 1 { light } else { housing };
        let [a, b] = [strip[0], strip[1]];
        d.quad([vec3(a, -DROP, -z), vec3(b, -DROP, -z), vec3(b, -DROP, z), vec3(a, -DROP, z)], material);
    }
}

/// A round clock on the wall around the origin, at ten past ten.
pub(super) fn clock(d: &mut Draft, radius: f32, rim: MaterialId, face: MaterialId, hands: MaterialId) {
    d.placed(Affine3::from_quat(Quat::from_rotation_x(std::f32::consts::FRAC_PI_2)), |d| {
        d.lathe(&[(radius, 0.0), (radius, 0.035)], 12, rim);
        d.disc(radius, 0.035, false, 12, face);
    });
    for (turn, length, lift) in [(-60.0_f32, 0.8, 0.0), (55.0, 0.55, 0.004)] {
        let frame = Affine3::from_rotation_translation(Quat::from_rotation_z(turn.to_radians()), vec3(0.0, 0.0, 0.035));
        d.placed(frame, |d| {
            let [lower, upper] = [vec3(-0.008, -0.02, 0.0), vec3(0.008, length * radius, 0.004 + lift)];
            d.cuboid(lower, upper, Faces::BACK, hands);
        });
    }
}

/// A book that stands, its spine (`thick` × `high`) towards +z; the origin is the middle of the
/// spine's foot.
pub(super) fn upright_book(d: &mut Draft, [thick, high, deep]: [f32; 3], cover: MaterialId, pages: MaterialId) {
    let [lower, upper] = [vec3(-0.5 * thick, 0.0, -deep), vec3(0.5 * thick, high, 0.0)];
    d.cuboid(lower, upper, !(Faces::LEFT | Faces::RIGHT | Faces::FRONT), cover);
    d.cuboid(lower, upper, !(Faces::TOP | Faces::BACK), pages);
}

/// A book that lies, its spine towards -x; the origin is the middle of its underside.
pub(super) fn lying_book(d: &mut Draft, [wide, thick, deep]: [f32; 3], cover: MaterialId, pages: MaterialId) {
    let [lower, upper] = [vec3(-0.5 * wide, 0.0, -0.5 * deep), vec3(0.5 * wide, thick, 0.5 * deep)];
    d.cuboid(lower, upper, !(Faces::TOP | Faces::LEFT), cover);
    d.cuboid(lower, upper, !(Faces::RIGHT | Faces::FRONT | Faces::BACK), pages);
}

/// A pad of A4 paper.
pub(super) fn paper(d: &mut Draft, thickness: f32, material: MaterialId) {
    d.block(Vec3::ZERO, vec3(0.21, thickness, 0.297), Faces::BOTTOM, material);
}

/// A pencil that lies along z.
pub(super) fn pencil(d: &mut Draft, material: MaterialId) {
    d.block(Vec3::ZERO, vec3(0.008, 0.008, 0.16), Faces::BOTTOM, material);
}

/// A bottle of water with its cap.
pub(super) fn bottle(d: &mut Draft, glass: MaterialId, cap: MaterialId) {
    d.lathe(&[(0.032, 0.0), (0.032, 0.14), (0.013, 0.19)], 8, glass);
    d.lathe(&[(0.013, 0.19), (0.013, 0.215), (0.0, 0.215)], 8, cap);
}

/// A folded name card: four polygons.
pub(super) fn name_card(d: &mut Draft, material: MaterialId) {
    let [x, y, z] = [0.1, 0.075, 0.04];
    d.quad([vec3(-x, 0., z), vec3(x, 0., z), vec3(x, y, 0.), vec3(-x, y, 0.)], material);
    d.quad([vec3(x, 0., -z), vec3(-x, 0., -z), vec3(-x, y, 0.), vec3(x, y, 0.)], material);
    d.triangle([vec3(x, 0., z), vec3(x, 0., -z), vec3(x, y, 0.)], material);
    d.triangle([vec3(-x, 0., -z), vec3(-x, 0., z), vec3(-x, y, 0.)], material);
}

/// Rows of keys that stand on a keyboard, in groups of up to eight neighbours: `rows` gives each
/// row's key widths, in keys.
pub(super) fn keys(d: &mut Draft, origin: Vec3, [pitch, high]: [f32; 2], rows: &[&[f32]], material: MaterialId) {
    let gap = 0.07 * pitch;
    for (row, widths) in rows.iter().enumerate() {
        let mut x = origin.x;
        for (block, widths) in widths.chunks(8).enumerate() {
            d.group(&format!("row_{}_{}", row + 1, block + 1), |d| {
                for width in widths {
                    let lower = vec3(x + gap, origin.y, origin.z + pitch * row as f32 + gap);
                    x += width * pitch;
                    let upper = vec3(x - gap, origin.y + high, lower.z + pitch - 2.0 * gap);
                    d.cuboid(lower, upper, Faces::BOTTOM, material);
                }
            });
        }
    }
}

/// A flat frame on the wall around `width` × `height`, centred on the origin's foot; what it frames
/// is `picture`'s.
pub(super) fn framed(
    d: &mut Draft,
    [width, height]: [f32; 2],
    [bar, depth]: [f32; 2],
    frame: MaterialId,
    picture: impl FnOnce(&mut Draft),
) {
    let half = 0.5 * width;
    let (lying, standing) = (Faces::BACK, Faces::BACK | Faces::ENDS);
    d.cuboid(vec3(-half - bar, -bar, 0.0), vec3(half + bar, 0.0, depth), lying, frame);
    d.cuboid(vec3(-half - bar, height, 0.0), vec3(half + bar, height + bar, depth), lying, frame);
    d.cuboid(vec3(-half - bar, 0.0, 0.0), vec3(-half, height, depth), standing, frame);
    d.cuboid(vec3(half, 0.0, 0.0), vec3(half + bar, height, depth), standing, frame);
    picture(d);
}
