//! The reading under the pointer, in the view's upper left corner.

use egui::{Align2, Rect, RichText, Ui};

use crate::app::panels::picked;
use crate::app::state::measuring::{Measuring, lux_in_words};
use crate::app::view::View;
use crate::app::view::overlays::{Overlays, Place};
use crate::app::widgets::theme;
use crate::app::{Shown, format, words};
use crate::base::photometry::{ShownIn, weighted};

/// Draws it; nothing while the pointer is elsewhere.
pub fn show(ui: &Ui, rect: Rect, shown: &Shown, view: &mut View, measuring: &Measuring, has_card: bool) {
    let (Some(reading), Some(info)) = (measuring.under_pointer(), &shown.info) else { return };
    let (e, b) = (reading.irradiance.to_array(), reading.radiosity.to_array());
    let number = |value: f32| format::number(value.into());
    let material = info.scene.materials.get(reading.leaf.material.0 as usize).map_or("", |material| &material.name);
    let factor = match view.reading.last().map(|reading| reading.shown_in) {
        Some(shown_in @ ShownIn::DaylightFactor { .. }) => {
            format!("D {} %   ", number(shown_in.per_watt() * weighted(e)))
        }
        Some(ShownIn::Unit(_)) | None => String::new(),
    };
    let age = if measuring.is_stale() { format!("{}:  ", words::EARLIER_PICTURE) } else { String::new() };
    let text = format!(
        "{age}{factor}E {}, {} W/m²   B {} W/m²   {material}",
        lux_in_words(reading),
        number(weighted(e)),
        number(weighted(b)),
    );
    // The pointer is over the view, and stays there.
    let place = Place { is_interactable: false, ..Place::at_rim("readout", rect, Align2::LEFT_TOP) };
    let room = picked::room_beside(rect, has_card);
    view.overlays.note(ui, place, 0.85, [8, 4], |ui| {
        ui.set_max_width((room - 40.0).max(80.0));
        ui.add(egui::Label::new(RichText::new(text).monospace()).truncate());
    });
}

/// Says what a person might not know of what is in view.
pub fn show_notes(ui: &Ui, rect: Rect, view: &mut View, measuring: &Measuring, looks_through_walls: bool) {
    let is_stale = measuring.shows_points && measuring.plane_is_stale();
    for (name, text, applies) in [
        ("walk note", words::WALKING, view.viewport.walks),
        ("walls note", words::THROUGH_WALLS, looks_through_walls),
        ("age note", words::EARLIER_PLANE, is_stale),
    ] {
        if applies {
            show_note(&mut view.overlays, ui, rect, name, text);
        }
    }
}

/// A few words over the lower edge of the view.
fn show_note(overlays: &mut Overlays, ui: &Ui, view: Rect, name: &'static str, text: &str) {
    let at_rim = Place::at_rim(name, view, Align2::CENTER_BOTTOM);
    let place = Place { is_interactable: false, is_needed: false, ..at_rim };
    overlays.note(ui, place, 0.7, [8, 3], |ui| {
        ui.set_max_width((view.width() - 40.0).max(80.0));
        ui.add(egui::Label::new(theme::weak(text).small()).wrap_mode(egui::TextWrapMode::Extend));
    });
}
