//! Elements and link at a place of the matrix.

use crate::hierarchy::{ElementId, Room};
use crate::transport::{LinkView, SolutionView};

/// The pair at a place, and the link that serves it.
#[derive(Clone, Debug)]
pub struct Pair {
    /// Elements that lie at the row, from the root down to a leaf.
    pub receivers: Vec<ElementId>,
    /// Elements that lie at the column, likewise.
    pub sources: Vec<ElementId>,
    /// The link whose block lies there; `None` where the pair exchanges no light.
    pub link: Option<LinkView>,
}

/// Elements and link at a place, column and row from 0 to 1.
pub fn pair_at(solution_view: &SolutionView, room: Room, [column, row]: [f64; 2]) -> Pair {
    let (order, hierarchy) = (solution_view.order(room), solution_view.hierarchy());
    let receivers = order.path_at(hierarchy, row);
    let sources = order.path_at(hierarchy, column);
    // Sources of the links of one receiver do not hold each other, but where rows of siblings wait:
    // the smallest is found.
    let link = receivers.iter().rev().find_map(|&receiver| {
        let here = solution_view.links_of(receiver).filter(|link| sources.contains(&link.source));
        here.max_by_key(|link| sources.iter().position(|&id| id == link.source))
    });
    Pair { link, receivers, sources }
}
