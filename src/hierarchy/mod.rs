//! The hierarchy: one arena of elements, from the root cluster over initial patches down to the
//! leaves of their subdivision.
//!
//! Sillion's unified hierarchy (paper, sections 1.2 and 2.1): a cluster holds clusters and initial
//! patches, a patch holds only the four patches it was split into. The part above the initial
//! patches is built once ([`ClusteringMode`]); the part below grows while links are refined
//! ([`Hierarchy::subdivide`]). This module imports `base`, `scene` and `geometry`.

mod adaptive;
mod build;
mod grouping;
mod groups;
mod merge_back;
mod octree;
mod order;
mod patch;
mod sample;
mod sky;
mod surface;

use glam::Vec3;
use rustc_hash::FxHashMap;
use serde::{Deserialize, Serialize};

use std::sync::Arc;

use crate::base::random::hash64;
use crate::geometry::Reachability;
use crate::scene::Scene;
use sky::Surroundings;

pub use merge_back::Renumbering;
pub use order::{Order, Room};
pub use patch::Patch;
pub use sample::{PatchSums, SurfacePoint, point_on_polygon};
pub use sky::{DEEPEST_SKY, SkyPart};

/// How the part of the hierarchy above the initial patches is built.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum ClusteringMode {
    /// Plain Hierarchical Radiosity: every pair of initial patches is a candidate (Table 1, HR).
    None,
    /// Uniform octree of the bounding box, the root being level 1 (Table 2, OCTREE).
    Octree,
    /// The scene's own groups (Table 2, USER).
    Groups,
    /// Surface-area heuristic over centroids, boxes may overlap (the paper's future work).
    #[default]
    Adaptive,
}

/// Index of an element in the hierarchy's arena; the root cluster is [`Hierarchy::ROOT`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct ElementId(pub u32);

impl ElementId {
    /// The element's place in any table that is parallel to the arena.
    #[inline]
    pub fn index(self) -> usize {
        self.0 as usize
    }
}

/// A cluster: a box around polygons, which scatters like an isotropic volume (section 1.2).
#[derive(Clone, Copy, Debug)]
pub struct Cluster {
    /// Half the box's extent along each axis; the centre is the element's.
    pub half_extent: Vec3,
    /// Depth below the root, which is level 0.
    pub level: u16,
    /// Place among the clusters, in the order of the elements.
    pub number: u32,
    /// First of the initial patches below, in [`Hierarchy::initial_patches`].
    first_patch: u32,
    /// Number of initial patches below.
    patch_count: u32,
}

impl Cluster {
    /// Places of the initial patches below, in [`Hierarchy::initial_patches`].
    pub fn patches(&self) -> std::ops::Range<usize> {
        let first = self.first_patch as usize;
        first..first + self.patch_count as usize
    }
}

/// Kind of an element.
#[derive(Clone, Copy, Debug)]
pub enum Shape {
    /// A group of elements.
    Cluster(Cluster),
    /// A planar triangle or quad.
    Patch(Patch),
    /// A part of what lies outside of the scene, by its number ([`Hierarchy::sky_part`]).
    Sky(u32),
}

/// A node of the hierarchy.
#[derive(Clone, Copy, Debug)]
pub struct Element {
    parent: u32,
    first_child: u32,
    child_count: u32,
    /// Area that light can reach ([`Reachability`]), m²; a cluster's is the sum of its polygons'
    /// (the "equivalent area" of section 2.1).
    pub area: f32,
    /// Area over which its random points are spread, m²: `area` and, where an edge of what hides it
    /// runs, some of the hidden area beside it.
    pub sampled_area: f32,
    /// Centroid of a patch, centre of a cluster's box; of a part of the outside a point far away in
    /// its direction.
    pub centre: Vec3,
    /// Tells what the element is whatever its index: seeds the rays of its links.
    pub key: u64,
    /// Cluster or patch.
    pub shape: Shape,
}

/// Stands for "no parent".
const NO_PARENT: u32 = u32::MAX;

impl Element {
    /// Whether the element is a cluster.
    pub fn is_cluster(&self) -> bool {
        matches!(self.shape, Shape::Cluster(_))
    }

    /// Whether the element is a patch.
    pub fn is_patch(&self) -> bool {
        matches!(self.shape, Shape::Patch(_))
    }

    /// Whether the element is a part of what lies outside.
    pub fn is_sky(&self) -> bool {
        matches!(self.shape, Shape::Sky(_))
    }

    /// Whether the element has no children.
    pub fn is_leaf(&self) -> bool {
        self.child_count == 0
    }

    /// Share of the element's random points that light can reach.
    pub fn reachable_share(&self) -> f32 {
        if self.sampled_area > 0.0 { self.area / self.sampled_area } else { 1.0 }
    }

    /// The enclosing element; `None` for the root and for what lies outside.
    pub fn parent(&self) -> Option<ElementId> {
        (self.parent != NO_PARENT).then_some(ElementId(self.parent))
    }

    /// The children; empty for a leaf.
    pub fn children(&self) -> impl ExactSizeIterator<Item = ElementId> + Clone + use<> {
        (self.first_child..self.first_child + self.child_count).map(ElementId)
    }
}

/// The arena of elements with the vertices of its patches.
#[derive(Clone)]
pub struct Hierarchy {
    elements: Vec<Element>,
    vertices: Vec<Vec3>,
    /// Vertex in the middle of a split edge, by the edge's ends (smaller index first).
    midpoints: FxHashMap<(u32, u32), u32>,
    /// Initial patches such that those below any one cluster lie together.
    initial_patches: Vec<ElementId>,
    /// Sampled areas of the initial patches, m².
    area_sums: PatchSums,
    reachability: Arc<Reachability>,
    cluster_count: usize,
    leaf_count: usize,
    /// Vertices of the initial patches, which come first.
    initial_vertices: usize,
    smooth_surfaces: Arc<Vec<u32>>,
    /// The sky and the sun as elements.
    around: Option<Surroundings>,
}

impl Hierarchy {
    /// The root cluster.
    pub const ROOT: ElementId = ElementId(0);

    /// Builds the clusters over a scene's polygons, which become the initial patches; what
    /// `reachability` says is hidden counts as no area.
    pub fn new(scene: &Scene, reachability: Arc<Reachability>, mode: ClusteringMode, octree_depth: u32) -> Self {
        build::build(scene, reachability, mode, octree_depth)
    }

    /// Which parts of the polygons are hidden.
    pub fn reachability(&self) -> &Arc<Reachability> {
        &self.reachability
    }

    /// The smooth, same-material surface that each polygon of the scene belongs to, as the smallest
    /// number of a polygon on it.
    pub fn smooth_surfaces(&self) -> &[u32] {
        &self.smooth_surfaces
    }

    /// The element with this id.
    #[inline]
    pub fn element(&self, id: ElementId) -> &Element {
        &self.elements[id.index()]
    }

    /// All elements; a parent precedes its children.
    pub fn elements(&self) -> &[Element] {
        &self.elements
    }

    /// Ids of all elements.
    pub fn ids(&self) -> impl DoubleEndedIterator<Item = ElementId> + ExactSizeIterator + Clone + use<> {
        (0..self.elements.len() as u32).map(ElementId)
    }

    /// Vertex positions that [`Patch::corners`] refer to.
    pub fn vertices(&self) -> &[Vec3] {
        &self.vertices
    }

    /// The initial patches, those below any one cluster side by side.
    pub fn initial_patches(&self) -> &[ElementId] {
        &self.initial_patches
    }

    /// The initial patches below a cluster.
    pub fn patches_below(&self, cluster: &Cluster) -> &[ElementId] {
        &self.initial_patches[cluster.patches()]
    }

    /// Number of clusters.
    pub fn cluster_count(&self) -> usize {
        self.cluster_count
    }

    /// Number of leaf patches.
    pub fn leaf_count(&self) -> usize {
        self.leaf_count
    }

    /// The vertex in the middle of the edge between two vertices, if a patch on either side was
    /// split there.
    pub fn midpoint(&self, a: u32, b: u32) -> Option<u32> {
        self.midpoints.get(&(a.min(b), a.max(b))).copied()
    }

    /// Whether any patch was split.
    pub fn is_subdivided(&self) -> bool {
        !self.midpoints.is_empty()
    }

    /// Memory of elements and vertices, bytes.
    pub fn bytes(&self) -> usize {
        size_of_val(&self.elements[..])
            + size_of_val(&self.vertices[..])
            + size_of_val(&self.initial_patches[..])
            + self.area_sums.bytes()
            + self.reachability.bytes()
            + self.midpoints.len() * size_of::<((u32, u32), u32)>()
            + self.around.as_ref().map_or(0, Surroundings::bytes)
    }

    /// The hierarchy as it was when it had so many elements and vertices; both tables only grow.
    pub fn as_of(&self, elements: usize, vertices: usize) -> Self {
        let mut former: Vec<Element> = self.elements[..elements].to_vec();
        for element in &mut former {
            if element.first_child as usize >= elements {
                (element.first_child, element.child_count) = (0, 0);
            }
        }
        let is_leaf = |element: &&Element| element.is_leaf() && element.is_patch();
        Self {
            leaf_count: former.iter().filter(is_leaf).count(),
            elements: former,
            vertices: self.vertices[..vertices].to_vec(),
            midpoints: self
                .midpoints
                .iter()
                .filter(|&(_, &at)| (at as usize) < vertices)
                .map(|(k, v)| (*k, *v))
                .collect(),
            initial_patches: self.initial_patches.clone(),
            area_sums: self.area_sums.clone(),
            reachability: self.reachability.clone(),
            cluster_count: self.cluster_count,
            initial_vertices: self.initial_vertices,
            smooth_surfaces: self.smooth_surfaces.clone(),
            around: self.around.clone(),
        }
    }

    /// Splits a leaf patch or a part of the sky into four, unless it has been split already;
    /// clusters are left as they are.
    pub fn subdivide(&mut self, id: ElementId) {
        let parent = *self.element(id);
        let Shape::Patch(patch) = parent.shape else { return self.subdivide_sky(id) };
        if !parent.is_leaf() {
            return;
        }
        let first_child = self.elements.len() as u32;
        let quarters = self.quarters(&patch);
        for (index, mut quarter) in quarters.into_iter().enumerate() {
            quarter.cells = self.reachability.of_quarter(patch.cells, index as u32);
            let mut child = self.patch_element(quarter, hash64(parent.key, index as u64 + 1));
            child.parent = id.0;
            self.elements.push(child);
        }
        let element = &mut self.elements[id.index()];
        (element.first_child, element.child_count) = (first_child, 4);
        self.leaf_count += 3;
    }
}
