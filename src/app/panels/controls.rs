//! The section that says what mouse and keys do in the view.

use egui::{Grid, Ui};

use crate::app::widgets::theme;

/// Gestures and their effects; [`crate::app::view::viewport`] acts so.
pub const CONTROLS: [(&str, &str); 11] = [
    ("left drag", "orbit"),
    ("right, middle or shift drag", "pan"),
    ("wheel or pinch", "zoom"),
    ("W A S D, Q E", "fly, down and up"),
    ("shift with these", "fly faster"),
    ("Camera: Walk at eye height", "W A S D walk"),
    ("click", "select the element"),
    ("double-click", "look at the point"),
    ("F", "frame all"),
    ("Home", "reset camera"),
    ("Ctrl+Z, Ctrl+Shift+Z", "undo, redo a setting"),
];

/// Draws the section.
pub fn show(ui: &mut Ui, are_keys_shown: &mut bool) {
    Grid::new("controls").num_columns(2).spacing([16.0, 3.0]).show(ui, |ui| {
        for (gesture, effect) in CONTROLS {
            ui.label(gesture);
            ui.label(theme::weak(effect));
            ui.end_row();
        }
    });
    if ui.button("All keys").on_hover_text("All keys, those that work anywhere among them (?)").clicked() {
        *are_keys_shown = true;
    }
}
