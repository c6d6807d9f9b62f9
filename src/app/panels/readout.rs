//! The reading under the pointer, in the view's upper left corner.

use egui::{Align2, Frame, Id, Rect, RichText, Ui};

use crate::app::widgets::theme;
use crate::app::{App, format};
use crate::base::photometry::{ShownIn, lux, weighted};

/// Draws it; nothing while the pointer is elsewhere.
pub(in crate::app) fn show(app: &App, ui: &Ui, view: Rect) {
    let (Some(reading), Some(info)) = (app.tools.measuring.under_pointer(), &app.shown.info) else { return };
    let (e, b) = (reading.irradiance.to_array(), reading.radiosity.to_array());
    let number = |value: f32| format::number(value.into());
    let material = info.scene.materials.get(reading.leaf.material.0 as usize).map_or("", |material| &material.name);
    let factor = match app.view.reading.last().map(|reading| reading.shown_in) {
        Some(shown_in @ ShownIn::DaylightFactor { .. }) => {
            format!("D {} %   ", number(shown_in.per_watt() * weighted(e)))
        }
        Some(ShownIn::Unit(_)) | None => String::new(),
    };
    let text = format!(
        "{factor}E {} lx, {} W/m²   B {} W/m²   {material}",
        number(lux(e)),
        number(weighted(e)),
        number(weighted(b)),
    );
    // The pointer is over the view, and stays there.
    let area = egui::Area::new(Id::unique("readout")).interactable(false);
    area.pivot(Align2::LEFT_TOP).fixed_pos(view.left_top() + egui::vec2(10.0, 10.0)).show(ui.ctx(), |ui| {
        theme::over_the_view(ui);
        let fill = theme::PANEL.gamma_multiply(0.85);
        Frame::new().fill(fill).corner_radius(4).inner_margin(egui::Margin::symmetric(8, 4)).show(ui, |ui| {
            ui.set_max_width((view.width() - 40.0).max(80.0));
            ui.add(egui::Label::new(RichText::new(text).monospace()).truncate());
        });
    });
}

/// A few words over the lower edge of the view.
pub(in crate::app) fn show_note(ui: &Ui, at: egui::Pos2, text: &str) {
    let area = egui::Area::new(Id::unique("view note")).interactable(false);
    area.pivot(Align2::CENTER_BOTTOM).fixed_pos(at).show(ui.ctx(), |ui| {
        theme::over_the_view(ui);
        let fill = theme::PANEL.gamma_multiply(0.7);
        Frame::new().fill(fill).corner_radius(4).inner_margin(egui::Margin::symmetric(8, 3)).show(ui, |ui| {
            ui.label(theme::weak(text).small());
        });
    });
}
