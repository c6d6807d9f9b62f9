//! Edits of materials on a solution that is there: all links stay but those that carry light
//! another way.

use std::sync::Arc;

use glam::Vec3;

use super::recheck::{RecheckReasons, judged_again};
use super::solution::{LinkSolution, surfaces_of};
use crate::hierarchy::{ElementId, PatchSums, Shape};
use crate::scene::{Material, MaterialId};

impl LinkSolution {
    /// Changes a material's emission B_e (W/m²). All links stay but those of clusters that now
    /// shine from other parts of them, which wait to be judged again.
    pub fn set_emission(&mut self, material: MaterialId, emission: Vec3) {
        self.edit_material(material, |material| material.emission = emission);
        let changed = self.changed_clusters(material);
        self.light.emitted = self.emitted_light().emitted;
        self.emission = self.emission_sums();
        let redirected = self.links.drain(|_, link| changed[link.source().index()]);
        let judged_again = |(receiver, link): (ElementId, _)| judged_again(receiver, &link, RecheckReasons::default());
        self.refinement.add(redirected.into_iter().map(judged_again));
    }

    /// Changes a material's reflectance ρ; all links stay.
    pub fn set_reflectance(&mut self, material: MaterialId, reflectance: Vec3) {
        self.edit_material(material, |material| material.reflectance = reflectance);
    }

    fn edit_material(&mut self, material: MaterialId, edit: impl FnOnce(&mut Material)) {
        let mut scene = (*self.scene).clone();
        edit(&mut scene.materials[material.0 as usize]);
        self.scene = Arc::new(scene);
        self.surfaces = surfaces_of(&self.scene);
        self.is_converged = false;
    }

    /// Clusters that hold faces of a material beside other lamps, or that were dark so far.
    fn changed_clusters(&self, material: MaterialId) -> Vec<bool> {
        let hierarchy = &self.hierarchy;
        let area = |&id: &ElementId| match hierarchy.element(id).shape {
            Shape::Patch(patch) if self.scene.polygons[patch.polygon as usize].material == material => {
                f64::from(hierarchy.element(id).sampled_area)
            }
            _ => 0.0,
        };
        let power = |id: &ElementId| {
            if area(id) > 0.0 { 0.0 } else { f64::from(self.light.emitted[id.index()].max_element()) }
        };
        let patches = hierarchy.initial_patches();
        let (own, others) = (PatchSums::new(patches.iter().map(area)), PatchSums::new(patches.iter().map(power)));
        let is_changed = |id: ElementId| {
            let was_dark = self.emission.of(hierarchy, id) <= 0.0;
            own.of(hierarchy, id) > 0.0 && (was_dark || others.of(hierarchy, id) > 0.0)
        };
        hierarchy.ids().map(is_changed).collect()
    }
}
