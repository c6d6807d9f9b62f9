//! The inspector: the picked element's place in the hierarchy, what it is, and all its links,
//! either way.
//!
//! From above to below: the path from the root as a breadcrumb to climb, the element in numbers,
//! what the clusters around it bring as bars, and every link as a row of a table. What the mouse is
//! over is marked in the view; a click walks there.

mod bars;
mod breadcrumb;
mod numbers;
mod order;
mod table;

use egui::{RichText, Ui};

use crate::app::actions::{Action, Outbox};
use crate::app::state::inspection::{Direction, Inspection};
use crate::app::view::highlight::Pointing;
use crate::app::widgets::{rows, theme};
use crate::app::{Shown, format, words};
use crate::hierarchy::{ElementId, Hierarchy};
use crate::transport::SolutionView;

/// How the inspector shows links, and where it has been.
#[derive(Default)]
pub struct Inspector {
    direction: Direction,
    bars: bars::Bars,
    order: order::Order,
    /// Elements that were walked from, the last one last.
    visited: Vec<ElementId>,
}

impl Inspector {
    /// Which way the light goes that is looked at.
    pub fn direction(&self) -> Direction {
        self.direction
    }
}

/// The directions with their names and hints.
const DIRECTIONS: [(Direction, &str, &str); 2] = [
    (
        Direction::In,
        words::WHAT_LIGHTS_THIS,
        "Links that bring it light: its own, those of its parts and of all that holds it",
    ),
    (Direction::Out, words::WHAT_THIS_LIGHTS, "Links that take its light elsewhere, likewise"),
];

/// The element that is looked at, and the state that it is part of.
struct Subject<'a> {
    solution_view: &'a SolutionView,
    element: ElementId,
}

/// Where a person goes on to.
enum Walk {
    To(ElementId),
    Back,
}

/// Draws it.
pub fn show(
    ui: &mut Ui,
    shown: &Shown,
    inspector: &mut Inspector,
    inspection: &mut Inspection,
    pointing: &mut Pointing,
    outbox: &mut Outbox,
) {
    if shown.snapshot.is_none() {
        ui.label(theme::weak("Open a scene to look inside its solution."));
        return;
    }
    let Some(element) = shown.picked_element() else {
        if show_nothing_picked(ui) {
            outbox.act(Action::Pick(Hierarchy::ROOT));
        }
        return;
    };
    let Some(solution_view) = shown.solution_view().filter(|solution_view| solution_view.holds(element)) else {
        ui.label(theme::weak("Asking for its links…"));
        return;
    };
    let subject = Subject { solution_view, element };
    let mut walk = show_head(ui, &subject, inspection, &inspector.visited);
    walk = breadcrumb::show(ui, &subject, inspection, pointing).or(walk);
    if let Some(facts) = &inspection.facts {
        numbers::show(ui, &subject, facts);
    }
    ui.separator();
    // The links at hand are those of the direction until now; another one is looked at in the next
    // frame.
    let direction = inspector.direction;
    ui.horizontal(|ui| rows::alternatives(ui, &mut inspector.direction, &DIRECTIONS));
    walk = bars::show(ui, &subject, inspection, direction, &mut inspector.bars, pointing).or(walk);
    ui.separator();
    walk = table::show(ui, &subject, inspection, direction, &mut inspector.order, pointing).or(walk);
    match walk {
        Some(Walk::To(id)) if id != element && solution_view.holds(id) => {
            inspector.visited.push(element);
            outbox.act(Action::Pick(id));
            outbox.act(Action::TurnTowards(solution_view.hierarchy().element(id).centre));
        }
        Some(Walk::Back) => inspector.visited.pop().into_iter().for_each(|last| outbox.act(Action::Pick(last))),
        Some(Walk::To(_)) | None => {}
    }
}

fn show_nothing_picked(ui: &mut Ui) -> bool {
    ui.add_space(12.0);
    ui.label("Click a surface in the view: its path to the root, its light and every link of it appear here.");
    ui.add_space(6.0);
    let hint = "The root cluster: everything, and the links of all parts";
    ui.button("Inspect the whole scene").on_hover_text(hint).clicked()
}

/// The element's name, and the way back.
fn show_head(ui: &mut Ui, subject: &Subject<'_>, inspection: &mut Inspection, visited: &[ElementId]) -> Option<Walk> {
    let (solution_view, id) = (subject.solution_view, subject.element);
    let mut walk = None;
    ui.horizontal(|ui| {
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            let parent = solution_view.hierarchy().element(id).parent();
            let up = ui.add_enabled(parent.is_some(), egui::Button::new(words::UP));
            if let Some(parent) = parent.filter(|_| up.on_hover_text("Climb to the element that holds it").clicked()) {
                walk = Some(Walk::To(parent));
            }
            let last = visited.last().copied().filter(|&last| solution_view.holds(last));
            let back = ui.add_enabled(last.is_some(), egui::Button::new(words::BACK));
            if back.on_hover_text("Return to the element that you came from").clicked() {
                walk = Some(Walk::Back);
            }
            let name = inspection.names.full(id).to_owned();
            let element = solution_view.hierarchy().element(id);
            let kind = if element.is_cluster() {
                "cluster"
            } else if element.is_sky() {
                "outside"
            } else {
                "patch"
            };
            ui.with_layout(egui::Layout::left_to_right(egui::Align::Center), |ui| {
                ui.label(theme::weak(kind));
                ui.add(egui::Label::new(RichText::new(name).strong()).truncate());
            });
        });
    });
    walk
}

/// A number in six characters at most: 12,345, 12.3, 0.0123, 0.0012, 1.2e-5.
fn compact(value: f32) -> String {
    match value.abs() {
        size if size > 0.0 && !(1e-3..1e5).contains(&size) => format!("{value:.1e}"),
        size if size > 0.0 && size < 1e-2 => format!("{value:.4}"),
        _ => format::number(value.into()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Written out by hand.
    #[test]
    fn numbers_fit_into_their_columns() {
        let values = [0.0, 12_345.0, 123_456.0, 12.34, 0.012_34, 0.001_234, 1.234e-5, 0.999, 1e-3];
        let read = values.map(compact);
        assert_eq!(read, ["0", "12,345", "1.2e5", "12.3", "0.0123", "0.0012", "1.2e-5", "0.999", "0.0010"]);
        assert!(read.iter().all(|text| text.len() <= 6));
    }
}
