//! Changes while a solution is there: what is still valid stays.

use std::sync::Arc;

use glam::Vec3;

use super::candidate::Candidate;
use super::change::{Doubts, Invalidates};
use super::gather::pull;
use super::link::LinkTable;
use super::params::{Reconstruct, SolverParams};
use super::picture::Picture;
use super::refine::Refinement;
use super::rounds::judged_again;
use super::stats::{Phase, Seconds};
use super::{Solver, SolverError, surfaces_of, timed, watts};
use crate::hierarchy::{ElementId, PatchSums, Shape};
use crate::scene::{Material, MaterialId};

impl Solver {
    /// Takes over new parameters with the least work that suffices; false when hierarchy or scene must be rebuilt, by
    /// [`Self::rebuilt`] or a new solver, which then takes over: this one stays as it is.
    ///
    /// # Errors
    /// Parameters out of range; the present ones stay.
    pub fn set_params(&mut self, params: SolverParams) -> Result<bool, SolverError> {
        params.validate()?;
        let is_anchored_anew = self.params.threshold() != params.threshold();
        let epsilon = if is_anchored_anew { watts(&params, self.largest_power()) } else { self.epsilon_watts };
        // More memory is more only where it was missing.
        let memory = if self.memory_stop.is_some() { self.params.memory } else { params.memory };
        let present = SolverParams { memory, ..self.params };
        let change = present.change_to(&params, [self.epsilon_watts, epsilon]);
        if change.cost >= Invalidates::Hierarchy {
            return Ok(false);
        }
        let was_gathered = self.params.shown_by() == Reconstruct::Gather;
        let is_moved = self.params.push != params.push || was_gathered;
        self.params = params;
        self.epsilon_watts = epsilon;
        if is_anchored_anew {
            self.anchor_watts = self.largest_power();
        }
        self.merges_back |= change.merges_back;
        self.doubts = self.doubts.and(change.doubts);
        match change.cost {
            Invalidates::Verdicts | Invalidates::Refinement if self.has_cut_rows => self.restart_from_root(),
            Invalidates::Nothing | Invalidates::Picture => {}
            // Links and their light stay; vertices look for theirs.
            Invalidates::Radiosities if self.phase == Phase::Done && !is_moved && self.is_to_reconstruct() => {
                self.end_links();
            }
            Invalidates::Radiosities | Invalidates::Verdicts | Invalidates::Refinement => {
                self.is_converged &= !is_moved;
                self.resume();
            }
            Invalidates::Links => self.restart_from_root(),
            Invalidates::Hierarchy | Invalidates::Scene => unreachable!("what is rebuilt was turned away above"),
        }
        Ok(true)
    }

    /// A solver of the same scene with other clusters, which starts with the radiosities that are known here and with what is known
    /// of hidden parts.
    ///
    /// # Errors
    /// Parameters out of range, or a `none` solve that cannot fit into memory.
    pub fn rebuilt(&self, params: SolverParams, generation: u64) -> Result<Self, SolverError> {
        let (scene, occluders) = (self.scene.clone(), self.occluders.clone());
        let reachability = self.hierarchy.reachability().clone();
        let mut new = Self::with_reachability(scene, occluders, params, generation, |_, _| reachability)?;
        if params.threshold() == self.params.threshold() {
            (new.epsilon_watts, new.anchor_watts) = (self.epsilon_watts, self.anchor_watts);
        }
        let mut of_polygons = vec![Vec3::ZERO; self.scene.polygons.len()];
        for &id in self.hierarchy.initial_patches() {
            if let Shape::Patch(patch) = self.hierarchy.element(id).shape {
                of_polygons[patch.polygon as usize] = self.light.radiosity[id.index()];
            }
        }
        for (element, radiosity) in new.hierarchy.elements().iter().zip(&mut new.light.radiosity) {
            if let Shape::Patch(patch) = element.shape {
                *radiosity = of_polygons[patch.polygon as usize];
            }
        }
        pull(&new.hierarchy, &mut new.light.radiosity);
        new.fix_brightness();
        new.seconds.load = self.seconds.load;
        Ok(new)
    }

    /// Changes a material's emission B_e (W/m²); ε in watts stays, and so do all links but those of clusters that now shine
    /// from other parts of them.
    pub fn set_emission(&mut self, material: MaterialId, emission: Vec3) {
        self.edit_material(material, |material| material.emission = emission);
        let changed = self.changed_clusters(material);
        self.light.emitted = self.emitted_light().emitted;
        self.emission = self.emission_sums();
        let redirected = self.links.drain(|_, link| changed[link.source().index()]);
        let judged_again = |(receiver, link): (ElementId, _)| judged_again(receiver, &link, Doubts::default());
        self.refinement.add(redirected.into_iter().map(judged_again));
        if self.epsilon_watts <= 0.0 {
            // There was no light to measure ε by.
            self.epsilon_watts = watts(&self.params, self.largest_power());
            self.anchor_watts = self.largest_power();
        }
        self.resume();
    }

    /// Changes a material's reflectance ρ; ε in watts stays, and so do all links: light is gathered again, and links are judged
    /// again where B has grown.
    pub fn set_reflectance(&mut self, material: MaterialId, reflectance: Vec3) {
        self.edit_material(material, |material| material.reflectance = reflectance);
        self.resume();
    }

    /// Measures a relative ε by the power that is emitted now; ε in watts stays as it is.
    pub fn anchor_epsilon(&mut self) {
        let epsilon = watts(&self.params, self.largest_power());
        self.anchor_watts = self.largest_power();
        if epsilon == self.epsilon_watts {
            return;
        }
        let is_finer = epsilon < self.epsilon_watts;
        self.merges_back |= !is_finer;
        self.doubts.finer_epsilon |= is_finer;
        self.epsilon_watts = epsilon;
        self.resume();
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

    /// Goes on with what is there after a change that leaves candidates and links valid.
    fn resume(&mut self) {
        self.gathers_finely = false;
        self.gather = None;
        // There may be room now; but siblings that their cluster lights as a whole stay as they are.
        self.is_full = self.has_cut_rows;
        self.memory_stop = self.memory_stop.filter(|_| self.has_cut_rows);
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
        let reachability = self.hierarchy.reachability().clone();
        let (hierarchy, seconds) = timed(|| Self::new_hierarchy(&scene, reachability, &self.params, self.entering));
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
        self.refinement.start(Candidate::first(&self.hierarchy));
        self.fix_brightness();
        self.picture = Picture::default();
        self.display = None;
        self.gather = None;
        self.phase = Phase::Refine;
        self.stage = 0;
        self.frozen = None;
        self.restart_history();
        (self.gathers_finely, self.is_converged) = (false, false);
        (self.merges_back, self.doubts) = (false, Doubts::default());
        (self.is_full, self.has_cut_rows, self.memory_stop) = (false, false, None);
    }
}
