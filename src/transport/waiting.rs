//! Pairs that wait to be judged, as links: so that there is light over all of the scene at any
//! time.

use rayon::prelude::*;

use super::candidate::Waiting;
use super::form_factor::{Exchange, exchange, self_exchange};
use super::link::{Link, LinkTable, VisibilitySource};
use super::solution::LinkSolution;
use crate::hierarchy::{ElementId, Hierarchy, Shape};

impl LinkSolution {
    /// Stored links, those that wait to be stored, and candidates as if they had been accepted.
    pub fn table_with_waiting(&self) -> LinkTable {
        let mut table = self.links.clone();
        table.append(self.hierarchy.elements().len(), &self.links_not_stored());
        table
    }

    /// Links that wait to be stored, and candidates as if they had been accepted; with their
    /// receivers.
    pub fn links_not_stored(&self) -> Vec<(ElementId, Link)> {
        let hierarchy = &self.hierarchy;
        let waiting: Vec<&Waiting> = self.refinement.waiting().collect();
        let as_links: Vec<[Option<(ElementId, Link)>; 2]> =
            waiting.par_iter().with_min_len(256).map(|waiting| links_of_waiting(hierarchy, waiting)).collect();
        let accepted = self.refinement.accepted.iter().copied();
        accepted.chain(as_links.into_iter().flatten().flatten()).collect()
    }
}

/// Links of a waiting pair, with their estimated form factor and the visibility of what they came
/// from.
fn links_of_waiting(hierarchy: &Hierarchy, waiting: &Waiting) -> [Option<(ElementId, Link)>; 2] {
    match *waiting {
        Waiting::Pair(candidate) if candidate.is_self() => [self_link(hierarchy, candidate.a), None],
        Waiting::Pair(candidate) => {
            let (a, b) = (candidate.a, candidate.b);
            let Exchange::Facing { estimate, .. } = exchange(hierarchy, a, b) else { return [None, None] };
            let link = |asked: bool, receiver: ElementId, source: ElementId| {
                let area = hierarchy.element(receiver).area;
                let form_factor = if area > 0.0 { (estimate / area).min(1.0) } else { 0.0 };
                asked
                    .then(|| (receiver, Link::new(source, form_factor, candidate.visibility(), VisibilitySource::None)))
            };
            [link(candidate.directions.to_a, a, b), link(candidate.directions.to_b, b, a)]
        }
        Waiting::Siblings { .. } => [link_of_row(hierarchy, waiting).map(|(own, link)| (own, link.unjudged())), None],
    }
}

/// A row of siblings stands for the exchange of one child with the rest of its cluster: lets the
/// cluster light it. `None` for anything else.
pub(super) fn link_of_row(hierarchy: &Hierarchy, waiting: &Waiting) -> Option<(ElementId, Link)> {
    let Waiting::Siblings { cluster, child, from } = *waiting else { return None };
    let element = hierarchy.element(cluster);
    let own = element.children().nth(child as usize)?;
    let (_, link) = self_link(hierarchy, cluster)?;
    let left = (element.children().len() as u32 - from) as f32 / element.children().len() as f32;
    // Rows shrink as the wave goes on; both halves of the pairs of a row go to its child.
    let form_factor = (link.form_factor * 2.0 * left).min(link.form_factor);
    Some((own, Link::new(cluster, form_factor, 1.0, VisibilitySource::Inherited)))
}

fn self_link(hierarchy: &Hierarchy, id: ElementId) -> Option<(ElementId, Link)> {
    let element = hierarchy.element(id);
    let Shape::Cluster(cluster) = &element.shape else { return None };
    let form_factor = if element.area > 0.0 { self_exchange(element, cluster) / element.area } else { 0.0 };
    Some((id, Link::new(id, form_factor, 1.0, VisibilitySource::None)))
}
