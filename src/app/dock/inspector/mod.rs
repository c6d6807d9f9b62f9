//! The inspector: the picked element's place in the hierarchy, what it is, and all its links.

use egui::Ui;

use super::super::{App, theme};

/// Draws it.
pub(super) fn show(app: &mut App, ui: &mut Ui) {
    if app.picked.is_none() {
        ui.add_space(12.0);
        ui.label(theme::weak("Click a surface in the view to see what lights it and what it lights."));
    }
}
