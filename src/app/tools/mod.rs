//! The dock at the right: tools that look into the solution, one at a time; closed until somebody
//! asks for one.
//!
//! A bar above the view opens and closes them.

mod clusters;
pub(in crate::app) mod compare;
mod export;
mod inspector;
mod matrix;
mod measure;

use egui::{RichText, ScrollArea, Ui};
use serde::{Deserialize, Serialize};

pub(in crate::app) use clusters::Clusters;
pub(in crate::app) use inspector::Inspector;
pub(in crate::app) use matrix::LinkMatrix;

use crate::app::state::comparison::Comparison;
use crate::app::state::inspection::Inspection;
use crate::app::state::measuring::Measuring;
use crate::app::state::pinned::Pinned;
use crate::app::state::playback::Playback;
use crate::app::{App, Outbox, layout, words};

/// State of each tool.
#[derive(Default)]
pub(in crate::app) struct Tools {
    /// The tool that the dock shows.
    pub open: Option<Tool>,
    /// Links of the selected element.
    pub inspection: Inspection,
    /// How the inspector shows them.
    pub inspector: Inspector,
    /// The link matrix.
    pub matrix: LinkMatrix,
    /// The tree of clusters.
    pub clusters: Clusters,
    /// Probes and work plane.
    pub measuring: Measuring,
    /// The comparison with a reference.
    pub comparison: Comparison,
    /// The solution that is kept as A.
    pub pinned: Pinned,
    /// The step of the timeline in view.
    pub playback: Playback,
}

/// A tool of the dock.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(in crate::app) enum Tool {
    /// Facts about an element, the links that light it, and those by which it lights others.
    Inspector,
    /// All links as blocks, receivers by sources.
    Matrix,
    /// The tree of clusters, and groups made by hand.
    Clusters,
    /// Irradiance at points.
    Measure,
    /// Two solutions side by side.
    Compare,
    /// Images, meshes and data as files.
    Export,
}

impl Tool {
    /// Whether the tool looks at elements and links, which snapshots carry only when they are asked
    /// to.
    pub(in crate::app) fn reads_solution_view(self) -> bool {
        matches!(self, Self::Inspector | Self::Matrix | Self::Clusters | Self::Export)
    }

    /// Whether the tool marks what lies under the mouse in the view.
    pub(in crate::app) fn marks_what_is_pointed_at(self) -> bool {
        self == Self::Matrix
    }

    /// Width when it is opened for the first time, points; each tool remembers its own.
    fn first_width(self) -> f32 {
        if matches!(self, Self::Inspector | Self::Matrix | Self::Clusters) { FIRST_WIDTH_OF_TABLE } else { FIRST_WIDTH }
    }
}

/// Every tool with its name on the bar and what it is for, in the bar's order.
const TOOLS: [(Tool, &str, &str); 6] = [
    (Tool::Inspector, words::INSPECTOR, "One element: its place in the hierarchy, its light and its links"),
    (Tool::Matrix, words::LINK_MATRIX, "All links as blocks: receivers by sources"),
    (Tool::Clusters, words::CLUSTERS, "The tree of clusters, and manual groups"),
    (Tool::Measure, words::MEASURE, "Irradiance and illuminance at points and on a work plane"),
    (Tool::Compare, words::COMPARE, "Two solutions side by side"),
    (Tool::Export, words::EXPORT, words::EXPORT_HINT),
];

/// Widths that the dock may be given, points.
pub(in crate::app) const WIDTHS: std::ops::RangeInclusive<f32> = 340.0..=900.0;
const FIRST_WIDTH: f32 = 380.0;
/// For a table.
const FIRST_WIDTH_OF_TABLE: f32 = 540.0;
/// A narrower bar has the tools in a menu, points.
const ROOM_FOR_TOOLS: f32 = 840.0;

/// The bar above the view: a switch for each tool, in a menu where there is no room for all of
/// them.
pub(in crate::app) fn show_bar(app: &mut App, ui: &mut Ui) {
    let has_room = ui.max_rect().width() >= ROOM_FOR_TOOLS;
    ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
        let keys = ui
            .selectable_label(app.layout.are_keys_shown, " ? ")
            .on_hover_text(words::MOUSE_AND_KEYS)
            .accessible_name(words::KEYS);
        if keys.clicked() {
            app.layout.are_keys_shown = !app.layout.are_keys_shown;
        }
        if has_room {
            show_full_screen(app, ui);
            ui.separator();
            for (tool, name, hint) in TOOLS.iter().rev() {
                show_switch(app, ui, *tool, name, hint);
            }
        } else {
            ui.menu_button(words::TOOLS, |ui| {
                for (tool, name, hint) in &TOOLS {
                    if show_switch(app, ui, *tool, name, hint) {
                        ui.close();
                    }
                }
                ui.separator();
                if show_full_screen(app, ui) {
                    ui.close();
                }
            });
        }
    });
}

/// The switch of the full screen; whether it was clicked.
fn show_full_screen(app: &mut App, ui: &mut Ui) -> bool {
    let full = ui.selectable_label(app.layout.is_full_picture, words::FULL_SCREEN);
    let is_clicked = full.on_hover_text("The picture alone; F11 or Esc brings the panels back").clicked();
    if is_clicked {
        app.set_full_screen(ui.ctx(), true);
    }
    is_clicked
}

/// The switch of a tool; whether it was clicked.
fn show_switch(app: &mut App, ui: &mut Ui, tool: Tool, name: &str, hint: &str) -> bool {
    let is_clicked = ui.selectable_label(app.tools.open == Some(tool), name).on_hover_text(hint).clicked();
    if is_clicked {
        app.toggle_tool(tool);
    }
    is_clicked
}

/// The open tool, if one is.
pub(in crate::app) fn show(app: &mut App, ui: &mut Ui, outbox: &mut Outbox) {
    let Some(open) = app.tools.open else { return };
    let Some((_, name, hint)) = TOOLS.iter().find(|(tool, ..)| *tool == open) else { return };
    let most =
        (layout::Sides::of(app, ui.ctx()).all - app.layout.settings_width).max(*WIDTHS.start()).min(*WIDTHS.end());
    let widths = *WIDTHS.start()..=most;
    egui::Panel::right(*name).default_size(open.first_width().min(most)).size_range(widths).show(ui, |ui| {
        ui.horizontal(|ui| {
            ui.label(RichText::new(*name).strong().size(14.0)).on_hover_text(*hint);
            ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
                if ui.button(words::CLOSE_TOOL).clicked() {
                    app.tools.open = None;
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
                    Tool::Measure => {
                        measure::show(ui, &app.shown, &mut app.tools.measuring, &mut app.messages, &app.wake)
                    }
                    Tool::Compare => compare::show(app, ui),
                    Tool::Export => export::show(app, ui),
                    Tool::Inspector | Tool::Matrix | Tool::Clusters => {}
                });
            }
        }
    });
}
