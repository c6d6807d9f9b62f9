//! Rows 1–3, 15 and 17: form factors near and far, what they sum to, and light that is reflected
//! often.

use glam::Vec3;

use super::measure::{MODES, at_each, deviation, params, received, solve};
use super::scenes::{add_box, empty_room, furnished_room};
use super::{Check, Row};
use crate::hierarchy::{ClusteringMode, Hierarchy};
use crate::measure::accuracy::cases::{lamp_and_black, level, upright};
use crate::measure::accuracy::closed_forms::{Span, closed_room, parallel_exchange, perpendicular_exchange};
use crate::scene::{GroupId, Scene};
use crate::solve::{SolverError, SolverParams};
use crate::transport::{Exchange, audit, exchange};

const UNIT: Span = [0.0, 1.0];

pub(super) fn rows() -> Vec<Row> {
    vec![
        Row {
            number: 1,
            name: "touching",
            asked: "squares that share an edge or a corner exchange their closed form, to 1 %",
            limit: None,
            measure: touching,
        },
        Row {
            number: 2,
            name: "row-sums",
            asked: "the form factors of each leaf of a closed cube sum to 1, to 1 %",
            limit: Some(
                "at ε = 1 a cluster stands for whole walls, and its form factors come from a dozen random points",
            ),
            measure: row_sums,
        },
        Row {
            number: 3,
            name: "weighted-visibility",
            asked: "a square behind a blocker gets its exact form factor, not V·F, to 2 %",
            limit: None,
            measure: weighted_visibility,
        },
        Row {
            number: 15,
            name: "small-lamps",
            asked: "lamps of 1 m to 1 mm and one power light a square 3 m below alike, to 1 %",
            limit: None,
            measure: small_lamps,
        },
        Row {
            number: 17,
            name: "white-rooms",
            asked: "furnaces of ρ = 0.5, 0.95 and 0.99 glow with B_e/(1−ρ), to ρ/(1−ρ) · 1 %",
            limit: None,
            measure: white_rooms,
        },
    ]
}

/// A square that shines and a black one.
fn pair(lamp: [Vec3; 4], other: [Vec3; 4]) -> Scene {
    let mut scene = Scene::new("pair");
    let (emitter, black) = lamp_and_black(&mut scene, 1.0);
    scene.add_quad(lamp, emitter, GroupId(0));
    scene.add_quad(other, black, GroupId(0));
    scene
}

fn touching() -> Result<Vec<Check>, SolverError> {
    let mut checks = Vec::new();
    let edge = perpendicular_exchange(UNIT, UNIT, UNIT, UNIT);
    // Pair by pair, as n × n pieces: the sum of what the formulas say must not depend on n.
    for pieces in [1, 4] {
        let mut scene = Scene::new("pieces");
        let (emitter, black) = lamp_and_black(&mut scene, 1.0);
        let span = |piece: usize| [piece as f64 / pieces as f64, (piece + 1) as f64 / pieces as f64];
        for (x, y) in (0..pieces * pieces).map(|piece| (piece / pieces, piece % pieces)) {
            scene.add_quad(level(span(x), span(y), 0.0, true), emitter, GroupId(0));
            scene.add_quad(upright(span(x), span(y)), black, GroupId(0));
        }
        let hierarchy = Hierarchy::new(&scene, std::sync::Arc::default(), ClusteringMode::None, 1);
        let patches = hierarchy.initial_patches();
        let of = |a, b| match exchange(&hierarchy, a, b) {
            Exchange::Facing { estimate, .. } => f64::from(estimate),
            Exchange::FacingAway => 0.0,
        };
        let floor = patches.iter().step_by(2);
        let sum: f64 = floor.flat_map(|&a| patches.iter().skip(1).step_by(2).map(move |&b| of(a, b))).sum();
        checks.push(Check::within(format!("edge, {pieces} × {pieces} pieces"), edge, sum, 0.01));
    }
    let corner = perpendicular_exchange(UNIT, UNIT, UNIT, [1.0, 2.0]);
    for mode in MODES {
        for (what, eta, truth) in [("edge", UNIT, edge), ("corner", [1.0, 2.0], corner)] {
            let scene = pair(level(UNIT, UNIT, 0.0, true), upright(UNIT, eta));
            let found = received(&solve(&scene, params(mode, 1e-4))?, 1);
            checks.push(Check::within(format!("{what}, {mode:?}"), truth, found, 0.01));
        }
    }
    Ok(checks)
}

fn row_sums() -> Result<Vec<Check>, SolverError> {
    let mut checks = Vec::new();
    for (mode, epsilon) in at_each([1.0, 1e-3]) {
        let rows = audit(solve(&empty_room(0.5, 1.0), params(mode, epsilon))?.link_solution()).rows;
        let far = |row: &f64| (row - 1.0).abs();
        let worst = rows.iter().copied().max_by(|a, b| far(a).total_cmp(&far(b))).unwrap_or(f64::NAN);
        let check = Check::near(format!("{mode:?}, ε = {epsilon:e}"), 1.0, worst, 0.01);
        checks.push(check.known_where(epsilon >= 1.0 && mode != ClusteringMode::None, 0.12));
    }
    Ok(checks)
}

/// F between facing unit squares at distance 1 past a square of 0.5 half-way between them, by
/// quadrature of the point form.
const BEHIND_BLOCKER: f64 = 0.099_506_3;

fn weighted_visibility() -> Result<Vec<Check>, SolverError> {
    let mut scene = pair(level(UNIT, UNIT, 0.0, true), level(UNIT, UNIT, 1.0, false));
    let black = scene.polygons[1].material;
    scene.add_quad(level([0.25, 0.75], [0.25, 0.75], 0.5, true), black, GroupId(0));
    let mut checks = Vec::new();
    // One link with many rays: the product of a plain mean V and F would be 12 % too low.
    let one_link = SolverParams { rays_min: 2048, rays_max: 2048, ..params(ClusteringMode::None, 2.0) };
    checks.push(Check::within("one link", BEHIND_BLOCKER, received(&solve(&scene, one_link)?, 1), 0.02));
    for mode in MODES {
        let found = received(&solve(&scene, params(mode, 1e-4))?, 1);
        checks.push(Check::within(format!("{mode:?}, ε = 1e-4"), BEHIND_BLOCKER, found, 0.02));
    }
    Ok(checks)
}

fn small_lamps() -> Result<Vec<Check>, SolverError> {
    let mut checks = Vec::new();
    for side in [1.0, 0.1, 0.01, 0.001] {
        let half = [-0.5 * side, 0.5 * side];
        let aside = [1.0, 2.0];
        let mut scene = Scene::new("lamp");
        let (emitter, black) = lamp_and_black(&mut scene, 1.0 / (side * side));
        scene.add_quad(level(half, half, 3.0, false), emitter, GroupId(0));
        scene.add_quad(level(aside, aside, 0.0, true), black, GroupId(0));
        let truth = parallel_exchange(half, half, aside, aside, 3.0) / (side * side);
        for mode in MODES {
            let found = received(&solve(&scene, params(mode, 1e-4))?, 1);
            // The closed form's sixteen terms cancel below a centimetre: the smaller lamps have the
            // truth of that one.
            let truth = if side < 0.01 { checks.last().map_or(truth, |last: &Check| last.truth) } else { truth };
            checks.push(Check::within(format!("{side} m, {mode:?}"), truth, found, 0.01));
        }
    }
    Ok(checks)
}

fn white_rooms() -> Result<Vec<Check>, SolverError> {
    let mut checks = Vec::new();
    for mode in MODES {
        for (reflectance, epsilon) in [(0.5_f32, 1e-4), (0.95, 1e-2), (0.99, 1e-2)] {
            let truth = 1.0 / (1.0 - f64::from(reflectance));
            let allowed = 0.01 * f64::from(reflectance) * truth;
            for (what, room) in
                [("empty", empty_room(reflectance, 1.0)), ("furnished", furnished_room(reflectance, 1.0))]
            {
                let (mean, ..) = deviation(&solve(&room, params(mode, epsilon))?, truth);
                checks.push(Check::within(format!("{what}, ρ = {reflectance}, {mode:?}"), truth, mean, allowed));
            }
        }
        // A lamp of 1 W in a white room: the mean over its faces is exact by conservation.
        let mut scene = Scene::new("white room");
        let white = scene.add_material("white", Vec3::splat(0.99), Vec3::ZERO);
        let lamp = scene.add_material("lamp", Vec3::splat(0.99), Vec3::splat(100.0));
        add_box(&mut scene, (Vec3::ZERO, Vec3::ONE), true, (white, GroupId(0)));
        scene.add_quad(level([0.45, 0.55], [0.45, 0.55], 0.999, false), lamp, GroupId(0));
        let solved = solve(&scene, params(mode, 1e-2))?;
        let mean = (0..6).map(|face| received(&solved, face)).sum::<f64>() / 6.0;
        checks.push(Check::within(format!("lamp, ρ = 0.99, {mode:?}"), closed_room(1.0, 6.0, 0.99), mean, 0.99));
    }
    Ok(checks)
}
