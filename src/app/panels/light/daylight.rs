//! The part of the light section for what lies outside: a sky and a sun, by presets, sliders and a dome on which the sun is dragged.

use egui::{Color32, Pos2, Rect, Sense, Slider, Stroke, Ui, Vec2};

use crate::app::widgets::theme;
use crate::app::{Outbox, format};
use crate::scene::outside::{Amount, CLEAR, Daylight, SkyKind, SkyTold, Spread, SunPlace, SunTold};
use crate::worker::Command;

/// Illuminances that sliders offer, lx.
const LUX: std::ops::RangeInclusive<f32> = 100.0..=150_000.0;
/// Side of the dome, points.
const DOME: f32 = 132.0;
/// The presets and what each brings.
const PRESETS: [(&str, Preset); 5] = [
    ("None", Preset { sky: None, sun: None }),
    ("Overcast", Preset { sky: Some((Spread::Overcast, 10_000.0)), sun: None }),
    ("Uniform", Preset { sky: Some((Spread::Uniform, 10_000.0)), sun: None }),
    ("Clear", Preset { sky: Some((Spread::Standard(CLEAR), 12_000.0)), sun: Some(80_000.0) }),
    ("Low sun", Preset { sky: Some((Spread::Standard(CLEAR), 8_000.0)), sun: Some(50_000.0) }),
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
    told: Daylight,
}

impl DaylightEditor {
    /// Takes over what a scene has.
    pub(in crate::app) fn follow(&mut self, told: Daylight) {
        self.told = told;
    }

    fn preset(&self, name: &str, preset: Preset) -> Daylight {
        let [azimuth, elevation] = match self.told.sun {
            Some(sun) if name != "Low sun" => sun.angles().map(|angle| angle as f32),
            _ if name == "Low sun" => [240.0, 15.0],
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
    ui.label(theme::weak("Daylight from outside"));
    let before = editor.told.clone();
    ui.horizontal_wrapped(|ui| {
        for (name, preset) in PRESETS {
            let wanted = editor.preset(name, preset);
            let spread = |told: &Daylight| told.sky.as_ref().map(|sky| sky.kind.clone());
            let is_chosen = spread(&wanted) == spread(&editor.told)
                && wanted.sun.is_some() == editor.told.sun.is_some()
                && name != "Low sun";
            if ui.selectable_label(is_chosen, name).clicked() {
                editor.told = wanted;
            }
        }
    });
    if let Some(sky) = &mut editor.told.sky {
        let mut lux = sky.amount.map_or(0.0, Amount::lux);
        if theme::row(ui, "Sky", |ui| lux_slider(ui, &mut lux))
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
        if theme::row(ui, "Sun", |ui| lux_slider(ui, &mut lux))
            .on_hover_text("Illuminance of a face turned to the sun")
            .changed()
        {
            sun.amount = Some(Amount::Lux(lux));
        }
        show_dome(ui, sun);
    }
    if editor.told != before {
        outbox.push(Command::SetDaylight(editor.told.clone()));
    }
}

/// The dome of the sky as seen from below would be mirrored; it is drawn as a plan: north up, east to the right, the zenith in its middle.
fn show_dome(ui: &mut Ui, sun: &mut SunTold) {
    let [azimuth, elevation] = sun.angles().map(|angle| angle as f32);
    ui.horizontal(|ui| {
        let (rect, response) = ui.allocate_exact_size(Vec2::splat(DOME), Sense::click_and_drag());
        let (centre, radius) = (rect.center(), 0.5 * DOME - 12.0);
        draw_dome(ui, rect, radius, place(centre, radius, azimuth, elevation));
        if let Some(pointer) = response.interact_pointer_pos() {
            let away = (pointer - centre) / radius;
            let azimuth = away.x.atan2(-away.y).to_degrees().rem_euclid(360.0).round();
            let elevation = (90.0 * (1.0 - away.length())).clamp(1.0, 90.0).round();
            sun.place = SunPlace::Direction { azimuth, elevation };
        }
        response.on_hover_text("Plan of the sky: drag the sun; north is −z of the scene, or y where z points up");
        ui.vertical(|ui| {
            ui.label(theme::value(format!("{}° from north", format::number(f64::from(azimuth.round())))));
            ui.label(theme::value(format!("{}° high", format::number(f64::from(elevation.round())))));
        });
    });
}

/// Where the sun is drawn.
fn place(centre: Pos2, radius: f32, azimuth: f32, elevation: f32) -> Pos2 {
    let (sine, cosine) = azimuth.to_radians().sin_cos();
    centre + radius * (1.0 - elevation.clamp(0.0, 90.0) / 90.0) * Vec2::new(sine, -cosine)
}

fn draw_dome(ui: &Ui, rect: Rect, radius: f32, sun: Pos2) {
    let (painter, line) = (ui.painter(), Stroke::new(1.0, ui.visuals().weak_text_color()));
    let centre = rect.center();
    painter.circle(centre, radius, ui.visuals().extreme_bg_color, line);
    for share in [1.0 / 3.0, 2.0 / 3.0] {
        painter.circle_stroke(centre, share * radius, Stroke::new(0.5, ui.visuals().weak_text_color()));
    }
    let font = egui::TextStyle::Small.resolve(ui.style());
    for (letter, side) in [("N", Vec2::UP), ("E", Vec2::RIGHT), ("S", Vec2::DOWN), ("W", Vec2::LEFT)] {
        let colour = ui.visuals().weak_text_color();
        painter.text(centre + (radius + 7.0) * side, egui::Align2::CENTER_CENTER, letter, font.clone(), colour);
    }
    painter.circle(sun, 6.0, Color32::from_rgb(255, 200, 60), Stroke::new(1.0, Color32::from_rgb(120, 80, 0)));
}

fn lux_slider(ui: &mut Ui, lux: &mut f32) -> egui::Response {
    let slider = Slider::new(lux, LUX).clamping(egui::SliderClamping::Edits).logarithmic(true).suffix(" lx");
    ui.add(slider.max_decimals(0).custom_formatter(|value, _| format::grouped(value)))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Truth: the plan's convention: the zenith in the middle, north up, east to the right, the horizon at the rim.
    #[test]
    fn the_sun_is_drawn_where_it_stands() {
        let at = |azimuth, elevation| place(Pos2::ZERO, 90.0, azimuth, elevation);
        assert!(at(10.0, 90.0).distance(Pos2::ZERO) < 1e-4);
        assert!(at(0.0, 0.0).distance(Pos2::new(0.0, -90.0)) < 1e-3);
        assert!(at(90.0, 45.0).distance(Pos2::new(45.0, 0.0)) < 1e-3);
    }

    /// A preset keeps where the sun stands, and every preset is daylight that can be used.
    #[test]
    fn presets_keep_the_sun_in_its_place() {
        let told = Daylight { sky: None, sun: Some(SunTold::at(123.0, 21.0, None)) };
        let editor = DaylightEditor { told };
        for (name, preset) in PRESETS {
            let made = editor.preset(name, preset);
            if let Some(sun) = made.sun.filter(|_| name == "Clear") {
                assert_eq!(sun.angles(), [123.0, 21.0]);
            }
            assert!(
                crate::scene::outside::Outside::new(&made, glam::Vec3::Y, |_| Err(String::new())).is_ok(),
                "{name}"
            );
        }
    }
}
