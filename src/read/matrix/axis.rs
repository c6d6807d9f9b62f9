//! Brackets along the edges of the matrix: the elements worth naming, in tiers from large to small.
//!
//! Each tier holds the largest elements that are no larger than its share of what is in view, so
//! that they lie inside of those of the tier before; as one zooms in, smaller ones take their
//! place.

use rustc_hash::FxHashMap;

use crate::hierarchy::{ElementId, Hierarchy, Order};
use crate::read::names::Names;
use crate::transport::SolutionView;

/// Largest share of what is in view that an element of each tier takes.
const TIERS: [f64; 3] = [0.45, 0.12, 0.03];
/// Elements that take less room are not marked, points or pixels.
const LEAST: f64 = 3.0;

/// An element along an edge.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bracket {
    /// The element.
    pub element: ElementId,
    /// The first tier that it belongs to, 0 for that of the largest ones.
    pub tier: usize,
    /// The last one: what is small enough for the next tier too takes the room of both.
    pub last_tier: usize,
    /// Beginning and end of the element on the axis, 0..=1.
    pub span: [f64; 2],
}

/// The brackets of so many tiers for what lies between two places, drawn `length` points long.
pub fn brackets(
    hierarchy: &Hierarchy,
    order: &Order,
    [start, end]: [f64; 2],
    length: f32,
    tiers: usize,
) -> Vec<Bracket> {
    let size = end - start;
    let least = LEAST / f64::from(length.max(1.0)) * size;
    let mut found: FxHashMap<ElementId, Bracket> = FxHashMap::default();
    for (tier, share) in TIERS.into_iter().take(tiers).enumerate() {
        let mut open: Vec<ElementId> = std::iter::once(Hierarchy::ROOT).chain(hierarchy.outside()).collect();
        while let Some(id) = open.pop() {
            let span = order.span(id);
            let width = span[1] - span[0];
            if span[0] >= end || span[1] <= start || width < least {
                continue;
            }
            let element = hierarchy.element(id);
            if width <= share * size || element.is_leaf() {
                let first = Bracket { element: id, tier, last_tier: tier, span };
                found.entry(id).or_insert(first).last_tier = tier;
            } else {
                open.extend(element.children());
            }
        }
    }
    // From one end to the other, tier by tier.
    let mut found: Vec<Bracket> = found.into_values().collect();
    found.sort_by(|one, other| one.tier.cmp(&other.tier).then(one.span[0].total_cmp(&other.span[0])));
    found
}

/// Fewer letters of a name than these say nothing.
const FEWEST_LETTERS: usize = 3;

/// The longest name of an element that `fits`, its label shortened if need be; `None` where nothing
/// does, or where an inner bracket would only repeat what the one around it says.
pub fn fitting_name(
    names: &Names,
    solution_view: &SolutionView,
    bracket: &Bracket,
    fits: impl Fn(&str) -> bool,
) -> Option<String> {
    let (id, hierarchy) = (bracket.element, solution_view.hierarchy());
    let is_patch = |id: ElementId| hierarchy.element(id).is_patch();
    if bracket.tier > 0 && is_patch(id) && hierarchy.element(id).parent().is_some_and(is_patch) {
        return None;
    }
    let label = names.label(hierarchy, id);
    let letters = label.chars().count();
    let shortened = (FEWEST_LETTERS..letters).rev().map(|kept| label.chars().take(kept).chain(['…']).collect());
    let candidates = [names.full(solution_view, id), label.clone()].into_iter().chain(shortened);
    candidates.into_iter().find(|name| fits(name))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Reachability;
    use crate::hierarchy::{ClusteringMode, Room};
    use crate::scene::builtin::BuiltinScene;

    /// Truth: brackets of one tier lie side by side, none larger than its share, and nothing that
    /// is large enough is left out.
    #[test]
    fn brackets_follow_what_is_in_view() {
        let scene = BuiltinScene::from_name("office").expect("ours").build();
        let hierarchy = Hierarchy::new(&scene, Reachability::default().into(), ClusteringMode::Adaptive, 4);
        let order = Order::new(&hierarchy, Room::Polygons);
        for view in [[0.0, 1.0], [0.25, 0.375], [0.5, 0.5001]] {
            let all = brackets(&hierarchy, &order, view, 400.0, 2);
            assert!(!all.is_empty());
            for (tier, share) in TIERS.into_iter().enumerate().take(2) {
                let is_of = |bracket: &&Bracket| (bracket.tier..=bracket.last_tier).contains(&tier);
                let mut of_tier: Vec<&Bracket> = all.iter().filter(is_of).collect();
                of_tier.sort_by(|one, other| one.span[0].total_cmp(&other.span[0]));
                assert!(of_tier.windows(2).all(|pair| pair[0].span[1] <= pair[1].span[0]));
                for bracket in of_tier {
                    assert!(bracket.span[0] < view[1] && bracket.span[1] > view[0]);
                    let width = bracket.span[1] - bracket.span[0];
                    let is_leaf = hierarchy.element(bracket.element).is_leaf();
                    assert!(is_leaf || width <= share * (view[1] - view[0]));
                }
            }
        }
    }
}
