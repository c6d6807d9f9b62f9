//! Changes while a solution is there: what is still valid stays.

use std::sync::Arc;

use glam::Vec3;

use super::candidate::Candidate;
use super::link::LinkTable;
use super::params::{Invalidates, SolverParams};
use super::picture::Picture;
use super::refine::Refinement;
use super::stats::{Phase, Seconds};
use super::{Solver, SolverError, judged_again, surfaces_of, timed, watts};
use crate::hierarchy::{ElementId, Hierarchy, PatchSums, Shape};
use crate::scene::MaterialId;

impl Solver {
    /// Takes over new parameters with the least work that suffices; false when hierarchy or scene must be rebuilt by a new
    /// solver, which then takes over.
    ///
    /// # Errors
    /// Parameters out of range; the present ones stay.
    pub fn set_params(&mut self, params: SolverParams) -> Result<bool, SolverError> {
        params.validate()?;
        let change = self.params.change_to(&params);
        if self.params.threshold() != params.threshold() {
            self.epsilon_watts = watts(&params, &self.scene);
        }
        self.params = params;
        match change {
            Invalidates::Nothing => {}
            Invalidates::Radiosities | Invalidates::Verdicts => self.resume(),
            Invalidates::Links => self.restart_from_root(),
            Invalidates::Hierarchy | Invalidates::Scene => return Ok(false),
        }
        Ok(true)
    }

    /// Changes a material's emission B_e (W/m²); ε in watts stays, and so do all links but those of clusters that now shine
    /// from other parts of them.
    pub fn set_emission(&mut self, material: MaterialId, emission: Vec3) {
        let mut scene = (*self.scene).clone();
        scene.materials[material.0 as usize].emission = emission;
        self.scene = Arc::new(scene);
        self.surfaces = surfaces_of(&self.scene);
        let changed = self.changed_clusters(material);
        self.light.emitted = self.emitted_light().emitted;
        self.emission = self.emission_sums();
        let redirected = self.links.drain(|_, link| changed[link.source().index()]);
        self.refinement.add(redirected.into_iter().map(|(receiver, link)| judged_again(receiver, &link, false)));
        if self.epsilon_watts <= 0.0 {
            // There was no light to measure ε by.
            self.epsilon_watts = watts(&self.params, &self.scene);
        }
        self.resume();
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

    /// Goes on with what is there after a change that leaves candidates and links valid.
    fn resume(&mut self) {
        self.gathers_finely = false;
        self.final_gather = None;
        if !self.refinement.is_finished() {
            self.phase = Phase::Refine;
        } else if matches!(self.phase, Phase::Done | Phase::Reconstruct) {
            self.phase = Phase::Gather;
        }
    }

    /// Refines again from the root's self-link, on the same clusters, judging by the radiosities that are known.
    fn restart_from_root(&mut self) {
        let known = self.light.radiosity[..].to_vec();
        let scene = self.scene.clone();
        let exposure = self.hierarchy.exposure().clone();
        let (hierarchy, seconds) =
            timed(|| Hierarchy::new(&scene, exposure, self.params.clustering, self.params.octree_depth));
        self.hierarchy = hierarchy;
        // Another solve begins, so it counts from zero.
        self.seconds = Seconds { load: self.seconds.load, hierarchy: seconds, total: seconds, ..Seconds::default() };
        self.iterations = 0;
        self.clamped_leaves = 0;
        self.light = self.emitted_light();
        self.emission = self.emission_sums();
        // Clusters and initial patches come first and in the same order as before.
        for (radiosity, known) in self.light.radiosity.iter_mut().zip(known) {
            *radiosity = known;
        }
        self.links = LinkTable::default();
        self.refinement = Refinement::default();
        self.refinement.start([Candidate::root()]);
        self.fix_brightness();
        self.picture = Picture::default();
        self.display = None;
        self.final_gather = None;
        self.phase = Phase::Refine;
        self.stage = 0;
        self.gathers_finely = false;
        self.frozen = None;
        self.restart_history();
    }
}
