//! The lamps of the scene: each material that emits and each luminaire, by name, with a switch, a
//! dimmer and a colour.

use egui::{ScrollArea, Slider, Ui};
use glam::Vec3;

use crate::app::format;
use crate::app::panels::light::{LightEditor, lumens};
use crate::app::state::lighting::MaterialLight;
use crate::app::widgets::{rows, theme};
use crate::base::photometry::lux;
use crate::scene::{FileLight, MaterialId, Scene};

/// Range of a dimmer, in percent of the light that is set for the lamp.
const DIMMER: std::ops::RangeInclusive<f32> = 0.0..=200.0;
/// Height that the list may take before it scrolls, points.
const MOST_HEIGHT: f32 = 150.0;
/// Widths of the value beside a dimmer and of the colour beside that, points.
const PERCENT_WIDTH: f32 = 52.0;

const COLOUR_WIDTH: f32 = 32.0;

/// Draws the list.
pub fn show(ui: &mut Ui, scene: &Scene, editor: &mut LightEditor) {
    let lamps: Vec<usize> = editor.lighting.lamps().collect();
    let count = lamps.len() + editor.lighting.luminaires.len();
    if count == 0 {
        return;
    }
    let area = |areas: &[f32], lamp: usize| areas.get(lamp).copied().unwrap_or(0.0);
    let of_file = lamps
        .iter()
        .filter_map(|&lamp| editor.lighting.of(lamp).map(|light| area(&editor.areas, lamp) * light.emission()));
    let of_luminaires = editor.lighting.luminaires.iter().map(|of| of.form.area() * of.light.emission());
    let powers: Vec<Vec3> = of_file.chain(of_luminaires).collect();
    let shining = powers.iter().filter(|power| power.max_element() > 0.0).count();
    let lamps_in_words = match shining == count {
        true => format::things(count, "lamp", "lamps"),
        false => format!("{shining} of {} on", format::things(count, "lamp", "lamps")),
    };
    let all: Vec3 = powers.into_iter().sum();
    ui.label(theme::weak(format!("{lamps_in_words}, {}", lumens(lux(all.to_array())))))
        .on_hover_text(format!("Luminous flux of all faces that emit: {}", in_watts(all)));
    ScrollArea::vertical().id_salt("lamps").max_height(MOST_HEIGHT).auto_shrink([false, true]).show(ui, |ui| {
        for lamp in lamps {
            let Some(material) = scene.materials.get(lamp) else { continue };
            let area = area(&editor.areas, lamp);
            let Some(light) = editor.lighting.of_mut(lamp) else { continue };
            let of_file = scene.lights.iter().find(|light| light.material.0 as usize == lamp).map(as_in_file);
            if show_one(ui, &material.name, area, light, of_file.as_deref()) {
                editor.material = MaterialId(lamp as u32);
            }
        }
        for (index, luminaire) in editor.lighting.luminaires.iter_mut().enumerate() {
            let area = luminaire.form.area();
            if show_one(ui, &luminaire.name, area, &mut luminaire.light, None) {
                editor.selected = Some(index);
            }
        }
    });
    ui.add_space(6.0);
}

/// Power of the three channels, W, in words.
fn in_watts(power: Vec3) -> String {
    let watts = |power: f32| format::quantity(power.into(), "W");
    format!("{} (sum of channels), {} (strongest channel)", watts(power.element_sum()), watts(power.max_element()))
}

/// Data of a point or spot light as its file has them.
fn as_in_file(light: &FileLight) -> String {
    let candelas = format::quantity(light.candelas.max_element().into(), "cd");
    let range = light.range.map(|range| format!(", range {}", format::quantity(range.into(), "m")));
    let cone = light.cone.map(|cone| {
        let [inner, outer] = cone.map(|half| 2.0 * half.to_degrees());
        format!(", full within {inner:.0}°, dark beyond {outer:.0}°")
    });
    format!("By the file {candelas}{}{}", cone.unwrap_or_default(), range.unwrap_or_default())
}

/// Draws one lamp whose faces have this area, with what its file says beside; true when it was
/// switched.
fn show_one(ui: &mut Ui, name: &str, area: f32, light: &mut MaterialLight, of_file: Option<&str>) -> bool {
    let power = area * light.emission();
    let flux = lumens(lux(power.to_array()));
    ui.horizontal(|ui| {
        let name_width = rows::LABEL_WIDTH.min(0.4 * ui.available_width());
        let beside = name_width + PERCENT_WIDTH + COLOUR_WIDTH + 4.0 * ui.spacing().item_spacing.x;
        ui.spacing_mut().slider_width = (ui.available_width() - beside).clamp(40.0, 240.0);
        let switch = ui
            .scope(|ui| {
                ui.set_min_width(name_width);
                ui.set_max_width(name_width);
                ui.style_mut().wrap_mode = Some(egui::TextWrapMode::Truncate);
                ui.checkbox(&mut light.is_on, name)
            })
            .inner;
        let state = if light.is_on { "" } else { " (switched off)" };
        let power = format!("{name}{state}: {flux}\n{}", in_watts(power));
        let hint = of_file.map_or_else(|| power.clone(), |of_file| format!("{power}\n{of_file}"));
        let switched = switch.on_hover_text(hint).clicked();
        let mut percent = 100.0 * light.dimmer;
        ui.spacing_mut().interact_size.x = PERCENT_WIDTH;
        let slider = Slider::new(&mut percent, DIMMER).suffix(" %").max_decimals(0).trailing_fill(true);
        let dimmer = ui.add_enabled(light.is_on, slider);
        let dimmer = dimmer.on_hover_text(format!("100 % is the light set for {name}; now {flux}"));
        if dimmer.accessible_name(format!("Dimmer of {name}")).changed() {
            light.dimmer = percent / 100.0;
        }
        ui.spacing_mut().interact_size.x = COLOUR_WIDTH;
        let mut colour = light.emission.tint().to_array();
        let button = ui.color_edit_button_rgb(&mut colour).on_hover_text("Colour of the light");
        if button.accessible_name(format!("Colour of {name}")).changed() {
            light.emission.set_tint(colour.into());
        }
        switched
    })
    .inner
}
