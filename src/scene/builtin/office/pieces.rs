//! Chairs, plants, cabinet, bin and pictures.

use glam::{Affine3, Mat3, Vec3, vec3};

use super::super::shapes::{Dice, Draft, Faces};
use super::Paints;
use crate::scene::MaterialId;

/// A swivel chair on a five-star foot; its back is at +z.
pub(super) fn office_chair(d: &mut Draft, p: &Paints) {
    d.group("foot", |d| {
        for arm in 0..5 {
            d.piece(&format!("arm_{}", arm + 1), Vec3::ZERO, 72.0 * arm as f32 + 15.0, |d| {
                d.bar([vec3(0.0, 0.09, 0.02), vec3(0.0, 0.07, 0.3)], [0.04, 0.025], Faces::NONE, p.steel);
                d.at(vec3(0.0, 0.0, 0.28), 0.0, |d| d.lathe(&[(0.026, 0.0), (0.026, 0.05), (0.0, 0.05)], 6, p.dark));
            });
        }
        d.group("column", |d| {
            d.lathe(&[(0.0, 0.06), (0.045, 0.06), (0.045, 0.12), (0.028, 0.14), (0.028, 0.43)], 8, p.steel);
        });
    });
    let cushion = [(0.0, 0.0), (0.9, 0.0), (1.0, 0.3), (1.0, 0.7), (0.9, 1.0), (0.0, 1.0)];
    d.group("seat", |d| {
        // Turned by half a side, the octagon shows a straight edge to the front.
        let frame = Affine3::from_scale_rotation_translation(
            vec3(0.27, 0.08, 0.27),
            glam::Quat::from_rotation_y(22.5_f32.to_radians()),
            vec3(0.0, 0.43, 0.0),
        );
        d.placed(frame, |d| d.lathe(&cushion, 8, p.fabric));
    });
    d.group("back", |d| {
        let upright = Mat3::from_cols(Vec3::X * 0.24, Vec3::Z * 0.06, -Vec3::Y * 0.29);
        d.placed(Affine3::from_mat3_translation(upright, vec3(0.0, 0.84, 0.22)), |d| {
            d.at(Vec3::ZERO, 22.5, |d| d.lathe(&cushion, 8, p.fabric));
        });
    });
    d.group("support", |d| {
        d.bar([vec3(0.0, 0.46, 0.2), vec3(0.0, 0.46, 0.32)], [0.06, 0.03], Faces::NONE, p.dark);
        d.bar([vec3(0.0, 0.45, 0.305), vec3(0.0, 0.85, 0.29)], [0.05, 0.03], Faces::NONE, p.dark);
        for x in [-0.255, 0.255] {
            d.block(vec3(x, 0.66, 0.03), vec3(0.06, 0.03, 0.26), Faces::NONE, p.dark);
            d.block(vec3(x, 0.45, 0.05), vec3(0.03, 0.21, 0.05), Faces::TOP, p.dark);
        }
    });
}

/// An armchair for visitors, who look towards -z.
pub(super) fn armchair(d: &mut Draft, p: &Paints) {
    let (x, z) = (0.36, 0.36);
    d.group("legs", |d| {
        for [x, z] in [[-x, -z], [x, -z], [-x, z], [x, z]] {
            d.block(vec3(0.88 * x, 0.0, 0.88 * z), vec3(0.045, 0.14, 0.045), Faces::ENDS, p.walnut);
        }
    });
    d.group("body", |d| {
        d.cuboid(vec3(-x, 0.14, -z), vec3(x, 0.3, z), Faces::NONE, p.visitor);
        for x in [-x + 0.06, x - 0.06] {
            d.block(vec3(x, 0.3, 0.0), vec3(0.12, 0.26, 2.0 * z), Faces::BOTTOM, p.visitor);
        }
        let (inner, back) = (x - 0.12, z - 0.14);
        // The back is higher than the arms, so it keeps 4 mm away from them.
        d.cuboid(vec3(0.004 - inner, 0.3, back), vec3(inner - 0.004, 0.82, z), Faces::BOTTOM, p.visitor);
        d.cuboid(
            vec3(0.005 - inner, 0.3, 0.015 - z),
            vec3(inner - 0.005, 0.42, back - 0.005),
            Faces::BOTTOM,
            p.cushion,
        );
    });
}

/// A pot with earth in it.
fn pot(d: &mut Draft, p: &Paints, [radius, height]: [f32; 2]) {
    d.group("pot", |d| {
        let (r, h) = (radius, height);
        d.lathe(
            &[(0.72 * r, 0.0), (0.95 * r, 0.82 * h), (r, 0.82 * h), (r, h), (0.88 * r, h), (0.85 * r, 0.9 * h)],
            10,
            p.pot,
        );
        d.disc(0.85 * r, 0.9 * h, false, 10, p.earth);
    });
}

/// A leaf that sets out from `start`, rises and hangs over: ten polygons.
fn leaf(d: &mut Draft, start: Vec3, angle: f32, [length, rise, width]: [f32; 3], material: MaterialId) {
    let out = vec3(angle.sin(), 0.0, angle.cos());
    let side = vec3(-angle.cos(), 0.0, angle.sin());
    let middle = start + 0.5 * length * out + Vec3::Y * rise;
    let tip = start + length * out + Vec3::Y * 0.75 * rise - Vec3::Y * 0.1 * length;
    d.blade(&[start, middle, tip], &[0.25 * width, width, 0.12 * width], side, 0.004, material);
}

/// The angle between one leaf and the next: the golden angle, radians.
const NEXT_LEAF: f32 = 2.399_963;

/// A plant for the window sill.
pub(super) fn small_plant(d: &mut Draft, p: &Paints, seed: u32) {
    let mut dice = Dice::new(seed);
    pot(d, p, [0.07, 0.11]);
    for bunch in 0..3 {
        d.group(&format!("leaves_{}", bunch + 1), |d| {
            for index in 0..4 {
                let angle = NEXT_LEAF * (4 * bunch + index) as f32;
                let shape = [dice.between(0.1, 0.17), dice.between(0.08, 0.22), 0.04];
                let green = if index % 2 == 0 { p.fresh_leaf } else { p.leaf };
                leaf(d, vec3(0.02 * angle.sin(), 0.095, 0.02 * angle.cos()), angle, shape, green);
            }
        });
    }
}

/// A plant as high as a man, with leaves along three stems.
pub(super) fn tall_plant(d: &mut Draft, p: &Paints) {
    let mut dice = Dice::new(3);
    pot(d, p, [0.19, 0.34]);
    for stem in 0..3 {
        d.group(&format!("stem_{}", stem + 1), |d| {
            let angle = 2.1 * stem as f32 + 0.4;
            let foot = vec3(0.06 * angle.sin(), 0.28, 0.06 * angle.cos());
            let head = vec3(0.16 * angle.sin(), 1.05 + 0.25 * stem as f32, 0.16 * angle.cos());
            d.bar([foot, head], [0.018, 0.018], Faces::NONE, p.earth);
            let bunches = 2 + stem.min(1);
            for bunch in 0..bunches {
                d.group(&format!("leaves_{}", bunch + 1), |d| {
                    for index in 0..4 {
                        let number = 4 * bunch + index;
                        let height = 1.0 - 0.07 * number as f32;
                        let shape = [dice.between(0.24, 0.36), dice.between(0.1, 0.24), 0.09];
                        let green = if number % 3 == 0 { p.fresh_leaf } else { p.leaf };
                        leaf(d, foot.lerp(head, height), NEXT_LEAF * number as f32 + angle, shape, green);
                    }
                });
            }
        });
    }
}

/// A cabinet with four drawers, papers on its top.
pub(super) fn cabinet(d: &mut Draft, p: &Paints) {
    let (x, z, top) = (0.22, 0.26, 1.18);
    d.group("body", |d| d.cuboid(vec3(-x, 0.0, -z), vec3(x, top, z), Faces::BOTTOM, p.steel));
    for drawer in 0..4 {
        d.group(&format!("drawer_{}", drawer + 1), |d| {
            let y = 0.03 + 0.285 * drawer as f32;
            d.cuboid(vec3(0.01 - x, y, z), vec3(x - 0.01, y + 0.275, z + 0.015), Faces::BACK, p.steel);
            d.cuboid(vec3(-0.06, y + 0.2, z + 0.015), vec3(0.06, y + 0.215, z + 0.035), Faces::BACK, p.dark);
            d.cuboid(vec3(-0.04, y + 0.09, z + 0.015), vec3(0.04, y + 0.13, z + 0.018), Faces::BACK, p.paper);
        });
    }
    d.piece("box", vec3(-0.02, top, -0.05), 8.0, |d| {
        d.block(Vec3::ZERO, vec3(0.32, 0.16, 0.26), Faces::BOTTOM | Faces::TOP, p.covers[7]);
        d.block(vec3(0.0, 0.16, 0.0), vec3(0.34, 0.05, 0.28), Faces::NONE, p.covers[1]);
    });
}

/// A waste-paper bin with a crumpled sheet in it and one beside it.
pub(super) fn bin(d: &mut Draft, p: &Paints) {
    d.group("bin", |d| {
        d.lathe(&[(0.11, 0.0), (0.14, 0.3), (0.135, 0.3), (0.107, 0.01), (0.0, 0.01)], 12, p.dark);
    });
    let balls = [vec3(0.02, 0.2, 0.03), vec3(0.24, 0.034, 0.12)];
    for (index, at) in balls.into_iter().enumerate() {
        d.piece(&format!("crumpled_{}", index + 1), at, 50.0 * index as f32, |d| {
            d.lathe(&[(0.0, -0.034), (0.036, -0.012), (0.032, 0.02), (0.0, 0.036)], 6, p.paper);
        });
    }
}

/// A framed picture of coloured fields; the origin is the middle of its lower edge.
pub(super) fn picture(d: &mut Draft, p: &Paints, [width, height]: [f32; 2], index: usize) {
    super::furniture::framed(d, [width, height], [0.03, 0.025], p.walnut, |d| {
        let fields = [[5, 7, 3], [6, 0, 7], [2, 6, 1]];
        let lines = |size: f32| [0.0, 0.22 * size, 0.61 * size, size];
        let (across, up) = (lines(width).map(|x| x - 0.5 * width), lines(height));
        for row in 0..3 {
            for column in 0..3 {
                let cover = p.covers[fields[(row + index) % 3][(column + 2 * index) % 3]];
                let (x, y) = (&across[column..column + 2], &up[row..row + 2]);
                d.wall((vec3(0.0, 0.0, 0.006), Vec3::X, Vec3::Y), x, y, |_, _| false, cover);
            }
        }
    });
}
