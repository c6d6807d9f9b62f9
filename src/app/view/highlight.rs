//! The element that a person points at, in a panel or in the view: every panel says so and every
//! panel marks it.
//!
//! While a frame is laid out, whoever is pointed at calls [`Pointing::at`]. Panels come before the
//! view, which draws the highlight in the same frame; the panels themselves mark what the last
//! frame ended with ([`Pointing::shown`]).

use crate::hierarchy::{ElementId, Hierarchy};
use crate::render::{Line, element_outline};
use crate::transport::SolutionView;

/// An element or a link that is pointed at.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Highlight {
    /// Nothing is.
    #[default]
    None,
    /// An element.
    Element(ElementId),
    /// Both ends of a link, and the way between them.
    Link { receiver: ElementId, source: ElementId },
}

/// Things that are pointed at in this frame, and in the last one.
#[derive(Default)]
pub struct Pointing {
    now: Highlight,
    shown: Highlight,
}

/// Colours of the highlight, gamma-encoded: what receives, what sends, and the light's way.
pub const RECEIVER: [u8; 4] = [92, 214, 255, 255];
pub const SOURCE: [u8; 4] = [255, 190, 70, 255];
const WAY: [u8; 4] = [255, 255, 255, 255];
const OUTLINE_WIDTH: f32 = 3.0;
const WAY_WIDTH: f32 = 3.0;
const DOT: f32 = 11.0;

impl Pointing {
    /// Says that this is pointed at; the last one to say so in a frame is heard.
    pub fn at(&mut self, highlight: Highlight) {
        self.now = highlight;
    }

    /// Highlight by the pointer when the last frame ended.
    pub fn shown(&self) -> Highlight {
        self.shown
    }

    /// Highlight by the pointer so far in this frame.
    pub fn now(&self) -> Highlight {
        self.now
    }

    /// Ends a frame; another one follows where something changed.
    pub fn end_frame(&mut self, ctx: &egui::Context) {
        if self.now != self.shown {
            ctx.request_repaint();
        }
        self.shown = std::mem::take(&mut self.now);
    }
}

impl Highlight {
    /// Lines that mark it in the view; none for what is not there.
    pub fn lines(self, solution_view: &SolutionView) -> Vec<Line> {
        let hierarchy = solution_view.hierarchy();
        match self {
            Self::Element(id) if solution_view.holds(id) => outline(hierarchy, id, WAY),
            Self::Link { receiver, source } if solution_view.holds(receiver) && solution_view.holds(source) => {
                let centre = |id: ElementId| hierarchy.element(id).centre;
                let mut lines = outline(hierarchy, receiver, RECEIVER);
                lines.extend(outline(hierarchy, source, SOURCE));
                lines.push(Line::new(centre(source), centre(receiver), WAY_WIDTH, WAY));
                lines.push(Line::dot(centre(receiver), DOT, RECEIVER));
                lines.push(Line::dot(centre(source), DOT, SOURCE));
                lines
            }
            Self::None | Self::Element(_) | Self::Link { .. } => Vec::new(),
        }
    }
}

fn outline(hierarchy: &Hierarchy, id: ElementId, colour: [u8; 4]) -> Vec<Line> {
    let edges = element_outline(hierarchy, id).into_iter();
    edges.map(|[from, to]| Line::new(from, to, OUTLINE_WIDTH, colour)).collect()
}
