//! The lamps of the scene: each material that emits, by name, with a switch, a dimmer and a colour.

use egui::{ScrollArea, Slider, Ui};

use super::super::super::{format, theme};
use super::LightEditor;
use crate::scene::{MaterialId, Scene};

/// What a dimmer offers, in percent of what the lamp had.
const DIMMER: std::ops::RangeInclusive<f32> = 0.0..=200.0;
/// Height that the list may take before it scrolls, points.
const MOST_HEIGHT: f32 = 150.0;
/// Widths of the value beside a dimmer and of the colour beside that, points.
const PERCENT_WIDTH: f32 = 52.0;

const COLOUR_WIDTH: f32 = 32.0;

/// Draws the list.
pub(super) fn show(ui: &mut Ui, scene: &Scene, editor: &mut LightEditor) {
    let lamps: Vec<usize> = editor.lighting.lamps().collect();
    if lamps.is_empty() {
        return;
    }
    let all: glam::Vec3 = lamps.iter().map(|&lamp| power(editor, lamp)).sum();
    let (count, watts) =
        (format::things(lamps.len(), "lamp", "lamps"), format::quantity(all.max_element().into(), "W"));
    ui.label(theme::weak(format!("{count}, {watts}")))
        .on_hover_text("Materials that emit, with the power of all of their faces in the strongest channel");
    ScrollArea::vertical().id_salt("lamps").max_height(MOST_HEIGHT).auto_shrink([false, true]).show(ui, |ui| {
        for lamp in lamps {
            let Some(material) = scene.materials.get(lamp) else { continue };
            show_one(ui, &material.name, MaterialId(lamp as u32), editor);
        }
    });
    ui.add_space(6.0);
}

fn show_one(ui: &mut Ui, name: &str, id: MaterialId, editor: &mut LightEditor) {
    let index = id.0 as usize;
    let watts = power(editor, index).max_element();
    let exitance = editor.lighting.of(index).map_or(0.0, |light| light.emission().max_element());
    let Some(light) = editor.lighting.of_mut(index) else { return };
    ui.horizontal(|ui| {
        let name_width = theme::LABEL_WIDTH.min(0.4 * ui.available_width());
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
        let power = format!(
            "{name}{state}: {}, {}",
            format::quantity(exitance.into(), "W/m²"),
            format::quantity(watts.into(), "W")
        );
        let switched = switch.on_hover_text(power).clicked();
        let mut percent = 100.0 * light.dimmer;
        ui.spacing_mut().interact_size.x = PERCENT_WIDTH;
        let slider = Slider::new(&mut percent, DIMMER).suffix(" %").max_decimals(0).trailing_fill(true);
        let dimmer = ui.add_enabled(light.is_on, slider);
        let dimmer = dimmer.on_hover_text("100 % is what the lamp had when the scene was opened");
        if dimmer.accessible_name(format!("Dimmer of {name}")).changed() {
            light.dimmer = percent / 100.0;
        }
        ui.spacing_mut().interact_size.x = COLOUR_WIDTH;
        let mut colour = light.emission.tint().to_array();
        let button = ui.color_edit_button_rgb(&mut colour).on_hover_text("Colour of the light");
        if button.accessible_name(format!("Colour of {name}")).changed() {
            light.emission.set_tint(colour.into());
        }
        if switched {
            editor.material = id;
        }
    });
}

/// Power that a material's faces emit, W per colour.
fn power(editor: &LightEditor, material: usize) -> glam::Vec3 {
    let area = editor.areas.get(material).copied().unwrap_or(0.0);
    editor.lighting.of(material).map_or(glam::Vec3::ZERO, |light| area * light.emission())
}
