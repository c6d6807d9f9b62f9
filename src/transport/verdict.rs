//! Verdicts: what becomes of a pair that was judged.

use super::candidate::Candidate;
use super::link::Link;
use crate::hierarchy::ElementId;

/// Why a pair gets no link.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Rejection {
    /// One end lies behind the other.
    FacingAway,
    /// No ray came through.
    Occluded,
}

/// Decision on one direction of a pair.
#[derive(Clone, Copy, Debug)]
pub enum Decision {
    /// The direction was not asked about.
    NotAsked,
    /// It is kept as a link.
    Accept(Link),
    /// It is kept as a link only because a patch is too deep to be split.
    AcceptAtGuard(Link),
    /// It must be refined by the children of this end.
    Refine(ElementId),
    /// It carries nothing.
    Reject(Rejection),
}

/// Decisions on both directions of a pair.
#[derive(Clone, Copy, Debug)]
pub struct Verdict {
    /// For the link at `a`, lit by `b`.
    pub to_a: Decision,
    /// For the link at `b`, lit by `a`.
    pub to_b: Decision,
    /// Visibility found, which the pair's refinements start with.
    pub visibility: f32,
    /// Whether all rays came through, so that refinements need no rays.
    pub fully_visible: bool,
    /// Whether the pair's power was below ε_partial.
    pub is_negligible: bool,
    /// Rays cast.
    pub rays: u32,
}

impl Verdict {
    /// A verdict with one decision in each direction that was asked about.
    pub fn alike(candidate: &Candidate, decision: Decision) -> Self {
        let if_asked = |asked: bool| if asked { decision } else { Decision::NotAsked };
        Self {
            to_a: if_asked(candidate.directions.to_a),
            to_b: if_asked(candidate.directions.to_b),
            visibility: 0.0,
            fully_visible: false,
            is_negligible: false,
            rays: 0,
        }
    }
}

/// A pair that no ray came through.
#[derive(Clone, Copy, Debug)]
pub struct OccludedPair {
    /// The pair in the directions that were rejected.
    pub pair: Candidate,
    /// Whether its power was below ε_partial, so that few rays were enough to drop it.
    pub was_negligible: bool,
}
