//! The light that surfaces send, as gathers read it: one irradiance for each leaf.

use std::sync::Arc;

use glam::Vec3;

use super::sources::Sources;
use crate::geometry::Occluders;
use crate::hierarchy::{ElementId, Hierarchy, Patch, Shape};
use crate::scene::Scene;
use crate::solver::Surface;

/// Errors of places that are darker than this share of the median are relative to it.
const DIM_SHARE: f32 = 0.1;

/// A solved radiosity field; immutable.
pub struct Field {
    scene: Arc<Scene>,
    occluders: Arc<Occluders>,
    surfaces: Vec<Surface>,
    pub(super) hierarchy: Hierarchy,
    /// The initial patch of each polygon.
    patches: Vec<ElementId>,
    /// What each leaf reflects, ρE, W/m², parallel to the arena; 0 for what is no leaf.
    pub(super) reflected: Vec<Vec3>,
    /// What is aimed at.
    pub(super) sources: Sources,
    /// E₀, a tenth of the area's median irradiance (mean of the colours), W/m².
    dim: f32,
}

impl std::fmt::Debug for Field {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Field").field("leaves", &self.hierarchy.leaf_count()).finish_non_exhaustive()
    }
}

/// Where a ray ends.
#[derive(Clone, Copy, Debug)]
pub struct Met {
    /// The leaf.
    pub leaf: ElementId,
    /// Where on it.
    pub position: Vec3,
}

impl Field {
    /// The field of a solution: `irradiance` is that of each leaf, W/m², parallel to the hierarchy's arena.
    pub fn new(scene: &Arc<Scene>, occluders: &Arc<Occluders>, hierarchy: Hierarchy, irradiance: &[Vec3]) -> Self {
        let surface = |polygon: &crate::scene::Polygon| {
            let surface = scene.surface(polygon);
            Surface { reflectance: surface.reflectance, emission: surface.emission }
        };
        let surfaces: Vec<Surface> = scene.polygons.iter().map(surface).collect();
        let mut patches = vec![Hierarchy::ROOT; scene.polygons.len()];
        for &id in hierarchy.initial_patches() {
            if let Shape::Patch(patch) = hierarchy.element(id).shape {
                patches[patch.polygon as usize] = id;
            }
        }
        let reflect = |(element, irradiance): (&crate::hierarchy::Element, &Vec3)| match element.shape {
            Shape::Patch(patch) if element.is_leaf() => {
                surfaces[patch.polygon as usize].reflectance * irradiance.max(Vec3::ZERO)
            }
            _ => Vec3::ZERO,
        };
        let reflected: Vec<Vec3> = hierarchy.elements().iter().zip(irradiance).map(reflect).collect();
        let sources = Sources::new(&hierarchy, &surfaces, &reflected);
        let dim = DIM_SHARE * median(&hierarchy, &surfaces, irradiance);
        Self {
            scene: scene.clone(),
            occluders: occluders.clone(),
            surfaces,
            hierarchy,
            patches,
            reflected,
            sources,
            dim,
        }
    }

    /// E₀: local errors are relative to E + E₀ (mean of the colours), W/m².
    pub fn dim(&self) -> f32 {
        self.dim
    }

    /// Reflectance and emission of a polygon.
    pub fn surface(&self, polygon: u32) -> &Surface {
        &self.surfaces[polygon as usize]
    }

    /// Unit normal of a polygon.
    pub fn normal(&self, polygon: u32) -> Vec3 {
        self.scene.normal(&self.scene.polygons[polygon as usize])
    }

    /// Memory, bytes.
    pub fn bytes(&self) -> usize {
        self.hierarchy.bytes()
            + self.sources.bytes()
            + size_of_val(&self.surfaces[..])
            + size_of_val(&self.patches[..])
            + size_of_val(&self.reflected[..])
    }

    /// The bright side that a ray from a face meets; `None` where no light comes from.
    pub(super) fn meet(&self, point: Vec3, normal: Vec3, direction: Vec3) -> Option<Met> {
        let hit = self.occluders.ray_from(point, normal, direction)?;
        if !hit.front {
            return None;
        }
        let position = point + hit.distance * direction;
        Some(Met { leaf: self.hierarchy.leaf_at(self.patches[hit.polygon as usize], position), position })
    }

    /// Whether nothing stands between two points of faces with these normals.
    pub(super) fn sees(&self, from: (Vec3, Vec3), to: (Vec3, Vec3)) -> bool {
        self.occluders.sees(from, to)
    }

    /// The patch that a leaf is.
    pub(super) fn patch(&self, leaf: ElementId) -> &Patch {
        match &self.hierarchy.element(leaf).shape {
            Shape::Patch(patch) => patch,
            Shape::Cluster(_) => unreachable!("leaves are patches"),
        }
    }
}

/// The area's median irradiance, mean of the colours, of leaves that do not emit, W/m².
fn median(hierarchy: &Hierarchy, surfaces: &[Surface], irradiance: &[Vec3]) -> f32 {
    let of_leaf = |(element, irradiance): (&crate::hierarchy::Element, &Vec3)| match element.shape {
        Shape::Patch(patch) if element.is_leaf() && element.area > 0.0 => {
            let emits = surfaces[patch.polygon as usize].emission != Vec3::ZERO;
            (!emits).then_some((irradiance.element_sum() / 3.0, element.area))
        }
        _ => None,
    };
    let mut sorted: Vec<(f32, f32)> = hierarchy.elements().iter().zip(irradiance).filter_map(of_leaf).collect();
    sorted.sort_by(|a, b| a.0.total_cmp(&b.0));
    let half = 0.5 * sorted.iter().map(|(_, area)| f64::from(*area)).sum::<f64>();
    let mut below = 0.0;
    let middle = sorted.iter().find(|(_, area)| {
        below += f64::from(*area);
        below >= half
    });
    middle.map_or(0.0, |(value, _)| *value)
}
