//! The part of the light section for what lies outside: a sky and a sun, by presets and sliders; where the sun stands next door.

use egui::{Slider, Ui};

use super::sun_place;
use crate::app::widgets::theme;
use crate::app::{Outbox, format, words};
use crate::scene::outside::{Amount, CLEAR, Daylight, SkyKind, SkyTold, Spread, SunTold};
use crate::worker::Command;

/// Illuminances that sliders offer, lx.
const LUX: std::ops::RangeInclusive<f32> = 100.0..=150_000.0;
/// The presets and what each brings.
const PRESETS: [(&str, Preset); 5] = [
    (words::NO_DAYLIGHT, Preset { sky: None, sun: None }),
    (words::OVERCAST_SKY, Preset { sky: Some((Spread::Overcast, 10_000.0)), sun: None }),
    (words::UNIFORM_SKY, Preset { sky: Some((Spread::Uniform, 10_000.0)), sun: None }),
    (words::CLEAR_SKY, Preset { sky: Some((Spread::Standard(CLEAR), 12_000.0)), sun: Some(80_000.0) }),
    (words::LOW_SUN, Preset { sky: Some((Spread::Standard(CLEAR), 8_000.0)), sun: Some(50_000.0) }),
];

/// A sky with its horizontal illuminance and a sun with its own, lx.
#[derive(Clone, Copy)]
struct Preset {
    sky: Option<(Spread, f32)>,
    sun: Option<f32>,
}

/// Daylight that is being set.
#[derive(Clone, Debug, Default)]
pub(in crate::app) struct DaylightEditor {
    /// What was set.
    pub told: Daylight,
}

impl DaylightEditor {
    /// Takes over what a scene has.
    pub(in crate::app) fn follow(&mut self, told: Daylight) {
        self.told = told;
    }

    fn preset(&self, name: &str, preset: Preset) -> Daylight {
        let [azimuth, elevation] = match self.told.sun {
            Some(sun) if name != words::LOW_SUN => sun.angles().map(|angle| angle as f32),
            _ if name == words::LOW_SUN => [240.0, 15.0],
            _ => [200.0, 45.0],
        };
        let sky = preset.sky.map(|(spread, lux)| SkyTold::of(spread, Amount::Lux(lux)));
        Daylight { sky, sun: preset.sun.map(|lux| SunTold::at(azimuth, elevation, Some(Amount::Lux(lux)))) }
    }
}

/// Overcast daylight, as is offered to a scene that has openings and no lamp.
pub(in crate::app) fn usual() -> Daylight {
    Daylight { sky: Some(SkyTold::of(Spread::Overcast, Amount::Lux(10_000.0))), sun: None }
}

/// Draws the part.
pub(in crate::app) fn show(ui: &mut Ui, editor: &mut DaylightEditor, outbox: &mut Outbox) {
    ui.label(theme::weak(words::DAYLIGHT));
    let before = editor.told.clone();
    ui.horizontal_wrapped(|ui| {
        for (name, preset) in PRESETS {
            let wanted = editor.preset(name, preset);
            let spread = |told: &Daylight| told.sky.as_ref().map(|sky| sky.kind.clone());
            let is_chosen = spread(&wanted) == spread(&editor.told)
                && wanted.sun.is_some() == editor.told.sun.is_some()
                && name != words::LOW_SUN;
            if ui.selectable_label(is_chosen, name).clicked() {
                editor.told = wanted;
            }
        }
    });
    if let Some(sky) = &mut editor.told.sky {
        let mut lux = sky.amount.map_or(0.0, Amount::lux);
        if theme::row(ui, words::SKY_ILLUMINANCE, |ui| lux_slider(ui, &mut lux))
            .on_hover_text("Horizontal illuminance of open ground, without the sun")
            .changed()
        {
            sky.amount = Some(Amount::Lux(lux));
        }
        if let SkyKind::Picture(name) = &sky.kind {
            ui.add(egui::Label::new(theme::weak(name.clone())).truncate());
        }
    }
    if let Some(sun) = &mut editor.told.sun {
        let mut lux = crate::base::photometry::lux(sun.irradiance().into());
        if theme::row(ui, words::SUN_ILLUMINANCE, |ui| lux_slider(ui, &mut lux))
            .on_hover_text("Illuminance of a face turned to the sun")
            .changed()
        {
            sun.amount = Some(Amount::Lux(lux));
        }
        sun_place::show(ui, sun);
    }
    if editor.told != before {
        outbox.push(Command::SetDaylight(editor.told.clone()));
    }
}

fn lux_slider(ui: &mut Ui, lux: &mut f32) -> egui::Response {
    let slider = Slider::new(lux, LUX).clamping(egui::SliderClamping::Edits).logarithmic(true).suffix(" lx");
    ui.add(slider.max_decimals(0).custom_formatter(|value, _| format::grouped(value)))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A preset keeps where the sun stands, and every preset is daylight that can be used.
    #[test]
    fn presets_keep_the_sun_in_its_place() {
        let told = Daylight { sky: None, sun: Some(SunTold::at(123.0, 21.0, None)) };
        let editor = DaylightEditor { told };
        for (name, preset) in PRESETS {
            let made = editor.preset(name, preset);
            if let Some(sun) = made.sun.filter(|_| name == words::CLEAR_SKY) {
                assert_eq!(sun.angles(), [123.0, 21.0]);
            }
            assert!(
                crate::scene::outside::Outside::new(&made, glam::Vec3::Y, |_| Err(String::new())).is_ok(),
                "{name}"
            );
        }
    }
}
