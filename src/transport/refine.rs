//! Refinement in waves: judge in parallel, then apply the verdicts in order on one thread.

use std::collections::VecDeque;

use rayon::prelude::*;

use super::candidate::{Candidate, Directions, Waiting, take_chunk};
use super::link::Link;
use super::oracle::Oracle;
use super::verdict::{Decision, OccludedPair, Rejection, Verdict};
use super::waiting::link_of_row;
use crate::base::cancel::CancelToken;
use crate::hierarchy::{ElementId, Hierarchy};

/// Candidates judged between two looks at commands.
const CHUNK: usize = 1 << 14;
/// Candidates of the first chunk after a change of settings, so that something new is soon to be
/// seen.
const FIRST_CHUNK: usize = 1 << 12;

/// Counts of refinement.
#[derive(Clone, Copy, Debug, Default)]
pub struct Counts {
    /// Directed pairs that the oracle was asked about.
    pub pairs_judged: u64,
    /// Rays cast.
    pub rays: u64,
    /// Pairs accepted only because a patch is too deep to be split.
    pub depth_guard_struck: u64,
}

/// Outcome of a chunk of verdicts.
#[derive(Clone, Copy, Debug)]
pub struct Applied {
    /// Whether the wave ended with them.
    pub wave_ended: bool,
    /// Whether there was room for all of them.
    pub is_whole: bool,
}

/// A direction of a pair that carries nothing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RejectedPair {
    /// Receiver.
    pub receiver: ElementId,
    /// Source.
    pub source: ElementId,
    /// Why.
    pub rejection: Rejection,
}

/// The wave at hand, the one that forms, and what was accepted since the last gather.
#[derive(Default)]
pub struct Refinement {
    wave: VecDeque<Waiting>,
    next_wave: VecDeque<Waiting>,
    /// Accepted links that wait to be taken into the table.
    pub accepted: Vec<(ElementId, Link)>,
    /// Pairs that no ray came through; a smaller ε looks at them again.
    pub occluded: Vec<OccludedPair>,
    /// Counts since the start.
    pub counts: Counts,
    /// Waves finished in this round.
    pub waves: u32,
    /// Candidates judged in this round, and in this wave alone.
    judged: (usize, usize),
    /// Whether the next chunk is a short one.
    hurries: bool,
    /// Candidates that each one of the last whole wave left.
    last_growth: f32,
    /// Rejected pairs, where a test asks to record them.
    pub rejected: Option<Vec<RejectedPair>>,
}

impl Refinement {
    /// Starts a round with these candidates.
    pub fn start(&mut self, candidates: impl IntoIterator<Item = Candidate>) {
        self.wave = candidates.into_iter().map(Waiting::Pair).collect();
        self.next_wave.clear();
        self.waves = 0;
        self.judged = (0, 0);
    }

    /// Makes the next chunk a short one.
    pub fn hurry(&mut self) {
        self.hurries = true;
    }

    /// Lets further candidates wait behind those of this round.
    pub fn add(&mut self, candidates: impl IntoIterator<Item = Candidate>) {
        self.next_wave.extend(candidates.into_iter().map(Waiting::Pair));
    }

    /// Whether nothing waits.
    pub fn is_finished(&self) -> bool {
        self.wave.is_empty() && self.next_wave.is_empty()
    }

    /// Everything that waits, in order.
    pub fn waiting(&self) -> impl Iterator<Item = &Waiting> {
        self.wave.iter().chain(&self.next_wave)
    }

    /// Entries that wait in this wave and the next.
    pub fn waiting_len(&self) -> (usize, usize) {
        (self.wave.len(), self.next_wave.len())
    }

    /// Share of the round that is done, if the present wave tells: where each candidate leaves g <
    /// 1 others, the n that wait make n/(1−g) in all. While waves still grow there is no telling.
    pub fn progress(&self) -> Option<f32> {
        let (done, in_wave) = (self.judged.0 as f32, self.judged.1 as f32);
        let growth = if in_wave > 0.0 { self.next_wave.len() as f32 / in_wave } else { self.last_growth };
        let waiting = (self.wave.len() + self.next_wave.len()) as f32;
        (done > 0.0 && growth < 1.0).then(|| done / (done + waiting / (1.0 - growth)))
    }

    /// Takes a chunk of the wave and judges it; `None` if cancelled, with the chunk put back.
    pub fn judge(&mut self, oracle: &Oracle, cancel: &CancelToken) -> Option<Vec<(Candidate, Verdict)>> {
        let limit = if std::mem::take(&mut self.hurries) { FIRST_CHUNK } else { CHUNK };
        let chunk = take_chunk(&mut self.wave, oracle.hierarchy, limit);
        let judged: Option<Vec<_>> = chunk
            .par_iter()
            .with_min_len(64)
            .map(|candidate| (!cancel.is_cancelled()).then(|| (*candidate, oracle.judge(candidate))))
            .collect();
        if judged.is_none() {
            for candidate in chunk.into_iter().rev() {
                self.wave.push_front(Waiting::Pair(candidate));
            }
        }
        judged
    }

    /// Applies verdicts in order as long as there is room; what is left over waits to be judged
    /// again.
    pub fn apply(
        &mut self,
        hierarchy: &mut Hierarchy,
        judged: &[(Candidate, Verdict)],
        has_room: impl Fn(&Self, &Hierarchy) -> bool,
    ) -> Applied {
        let mut applied = judged.len();
        for (place, (candidate, verdict)) in judged.iter().enumerate() {
            if !has_room(self, hierarchy) {
                applied = place;
                break;
            }
            let (a, b) = (candidate.a, candidate.b);
            self.counts.rays += u64::from(verdict.rays);
            let to_a = self.settle(a, b, &verdict.to_a);
            let to_b = self.settle(b, a, &verdict.to_b);
            let occluded = |decision: &Decision| matches!(decision, Decision::Reject(Rejection::Occluded));
            let blocked = Directions { to_a: occluded(&verdict.to_a), to_b: occluded(&verdict.to_b) };
            if !blocked.is_empty() {
                let pair = Candidate::new(a, b, blocked, 0.0, false);
                self.occluded.push(OccludedPair { pair, was_negligible: verdict.is_negligible });
            }
            let both = Directions { to_a: true, to_b: true };
            match (to_a, to_b) {
                (Some(end), Some(other)) if end == other => self.refine(hierarchy, candidate, verdict, both, end),
                _ => {
                    let splits =
                        [(to_a, Directions { to_b: false, ..both }), (to_b, Directions { to_a: false, ..both })];
                    for (end, directions) in splits {
                        if let Some(end) = end {
                            self.refine(hierarchy, candidate, verdict, directions, end);
                        }
                    }
                }
            }
        }
        self.judged.0 += applied;
        self.judged.1 += applied;
        for (candidate, _) in judged[applied..].iter().rev() {
            self.wave.push_front(Waiting::Pair(*candidate));
        }
        let ended = self.wave.is_empty();
        if ended {
            self.last_growth = self.next_wave.len() as f32 / self.judged.1.max(1) as f32;
            self.judged.1 = 0;
            self.wave = std::mem::take(&mut self.next_wave);
            self.waves += 1;
        }
        Applied { wave_ended: ended, is_whole: applied == judged.len() }
    }

    /// Lets a cluster light its child at once where more than `most` of the child's siblings wait
    /// to: to judge each of those pairs would take the memory that there is not. Whether there were
    /// any.
    pub fn coarsen_sibling_batches(&mut self, hierarchy: &Hierarchy, most: u32) -> bool {
        let accepted = self.accepted.len();
        for waves in [&mut self.wave, &mut self.next_wave] {
            waves.retain(|waiting| {
                let Some(link) = link_of_row(hierarchy, waiting).filter(|_| waiting.pairs(hierarchy) > most) else {
                    return true;
                };
                self.accepted.push(link);
                false
            });
        }
        self.accepted.len() > accepted
    }

    /// Takes back what was recorded of pairs that are looked at again.
    pub fn forget_rejections(&mut self, pairs: &[Candidate]) {
        let Some(rejected) = &mut self.rejected else { return };
        let again: rustc_hash::FxHashSet<(ElementId, ElementId)> = pairs
            .iter()
            .flat_map(|pair| [(pair.directions.to_a, pair.a, pair.b), (pair.directions.to_b, pair.b, pair.a)])
            .filter_map(|(asked, receiver, source)| asked.then_some((receiver, source)))
            .collect();
        rejected.retain(|pair| !again.contains(&(pair.receiver, pair.source)));
    }

    /// Books one direction's decision; the end to split if it must be refined.
    fn settle(&mut self, receiver: ElementId, source: ElementId, decision: &Decision) -> Option<ElementId> {
        self.counts.pairs_judged += u64::from(!matches!(decision, Decision::NotAsked));
        match *decision {
            Decision::NotAsked => {}
            Decision::Accept(link) => self.accepted.push((receiver, link)),
            Decision::AcceptAtGuard(link) => {
                self.counts.depth_guard_struck += 1;
                self.accepted.push((receiver, link));
            }
            Decision::Reject(rejection) => {
                if let Some(rejected) = &mut self.rejected {
                    rejected.push(RejectedPair { receiver, source, rejection });
                }
            }
            Decision::Refine(end) => return Some(end),
        }
        None
    }

    /// Queues the pairs that a refined pair turns into.
    fn refine(
        &mut self,
        hierarchy: &mut Hierarchy,
        candidate: &Candidate,
        verdict: &Verdict,
        directions: Directions,
        end: ElementId,
    ) {
        let (a, b) = (candidate.a, candidate.b);
        if candidate.is_self() {
            let children = hierarchy.element(a).children().len() as u32;
            let rows = (0..children).map(|child| Waiting::Siblings { cluster: a, child, from: child });
            self.next_wave.extend(rows);
            return;
        }
        hierarchy.subdivide(end);
        for child in hierarchy.element(end).children() {
            let (a, b) = if end == a { (child, b) } else { (a, child) };
            let pair = Candidate::new(a, b, directions, verdict.visibility, verdict.fully_visible);
            self.next_wave.push_back(Waiting::Pair(pair));
        }
    }
}
