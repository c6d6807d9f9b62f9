//! Changes while a solution is there: what is still valid stays.

use glam::Vec3;

use super::change::ChangeCost;
use super::job::{Job, Pending};
use super::params::{Reconstruct, SolverParams};
use super::reconstruction_mesh::ReconstructionMesh;
use super::stats::Seconds;
use super::{Solver, SolverError, check, clusters, timed, watts};
use crate::scene::MaterialId;
use crate::transport::LinkRules;

impl Solver {
    /// Takes over new parameters with the least work that suffices, and tells which that is. From
    /// [`ChangeCost::Hierarchy`] on hierarchy or scene must be rebuilt, by [`Self::rebuilt`] or a
    /// new solver, which then takes over: this one stays as it is.
    ///
    /// # Errors
    /// Parameters out of range; the present ones stay.
    pub fn set_params(&mut self, params: SolverParams) -> Result<ChangeCost, SolverError> {
        params.validate()?;
        let is_anchored_anew = self.params.threshold() != params.threshold();
        let present_epsilon = self.epsilon_watts();
        let epsilon = if is_anchored_anew { watts(&params, self.links.largest_power()) } else { present_epsilon };
        // More memory is more only where it was missing.
        let memory = if self.memory_stop.is_some() { self.params.memory } else { params.memory };
        let present = SolverParams { memory, ..self.params };
        let change = present.change_to(&params, [present_epsilon, epsilon]);
        if change.cost.is_rebuilt() {
            return Ok(change.cost);
        }
        let was_gathered = self.params.shown_by() == Reconstruct::Gather;
        let is_moved = self.params.push != params.push || was_gathered;
        self.params = params;
        self.links.set_rules(params.link_rules(epsilon));
        if is_anchored_anew {
            self.anchor_watts = self.links.largest_power();
        }
        self.pending.merges_back |= change.merges_back;
        self.pending.reasons = self.pending.reasons.and(change.reasons);
        match change.cost {
            ChangeCost::Nothing | ChangeCost::Picture => {}
            ChangeCost::Verdicts | ChangeCost::Refinement if self.links.has_coarsened_siblings() => {
                self.restart_from_root()
            }
            // Links and their light stay; leaves look for theirs.
            ChangeCost::Radiosities if self.job == Job::Done && !is_moved && self.is_to_gather() => self.end_links(),
            ChangeCost::Radiosities | ChangeCost::Verdicts | ChangeCost::Refinement => {
                if is_moved {
                    self.links.unsettle();
                }
                self.resume();
            }
            ChangeCost::Links => self.restart_from_root(),
            ChangeCost::Hierarchy | ChangeCost::Scene => unreachable!("what is rebuilt was turned away above"),
        }
        Ok(change.cost)
    }

    /// A solver of the same scene with other clusters, which starts with the radiosities that are
    /// known here and with what is known of hidden parts.
    ///
    /// # Errors
    /// Parameters out of range, or a `none` solve that cannot fit into memory.
    pub fn rebuilt(&self, params: SolverParams, generation: u64) -> Result<Self, SolverError> {
        check(self.scene(), &params)?;
        let (epsilon, anchor) = if params.threshold() == self.params.threshold() {
            (self.epsilon_watts(), self.anchor_watts)
        } else {
            let power = self.links.largest_power();
            (watts(&params, power), power)
        };
        let (links, seconds) = timed(|| {
            let reachability = self.hierarchy().reachability().clone();
            let hierarchy = clusters(self.scene(), reachability, &params, self.links.entering_power());
            self.links.restarted(hierarchy, params.link_rules(epsilon))
        });
        let mut new = Self::over(links, params, anchor, (generation, seconds));
        new.seconds.load = self.seconds.load;
        Ok(new)
    }

    /// Changes a material's emission B_e (W/m²); ε in watts stays, and so do all links but those of
    /// clusters that now shine from other parts of them.
    pub fn set_emission(&mut self, material: MaterialId, emission: Vec3) {
        self.links.set_emission(material, emission);
        if self.epsilon_watts() <= 0.0 {
            // There was no light to measure ε by.
            self.anchor_watts = self.links.largest_power();
            self.set_epsilon(watts(&self.params, self.anchor_watts));
        }
        self.resume();
    }

    /// Changes a material's reflectance ρ; ε in watts stays, and so do all links: light is gathered
    /// again, and links are judged again where B has grown.
    pub fn set_reflectance(&mut self, material: MaterialId, reflectance: Vec3) {
        self.links.set_reflectance(material, reflectance);
        self.resume();
    }

    /// Measures a relative ε by the power that is emitted now; ε in watts stays as it is.
    pub fn anchor_epsilon(&mut self) {
        self.anchor_watts = self.links.largest_power();
        let (before, epsilon) = (self.epsilon_watts(), watts(&self.params, self.anchor_watts));
        if epsilon == before {
            return;
        }
        self.pending.merges_back |= epsilon > before;
        self.pending.reasons.finer_epsilon |= epsilon < before;
        self.set_epsilon(epsilon);
        self.resume();
    }

    /// Threshold ε, W.
    pub(super) fn epsilon_watts(&self) -> f64 {
        self.links.rules().epsilon_watts
    }

    fn set_epsilon(&mut self, epsilon_watts: f64) {
        self.links.set_rules(LinkRules { epsilon_watts, ..*self.links.rules() });
    }

    /// Goes on with what is there after a change that leaves candidates and links valid.
    fn resume(&mut self) {
        self.gather = None;
        // There may be room now; but siblings that their cluster lights as a whole stay as they
        // are.
        if self.links.split_again() {
            self.memory_stop = None;
        }
        self.job = match self.links.refinement().is_finished() {
            true => self.after_refinement(false),
            false => Job::Refine { is_last: false },
        };
    }

    /// Refines again from the root's self-link, on new clusters of the same kind, judging by the
    /// radiosities that are known.
    fn restart_from_root(&mut self) {
        let reachability = self.hierarchy().reachability().clone();
        let entering = self.links.entering_power();
        let (links, seconds) = timed(|| {
            let hierarchy = clusters(self.scene(), reachability, &self.params, entering);
            self.links.restarted(hierarchy, *self.links.rules())
        });
        self.links = links;
        // Another solve begins, so it counts from zero.
        self.seconds = Seconds { load: self.seconds.load, hierarchy: seconds, total: seconds, ..Seconds::default() };
        self.gather = None;
        (self.job, self.pending, self.memory_stop) = (Job::Refine { is_last: false }, Pending::default(), None);
        self.view.clear();
        self.restart_timeline();
    }

    /// Forgets what names elements that were numbered anew. A picture starts from what is known
    /// now; its mesh is made anew.
    pub(super) fn forget_elements(&mut self) {
        self.gather = None;
        self.view.hierarchy = None;
        self.view.light = Some(self.links.light().clone());
        self.view.reconstruction = self.view.reconstruction.take().map(ReconstructionMesh::outdated);
        self.restart_timeline();
    }
}
