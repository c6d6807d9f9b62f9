//! Rows 8–10 and 13: what clusters do to light that they should not.

use glam::{Vec3, vec3};

use super::matrix::{self, Fineness};
use super::measure::{at_each, of_polygons, params, received, solve};
use super::scenes::add_box;
use super::{Check, Row};
use crate::base::random::{hash64, r2_sequence};
use crate::geometry::Occluders;
use crate::hierarchy::ClusteringMode;
use crate::measure::accuracy::by_reference;
use crate::measure::accuracy::cases::{Case, lamp_and_black, level, mean};
use crate::measure::accuracy::closed_forms::{Span, parallel_exchange, perpendicular_exchange};
use crate::scene::{GroupId, Scene};
use crate::solve::{SolverError, SolverParams};
use crate::transport::{ClusterModel, Push};

pub(super) fn rows() -> Vec<Row> {
    vec![
        Row {
            number: 8,
            name: "lit-backs",
            asked: "of squares in a cluster those that face a lamp get their closed form, to 2 %, their backs nothing",
            limit: Some(
                "a coarse link to a cluster has its form factor from a dozen random points; a deferred push, the paper's, lights backs",
            ),
            measure: lit_backs,
        },
        Row {
            number: 9,
            name: "dense-cluster",
            asked: "a stack of plates takes no more than the power that meets its outline, to 2 %",
            limit: None,
            measure: dense_cluster,
        },
        Row {
            number: 10,
            name: "extinction",
            asked: "a cloud of random sheets lets through what the path tracer finds, to 5 %",
            limit: Some("at ε = 1e-2 few rays decide for the whole cloud"),
            measure: extinction,
        },
        Row {
            number: 13,
            name: "overlapping-boxes",
            asked: "clusters that run through each other exchange what a matrix of all pairs says, to 3 %",
            limit: Some(
                "what clusters that overlap exchange at a coarse ε comes from few random points, and an octree of few polygons is coarse",
            ),
            measure: overlapping_boxes,
        },
    ]
}

const UNIT: Span = [0.0, 1.0];

/// Nine small squares side by side that face a lamp, and nine back to back with them.
fn tray() -> Scene {
    let mut scene = Scene::new("tray");
    let (lamp, black) = lamp_and_black(&mut scene, 1.0);
    scene.add_quad(level(UNIT, UNIT, 2.0, false), lamp, GroupId(0));
    let tray = scene.add_group("tray", GroupId(0));
    for (up, z) in [(true, 0.0), (false, -0.01)] {
        for (u, v) in (0..9).map(|piece| (piece / 3, piece % 3)) {
            let span = |place: i32| [f64::from(place) / 3.0, f64::from(place + 1) / 3.0];
            scene.add_quad(level(span(u), span(v), z, up), black, tray);
        }
    }
    scene
}

fn lit_backs() -> Result<Vec<Check>, SolverError> {
    let scene = tray();
    let truth = parallel_exchange(UNIT, UNIT, UNIT, UNIT, 2.0);
    let mut checks = Vec::new();
    let lit_and_dark = |params: SolverParams| -> Result<[f64; 2], SolverError> {
        let solved = solve(&scene, params)?;
        Ok([1..10, 10..19].map(|part| part.map(|polygon| received(&solved, polygon)).sum()))
    };
    for (mode, epsilon) in at_each([1.0, 1e-2, 1e-4]) {
        let [lit, dark] = lit_and_dark(params(mode, epsilon))?;
        let at = format!("{mode:?}, ε = {epsilon:e}");
        let check = Check::within(format!("faces, W, {at}"), truth, lit, 0.02);
        checks.push(check.known_where(epsilon > 1e-4, if epsilon < 1.0 { 0.06 * truth } else { 0.2 * truth }));
        checks.push(Check::near(format!("backs, W, {at}"), 0.0, dark, 1e-6 * truth));
    }
    // The paper's clusters at their plainest: a volume's cosine of ¼, and light handed down evenly.
    let plain = SolverParams { cluster_model: ClusterModel::Isotropic, ..params(ClusteringMode::Groups, 1.0) };
    for (what, push) in [("immediate", Push::Immediate), ("deferred", Push::Deferred)] {
        let [lit, dark] = lit_and_dark(SolverParams { push, ..plain })?;
        let check = Check::within(format!("faces, W, isotropic, {what} push, ε = 1"), truth, lit, 0.02);
        checks.push(check.known_within(0.8));
        let check = Check::near(format!("backs, W, isotropic, {what} push, ε = 1"), 0.0, dark, 1e-6 * truth);
        checks.push(check.known_where(push == Push::Deferred, 0.8 * truth));
    }
    Ok(checks)
}

/// Ten plates of 1 m one above the other, 2 cm apart, and a lamp of 1 m above.
fn dense_cluster() -> Result<Vec<Check>, SolverError> {
    let mut scene = Scene::new("plates");
    let (lamp, black) = lamp_and_black(&mut scene, 1.0);
    let (plates, gap, height) = (10, 0.02, 2.0);
    scene.add_quad(level(UNIT, UNIT, height, false), lamp, GroupId(0));
    let stack = scene.add_group("stack", GroupId(0));
    for plate in 0..plates {
        scene.add_quad(level(UNIT, UNIT, gap * f64::from(plate), true), black, stack);
    }
    // The outline: the top, and four sides between the lowest and the highest plate.
    let top = gap * f64::from(plates - 1);
    let above = height - top;
    let side = perpendicular_exchange(UNIT, UNIT, [above, height], UNIT);
    let outline = parallel_exchange(UNIT, UNIT, UNIT, UNIT, above) + 4.0 * side;
    let mut checks = Vec::new();
    for (mode, epsilon) in at_each([1.0, 0.1, 1e-2, 1e-4]) {
        let solved = solve(&scene, params(mode, epsilon))?;
        let taken: f64 = (1..=plates as u32).map(|plate| received(&solved, plate)).sum();
        checks.push(Check {
            allowed: 0.02 * outline,
            ..Check::at_most(format!("W, {mode:?}, ε = {epsilon:e}"), outline, taken)
        });
    }
    Ok(checks)
}

/// 150 random sheets of 12 cm in a cube of 1 m between a lamp and a floor.
fn extinction() -> Result<Vec<Check>, SolverError> {
    let mut scene = Scene::new("sheets");
    let (lamp, black) = lamp_and_black(&mut scene, 1.0);
    scene.add_quad(level(UNIT, UNIT, 1.3, false), lamp, GroupId(0));
    scene.add_quad(level(UNIT, UNIT, -0.3, true), black, GroupId(0));
    let cloud = scene.add_group("cloud", GroupId(0));
    for sheet in 0..150_u64 {
        let [x, y] = r2_sequence(hash64(3, 0), sheet as u32);
        let [z, around] = r2_sequence(hash64(3, 1), sheet as u32);
        let [height, _] = r2_sequence(hash64(3, 2), sheet as u32);
        let (sine, cosine) = (std::f32::consts::TAU * around).sin_cos();
        let flat = (1.0 - (2.0 * height - 1.0).powi(2)).sqrt();
        let (u, v) = vec3(flat * cosine, flat * sine, 2.0 * height - 1.0).any_orthonormal_pair();
        let (centre, u, v) = (vec3(x, y, z), 0.06 * u, 0.06 * v);
        scene.add_quad([centre - u - v, centre + u - v, centre + u + v, centre - u + v], black, cloud);
    }
    let case = Case { name: "sheets", source: "paths", scene, readings: vec![mean("floor", vec![1], 1.0)] };
    let truth = by_reference(&case, 64, 1)[0].value;
    let mut checks = Vec::new();
    for (mode, epsilon) in at_each([1e-2, 1e-3]) {
        let found = received(&solve(&case.scene, params(mode, epsilon))?, 1);
        let check = Check::within(format!("W on the floor, {mode:?}, ε = {epsilon:e}"), truth, found, 0.05);
        checks.push(check.known_where(epsilon > 1e-3, 0.09 * truth));
    }
    Ok(checks)
}

/// Two groups of small boxes, one of them emitting, mingled in one cube.
fn overlapping_boxes() -> Result<Vec<Check>, SolverError> {
    let mut scene = Scene::new("mingled");
    let grey = scene.add_material("grey", Vec3::splat(0.6), Vec3::ZERO);
    let lamp = scene.add_material("lamp", Vec3::splat(0.3), Vec3::ONE);
    let groups = [("bright", lamp), ("dark", grey)].map(|(name, of)| (scene.add_group(name, GroupId(0)), of));
    for index in 0..8_u32 {
        let (group, material) = groups[(index % 2) as usize];
        let [x, y] = r2_sequence(5, index);
        let [z, size] = r2_sequence(6, index);
        let corner = vec3(x, y, z);
        add_box(&mut scene, (corner, corner + 0.12 + 0.08 * size), false, (material, group));
    }
    let occluders = Occluders::new(&scene);
    let truth = matrix::radiosities(&scene, &occluders, Fineness { largest_part: 0.011, points: 8, looks: 16 });
    let is_dark = |polygon: &usize| scene.polygons[*polygon].material == grey;
    let dark: Vec<usize> = (0..scene.polygons.len()).filter(is_dark).collect();
    let power = |polygon: usize, radiosity: f64| f64::from(scene.area(&scene.polygons[polygon])) * radiosity;
    let wanted: f64 = dark.iter().map(|&polygon| power(polygon, truth[polygon].x)).sum();
    let mut checks = Vec::new();
    for (mode, epsilon) in at_each([1e-2, 1e-3, 1e-4]) {
        let solved = solve(&scene, params(mode, epsilon))?;
        let polygons = of_polygons(&solved);
        let found: f64 = dark.iter().map(|&polygon| power(polygon, polygons[polygon].1.x)).sum();
        let check = Check::within(format!("W of the dark boxes, {mode:?}, ε = {epsilon:e}"), wanted, found, 0.03);
        let is_coarse_octree = mode == ClusteringMode::Octree && epsilon > 1e-3;
        let known = if is_coarse_octree { 1.0 } else { 0.08 };
        checks.push(check.known_where(epsilon > 1e-4, known * wanted));
    }
    Ok(checks)
}
