//! Facts about an element: its kind, and how it is lit.

use glam::Vec3;

use crate::base::photometry;
use crate::hierarchy::{ElementId, Shape};
use crate::read::names::of_material;
use crate::scene::{Material, Scene};
use crate::solve::Snapshot;
use crate::transport::SolutionView;

/// An element in numbers.
#[derive(Clone, Debug)]
pub(in crate::app) struct Facts {
    /// The material of a patch.
    pub material: Option<String>,
    /// The polygon of a patch.
    pub polygon: Option<u32>,
    /// Path of the patch's group; empty for the root group.
    pub group: String,
    /// Area that light can reach, m².
    pub area: f32,
    /// Levels below the root; `None` while no solution view is there.
    pub depth: Option<u16>,
    /// Subdivision level of a patch below its polygon.
    pub level: Option<u8>,
    /// Polygons inside of a cluster.
    pub polygons: usize,
    /// Reflectance ρ, the mean over the area.
    pub reflectance: Vec3,
    /// Irradiance E, W/m².
    pub irradiance: Vec3,
    /// Radiosity B, W/m².
    pub radiosity: Vec3,
    /// Emitted part of B, W/m².
    pub emitted: Vec3,
}

impl Facts {
    /// All of any element.
    pub(in crate::app) fn of(solution_view: &SolutionView, scene: &Scene, id: ElementId) -> Self {
        let hierarchy = solution_view.hierarchy();
        let element = hierarchy.element(id);
        let lit = Self {
            area: element.area,
            depth: Some(solution_view.depth(id)),
            irradiance: solution_view.irradiance(id),
            radiosity: solution_view.radiosity(id),
            emitted: solution_view.emitted(id),
            ..Self::unlit()
        };
        match &element.shape {
            Shape::Patch(patch) => Self { level: Some(patch.level), ..lit.with_polygon(scene, patch.polygon) },
            Shape::Sky(_) => lit,
            Shape::Cluster(cluster) => {
                let below = hierarchy.patches_below(cluster);
                let (mut sum, mut area) = (Vec3::ZERO, 0.0);
                for &id in below {
                    let element = hierarchy.element(id);
                    if let Shape::Patch(patch) = &element.shape {
                        let material = material(scene, patch.polygon);
                        sum += element.area * material.map_or(Vec3::ZERO, |material| material.reflectance);
                        area += element.area;
                    }
                }
                let reflectance = if area > 0.0 { sum / area } else { Vec3::ZERO };
                Self { polygons: below.len(), reflectance, ..lit }
            }
        }
    }

    /// Facts about a leaf that a snapshot alone tells.
    pub(in crate::app) fn of_leaf(snapshot: &Snapshot, scene: &Scene, id: ElementId) -> Option<Self> {
        let index = snapshot.mesh.leaves.iter().position(|leaf| leaf.element == id)?;
        let leaf = snapshot.mesh.leaves[index];
        let light = |of: &[[f32; 3]]| of.get(index).copied().map_or(Vec3::ZERO, Vec3::from);
        let lit = Self {
            area: leaf.exposed_area,
            level: Some(leaf.level),
            irradiance: light(&snapshot.leaf_irradiance),
            radiosity: light(&snapshot.leaf_radiosity),
            ..Self::unlit()
        };
        Some(lit.with_polygon(scene, leaf.polygon))
    }

    /// Name of the element in a word or two.
    pub(in crate::app) fn name(&self) -> String {
        match (&self.material, self.group.as_str()) {
            (Some(material), "") => material.clone(),
            (Some(material), group) => of_material(group.rsplit('/').next().unwrap_or(group), material),
            (None, _) => format!("cluster of {}", crate::base::format::things(self.polygons, "polygon", "polygons")),
        }
    }

    fn unlit() -> Self {
        Self {
            material: None,
            polygon: None,
            group: String::new(),
            area: 0.0,
            depth: None,
            level: None,
            polygons: 0,
            reflectance: Vec3::ZERO,
            irradiance: Vec3::ZERO,
            radiosity: Vec3::ZERO,
            emitted: Vec3::ZERO,
        }
    }

    fn with_polygon(self, scene: &Scene, polygon: u32) -> Self {
        let material = material(scene, polygon);
        Self {
            material: material.map(|material| material.name.clone()),
            reflectance: material.map_or(Vec3::ZERO, |material| material.reflectance),
            polygon: Some(polygon),
            group: scene.polygons.get(polygon as usize).map_or_else(String::new, |of| scene.group_path(of.group)),
            polygons: 1,
            ..self
        }
    }

    /// Illuminance, lx.
    pub(in crate::app) fn illuminance(&self) -> f32 {
        photometry::lux(self.irradiance.into())
    }

    /// Luminance L = B/π, cd/m².
    pub(in crate::app) fn luminance(&self) -> f32 {
        photometry::lux(self.radiosity.into()) / std::f32::consts::PI
    }
}

fn material(scene: &Scene, polygon: u32) -> Option<&Material> {
    let polygon = scene.polygons.get(polygon as usize)?;
    scene.materials.get(polygon.material.0 as usize)
}
