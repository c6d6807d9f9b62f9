//! The marks over the view: links, the picked element and what is pointed at; made anew only when one of them changes.

use super::highlight::Highlight;
use crate::hierarchy::ElementId;
use crate::render::{Line, Marks, link_marks};
use crate::solver::Snapshot;

/// Marks, and what they were made of.
#[derive(Default)]
pub(super) struct MarksOverView {
    links: (Option<LinksOf>, Vec<Line>),
    all: (Option<(LinksOf, Highlight)>, Marks),
}

/// Generation, serial, picked element and the most links that are drawn.
type LinksOf = (u64, u64, Option<ElementId>, usize);

impl MarksOverView {
    /// The marks over a snapshot.
    pub(super) fn over(
        &mut self,
        snapshot: &Snapshot,
        picked: Option<ElementId>,
        most: usize,
        highlight: Highlight,
    ) -> Marks {
        let of = (snapshot.generation, snapshot.serial, picked, most);
        if self.links.0 != Some(of) {
            let lines = picked.map(|element| link_marks(snapshot, element, most)).unwrap_or_default();
            self.links = (Some(of), lines);
        }
        if self.all.0 != Some((of, highlight)) {
            let mut lines = self.links.1.clone();
            if let Some(anatomy) = &snapshot.anatomy {
                lines.extend(highlight.lines(anatomy));
            }
            self.all = (Some((of, highlight)), lines.into());
        }
        self.all.1.clone()
    }
}
