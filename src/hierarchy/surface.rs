//! Smooth surfaces: polygons over which radiosity may be interpolated.

use glam::Vec3;
use petgraph::unionfind::UnionFind;
use rayon::prelude::*;
use rustc_hash::FxHashSet;

use super::{Hierarchy, Patch, Shape};
use crate::scene::Scene;

/// Polygons that meet in an edge belong to one smooth surface when their normals differ by less
/// (cosine of 40°).
const SMOOTH_COSINE: f32 = 0.766;

/// The smooth, same-material surface that each polygon belongs to, as the smallest polygon index on
/// it.
///
/// Two polygons are joined when they share an edge that both run through in opposite directions (so
/// neither is the other's back), have the same material and meet at less than 40°; unless a wall
/// stands on it ([`Scene::cut_edges`], or a third polygon that has the edge and rises in front of
/// them).
pub fn smooth_surfaces(scene: &Scene, hierarchy: &Hierarchy) -> Vec<u32> {
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
    let edges = Edges::new(hierarchy.vertices().len(), patches);
    let all_with = |from: u32, to: u32| edges.with(from, to).filter_map(patch_of);
    let polygon = |patch: &Patch| &scene.polygons[patch.polygon as usize];
    let joined_to = |patch: Patch| {
        let others = edges_of(&patch).flat_map(move |(from, to)| {
            // Each pair once.
            let joined = move |other: &Patch| {
                patch.polygon < other.polygon
                    && scene.has_same_finish(polygon(&patch), polygon(other))
                    && patch.normal.dot(other.normal) > SMOOTH_COSINE
            };
            let is_open = move |other: &Patch| {
                let is_wall = |third: Patch| {
                    third.polygon != patch.polygon
                        && third.polygon != other.polygon
                        && rises(hierarchy, &third, from, patch.normal + other.normal)
                };
                !is_seam(from, to) && !all_with(from, to).chain(all_with(to, from)).any(is_wall)
            };
            all_with(to, from).filter(joined).filter(is_open)
        });
        others.map(|other| (patch.polygon, other.polygon)).collect::<Vec<_>>()
    };
    let initial = hierarchy.initial_patches().par_iter().filter_map(|id| patch_of(id.0));
    let joined: Vec<(u32, u32)> = initial.flat_map_iter(joined_to).collect();
    let mut surfaces = UnionFind::new(scene.polygons.len());
    for (a, b) in joined {
        surfaces.union(a, b);
    }
    let surfaces: Vec<u32> = surfaces.into_labeling();
    let mut smallest = vec![u32::MAX; surfaces.len()];
    for (polygon, &surface) in (0..).zip(&surfaces) {
        smallest[surface as usize] = smallest[surface as usize].min(polygon);
    }
    surfaces.into_iter().map(|surface| smallest[surface as usize]).collect()
}

/// The directed edges of patches, by the vertices that they start from. Several patches may have
/// one: a doubled face's back runs like its neighbour's front.
struct Edges {
    /// Where the edges from each vertex begin.
    start: Vec<u32>,
    /// Where each edge leads, and whose it is.
    edges: Vec<(u32, u32)>,
}

impl Edges {
    fn new<P: Iterator<Item = (u32, Patch)>>(vertices: usize, patches: impl Fn() -> P) -> Self {
        let mut start = vec![0; vertices + 1];
        let all = || patches().flat_map(|(id, patch)| edges_of(&patch).map(move |edge| (id, edge)));
        all().for_each(|(_, (from, _))| start[from as usize + 1] += 1);
        for vertex in 1..start.len() {
            start[vertex] += start[vertex - 1];
        }
        let mut next = start.clone();
        let mut edges = vec![(0, 0); start.last().map_or(0, |count| *count as usize)];
        for (id, (from, to)) in all() {
            edges[next[from as usize] as usize] = (to, id);
            next[from as usize] += 1;
        }
        Self { start, edges }
    }

    /// The patches that have an edge.
    fn with(&self, from: u32, to: u32) -> impl Iterator<Item = u32> + use<'_> {
        let [first, last] = [0, 1].map(|by| self.start[from as usize + by] as usize);
        self.edges[first..last].iter().filter(move |edge| edge.0 == to).map(|edge| edge.1)
    }
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
    let (patch, count) = (*patch, patch.corners().len());
    (0..count).map(move |index| (patch.corners()[index], patch.corners()[(index + 1) % count]))
}
