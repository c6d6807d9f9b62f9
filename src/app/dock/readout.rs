//! The reading under the pointer, in the bar above the view.

use egui::{Label, RichText, Ui};

use super::super::{App, format};
use crate::photometry::{CONVENTION, lux, weighted};

/// Draws it; nothing while the pointer is elsewhere.
pub(super) fn show(app: &App, ui: &mut Ui) {
    let (Some(reading), Some(info)) = (app.measuring.under_pointer(), &app.shown.info) else { return };
    let (e, b) = (reading.irradiance.to_array(), reading.radiosity.to_array());
    let number = |value: f32| format::number(value.into());
    let material = info.scene.materials.get(reading.leaf.material.0 as usize).map_or("", |material| &material.name);
    let text =
        format!("E {} lx, {} W/m²   B {} W/m²   {material}", number(lux(e)), number(weighted(e)), number(weighted(b)),);
    let by_colour = |rgb: [f32; 3]| rgb.map(|value| format::number(value.into())).join(" ");
    let details = format!(
        "Under the pointer: irradiance E {} and radiosity B {} W/m² (R G B). {CONVENTION}; the W/m² shown are their means by the same weights.",
        by_colour(e),
        by_colour(b)
    );
    ui.add(Label::new(RichText::new(text).monospace()).truncate()).on_hover_text(details);
}
