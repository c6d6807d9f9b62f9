//! The pairs of a solution, merged back from their parts for as long as the oracle would accept the
//! whole.

use rayon::prelude::*;
use rustc_hash::FxHashMap;

use super::combined::Combined;
use crate::base::cancel::CancelToken;
use crate::hierarchy::{ElementId, Hierarchy, Shape};
use crate::transport::candidate::end_to_split;
use crate::transport::form_factor::{Exchange, exchange};
use crate::transport::link::{Link, LinkTable};
use crate::transport::oracle::Oracle;
use crate::transport::verdict::OccludedPair;

/// Receiver and source.
pub type Pair = (ElementId, ElementId);

/// How a pair stands.
#[derive(Clone, Copy, Debug)]
pub enum Standing {
    /// Light passes over this link.
    Linked(Link),
    /// No ray came through.
    Occluded {
        /// Whether few rays were enough to believe that.
        was_negligible: bool,
    },
}

/// A pair that could be made again of its parts.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Whole {
    receiver: ElementId,
    source: ElementId,
    split: Split,
}

/// Which end was split.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Split {
    Receiver,
    Source,
    /// A self-link, which was refined to all pairs of its children.
    Both,
}

/// Parts that turn away from each other leave no trace; below a part that was refined they are
/// looked for this deep.
const DEEPEST_TRACE: u32 = 2;

/// Every directed pair that carries a link or was found occluded; of all others the ends turn away
/// from each other.
pub struct Pairs<'a> {
    oracle: &'a Oracle<'a>,
    /// Largest colour of each element's emission, W/m².
    emitted: &'a [f32],
    standings: FxHashMap<Pair, Standing>,
    /// Place of each element's initial patch, or a cluster's first one, in the hierarchy's order.
    places: Vec<u32>,
}

impl<'a> Pairs<'a> {
    /// The pairs of a table of links and of those that no ray came through.
    pub fn new(oracle: &'a Oracle<'a>, emitted: &'a [f32], links: &LinkTable, occluded: &[OccludedPair]) -> Self {
        let mut standings = FxHashMap::default();
        standings.reserve(links.len() + occluded.len());
        for receiver in (0..links.receivers() as u32).map(ElementId) {
            standings
                .extend(links.of(receiver).iter().map(|link| ((receiver, link.source()), Standing::Linked(*link))));
        }
        for OccludedPair { pair, was_negligible } in occluded {
            let standing = Standing::Occluded { was_negligible: *was_negligible };
            let directions = [(pair.directions.to_a, pair.a, pair.b), (pair.directions.to_b, pair.b, pair.a)];
            let asked = directions.into_iter().filter(|(asked, ..)| *asked);
            standings.extend(asked.map(|(_, receiver, source)| ((receiver, source), standing)));
        }
        Self { oracle, emitted, standings, places: places(oracle.hierarchy) }
    }

    /// Merges, from the parts up, what the oracle would accept as a whole; the pairs that are left
    /// in order of receivers and sources, `None` if cancelled.
    pub fn merge(mut self, cancel: &CancelToken) -> Option<Vec<(Pair, Standing)>> {
        let mut new: Vec<Pair> = self.standings.keys().copied().collect();
        while !new.is_empty() {
            let mut wholes: Vec<Whole> = new.par_iter().flat_map_iter(|pair| self.wholes_of(*pair)).collect();
            wholes.par_sort_unstable();
            wholes.dedup();
            if cancel.is_cancelled() {
                return None;
            }
            let merged: Vec<(Whole, Standing)> = wholes
                .par_iter()
                .with_min_len(64)
                .filter(|_| !cancel.is_cancelled())
                .filter_map(|whole| Some((*whole, self.merged(*whole)?)))
                .collect();
            if cancel.is_cancelled() {
                return None;
            }
            new.clear();
            for (whole, standing) in merged {
                let pair = (whole.receiver, whole.source);
                // Of equal ends either may have been split, so another whole may have taken some of
                // the parts.
                if self.take_parts(whole) {
                    self.standings.insert(pair, standing);
                    new.push(pair);
                }
            }
        }
        let mut left: Vec<(Pair, Standing)> = self.standings.into_iter().collect();
        left.par_sort_unstable_by_key(|(pair, _)| *pair);
        Some(left)
    }

    fn hierarchy(&self) -> &'a Hierarchy {
        self.oracle.hierarchy
    }

    /// The pairs that a pair may have come from.
    fn wholes_of(&self, (receiver, source): Pair) -> impl Iterator<Item = Whole> + use<> {
        let parent = |id: ElementId| self.hierarchy().element(id).parent();
        let (of_receiver, of_source) = (parent(receiver), parent(source));
        let wholes = if of_receiver == of_source {
            [of_receiver.map(|both| Whole { receiver: both, source: both, split: Split::Both }), None]
        } else {
            let is_whole = |end: ElementId, other: ElementId| !self.holds(end, other) && self.was_split(end, other);
            let by_receiver = of_receiver.filter(|&above| is_whole(above, source));
            let by_source = of_source.filter(|&above| is_whole(above, receiver));
            [
                by_receiver.map(|receiver| Whole { receiver, source, split: Split::Receiver }),
                by_source.map(|source| Whole { receiver, source, split: Split::Source }),
            ]
        };
        wholes.into_iter().flatten()
    }

    /// Whether refinement would split `end` of a pair with `other`.
    fn was_split(&self, end: ElementId, other: ElementId) -> bool {
        let hierarchy = self.hierarchy();
        end_to_split(hierarchy, end, other) == Some(end)
            // Of equal ends it is that which came first.
            || hierarchy.element(end).area == hierarchy.element(other).area
                && end_to_split(hierarchy, other, end) == Some(end)
    }

    /// Whether refinement comes by a pair: it splits each of the elements above one end while the
    /// other end is still whole.
    fn is_reached(&self, a: ElementId, b: ElementId) -> bool {
        let above_is_split = |end: ElementId, other: ElementId| {
            let above = self.hierarchy().element(end).parent();
            above.is_none_or(|above| self.holds(above, other) || self.was_split(above, other))
        };
        above_is_split(a, b) && above_is_split(b, a)
    }

    /// Whether a pair is reached without doubt: of two ends of equal area either may have been
    /// split first, which leaves pairs between that refinement may have passed by.
    fn is_surely_reached(&self, a: ElementId, b: ElementId) -> bool {
        let hierarchy = self.hierarchy();
        let element = |id: ElementId| hierarchy.element(id);
        let (Some(above_a), Some(above_b)) = (element(a).parent(), element(b).parent()) else { return false };
        let comes_from = |above: ElementId, other: ElementId| {
            !self.holds(above, other)
                && end_to_split(hierarchy, above, other) == Some(above)
                && end_to_split(hierarchy, other, above) == Some(above)
                && self.is_surely_reached(above, other)
        };
        let are_equal = element(above_a).area == element(above_b).area;
        above_a == above_b
            || comes_from(above_a, b)
            || comes_from(above_b, a)
            || are_equal
                && !self.holds(above_a, above_b)
                && !self.holds(above_b, above_a)
                && self.is_surely_reached(above_a, above_b)
    }

    /// Whether an element holds another.
    fn holds(&self, whole: ElementId, part: ElementId) -> bool {
        match &self.hierarchy().element(whole).shape {
            Shape::Cluster(cluster) => {
                let first = self.places[whole.index()];
                let count = self.hierarchy().patches_below(cluster).len() as u32;
                (first..first + count).contains(&self.places[part.index()])
            }
            Shape::Patch(_) => self.places[whole.index()] == self.places[part.index()],
            Shape::Sky(_) => false,
        }
    }

    /// The pairs that a whole was refined to.
    fn parts(&self, whole: Whole) -> impl Iterator<Item = Pair> + use<> {
        let of = |id: ElementId, is_split: bool| {
            let mut children = self.hierarchy().element(id).children();
            let count = children.len() as u32;
            let first = children.next().filter(|_| is_split);
            first.map_or(id.0..id.0 + 1, |first| first.0..first.0 + count)
        };
        let receivers = of(whole.receiver, whole.split != Split::Source);
        let sources = of(whole.source, whole.split != Split::Receiver);
        receivers.flat_map(move |receiver| sources.clone().map(move |source| (ElementId(receiver), ElementId(source))))
    }

    /// How a whole stands once its parts are merged; `None` where one of them was refined further,
    /// or the oracle would refine it.
    fn merged(&self, whole: Whole) -> Option<Standing> {
        if whole.split == Split::Both && !self.oracle.accepts_self(whole.receiver) {
            // There may be millions of parts.
            return None;
        }
        let mut combined = Combined::default();
        let mut has_void = false;
        for pair in self.parts(whole) {
            match self.standings.get(&pair) {
                Some(Standing::Linked(link)) => {
                    let weight = self.weight_of(whole, pair);
                    let emission = self.emission_share(whole, pair.1);
                    combined.add(self.hierarchy(), pair.0, link, weight, emission);
                }
                Some(Standing::Occluded { was_negligible }) => {
                    combined.add_occluded(self.hierarchy(), pair, self.weight_of(whole, pair), *was_negligible);
                }
                None if self.is_void(pair, DEEPEST_TRACE) => has_void = true,
                None => return None,
            }
        }
        let (receiver, source) = (whole.receiver, whole.source);
        // Parts that stand belong to one whole alone; those that leave no trace might be claimed by
        // two.
        let is_one = whole.split == Split::Both
            || self.is_reached(receiver, source) && (!has_void || self.is_surely_reached(receiver, source));
        if !is_one {
            return None;
        }
        if combined.links == 0 {
            let standing = Standing::Occluded { was_negligible: combined.was_negligible };
            return (whole.split != Split::Both && combined.occluded > 0).then_some(standing);
        }
        self.oracle.accept_merged(receiver, source, &combined).map(Standing::Linked)
    }

    /// Share of a part in the irradiance of the whole: that of its receiver in the area.
    fn weight_of(&self, whole: Whole, (receiver, _): Pair) -> f32 {
        let area = |id: ElementId| self.hierarchy().element(id).area;
        if area(whole.receiver) > 0.0 { area(receiver) / area(whole.receiver) } else { 0.0 }
    }

    /// Emission of a part's source in multiples of the whole's.
    fn emission_share(&self, whole: Whole, source: ElementId) -> f32 {
        let mean = self.emitted[whole.source.index()];
        if mean > 0.0 { self.emitted[source.index()] / mean } else { 1.0 }
    }

    /// Whether nothing passes between the ends because they turn away from each other, or all their
    /// parts do.
    fn is_void(&self, (receiver, source): Pair, depth: u32) -> bool {
        let hierarchy = self.hierarchy();
        if receiver == source {
            // A patch has no self-link, nor has a cluster that none of its polygons lights.
            return match &hierarchy.element(receiver).shape {
                Shape::Patch(_) | Shape::Sky(_) => true,
                Shape::Cluster(cluster) => self.oracle.is_convex(cluster),
            };
        }
        if exchange(hierarchy, receiver, source) == Exchange::FacingAway {
            return true;
        }
        let Some(end) = end_to_split(hierarchy, receiver, source).filter(|_| depth > 0) else { return false };
        let pair_of = |child: ElementId| if end == receiver { (child, source) } else { (receiver, child) };
        let mut children = hierarchy.element(end).children().map(pair_of);
        children.len() > 0 && children.all(|pair| !self.standings.contains_key(&pair) && self.is_void(pair, depth - 1))
    }

    /// Takes the parts of a whole out, if all that stood before are still there.
    fn take_parts(&mut self, whole: Whole) -> bool {
        let parts: Vec<Pair> = self.parts(whole).collect();
        let is_there = |pair: &Pair| self.standings.contains_key(pair) || self.is_void(*pair, DEEPEST_TRACE);
        if !parts.iter().all(is_there) {
            return false;
        }
        for pair in &parts {
            self.standings.remove(pair);
        }
        true
    }
}

/// Place of each element's initial patch in the hierarchy's order; of a cluster that of the first
/// patch below.
fn places(hierarchy: &Hierarchy) -> Vec<u32> {
    let mut places = vec![0; hierarchy.elements().len()];
    for (place, patch) in hierarchy.initial_patches().iter().enumerate() {
        places[patch.index()] = place as u32;
    }
    for id in hierarchy.ids() {
        match &hierarchy.element(id).shape {
            Shape::Cluster(cluster) => {
                let first = hierarchy.patches_below(cluster).first();
                places[id.index()] = first.map_or(0, |first| places[first.index()]);
            }
            Shape::Patch(patch) if patch.level > 0 => {
                let parent = hierarchy.element(id).parent();
                places[id.index()] = parent.map_or(0, |parent| places[parent.index()]);
            }
            Shape::Patch(_) => {}
            // In nothing of the scene.
            Shape::Sky(_) => places[id.index()] = u32::MAX,
        }
    }
    places
}
