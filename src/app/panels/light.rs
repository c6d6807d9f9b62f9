//! The light section: make a material emit, or add a light under the ceiling.

use egui::{ComboBox, DragValue, Slider, Ui};
use glam::Vec3;

use super::super::{Outbox, format, theme};
use crate::ceiling;
use crate::scene::{MaterialId, Scene};
use crate::worker::{Command, SceneInfo};

/// Exitance offered at first, W/m²: a bright office ceiling panel.
const FIRST_EXITANCE: f32 = 100.0;
/// Exitances a slider offers, W/m².
const EXITANCES: std::ops::RangeInclusive<f32> = 0.1..=1e5;

/// What is about to be given to the scene.
pub(in super::super) struct LampEditor {
    material: MaterialId,
    colour: [f32; 3],
    exitance: f32,
    size: f32,
    ceiling_exitance: f32,
}

impl Default for LampEditor {
    fn default() -> Self {
        Self {
            material: MaterialId(0),
            colour: [1.0; 3],
            exitance: FIRST_EXITANCE,
            size: 1.0,
            ceiling_exitance: FIRST_EXITANCE,
        }
    }
}

impl LampEditor {
    /// Sizes that suit a scene; its first lamp, if it has one, is the material shown.
    pub(in super::super) fn for_scene(scene: &Scene) -> Self {
        let emits = |material: &crate::scene::Material| material.emission.max_element() > 0.0;
        let lamp = scene.materials.iter().position(emits).unwrap_or(0);
        let mut editor = Self { size: ceiling::suggested_size(scene), ..Self::default() };
        editor.choose(scene, MaterialId(lamp as u32));
        editor
    }

    /// What the material is to emit: exitance B_e per colour, W/m².
    fn emission(&self) -> Vec3 {
        self.exitance * Vec3::from(self.colour)
    }

    /// Shows a material: its emission if it has one, otherwise what was set last.
    pub(in super::super) fn choose(&mut self, scene: &Scene, material: MaterialId) {
        self.material = material;
        let Some(emission) = scene.materials.get(material.0 as usize).map(|material| material.emission) else { return };
        let strongest = emission.max_element();
        if strongest > 0.0 {
            self.exitance = strongest;
            self.colour = (emission / strongest).to_array();
        }
    }
}

/// Draws the section.
pub(super) fn show(ui: &mut Ui, info: &SceneInfo, lamp: &mut LampEditor, outbox: &mut Outbox) {
    if !info.has_light {
        let sentence =
            "Nothing in this scene emits light, so it is black: make a material emit, or add a ceiling light.";
        ui.add(egui::Label::new(theme::notice(ui, sentence)).wrap());
        ui.add_space(2.0);
    }
    show_material(ui, &info.scene, lamp, outbox);
    ui.add_space(6.0);
    show_ceiling(ui, lamp, outbox);
}

fn show_material(ui: &mut Ui, scene: &Scene, lamp: &mut LampEditor, outbox: &mut Outbox) {
    ui.label(theme::weak("Make a material emit (click a surface in the view to choose it)"));
    let Some(material) = scene.materials.get(lamp.material.0 as usize) else { return };
    let before = (lamp.material, lamp.emission());
    ui.horizontal(|ui| {
        let combo = ComboBox::from_id_salt("material").width(196.0).truncate().selected_text(material.name.as_str());
        let mut chosen = None;
        let response = combo.show_ui(ui, |ui| {
            for (index, other) in scene.materials.iter().enumerate() {
                if ui.selectable_label(index as u32 == lamp.material.0, other.name.as_str()).clicked() {
                    chosen = Some(MaterialId(index as u32));
                }
            }
        });
        let _ = response.response.accessible_name("Material");
        if let Some(chosen) = chosen {
            lamp.choose(scene, chosen);
        }
        let _ = ui.color_edit_button_rgb(&mut lamp.colour).accessible_name("Colour of the light");
    });
    exitance_slider(ui, &mut lamp.exitance, "Strength");
    let emits = material.emission.max_element() > 0.0;
    // The choice of another material shows that one's values, which is no change of them.
    if emits && lamp.material == before.0 && lamp.emission() != before.1 {
        outbox.push(Command::SetEmission { material: lamp.material, emission: lamp.emission() });
    }
    ui.horizontal(|ui| {
        if ui.add_enabled(!emits, egui::Button::new("Make it emit")).clicked() {
            outbox.push(Command::SetEmission { material: lamp.material, emission: lamp.emission() });
        }
        if ui.add_enabled(emits, egui::Button::new("Switch it off")).clicked() {
            outbox.push(Command::SetEmission { material: lamp.material, emission: Vec3::ZERO });
        }
    });
}

fn show_ceiling(ui: &mut Ui, lamp: &mut LampEditor, outbox: &mut Outbox) {
    ui.label(theme::weak("Add a square light below the ceiling"));
    let speed = 0.01 * f64::from(lamp.size);
    let side = DragValue::new(&mut lamp.size).speed(speed).range(1e-6..=1e6).max_decimals(3);
    theme::row(ui, "Side length", |ui| ui.add(side)).on_hover_text("In the scene's length unit");
    exitance_slider(ui, &mut lamp.ceiling_exitance, "Ceiling strength");
    if ui.button("Add a ceiling light").clicked() {
        let exitance = Vec3::splat(lamp.ceiling_exitance);
        outbox.push(Command::AddCeilingLight { size: lamp.size, exitance });
    }
}

fn exitance_slider(ui: &mut Ui, exitance: &mut f32, name: &str) {
    // What a file says beyond the slider's range stays until a person moves it.
    let slider = Slider::new(exitance, EXITANCES).clamping(egui::SliderClamping::Edits);
    let slider = slider.logarithmic(true).suffix(" W/m²").max_decimals(1);
    let slider = slider.custom_formatter(|value, _| format::grouped(value));
    let slider = slider.custom_parser(|text| text.replace(',', "").trim().parse().ok());
    theme::row(ui, name, |ui| ui.add(slider));
}
