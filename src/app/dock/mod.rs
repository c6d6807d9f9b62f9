//! The dock at the right: tools that look into the solution, one at a time; closed until somebody asks for one.
//!
//! A bar above the view opens and closes them.

mod clusters;
pub(super) mod compare;
mod export;
mod inspector;
mod matrix;
mod measure;

use egui::{RichText, ScrollArea, Ui};
use serde::{Deserialize, Serialize};

pub(super) use clusters::Clusters;
pub(super) use inspector::Inspector;
pub(super) use matrix::LinkMatrix;

use super::{App, Outbox};

/// A tool of the dock.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(in crate::app) enum Tool {
    /// What an element is, what lights it and what it lights.
    Inspector,
    /// All links as blocks, receivers by sources.
    Matrix,
    /// The tree of clusters, and groups made by hand.
    Clusters,
    /// Irradiance at points.
    Measure,
    /// Two solutions side by side.
    Compare,
    /// What can be taken along.
    Export,
}

impl Tool {
    /// Whether the tool looks at elements and links, which snapshots carry only when they are asked to.
    pub(super) fn reads_anatomy(self) -> bool {
        matches!(self, Self::Inspector | Self::Matrix | Self::Clusters | Self::Export)
    }

    /// Whether the tool marks what lies under the mouse in the view.
    pub(super) fn marks_what_is_pointed_at(self) -> bool {
        self == Self::Matrix
    }

    /// Width when it is opened for the first time, points; each tool remembers its own.
    fn first_width(self) -> f32 {
        if matches!(self, Self::Inspector | Self::Matrix | Self::Clusters) { FIRST_WIDTH_OF_TABLE } else { FIRST_WIDTH }
    }
}

/// Every tool with its name on the bar and what it is for, in the bar's order.
const TOOLS: [(Tool, &str, &str); 6] = [
    (Tool::Inspector, "Inspector", "What an element is, what lights it and what it lights"),
    (Tool::Matrix, "Link matrix", "All links as blocks: receivers by sources"),
    (Tool::Clusters, "Clusters", "The tree of clusters, and groups made by hand"),
    (Tool::Measure, "Measure", "Irradiance and illuminance at points and on a work plane"),
    (Tool::Compare, "Compare", "Two solutions side by side"),
    (Tool::Export, "Export", "Pictures, meshes, links and numbers to take along"),
];

/// Widths that the dock may be given, points.
const WIDTHS: std::ops::RangeInclusive<f32> = 300.0..=900.0;
const FIRST_WIDTH: f32 = 380.0;
/// For a table.
const FIRST_WIDTH_OF_TABLE: f32 = 500.0;

/// The bar above the view: a switch for each tool.
pub(super) fn show_bar(app: &mut App, ui: &mut Ui) {
    ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
        let keys =
            ui.selectable_label(app.are_keys_shown, " ? ").on_hover_text("Mouse and keys").accessible_name("Keys");
        if keys.clicked() {
            app.are_keys_shown = !app.are_keys_shown;
        }
        let full = ui.selectable_label(app.is_full_picture, "Full picture");
        if full.on_hover_text("Hide all panels; F11 or Esc brings them back").clicked() {
            app.is_full_picture = true;
        }
        ui.separator();
        for (tool, name, hint) in TOOLS.iter().rev() {
            let is_open = app.tool == Some(*tool);
            if ui.selectable_label(is_open, *name).on_hover_text(*hint).clicked() {
                app.tool = (!is_open).then_some(*tool);
            }
        }
    });
}

/// The open tool, if one is.
pub(super) fn show(app: &mut App, ui: &mut Ui, outbox: &mut Outbox) {
    let Some(open) = app.tool else { return };
    let Some((_, name, hint)) = TOOLS.iter().find(|(tool, ..)| *tool == open) else { return };
    egui::Panel::right(*name).default_size(open.first_width()).size_range(WIDTHS).show(ui, |ui| {
        ui.horizontal(|ui| {
            ui.label(RichText::new(*name).strong().size(14.0)).on_hover_text(*hint);
            ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
                if ui.button("Close tool").clicked() {
                    app.tool = None;
                }
            });
        });
        ui.separator();
        match open {
            // These fill the dock and scroll by themselves.
            Tool::Inspector => inspector::show(app, ui),
            Tool::Matrix => matrix::show(app, ui),
            Tool::Clusters => clusters::show(app, ui, outbox),
            Tool::Measure | Tool::Compare | Tool::Export => {
                ScrollArea::vertical().auto_shrink([false, false]).show(ui, |ui| match open {
                    Tool::Measure => measure::show(ui, &app.shown, &mut app.measuring, &mut app.messages, &app.wake),
                    Tool::Compare => compare::show(app, ui),
                    Tool::Export => export::show(app, ui),
                    Tool::Inspector | Tool::Matrix | Tool::Clusters => {}
                });
            }
        }
    });
}
