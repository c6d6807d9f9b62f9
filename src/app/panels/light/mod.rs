//! The light section: every lamp with a switch and a dimmer, the material at hand, daylight, and
//! luminaires that are added.

mod daylight;
mod lamps;
mod luminaires;
mod material;
mod sun_place;

use egui::{Align2, Rect, Slider, Ui};

use crate::app::actions::{Action, Outbox};
use crate::app::state::lighting::{Lighting, LuminaireLight};
use crate::app::view::View;
use crate::app::view::overlays::Place;
use crate::app::widgets::{rows, theme};
use crate::app::{Shown, format, words};
use crate::scene::{Luminaire, LuminaireShape, MaterialId, Reading, Scene};
use crate::solve::{Epsilon, SolverParams};
use crate::worker::Command;
use daylight::DaylightEditor;

/// A luminous flux in words: to whole lumens where these are many.
fn lumens(lumens: f32) -> String {
    let lumens = f64::from(lumens);
    format!("{} lm", format::grouped(if lumens < 100.0 { lumens } else { lumens.round() }))
}

/// Exitances a slider offers, W/m².
const EXITANCES: std::ops::RangeInclusive<f32> = 0.1..=1e5;
/// A power that differs by less than this share counts as the same.
const SAME_POWER: f64 = 1e-4;

/// Changes that a person is making in the section.
#[derive(Default)]
pub struct LightEditor {
    /// Of each material, what was set.
    pub lighting: Lighting,
    /// The material at hand.
    material: MaterialId,
    /// Area of the faces of each material, m².
    areas: Vec<f32>,
    /// The luminaire at hand.
    pub selected: Option<usize>,
    /// Whether nothing lit the scene when it was opened.
    pub was_dark: bool,
    /// A place that was asked for: the view turns there.
    pub to_be_seen: Option<glam::Vec3>,
    /// Luminaires that the worker knows of.
    sent: Vec<Luminaire>,
    /// Sky and sun, as they were set.
    pub daylight: DaylightEditor,
    /// A material, and whether its faces are kept or left out.
    faces: Option<(String, Faces)>,
    /// In which unit a lamp's strength is shown.
    unit: LampUnit,
}

/// Treatment of the faces of a material when its file is read again.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Faces {
    /// Transparent ones stop light.
    Opaque,
    /// They are left out.
    LeftOut,
    /// They are there again.
    Back,
}

/// Units of a lamp's strength.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum LampUnit {
    /// Luminous flux of all faces, lm.
    #[default]
    Lumens,
    /// Power of all faces, sum of the channels, W.
    Watts,
    /// Exitance of the strongest channel, W/m².
    Exitance,
}

impl LampUnit {
    const ALL: [Self; 3] = [Self::Lumens, Self::Watts, Self::Exitance];

    /// Label of the slider, sign of the unit, and what is shown.
    fn words(self) -> (&'static str, &'static str, &'static str) {
        match self {
            Self::Lumens => (words::FLUX, "lm", "Luminous flux of all of its faces, at 100 % of the dimmer"),
            Self::Watts => {
                (words::POWER, "W", "Power of all of its faces, sum of the channels, at 100 % of the dimmer")
            }
            Self::Exitance => {
                (words::EXITANCE, "W/m²", "Exitance B_e of the strongest channel, at 100 % of the dimmer")
            }
        }
    }

    /// How much of the unit an exitance of 1 W/m² in the strongest channel is, for this tint and
    /// area (m²).
    fn per_exitance(self, tint: glam::Vec3, area: f32) -> f32 {
        match self {
            Self::Exitance => 1.0,
            Self::Watts => area * tint.element_sum(),
            Self::Lumens => area * crate::base::photometry::lux(tint.to_array()),
        }
    }
}

impl LightEditor {
    /// For a scene that was just opened; its first lamp, if it has one, is the material at hand.
    pub fn for_scene(scene: &Scene) -> Self {
        let lighting = Lighting::of_scene(scene);
        let lamp = lighting.lamps().next();
        let material = MaterialId(lamp.unwrap_or(0) as u32);
        let was_dark = !scene.has_light();
        let mut editor = Self { lighting, material, was_dark, sent: scene.luminaires(), ..Self::default() };
        editor.follow(scene);
        editor
    }

    /// Takes up what an edited scene has more.
    pub fn follow(&mut self, scene: &Scene) {
        self.daylight.follow(scene.daylight());
        self.areas = vec![0.0; scene.materials.len()];
        for polygon in &scene.polygons {
            self.areas[polygon.material.0 as usize] += scene.area(polygon);
        }
    }

    /// The luminaires are those of the scene again: what was wanted cannot be had.
    pub fn take_back_luminaires(&mut self, scene: &Scene) {
        let present = scene.luminaires();
        if present != self.sent {
            self.lighting.luminaires = Lighting::of_scene(scene).luminaires;
            self.sent = present;
        }
    }

    /// Command by which the worker learns of changed luminaires. While a person moves one, only
    /// what is live goes out: another exitance.
    pub fn luminaires_command(&mut self, is_busy: bool) -> Option<Command> {
        let mut wanted = self.lighting.wanted_luminaires();
        if is_busy {
            if wanted.len() != self.sent.len() {
                return None;
            }
            for (wanted, sent) in wanted.iter_mut().zip(&self.sent) {
                (wanted.form, wanted.name) = (sent.form, sent.name.clone());
            }
        }
        if wanted == self.sent {
            return None;
        }
        self.sent.clone_from(&wanted);
        Some(Command::SetLuminaires(wanted))
    }

    /// How the scene in view is to be read again, where somebody asked for faces or against them
    /// since the last time.
    fn take_reading(&mut self, present: &Reading) -> Option<Reading> {
        let (name, faces) = self.faces.take()?;
        let mut reading = present.clone();
        reading.ignored.retain(|ignored| *ignored != name);
        match faces {
            Faces::Opaque => reading.opaque.push(name),
            Faces::LeftOut => reading.ignored.push(name),
            Faces::Back => {}
        }
        Some(reading)
    }

    /// Takes a material of the scene in view in hand, or the luminaire that it is of.
    pub fn choose(&mut self, scene: &Scene, material: MaterialId) {
        if scene.luminaire_of(material).is_none() {
            self.material = material;
        } else if let Some(of) = scene.materials.get(material.0 as usize) {
            self.selected = self.lighting.luminaires.iter().position(|luminaire| luminaire.name == of.name);
        }
    }

    /// The luminaire at hand.
    pub fn selected_mut(&mut self) -> Option<&mut LuminaireLight> {
        self.lighting.luminaires.get_mut(self.selected?)
    }
}

/// Draws the section.
pub fn show(
    ui: &mut Ui,
    (shown, eye): (&Shown, Option<glam::Vec3>),
    params: &SolverParams,
    editor: &mut LightEditor,
    outbox: &mut Outbox,
) {
    let Some(info) = &shown.info else { return };
    if !info.has_light {
        let sentence = match info.is_open {
            true => {
                "Nothing in this scene emits light, so that there is nothing to solve: let daylight in, make a material a light, or add a luminaire."
            }
            false => {
                "Nothing in this scene emits light, so that there is nothing to solve: make a material a light, or add a luminaire."
            }
        };
        rows::sentence(ui, egui::RichText::new(sentence).color(theme::ACCENT));
        if info.is_open && ui.button(words::LET_DAYLIGHT_IN).clicked() {
            outbox.push(Command::SetDaylight(daylight::usual()));
        }
        ui.add_space(2.0);
    }
    let before = editor.lighting.clone();
    lamps::show(ui, &info.scene, editor);
    material::show(ui, info, editor);
    outbox.extend(editor.lighting.commands_since(&before));
    show_anchor(ui, shown, params, outbox);
    ui.add_space(6.0);
    daylight::show(ui, &mut editor.daylight, outbox);
    ui.add_space(6.0);
    luminaires::show(ui, info, eye, editor);
    let to_be_seen = editor.to_be_seen.take().map(Action::TurnTowards);
    let reading = editor.take_reading(&info.scene.reading).map(Action::Read);
    to_be_seen.into_iter().chain(reading).for_each(|action| outbox.act(action));
}

/// Over a view that nothing lights: a sentence that says so, and two ways to some light.
pub fn show_ways_to_light(
    ui: &Ui,
    rect: Rect,
    shown: &Shown,
    view: &mut View,
    light: &mut LightEditor,
    outbox: &mut Outbox,
) {
    let Some(info) = &shown.info else { return };
    let sentence = if info.has_light { words::NO_LIGHT_HERE } else { words::NO_LIGHT_YET };
    let eye = view.viewport.pose().map(|pose| pose.eye);
    let mut place = Place::at_rim("ways to light", rect, Align2::CENTER_TOP);
    // The readout comes and goes above it.
    place.at.y += 34.0;
    view.overlays.card(ui, place, 10, |ui| {
        ui.set_max_width((rect.width() - 60.0).clamp(160.0, 420.0));
        rows::sentence(ui, sentence);
        ui.horizontal_wrapped(|ui| {
            let can_let_daylight_in = info.is_open && info.scene.outside().is_none();
            if can_let_daylight_in && ui.button("Light it by daylight").clicked() {
                outbox.push(Command::SetDaylight(daylight::usual()));
            }
            if ui.button(words::HANG_UP_A_LAMP).clicked() {
                let before = light.lighting.clone();
                luminaires::add(info, eye, LuminaireShape::Square, light);
                // The room is to be seen by it: the view stays.
                light.to_be_seen = None;
                outbox.extend(light.lighting.commands_since(&before));
            }
        });
    });
}

/// Says by which power ε was set, and offers to set it anew where that has changed: ε stays in
/// watts when a lamp is dimmed.
///
/// The row is there whether or not it has, so that nothing below it jumps while somebody drags a
/// slider.
fn show_anchor(ui: &mut Ui, shown: &Shown, params: &SolverParams, outbox: &mut Outbox) {
    let Some(stats) = shown.stats().filter(|stats| stats.power_watts > 0.0) else { return };
    let is_relative = matches!(params.threshold(), Epsilon::Relative(_));
    let has_moved = (stats.power_watts - stats.anchor_watts).abs() > SAME_POWER * stats.anchor_watts;
    let [then, now] = [stats.anchor_watts, stats.power_watts].map(|power| format::quantity(power, "W"));
    let text = match (is_relative, has_moved) {
        (false, _) => format!("Φ = {now} (strongest channel); ε was set in watts"),
        (true, false) => format!("Φ = {now} (strongest channel), as when ε was set"),
        (true, true) => format!("Φ = {now} (strongest channel); ε was set at {then}"),
    };
    let hint = "ε stays in watts when lamps change; this sets it to the same share of the power Φ that they emit now, in the strongest channel, which ε bounds";
    rows::sentence(ui, theme::weak(text)).on_hover_text(hint);
    let button = ui.add_enabled(is_relative && has_moved, egui::Button::new(words::RESCALE_EPSILON));
    if button.on_hover_text(hint).on_disabled_hover_text(hint).clicked() {
        outbox.push(Command::AnchorEpsilon);
    }
}

/// A slider of a strength in a unit, of which so much is 1 W/m².
fn strength_slider(ui: &mut Ui, strength: &mut f32, per_exitance: f32, sign: &str) -> egui::Response {
    let range = EXITANCES.start() * per_exitance..=EXITANCES.end() * per_exitance;
    // What a file says beyond the slider's range stays until a person moves it.
    let slider = Slider::new(strength, range).clamping(egui::SliderClamping::Edits);
    let slider = slider.logarithmic(true).suffix(format!(" {sign}")).max_decimals(1);
    let slider = slider.custom_formatter(|value, _| format::grouped(if value < 100.0 { value } else { value.round() }));
    ui.add(slider.custom_parser(|text| text.replace(',', "").trim().parse().ok()))
}
