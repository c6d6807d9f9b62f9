//! From a scene to an arena: a clustering strategy says who belongs together, this module lays the
//! elements out.

use std::collections::VecDeque;
use std::sync::Arc;

use glam::Vec3;
use rustc_hash::FxHashMap;

use super::grouping::{Grouping, PolygonBounds};
use super::surface::smooth_surfaces;
use super::{
    Cluster, ClusteringMode, Element, ElementId, Hierarchy, NO_PARENT, Patch, PatchSums, Shape, adaptive, groups,
    octree,
};
use crate::base::random::hash64;
use crate::geometry::Reachability;
use crate::scene::{Scene, weld};

/// Builds the hierarchy of a scene.
pub(super) fn build(
    scene: &Scene,
    reachability: Arc<Reachability>,
    mode: ClusteringMode,
    octree_depth: u32,
) -> Hierarchy {
    let bounds = PolygonBounds::new(scene);
    let all: Vec<u32> = (0..scene.polygons.len() as u32).collect();
    let group = || match mode {
        ClusteringMode::None => Grouping { groupings: Vec::new(), polygons: all },
        ClusteringMode::Octree => octree::group(&bounds, all, octree_depth),
        ClusteringMode::Groups => groups::group(scene, &bounds),
        ClusteringMode::Adaptive => adaptive::group(&bounds, all),
    };
    let (grouping, (vertices, welded)) = rayon::join(group, || weld(&scene.vertices));
    let initial_vertices = vertices.len();
    let mut hierarchy = Hierarchy {
        elements: Vec::with_capacity(2 * scene.polygons.len() + 1),
        vertices,
        midpoints: FxHashMap::default(),
        initial_patches: Vec::with_capacity(scene.polygons.len()),
        area_sums: PatchSums::default(),
        reachability,
        cluster_count: 0,
        leaf_count: scene.polygons.len(),
        initial_vertices,
        smooth_surfaces: Arc::default(),
        around: None,
    };
    let vertices = hierarchy.vertices.clone();
    let lay_out = || {
        hierarchy.lay_out(scene, &welded, grouping.tidied().unwrap_or_default());
        hierarchy.finish_clusters(Hierarchy::ROOT);
        hierarchy.add_outside(scene);
    };
    let ((), surfaces) = rayon::join(lay_out, || smooth_surfaces(scene, &vertices, &welded));
    hierarchy.smooth_surfaces = Arc::new(surfaces);
    hierarchy
}

impl Hierarchy {
    /// Lays the elements out breadth first, so that siblings lie together and parents come first.
    fn lay_out(&mut self, scene: &Scene, welded: &[u32], root: Grouping) {
        let empty_cluster = |parent: u32, level: u16, number: usize| Element {
            parent,
            first_child: 0,
            child_count: 0,
            area: 0.0,
            sampled_area: 0.0,
            centre: Vec3::ZERO,
            key: 0,
            shape: Shape::Cluster(Cluster {
                half_extent: Vec3::ZERO,
                level,
                number: number as u32,
                first_patch: 0,
                patch_count: 0,
            }),
        };
        self.elements.push(empty_cluster(NO_PARENT, 0, 0));
        self.cluster_count = 1;
        let mut waiting = VecDeque::from([(0_u32, 0_u16, root)]);
        while let Some((parent, level, grouping)) = waiting.pop_front() {
            let first_child = self.elements.len() as u32;
            let child_count = (grouping.groupings.len() + grouping.polygons.len()) as u32;
            for inner in grouping.groupings {
                waiting.push_back((self.elements.len() as u32, level + 1, inner));
                self.elements.push(empty_cluster(parent, level + 1, self.cluster_count));
                self.cluster_count += 1;
            }
            for index in grouping.polygons {
                let polygon = &scene.polygons[index as usize];
                let mut corners = [0; 4];
                let count = polygon.corners().len();
                for (corner, &old) in corners.iter_mut().zip(polygon.corners()) {
                    *corner = welded[old as usize];
                }
                let cells = self.reachability.of_polygon(index);
                let patch = Patch::new(&corners[..count], index, 0, cells);
                let element = Element { parent, ..self.patch_element(patch, hash64(1, u64::from(index))) };
                self.elements.push(element);
            }
            let element = &mut self.elements[parent as usize];
            (element.first_child, element.child_count) = (first_child, child_count);
        }
    }

    /// Fills in boxes, areas, keys and the order of initial patches, depth first; returns the
    /// element's box and area.
    fn finish_clusters(&mut self, id: ElementId) -> (Vec3, Vec3, f64) {
        let element = *self.element(id);
        let cluster = match element.shape {
            Shape::Patch(patch) => {
                self.initial_patches.push(id);
                self.area_sums.push(f64::from(element.sampled_area));
                let (positions, count) = self.corner_positions(&patch);
                let around = |f: fn(Vec3, Vec3) -> Vec3| positions[1..count].iter().copied().fold(positions[0], f);
                return (around(Vec3::min), around(Vec3::max), f64::from(element.area));
            }
            Shape::Cluster(cluster) => cluster,
            Shape::Sky(_) => unreachable!("what lies outside is in no cluster"),
        };
        let first_patch = self.initial_patches.len();
        let (mut lower, mut upper, mut area) = (Vec3::INFINITY, Vec3::NEG_INFINITY, 0.0);
        for child in element.children() {
            let (child_lower, child_upper, child_area) = self.finish_clusters(child);
            (lower, upper) = (lower.min(child_lower), upper.max(child_upper));
            area += child_area;
        }
        let patch_count = self.initial_patches.len() - first_patch;
        if patch_count == 0 {
            (lower, upper) = (Vec3::ZERO, Vec3::ZERO);
        }
        let first_key = self.initial_patches.get(first_patch).map_or(0, |first| self.element(*first).key);
        let cluster = Cluster {
            half_extent: 0.5 * (upper - lower),
            first_patch: first_patch as u32,
            patch_count: patch_count as u32,
            ..cluster
        };
        let sampled_area = self.area_sums.over(&cluster) as f32;
        let finished = &mut self.elements[id.index()];
        (finished.area, finished.sampled_area) = (area as f32, sampled_area);
        finished.centre = 0.5 * (lower + upper);
        finished.key = hash64(first_key, hash64(patch_count as u64, u64::from(cluster.level)));
        finished.shape = Shape::Cluster(cluster);
        (lower, upper, area)
    }
}
