//! The mesh that a view draws: no cracks, no jumps, light smoothed only where a surface is smooth.
//!
//! Truth: topology. Inside a surface every edge has a triangle on either side.

use glam::Vec3;
use rustc_hash::{FxHashMap, FxHashSet};
use selflink::hierarchy::{ClusteringMode, Shape};
use selflink::scene::{GroupId, Polygon, Scene};
use selflink::solve::{Mesh, Snapshot, Solver};

use super::support::{MODES, empty_room, furnished_room, lamp_room, params, solve};

type Edge = [[u32; 3]; 2];

/// Ends of an edge by the bits of their positions, the smaller first.
fn edge_at(mesh: &Mesh, a: u32, b: u32) -> Edge {
    let bits = |vertex: u32| mesh.positions[vertex as usize].map(|value| (value + 0.0).to_bits());
    let mut ends = [bits(a), bits(b)];
    ends.sort_unstable();
    ends
}

/// Triangles at each edge, by the edge's key.
fn edge_uses<K: std::hash::Hash + Eq>(mesh: &Mesh, key: impl Fn(u32, u32, u32) -> K) -> FxHashMap<K, usize> {
    let mut uses = FxHashMap::default();
    for (triangle, leaf) in mesh.triangles.iter().zip(&mesh.triangle_leaf) {
        for index in 0..3 {
            *uses.entry(key(triangle[index], triangle[(index + 1) % 3], *leaf)).or_insert(0) += 1;
        }
    }
    uses
}

fn finished(scene: &Scene, mode: ClusteringMode, epsilon: f64) -> (Solver, Snapshot) {
    let mut solved = solve(scene, params(mode, epsilon));
    let snapshot = solved.snapshot();
    (solved, snapshot)
}

fn levels(snapshot: &Snapshot) -> FxHashSet<u8> {
    snapshot.mesh.leaves.iter().map(|leaf| leaf.level).collect()
}

/// A closed room is a closed surface: each edge, by position, has exactly two triangles, across
/// creases and across levels of subdivision. A T-vertex would leave three edges with one triangle
/// each.
#[test]
fn a_closed_room_has_no_crack() {
    // One wall shines, so that leaves of many levels meet.
    let mut scene = empty_room(0.5, 0.0);
    let lamp = scene.add_material("lamp", Vec3::ZERO, Vec3::ONE);
    scene.polygons[4].material = lamp;
    for mode in MODES {
        for epsilon in [1.0, 1e-2, 1e-3, 3e-4] {
            let (_, snapshot) = finished(&scene, mode, epsilon);
            let uses = edge_uses(&snapshot.mesh, |a, b, _| edge_at(&snapshot.mesh, a, b));
            let cracks = uses.values().filter(|&&uses| uses != 2).count();
            assert_eq!(
                cracks,
                0,
                "{mode:?} at {epsilon}: {} leaves of levels {:?}",
                snapshot.mesh.leaves.len(),
                levels(&snapshot)
            );
        }
    }
    let (_, snapshot) = finished(&scene, ClusteringMode::Adaptive, 3e-4);
    assert!(levels(&snapshot).len() > 2, "the test needs neighbours of several levels");
}

/// In a furnished room the edges with one triangle add up to the rims of the smooth surfaces, area
/// is neither lost nor covered twice, and every triangle shows its bright side. Sums of f32 lengths
/// and areas: 1e-4.
#[test]
fn surfaces_are_covered_once_up_to_their_rims() {
    for scene in [furnished_room(0.5, 1.0), lamp_room()] {
        let (solved, snapshot) = finished(&scene, ClusteringMode::Adaptive, 1e-4);
        let mesh = &snapshot.mesh;
        assert!(levels(&snapshot).len() > 2);
        let surfaces = solved.hierarchy().smooth_surfaces();
        let surface_of = |leaf: u32| surfaces[mesh.leaves[leaf as usize].polygon as usize];
        let length = |edge: &Edge| {
            let [a, b] = edge.map(|end| Vec3::from(end.map(f32::from_bits)));
            f64::from((a - b).length())
        };
        let uses = edge_uses(mesh, |a, b, leaf| (edge_at(mesh, a, b), surface_of(leaf)));
        assert!(uses.values().all(|&uses| uses <= 2), "an edge with more than two triangles of one surface");
        let rims: f64 = uses.iter().filter(|(_, uses)| **uses == 1).map(|((edge, _), _)| length(edge)).sum();
        // Every quad is a surface of its own here: all creases are right angles.
        let expected: f64 = scene.polygons.iter().map(|polygon| perimeter(&scene, polygon)).sum();
        assert!((rims / expected - 1.0).abs() < 1e-4, "{}: rims of {rims} m instead of {expected} m", scene.name);

        let mut area = vec![0.0_f64; scene.polygons.len()];
        for (triangle, leaf) in mesh.triangles.iter().zip(&mesh.triangle_leaf) {
            let [a, b, c] = triangle.map(|vertex| Vec3::from(mesh.positions[vertex as usize]));
            let polygon = mesh.leaves[*leaf as usize].polygon as usize;
            let normal = scene.normal(&scene.polygons[polygon]);
            let signed = 0.5 * (b - a).cross(c - a).dot(normal);
            assert!(signed > 0.0, "a triangle is turned over or flat");
            area[polygon] += f64::from(signed);
        }
        for (polygon, area) in scene.polygons.iter().zip(area) {
            assert!((area / f64::from(scene.area(polygon)) - 1.0).abs() < 1e-4);
        }
    }
}

fn perimeter(scene: &Scene, polygon: &Polygon) -> f64 {
    let (corners, count) = scene.corner_positions(polygon);
    (0..count).map(|index| f64::from((corners[index] - corners[(index + 1) % count]).length())).sum()
}

/// Truth: where one position has one vertex per surface, radiosity cannot jump inside the surface.
#[test]
fn a_surface_has_one_vertex_at_a_position() {
    let scene = lamp_room();
    let (solved, snapshot) = finished(&scene, ClusteringMode::Adaptive, 1e-4);
    let surfaces = solved.hierarchy().smooth_surfaces();
    let mesh = &snapshot.mesh;
    let mut vertex_at = FxHashMap::default();
    for (triangle, leaf) in mesh.triangles.iter().zip(&mesh.triangle_leaf) {
        let surface = surfaces[mesh.leaves[*leaf as usize].polygon as usize];
        for &vertex in triangle {
            let position = mesh.positions[vertex as usize].map(|value| (value + 0.0).to_bits());
            assert_eq!(*vertex_at.entry((position, surface)).or_insert(vertex), vertex, "two vertices of one surface");
        }
    }
    assert_eq!(vertex_at.len(), mesh.positions.len(), "a vertex that no triangle uses, or two surfaces share");
}

/// Truth: a mean of equal values. A black furnace has B = 1 on every leaf, so every vertex shows 1,
/// up to the rounding of up to a dozen weights. And no mean lies outside the values it is made of.
#[test]
fn weights_of_a_vertex_sum_to_one() {
    let (_, snapshot) = finished(&furnished_room(0.0, 1.0), ClusteringMode::Adaptive, 1e-3);
    assert!(levels(&snapshot).len() > 1);
    assert!(snapshot.vertex_radiosity.iter().flatten().all(|value| (value - 1.0).abs() < 1e-6));

    let (_, snapshot) = finished(&lamp_room(), ClusteringMode::Adaptive, 1e-3);
    for channel in 0..3 {
        let of_leaves = || snapshot.leaf_radiosity.iter().map(|radiosity| radiosity[channel]);
        let (least, most) = (of_leaves().fold(f32::INFINITY, f32::min), of_leaves().fold(0.0, f32::max));
        let inside = |value: f32| value >= least * (1.0 - 1e-6) && value <= most * (1.0 + 1e-6);
        assert!(snapshot.vertex_radiosity.iter().all(|radiosity| inside(radiosity[channel])));
    }
}

/// Two squares with a common edge, the second turned about it, under a lamp that stands over the
/// first.
fn two_squares(angle_deg: f32, same_material: bool) -> Scene {
    let mut scene = Scene::new("two squares");
    let grey = scene.add_material("grey", Vec3::splat(0.5), Vec3::ZERO);
    let other = scene.add_material("other", Vec3::splat(0.5), Vec3::ZERO);
    let lamp = scene.add_material("lamp", Vec3::ZERO, Vec3::splat(10.0));
    let across = Vec3::new(angle_deg.to_radians().cos(), 0.0, angle_deg.to_radians().sin());
    scene.add_quad([-Vec3::X, Vec3::ZERO, Vec3::Y, Vec3::Y - Vec3::X], grey, GroupId(0));
    let second = if same_material { grey } else { other };
    scene.add_quad([Vec3::ZERO, across, across + Vec3::Y, Vec3::Y], second, GroupId(0));
    let corners = [[-1.0, 0.0], [-1.0, 1.0], [-0.5, 1.0], [-0.5, 0.0]].map(|[x, y]| Vec3::new(x, y, 1.0));
    scene.add_quad(corners, lamp, GroupId(0));
    scene
}

/// Truth: the stated rule. Vertices on the common edge are one where the surface is smooth and of
/// one material, and two where there is a crease (90°) or another material.
#[test]
fn light_is_smoothed_within_a_surface_only() {
    for (angle, same_material, joined) in
        [(0.0, true, true), (20.0, true, true), (90.0, true, false), (60.0, true, false), (0.0, false, false)]
    {
        for epsilon in [1.0, 1e-3] {
            let (_, snapshot) = finished(&two_squares(angle, same_material), ClusteringMode::Adaptive, epsilon);
            let mesh = &snapshot.mesh;
            let on_edge: Vec<usize> = (0..mesh.positions.len())
                .filter(|&vertex| mesh.positions[vertex][0] == 0.0 && mesh.positions[vertex][2] == 0.0)
                .collect();
            let places: FxHashSet<u32> = on_edge.iter().map(|&vertex| mesh.positions[vertex][1].to_bits()).collect();
            let per_place = if joined { 1 } else { 2 };
            assert!(places.len() >= 2);
            assert_eq!(on_edge.len(), per_place * places.len(), "{angle}°, same material: {same_material}");
        }
    }
}

/// Truth: the back of a face is another surface, even where both sides have one material.
#[test]
fn the_two_sides_of_a_face_are_not_smoothed_together() {
    let mut scene = two_squares(0.0, true);
    for face in 0..2 {
        let mut back = scene.polygons[face].flipped();
        back.is_back = true;
        scene.polygons.push(back);
    }
    let (solved, snapshot) = finished(&scene, ClusteringMode::Adaptive, 1e-3);
    let surfaces = solved.hierarchy().smooth_surfaces();
    assert_eq!((surfaces[0], surfaces[3]), (surfaces[1], surfaces[4]));
    assert_ne!(surfaces[0], surfaces[3]);
    // The lamp is above: nothing reaches the backs, and nothing of the fronts' light shows there.
    for (triangle, leaf) in snapshot.mesh.triangles.iter().zip(&snapshot.mesh.triangle_leaf) {
        if snapshot.mesh.leaves[*leaf as usize].polygon > 2 {
            assert!(triangle.iter().all(|&vertex| snapshot.vertex_radiosity[vertex as usize] == [0.0; 3]));
        }
    }
}

/// Truth: the tables describe the hierarchy they were made from.
#[test]
fn leaves_of_the_mesh_are_the_leaves_of_the_hierarchy() {
    let scene = lamp_room();
    let (solved, snapshot) = finished(&scene, ClusteringMode::Groups, 1e-3);
    assert_eq!(snapshot.mesh.leaves.len(), solved.stats().patches);
    assert_eq!(snapshot.leaf_radiosity.len(), snapshot.mesh.leaves.len());
    assert_eq!(snapshot.clusters.len(), solved.stats().clusters);
    for (leaf, radiosity) in snapshot.mesh.leaves.iter().zip(&snapshot.leaf_radiosity) {
        let element = solved.hierarchy().element(leaf.element);
        let Shape::Patch(patch) = element.shape else { panic!("a leaf is a patch") };
        assert!(element.is_leaf());
        assert_eq!((patch.polygon, patch.level), (leaf.polygon, leaf.level));
        assert_eq!((element.area, solved.hierarchy().whole_area(element, &patch)), (leaf.reachable_area, leaf.area));
        assert_eq!(leaf.material, scene.polygons[leaf.polygon as usize].material);
        assert_eq!(Vec3::from(*radiosity), solved.radiosity()[leaf.element.index()]);
    }
}
