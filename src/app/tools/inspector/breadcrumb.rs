//! The path from the root to the element, to be climbed.

use egui::{RichText, Ui};

use crate::app::state::inspection::Inspection;
use crate::app::tools::inspector::{Subject, Walk};
use crate::app::view::highlight::{Highlight, Pointing};
use crate::app::widgets::theme;

/// Draws it; where a person climbs to.
pub fn show(ui: &mut Ui, subject: &Subject<'_>, inspection: &Inspection, pointing: &mut Pointing) -> Option<Walk> {
    let mut walk = None;
    let path = subject.solution_view.path(subject.element);
    ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().item_spacing = egui::vec2(3.0, 2.0);
        ui.spacing_mut().button_padding = egui::vec2(4.0, 1.0);
        for (depth, &id) in path.iter().enumerate() {
            if depth > 0 {
                ui.label(theme::weak("›"));
            }
            let is_here = id == subject.element;
            let name = inspection.names.short(id);
            let colour = if is_here { ui.visuals().strong_text_color() } else { ui.visuals().text_color() };
            let crumb = ui.selectable_label(is_here, RichText::new(name).size(12.0).color(colour));
            let crumb = crumb.on_hover_text(format!("Level {depth}: click to inspect it"));
            if crumb.hovered() {
                pointing.at(Highlight::Element(id));
            }
            if crumb.clicked() {
                walk = Some(Walk::To(id));
            }
        }
    });
    walk
}
