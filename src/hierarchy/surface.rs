//! Smooth surfaces: polygons over which radiosity may be interpolated.

use glam::Vec3;
use rustc_hash::{FxHashMap, FxHashSet};

use super::{Hierarchy, Shape};
use crate::scene::Scene;

/// Polygons that meet in an edge belong to one smooth surface when their normals differ by less (cosine of 40°).
const SMOOTH_COSINE: f32 = 0.766;

/// The smooth, same-material surface that each polygon belongs to, as the smallest polygon index on it.
///
/// Two polygons are joined when they share an edge that both run through in opposite directions (so neither is the other's
/// back), have the same material and meet at less than 40°; unless a wall stands on it ([`Scene::seams`]).
pub fn smooth_surfaces(scene: &Scene, hierarchy: &Hierarchy) -> Vec<u32> {
    let mut surface: Vec<u32> = (0..scene.polygons.len() as u32).collect();
    // The first patch with each directed edge, and the next one with the same edge: a doubled face's back runs like its
    // neighbour's front.
    let mut first_with: FxHashMap<(u32, u32), usize> = FxHashMap::default();
    let mut edges: Vec<(u32, Option<usize>)> = Vec::new();
    first_with.reserve(4 * scene.polygons.len());
    let key = |[a, b]: [Vec3; 2]| {
        let bits = |end: Vec3| (end + Vec3::ZERO).to_array().map(f32::to_bits);
        let (a, b) = (bits(a), bits(b));
        (a.min(b), a.max(b))
    };
    let seams: FxHashSet<_> = scene.seams.iter().copied().map(key).collect();
    let is_seam = |from: u32, to: u32| {
        let vertices = hierarchy.vertices();
        !seams.is_empty() && seams.contains(&key([vertices[from as usize], vertices[to as usize]]))
    };
    for &id in hierarchy.initial_patches() {
        let Shape::Patch(patch) = hierarchy.element(id).shape else { continue };
        let corners = patch.corners();
        for (index, &from) in corners.iter().enumerate() {
            let to = corners[(index + 1) % corners.len()];
            if is_seam(from, to) {
                continue;
            }
            let mut next = first_with.get(&(to, from)).copied();
            while let Some((neighbour, after)) = next.map(|place| edges[place]) {
                next = after;
                let Shape::Patch(other) = hierarchy.element(super::ElementId(neighbour)).shape else { continue };
                let polygon = |index: u32| &scene.polygons[index as usize];
                let is_alike = scene.has_same_finish(polygon(patch.polygon), polygon(other.polygon));
                if is_alike && patch.normal.dot(other.normal) > SMOOTH_COSINE {
                    join(&mut surface, patch.polygon, other.polygon);
                }
            }
            let before = first_with.insert((from, to), edges.len());
            edges.push((id.0, before));
        }
    }
    (0..surface.len() as u32).map(|polygon| find(&mut surface, polygon)).collect()
}

fn find(surface: &mut [u32], polygon: u32) -> u32 {
    let mut root = polygon;
    while surface[root as usize] != root {
        let grandparent = surface[surface[root as usize] as usize];
        surface[root as usize] = grandparent;
        root = grandparent;
    }
    root
}

fn join(surface: &mut [u32], a: u32, b: u32) {
    let (a, b) = (find(surface, a), find(surface, b));
    surface[a.max(b) as usize] = a.min(b);
}
