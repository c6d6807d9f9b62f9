//! Rows 14 and 25: units and the order of colours.

use glam::Vec3;

use super::measure::{MODES, difference_to, params, solve};
use super::scenes::lamp_room;
use super::{Check, Row};
use crate::hierarchy::ClusteringMode;
use crate::scene::Scene;
use crate::solve::{Solver, SolverError};

pub(super) fn rows() -> Vec<Row> {
    vec![
        Row {
            number: 14,
            name: "units",
            asked: "other units of length and emission leave links within 0.1 % and relative B within 1e-3; powers of two change nothing",
            limit: Some(
                "lengths that are no powers of two round otherwise: clusters are cut elsewhere and rays start elsewhere",
            ),
            measure: units,
        },
        Row {
            number: 25,
            name: "colours",
            asked: "permuted colours permute the answer, to the bit",
            limit: None,
            measure: colours,
        },
    ]
}

fn scaled(scene: &Scene, length: f32, emission: f32) -> Scene {
    let mut scaled = scene.clone();
    scaled.vertices.iter_mut().for_each(|vertex| *vertex *= length);
    scaled.materials.iter_mut().for_each(|material| material.emission *= emission);
    scaled
}

/// Number of elements whose changed radiosity is not that of the other solution, and of elements
/// and links that one has more.
fn differing(one: &Solver, other: &Solver, change: impl Fn(Vec3) -> Vec3) -> f64 {
    let pairs = one.radiosity().iter().zip(other.radiosity());
    let differ = pairs.filter(|(a, b)| change(**a) != **b).count();
    (differ + one.radiosity().len().abs_diff(other.radiosity().len()) + one.links().len().abs_diff(other.links().len()))
        as f64
}

fn units() -> Result<Vec<Check>, SolverError> {
    let scene = lamp_room();
    let mut checks = Vec::new();
    for mode in MODES {
        let plain = solve(&scene, params(mode, 1e-3))?;
        for (length, emission) in [(1024.0, 1.0), (1.0 / 1024.0, 4.0), (1.0, 1.0 / 1024.0)] {
            let other = solve(&scaled(&scene, length, emission), params(mode, 1e-3))?;
            let what = format!("values that differ, lengths × {length}, emission × {emission}, {mode:?}");
            checks.push(Check::near(what, 0.0, differing(&plain, &other, |radiosity| emission * radiosity), 0.0));
        }
        for (length, emission) in [(1e-3, 1.0), (10.0, 1.0), (1e3, 1.0), (1.0, 1e-3), (1.0, 1e3)] {
            let other = solve(&scaled(&scene, length, emission), params(mode, 1e-3))?;
            let (links, expected) = (other.links().len() as f64, plain.links().len() as f64);
            let what = format!("lengths × {length}, emission × {emission}, {mode:?}");
            let check = Check::within(format!("links, {what}"), expected, links, 1e-3);
            checks.push(check.known_where(length != 1.0, 0.018 * expected));
            checks.push(Check::near(format!("RMS of B, {what}"), 0.0, difference_to(&other, &plain, emission), 1e-3));
        }
    }
    Ok(checks)
}

fn colours() -> Result<Vec<Check>, SolverError> {
    let permute = |colour: Vec3| Vec3::new(colour.z, colour.x, colour.y);
    let mut permuted = lamp_room();
    for material in &mut permuted.materials {
        material.reflectance = permute(material.reflectance);
        material.emission = permute(material.emission);
    }
    let mut checks = Vec::new();
    for mode in MODES {
        let (plain, other) = (solve(&lamp_room(), params(mode, 1e-3))?, solve(&permuted, params(mode, 1e-3))?);
        let differ = differing(&plain, &other, permute);
        checks.push(Check::near(format!("values that differ, {mode:?}"), 0.0, differ, 0.0));
    }
    // A red lamp: what it does not send is black, and red alone decides.
    let mut red = lamp_room();
    let mut white = lamp_room();
    for (red, white) in red.materials.iter_mut().zip(&mut white.materials) {
        (red.emission.y, red.emission.z) = (0.0, 0.0);
        white.emission = Vec3::splat(white.emission.x);
        white.reflectance = Vec3::splat(white.reflectance.x);
    }
    let (red, white) =
        (solve(&red, params(ClusteringMode::Adaptive, 1e-3))?, solve(&white, params(ClusteringMode::Adaptive, 1e-3))?);
    let of_red = |solved: &Solver| solved.radiosity().iter().map(|radiosity| radiosity.x).collect::<Vec<_>>();
    let differ = of_red(&red).iter().zip(&of_red(&white)).filter(|(a, b)| a != b).count();
    checks.push(Check::near("red values that differ under a red lamp", 0.0, differ as f64, 0.0));
    let stray = red.radiosity().iter().filter(|radiosity| radiosity.y != 0.0 || radiosity.z != 0.0).count();
    checks.push(Check::near("elements with green or blue under a red lamp", 0.0, stray as f64, 0.0));
    Ok(checks)
}
