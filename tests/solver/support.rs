//! Small scenes made in code, and short ways to solve them.

use std::sync::Arc;

use glam::{DVec3, Vec3};
use selflink::cancel::CancelToken;
use selflink::hierarchy::{ElementId, Hierarchy, Shape};
use selflink::scene::{GroupId, MaterialId, Scene};
use selflink::solver::{ClusteringMode, Epsilon, Link, Solver, SolverParams};
use selflink::visibility::Occluders;

/// Every way to build clusters.
pub const MODES: [ClusteringMode; 4] =
    [ClusteringMode::None, ClusteringMode::Octree, ClusteringMode::Groups, ClusteringMode::Adaptive];

/// The default parameters with these clusters and this relative ε.
pub fn params(clustering: ClusteringMode, epsilon: f64) -> SolverParams {
    SolverParams { clustering, epsilon: Epsilon::Relative(epsilon), ..SolverParams::default() }
}

/// A solver that has not started; records its rejections.
pub fn solver(scene: &Scene, params: SolverParams) -> Solver {
    let occluders = Arc::new(Occluders::new(scene));
    let mut solver = Solver::new(Arc::new(scene.clone()), occluders, params, 0).expect("usable parameters");
    solver.record_rejected();
    solver
}

/// A finished solve.
pub fn solve(scene: &Scene, params: SolverParams) -> Solver {
    let mut solver = solver(scene, params);
    assert!(solver.run(&CancelToken::new()), "nobody cancels");
    assert!(solver.stats().converged);
    solver
}

/// The same, with this many threads.
pub fn with_threads<T: Send>(threads: usize, work: impl FnOnce() -> T + Send) -> T {
    rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads are left").install(work)
}

/// Adds the six faces of a box, bright outside or (a room) inside.
pub fn add_box(scene: &mut Scene, (lower, upper): (Vec3, Vec3), bright_inside: bool, of: (MaterialId, GroupId)) {
    let corner = |index: usize| {
        let pick = |axis: usize| if index >> axis & 1 == 1 { upper[axis] } else { lower[axis] };
        Vec3::new(pick(0), pick(1), pick(2))
    };
    // Anticlockwise as seen from outside: x, y and z low, then high.
    let faces = [[0, 4, 6, 2], [0, 1, 5, 4], [0, 2, 3, 1], [1, 3, 7, 5], [2, 6, 7, 3], [4, 5, 7, 6]];
    for mut face in faces {
        if bright_inside {
            face.reverse();
        }
        scene.add_quad(face.map(corner), of.0, of.1);
    }
}

/// A closed room of 1 × 1 × 1 without anything in it.
pub fn empty_room(reflectance: f32, emission: f32) -> Scene {
    let mut scene = Scene::new("room");
    let material = scene.add_material("wall", Vec3::splat(reflectance), Vec3::splat(emission));
    add_box(&mut scene, (Vec3::ZERO, Vec3::ONE), true, (material, GroupId(0)));
    scene
}

/// Boxes of the furniture of [`furnished_room`], by group. They stand a little above the floor and off each other, so that
/// every bright side sees something.
const FURNITURE: [(&str, &[[f32; 6]]); 3] = [
    (
        "table",
        &[
            [0.15, 0.34, 0.15, 0.60, 0.37, 0.45],
            [0.17, 0.02, 0.17, 0.21, 0.32, 0.21],
            [0.54, 0.02, 0.17, 0.58, 0.32, 0.21],
            [0.17, 0.02, 0.39, 0.21, 0.32, 0.43],
            [0.54, 0.02, 0.39, 0.58, 0.32, 0.43],
        ],
    ),
    (
        "shelf",
        &[
            [0.70, 0.05, 0.70, 0.95, 0.08, 0.95],
            [0.70, 0.30, 0.70, 0.95, 0.33, 0.95],
            [0.70, 0.55, 0.70, 0.95, 0.58, 0.95],
        ],
    ),
    ("crate", &[[0.15, 0.03, 0.65, 0.40, 0.28, 0.90]]),
];

/// The room with a table, a shelf and a crate in it: 60 polygons of one material.
pub fn furnished_room(reflectance: f32, emission: f32) -> Scene {
    let mut scene = empty_room(reflectance, emission);
    add_furniture(&mut scene, MaterialId(0));
    scene
}

/// The furnished room, black but for grey walls, red furniture and a white lamp under the ceiling: 61 polygons.
pub fn lamp_room() -> Scene {
    let mut scene = empty_room(0.6, 0.0);
    scene.materials[0].reflectance = Vec3::new(0.7, 0.6, 0.5);
    let furniture = scene.add_material("furniture", Vec3::new(0.6, 0.2, 0.1), Vec3::ZERO);
    add_furniture(&mut scene, furniture);
    let lamp = scene.add_material("lamp", Vec3::splat(0.3), Vec3::new(20.0, 18.0, 14.0));
    let group = scene.add_group("lamp", GroupId(0));
    scene.add_quad([[0.4, 0.4], [0.6, 0.4], [0.6, 0.6], [0.4, 0.6]].map(|[x, z]| Vec3::new(x, 0.98, z)), lamp, group);
    assert!(scene.normal(scene.polygons.last().expect("the lamp")).y < 0.0, "the lamp shines down");
    scene
}

fn add_furniture(scene: &mut Scene, material: MaterialId) {
    for (name, boxes) in FURNITURE {
        let group = scene.add_group(name, GroupId(0));
        for &[x, y, z, right, top, front] in boxes {
            let piece = scene.add_group("piece", group);
            let corners = (Vec3::new(x, y, z), Vec3::new(right, top, front));
            add_box(scene, corners, false, (material, piece));
        }
    }
}

/// The initial patch that a patch is a part of, and the share of its area.
pub fn initial_patch(hierarchy: &Hierarchy, patch: ElementId) -> (ElementId, f64) {
    let mut id = patch;
    while let Shape::Patch(shape) = hierarchy.element(id).shape
        && shape.level > 0
    {
        id = hierarchy.element(id).parent().expect("a patch below the first level has a parent");
    }
    (id, f64::from(hierarchy.element(patch).area) / f64::from(hierarchy.element(id).area))
}

/// The leaf patches with the index of their polygon.
pub fn leaves(hierarchy: &Hierarchy) -> Vec<(ElementId, u32)> {
    let polygon = |id: ElementId| match hierarchy.element(id).shape {
        Shape::Patch(patch) if hierarchy.element(id).is_leaf() => Some((id, patch.polygon)),
        _ => None,
    };
    hierarchy.ids().filter_map(polygon).collect()
}

/// Power Σ A·E that a polygon receives, W (red).
pub fn received(solver: &Solver, polygon: u32) -> f64 {
    let hierarchy = solver.hierarchy();
    let power = |id: ElementId| f64::from(hierarchy.element(id).area) * f64::from(solver.irradiance()[id.index()].x);
    leaves(hierarchy).iter().filter(|leaf| leaf.1 == polygon).map(|leaf| power(leaf.0)).sum()
}

/// A stored link, bit for bit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LinkBits {
    pub receiver: ElementId,
    pub source: ElementId,
    pub form_factor: u32,
    pub visibility: u32,
}

/// Every stored link, bit for bit.
pub fn links(solver: &Solver) -> Vec<LinkBits> {
    let bits = |receiver: ElementId, link: &Link| LinkBits {
        receiver,
        source: link.source(),
        form_factor: link.form_factor.to_bits(),
        visibility: link.visibility().to_bits(),
    };
    let of = |receiver: ElementId| solver.links().of(receiver).iter().map(move |link| bits(receiver, link));
    solver.hierarchy().ids().flat_map(of).collect()
}

/// Every radiosity, bit for bit.
pub fn radiosity_bits(solver: &Solver) -> Vec<[u32; 3]> {
    solver.radiosity().iter().map(|radiosity| radiosity.to_array().map(f32::to_bits)).collect()
}

/// Area-weighted mean of the red radiosity over the leaves, its relative RMS deviation from `truth`, and the worst one.
pub fn deviation(solver: &Solver, truth: f64) -> (f64, f64, f64) {
    let hierarchy = solver.hierarchy();
    let (mut area_sum, mut sum, mut squares, mut worst) = (0.0, 0.0, 0.0, 0.0_f64);
    for (leaf, _) in leaves(hierarchy) {
        let area = f64::from(hierarchy.element(leaf).area);
        let radiosity = f64::from(solver.radiosity()[leaf.index()].x);
        let error = radiosity / truth - 1.0;
        area_sum += area;
        sum += area * radiosity;
        squares += area * error * error;
        worst = worst.max(error.abs());
    }
    (sum / area_sum, (squares / area_sum).sqrt(), worst)
}

/// Relative RMS difference of two solutions' radiosities over the polygons, weighted by area.
pub fn difference(one: &Solver, other: &Solver) -> f64 {
    let (one, other) = (of_polygons(one), of_polygons(other));
    assert_eq!(one.len(), other.len());
    let mut sums = (0.0, 0.0);
    for ((_, a), (area, b)) in one.into_iter().zip(other) {
        sums.0 += area * (a - b).length_squared();
        sums.1 += area * b.length_squared();
    }
    (sums.0 / sums.1).sqrt()
}

/// Area and mean radiosity of each polygon.
fn of_polygons(solver: &Solver) -> Vec<(f64, DVec3)> {
    let hierarchy = solver.hierarchy();
    let mut polygons = vec![(0.0, DVec3::ZERO); hierarchy.initial_patches().len()];
    for &id in hierarchy.initial_patches() {
        let element = hierarchy.element(id);
        let Shape::Patch(patch) = element.shape else { panic!("an initial patch is a patch") };
        polygons[patch.polygon as usize] = (f64::from(element.area), solver.radiosity()[id.index()].as_dvec3());
    }
    polygons
}

/// Whether every radiosity is a number, none negative.
pub fn is_sound(solver: &Solver) -> bool {
    solver.radiosity().iter().all(|radiosity| radiosity.is_finite() && radiosity.min_element() >= 0.0)
}
