//! Rows 18, 19 and 24: light that grows, light that drifts away, and links that were judged in the
//! dark.

use std::sync::Arc;

use glam::{Vec3, vec3};
use rustc_hash::FxHashMap;

use super::measure::{MODES, at_each, difference, params, solve};
use super::scenes::{add_box, empty_room, furnished_room, lamp_room};
use super::{Check, Row};
use crate::base::cancel::CancelToken;
use crate::geometry::Occluders;
use crate::hierarchy::{ClusteringMode, ElementId};
use crate::measure::accuracy::by_reference;
use crate::measure::accuracy::cases::{Case, level, mean};
use crate::scene::{GroupId, Scene};
use crate::solve::{Epsilon, Solver, SolverError, SolverParams, power_balance};
use crate::transport::{ClusterModel, audit};

pub(super) fn rows() -> Vec<Row> {
    vec![
        Row {
            number: 18,
            name: "divergence",
            asked: "B ≤ max B_e/(1−ρ_max), power ≤ Φ/(1−ρ_max), rows and columns of F·V sum to 1 at most, at any ε",
            limit: Some("few rays make some rows and columns too large by chance, as they make others too small"),
            measure: divergence,
        },
        Row {
            number: 19,
            name: "reciprocity",
            asked: "a closed room takes what its lamp sends, to 1 % at a coarse and 0.1 % at a fine ε; A_r·F(r←s) = A_s·F(s←r) on all links",
            limit: Some("V by few rays is right in the mean only, and is chosen after a look"),
            measure: reciprocity,
        },
        Row {
            number: 24,
            name: "frozen-links",
            asked: "links first judged in the dark are judged again: one fine solve and one refined from a coarse one agree; indirect light as the path tracer has it, to 3 %",
            limit: Some("at ε = 1e-3 the floor below the shelf is lit by clusters that see past it"),
            measure: frozen_links,
        },
    ]
}

/// Boxes and plates pressed together, a few of them emitting: what makes rows large.
fn dense_scene(reflectance: f32) -> Scene {
    let mut scene = empty_room(reflectance, 0.0);
    let white = scene.materials[0].clone();
    let lamp = scene.add_material("lamp", white.reflectance, Vec3::ONE);
    let pile = scene.add_group("pile", GroupId(0));
    for index in 0..12_u16 {
        let (x, y) = (f32::from(index % 4), f32::from(index / 4));
        let corner = vec3(0.2 + 0.15 * x, 0.2 + 0.2 * y, 0.3 + 0.011 * x);
        let of = if index % 5 == 0 { lamp } else { crate::scene::MaterialId(0) };
        add_box(&mut scene, (corner, corner + vec3(0.149, 0.199, 0.3)), false, (of, pile));
    }
    scene
}

fn divergence() -> Result<Vec<Check>, SolverError> {
    let mut checks = Vec::new();
    let scenes = [
        ("empty furnace", empty_room(0.99, 1.0)),
        ("furnished furnace", furnished_room(0.95, 1.0)),
        ("lamp room", lamp_room()),
        ("pile, ρ = 0.99", dense_scene(0.99)),
    ];
    for (name, scene) in scenes {
        for (mode, epsilon) in at_each([1.0, 1e-2]) {
            for model in [ClusterModel::Oriented, ClusterModel::Isotropic] {
                let is_clustered = mode != ClusteringMode::None;
                if model == ClusterModel::Isotropic && !(is_clustered && epsilon == 1e-2) {
                    continue;
                }
                let found = audit(
                    solve(&scene, SolverParams { cluster_model: model, ..params(mode, epsilon) })?.link_solution(),
                );
                let what = format!("{name}, {mode:?}, {model:?}, ε = {epsilon:e}");
                // f32 sums of many links.
                let at_most_one =
                    |what: String, found: f64| Check { allowed: 1e-4, ..Check::at_most(what, 1.0, found) };
                let (row, _) = found.largest_and_mean(&found.rows);
                let (column, mean) = found.largest_and_mean(&found.columns);
                checks.push(at_most_one(format!("B / bound, {what}"), found.largest_radiosity));
                checks.push(at_most_one(format!("power / bound, {what}"), found.power));
                checks.push(at_most_one(format!("largest row, {what}"), row).known_to(0.251));
                checks.push(at_most_one(format!("largest column, {what}"), column).known_to(3.5));
                checks.push(at_most_one(format!("mean column, {what}"), mean).known_to(0.02));
            }
        }
    }
    Ok(checks)
}

fn reciprocity() -> Result<Vec<Check>, SolverError> {
    let mut checks = Vec::new();
    for mode in MODES {
        for (epsilon, allowed) in [(1e-3, 0.01), (1e-4, 1e-3)] {
            let solved = solve(&lamp_room(), params(mode, epsilon))?;
            let gap = power_balance(&solved, 1 << 16, 7).relative_gap();
            let check = Check::near(format!("share missing, {mode:?}, ε = {epsilon:e}"), 0.0, gap, allowed);
            checks.push(check.known_to(0.014));
            checks.push(Check::near(
                format!("A_r·F(r←s) / A_s·F(s←r), {mode:?}, ε = {epsilon:e}"),
                1.0,
                worst_ratio(&solved),
                1e-4,
            ));
        }
    }
    Ok(checks)
}

/// Of all links between patches that are stored in both directions, the ratio of their exchanges
/// that is farthest from 1.
fn worst_ratio(solved: &Solver) -> f64 {
    let hierarchy = solved.hierarchy();
    let mut exchanges = FxHashMap::<(ElementId, ElementId), f64>::default();
    let is_patch = |id: ElementId| !hierarchy.element(id).is_cluster();
    for receiver in hierarchy.ids().filter(|id| is_patch(*id)) {
        for link in solved.links().of(receiver).iter().filter(|link| is_patch(link.source())) {
            let exchange = f64::from(hierarchy.element(receiver).area) * f64::from(link.form_factor);
            if exchange > 0.0 {
                exchanges.insert((receiver, link.source()), exchange);
            }
        }
    }
    let ratio = |(&(receiver, source), exchange): (&(ElementId, ElementId), &f64)| {
        exchanges.get(&(source, receiver)).map(|other| exchange / other)
    };
    let far = |ratio: &f64| (ratio - 1.0).abs();
    exchanges.iter().filter_map(ratio).max_by(|a, b| far(a).total_cmp(&far(b))).unwrap_or(1.0)
}

/// A room lit by its ceiling alone, on which a lamp shines that nothing else sees.
fn indirect_room() -> Scene {
    let mut scene = Scene::new("indirect");
    let grey = scene.add_material("grey", Vec3::splat(0.6), Vec3::ZERO);
    let lamp = scene.add_material("lamp", Vec3::splat(0.6), Vec3::splat(20.0));
    add_box(&mut scene, (Vec3::ZERO, vec3(2.0, 2.0, 1.5)), true, (grey, GroupId(0)));
    let shelf = scene.add_group("shelf", GroupId(0));
    add_box(&mut scene, (vec3(0.6, 0.6, 1.0), vec3(1.4, 1.4, 1.02)), false, (grey, shelf));
    scene.add_quad(level([0.8, 1.2], [0.8, 1.2], 1.03, true), lamp, shelf);
    scene
}

fn frozen_links() -> Result<Vec<Check>, SolverError> {
    let scene = indirect_room();
    let readings = vec![mean("floor", vec![2], 1.0), mean("walls", vec![0, 1, 3, 4], 1.0)];
    let case = Case { name: "indirect", source: "paths", scene: scene.clone(), readings };
    let truths = by_reference(&case, 32, 1);
    let mut checks = Vec::new();
    for mode in MODES {
        for epsilon in [1e-3, 1e-4] {
            let found = crate::measure::accuracy::by_solver(&case, params(mode, epsilon))?;
            for ((reading, truth), found) in case.readings.iter().zip(&truths).zip(found) {
                let what = format!("E of the {}, {mode:?}, ε = {epsilon:e}", reading.label);
                let check = Check::within(what, truth.value, found, 0.03);
                checks.push(check.known_where(epsilon > 1e-4, 0.06 * truth.value));
            }
        }
        // At once, and by way of a coarse solution whose links are judged again.
        let at_once = solve(&scene, params(mode, 1e-4))?;
        let mut in_steps = Solver::new(
            Arc::new(scene.clone()),
            Arc::new(Occluders::new(&scene)),
            SolverParams { epsilon: Epsilon::Relative(1e-2), ..params(mode, 1e-2) },
            0,
        )?;
        for epsilon in [1e-2, 1e-3, 1e-4] {
            in_steps.set_params(params(mode, epsilon))?;
            in_steps.run(&CancelToken::new());
        }
        let off = difference(&in_steps, &at_once);
        checks.push(Check::at_most(format!("RMS of B in steps beside at once, {mode:?}"), 0.01, off));
    }
    Ok(checks)
}
