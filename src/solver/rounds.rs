//! Rounds: waves of refinement, a gather, and what must be judged again by the light that it found.

use rayon::prelude::*;

use super::candidate::{Candidate, Directions};
use super::change::Doubts;
use super::gather::Gatherer;
use super::link::{Evidence, Link, LinkTable};
use super::memory::{MemoryStop, growing_bytes};
use super::oracle::Oracle;
use super::params::OracleKind;
use super::rays::RaySampler;
use super::refine::Refinement;
use super::sight::Thresholds;
use super::stats::Phase;
use super::verdict::Verdict;
use super::{Solver, Step, timed};
use crate::cancel::CancelToken;
use crate::hierarchy::{ElementId, Hierarchy};

/// Multiples of ε that a solve goes through. Verdicts look at radiosities, so a fine ε needs them nearly right: with the
/// last ε alone, links judged while B was small are judged again and again as it grows, and are refined by wrong values.
const SCHEDULE: [f64; 2] = [2.0, 1.0];

/// Rounds end when no more than one in so many links fails its threshold: the last ones are refined, but what little that
/// changes is not judged again.
const FEW: usize = 100;

/// A round's gather ends when less than this share of the power is still to come: thresholds do not ask for more.
const ROUND_TOLERANCE: f64 = 1e-2;
/// The last gather ends when less than this share of the power is still to come.
const FINAL_TOLERANCE: f64 = 1e-5;
/// Where memory is full, a child with more siblings to be judged than this is lit by its cluster as a whole.
const LONGEST_ROW: u32 = 16;
/// A gather is given up after this many sweeps; at the largest reflectance that files may hold (0.99) light needs 1,400
/// sweeps to fall to 10⁻⁶.
const MOST_SWEEPS: u32 = 2000;

impl Solver {
    /// A bounded piece of work, timed.
    pub(super) fn work(&mut self, cancel: &CancelToken) -> Step {
        if cancel.is_cancelled() {
            return Step::Interrupted;
        }
        match self.phase {
            Phase::Hierarchy | Phase::Refine => {
                let (step, seconds) = timed(|| self.refine(cancel));
                self.seconds.refine += seconds;
                self.seconds.total += seconds;
                step
            }
            Phase::Gather if self.merges_back => {
                let (is_done, seconds) = timed(|| self.merge_back(cancel));
                self.seconds.refine += seconds;
                self.seconds.total += seconds;
                self.merges_back = !is_done;
                if is_done { Step::Refined { wave_ended: true } } else { Step::Interrupted }
            }
            Phase::Gather => {
                let (step, seconds) = timed(|| self.gather(cancel));
                self.seconds.gather += seconds;
                self.seconds.total += seconds;
                step
            }
            Phase::Reconstruct => {
                let (step, seconds) = timed(|| self.reconstruct(cancel));
                self.seconds.reconstruct += seconds;
                self.seconds.total += seconds;
                step
            }
            Phase::Done => Step::Finished,
        }
    }

    fn refine(&mut self, cancel: &CancelToken) -> Step {
        // Out of the way of the oracle, which looks at all the rest.
        let mut refinement = std::mem::take(&mut self.refinement);
        let judged = refinement.judge(&self.oracle(), cancel);
        self.refinement = refinement;
        let Some(judged) = judged else { return Step::Interrupted };
        let wave_ended = self.apply(&judged);
        self.grow_light();
        if self.refinement.is_finished() {
            self.phase = Phase::Gather;
        }
        Step::Refined { wave_ended }
    }

    /// Applies verdicts as far as memory holds what comes of them; from then on nothing is split.
    fn apply(&mut self, judged: &[(Candidate, Verdict)]) -> bool {
        let (is_full, is_watched) = (self.is_full, self.is_watched());
        let room = self.budget_of_links().saturating_sub(self.lasting_bytes());
        let has_room = |refinement: &Refinement, hierarchy: &Hierarchy| {
            is_full || growing_bytes(refinement, hierarchy, is_watched) <= room
        };
        let applied = self.refinement.apply(&mut self.hierarchy, judged, has_room);
        if !applied.is_whole {
            self.is_full = true;
            let is_first = self.refinement.counts.pairs_judged == 0;
            self.memory_stop = Some(if is_first { MemoryStop::Scene } else { MemoryStop::Links });
            self.has_cut_rows |= self.refinement.cut_rows(&self.hierarchy, LONGEST_ROW);
        }
        applied.wave_ended
    }

    fn gather(&mut self, cancel: &CancelToken) -> Step {
        let accepted = std::mem::take(&mut self.refinement.accepted);
        self.is_converged &= accepted.is_empty();
        if !accepted.is_empty() || self.links.receivers() < self.hierarchy.elements().len() {
            self.links.append(self.hierarchy.elements().len(), &accepted);
        }
        if self.is_converged && !self.gathers_finely {
            self.judge_stored();
            return Step::Gathered;
        }
        // The first rounds are coarse: light that is not judged yet has no place in what verdicts look at.
        let tolerance = if self.gathers_finely { FINAL_TOLERANCE } else { ROUND_TOLERANCE };
        let mut light = self.light.clone();
        let gatherer = self.gatherer(&self.links);
        let Some(clamped) = gatherer.limit_rows(&mut light, cancel) else { return Step::Interrupted };
        if !gatherer.converge(&mut light, tolerance, MOST_SWEEPS, cancel) {
            return Step::Interrupted;
        }
        self.bounded_leaves = self.keep_bounds(&mut light);
        self.light = light;
        self.clamped_leaves = clamped;
        self.fix_brightness();
        self.iterations += 1;
        if self.gathers_finely {
            self.is_converged = true;
            self.end_links();
        } else {
            self.judge_stored();
        }
        Step::Gathered
    }

    /// Judges the stored links by the present radiosities; those that fail are candidates of the next round.
    fn judge_stored(&mut self) {
        let doubts = std::mem::take(&mut self.doubts);
        let mut failing = self.take_failing(doubts);
        let few_fail = failing.len() * FEW <= self.links.len();
        if few_fail && self.stage + 1 < SCHEDULE.len() {
            self.stage += 1;
            failing.append(&mut self.take_failing(Doubts { finer_epsilon: true, ..Doubts::default() }));
        } else {
            self.gathers_finely = few_fail;
        }
        if !failing.is_empty() {
            self.refinement.start(failing);
            if doubts != Doubts::default() {
                self.refinement.hurry();
            }
            self.phase = Phase::Refine;
        }
    }

    /// ε of the present stage, W.
    fn stage_epsilon(&self) -> f64 {
        self.epsilon_watts * SCHEDULE[self.stage]
    }

    /// Takes out what must be judged again as candidates. A link that fails by the present radiosities or is in doubt; and pairs
    /// whose occlusion matters more than when it was found.
    fn take_failing(&mut self, doubts: Doubts) -> Vec<Candidate> {
        let mut links = std::mem::take(&mut self.links);
        let occluded = std::mem::take(&mut self.refinement.occluded);
        let oracle = self.oracle();
        let failing = links.drain(|receiver, link| match oracle.may_split {
            true => oracle.must_judge_again(receiver, link) || oracle.is_in_doubt(receiver, link, doubts),
            false => oracle.is_unjudged(link),
        });
        let of_link = |(receiver, link): (ElementId, Link)| judged_again(receiver, &link, doubts);
        let (doubtful, believed): (Vec<_>, _) =
            occluded.into_par_iter().partition(|pair| oracle.is_doubtful(pair, doubts));
        let doubtful: Vec<Candidate> = doubtful.into_iter().map(|occluded| occluded.pair).collect();
        self.links = links;
        self.refinement.occluded = believed;
        self.refinement.forget_rejections(&doubtful);
        failing.into_iter().map(of_link).chain(doubtful).collect()
    }

    /// The oracle over the present state.
    pub(super) fn oracle(&self) -> Oracle<'_> {
        let (params, epsilon) = (&self.params, self.stage_epsilon());
        let thresholds = Thresholds {
            epsilon: epsilon as f32,
            epsilon_partial: (params.partial_factor * epsilon) as f32,
            visibility_factor: params.visibility_factor as f32,
            rays_min: params.rays_min,
            rays_max: params.rays_max,
            is_patient: params.oracle == OracleKind::Error || params.error.is_some(),
        };
        Oracle {
            hierarchy: &self.hierarchy,
            brightness: &self.brightness,
            spread: &self.spread,
            thresholds,
            model: params.cluster_model,
            kind: params.oracle,
            may_split: !self.is_full,
            sampler: RaySampler { occluders: &self.occluders, seed: params.seed, emission: &self.emission },
        }
    }

    pub(super) fn gatherer<'a>(&'a self, links: &'a LinkTable) -> Gatherer<'a> {
        Gatherer::new(&self.hierarchy, links, &self.surfaces, &self.params, false)
    }
}

/// The candidate that a stored link becomes; by a finer ε or with more rays, visibility that it inherited must show itself.
pub(super) fn judged_again(receiver: ElementId, link: &Link, doubts: Doubts) -> Candidate {
    let directions = Directions { to_a: true, to_b: false };
    let is_inherited = link.evidence() == Evidence::Inherited && receiver != link.source();
    let must_show = doubts.finer_epsilon || doubts.more_rays;
    Candidate::new(receiver, link.source(), directions, link.visibility(), is_inherited && !must_show)
}
