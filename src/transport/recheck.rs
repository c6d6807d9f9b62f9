//! The second look: stored links judged again by the light that was found over them.

use rayon::prelude::*;

use super::candidate::{Candidate, Directions};
use super::link::{Link, VisibilitySource};
use super::solution::LinkSolution;
use crate::hierarchy::ElementId;

/// Multiples of ε that a solve goes through. Verdicts look at radiosities, so a fine ε needs them
/// nearly right: with the last ε alone, links judged while B was small are judged again and again
/// as it grows, and are refined by wrong values.
pub(super) const SCHEDULE: [f64; 2] = [2.0, 1.0];

/// Rounds end when no more than one in so many links fails its threshold: the last ones are
/// refined, but what little that changes is not judged again.
const FEW: usize = 100;

/// Reasons to judge stored links again although their power is no greater than before.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct RecheckReasons {
    /// ε is finer: visibility that was inherited must show itself, and so must occlusion.
    pub finer_epsilon: bool,
    /// Links deserve more rays than they had.
    pub more_rays: bool,
    /// Clusters are something else to light: form factors of their links change.
    pub cluster_model: bool,
}

impl RecheckReasons {
    /// Both.
    pub fn and(self, other: Self) -> Self {
        Self {
            finer_epsilon: self.finer_epsilon || other.finer_epsilon,
            more_rays: self.more_rays || other.more_rays,
            cluster_model: self.cluster_model || other.cluster_model,
        }
    }
}

/// Result of judging the stored links again.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Rechecked {
    /// Whether links failed and wait.
    pub has_failing: bool,
    /// Whether so few failed that no further look is needed once they are refined.
    pub is_last: bool,
}

impl LinkSolution {
    /// Judges the stored links by the present radiosities; those that fail wait to be refined.
    pub fn recheck(&mut self, reasons: RecheckReasons) -> Rechecked {
        let mut failing = self.take_failing(reasons);
        let few_fail = failing.len() * FEW <= self.links.len();
        let has_finer_stage = self.stage + 1 < SCHEDULE.len();
        if few_fail && has_finer_stage {
            self.stage += 1;
            failing.append(&mut self.take_failing(RecheckReasons { finer_epsilon: true, ..RecheckReasons::default() }));
        }
        let found = Rechecked { has_failing: !failing.is_empty(), is_last: few_fail && !has_finer_stage };
        if found.has_failing {
            self.refinement.start(failing);
            if reasons != RecheckReasons::default() {
                self.refinement.hurry();
            }
        }
        found
    }

    /// Takes out what must be judged again as candidates: links that fail by the present
    /// radiosities or for a reason to recheck them, and pairs whose occlusion matters more than
    /// when it was found.
    fn take_failing(&mut self, reasons: RecheckReasons) -> Vec<Candidate> {
        let mut links = std::mem::take(&mut self.links);
        let occluded = std::mem::take(&mut self.refinement.occluded);
        let oracle = self.oracle();
        let failing = links.drain(|receiver, link| match oracle.may_split {
            true => oracle.must_judge_again(receiver, link) || oracle.link_needs_recheck(receiver, link, reasons),
            false => oracle.is_unjudged(link),
        });
        let of_link = |(receiver, link): (ElementId, Link)| judged_again(receiver, &link, reasons);
        let (rechecked, believed): (Vec<_>, _) =
            occluded.into_par_iter().partition(|pair| oracle.occluded_needs_recheck(pair, reasons));
        let rechecked: Vec<Candidate> = rechecked.into_iter().map(|occluded| occluded.pair).collect();
        self.links = links;
        self.refinement.occluded = believed;
        self.refinement.forget_rejections(&rechecked);
        failing.into_iter().map(of_link).chain(rechecked).collect()
    }
}

/// The candidate that a stored link becomes; by a finer ε or with more rays, visibility that it
/// inherited must show itself.
pub(super) fn judged_again(receiver: ElementId, link: &Link, reasons: RecheckReasons) -> Candidate {
    let directions = Directions { to_a: true, to_b: false };
    let is_inherited = link.visibility_source() == VisibilitySource::Inherited && receiver != link.source();
    let must_show = reasons.finer_epsilon || reasons.more_rays;
    Candidate::new(receiver, link.source(), directions, link.visibility(), is_inherited && !must_show)
}
