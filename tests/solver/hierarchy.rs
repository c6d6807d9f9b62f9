//! The hierarchy's own bookkeeping, and that light of every pair of patches is accounted for
//! exactly once.
//!
//! Truth: counting. Areas add up, every polygon is somewhere, and refinement only ever replaces a
//! pair by its parts.

use glam::Vec3;
use proptest::prelude::*;
use proptest::test_runner::{Config, RngAlgorithm, TestRng, TestRunner};
use std::sync::Arc;

use selflink::hierarchy::{ClusteringMode, ElementId, Hierarchy, Shape};
use selflink::scene::{GroupId, Scene};

use super::coverage::check_coverage;
use super::support::{MODES, add_box, furnished_room, is_sound, lamp_room, params, solve};

/// Every polygon is one initial patch, every element but the root has the parent that lists it,
/// areas add up, boxes hold what is in them. Areas and boxes within f32's 1e-6 of the scene's size.
pub fn check_tree(scene: &Scene, hierarchy: &Hierarchy) {
    let mut polygons: Vec<u32> = Vec::new();
    for &id in hierarchy.initial_patches() {
        let Shape::Patch(patch) = hierarchy.element(id).shape else { panic!("an initial patch is a patch") };
        assert_eq!(patch.level, 0);
        polygons.push(patch.polygon);
    }
    polygons.sort_unstable();
    assert_eq!(polygons, (0..scene.polygons.len() as u32).collect::<Vec<_>>());
    for id in hierarchy.ids() {
        let element = hierarchy.element(id);
        let children: Vec<ElementId> = element.children().collect();
        assert!(children.iter().all(|&child| hierarchy.element(child).parent() == Some(id) && child > id));
        if !children.is_empty() {
            let area: f32 = children.iter().map(|&child| hierarchy.element(child).area).sum();
            assert!((area - element.area).abs() <= 1e-5 * element.area, "{id:?}: {area} instead of {}", element.area);
        }
        if let Shape::Cluster(cluster) = element.shape {
            assert!(children.len() > 1 || id == Hierarchy::ROOT, "{id:?} is a cluster of one");
            for &below in hierarchy.patches_below(&cluster) {
                let Shape::Patch(patch) = hierarchy.element(below).shape else { panic!("an initial patch is a patch") };
                let (corners, count) = hierarchy.corner_positions(&patch);
                for corner in &corners[..count] {
                    let outside = (*corner - element.centre).abs() - cluster.half_extent;
                    assert!(outside.max_element() <= 1e-6 * corner.length().max(1.0), "{corner} lies outside {id:?}");
                }
            }
        }
    }
    let reachable: usize = hierarchy.ids().filter(|&id| hierarchy.element(id).parent().is_none()).count();
    assert_eq!(reachable, 1, "the root alone has no parent");
}

#[test]
fn every_pair_of_patches_is_covered_once_in_a_furnished_room() {
    for scene in [furnished_room(0.5, 1.0), lamp_room()] {
        for mode in MODES {
            for epsilon in [1.0, 1e-2, 1e-3] {
                let solved = solve(&scene, params(mode, epsilon));
                check_tree(&scene, solved.hierarchy());
                check_coverage(&solved, &format!("{} in {mode:?} at {epsilon}", scene.name));
            }
        }
    }
}

/// A scene of random boxes and a soup of triangles, a few of them shining.
pub fn soup() -> impl Strategy<Value = Scene> {
    let point = prop::array::uniform3(-2.0_f32..2.0).prop_map(Vec3::from);
    let a_box = (point.clone(), prop::array::uniform3(0.02_f32..1.0).prop_map(Vec3::from), any::<bool>());
    let a_triangle = (point, prop::array::uniform6(-0.8_f32..0.8));
    let emission = 0.0_f32..4.0;
    (prop::collection::vec(a_box, 0..4), prop::collection::vec(a_triangle, 0..16), emission).prop_map(
        |(boxes, triangles, emission)| {
            let mut scene = Scene::new("soup");
            let grey = scene.add_material("grey", Vec3::new(0.7, 0.5, 0.2), Vec3::ZERO);
            let lamp = scene.add_material("lamp", Vec3::splat(0.1), Vec3::splat(emission));
            for (index, (lower, size, is_room)) in boxes.into_iter().enumerate() {
                let group = scene.add_group("box", GroupId(0));
                let material = if index == 1 { lamp } else { grey };
                add_box(&mut scene, (lower, lower + size), is_room, (material, group));
            }
            for (index, (corner, [a, b, c, d, e, f])) in triangles.into_iter().enumerate() {
                let corners = [corner, corner + Vec3::new(a, b, c), corner + Vec3::new(d, e, f)];
                // Loaders drop faces without area before a solver sees them.
                if (corners[1] - corner).cross(corners[2] - corner).length() > 1e-3 {
                    let material = if index % 5 == 0 { lamp } else { grey };
                    scene.add_triangle(corners, material, GroupId(0));
                }
            }
            scene
        },
    )
}

#[test]
fn every_pair_of_patches_is_covered_once_in_random_scenes() {
    let cases = Config { cases: 24, failure_persistence: None, max_shrink_iters: 200, ..Config::default() };
    let random = TestRng::from_seed(RngAlgorithm::ChaCha, b"selflink: every pair just once!!");
    let checked = TestRunner::new_with_rng(cases, random).run(&soup(), |scene| {
        for mode in MODES {
            let solved = solve(&scene, params(mode, 3e-3));
            prop_assert!(is_sound(&solved));
            check_tree(&scene, solved.hierarchy());
            check_coverage(&solved, &format!("{mode:?}"));
        }
        Ok(())
    });
    checked.expect("every random scene is covered");
}

/// Truth: the definitions of the strategies. `none` has the root alone; the others have more where
/// there is more than one thing.
#[test]
fn clustering_modes_build_what_they_say() {
    let scene = furnished_room(0.5, 1.0);
    let of = |mode: ClusteringMode, depth: u32| {
        let hierarchy = Hierarchy::new(&scene, Arc::default(), mode, depth);
        check_tree(&scene, &hierarchy);
        hierarchy
    };
    assert_eq!(of(ClusteringMode::None, 5).cluster_count(), 1);
    assert_eq!(of(ClusteringMode::Octree, 1).cluster_count(), 1, "an octree of one level is its root");
    let counts: Vec<usize> = (1..=6).map(|depth| of(ClusteringMode::Octree, depth).cluster_count()).collect();
    assert!(counts.is_sorted() && counts[5] > 1, "a deeper octree has more clusters: {counts:?}");
    // Room, table with 5 pieces, shelf with 3, crate (a group of one piece is that piece).
    assert_eq!(of(ClusteringMode::Groups, 5).cluster_count(), 1 + (1 + 5) + (1 + 3) + 1);
    assert!(of(ClusteringMode::Adaptive, 5).cluster_count() > 5);
}

/// Truth: an octree puts a polygon into the smallest cell that holds it whole, so no cluster's box
/// is larger than its cell.
#[test]
fn octree_clusters_fit_their_cells() {
    let scene = furnished_room(0.5, 1.0);
    let hierarchy = Hierarchy::new(&scene, Arc::default(), ClusteringMode::Octree, 6);
    for id in hierarchy.ids() {
        if let Shape::Cluster(cluster) = hierarchy.element(id).shape {
            let cell = 0.5 * 0.5_f32.powi(i32::from(cluster.level));
            assert!(cluster.half_extent.max_element() <= cell * 1.000_01, "{id:?} at level {}", cluster.level);
        }
    }
}

/// Truth: geometry. Four quarters have the area, the plane and the winding of the whole, whatever
/// its shape, and neighbours share the vertices on their common edge.
#[test]
fn quarters_make_up_the_whole() {
    let mut scene = Scene::new("shapes");
    let grey = scene.add_material("grey", Vec3::splat(0.5), Vec3::ONE);
    let triangle = [Vec3::ZERO, Vec3::new(3.0, 0.0, 1.0), Vec3::new(0.5, 2.0, 0.0)];
    let trapezium = [Vec3::ZERO, Vec3::new(4.0, 0.0, 0.0), Vec3::new(3.0, 2.0, 0.0), Vec3::new(1.0, 2.0, 0.0)];
    scene.add_triangle(triangle, grey, GroupId(0));
    scene.add_quad(trapezium, grey, GroupId(0));
    let mut hierarchy = Hierarchy::new(&scene, Arc::default(), ClusteringMode::None, 1);
    for _ in 0..4 {
        for id in hierarchy.ids() {
            hierarchy.subdivide(id);
        }
    }
    check_tree(&scene, &hierarchy);
    assert_eq!(hierarchy.leaf_count(), 2 * 256);
    for id in hierarchy.ids() {
        let (Shape::Patch(patch), Some(parent)) = (hierarchy.element(id).shape, hierarchy.element(id).parent()) else {
            continue;
        };
        if let Shape::Patch(whole) = hierarchy.element(parent).shape {
            assert_eq!(patch.level, whole.level + 1);
            assert!(patch.normal.dot(whole.normal) > 0.999_999);
        }
    }
    // (2^4 + 1)² vertices of the quad and 17 · 18 / 2 of the triangle, less the common corner.
    assert_eq!(hierarchy.vertices().len(), 17 * 17 + 17 * 18 / 2 - 1);
    let elements = hierarchy.elements().len();
    hierarchy.subdivide(hierarchy.initial_patches()[0]);
    assert_eq!(hierarchy.elements().len(), elements, "a patch is split only once");
}
