//! The material at hand: what it reflects, and what it emits.

use egui::{Button, ComboBox, Label, RichText, Slider, Ui};
use glam::Vec3;

use crate::app::panels::light::{Faces, LampUnit, LightEditor, lumens, strength_slider};
use crate::app::state::lighting::MaterialLight;
use crate::app::widgets::{rows, theme};
use crate::app::{format, words};
use crate::base::photometry::{lux, temperature_of_tint, tint_of_temperature};
use crate::scene::{MAX_SIDECAR_REFLECTANCE, MaterialId, Scene};
use crate::worker::SceneInfo;

/// Colour temperatures offered, K.
const TEMPERATURES: std::ops::RangeInclusive<f32> = 1700.0..=12_000.0;
/// A tint that differs by less than this in each channel is that of a temperature.
const SAME_TINT: f32 = 0.04;

/// Draws the part.
pub fn show(ui: &mut Ui, info: &SceneInfo, editor: &mut LightEditor) {
    let scene = &info.scene;
    ui.label(theme::weak("Material (click a surface in the view to choose it)"));
    show_choice(ui, scene, editor);
    show_faces(ui, scene, editor);
    let area = editor.areas.get(editor.material.0 as usize).copied().unwrap_or(0.0);
    let Some(light) = editor.lighting.of_mut(editor.material.0 as usize) else { return };
    let Some(material) = scene.materials.get(editor.material.0 as usize) else { return };
    let mut strength = light.reflectance.strength();
    rows::row(ui, words::REFLECTANCE, |ui| {
        let slider = Slider::new(&mut strength, 0.0..=MAX_SIDECAR_REFLECTANCE).fixed_decimals(2);
        let response = ui.add(slider.clamping(egui::SliderClamping::Edits));
        if response.changed() {
            light.reflectance.set_strength(strength);
        }
        response
    })
    .on_hover_text("Share ρ of the light that it reflects, of the strongest channel");
    let mut colour = light.reflectance.value().to_array();
    if show_colour(ui, "Colour", "Share of each colour that it reflects", &mut colour) {
        light.reflectance.set(Vec3::from(colour).min(Vec3::splat(MAX_SIDECAR_REFLECTANCE)));
    }
    if !light.is_lamp {
        let hint = format!("Its faces emit {} together, to begin with", lumens(info.luminaire_lumens));
        if ui.add_enabled(area > 0.0, Button::new(words::MAKE_IT_A_LIGHT)).on_hover_text(hint).clicked() {
            (light.is_lamp, light.is_on) = (true, true);
            light.emission.set_strength(info.luminaire_lumens / (area * lux(light.emission.tint().to_array())));
        }
        return;
    }
    show_strength(ui, &material.name, light, area, &mut editor.unit);
    show_tint(ui, "Colour of light", light);
    show_temperature(ui, light);
    ui.horizontal(|ui| {
        if ui.add_enabled(!light.is_on, Button::new(words::SWITCH_ON)).clicked() {
            light.is_on = true;
        }
        let off = ui.add_enabled(light.is_on, Button::new(words::SWITCH_OFF));
        if off.on_hover_text("Its exitance is kept for when it is switched on again").clicked() {
            light.is_on = false;
        }
    });
}

/// The strength of a lamp by name, in a unit to be chosen.
pub fn show_strength(ui: &mut Ui, name: &str, light: &mut MaterialLight, area: f32, unit: &mut LampUnit) {
    ui.add_space(2.0);
    ui.add(Label::new(RichText::new(words::light_of(name)).strong()).truncate()).on_hover_text(name);
    if !light.is_on {
        ui.label(theme::weak("Switched off"));
    } else if light.dimmer != 1.0 {
        let now = lumens(area * lux(light.emission().to_array()));
        ui.label(theme::weak(format!("Dimmed to {:.0} %: {now}", 100.0 * light.dimmer)));
    }
    rows::row(ui, words::LAMP_UNIT, |ui| {
        let combo = ComboBox::from_id_salt("lamp unit").selected_text(unit.words().0);
        let shown = combo.show_ui(ui, |ui| {
            for each in LampUnit::ALL {
                let (name, sign, hint) = each.words();
                ui.selectable_value(unit, each, format!("{name}, {sign}")).on_hover_text(hint);
            }
        });
        shown.response
    });
    let (label, sign, hint) = unit.words();
    let per_exitance = unit.per_exitance(light.emission.tint(), area);
    let mut strength = per_exitance * light.emission.strength();
    rows::row(ui, label, |ui| {
        ui.add_enabled_ui(per_exitance > 0.0, |ui| {
            let response = strength_slider(ui, &mut strength, per_exitance, sign);
            if response.changed() {
                light.emission.set_strength(strength / per_exitance);
            }
            response
        })
        .inner
    })
    .on_hover_text(hint);
}

/// The colour of the light as a temperature, where it is one.
pub fn show_temperature(ui: &mut Ui, light: &mut MaterialLight) {
    let (mut kelvin, off) = temperature_of_tint(light.emission.tint().to_array());
    rows::row(ui, words::COLOUR_TEMPERATURE, |ui| {
        let slider = Slider::new(&mut kelvin, TEMPERATURES).logarithmic(true).clamping(egui::SliderClamping::Edits);
        let is_one = off < SAME_TINT;
        let slider = slider.custom_formatter(move |kelvin, _| match is_one {
            true => format!("{} K", format::count((10.0 * (kelvin / 10.0).round()) as u64)),
            false => "none".to_owned(),
        });
        let slider = slider.custom_parser(|text| text.replace([',', 'K'], "").trim().parse().ok());
        let response = ui.add(slider);
        if response.changed() {
            light.emission.set_tint(tint_of_temperature(kelvin).into());
        }
        response
    })
    .on_hover_text("Colour of a black body at this temperature; the exitance of the strongest channel stays");
}

fn show_choice(ui: &mut Ui, scene: &Scene, editor: &mut LightEditor) {
    let Some(material) = scene.materials.get(editor.material.0 as usize) else { return };
    let response = rows::row(ui, "Material", |ui| {
        let combo = ComboBox::from_id_salt("material").truncate().selected_text(material.name.as_str());
        let shown = combo.show_ui(ui, |ui| {
            // A luminaire's is its own affair.
            let of_file = scene.materials.len() - scene.placed_luminaires.len();
            for (index, other) in scene.materials[..of_file].iter().enumerate() {
                if ui.selectable_label(index as u32 == editor.material.0, other.name.as_str()).clicked() {
                    editor.material = MaterialId(index as u32);
                }
            }
        });
        shown.response
    });
    let _ = response.on_hover_text(material.name.as_str());
}

/// Offers the faces of the material at hand that were left out, or to leave them out.
fn show_faces(ui: &mut Ui, scene: &Scene, editor: &mut LightEditor) {
    let Some(material) = scene.materials.get(editor.material.0 as usize) else { return };
    let is_ignored = scene.reading.ignored.contains(&material.name);
    let has_faces = editor.areas.get(editor.material.0 as usize).is_some_and(|area| *area > 0.0);
    let (label, faces, hint) = if material.left_out > 0 {
        let faces = format::things(material.left_out, "transparent face", "transparent faces");
        let hint = "The file says that they let light through, so they were left out. This reads the file again and takes them for opaque; `Save scene settings` keeps it.";
        (format!("Make its {faces} opaque"), Faces::Opaque, hint)
    } else if is_ignored {
        ("Bring its faces back".to_owned(), Faces::Back, "Reads the scene again with the faces of this material")
    } else if !has_faces {
        return;
    } else {
        let hint = "Reads the scene again without the faces of this material, such as panes that daylight is to pass; `Save scene settings` keeps it.";
        ("Leave its faces out".to_owned(), Faces::LeftOut, hint)
    };
    if ui.button(label).on_hover_text(hint).clicked() {
        editor.faces = Some((material.name.clone(), faces));
    }
}

/// The tint of a lamp's light.
pub fn show_tint(ui: &mut Ui, label: &str, light: &mut MaterialLight) {
    let mut tint = light.emission.tint().to_array();
    if show_colour(ui, label, "Tint of the light that it emits; its exitance stays", &mut tint) {
        light.emission.set_tint(tint.into());
    }
}

/// A colour that can be edited; true when it was.
fn show_colour(ui: &mut Ui, label: &str, hint: &str, colour: &mut [f32; 3]) -> bool {
    rows::row(ui, label, |ui| ui.color_edit_button_rgb(colour)).on_hover_text(hint).changed()
}
