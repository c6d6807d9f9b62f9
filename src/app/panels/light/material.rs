//! The material at hand: what it reflects, and what it emits.

use egui::{Button, ComboBox, Slider, Ui};
use glam::Vec3;

use super::super::super::{format, theme};
use super::{LightEditor, exitance_slider};
use crate::scene::{MAX_SIDECAR_REFLECTANCE, MaterialId, Scene};

/// Draws the part.
pub(super) fn show(ui: &mut Ui, scene: &Scene, editor: &mut LightEditor) {
    ui.label(theme::weak("Material (click a surface in the view to choose it)"));
    show_choice(ui, scene, editor);
    show_left_out(ui, scene, editor);
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
    let mut colour = light.reflectance.value().to_array();
    if show_colour(ui, "Colour", "Share of each colour that it reflects", &mut colour) {
        light.reflectance.set(Vec3::from(colour).min(Vec3::splat(MAX_SIDECAR_REFLECTANCE)));
    }
    let mut strength = light.emission.strength();
    theme::row(ui, "Strength", |ui| {
        let response = exitance_slider(ui, &mut strength);
        if response.changed() {
            light.emission.set_strength(strength);
        }
        response
    })
    .on_hover_text("Exitance B_e that it emits of its brightest colour, before its dimmer");
    let mut tint = light.emission.tint().to_array();
    if show_colour(ui, "Colour of light", "Tint of the light that it emits; its strength stays", &mut tint) {
        light.emission.set_tint(tint.into());
    }
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

/// Offers the faces of the material at hand that were left out.
fn show_left_out(ui: &mut Ui, scene: &Scene, editor: &mut LightEditor) {
    let Some(material) = scene.materials.get(editor.material.0 as usize).filter(|material| material.left_out > 0)
    else {
        return;
    };
    let faces = format::things(material.left_out, "transparent face", "transparent faces");
    let hint = "The file says that they let light through, so they were left out. This reads the file again and takes them for opaque; `Save sidecar` keeps it.";
    if ui.button(format!("Make its {faces} opaque")).on_hover_text(hint).clicked() {
        editor.opaque = Some(material.name.clone());
    }
}

/// A colour that can be edited; true when it was.
fn show_colour(ui: &mut Ui, label: &str, hint: &str, colour: &mut [f32; 3]) -> bool {
    theme::row(ui, label, |ui| ui.color_edit_button_rgb(colour)).on_hover_text(hint).changed()
}
