//! The reconstruction mesh: leaves as triangles without cracks, and vertex radiosities averaged
//! over the leaves around a vertex.
//!
//! A vertex belongs to one smooth, same-material surface. Where a neighbour was split and a leaf
//! was not, the neighbour's vertices on the common edge (hanging vertices) become corners of the
//! leaf's own triangles, so nothing jumps or gapes.

use std::sync::Arc;

use glam::Vec3;
use rayon::prelude::*;
use rustc_hash::FxHashMap;

use super::snapshot::{ClusterBox, Leaf, Mesh};
use crate::hierarchy::{ElementId, Hierarchy, Shape};
use crate::scene::Scene;

/// How leaves become triangles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum MeshKind {
    /// Leaves share the vertices between them.
    Shared,
    /// Each leaf has vertices of its own, all of one value.
    Flat,
}

/// Stands for the number of elements of a mesh that is to be made anew.
const OUTDATED: usize = usize::MAX;

/// The mesh of one state of the hierarchy, and how leaves' radiosities make its vertices'.
pub struct ReconstructionMesh {
    /// Elements when the mesh was made; more elements ask for a new one.
    elements: usize,
    kind: MeshKind,
    /// The mesh.
    pub mesh: Arc<Mesh>,
    /// Boxes of the clusters.
    pub clusters: Arc<Vec<ClusterBox>>,
    /// Where each vertex's shares start; one longer than the number of vertices.
    starts: Vec<u32>,
    /// Leaf (index into the mesh's leaves) and weight; a vertex's weights sum to 1.
    shares: Vec<(u32, f32)>,
    /// The element of the hierarchy that each leaf of the mesh is.
    own: Vec<ElementId>,
    /// Of each element, its place among the mesh's leaves.
    place_of: Vec<u32>,
    /// Where each leaf's triangles start; one longer than the number of leaves.
    first_triangles: Vec<u32>,
}

impl ReconstructionMesh {
    /// The mesh of the hierarchy as it is, the old one where nothing was split since. Elements
    /// beyond the first `link_elements` are parts of those that links know, and the mesh names
    /// these.
    pub fn current(
        old: Option<Self>,
        scene: &Scene,
        hierarchy: &Hierarchy,
        link_elements: usize,
        kind: MeshKind,
    ) -> Self {
        let elements = hierarchy.elements().len();
        match old {
            Some(reconstruction) if reconstruction.elements == elements && reconstruction.kind == kind => {
                reconstruction
            }
            Some(reconstruction) => Self::build(hierarchy, link_elements, scene, reconstruction.clusters, kind),
            None => Self::build(hierarchy, link_elements, scene, Arc::new(cluster_boxes(hierarchy)), kind),
        }
    }

    /// For a hierarchy whose patches were merged back and numbered anew: boxes stay, the mesh
    /// does not.
    pub fn outdated(self) -> Self {
        Self { elements: OUTDATED, ..self }
    }

    /// The mesh of the hierarchy, or of what it has grown to, in another kind.
    pub fn rebuilt(&self, scene: &Scene, hierarchy: &Hierarchy, link_elements: usize, kind: MeshKind) -> Self {
        Self::build(hierarchy, link_elements, scene, self.clusters.clone(), kind)
    }

    fn build(
        hierarchy: &Hierarchy,
        link_elements: usize,
        scene: &Scene,
        clusters: Arc<Vec<ClusterBox>>,
        kind: MeshKind,
    ) -> Self {
        let part = |patches: &[ElementId]| {
            let mut builder = MeshBuilder::new(hierarchy, scene, kind);
            patches.iter().for_each(|patch| hierarchy.leaves_below(*patch, &mut |leaf| builder.add_leaf(leaf)));
            builder.part
        };
        let mut joined = Joined::for_leaves(hierarchy.leaf_count());
        for patches in hierarchy.initial_patches().chunks(PARTS_AT_ONCE * PATCHES_OF_PART) {
            let parts: Vec<Part> = patches.par_chunks(PATCHES_OF_PART).map(part).collect();
            parts.iter().for_each(|part| joined.append(part));
        }
        let (mut mesh, starts, shares) = joined.finish();
        let own: Vec<ElementId> = mesh.leaves.iter().map(|leaf| leaf.element).collect();
        let mut place_of = vec![u32::MAX; hierarchy.elements().len()];
        own.iter().enumerate().for_each(|(place, leaf)| place_of[leaf.index()] = place as u32);
        let mut first_triangles = vec![0; own.len() + 1];
        mesh.triangle_leaf.iter().for_each(|leaf| first_triangles[*leaf as usize + 1] += 1);
        (0..own.len()).for_each(|leaf| first_triangles[leaf + 1] += first_triangles[leaf]);
        for leaf in &mut mesh.leaves {
            while leaf.element.index() >= link_elements
                && let Some(parent) = hierarchy.element(leaf.element).parent()
            {
                leaf.element = parent;
            }
        }
        Self {
            elements: hierarchy.elements().len(),
            kind,
            mesh: Arc::new(mesh),
            clusters,
            starts,
            shares,
            own,
            place_of,
            first_triangles,
        }
    }

    /// The corners of the triangle of a leaf that holds a point, and their weights.
    pub fn locate(&self, leaf: ElementId, point: Vec3) -> Option<([u32; 3], Vec3)> {
        // Leaves lie in the order of their patches, not of the arena.
        let place = self.place_of[leaf.index()] as usize;
        let (first, last) = (*self.first_triangles.get(place)?, *self.first_triangles.get(place + 1)?);
        let (triangle, weights) = place_among(&self.mesh, first..last, point)?;
        Some((self.mesh.triangles[triangle as usize], weights))
    }

    /// Values of each mesh vertex, averaged over the leaves around it; `table` is parallel to the
    /// hierarchy's arena.
    pub fn of_vertices(&self, table: &[Vec3]) -> Vec<[f32; 3]> {
        let of_leaf = |leaf: u32| table[self.own[leaf as usize].index()];
        let vertex = |range: &[u32]| {
            let shares = &self.shares[range[0] as usize..range[1] as usize];
            shares.iter().map(|&(leaf, weight)| weight * of_leaf(leaf)).sum::<Vec3>().to_array()
        };
        self.starts.par_windows(2).with_min_len(4096).map(vertex).collect()
    }

    /// A value of each leaf in the mesh's order.
    pub fn of_leaves(&self, table: &[Vec3]) -> Vec<[f32; 3]> {
        self.own.par_iter().with_min_len(1 << 13).map(|leaf| table[leaf.index()].to_array()).collect()
    }
}

/// Weight of a hidden leaf at a vertex: not beside what is reachable, but where there is nothing
/// else.
const LEAST_REACHABLE: f32 = 1e-6;

/// Barycentric weights of a point's projection; not finite for a triangle without area.
pub fn barycentric([a, b, c]: [Vec3; 3], point: Vec3) -> Vec3 {
    let across = (b - a).cross(c - a);
    let area_squared = across.length_squared();
    let of_b = (point - a).cross(c - a).dot(across) / area_squared;
    let of_c = (b - a).cross(point - a).dot(across) / area_squared;
    Vec3::new(1.0 - of_b - of_c, of_b, of_c)
}

/// The one of these triangles of a mesh that a point of their plane lies in, and the weights of its
/// corners there, which sum to 1. Rounding may leave a point on an edge a little outside of either
/// triangle: the one that it is least outside of has it.
pub fn place_among(mesh: &Mesh, triangles: impl Iterator<Item = u32>, point: Vec3) -> Option<(u32, Vec3)> {
    let weigh = |triangle: u32| (triangle, barycentric(mesh.corners(mesh.triangles[triangle as usize]), point));
    let found = triangles.map(weigh).filter(|(_, weights)| weights.is_finite());
    let (triangle, weights) = found.max_by(|a, b| a.1.min_element().total_cmp(&b.1.min_element()))?;
    let weights = weights.max(Vec3::ZERO);
    Some((triangle, weights / weights.element_sum()))
}

/// Initial patches whose leaves become triangles in one task.
const PATCHES_OF_PART: usize = 1 << 13;
/// Parts that are there at once, beside the mesh that they are joined to.
const PARTS_AT_ONCE: usize = 16;

/// The mesh of a run of patches.
#[derive(Default)]
struct Part {
    mesh: Mesh,
    /// Hierarchy vertex and smooth surface of each vertex; `None` for the middle of a leaf.
    keys: Vec<Option<(u32, u32)>>,
    /// (mesh vertex, leaf, weight) in the order found.
    contributions: Vec<(u32, u32, f32)>,
}

struct MeshBuilder<'a> {
    hierarchy: &'a Hierarchy,
    scene: &'a Scene,
    kind: MeshKind,
    part: Part,
    /// Mesh vertex by (hierarchy vertex, smooth surface).
    vertex_of: FxHashMap<(u32, u32), u32>,
    rim: Vec<u32>,
    /// How much of the leaf is reachable near each vertex of the rim.
    rim_reachable: Vec<f32>,
}

impl<'a> MeshBuilder<'a> {
    fn new(hierarchy: &'a Hierarchy, scene: &'a Scene, kind: MeshKind) -> Self {
        Self {
            hierarchy,
            scene,
            kind,
            part: Part::default(),
            vertex_of: FxHashMap::default(),
            rim: Vec::new(),
            rim_reachable: Vec::new(),
        }
    }

    fn add_leaf(&mut self, id: ElementId) {
        let element = self.hierarchy.element(id);
        let Shape::Patch(patch) = element.shape else { return };
        let leaf = self.part.mesh.leaves.len() as u32;
        let material = self.scene.polygons[patch.polygon as usize].material;
        let whole_area = self.hierarchy.whole_area(element, &patch);
        self.part.mesh.leaves.push(Leaf {
            element: id,
            polygon: patch.polygon,
            material,
            area: whole_area,
            reachable_area: element.area,
            level: patch.level,
        });
        let reachable = element.area / whole_area;
        let surface =
            if self.kind == MeshKind::Flat { id.0 } else { self.hierarchy.smooth_surfaces()[patch.polygon as usize] };
        let corners = patch.corners();
        self.rim.clear();
        self.rim_reachable.clear();
        for (index, &from) in corners.iter().enumerate() {
            let vertex = self.vertex(from, surface);
            self.rim.push(vertex);
            self.rim_reachable.push(self.hierarchy.reachable_at_corner(&patch, index));
            if self.hierarchy.is_subdivided() {
                self.hanging(from, corners[(index + 1) % corners.len()], surface);
                self.rim_reachable.resize(self.rim.len(), reachable);
            }
        }
        let rim = std::mem::take(&mut self.rim);
        for index in 0..rim.len() {
            self.contribute(&rim, index, leaf, element.centre);
            self.part.mesh.outlines.push([rim[index], rim[(index + 1) % rim.len()]]);
        }
        match *rim.as_slice() {
            [a, b, c] => self.triangle([a, b, c], leaf),
            [a, b, c, d] if corners.len() == 4 => {
                self.triangle([a, b, c], leaf);
                self.triangle([a, c, d], leaf);
            }
            _ => {
                let centre = self.part.mesh.positions.len() as u32;
                self.part.mesh.positions.push(element.centre.to_array());
                self.part.keys.push(None);
                self.part.contributions.push((centre, leaf, 1.0));
                for index in 0..rim.len() {
                    self.triangle([centre, rim[index], rim[(index + 1) % rim.len()]], leaf);
                }
            }
        }
        self.rim = rim;
    }

    /// Adds the vertices that neighbours put on an edge, in order, its ends left out.
    fn hanging(&mut self, from: u32, to: u32, surface: u32) {
        if let Some(middle) = self.hierarchy.midpoint(from, to) {
            self.hanging(from, middle, surface);
            let vertex = self.vertex(middle, surface);
            self.rim.push(vertex);
            self.hanging(middle, to, surface);
        }
    }

    fn vertex(&mut self, vertex: u32, surface: u32) -> u32 {
        let (part, hierarchy) = (&mut self.part, self.hierarchy);
        *self.vertex_of.entry((vertex, surface)).or_insert_with(|| {
            part.mesh.positions.push(hierarchy.vertices()[vertex as usize].to_array());
            part.keys.push(Some((vertex, surface)));
            part.keys.len() as u32 - 1
        })
    }

    /// A leaf counts at a vertex by the angle it fills there, over the squared distance of its
    /// centre, which reproduces a linear radiosity across a change of subdivision level, and by how
    /// much of it is reachable there: beyond a thing that stands on the vertex it may be lit
    /// otherwise.
    fn contribute(&mut self, rim: &[u32], index: usize, leaf: u32, centre: Vec3) {
        let at = |index: usize| Vec3::from(self.part.mesh.positions[rim[index % rim.len()] as usize]);
        let vertex = at(index);
        let angle = (at(index + 1) - vertex).angle_between(at(index + rim.len() - 1) - vertex);
        let distance_squared = (centre - vertex).length_squared();
        let reachable = self.rim_reachable[index].max(LEAST_REACHABLE);
        let weight = if distance_squared > 0.0 && angle > 0.0 { reachable * angle / distance_squared } else { 0.0 };
        self.part.contributions.push((rim[index], leaf, weight));
    }

    fn triangle(&mut self, corners: [u32; 3], leaf: u32) {
        self.part.mesh.triangles.push(corners);
        self.part.mesh.triangle_leaf.push(leaf);
    }
}

/// The mesh of several parts, which share vertices.
struct Joined {
    mesh: Mesh,
    /// Mesh vertex by (hierarchy vertex, smooth surface).
    vertex_of: FxHashMap<(u32, u32), u32>,
    /// (mesh vertex, leaf, weight).
    contributions: Vec<(u32, u32, f32)>,
}

impl Joined {
    /// With room for so many leaves.
    fn for_leaves(leaves: usize) -> Self {
        let mesh = Mesh {
            triangles: Vec::with_capacity(2 * leaves),
            triangle_leaf: Vec::with_capacity(2 * leaves),
            outlines: Vec::with_capacity(4 * leaves),
            leaves: Vec::with_capacity(leaves),
            ..Mesh::default()
        };
        Self { mesh, vertex_of: FxHashMap::default(), contributions: Vec::with_capacity(4 * leaves) }
    }

    fn append(&mut self, Part { mesh: part, keys, contributions }: &Part) {
        let mesh = &mut self.mesh;
        let first_leaf = mesh.leaves.len() as u32;
        let mut add = |position: [f32; 3]| {
            mesh.positions.push(position);
            mesh.positions.len() as u32 - 1
        };
        let place = |(key, position): (&Option<(u32, u32)>, &[f32; 3])| match key {
            Some(key) => *self.vertex_of.entry(*key).or_insert_with(|| add(*position)),
            None => add(*position),
        };
        let places: Vec<u32> = keys.iter().zip(&part.positions).map(place).collect();
        let of = |vertex: u32| places[vertex as usize];
        mesh.triangles.extend(part.triangles.iter().map(|corners| corners.map(of)));
        mesh.triangle_leaf.extend(part.triangle_leaf.iter().map(|leaf| first_leaf + leaf));
        mesh.outlines.extend(part.outlines.iter().map(|ends| ends.map(of)));
        mesh.leaves.extend_from_slice(&part.leaves);
        let moved = contributions.iter().map(|&(vertex, leaf, weight)| (of(vertex), first_leaf + leaf, weight));
        self.contributions.extend(moved);
    }

    /// Sorts contributions by vertex and makes each vertex's weights sum to 1.
    fn finish(self) -> (Mesh, Vec<u32>, Vec<(u32, f32)>) {
        let vertices = self.mesh.positions.len();
        let mut starts = vec![0_u32; vertices + 1];
        let mut sums = vec![0.0_f64; vertices];
        for &(vertex, _, weight) in &self.contributions {
            starts[vertex as usize + 1] += 1;
            sums[vertex as usize] += f64::from(weight);
        }
        for vertex in 0..vertices {
            starts[vertex + 1] += starts[vertex];
        }
        let mut next = starts.clone();
        let mut shares = vec![(0, 0.0); self.contributions.len()];
        for (vertex, leaf, weight) in self.contributions {
            let vertex = vertex as usize;
            let count = f64::from(starts[vertex + 1] - starts[vertex]);
            let share = if sums[vertex] > 0.0 { f64::from(weight) / sums[vertex] } else { 1.0 / count };
            shares[next[vertex] as usize] = (leaf, share as f32);
            next[vertex] += 1;
        }
        (self.mesh, starts, shares)
    }
}

fn cluster_boxes(hierarchy: &Hierarchy) -> Vec<ClusterBox> {
    let clusters = hierarchy.elements().iter().filter_map(|element| match &element.shape {
        Shape::Cluster(cluster) => Some(ClusterBox {
            lower: element.centre - cluster.half_extent,
            upper: element.centre + cluster.half_extent,
            level: cluster.level,
            polygons: hierarchy.patches_below(cluster).len() as u32,
        }),
        Shape::Patch(_) | Shape::Sky(_) => None,
    });
    clusters.collect()
}
