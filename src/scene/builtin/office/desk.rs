//! A desk with drawers and all that stands on it; people sit at +z and look towards -z.

use glam::{Affine3, EulerRot, Quat, Vec3, vec3};

use super::super::furniture;
use super::super::shapes::{Dice, Draft, Faces};
use super::Paints;

const HEIGHT: f32 = 0.74;
const TOP: f32 = 0.03;
const UNDER: f32 = HEIGHT - TOP;
const WIDTH: f32 = 1.7;
const DEPTH: f32 = 0.8;

/// Differences between desks.
#[derive(Clone, Copy, Debug)]
pub(super) struct Habits {
    pub(super) seed: u32,
    /// Where the lamp stands, m to the right of the middle.
    pub(super) lamp: f32,
    /// Degrees that the screen is turned by.
    pub(super) screen_turn: f32,
}

/// The desk: a side panel on the left, a pedestal with three drawers on the right.
pub(super) fn desk(d: &mut Draft, p: &Paints) {
    let (x, z) = (0.5 * WIDTH, 0.5 * DEPTH);
    d.group("table", |d| {
        d.block(vec3(0.0, UNDER, 0.0), vec3(WIDTH, TOP, DEPTH), Faces::NONE, p.oak);
        d.cuboid(vec3(0.02 - x, 0.0, 0.04 - z), vec3(0.05 - x, UNDER, z - 0.04), Faces::ENDS, p.oak);
        let knees = Faces::TOP | Faces::LEFT | Faces::RIGHT;
        d.cuboid(vec3(0.05 - x, 0.3, 0.1 - z), vec3(x - 0.46, UNDER, 0.12 - z), knees, p.oak);
    });
    d.group("drawers", |d| {
        let (left, right, front) = (x - 0.46, x - 0.02, z - 0.06);
        d.cuboid(vec3(left, 0.0, 0.04 - z), vec3(right, UNDER, front), Faces::ENDS, p.white);
        for (index, [low, high]) in [[0.05, 0.33], [0.34, 0.51], [0.52, 0.69]].into_iter().enumerate() {
            d.group(&format!("drawer_{}", index + 1), |d| {
                let face = front + 0.018;
                d.cuboid(vec3(left + 0.005, low, front), vec3(right - 0.005, high, face), Faces::BACK, p.white);
                let (x, y) = (0.5 * (left + right), high - 0.05);
                d.cuboid(vec3(x - 0.07, y, face), vec3(x + 0.07, y + 0.012, face + 0.025), Faces::BACK, p.steel);
            });
        }
    });
}

/// Monitor, keyboard, mouse, lamp, papers, books, mug and pens.
pub(super) fn equipment(d: &mut Draft, p: &Paints, habits: Habits) {
    let mut dice = Dice::new(habits.seed);
    let away = -habits.lamp.signum();
    let top = |x: f32, z: f32| vec3(x, HEIGHT, z);
    d.piece("monitor", top(0.0, -0.16), habits.screen_turn, |d| monitor(d, p));
    d.piece("keyboard", top(-0.02, 0.2), 0.0, |d| keyboard(d, p));
    d.piece("mouse", top(0.33, 0.22), -10.0, |d| mouse(d, p));
    d.piece("lamp", top(habits.lamp, -0.24), if habits.lamp < 0.0 { 0.0 } else { 180.0 }, |d| lamp(d, p));
    d.group("papers", |d| {
        let pile = top(away * 0.58 + dice.between(-0.03, 0.03), 0.14 + dice.between(-0.02, 0.02));
        for sheet in 0..3 {
            // Each sheet is smaller than the one below, on which it rests wholly.
            let (lift, size) = (vec3(0.0, 0.004 * sheet as f32, 0.0), 1.0 - 0.16 * sheet as f32);
            d.at(pile + lift, dice.between(-3.0, 3.0), |d| {
                d.block(Vec3::ZERO, vec3(0.24 * size, 0.004, 0.32 * size), Faces::BOTTOM, p.paper);
            });
        }
        d.at(top(habits.lamp.signum() * 0.6, 0.17), dice.between(-12.0, 12.0), |d| furniture::paper(d, 0.002, p.paper));
        d.at(top(habits.lamp.signum() * 0.43, 0.24), 8.0, |d| furniture::pencil(d, p.covers[3]));
    });
    d.piece("books", top(away * 0.42, -0.2), dice.between(-10.0, 10.0), |d| {
        let mut y = 0.0;
        for size in [1.0, 0.86, 0.7] {
            let (thick, cover) = (0.005 * dice.between(5.0, 9.0).round(), dice.pick(&p.covers));
            d.at(vec3(0.0, y, 0.0), dice.between(-2.5, 2.5), |d| {
                furniture::lying_book(d, [0.2 * size, thick, 0.27 * size], cover, p.paper);
            });
            y += thick;
        }
    });
    d.piece("mug", top(away * 0.34, 0.03), dice.between(0.0, 360.0), |d| mug(d, p));
    d.piece("pens", top(away * 0.66, -0.22), 0.0, |d| pens(d, p, &mut dice));
}

fn monitor(d: &mut Draft, p: &Paints) {
    let (x, low, high, thick, rim) = (0.3, 0.13, 0.49, 0.035, 0.015);
    d.group("stand", |d| {
        d.block(vec3(0.0, 0.0, -0.04), vec3(0.24, 0.012, 0.18), Faces::BOTTOM, p.dark);
        // Sunk 5 mm into the housing.
        d.cuboid(vec3(-0.03, 0.012, -0.055), vec3(0.03, 0.3, 0.005 - thick), Faces::BOTTOM, p.dark);
    });
    // One grid for the rim and what the screen shows, so that neighbours share full edges.
    let across = [-x, rim - x, 0.06, x - rim, x];
    let up = [low, low + rim, low + 0.04, high - 0.05, high - rim, high];
    let is_rim =
        |column: usize, row: usize| [0, across.len() - 2].contains(&column) || [0, up.len() - 2].contains(&row);
    let plane = (Vec3::ZERO, Vec3::X, Vec3::Y);
    d.group("housing", |d| {
        d.cuboid(vec3(-x, low, -thick), vec3(x, high, 0.0), Faces::FRONT, p.dark);
        d.wall(plane, &across, &up, |column, row| !is_rim(column, row), p.dark);
    });
    d.group("screen", |d| {
        let shown = |column: usize, row: usize| match (column, row) {
            (_, 1) => p.screen_code,
            (1, 2) => p.screen_page,
            _ => p.screen,
        };
        for material in [p.screen, p.screen_page, p.screen_code] {
            let other = |column, row| is_rim(column, row) || shown(column, row) != material;
            d.wall(plane, &across, &up, other, material);
        }
    });
}

const KEY_ROWS: [&[f32]; 6] = [
    &[1.0; 15],
    &[1., 1., 1., 1., 1., 1., 1., 1., 1., 1., 1., 1., 1., 2.],
    &[1.5, 1., 1., 1., 1., 1., 1., 1., 1., 1., 1., 1., 1., 1.5],
    &[1.75, 1., 1., 1., 1., 1., 1., 1., 1., 1., 1., 1., 2.25],
    &[2.25, 1., 1., 1., 1., 1., 1., 1., 1., 1., 1., 2.75],
    &[1.5, 1.25, 1.25, 6., 1.25, 1.25, 1.25, 1.25],
];

const PAD_ROWS: [&[f32]; 4] = [&[1.0; 4], &[1.0; 4], &[1.0; 4], &[2., 1., 1.]];

fn keyboard(d: &mut Draft, p: &Paints) {
    const PITCH: [f32; 2] = [0.019, 0.006];
    d.block(Vec3::ZERO, vec3(0.4, 0.018, 0.14), Faces::BOTTOM, p.dark);
    d.group("letters", |d| furniture::keys(d, vec3(-0.193, 0.018, -0.058), PITCH, &KEY_ROWS, p.key));
    d.group("numbers", |d| furniture::keys(d, vec3(0.108, 0.018, -0.02), PITCH, &PAD_ROWS, p.key));
}

fn mouse(d: &mut Draft, p: &Paints) {
    let scale = Affine3::from_scale(vec3(0.03, 0.032, 0.052));
    d.placed(scale, |d| d.lathe(&[(1.0, 0.0), (0.95, 0.55), (0.6, 1.0), (0.0, 1.0)], 8, p.dark));
}

/// A telephone with its keys on the right and the handset on the left.
pub(super) fn telephone(d: &mut Draft, p: &Paints) {
    d.group("base", |d| d.block(vec3(0.0, HEIGHT, 0.0), vec3(0.18, 0.04, 0.2), Faces::BOTTOM, p.dark));
    // Sunk a millimetre into the base.
    d.group("handset", |d| d.block(vec3(-0.055, HEIGHT + 0.039, 0.0), vec3(0.045, 0.035, 0.22), Faces::NONE, p.dark));
    let rows: [&[f32]; 4] = [&[1.0; 3]; 4];
    furniture::keys(d, vec3(-0.005, HEIGHT + 0.04, -0.02), [0.026, 0.005], &rows, p.key);
}

/// A lamp whose arm leans to the right, with the bulb in a shade of enamel.
fn lamp(d: &mut Draft, p: &Paints) {
    // Above the head, so that the arm comes down on the shade from outside.
    let elbow = vec3(-0.06, 0.47, 0.0);
    let head = vec3(0.16, 0.43, 0.06);
    d.group("arm", |d| {
        d.lathe(&[(0.075, 0.0), (0.075, 0.012), (0.05, 0.025), (0.0, 0.025)], 10, p.enamel);
        d.bar([vec3(0.0, 0.02, 0.0), elbow], [0.014, 0.014], Faces::NONE, p.steel);
        // It ends between the two skins of the shade's top, and is not to be seen inside.
        d.bar([elbow, head + vec3(0.0, 0.01, 0.0)], [0.014, 0.014], Faces::NONE, p.steel);
    });
    let tilt = Quat::from_euler(EulerRot::XYZ, -0.15, 0.0, 0.35);
    d.placed(Affine3::from_rotation_translation(tilt, head - vec3(0.0, 0.085, 0.0)), |d| {
        let inside = [(0.0, 0.08), (0.028, 0.08), (0.078, 0.0), (0.083, 0.0)];
        let outside = [(0.083, 0.0), (0.033, 0.09), (0.0, 0.09)];
        d.group("shade", |d| {
            d.group("inside", |d| d.lathe(&inside, 10, p.white));
            d.group("outside", |d| d.lathe(&outside, 10, p.enamel));
        });
        d.group("bulb", |d| d.lathe(&[(0.0, 0.028), (0.02, 0.04), (0.02, 0.06), (0.012, 0.08)], 8, p.bulb));
    });
}

/// A mug with a handle, which goes a millimetre into the wall.
fn mug(d: &mut Draft, p: &Paints) {
    d.lathe(&[(0.038, 0.0), (0.04, 0.095), (0.035, 0.095), (0.034, 0.07)], 10, p.enamel);
    d.disc(0.034, 0.07, false, 10, p.earth);
    d.group("handle", |d| {
        let thick = [0.01, 0.01];
        d.bar([vec3(0.037, 0.075, 0.0), vec3(0.06, 0.075, 0.0)], thick, Faces::BACK | Faces::FRONT, p.enamel);
        d.bar([vec3(0.037, 0.025, 0.0), vec3(0.06, 0.025, 0.0)], thick, Faces::BACK | Faces::FRONT, p.enamel);
        d.cuboid(vec3(0.06, 0.018, -0.006), vec3(0.07, 0.082, 0.006), Faces::NONE, p.enamel);
    });
}

/// A beaker of pens.
fn pens(d: &mut Draft, p: &Paints, dice: &mut Dice) {
    d.group("beaker", |d| {
        d.lathe(&[(0.036, 0.0), (0.036, 0.1), (0.032, 0.1), (0.032, 0.006), (0.0, 0.006)], 8, p.dark);
    });
    d.group("pens", |d| {
        for pen in 0..5 {
            let angle = std::f32::consts::TAU * (pen as f32 + dice.between(0.0, 0.5)) / 5.0;
            let out = vec3(angle.sin(), 0.0, angle.cos());
            let foot = 0.012 * out + vec3(0.0, 0.012, 0.0);
            let head = 0.034 * out + vec3(0.0, dice.between(0.145, 0.17), 0.0);
            d.bar([foot, head], [0.007, 0.007], Faces::NONE, p.covers[pen]);
        }
    });
}
