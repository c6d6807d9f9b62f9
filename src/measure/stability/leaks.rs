//! Rows 4–6, 11 and 21: light where there should be none, shadow where there should be none, and
//! small things between.

use glam::{DVec3, Vec3, vec3};

use super::measure::{MODES, at_each, leaves, params, received, solve};
use super::scenes::add_box;
use super::{Check, Row};
use crate::geometry::orient;
use crate::measure::accuracy::by_solver;
use crate::measure::accuracy::cases::{Case, corners, lamp_and_black, level, point};
use crate::measure::accuracy::closed_forms::{Span, parallel_exchange, point_to_polygon};
use crate::scene::{GroupId, MaterialId, Scene, Sides};
use crate::solve::{ClusteringMode, Solver, SolverError, SolverParams};

pub(super) fn rows() -> Vec<Row> {
    vec![
        Row {
            number: 4,
            name: "light-leak",
            asked: "a dark room behind a partition on one shared floor gets none of the lit room's light, to 1e-6",
            limit: None,
            measure: light_leak,
        },
        Row {
            number: 5,
            name: "shadow-leak",
            asked: "the wall around a thin panel is lit as without it, to 5 %",
            limit: Some("leaves that the panel's edge cuts are darker, and vertices beside them take a share of that"),
            measure: shadow_leak,
        },
        Row {
            number: 6,
            name: "small-blocker",
            asked: "a table leg of 5 cm takes its light from a floor of 4 m, to 20 %",
            limit: Some("at ε = 1e-3 the few rays of a link miss a thing of a hundredth of its width"),
            measure: small_blocker,
        },
        Row {
            number: 11,
            name: "wall-in-a-cluster",
            asked: "a wall of 4 × 3 m within a cluster lets nothing through, to 1e-6",
            limit: Some(
                "where the wall and things on both of its sides are one group, a coarse ε lights the group as one",
            ),
            measure: wall_in_a_cluster,
        },
        Row {
            number: 21,
            name: "slits",
            asked: "a slit of 1 cm and a peephole of 2 cm in a wall of 4 m let their closed form through, to 10 %",
            limit: Some(
                "pairs that no ray came through are dropped; what a few rays in a hundred thousand would bring is lost",
            ),
            measure: slits,
        },
    ]
}

/// Two closed rooms of 1 m side by side, the left one lit, with one floor, one ceiling and long
/// walls for both; the partition stands where no split of the floor runs, 2 cm thick or a sheet
/// without any. As the program takes scenes: [`orient::apply`].
fn two_rooms(is_sheet: bool) -> Scene {
    let mut scene = Scene::new("two rooms");
    let grey = scene.add_material("grey", Vec3::splat(0.5), Vec3::ZERO);
    let lamp = scene.add_material("lamp", Vec3::ZERO, Vec3::splat(10.0));
    add_box(&mut scene, (Vec3::ZERO, vec3(2.1, 1.0, 1.0)), true, (grey, GroupId(0)));
    let partition = scene.add_group("partition", GroupId(0));
    if is_sheet {
        let corners = [[0.0, 0.0], [0.0, 1.0], [1.0, 1.0], [1.0, 0.0]].map(|[y, z]| vec3(1.03, y, z));
        scene.add_quad(corners, grey, partition);
        scene.add_quad([corners[0], corners[3], corners[2], corners[1]], grey, partition);
    } else {
        add_box(&mut scene, (vec3(1.01, 0.0, 0.0), vec3(1.03, 1.0, 1.0)), false, (grey, partition));
    }
    scene.add_quad(level([0.3, 0.6], [0.4, 0.7], 0.99, false), lamp, GroupId(0));
    orient::apply(scene, Sides::Front).0
}

/// Mean irradiance of the leaves wholly beyond `x` over that of all leaves, and the brightest of
/// the shown vertices there over the same.
fn beyond(solver: &mut Solver, x: f32) -> (f64, f64) {
    let snapshot = solver.snapshot();
    let mesh = &snapshot.mesh;
    // From where to where each leaf reaches; a leaf in the plane of a sheet lies beyond it no more
    // than before it.
    let mut reach = vec![[f32::INFINITY, f32::NEG_INFINITY]; mesh.leaves.len()];
    let at = |vertex: u32| mesh.positions[vertex as usize][0];
    for (triangle, &leaf) in mesh.triangles.iter().zip(&mesh.triangle_leaf) {
        let [from, to] = &mut reach[leaf as usize];
        triangle.iter().for_each(|&vertex| (*from, *to) = (from.min(at(vertex)), to.max(at(vertex))));
    }
    let (mut dark, mut all) = ((0.0, 0.0), (0.0, 0.0));
    for ((leaf, irradiance), [from, to]) in mesh.leaves.iter().zip(&snapshot.leaf_irradiance).zip(&reach) {
        let (area, power) = (f64::from(leaf.reachable_area), f64::from(leaf.reachable_area * irradiance[0]));
        all = (all.0 + area, all.1 + power);
        if *from >= x && *to > x {
            dark = (dark.0 + area, dark.1 + power);
        }
    }
    let mean = |(area, power): (f64, f64)| if area > 0.0 { power / area } else { 0.0 };
    // Of leaves that lie on both sides as well: what a person sees on the floor of the dark room
    // beside the partition.
    let shown = mesh.triangles.iter().zip(&mesh.triangle_leaf).filter(|(_, leaf)| reach[**leaf as usize][1] > x);
    let vertices = shown.flat_map(|(triangle, _)| triangle).filter(|vertex| at(**vertex) >= x);
    let brightest =
        vertices.map(|&vertex| f64::from(snapshot.vertex_irradiance[vertex as usize][0])).fold(0.0, f64::max);
    (mean(dark) / mean(all), brightest / mean(all))
}

/// Every mode at ε = 1e-4, and an error asked for.
fn settings() -> Vec<(String, SolverParams)> {
    let gather = SolverParams { error: Some(0.05), ..params(ClusteringMode::Adaptive, 1e-4) };
    let by_threshold = MODES.map(|mode| (format!("{mode:?}, ε = 1e-4"), params(mode, 1e-4)));
    by_threshold.into_iter().chain([("--error 0.05".to_owned(), gather)]).collect()
}

fn light_leak() -> Result<Vec<Check>, SolverError> {
    let mut checks = Vec::new();
    for (wall, scene) in [("wall", two_rooms(false)), ("sheet", two_rooms(true))] {
        for (what, params) in settings() {
            let (dark, brightest) = beyond(&mut solve(&scene, params)?, 1.03);
            let what = [("mean of the dark room / of all", dark), ("brightest vertex / mean of all", brightest)]
                .map(|(of, found)| Check::near(format!("{of}, {wall}, {what}"), 0.0, found, 1e-6));
            checks.extend(what);
        }
    }
    Ok(checks)
}

fn shadow_leak() -> Result<Vec<Check>, SolverError> {
    let mut scene = Scene::new("panel");
    let (emitter, black) = lamp_and_black(&mut scene, 1.0);
    scene.add_quad(level([0.0, 2.0], [0.0, 2.0], 2.0, false), emitter, GroupId(0));
    scene.add_quad(level([0.0, 2.0], [0.0, 2.0], 0.0, true), black, GroupId(0));
    let panel = scene.add_group("panel", GroupId(0));
    let (low, high) = (0.713_f32, 1.229);
    add_box(&mut scene, (vec3(low, low, 0.0), vec3(high, high, 0.02)), false, (black, panel));
    let lamp = corners(&scene, 0);
    // 3 and 8 cm off each edge the lamp stands wholly above the panel's rim.
    let middle = 0.5 * (low + high);
    let around = [(low, -1.0, true), (high, 1.0, true), (low, -1.0, false), (high, 1.0, false)];
    let places = around.into_iter().flat_map(|(edge, outwards, is_x)| {
        [0.03, 0.08].map(|away| {
            let off = edge + outwards * away;
            if is_x { vec3(off, middle, 0.0) } else { vec3(middle, off, 0.0) }
        })
    });
    let reading = |position: Vec3| {
        let truth = point_to_polygon(position.as_dvec3(), DVec3::Z, &lamp);
        point(&format!("({:.2}, {:.2})", position.x, position.y), 1, position, truth)
    };
    let readings = places.map(reading).collect();
    let case = Case { name: "panel on a wall", source: "Lambert", scene, readings };
    let mut checks = Vec::new();
    for (what, params) in settings() {
        let known = if params.error.is_some() { 0.05 } else { 0.075 };
        for (reading, found) in case.readings.iter().zip(by_solver(&case, params)?) {
            let check = Check::within(format!("{}, {what}", reading.label), reading.truth, found, 0.05);
            checks.push(check.known_within(known));
        }
    }
    Ok(checks)
}

/// Middle of the lamp, m.
const LAMP: Vec3 = vec3(1.2, 2.0, 2.5);

/// A floor of 4 m, a lamp of 20 cm and, where wanted, a leg of 5 × 5 × 70 cm on the floor, whose
/// shadow stays on it.
fn floor_with_leg(with_leg: bool) -> Scene {
    let mut scene = Scene::new("leg");
    let (emitter, black) = lamp_and_black(&mut scene, 25.0);
    let about = |middle: f32| [f64::from(middle) - 0.1, f64::from(middle) + 0.1];
    scene.add_quad(level(about(LAMP.x), about(LAMP.y), f64::from(LAMP.z), false), emitter, GroupId(0));
    scene.add_quad(level([0.0, 4.0], [0.0, 4.0], 0.0, true), black, GroupId(0));
    if with_leg {
        let leg = scene.add_group("leg", GroupId(0));
        add_box(&mut scene, (vec3(2.0, 2.0, 0.0), vec3(2.05, 2.05, 0.7)), false, (black, leg));
    }
    scene
}

fn small_blocker() -> Result<Vec<Check>, SolverError> {
    let (with_leg, without) = (floor_with_leg(true), floor_with_leg(false));
    // All light that meets the convex leg would have met the floor: power from 16 × 16 points of
    // the lamp to its faces.
    let steps = 16;
    let at = |step: usize, middle: f32| f64::from(middle) - 0.1 + 0.2 * (step as f64 + 0.5) / steps as f64;
    let faces = || with_leg.polygons[2..].iter().map(|face| (with_leg.corner_positions(face).0, with_leg.normal(face)));
    let mut blocked = 0.0;
    for (i, j) in (0..steps * steps).map(|step| (step / steps, step % steps)) {
        let from = DVec3::new(at(i, LAMP.x), at(j, LAMP.y), f64::from(LAMP.z));
        for (corners, normal) in faces() {
            let corners = corners.map(Vec3::as_dvec3);
            if normal.as_dvec3().dot(from - corners[0]) > 0.0 {
                blocked += point_to_polygon(from, DVec3::NEG_Z, &corners) / (steps * steps) as f64;
            }
        }
    }
    let mut checks = Vec::new();
    for (mode, epsilon) in at_each([1e-3, 1e-4]) {
        let params = params(mode, epsilon);
        let missing = received(&solve(&without, params)?, 1) - received(&solve(&with_leg, params)?, 1);
        let check = Check::within(format!("W missing, {mode:?}, ε = {epsilon:e}"), blocked, missing, 0.2);
        checks.push(check.known_where(epsilon > 1e-4, 0.45 * blocked));
    }
    Ok(checks)
}

/// A room of 4 × 8 × 3 m, each half with its own faces, cut by a wall that stands in a cluster with
/// small things around it.
fn wall_in_a_cluster() -> Result<Vec<Check>, SolverError> {
    let mut scene = Scene::new("wall");
    let grey = scene.add_material("grey", Vec3::splat(0.7), Vec3::ZERO);
    let lamp = scene.add_material("lamp", Vec3::ZERO, Vec3::splat(100.0));
    let rooms = [(vec3(0.0, 0.0, 0.0), vec3(4.0, 4.0, 3.0)), (vec3(0.0, 4.0, 0.0), vec3(4.0, 8.0, 3.0))];
    let middle = scene.add_group("middle", GroupId(0));
    for (index, corners) in rooms.into_iter().enumerate() {
        let first = scene.polygons.len();
        add_box(&mut scene, corners, true, (grey, GroupId(0)));
        // The side of each room that is the wall between them.
        let wall = first + if index == 0 { 4 } else { 1 };
        scene.polygons[wall].group = middle;
    }
    for index in 0..24_u32 {
        let place = |step: f32| (0.37 + step * index as f32).fract();
        let corner = vec3(3.8 * place(0.618), 2.1 + 3.6 * place(0.755), 2.8 * place(0.57));
        if (corner.y - 4.0).abs() > 0.25 {
            add_box(&mut scene, (corner, corner + 0.1), false, (grey, middle));
        }
    }
    scene.add_quad(level([1.5, 2.5], [0.6, 1.6], 2.95, false), lamp, GroupId(0));
    let is_dark: Vec<bool> = scene
        .polygons
        .iter()
        .map(|polygon| {
            let (corners, count) = scene.corner_positions(polygon);
            let inside = corners[..count].iter().sum::<Vec3>() / count as f32 + 0.01 * scene.normal(polygon);
            inside.y > 4.0
        })
        .collect();
    let mut checks = Vec::new();
    for (mode, epsilon) in at_each([0.3, 1e-2, 1e-3]) {
        let solved = solve(&scene, params(mode, epsilon))?;
        let hierarchy = solved.hierarchy();
        let (mut dark, mut all) = (0.0, 0.0);
        for (leaf, polygon) in leaves(hierarchy) {
            let power = f64::from(hierarchy.element(leaf).area * solved.irradiance()[leaf.index()].x);
            all += power;
            dark += if is_dark[polygon as usize] { power } else { 0.0 };
        }
        let what = format!("dark share of the power, {mode:?}, ε = {epsilon:e}");
        let check = Check::near(what, 0.0, dark / all, 1e-6);
        let known = if epsilon > 0.1 { 0.11 } else { 1e-5 };
        checks.push(check.known_where(mode == ClusteringMode::Groups && epsilon > 1e-3, known));
    }
    Ok(checks)
}

/// A wall of 4 × 4 m with a hole, a lamp of 1 m above it and a floor just below that takes all that
/// comes through the hole and nothing that passes the wall's rim.
fn wall_with_hole(x: Span, y: Span) -> (Scene, f64) {
    let mut scene = Scene::new("hole");
    let (emitter, black) = lamp_and_black(&mut scene, 1.0);
    let (whole, lamp): (Span, Span) = ([0.0, 4.0], [1.5, 2.5]);
    scene.add_quad(level(lamp, lamp, 2.0, false), emitter, GroupId(0));
    scene.add_quad(level([-0.2, 4.2], [-0.2, 4.2], 0.0, true), black, GroupId(0));
    let wall = |scene: &mut Scene, x: Span, y: Span, material: MaterialId| {
        if x[1] > x[0] && y[1] > y[0] {
            scene.add_quad(level(x, y, 0.5, true), material, GroupId(0));
        }
    };
    wall(&mut scene, [whole[0], x[0]], whole, black);
    wall(&mut scene, [x[1], whole[1]], whole, black);
    wall(&mut scene, x, [whole[0], y[0]], black);
    wall(&mut scene, x, [y[1], whole[1]], black);
    let truth = parallel_exchange(lamp, lamp, x, y, 1.5);
    (scene, truth)
}

fn slits() -> Result<Vec<Check>, SolverError> {
    let mut checks = Vec::new();
    let holes = [("slit", [1.9, 1.91], [0.5, 3.5]), ("peephole", [1.9, 1.92], [2.2, 2.22])];
    for (what, x, y) in holes {
        let (scene, truth) = wall_with_hole(x, y);
        for (mode, epsilon) in at_each([1e-3, 1e-4]) {
            let found = received(&solve(&scene, params(mode, epsilon))?, 1);
            let check = Check::within(format!("{what}, W, {mode:?}, ε = {epsilon:e}"), truth, found, 0.1);
            let known = if what == "slit" && epsilon < 1e-3 { 0.6 } else { 1.0 };
            checks.push(check.known_within(known));
        }
    }
    Ok(checks)
}
