//! What can be asked of a solver at any time: its parts, counts and pictures.

use std::sync::Arc;

use glam::Vec3;

use super::link::LinkTable;
use super::params::SolverParams;
use super::refine::RejectedPair;
use super::snapshot::Snapshot;
use super::stats::{Bytes, Phase, Stats};
use super::{Solver, balance, picture, timed};
use crate::gather::{Field, Gather};
use crate::hierarchy::Hierarchy;
use crate::scene::Scene;

impl Solver {
    /// The scene as it is solved, edits of emission included.
    pub fn scene(&self) -> &Arc<Scene> {
        &self.scene
    }

    /// The present parameters.
    pub fn params(&self) -> &SolverParams {
        &self.params
    }

    /// The elements.
    pub fn hierarchy(&self) -> &Hierarchy {
        &self.hierarchy
    }

    /// The links that the last gather knew.
    pub fn links(&self) -> &LinkTable {
        &self.links
    }

    /// Radiosity B of each element, W/m², parallel to the hierarchy's arena.
    pub fn radiosity(&self) -> &[Vec3] {
        &self.light.radiosity
    }

    /// Irradiance E of each leaf, W/m², parallel to the hierarchy's arena.
    pub fn irradiance(&self) -> &[Vec3] {
        &self.light.irradiance
    }

    /// Records every rejected pair from now on; for tests that ask whether all pairs are covered.
    pub fn record_rejected(&mut self) {
        self.refinement.rejected.get_or_insert_default();
    }

    /// The pairs rejected since [`Self::record_rejected`].
    pub fn rejected(&self) -> &[RejectedPair] {
        self.refinement.rejected.as_deref().unwrap_or_default()
    }

    /// Says whether snapshots carry the [`super::Anatomy`] of what they show.
    pub fn show_anatomy(&mut self, is_wanted: bool) {
        self.wants_anatomy = is_wanted;
        if !is_wanted {
            self.frozen = None;
        }
    }

    /// Numbers the snapshots of this solve, before the first one is taken.
    pub fn set_generation(&mut self, generation: u64) {
        self.generation = generation;
    }

    /// Books time that passed before the solver was made: reading the file and building the occluders.
    pub fn set_load_seconds(&mut self, seconds: f64) {
        self.seconds.load = seconds;
    }

    /// Whether nothing is left to do.
    pub fn is_done(&self) -> bool {
        self.phase == Phase::Done
    }

    /// Counts and times so far.
    pub fn stats(&self) -> Stats {
        let (wave, next_wave) = self.refinement.waiting_len();
        let emitted = self.scene.emitted_power();
        let largest = self.largest_power();
        Stats {
            phase: self.phase,
            epsilon_watts: self.epsilon_watts,
            epsilon_relative: if largest > 0.0 { self.epsilon_watts / largest } else { 0.0 },
            power_watts: largest,
            anchor_watts: self.anchor_watts,
            initial_patches: self.hierarchy.initial_patches().len(),
            clusters: self.hierarchy.cluster_count(),
            patches: self.field().map_or(&self.hierarchy, Field::hierarchy).leaf_count(),
            elements: self.hierarchy.elements().len(),
            links: self.links.len() + self.refinement.accepted.len(),
            pairs_judged: self.refinement.counts.pairs_judged,
            rays: self.refinement.counts.rays + self.gather.as_ref().map_or(0, Gather::rays),
            iterations: self.iterations,
            wave: self.refinement.waves,
            candidates_left: wave + next_wave,
            converged: self.phase == Phase::Done && self.memory_stop.is_none(),
            depth_guard_struck: self.refinement.counts.depth_guard_struck,
            clamped_leaves: self.clamped_leaves,
            bounded_leaves: self.bounded_leaves,
            error_asked: self.params.error,
            error_estimate: self.certificate().map(|certificate| certificate.bound),
            error: self.error_found.filter(|_| self.gather.is_some()),
            seconds: self.seconds,
            bytes: Bytes {
                links: self.links.bytes(),
                elements: self.hierarchy.bytes() + self.light.bytes(),
                rows: self.gather.as_ref().map_or(0, Gather::bytes),
                counted: self.counted_bytes(),
                budget: self.budget_bytes(),
            },
            memory_stop: self.memory_stop,
            emitted_watts: f64::from(emitted.element_sum()),
            entering_watts: f64::from(self.entering.element_sum()),
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
        if self.phase != Phase::Done {
            self.seconds.total += seconds;
        }
        if is_first {
            self.seconds.first_snapshot = self.seconds.total;
        }
        snapshot.stats.seconds = self.seconds;
        snapshot
    }
}
