//! The part of the light section for what lies outside: a sky and a sun, by presets and sliders;
//! where the sun stands next door.

use egui::{ComboBox, Slider, TextEdit, Ui};

use super::sun_place;
use crate::app::widgets::{rows, theme};
use crate::app::{Outbox, format, words};
use crate::scene::outside::{Amount, CLEAR, Daylight, LuminanceDistribution, SkyKind, SkySpec, SunSpec};
use crate::worker::Command;

/// Illuminances that sliders offer, lx.
const LUX: std::ops::RangeInclusive<f32> = 100.0..=150_000.0;
/// The presets and what each brings.
const PRESETS: [(&str, Preset); 5] = [
    (words::NO_DAYLIGHT, Preset { sky: None, sun: None }),
    (words::OVERCAST_SKY, Preset { sky: Some((LuminanceDistribution::Overcast, 10_000.0)), sun: None }),
    (words::UNIFORM_SKY, Preset { sky: Some((LuminanceDistribution::Uniform, 10_000.0)), sun: None }),
    (words::CLEAR_SKY, Preset { sky: Some((LuminanceDistribution::Standard(CLEAR), 12_000.0)), sun: Some(80_000.0) }),
    (words::LOW_SUN, Preset { sky: Some((LuminanceDistribution::Standard(CLEAR), 8_000.0)), sun: Some(50_000.0) }),
];

/// The 15 standard skies of CIE S 011, in their order.
const STANDARD_SKIES: [&str; 15] = [
    "Overcast, steep",
    "Overcast, steep, bright sun side",
    "Overcast, moderate",
    "Overcast, moderate, bright sun side",
    "Even clouds",
    "Cloudy, bright sun side",
    "Cloudy, brighter about the sun",
    "Cloudy, distinct corona",
    "Cloudy, sun behind clouds",
    "Broken clouds, bright about the sun",
    "White-blue, distinct corona",
    "Clear",
    "Clear, polluted",
    "Turbid, broad corona",
    "White-blue turbid, broad corona",
];

/// A sky with its horizontal illuminance and a sun with its own, lx.
#[derive(Clone, Copy)]
struct Preset {
    sky: Option<(LuminanceDistribution, f32)>,
    sun: Option<f32>,
}

/// Daylight that is being set.
#[derive(Clone, Debug, Default)]
pub struct DaylightEditor {
    /// Sky and sun as they were set.
    pub spec: Daylight,
    /// The sky as it is being written.
    text: String,
    /// Why what was written is no sky.
    problem: Option<String>,
}

impl DaylightEditor {
    /// Takes over what a scene has.
    pub fn follow(&mut self, spec: Daylight) {
        self.text = spec.sky.as_ref().map(ToString::to_string).unwrap_or_default();
        (self.spec, self.problem) = (spec, None);
    }

    /// Spreads the sky's light in another way; one that needs a sun gets one.
    fn set_distribution(&mut self, distribution: LuminanceDistribution) {
        let amount = self.spec.sky.as_ref().and_then(|sky| sky.amount).unwrap_or(Amount::Lux(10_000.0));
        self.set_sky(SkySpec::of(distribution, amount));
    }

    fn set_sky(&mut self, sky: SkySpec) {
        if matches!(sky.kind, SkyKind::Formula(distribution) if distribution.needs_sun()) {
            self.spec.sun.get_or_insert(SunSpec::at(200.0, 45.0, None));
        }
        self.spec.sky = Some(sky);
    }

    /// Takes over the sky that was written.
    fn read_text(&mut self) {
        match self.text.trim().parse() {
            Ok(sky) => {
                self.problem = None;
                self.set_sky(sky);
            }
            Err(problem) => self.problem = Some(problem.to_string()),
        }
    }

    fn preset(&self, name: &str, preset: Preset) -> Daylight {
        let [azimuth, elevation] = match self.spec.sun {
            Some(sun) if name != words::LOW_SUN => sun.angles().map(|angle| angle as f32),
            _ if name == words::LOW_SUN => [240.0, 15.0],
            _ => [200.0, 45.0],
        };
        let sky = preset.sky.map(|(distribution, lux)| SkySpec::of(distribution, Amount::Lux(lux)));
        Daylight { sky, sun: preset.sun.map(|lux| SunSpec::at(azimuth, elevation, Some(Amount::Lux(lux)))) }
    }
}

/// Overcast daylight, as is offered to a scene that has openings and no lamp.
pub fn usual() -> Daylight {
    Daylight { sky: Some(SkySpec::of(LuminanceDistribution::Overcast, Amount::Lux(10_000.0))), sun: None }
}

/// Draws the part.
pub fn show(ui: &mut Ui, editor: &mut DaylightEditor, outbox: &mut Outbox) {
    ui.label(theme::weak("Daylight from outside"));
    let before = editor.spec.clone();
    ui.horizontal_wrapped(|ui| {
        for (name, preset) in PRESETS {
            let wanted = editor.preset(name, preset);
            let distribution = |spec: &Daylight| spec.sky.as_ref().map(|sky| sky.kind.clone());
            let is_chosen = distribution(&wanted) == distribution(&editor.spec)
                && wanted.sun.is_some() == editor.spec.sun.is_some()
                && name != words::LOW_SUN;
            if ui.selectable_label(is_chosen, name).clicked() {
                editor.spec = wanted;
            }
        }
    });
    if let Some(sky) = &mut editor.spec.sky {
        let mut lux = sky.amount.map_or(0.0, Amount::lux);
        if rows::row(ui, words::SKY_ILLUMINANCE, |ui| lux_slider(ui, &mut lux))
            .on_hover_text("Horizontal illuminance of open ground, without the sun")
            .changed()
        {
            sky.amount = Some(Amount::Lux(lux));
        }
    }
    show_sky_kind(ui, editor);
    if let Some(sun) = &mut editor.spec.sun {
        let mut lux = crate::base::photometry::lux(sun.irradiance().into());
        if rows::row(ui, "Sun", |ui| lux_slider(ui, &mut lux))
            .on_hover_text("Illuminance of a face turned to the sun")
            .changed()
        {
            sun.amount = Some(Amount::Lux(lux));
        }
        sun_place::show(ui, sun);
    }
    if editor.spec != before {
        outbox.push(Command::SetDaylight(editor.spec.clone()));
    }
}

/// The distribution of light over the sky: by a list, and by the words of the command line for what
/// is not in it.
fn show_sky_kind(ui: &mut Ui, editor: &mut DaylightEditor) {
    let Some(sky) = &editor.spec.sky else { return };
    let name = |distribution: LuminanceDistribution| match distribution {
        LuminanceDistribution::Uniform => words::UNIFORM_SKY.to_owned(),
        LuminanceDistribution::Overcast => words::OVERCAST_SKY.to_owned(),
        LuminanceDistribution::Standard(number) => format!("{number}: {}", STANDARD_SKIES[usize::from(number) - 1]),
        LuminanceDistribution::General(_) => "By coefficients".to_owned(),
        LuminanceDistribution::Weather { .. } => "By the weather".to_owned(),
    };
    let (present, shown) = match sky.kind {
        SkyKind::Formula(distribution) => (Some(distribution), name(distribution)),
        SkyKind::Picture(_) => (None, "Picture".to_owned()),
    };
    let mut chosen = None;
    rows::row(ui, words::SKY_TYPE, |ui| {
        let list = ComboBox::from_id_salt(words::SKY_TYPE).selected_text(shown).truncate();
        let answer = list.show_ui(ui, |ui| {
            for distribution in [LuminanceDistribution::Uniform, LuminanceDistribution::Overcast]
                .into_iter()
                .chain((1..=15).map(LuminanceDistribution::Standard))
            {
                if ui.selectable_label(present == Some(distribution), name(distribution)).clicked() {
                    chosen = Some(distribution);
                }
            }
        });
        answer.response.on_hover_text("How bright the sky is where (CIE S 011)")
    });
    if let Some(distribution) = chosen {
        editor.set_distribution(distribution);
    }
    let written = rows::row(ui, "Sky as text", |ui| {
        let hint = "As on the command line: cie=A/B/C/D/E (coefficients), perez=DIRECT/DIFFUSE (weather, W/m²), or the path of a picture all around; :10000lx or :50W may follow";
        ui.add(TextEdit::singleline(&mut editor.text).desired_width(f32::INFINITY)).on_hover_text(hint)
    });
    if written.lost_focus() && ui.input(|input| input.key_pressed(egui::Key::Enter)) {
        editor.read_text();
    }
    if let Some(problem) = &editor.problem {
        ui.label(theme::weak(problem.clone()));
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
        let spec = Daylight { sky: None, sun: Some(SunSpec::at(123.0, 21.0, None)) };
        let editor = DaylightEditor { spec, ..DaylightEditor::default() };
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

    /// A sky that is brightest about the sun gets one; what is no sky changes nothing and is
    /// reported.
    #[test]
    fn skies_are_taken_from_their_words() {
        let mut editor = DaylightEditor::default();
        for (text, has_sun) in [("overcast:5000lx", false), ("perez=600/120", true), ("cie=4/-0.7/0/-1/0:8000lx", true)]
        {
            editor.text = text.to_owned();
            editor.read_text();
            assert!(editor.problem.is_none() && editor.spec.sun.is_some() == has_sun, "{text}: {editor:?}");
        }
        editor.set_distribution(LuminanceDistribution::Standard(3));
        let before = editor.spec.clone();
        assert_eq!(before.sky.as_ref().map(ToString::to_string).as_deref(), Some("cie3:8000lx"));
        editor.text = "cloudy".to_owned();
        editor.read_text();
        assert!(editor.problem.as_ref().is_some_and(|problem| problem.contains("cloudy")));
        assert_eq!(editor.spec, before);
    }
}
