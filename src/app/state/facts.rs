//! Facts about an element: its kind, and how it is lit.

use std::sync::Arc;

use glam::Vec3;

use crate::app::words;
use crate::base::photometry;
use crate::hierarchy::{ElementId, Hierarchy, Shape};
use crate::read::names;
use crate::scene::{Material, Scene};
use crate::solve::Snapshot;
use crate::transport::SolutionView;

/// An element in numbers.
#[derive(Clone, Debug, Default)]
pub struct Facts {
    /// Name of a patch; empty for others, which links alone can name.
    pub name: String,
    /// The polygon of a patch.
    pub polygon: Option<u32>,
    /// Area that light can reach, m².
    pub area: f32,
    /// Levels below the root, clusters and patches alike; `None` while no solution view is there.
    pub level: Option<u16>,
    /// Polygons inside of a cluster.
    pub polygons: usize,
    /// Reflectance ρ, the mean over the area.
    pub reflectance: Vec3,
    /// Irradiance E as it is shown, W/m²: by the final gather once that is there, else by links.
    pub irradiance: Vec3,
    /// Irradiance E that links bring, W/m², beside that of a final gather.
    pub by_links: Option<Vec3>,
    /// Radiosity B as it is shown, W/m².
    pub radiosity: Vec3,
    /// Emitted part of B, W/m².
    pub emitted: Vec3,
}

impl Facts {
    /// All of any element.
    pub fn of(snapshot: &Snapshot, solution_view: &SolutionView, scene: &Arc<Scene>, id: ElementId) -> Self {
        let hierarchy = solution_view.hierarchy();
        let element = hierarchy.element(id);
        let by_links = solution_view.irradiance(id);
        let gathered = snapshot.field.is_some().then(|| mean_light(snapshot, |leaf| is_below(hierarchy, leaf, id)));
        let gathered = gathered.flatten();
        let lit = Self {
            area: element.area,
            level: Some(solution_view.depth(id)),
            irradiance: gathered.map_or(by_links, |light| light.irradiance),
            by_links: gathered.map(|_| by_links),
            radiosity: gathered.map_or_else(|| solution_view.radiosity(id), |light| light.radiosity),
            emitted: solution_view.emitted(id),
            ..Self::default()
        };
        match &element.shape {
            Shape::Patch(patch) => lit.with_polygon(scene, patch.polygon),
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
    pub fn of_leaf(snapshot: &Snapshot, scene: &Arc<Scene>, id: ElementId) -> Option<Self> {
        let leaf = snapshot.mesh.leaves.iter().find(|leaf| leaf.element == id)?;
        let light = mean_light(snapshot, |leaf| leaf == id)?;
        let lit =
            Self { area: light.area, irradiance: light.irradiance, radiosity: light.radiosity, ..Self::default() };
        Some(lit.with_polygon(scene, leaf.polygon))
    }

    fn with_polygon(self, scene: &Arc<Scene>, polygon: u32) -> Self {
        Self {
            name: names::of_polygon(&scene.as_arranged(), polygon),
            reflectance: material(scene, polygon).map_or(Vec3::ZERO, |material| material.reflectance),
            polygon: Some(polygon),
            polygons: 1,
            ..self
        }
    }

    /// Irradiances with their names and what they mean: one, or that of the final gather beside
    /// that of the links below it.
    pub fn irradiances(&self) -> Vec<(&'static str, Vec3, &'static str)> {
        match self.by_links {
            None => vec![(words::E, self.irradiance, "Irradiance of the three channels, the mean over the area")],
            Some(by_links) => vec![
                (
                    words::E_BY_GATHER,
                    self.irradiance,
                    "Irradiance that the final gather finds, mean over the area: what is shown",
                ),
                (
                    words::E_BY_LINKS,
                    by_links,
                    "Irradiance that the links bring, mean over the area: coarser, and what the final gather starts from",
                ),
            ],
        }
    }

    /// Illuminance, lx.
    pub fn illuminance(&self) -> f32 {
        photometry::lux(self.irradiance.into())
    }

    /// Luminance L = B/π, cd/m².
    pub fn luminance(&self) -> f32 {
        photometry::lux(self.radiosity.into()) / std::f32::consts::PI
    }
}

/// Light of some leaves of the mesh in view.
#[derive(Clone, Copy)]
struct MeanLight {
    /// Area that light can reach, m².
    area: f32,
    /// Mean irradiance over the area, W/m².
    irradiance: Vec3,
    /// Mean radiosity over the area, W/m².
    radiosity: Vec3,
}

/// Light of the leaves whose elements are chosen; `None` where they have no area.
fn mean_light(snapshot: &Snapshot, is_chosen: impl Fn(ElementId) -> bool) -> Option<MeanLight> {
    let light = snapshot.leaf_irradiance.iter().zip(&snapshot.leaf_radiosity);
    let (mut irradiance, mut radiosity, mut area) = (Vec3::ZERO, Vec3::ZERO, 0.0);
    for (leaf, (received, sent)) in snapshot.mesh.leaves.iter().zip(light) {
        if is_chosen(leaf.element) {
            irradiance += leaf.reachable_area * Vec3::from(*received);
            radiosity += leaf.reachable_area * Vec3::from(*sent);
            area += leaf.reachable_area;
        }
    }
    (area > 0.0).then(|| MeanLight { area, irradiance: irradiance / area, radiosity: radiosity / area })
}

/// Whether an element is another one or a part of it.
fn is_below(hierarchy: &Hierarchy, part: ElementId, whole: ElementId) -> bool {
    std::iter::successors(Some(part), |&at| hierarchy.element(at).parent()).any(|at| at == whole)
}

fn material(scene: &Scene, polygon: u32) -> Option<&Material> {
    let polygon = scene.polygons.get(polygon as usize)?;
    scene.materials.get(polygon.material.0 as usize)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::builtin::BuiltinScene;
    use crate::solve::{Solver, SolverParams};

    /// Truth: the field's own irradiance over its own mesh, and the links' sum; of the whole scene
    /// both are means over all leaves.
    #[test]
    fn the_gathered_irradiance_stands_beside_that_of_the_links() {
        let scene = Arc::new(BuiltinScene::Cornell.build());
        let params = SolverParams { error: Some(0.1), ..SolverParams::usual() };
        let snapshot = Solver::solved(scene.clone(), params).snapshot();
        let solution_view = snapshot.solution_view.clone().expect("it was asked for");
        let facts = |id| Facts::of(&snapshot, &solution_view, &scene, id);
        let whole = facts(Hierarchy::ROOT);
        let (mut sum, mut area) = (Vec3::ZERO, 0.0);
        for (leaf, irradiance) in snapshot.mesh.leaves.iter().zip(&snapshot.leaf_irradiance) {
            sum += leaf.reachable_area * Vec3::from(*irradiance);
            area += leaf.reachable_area;
        }
        assert!(whole.irradiance.abs_diff_eq(sum / area, 1e-4 * whole.irradiance.max_element()));
        let names: Vec<&str> = whole.irradiances().iter().map(|(name, ..)| *name).collect();
        assert_eq!(names, [words::E_BY_GATHER, words::E_BY_LINKS]);
        let mut differ = 0;
        for id in solution_view.hierarchy().initial_patches() {
            let of = facts(*id);
            let by_links: Vec3 = solution_view.all_incoming(*id).iter().map(|link| link.irradiance).sum();
            let shown = of.by_links.expect("a final gather is there");
            assert!(shown.abs_diff_eq(by_links, 5e-3 * by_links.max_element().max(1e-3)), "{shown} {by_links}");
            differ += usize::from(!shown.abs_diff_eq(of.irradiance, 1e-3 * shown.max_element()));
        }
        assert!(differ > 0, "the gather finds what links blur");
    }
}
