//! The element in numbers.

use egui::{Grid, Ui};
use glam::Vec3;

use crate::app::state::facts::Facts;
use crate::app::tools::inspector::{Subject, compact};
use crate::app::widgets::theme;
use crate::app::{format, words};
use crate::base::photometry;

/// Room that two numbers beside each other take, points.
const ROOM_FOR_TWO: f32 = 460.0;

/// Draws them, two to a line where there is room.
pub fn show(ui: &mut Ui, subject: &Subject<'_>, facts: &Facts) {
    ui.add_space(2.0);
    let a_line = if ui.available_width() >= ROOM_FOR_TWO { 2 } else { 1 };
    Grid::new(("inspected", a_line)).num_columns(2 * a_line).spacing([10.0, 2.0]).show(ui, |ui| {
        for line in numbers(facts, subject.solution_view.deepest()).chunks(a_line) {
            for (name, value, hint) in line {
                ui.label(theme::weak(*name)).on_hover_text(hint);
                ui.label(theme::value(value)).on_hover_text(hint);
            }
            ui.end_row();
        }
    });
}

/// Names, values and what they mean.
fn numbers(facts: &Facts, deepest: u16) -> Vec<(&'static str, String, String)> {
    let own = match facts.emitted.max_element() > 0.0 {
        true => ("B_e", colours(facts.emitted, "W/m²"), "The part of B that lamps emit".into()),
        false => {
            ("ρ", colours(facts.reflectance, ""), "Reflectance of the three channels, the mean over the area".into())
        }
    };
    let level = facts.level.map_or("–".into(), |level| format!("{level} of {deepest}"));
    let size = match facts.polygon {
        Some(polygon) => ("Polygon", format::count(polygon), "Its number in the scene's file".into()),
        None => ("Polygons", format::count(facts.polygons), "Polygons inside of the cluster".into()),
    };
    let irradiances = facts.irradiances().into_iter();
    let mut numbers: Vec<_> =
        irradiances.map(|(name, value, hint)| (name, colours(value, "W/m²"), hint.to_owned())).collect();
    numbers.extend([
        (
            words::MEAN_ILLUMINANCE,
            format::quantity(facts.illuminance().into(), "lx"),
            format!("Illuminance, the mean over the area; {}", photometry::CONVENTION),
        ),
        (
            "B",
            colours(facts.radiosity, "W/m²"),
            "Radiosity of the three channels, emitted and reflected, the mean over the area".into(),
        ),
        (
            "Luminance",
            format::quantity(facts.luminance().into(), "cd/m²"),
            format!("Luminance B/π; lumens = {}, the convention of Radiance", photometry::FORMULA),
        ),
        own,
        ("Area", format::quantity(facts.area.into(), "m²"), "Area that light can reach".into()),
        (words::LEVEL, level, "Levels below the root; clusters and patches count alike".into()),
        size,
    ]);
    numbers
}

fn colours(rgb: Vec3, unit: &str) -> String {
    let [r, g, b] = rgb.to_array().map(compact);
    format!("{r} {g} {b} {unit}").trim_end().to_owned()
}
