//! The dock at the right: tools that look into the solution, one at a time; closed until somebody
//! asks for one.
//!
//! A bar above the view opens and closes them.

pub mod clusters;
pub mod compare;
pub mod export;
pub mod inspector;
pub mod matrix;
pub mod measure;

use egui::Ui;
use serde::{Deserialize, Serialize};

pub use clusters::Clusters;
pub use inspector::Inspector;
pub use matrix::LinkMatrix;

use crate::app::actions::{Action, Outbox};
use crate::app::state::comparison::Comparison;
use crate::app::state::inspection::Inspection;
use crate::app::state::measuring::Measuring;
use crate::app::state::pinned::Pinned;
use crate::app::state::playback::Playback;
use crate::app::words;

/// State of each tool.
#[derive(Default)]
pub struct Tools {
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
pub enum Tool {
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
    pub fn reads_solution_view(self) -> bool {
        matches!(self, Self::Inspector | Self::Matrix | Self::Clusters | Self::Export)
    }

    /// Whether the tool marks what lies under the mouse in the view.
    pub fn marks_what_is_pointed_at(self) -> bool {
        self == Self::Matrix
    }

    /// Width when it is opened for the first time, points; each tool remembers its own.
    pub fn first_width(self) -> f32 {
        if matches!(self, Self::Inspector | Self::Matrix | Self::Clusters) { FIRST_WIDTH_OF_TABLE } else { FIRST_WIDTH }
    }
}

/// Every tool with its name on the bar and what it is for, in the bar's order.
pub const TOOLS: [(Tool, &str, &str); 6] = [
    (Tool::Inspector, words::INSPECTOR, "One element: its place in the hierarchy, its light and its links"),
    (Tool::Matrix, words::LINK_MATRIX, "All links as blocks: receivers by sources"),
    (Tool::Clusters, words::CLUSTERS, "The tree of clusters, and manual groups"),
    (Tool::Measure, words::MEASURE, "Irradiance and illuminance at points and on a work plane"),
    (Tool::Compare, words::COMPARE, "Two solutions side by side"),
    (Tool::Export, words::EXPORT, "Export images, meshes, data"),
];

/// Widths that the dock may be given, points.
pub const WIDTHS: std::ops::RangeInclusive<f32> = 340.0..=900.0;
const FIRST_WIDTH: f32 = 380.0;
/// For a table.
const FIRST_WIDTH_OF_TABLE: f32 = 540.0;
/// A narrower bar has the tools in a menu, points.
const ROOM_FOR_TOOLS: f32 = 840.0;

/// The bar above the view: a switch for each tool, in a menu where there is no room for all of
/// them.
pub fn show_bar(ui: &mut Ui, open: Option<Tool>, are_keys_shown: bool, outbox: &mut Outbox) {
    let has_room = ui.max_rect().width() >= ROOM_FOR_TOOLS;
    let full = ("Full screen", "The picture alone; F11 or Esc brings the panels back");
    ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
        let keys = ui.selectable_label(are_keys_shown, " ? ").on_hover_text(words::MOUSE_AND_KEYS);
        if keys.accessible_name(words::KEYS).clicked() {
            outbox.act(Action::ToggleKeys);
        }
        if has_room {
            show_switch(ui, false, full, Action::ToggleFullScreen, outbox);
            ui.separator();
            for (tool, name, hint) in TOOLS.iter().rev() {
                show_switch(ui, open == Some(*tool), (name, hint), Action::ToggleTool(*tool), outbox);
            }
        } else {
            ui.menu_button(words::TOOLS, |ui| {
                let mut is_clicked = false;
                for (tool, name, hint) in &TOOLS {
                    is_clicked |= show_switch(ui, open == Some(*tool), (name, hint), Action::ToggleTool(*tool), outbox);
                }
                ui.separator();
                if show_switch(ui, false, full, Action::ToggleFullScreen, outbox) || is_clicked {
                    ui.close();
                }
            });
        }
    });
}

/// A switch with its name and hint; whether it was clicked.
fn show_switch(ui: &mut Ui, is_on: bool, (name, hint): (&str, &str), action: Action, outbox: &mut Outbox) -> bool {
    let is_clicked = ui.selectable_label(is_on, name).on_hover_text(hint).clicked();
    if is_clicked {
        outbox.act(action);
    }
    is_clicked
}
