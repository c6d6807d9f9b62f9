//! The appearance section: theme and UI scale.

use egui::{ComboBox, ThemePreference, Ui};

use crate::app::appearance::Appearance;
use crate::app::widgets::rows;
use crate::app::words;

/// Scales offered, as factors.
const SCALES: [f32; 7] = [0.75, 0.9, 1.0, 1.25, 1.5, 2.0, 2.5];

/// Draws the section.
pub fn show(ui: &mut Ui, appearance: &mut Appearance) {
    rows::row(ui, "Theme", |ui| {
        let themes = ui.horizontal_wrapped(|ui| {
            for (theme, name) in [
                (ThemePreference::Dark, words::DARK_THEME),
                (ThemePreference::Light, words::LIGHT_THEME),
                (ThemePreference::System, "As the system"),
            ] {
                if ui.selectable_value(&mut appearance.theme, theme, name).changed() {
                    ui.ctx().set_theme(theme);
                }
            }
        });
        themes.response
    });
    rows::row(ui, words::UI_SCALE, |ui| {
        let percent = |scale: f32| format!("{:.0} %", 100.0 * scale);
        let present = ui.ctx().zoom_factor();
        let combo = ComboBox::from_id_salt("UI scale").selected_text(percent(present));
        let inner = combo.show_ui(ui, |ui| {
            for scale in SCALES {
                if ui.selectable_label(scale == present, percent(scale)).clicked() {
                    appearance.scale = Some(scale);
                    ui.ctx().set_zoom_factor(scale);
                }
            }
        });
        inner.response.on_hover_text("Also by keys: Ctrl with plus, minus and zero")
    });
}
