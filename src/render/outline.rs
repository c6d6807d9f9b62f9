//! Outlines of elements: a patch's rim, a cluster's box.

use glam::{BVec3, Vec3};

use crate::hierarchy::{ElementId, Hierarchy, Shape};

/// The edges around an element: three or four of a patch, twelve of a cluster's box.
pub fn element_outline(hierarchy: &Hierarchy, id: ElementId) -> Vec<[Vec3; 2]> {
    let element = hierarchy.element(id);
    match &element.shape {
        Shape::Patch(patch) => {
            let (corners, count) = hierarchy.corner_positions(patch);
            (0..count).map(|corner| [corners[corner], corners[(corner + 1) % count]]).collect()
        }
        Shape::Cluster(cluster) => {
            box_edges(element.centre - cluster.half_extent, element.centre + cluster.half_extent).into()
        }
        // Nowhere in the scene.
        Shape::Sky(_) => Vec::new(),
    }
}

/// The edges between corners of a box that differ in one coordinate.
pub fn box_edges(lower: Vec3, upper: Vec3) -> [[Vec3; 2]; 12] {
    let corner = |bits: usize| Vec3::select(BVec3::new(bits & 1 != 0, bits & 2 != 0, bits & 4 != 0), upper, lower);
    std::array::from_fn(|edge| {
        let (axis, rest) = (edge / 4, edge % 4);
        let low_bits = rest & ((1 << axis) - 1);
        let from = (rest - low_bits) << 1 | low_bits;
        [corner(from), corner(from | 1 << axis)]
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Reachability;
    use crate::hierarchy::ClusteringMode;
    use crate::scene::builtin::BuiltinScene;

    /// Truth: the box has the scene's bounds, and a wall of the Cornell box four edges around its
    /// own corners.
    #[test]
    fn a_cluster_has_the_edges_of_its_box_and_a_patch_its_own() {
        let scene = BuiltinScene::Cornell.build();
        let reachability = Reachability::default();
        let hierarchy = Hierarchy::new(&scene, reachability.into(), ClusteringMode::Adaptive, 3);
        let edges = element_outline(&hierarchy, Hierarchy::ROOT);
        assert_eq!(edges.len(), 12);
        let (lower, upper) = scene.bounds();
        let longest = edges.iter().map(|[a, b]| a.distance(*b)).fold(0.0, f32::max);
        assert!((longest - (upper - lower).max_element()).abs() < 1e-4);
        let quad = hierarchy.ids().find(|&id| !hierarchy.element(id).is_cluster()).expect("there are patches");
        let rim = element_outline(&hierarchy, quad);
        assert_eq!(rim.len(), 4);
        assert!(rim.iter().enumerate().all(|(edge, [_, end])| *end == rim[(edge + 1) % 4][0]), "the rim is closed");
    }
}
