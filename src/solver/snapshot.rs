//! What the solver hands up to be looked at: a mesh with vertex radiosities, clusters, links of one element, numbers.
//!
//! A snapshot is immutable and complete in itself; a view needs nothing else of the solver.

use std::sync::Arc;

use glam::Vec3;

use super::stats::Stats;
use crate::hierarchy::ElementId;
use crate::scene::MaterialId;

/// One state of the solution, valid for what is there.
#[derive(Clone, Debug)]
pub struct Snapshot {
    /// Counts up with each scene or rebuilt hierarchy; a view drops what carries an older one.
    pub generation: u64,
    /// Counts up with each snapshot of a generation.
    pub serial: u64,
    /// Triangles to draw; shared between snapshots as long as nothing was subdivided.
    pub mesh: Arc<Mesh>,
    /// Radiosity B of each mesh vertex, W/m², linear RGB.
    pub vertex_radiosity: Vec<[f32; 3]>,
    /// Irradiance E of each mesh vertex, W/m², linear RGB.
    pub vertex_irradiance: Vec<[f32; 3]>,
    /// Irradiance E of each leaf, W/m²; parallel to [`Mesh::leaves`].
    pub leaf_irradiance: Vec<[f32; 3]>,
    /// Radiosity B of each leaf, W/m²; parallel to [`Mesh::leaves`].
    pub leaf_radiosity: Vec<[f32; 3]>,
    /// Boxes of the clusters; shared like the mesh.
    pub clusters: Arc<Vec<ClusterBox>>,
    /// Links of the element that was asked for, if one was.
    pub inspected: Option<InspectedElement>,
    /// Counts and times.
    pub stats: Stats,
}

/// The leaves of the hierarchy as triangles without cracks: hanging vertices are triangulated in.
#[derive(Clone, Debug, Default)]
pub struct Mesh {
    /// Vertex positions; a vertex belongs to one smooth surface of one material.
    pub positions: Vec<[f32; 3]>,
    /// Three vertex indices each, anticlockwise from the bright side.
    pub triangles: Vec<[u32; 3]>,
    /// The leaf (index into `leaves`) of each triangle.
    pub triangle_leaf: Vec<u32>,
    /// Ends of the outlines of all leaves, as vertex index pairs.
    pub outlines: Vec<[u32; 2]>,
    /// What a person can ask about each leaf.
    pub leaves: Vec<Leaf>,
}

/// A leaf element as a view shows it.
#[derive(Clone, Copy, Debug)]
pub struct Leaf {
    /// The element.
    pub element: ElementId,
    /// The initial patch's polygon, as an index into [`crate::scene::Scene::polygons`].
    pub polygon: u32,
    /// Material of the bright side.
    pub material: MaterialId,
    /// Area, m².
    pub area: f32,
    /// Area of it that light can reach, m².
    pub exposed_area: f32,
    /// Subdivision level below the initial patch, which is level 0.
    pub level: u8,
}

/// A cluster's bounding box.
#[derive(Clone, Copy, Debug)]
pub struct ClusterBox {
    /// Lower corner.
    pub lower: Vec3,
    /// Upper corner.
    pub upper: Vec3,
    /// Depth below the root, which is level 0.
    pub level: u16,
    /// Polygons inside.
    pub polygons: u32,
}

/// An element with the links that bring it light, its own and its ancestors'.
#[derive(Clone, Debug)]
pub struct InspectedElement {
    /// The element that was asked for.
    pub element: ElementId,
    /// Its centre.
    pub centre: Vec3,
    /// Links, strongest power first.
    pub links: Vec<LinkView>,
}

/// One link as a view draws it.
#[derive(Clone, Copy, Debug)]
pub struct LinkView {
    /// The receiving element: the inspected one or one of its ancestors.
    pub receiver: ElementId,
    /// The element that sends.
    pub source: ElementId,
    /// Centre of the receiver.
    pub receiver_centre: Vec3,
    /// Centre of the source.
    pub source_centre: Vec3,
    /// Whether the source is a cluster.
    pub source_is_cluster: bool,
    /// Form factor F(r←s) without occlusion.
    pub form_factor: f32,
    /// Visibility V.
    pub visibility: f32,
    /// Power carried to the whole receiver, B_s·F·V·A_r, W (largest colour).
    pub power: f32,
    /// How many levels above the inspected element the receiver lies; 0 for the element itself.
    pub levels_up: u16,
    /// Whether the receiver is a cluster.
    pub receiver_is_cluster: bool,
    /// What the link brings to the inspected element, W/m²; over all links this adds up to its irradiance E.
    pub irradiance: Vec3,
}
