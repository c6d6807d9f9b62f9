//! A coarser threshold on a solution that is there: links and patches are merged back instead of
//! starting over.
//!
//! Refinement replaces a pair by the pairs of one end's parts; this is its reverse. From the finest
//! pairs up, parts are replaced by the whole as long as the oracle would now accept it by the
//! radiosities that are known. The whole's F and V are the means of its parts', so the same power
//! passes, and no ray is cast. Patches whose quarters neither send nor receive a link of their own
//! are merged with them.

mod combined;
mod pairs;
mod recorded;

use glam::Vec3;

use super::candidate::{Candidate, Directions};
use super::link::{Link, LinkTable};
use super::solution::LinkSolution;
use super::sweep::Light;
use super::verdict::OccludedPair;
use crate::base::cancel::CancelToken;
use crate::hierarchy::{ElementId, Hierarchy, Renumbering};
use pairs::{Pair, Pairs, Standing};

impl LinkSolution {
    /// Merges links and patches back as far as the present thresholds allow; false if cancelled,
    /// with nothing changed. Elements are numbered anew.
    pub fn merge_back(&mut self, cancel: &CancelToken) -> bool {
        self.store_accepted();
        let emitted: Vec<f32> = self.light.emitted.iter().map(|emitted| emitted.max_element()).collect();
        let oracle = self.oracle();
        let pairs = Pairs::new(&oracle, &emitted, &self.links, &self.refinement.occluded);
        let Some(pairs) = pairs.merge(cancel) else { return false };
        self.adopt(&pairs);
        true
    }

    /// Goes on with these pairs and no more patches than they need.
    fn adopt(&mut self, pairs: &[(Pair, Standing)]) {
        let stays_split = split_by(&self.hierarchy, pairs);
        let (hierarchy, renumbering) = self.hierarchy.merged_back(|id| stays_split[id.index()]);
        let before = std::mem::replace(&mut self.hierarchy, hierarchy);
        let renumbered = |id: ElementId| {
            renumbering.of(id).expect("patches above the ends of a pair stay split, so that the ends stay")
        };
        let link = |(pair, standing): &(Pair, Standing)| match standing {
            Standing::Linked(link) => Some((renumbered(pair.0), link.with_source(renumbered(pair.1)))),
            Standing::Occluded { .. } => None,
        };
        let links: Vec<(ElementId, Link)> = pairs.iter().filter_map(link).collect();
        self.links = LinkTable::default();
        self.links.append(self.hierarchy.elements().len(), &links);
        self.refinement.occluded = occluded_of(pairs, &renumbered);
        if let Some(recorded) = &mut self.refinement.rejected {
            *recorded = recorded::after_merging(recorded, pairs, (&before, &self.hierarchy), &renumbering);
        }
        self.light = light_of(&self.light, &before, &renumbering);
        self.max_radiosity = renumbering.reorder(&self.max_radiosity);
    }
}

/// Whether each element is split because a pair needs one of its parts.
fn split_by(hierarchy: &Hierarchy, pairs: &[(Pair, Standing)]) -> Vec<bool> {
    let mut is_needed = vec![false; hierarchy.elements().len()];
    for ((receiver, source), _) in pairs {
        is_needed[receiver.index()] = true;
        is_needed[source.index()] = true;
    }
    let mut is_split = vec![false; is_needed.len()];
    // Children come after their parent.
    for id in (0..is_needed.len() as u32).rev().map(ElementId) {
        if (is_needed[id.index()] || is_split[id.index()])
            && let Some(parent) = hierarchy.element(id).parent()
        {
            is_split[parent.index()] = true;
        }
    }
    is_split
}

/// The occluded pairs, both directions together where they stand alike.
fn occluded_of(pairs: &[(Pair, Standing)], renumbered: &impl Fn(ElementId) -> ElementId) -> Vec<OccludedPair> {
    let standing_of = |pair: Pair| match pairs.binary_search_by_key(&pair, |(pair, _)| *pair) {
        Ok(place) => match pairs[place].1 {
            Standing::Occluded { was_negligible } => Some(was_negligible),
            Standing::Linked(_) => None,
        },
        Err(_) => None,
    };
    let occluded = |((receiver, source), standing): &(Pair, Standing)| {
        let Standing::Occluded { was_negligible } = *standing else { return None };
        let to_b = standing_of((*source, *receiver)) == Some(was_negligible);
        if to_b && receiver > source {
            // The other direction stands for both.
            return None;
        }
        let directions = Directions { to_a: true, to_b };
        let pair = Candidate::new(renumbered(*receiver), renumbered(*source), directions, 0.0, false);
        Some(OccludedPair { pair, was_negligible })
    };
    pairs.iter().filter_map(occluded).collect()
}

/// The light of what is left, that of merged patches the mean over their quarters.
fn light_of(light: &Light, before: &Hierarchy, renumbering: &Renumbering) -> Light {
    let mut irradiance = light.irradiance.clone();
    for id in (0..before.elements().len() as u32).rev().map(ElementId) {
        let element = before.element(id);
        let is_merged = |child: ElementId| renumbering.of(child).is_none();
        if element.area > 0.0 && !element.is_leaf() && element.children().all(is_merged) {
            let power: Vec3 =
                element.children().map(|child| before.element(child).area * irradiance[child.index()]).sum();
            irradiance[id.index()] = power / element.area;
        }
    }
    Light {
        radiosity: renumbering.reorder(&light.radiosity),
        irradiance: renumbering.reorder(&irradiance),
        emitted: renumbering.reorder(&light.emitted),
        row_scale: renumbering.reorder(&light.row_scale),
    }
}
