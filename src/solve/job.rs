//! Jobs: what a solve is at, and what comes after it.

use super::memory::{MemoryStop, growing_bytes};
use super::stats::Phase;
use super::timeline::TimelineStepKind;
use super::{Solver, timed};
use crate::base::cancel::CancelToken;
use crate::hierarchy::Hierarchy;
use crate::transport::{RecheckReasons, Refinement};

/// Light is moved until less than this share of the power is still to come, where links are judged
/// by it again: thresholds do not ask for more.
const ROUND_TOLERANCE: f64 = 1e-2;
/// Share of the power still to come at which light that is the result is done.
const FINAL_TOLERANCE: f64 = 1e-5;

/// A kind of work.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Job {
    /// Judge the pairs that wait. `is_last` tells that the light that is then moved is the result.
    Refine { is_last: bool },
    /// Merge links and patches back that a coarser threshold does not ask for.
    MergeBack,
    /// Judge the stored links again by their light.
    Recheck,
    /// Move light over the links; unless it is the last time, links are judged by it again.
    Converge { is_last: bool },
    /// Gather light anew over the links' solution.
    Gather,
    /// Nothing.
    Done,
}

impl Job {
    /// Name of the job in statistics.
    pub fn phase(self) -> Phase {
        match self {
            Self::Refine { .. } => Phase::Refine,
            Self::MergeBack | Self::Recheck | Self::Converge { .. } => Phase::Gather,
            Self::Gather => Phase::Reconstruct,
            Self::Done => Phase::Done,
        }
    }

    /// Whether the links are as they stay.
    pub fn is_past_links(self) -> bool {
        matches!(self, Self::Gather | Self::Done)
    }
}

/// Work that changed settings ask for once nothing waits to be judged.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Pending {
    /// Links may be finer than they need be, because ε was raised.
    pub merges_back: bool,
    /// Why stored links are to be judged again.
    pub reasons: RecheckReasons,
}

/// Outcome of one call of [`Solver::step`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Step {
    /// Judged and applied a part of a wave.
    Refined {
        /// Whether the wave ended with it.
        wave_ended: bool,
    },
    /// Gathered to convergence and judged the stored links again.
    Gathered,
    /// A part of the final gather.
    Reconstructed {
        /// Whether a pass over all of them ended with it.
        pass_ended: bool,
    },
    /// Nothing is left to do.
    Finished,
    /// The token was cancelled; the same step can be taken again, with the same result.
    Interrupted,
}

impl Solver {
    /// Does one bounded piece of work, and keeps a step of the timeline where one ends with it and
    /// a timeline is kept.
    pub fn step(&mut self, cancel: &CancelToken) -> Step {
        let step = self.work(cancel);
        match step {
            Step::Refined { wave_ended: true } => self.remember(TimelineStepKind::Wave),
            Step::Gathered => self.remember(TimelineStepKind::Round),
            Step::Reconstructed { pass_ended: true } => self.remember(TimelineStepKind::Pass),
            _ => {}
        }
        self.log(step);
        step
    }

    fn log(&self, step: Step) {
        let (refinement, seconds) = (self.links.refinement(), self.seconds.total);
        match step {
            Step::Refined { wave_ended: true } => {
                let counts = refinement.counts;
                let (wave, links) = (refinement.waves, self.links.links().len() + refinement.accepted.len());
                tracing::debug!(wave, links, judged = counts.pairs_judged, rays = counts.rays, seconds, "wave refined");
            }
            Step::Gathered if self.job.is_past_links() => {
                tracing::info!(
                    links = self.links.links().len(),
                    rays = refinement.counts.rays,
                    seconds,
                    "links settled"
                );
            }
            Step::Gathered => tracing::debug!(links = self.links.links().len(), seconds, "light moved over links"),
            Step::Reconstructed { pass_ended: true } => {
                let (attempt, rays) =
                    self.gather.as_ref().map_or((0, 0), |gather| (gather.progress().0, gather.rays()));
                tracing::debug!(attempt, rays, seconds, "gather pass ended");
            }
            Step::Refined { .. } | Step::Reconstructed { .. } | Step::Finished | Step::Interrupted => {}
        }
    }

    /// Steps until nothing is left to do; false if cancelled.
    pub fn run(&mut self, cancel: &CancelToken) -> bool {
        loop {
            match self.step(cancel) {
                Step::Finished => return true,
                Step::Interrupted => return false,
                Step::Refined { .. } | Step::Gathered | Step::Reconstructed { .. } => {}
            }
        }
    }

    /// A bounded piece of work, timed.
    fn work(&mut self, cancel: &CancelToken) -> Step {
        if cancel.is_cancelled() {
            return Step::Interrupted;
        }
        let job = self.job;
        let (step, seconds) = timed(|| match job {
            Job::Refine { is_last } => self.refine(is_last, cancel),
            Job::MergeBack => self.merge_back(cancel),
            Job::Recheck => self.recheck(),
            Job::Converge { is_last } => self.converge(is_last, cancel),
            Job::Gather => self.gather(cancel),
            Job::Done => Some(Step::Finished),
        });
        let of_job = match job {
            Job::Refine { .. } | Job::MergeBack => &mut self.seconds.refine,
            Job::Recheck | Job::Converge { .. } => &mut self.seconds.gather,
            Job::Gather => &mut self.seconds.reconstruct,
            Job::Done => return Step::Finished,
        };
        *of_job += seconds;
        self.seconds.total += seconds;
        step.unwrap_or(Step::Interrupted)
    }

    fn refine(&mut self, is_last: bool, cancel: &CancelToken) -> Option<Step> {
        let is_watched = self.is_watched();
        let room = self.budget_of_links().saturating_sub(self.lasting_bytes());
        let has_room =
            |refinement: &Refinement, hierarchy: &Hierarchy| growing_bytes(refinement, hierarchy, is_watched) <= room;
        let applied = self.links.refine(has_room, cancel)?;
        if !applied.is_whole {
            let is_first = self.links.refinement().counts.pairs_judged == 0;
            self.memory_stop = Some(if is_first { MemoryStop::Scene } else { MemoryStop::Links });
        }
        if self.links.refinement().is_finished() {
            self.job = self.after_refinement(is_last);
        }
        Some(Step::Refined { wave_ended: applied.wave_ended })
    }

    /// The next job once nothing waits to be judged.
    pub(super) fn after_refinement(&self, is_last: bool) -> Job {
        let is_settled = self.links.is_converged() && self.links.refinement().accepted.is_empty();
        match self.pending.merges_back {
            true => Job::MergeBack,
            false if is_settled && !is_last => Job::Recheck,
            false => Job::Converge { is_last },
        }
    }

    fn merge_back(&mut self, cancel: &CancelToken) -> Option<Step> {
        if !self.links.merge_back(cancel) {
            return None;
        }
        self.pending.merges_back = false;
        self.forget_elements();
        self.job = self.after_refinement(false);
        Some(Step::Refined { wave_ended: true })
    }

    #[expect(clippy::unnecessary_wraps, reason = "one of several jobs, which can be cancelled")]
    fn recheck(&mut self) -> Option<Step> {
        self.links.store_accepted();
        let found = self.links.recheck(std::mem::take(&mut self.pending.reasons));
        self.job = match found.has_failing {
            true => Job::Refine { is_last: found.is_last },
            false => self.after_refinement(found.is_last),
        };
        Some(Step::Gathered)
    }

    fn converge(&mut self, is_last: bool, cancel: &CancelToken) -> Option<Step> {
        self.links.store_accepted();
        // The first rounds are coarse: light that is not judged yet has no place in what verdicts
        // look at.
        self.links.converge(if is_last { FINAL_TOLERANCE } else { ROUND_TOLERANCE }, is_last, cancel)?;
        if !is_last {
            return self.recheck();
        }
        self.links.settle();
        self.end_links();
        Some(Step::Gathered)
    }
}
