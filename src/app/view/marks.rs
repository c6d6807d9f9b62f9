//! The marks over the view: links, the picked element and what is pointed at; made anew only when
//! one of them changes.

use crate::app::state::inspection::Inspection;
use crate::app::state::settings::{LinkOverlay, LinksOf};
use crate::app::view::highlight::Highlight;
use crate::hierarchy::ElementId;
use crate::render::{ChosenLinks, Line, Marks, picked_leaf, picked_marks, picked_rim};
use crate::solve::Snapshot;
use crate::transport::SolutionView;

/// Marks, and what they were made of.
#[derive(Default)]
pub struct MarksOverView {
    made_of: Option<MadeOf>,
    /// The links that are drawn; `None` where none are asked for.
    chosen: Option<ChosenLinks>,
    /// Lines of the links and of the picked element.
    lines: Vec<Line>,
    /// Marks with those of what is pointed at.
    all: Marks,
    highlight: Highlight,
}

/// State that links and the picked element's marks are made of.
#[derive(Clone, Copy, PartialEq)]
struct MadeOf {
    generation: u64,
    serial: u64,
    picked: Option<ElementId>,
    /// That of the inspection whose links are drawn.
    stamp: u64,
    links: LinkOverlay,
}

impl MarksOverView {
    /// The marks over a snapshot.
    pub fn over(
        &mut self,
        snapshot: &Snapshot,
        picked: Option<ElementId>,
        inspection: &Inspection,
        links: &LinkOverlay,
        highlight: Highlight,
    ) -> Marks {
        let (generation, serial) = (snapshot.generation, snapshot.serial);
        let now = MadeOf { generation, serial, picked, stamp: inspection.stamp, links: *links };
        let is_as_before = self.made_of == Some(now);
        if is_as_before && self.highlight == highlight {
            return self.all.clone();
        }
        if !is_as_before {
            (self.chosen, self.lines) = (None, Vec::new());
            match &snapshot.solution_view {
                Some(solution_view) => {
                    let picked = picked.filter(|&picked| solution_view.holds(picked));
                    self.draw(solution_view, picked, inspection, links);
                }
                // Nobody has asked for elements and links: what was clicked is marked all the same.
                None => self.lines.extend(picked.into_iter().flat_map(|picked| picked_leaf(&snapshot.mesh, picked))),
            }
        }
        let mut lines = self.lines.clone();
        lines.extend(snapshot.solution_view.iter().flat_map(|solution_view| highlight.lines(solution_view)));
        (self.made_of, self.highlight, self.all) = (Some(now), highlight, lines.into());
        self.all.clone()
    }

    fn draw(
        &mut self,
        solution_view: &SolutionView,
        picked: Option<ElementId>,
        inspection: &Inspection,
        links: &LinkOverlay,
    ) {
        let epsilon = solution_view.epsilon_watts();
        self.chosen = match (links.of, picked) {
            (LinksOf::Nothing, _) | (LinksOf::Picked, None) => None,
            (LinksOf::Picked, Some(_)) => {
                Some(ChosenLinks::new(inspection.links.iter().copied(), &links.filter, epsilon))
            }
            (LinksOf::Level, _) => {
                // While the first links are refined, none reaches down to the level.
                let deepest = links.level.min(solution_view.deepest());
                let of_level =
                    |level: u16| ChosenLinks::new(solution_view.links_at_depth(level), &links.filter, epsilon);
                Some((0..=deepest).rev().map(of_level).find(|of_level| of_level.all > 0).unwrap_or_default())
            }
        };
        if let Some(chosen) = &self.chosen {
            self.lines = chosen.lines(solution_view, links.style);
        }
        let mark = if self.chosen.is_some() { picked_marks } else { picked_rim };
        self.lines.extend(picked.into_iter().flat_map(|picked| mark(solution_view, picked)));
    }

    /// The links that were last drawn; `None` where none are asked for.
    pub fn chosen_links(&self) -> Option<&ChosenLinks> {
        self.chosen.as_ref()
    }
}
