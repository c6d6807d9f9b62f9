//! Snapshots, which the solver hands up to be looked at: a mesh with vertex radiosities, clusters,
//! links of one element, numbers.
//!
//! A snapshot is immutable and complete in itself; a view needs nothing else of the solver.

use std::sync::Arc;

use glam::Vec3;

use super::stats::Stats;
use crate::gather::Field;
use crate::hierarchy::ElementId;
use crate::scene::MaterialId;
use crate::transport::SolutionView;

/// One state of the solution, valid for what is there.
#[derive(Clone, Debug, Default)]
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
    /// The former step that it shows ([`super::Solver::snapshot_of`]); `None` for the present.
    pub former_step: Option<usize>,
    /// The field that readings gather over; `None` until a final gather has ended.
    pub field: Option<Arc<Field>>,
    /// Elements and links of this state, where somebody asked for them.
    pub solution_view: Option<Arc<SolutionView>>,
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
    /// Facts about each leaf.
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
    pub reachable_area: f32,
    /// Subdivision level below the initial patch, which is level 0.
    pub level: u8,
}

impl Mesh {
    /// Positions of a triangle's corners.
    pub fn corners(&self, triangle: [u32; 3]) -> [Vec3; 3] {
        triangle.map(|vertex| Vec3::from(self.positions[vertex as usize]))
    }
}

#[cfg(test)]
impl Leaf {
    /// A square metre of a polygon that light reaches everywhere.
    pub(crate) fn square_metre(element: u32, polygon: u32) -> Self {
        let (element, material) = (ElementId(element), MaterialId(0));
        Self { element, polygon, material, area: 1.0, reachable_area: 1.0, level: 0 }
    }
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
