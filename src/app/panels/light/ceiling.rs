//! A square light under the ceiling, for scenes that have none.

use egui::{DragValue, Ui};
use glam::Vec3;

use super::super::super::{Outbox, theme, words};
use super::exitance_slider;
use crate::worker::Command;

/// Exitance offered at first, W/m²: a bright office ceiling panel.
const FIRST_EXITANCE: f32 = 100.0;

/// The light that is about to be added.
pub(in super::super::super) struct CeilingEditor {
    size: f32,
    exitance: f32,
}

impl Default for CeilingEditor {
    fn default() -> Self {
        Self { size: 1.0, exitance: FIRST_EXITANCE }
    }
}

impl CeilingEditor {
    /// Offers a side length.
    pub(super) fn of_size(size: f32) -> Self {
        Self { size, ..Self::default() }
    }
}

/// Draws the part.
pub(super) fn show(ui: &mut Ui, editor: &mut CeilingEditor, outbox: &mut Outbox) {
    ui.label(theme::weak("Add a square light below the ceiling"));
    let speed = 0.01 * f64::from(editor.size);
    let side = DragValue::new(&mut editor.size).speed(speed).range(1e-6..=1e6).max_decimals(3);
    theme::row(ui, words::SIDE_LENGTH, |ui| ui.add(side)).on_hover_text("In the scene's length unit");
    theme::row(ui, words::CEILING_EXITANCE, |ui| exitance_slider(ui, &mut editor.exitance))
        .on_hover_text("Exitance B_e of the light");
    if ui.button(words::ADD_CEILING_LIGHT).clicked() {
        let exitance = Vec3::splat(editor.exitance);
        outbox.push(Command::AddCeilingLight { size: editor.size, exitance });
    }
}
