//! The rejected pairs that a test asked to record, brought up to date with merged pairs.

use rustc_hash::FxHashSet;

use super::pairs::{Pair, Standing};
use crate::hierarchy::{ElementId, Hierarchy, Renumbering};
use crate::transport::RejectedPair;
use crate::transport::verdict::Rejection;

/// The rest of the record, under the new numbers: pairs that no merged pair stands for.
pub(super) fn after_merging(
    recorded: &[RejectedPair],
    pairs: &[(Pair, Standing)],
    (before, after): (&Hierarchy, &Hierarchy),
    renumbering: &Renumbering,
) -> Vec<RejectedPair> {
    let standing: FxHashSet<Pair> = pairs.iter().map(|(pair, _)| *pair).collect();
    let occluded = pairs.iter().filter(|(_, standing)| matches!(standing, Standing::Occluded { .. }));
    let occluded = occluded.map(|(pair, _)| (*pair, Rejection::Occluded));
    let facing_away = recorded.iter().filter(|pair| pair.rejection == Rejection::FacingAway);
    let facing_away = facing_away.map(|pair| (pair.receiver, pair.source));
    let left = facing_away.filter(|pair| !with_around(before, *pair).any(|around| standing.contains(&around)));
    // Where all quarters turn away, what they were merged to does.
    let of = |id: ElementId| renumbering.of_nearest(before, id);
    let all = occluded.chain(left.map(|pair| (pair, Rejection::FacingAway)));
    let mut known = FxHashSet::default();
    let all: Vec<(Pair, Rejection)> = all
        .filter_map(|((receiver, source), rejection)| Some(((of(receiver)?, of(source)?), rejection)))
        .filter(|(pair, _)| known.insert(*pair))
        .collect();
    let is_inside = |pair: Pair| with_around(after, pair).skip(1).any(|around| known.contains(&around));
    let outer = all.into_iter().filter(|(pair, _)| !is_inside(*pair));
    outer.map(|((receiver, source), rejection)| RejectedPair { receiver, source, rejection }).collect()
}

/// Every pair that holds a pair, itself first.
fn with_around(hierarchy: &Hierarchy, (receiver, source): Pair) -> impl Iterator<Item = Pair> {
    let with_above = |id: ElementId| std::iter::successors(Some(id), |&id| hierarchy.element(id).parent());
    with_above(receiver).flat_map(move |to| with_above(source).map(move |from| (to, from)))
}
