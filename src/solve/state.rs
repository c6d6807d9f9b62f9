//! Questions that a solver answers at any time: its parts, counts and pictures.

use std::sync::Arc;

use glam::Vec3;

use super::job::Job;
use super::params::SolverParams;
use super::snapshot::Snapshot;
use super::stats::{Bytes, Stats};
use super::{Solver, balance, picture, timed};
use crate::gather::{Field, Gather};
use crate::hierarchy::Hierarchy;
use crate::scene::Scene;
use crate::transport::{LinkSolution, LinkTable, RejectedPair};

impl Solver {
    /// The scene as it is solved, edits of emission included.
    pub fn scene(&self) -> &Arc<Scene> {
        self.links.scene()
    }

    /// The present parameters.
    pub fn params(&self) -> &SolverParams {
        &self.params
    }

    /// The elements.
    pub fn hierarchy(&self) -> &Hierarchy {
        self.links.hierarchy()
    }

    /// Elements, links and their light.
    pub fn link_solution(&self) -> &LinkSolution {
        &self.links
    }

    /// The links that the last gather knew.
    pub fn links(&self) -> &LinkTable {
        self.links.links()
    }

    /// Radiosity B of each element, W/m², parallel to the hierarchy's arena.
    pub fn radiosity(&self) -> &[Vec3] {
        &self.links.light().radiosity
    }

    /// Irradiance E of each leaf, W/m², parallel to the hierarchy's arena.
    pub fn irradiance(&self) -> &[Vec3] {
        &self.links.light().irradiance
    }

    /// Records every rejected pair from now on; for tests that ask whether all pairs are covered.
    pub fn record_rejected(&mut self) {
        self.links.record_rejected();
    }

    /// The pairs rejected since [`Self::record_rejected`].
    pub fn rejected(&self) -> &[RejectedPair] {
        self.links.refinement().rejected.as_deref().unwrap_or_default()
    }

    /// Says whether snapshots carry the [`crate::transport::SolutionView`] of what they show.
    pub fn show_solution_view(&mut self, is_wanted: bool) {
        self.view.wants_solution_view = is_wanted;
        if !is_wanted {
            self.view.hierarchy = None;
        }
    }

    /// Numbers the snapshots of this solve, before the first one is taken.
    pub fn set_generation(&mut self, generation: u64) {
        self.view.generation = generation;
    }

    /// Books time that passed before the solver was made: reading the file and building the
    /// occluders.
    pub fn set_load_seconds(&mut self, seconds: f64) {
        self.seconds.load = seconds;
    }

    /// Whether nothing is left to do.
    pub fn is_done(&self) -> bool {
        self.job == Job::Done
    }

    /// Counts and times so far.
    pub fn stats(&self) -> Stats {
        let (links, refinement) = (&self.links, self.links.refinement());
        let (wave, next_wave) = refinement.waiting_len();
        let (emitted, largest) = (links.scene().emitted_power(), links.largest_power());
        let (clamped_leaves, bounded_leaves) = links.limited_leaves();
        Stats {
            phase: self.job.phase(),
            epsilon_watts: self.epsilon_watts(),
            epsilon_relative: if largest > 0.0 { self.epsilon_watts() / largest } else { 0.0 },
            power_watts: largest,
            anchor_watts: self.anchor_watts,
            initial_patches: links.hierarchy().initial_patches().len(),
            clusters: links.hierarchy().cluster_count(),
            patches: self.field().map_or(links.hierarchy(), Field::hierarchy).leaf_count(),
            elements: links.hierarchy().elements().len(),
            links: links.links().len() + refinement.accepted.len(),
            pairs_judged: refinement.counts.pairs_judged,
            rays: refinement.counts.rays + self.gather.as_ref().map_or(0, Gather::rays),
            iterations: links.iterations(),
            wave: refinement.waves,
            candidates_left: wave + next_wave,
            converged: self.is_done() && self.memory_stop.is_none(),
            depth_guard_struck: refinement.counts.depth_guard_struck,
            clamped_leaves,
            bounded_leaves,
            error_asked: self.params.error,
            error_estimate: self.certificate().map(|certificate| certificate.bound),
            error: self.error_found.filter(|_| self.gather.is_some()),
            seconds: self.seconds,
            bytes: Bytes {
                links: links.links().bytes(),
                elements: links.hierarchy().bytes() + links.light().bytes(),
                gather_samples: self.gather.as_ref().map_or(0, Gather::bytes),
                counted: self.counted_bytes(),
                budget: self.budget_bytes(),
            },
            memory_stop: self.memory_stop,
            emitted_watts: f64::from(emitted.element_sum()),
            entering_watts: f64::from(links.entering_power().element_sum()),
            absorbed_watts: balance::absorbed(self).element_sum(),
            progress: self.progress(),
            error_so_far: self.gather.as_ref().and_then(Gather::error_so_far),
        }
    }

    /// A picture of what is there, candidates counted at their present level.
    pub fn snapshot(&mut self) -> Snapshot {
        let is_first = self.seconds.first_snapshot <= 0.0;
        let (mut snapshot, seconds) = timed(|| picture::snapshot(self));
        // Who looks at a finished solution adds nothing to the time that it took.
        if !self.is_done() {
            self.seconds.total += seconds;
        }
        if is_first {
            self.seconds.first_snapshot = self.seconds.total;
        }
        snapshot.stats.seconds = self.seconds;
        snapshot
    }
}
