//! The material at hand: what it reflects, and what it emits.

use egui::{Button, ComboBox, Slider, Ui};

use super::super::super::lighting::Tinted;
use super::super::super::theme;
use super::{LightEditor, exitance_slider};
use crate::scene::{MAX_SIDECAR_REFLECTANCE, MaterialId, Scene};

/// Draws the part.
pub(super) fn show(ui: &mut Ui, scene: &Scene, editor: &mut LightEditor) {
    ui.label(theme::weak("Material (click a surface in the view to choose it)"));
    show_choice(ui, scene, editor);
    let Some(light) = editor.lighting.of_mut(editor.material.0 as usize) else { return };
    let mut strength = light.reflectance.strength();
    theme::row(ui, "Reflectance", |ui| {
        let slider = Slider::new(&mut strength, 0.0..=MAX_SIDECAR_REFLECTANCE).fixed_decimals(2);
        let response = ui.add(slider.clamping(egui::SliderClamping::Edits));
        if response.changed() {
            light.reflectance.set_strength(strength);
        }
        response
    })
    .on_hover_text("Share ρ of the light that it reflects, of its brightest colour");
    show_colour(ui, "Colour", "Colour of the reflectance", &mut light.reflectance);
    let mut strength = light.emission.strength();
    theme::row(ui, "Strength", |ui| {
        let response = exitance_slider(ui, &mut strength);
        if response.changed() {
            light.emission.set_strength(strength);
        }
        response
    })
    .on_hover_text("Exitance B_e that it emits of its brightest colour, before its dimmer");
    show_colour(ui, "Colour of light", "Colour of the light that it emits", &mut light.emission);
    ui.horizontal(|ui| {
        let name = if light.is_lamp { "Switch it on" } else { "Make it emit" };
        if ui.add_enabled(!light.is_on, Button::new(name)).clicked() {
            (light.is_lamp, light.is_on) = (true, true);
        }
        let off = ui.add_enabled(light.is_on, Button::new("Switch it off"));
        if off.on_hover_text("Its strength is remembered for when it goes on again").clicked() {
            light.is_on = false;
        }
    });
}

fn show_choice(ui: &mut Ui, scene: &Scene, editor: &mut LightEditor) {
    let Some(material) = scene.materials.get(editor.material.0 as usize) else { return };
    let response = theme::row(ui, "Material", |ui| {
        let combo = ComboBox::from_id_salt("material").truncate().selected_text(material.name.as_str());
        let shown = combo.show_ui(ui, |ui| {
            for (index, other) in scene.materials.iter().enumerate() {
                if ui.selectable_label(index as u32 == editor.material.0, other.name.as_str()).clicked() {
                    editor.material = MaterialId(index as u32);
                }
            }
        });
        shown.response
    });
    let _ = response.on_hover_text(material.name.as_str());
}

fn show_colour(ui: &mut Ui, label: &str, name: &str, tinted: &mut Tinted) {
    theme::row(ui, label, |ui| {
        let mut tint = tinted.tint().to_array();
        let response = ui.color_edit_button_rgb(&mut tint);
        if response.changed() {
            tinted.set_tint(tint.into());
        }
        response
    })
    .on_hover_text(name);
}
