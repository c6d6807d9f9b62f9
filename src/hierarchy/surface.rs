//! Smooth surfaces: polygons over which radiosity may be interpolated.

use glam::Vec3;
use rustc_hash::{FxHashMap, FxHashSet};

use super::{Hierarchy, Patch, Shape};
use crate::scene::Scene;

/// Polygons that meet in an edge belong to one smooth surface when their normals differ by less (cosine of 40°).
const SMOOTH_COSINE: f32 = 0.766;

/// The smooth, same-material surface that each polygon belongs to, as the smallest polygon index on it.
///
/// Two polygons are joined when they share an edge that both run through in opposite directions (so neither is the other's
/// back), have the same material and meet at less than 40°; unless a wall stands on it ([`Scene::cut_edges`], or a third polygon that has
/// the edge and rises in front of them).
pub fn smooth_surfaces(scene: &Scene, hierarchy: &Hierarchy) -> Vec<u32> {
    let mut surface: Vec<u32> = (0..scene.polygons.len() as u32).collect();
    // The last patch with each directed edge, and the one before it with the same edge: a doubled face's back runs like its
    // neighbour's front.
    let mut last_with: FxHashMap<(u32, u32), usize> = FxHashMap::default();
    let mut edges: Vec<(u32, Option<usize>)> = Vec::new();
    last_with.reserve(4 * scene.polygons.len());
    let key = |[a, b]: [Vec3; 2]| {
        let bits = |end: Vec3| (end + Vec3::ZERO).to_array().map(f32::to_bits);
        let (a, b) = (bits(a), bits(b));
        (a.min(b), a.max(b))
    };
    let cuts: FxHashSet<_> = scene.cut_edges.iter().copied().map(key).collect();
    let is_seam = |from: u32, to: u32| {
        let vertices = hierarchy.vertices();
        !cuts.is_empty() && cuts.contains(&key([vertices[from as usize], vertices[to as usize]]))
    };
    let patch_of = |id: u32| match hierarchy.element(super::ElementId(id)).shape {
        Shape::Patch(patch) => Some(patch),
        Shape::Cluster(_) | Shape::Sky(_) => None,
    };
    let patches = || hierarchy.initial_patches().iter().filter_map(|id| Some((id.0, patch_of(id.0)?)));
    for (id, patch) in patches() {
        for edge in edges_of(&patch) {
            let before = last_with.insert(edge, edges.len());
            edges.push((id, before));
        }
    }
    let all_with = |edge: (u32, u32)| {
        let first = last_with.get(&edge).map(|place| edges[*place]);
        std::iter::successors(first, |(_, before)| before.map(|place| edges[place])).filter_map(|(id, _)| patch_of(id))
    };
    let polygon = |patch: &Patch| &scene.polygons[patch.polygon as usize];
    for (_, patch) in patches() {
        for (from, to) in edges_of(&patch) {
            let others = all_with((to, from));
            // Each pair once.
            let joined = others.filter(|other| {
                patch.polygon < other.polygon
                    && scene.has_same_finish(polygon(&patch), polygon(other))
                    && patch.normal.dot(other.normal) > SMOOTH_COSINE
            });
            for other in joined {
                let is_wall = |third: Patch| {
                    third.polygon != patch.polygon
                        && third.polygon != other.polygon
                        && rises(hierarchy, &third, from, patch.normal + other.normal)
                };
                let has_wall = || all_with((from, to)).chain(all_with((to, from))).any(is_wall);
                if !is_seam(from, to) && !has_wall() {
                    join(&mut surface, patch.polygon, other.polygon);
                }
            }
        }
    }
    (0..surface.len() as u32).map(|polygon| find(&mut surface, polygon)).collect()
}

/// Sine of the least angle under which what stands on a surface rises.
const RISING: f32 = 0.2;

/// Whether a polygon with this corner rises along `up`.
fn rises(hierarchy: &Hierarchy, patch: &Patch, corner: u32, up: Vec3) -> bool {
    let (corners, count) = hierarchy.corner_positions(patch);
    let foot = hierarchy.vertices()[corner as usize];
    let ways = corners[..count].iter().map(|corner| (*corner - foot).normalize_or_zero().dot(up.normalize_or_zero()));
    ways.fold(0.0, f32::max) > RISING
}

fn edges_of(patch: &Patch) -> impl Iterator<Item = (u32, u32)> + use<> {
    let (corners, count) = (patch.corners().to_vec(), patch.corners().len());
    (0..count).map(move |index| (corners[index], corners[(index + 1) % count]))
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
