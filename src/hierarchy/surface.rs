//! Smooth surfaces: polygons over which radiosity may be interpolated.

use glam::Vec3;
use petgraph::unionfind::UnionFind;
use rayon::prelude::*;
use rustc_hash::FxHashSet;

use super::patch::area_vector;
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
///
/// `vertices` are the positions of the scene's corners, those that coincide being one, and `welded`
/// tells which one each of the scene's vertices is.
pub(super) fn smooth_surfaces(scene: &Scene, vertices: &[Vec3], welded: &[u32]) -> Vec<u32> {
    let key = |[a, b]: [Vec3; 2]| {
        let bits = |end: Vec3| (end + Vec3::ZERO).to_array().map(f32::to_bits);
        let (a, b) = (bits(a), bits(b));
        (a.min(b), a.max(b))
    };
    let cuts: FxHashSet<_> = scene.cut_edges.iter().copied().map(key).collect();
    let is_cut =
        |from: u32, to: u32| !cuts.is_empty() && cuts.contains(&key([vertices[from as usize], vertices[to as usize]]));
    let face = |index: usize| {
        let corners = scene.polygons[index].corners();
        let mut face = Face { polygon: index as u32, corners: [0; 4], count: corners.len(), normal: Vec3::ZERO };
        let mut positions = [Vec3::ZERO; 4];
        for (place, corner) in corners.iter().enumerate() {
            face.corners[place] = welded[*corner as usize];
            positions[place] = vertices[face.corners[place] as usize];
        }
        Face { normal: area_vector(&positions[..corners.len()]).normalize_or_zero(), ..face }
    };
    let faces: Vec<Face> = (0..scene.polygons.len()).into_par_iter().with_min_len(1 << 12).map(face).collect();
    let edges = Edges::new(vertices.len(), &faces);
    let all_with = |from: u32, to: u32| edges.with(from, to).map(|index| &faces[index as usize]);
    let polygon = |face: &Face| &scene.polygons[face.polygon as usize];
    let joined_to = |face: &Face| {
        let face = *face;
        let others = face.edges().flat_map(move |(from, to)| {
            // Each pair once.
            let joined = move |other: &&Face| {
                face.polygon < other.polygon
                    && scene.has_same_finish(polygon(&face), polygon(other))
                    && face.normal.dot(other.normal) > SMOOTH_COSINE
            };
            let is_open = move |other: &&Face| {
                let is_wall = |third: &Face| {
                    third.polygon != face.polygon
                        && third.polygon != other.polygon
                        && third.rises(vertices, from, face.normal + other.normal)
                };
                !is_cut(from, to) && !all_with(from, to).chain(all_with(to, from)).any(is_wall)
            };
            all_with(to, from).filter(joined).filter(is_open)
        });
        others.map(|other| (face.polygon, other.polygon)).collect::<Vec<_>>()
    };
    let joined: Vec<(u32, u32)> = faces.par_iter().flat_map_iter(joined_to).collect();
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

/// A polygon, by welded vertices.
#[derive(Clone, Copy)]
struct Face {
    polygon: u32,
    corners: [u32; 4],
    count: usize,
    normal: Vec3,
}

impl Face {
    fn edges(self) -> impl Iterator<Item = (u32, u32)> {
        (0..self.count).map(move |index| (self.corners[index], self.corners[(index + 1) % self.count]))
    }

    /// Whether it rises along `up` from this corner.
    fn rises(&self, vertices: &[Vec3], corner: u32, up: Vec3) -> bool {
        let (foot, up) = (vertices[corner as usize], up.normalize_or_zero());
        let ways = self.corners[..self.count].iter().map(|corner| vertices[*corner as usize] - foot);
        ways.map(|way| way.normalize_or_zero().dot(up)).fold(0.0, f32::max) > RISING
    }
}

/// Sine of the least angle under which what stands on a surface rises.
const RISING: f32 = 0.2;

/// The directed edges of faces, by the vertices that they start from. Several faces may have one: a
/// doubled face's back runs like its neighbour's front.
struct Edges {
    /// Where the edges from each vertex begin.
    start: Vec<u32>,
    /// Where each edge leads, and whose it is.
    edges: Vec<(u32, u32)>,
}

impl Edges {
    fn new(vertices: usize, faces: &[Face]) -> Self {
        let mut start = vec![0; vertices + 1];
        let all = || faces.iter().flat_map(|face| face.edges().map(|edge| (face.polygon, edge)));
        all().for_each(|(_, (from, _))| start[from as usize + 1] += 1);
        for vertex in 1..start.len() {
            start[vertex] += start[vertex - 1];
        }
        let mut next = start.clone();
        let mut edges = vec![(0, 0); start.last().map_or(0, |count| *count as usize)];
        for (polygon, (from, to)) in all() {
            edges[next[from as usize] as usize] = (to, polygon);
            next[from as usize] += 1;
        }
        Self { start, edges }
    }

    /// The polygons that have an edge.
    fn with(&self, from: u32, to: u32) -> impl Iterator<Item = u32> + use<'_> {
        let [first, last] = [0, 1].map(|by| self.start[from as usize + by] as usize);
        self.edges[first..last].iter().filter(move |edge| edge.0 == to).map(|edge| edge.1)
    }
}
