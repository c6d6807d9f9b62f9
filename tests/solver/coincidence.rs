//! Faces that lie on each other: two-sided exports, rooms that share a wall, faces that a file
//! draws twice.
//!
//! Truth: the same scene with each face once, and the furnace B = B_e / (1 − ρ). What is compared
//! goes through [`orient::apply`], as every scene does.

use std::sync::Arc;

use glam::{Vec3, vec3};
use selflink::base::cancel::CancelToken;
use selflink::geometry::orient;
use selflink::hierarchy::ClusteringMode;
use selflink::read::probe::Probe;
use selflink::scene::{GroupId, MaterialId, Scene, Sides};
use selflink::solve::{Epsilon, Reconstruct, Snapshot, Solver, SolverParams};

use super::support::{MODES, add_box, empty_room, params};

/// A room of 5 × 3 × 4 m, ρ = 0.7, with a lamp of 1 m² that shines down from 0.1 m below the
/// ceiling.
fn room() -> Scene {
    let mut scene = Scene::new("room");
    let wall = scene.add_material("wall", Vec3::splat(0.7), Vec3::ZERO);
    let lamp = scene.add_material("lamp", Vec3::ZERO, Vec3::splat(30.0));
    add_box(&mut scene, (Vec3::ZERO, vec3(5.0, 3.0, 4.0)), true, (wall, GroupId(0)));
    let corners = [[2.0, 1.5], [3.0, 1.5], [3.0, 2.5], [2.0, 2.5]].map(|[x, z]| vec3(x, 2.9, z));
    scene.add_quad(corners, lamp, GroupId(0));
    scene
}

/// Points of floor, ceiling and two walls, with their normals.
const POINTS: [(Vec3, Vec3); 4] = [
    (vec3(0.5, 0.0, 0.5), Vec3::Y),
    (vec3(1.0, 3.0, 1.0), Vec3::NEG_Y),
    (vec3(5.0, 1.5, 2.0), Vec3::NEG_X),
    (vec3(2.5, 1.0, 0.0), Vec3::Z),
];

/// Adds each of the first six faces once more, wound the other way: as it is, or as two triangles.
fn add_twins(scene: &mut Scene, as_triangles: bool) {
    for index in 0..6 {
        let twin = scene.polygons[index].flipped();
        let [a, b, c, d] = scene.corner_positions(&twin).0;
        if as_triangles {
            scene.add_triangle([b, c, d], twin.material, twin.group);
            scene.add_triangle([b, d, a], twin.material, twin.group);
        } else {
            scene.add_quad([a, b, c, d], twin.material, twin.group);
        }
    }
}

fn solved(scene: Scene, sides: Sides, params: SolverParams) -> (Arc<Scene>, Snapshot) {
    let (scene, occluders) = orient::apply(scene, sides);
    let scene = Arc::new(scene);
    let mut solver = Solver::new(scene.clone(), Arc::new(occluders), params, 0).expect("usable parameters");
    assert!(solver.run(&CancelToken::new()), "nobody cancels");
    (scene, solver.snapshot())
}

fn irradiances(snapshot: &Snapshot, points: &[(Vec3, Vec3)]) -> Vec<f32> {
    let probe = Probe::new(&snapshot.mesh, &snapshot.vertex_irradiance, &snapshot.vertex_radiosity);
    points.iter().map(|(point, normal)| probe.at(*point, *normal).expect("a point of a face").irradiance.x).collect()
}

/// Ways to solve: by clusters of each kind, and by the error that is asked for.
fn ways() -> Vec<SolverParams> {
    let gather = SolverParams { reconstruct: Reconstruct::Gather, ..params(ClusteringMode::Adaptive, 1e-2) };
    let mut ways = MODES.map(|mode| params(mode, 1e-3)).to_vec();
    ways.extend([gather, SolverParams { error: Some(0.05), ..SolverParams::default() }]);
    ways
}

/// Truth: a face that is there once more, wound the other way, sends nothing into the room and
/// takes nothing from it: 2 %, of which most is that a few rays fall otherwise. With both sides
/// bright it has no area of its own.
#[test]
fn twins_change_nothing() {
    for sides in [Sides::Front, Sides::Auto, Sides::Both] {
        for way in ways() {
            let (plain, single) = solved(room(), sides, way);
            let single = irradiances(&single, &POINTS);
            for as_triangles in [false, true] {
                let mut scene = room();
                add_twins(&mut scene, as_triangles);
                let (scene, double) = solved(scene, sides, way);
                let double = irradiances(&double, &POINTS);
                for (single, double) in single.iter().zip(&double) {
                    let allowed = 0.02 * single;
                    assert!(
                        (single - double).abs() <= allowed,
                        "{sides:?}, {way:?}, triangles {as_triangles}: E = {double} instead of {single}"
                    );
                }
                let area = |scene: &Scene| scene.polygons.iter().map(|polygon| scene.area(polygon)).sum::<f32>();
                if sides == Sides::Both {
                    assert!(
                        (area(&scene) - area(&plain)).abs() < 1e-3,
                        "{} m² instead of {}",
                        area(&scene),
                        area(&plain)
                    );
                }
            }
        }
    }
}

/// Truth: no light gets through a wall, whichever part of it two rooms share: the same plane, with
/// the other room as large, smaller and off to the side, or larger.
#[test]
fn what_shares_a_wall_shares_no_light() {
    let neighbours = [
        (vec3(5.0, 0.0, 0.0), vec3(10.0, 3.0, 4.0)),
        (vec3(5.0, 0.5, 1.0), vec3(7.0, 2.0, 6.0)),
        (vec3(5.0, -1.0, -2.0), vec3(9.0, 4.0, 5.0)),
        (vec3(0.0, -3.0, 0.0), vec3(5.0, 0.0, 4.0)),
    ];
    for way in ways() {
        let (_, alone) = solved(room(), Sides::Front, way);
        let alone = irradiances(&alone, &POINTS);
        for (lower, upper) in neighbours {
            let mut scene = room();
            add_box(&mut scene, (lower, upper), true, (MaterialId(0), GroupId(0)));
            for sides in [Sides::Front, Sides::Auto] {
                let (_, snapshot) = solved(scene.clone(), sides, way);
                for (alone, found) in alone.iter().zip(irradiances(&snapshot, &POINTS)) {
                    // As far off as a solve with other clusters is.
                    assert!((alone - found).abs() <= 0.05 * alone, "{way:?}, {lower}: E = {found} instead of {alone}");
                }
                let middle = 0.5 * (lower + upper);
                let dark = [0, 1, 2].map(|axis| {
                    let mut inward = Vec3::ZERO;
                    inward[axis] = 1.0;
                    (middle.with_axis(axis, lower[axis]), inward)
                });
                let dark = irradiances(&snapshot, &dark);
                // A gather starts from what coarse links found, which lets 1e-5 through, and
                // forgets it sweep by sweep.
                let most = if way.reconstruct == Reconstruct::Gather || way.error.is_some() { 1e-4 } else { 0.0 };
                assert!(dark.iter().all(|light| *light <= most), "{way:?}, {sides:?}, room from {lower}: E = {dark:?}");
            }
        }
    }
}

trait WithAxis {
    fn with_axis(self, axis: usize, value: f32) -> Self;
}

impl WithAxis for Vec3 {
    fn with_axis(mut self, axis: usize, value: f32) -> Self {
        self[axis] = value;
        self
    }
}

/// Furnaces of 1 m with faces drawn twice, by how they are.
fn furnaces() -> Vec<(&'static str, Scene)> {
    let (grey, group) = (MaterialId(0), GroupId(0));
    let floor = |scene: &Scene| {
        let floor = scene.polygons.iter().find(|polygon| scene.normal(polygon).y > 0.5).expect("a floor");
        scene.corner_positions(floor).0
    };
    let at = |x: f32, z: f32| vec3(x, 0.0, z);
    let mut all = Vec::new();
    let mut add = |name: &'static str, change: &dyn Fn(&mut Scene, [Vec3; 4])| {
        let mut scene = empty_room(0.5, 1.0);
        let corners = floor(&scene);
        change(&mut scene, corners);
        all.push((name, scene));
    };
    add("the floor once more", &|scene, corners| scene.add_quad(corners, grey, group));
    add("the floor in two triangles", &|scene, [a, b, c, d]| {
        scene.add_triangle([a, b, c], grey, group);
        scene.add_triangle([a, c, d], grey, group);
    });
    add("the floor from another corner, in a fan around its middle", &|scene, [a, b, c, d]| {
        let middle = 0.25 * (a + b + c + d);
        for [from, to] in [[a, b], [b, c], [c, d], [d, a]] {
            scene.add_triangle([from, to, middle], grey, group);
        }
    });
    add("a rug and a mat that overlap", &|scene, _| {
        scene.add_quad([at(0.2, 0.7), at(0.6, 0.7), at(0.6, 0.2), at(0.2, 0.2)], grey, group);
        scene.add_quad([at(0.4, 0.9), at(0.9, 0.9), at(0.9, 0.5), at(0.4, 0.5)], grey, group);
    });
    add("a mesh of 200 triangles over most of it", &|scene, _| {
        let knot = |x: u32, z: u32| at(0.05 + 0.09 * x as f32, 0.05 + 0.086 * z as f32);
        for (x, z) in (0..100).map(|cell| (cell % 10, cell / 10)) {
            let [a, b, c, d] = [knot(x, z), knot(x, z + 1), knot(x + 1, z + 1), knot(x + 1, z)];
            scene.add_triangle([a, b, c], grey, group);
            scene.add_triangle([a, c, d], grey, group);
        }
    });
    all
}

/// Truth: the faces of a cube of 1 m have 6 m², and it glows with B = 2, to the noise of few rays.
/// Turned askew too, where every corner is rounded; as they are, turned or bright on both sides.
#[test]
fn what_is_drawn_twice_counts_once() {
    let turn = glam::Quat::from_euler(glam::EulerRot::XYZ, 0.4, -0.9, 0.2);
    for (name, plain) in furnaces() {
        for is_turned in [false, true] {
            let mut scene = plain.clone();
            if is_turned {
                scene.vertices.iter_mut().for_each(|vertex| *vertex = turn * *vertex);
            }
            for sides in [Sides::Front, Sides::Auto, Sides::Both] {
                let what = format!("{name}, {sides:?}, turned {is_turned}");
                let way = params(ClusteringMode::None, 1e-3);
                let (scene, snapshot) = solved(scene.clone(), sides, way);
                let area: f32 = scene.polygons.iter().map(|polygon| scene.area(polygon)).sum();
                let whole = if sides == Sides::Both { 12.0 } else { 6.0 };
                assert!((area - whole).abs() < 1e-3, "{what}: {area} m²");
                assert!(scene.skipped.covered_faces > 0, "{what}: nothing is said");
                let inner = snapshot.mesh.leaves.iter().zip(&snapshot.leaf_irradiance);
                let brightest = inner.map(|(_, irradiance)| 1.0 + 0.5 * irradiance[0]).fold(0.0, f32::max);
                let points = [vec3(0.3, 0.0, 0.4), vec3(0.5, 0.0, 0.6)];
                let points =
                    points.map(|point| if is_turned { (turn * point, turn * Vec3::Y) } else { (point, Vec3::Y) });
                for found in irradiances(&snapshot, &points) {
                    assert!((found / 2.0 - 1.0).abs() < 0.02, "{what}: E = {found}");
                }
                assert!(brightest < 2.0 * 1.02, "{what}: B = {brightest}");
            }
        }
    }
}

/// Truth: of two faces in one plane the smaller is seen, so a lamp flush with the ceiling shines,
/// once: 1 m² of 30 W/m².
#[test]
fn a_lamp_flush_with_the_ceiling_shines_once() {
    let mut scene = room();
    let lamp = scene.polygons.pop().expect("the lamp");
    let flush = scene.corner_positions(&lamp).0.map(|corner| corner.with_axis(1, 3.0));
    let [a, b, c, d] = flush;
    scene.add_quad(flush, lamp.material, lamp.group);
    scene.add_triangle([a, b, c], lamp.material, lamp.group);
    scene.add_triangle([a, c, d], lamp.material, lamp.group);
    let way = SolverParams { epsilon: Epsilon::Relative(1e-2), ..SolverParams::default() };
    let (scene, _) = solved(scene, Sides::Front, way);
    assert!((scene.emitted_power().x - 30.0).abs() < 1e-3, "{} W", scene.emitted_power().x);
    assert_eq!(scene.skipped.covered_faces, 2, "the ceiling and the lamp that is whole");
}
