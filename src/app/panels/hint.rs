//! Hints over the view: the three lines of the first start, and the way back from the full picture.

use egui::{Align2, Area, Rect, Ui};

use crate::app::actions::{Action, Outbox};
use crate::app::view::overlays::{Overlays, Place};
use crate::app::widgets::theme;
use crate::app::words;

const LINES: [&str; 3] = [
    "Drag to turn the view, roll the wheel to come nearer, fly with W A S D.",
    "Click a surface to read its light; the tools above the view look further inside.",
    "Choose a quality at the left and watch the light refine. Press ? for all keys.",
];

/// Draws the lines until somebody has read them.
pub fn show_first_lines(ui: &Ui, view: Rect, overlays: &mut Overlays, is_shown: &mut bool) {
    if !*is_shown {
        return;
    }
    let place = Place::at_rim("first lines", view, Align2::CENTER_BOTTOM);
    overlays.card(ui, place, 12, |ui| {
        ui.set_max_width((view.width() - 60.0).max(200.0));
        for line in LINES {
            ui.label(egui::RichText::new(line).strong());
        }
        ui.add_space(4.0);
        if ui.button("Got it").clicked() {
            *is_shown = false;
        }
    });
}

/// So near to the upper edge of the full screen the pointer calls the way back, points.
const NEAR_TOP: f32 = 60.0;

/// A button in the corner of the full screen, where the pointer comes near to it; otherwise the
/// picture is alone.
pub fn show_way_back(ui: &Ui, view: Rect, outbox: &mut Outbox) {
    let is_near = ui.input(|input| input.pointer.hover_pos().is_some_and(|at| at.y < view.top() + NEAR_TOP));
    if !is_near {
        return;
    }
    let at = view.left_top() + egui::vec2(10.0, 10.0);
    Area::new(egui::Id::unique("way back")).fixed_pos(at).show(ui.ctx(), |ui| {
        theme::over_the_view(ui);
        if ui.button(words::SHOW_PANELS).on_hover_text("F11 or Esc does so too").clicked() {
            outbox.act(Action::ToggleFullScreen);
        }
    });
}
