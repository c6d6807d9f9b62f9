//! Content of the picked element's panels: facts, links and names, made once for each state of the
//! solution.

use std::sync::Arc;
use std::time::{Duration, Instant};

use crate::app::state::facts::Facts;
use crate::app::state::names::NamesInView;
use crate::hierarchy::ElementId;
use crate::scene::Scene;
use crate::solve::Snapshot;
use crate::transport::{LinkView, SolutionView};

/// While the solution moves on, an inspection may take this share of the time, so that a large one
/// does not hold up the window.
const BUSY_SHARE: u32 = 8;

/// Which way light goes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Direction {
    /// To the element: what lights it.
    #[default]
    In,
    /// From the element: what it lights.
    Out,
}

impl Direction {
    /// The end of a link away from the element that is inspected.
    pub fn far_end(self, link: &LinkView) -> ElementId {
        match self {
            Self::In => link.source,
            Self::Out => link.receiver,
        }
    }
}

/// Content of the picked element's panels.
#[derive(Default)]
pub struct Inspection {
    made_of: Option<MadeOf>,
    made: Option<(Instant, Duration)>,
    /// Counts up with each change of `links`.
    pub stamp: u64,
    pub facts: Option<Facts>,
    /// Links of the element, of its parts and of all that holds it, by the light they bring; most
    /// first.
    pub links: Vec<LinkView>,
    /// Names of elements, for all tools.
    pub names: NamesInView,
}

/// State that an inspection was made of.
#[derive(Clone, Copy, PartialEq, Eq)]
struct MadeOf {
    generation: u64,
    serial: u64,
    former_step: Option<usize>,
    has_solution_view: bool,
    element: ElementId,
    direction: Direction,
}

impl Inspection {
    /// Looks at an element, unless nothing has changed. While only the solution moves on and
    /// looking takes long, what was seen last stays for a while; true then: another look is due.
    pub fn look(&mut self, snapshot: &Snapshot, scene: &Arc<Scene>, element: ElementId, direction: Direction) -> bool {
        let (generation, serial, former_step) = (snapshot.generation, snapshot.serial, snapshot.former_step);
        let has_solution_view = snapshot.solution_view.is_some();
        let now = MadeOf { generation, serial, former_step, has_solution_view, element, direction };
        if self.made_of == Some(now) {
            return false;
        }
        let is_same = self.made_of.is_some_and(|then| MadeOf { serial, ..then } == now);
        if is_same && self.made.is_some_and(|(when, took)| when.elapsed() < BUSY_SHARE * took) {
            return true;
        }
        let begun = Instant::now();
        self.links.clear();
        match snapshot.solution_view.as_ref().filter(|solution_view| solution_view.holds(element)) {
            Some(solution_view) => {
                self.facts = Some(Facts::of(snapshot, solution_view, scene, element));
                self.links = links(solution_view, element, direction);
            }
            None => self.facts = Facts::of_leaf(snapshot, scene, element),
        }
        self.stamp += 1;
        (self.made_of, self.made) = (Some(now), Some((begun, begun.elapsed())));
        false
    }

    /// Name of the element that was looked at; it needs no links where that is a patch.
    pub fn name(&mut self, element: ElementId) -> String {
        match self.names.full(element) {
            "" => self.facts.as_ref().map(|facts| facts.name.clone()).unwrap_or_default(),
            name => name.to_owned(),
        }
    }
}

/// The links of an element, its parts and all that holds it, by what they bring; most first.
fn links(solution_view: &SolutionView, element: ElementId, direction: Direction) -> Vec<LinkView> {
    let mut links = match direction {
        Direction::In => solution_view.all_incoming(element),
        Direction::Out => solution_view.all_outgoing(element),
    };
    let most = |link: &LinkView| match direction {
        Direction::In => link.irradiance.max_element(),
        Direction::Out => link.power.element_sum(),
    };
    links.sort_by(|a, b| most(b).total_cmp(&most(a)));
    links
}
