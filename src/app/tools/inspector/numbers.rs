//! The element in numbers.

use egui::{Grid, Ui};
use glam::Vec3;

use crate::app::format;
use crate::app::state::facts::Facts;
use crate::app::tools::inspector::{Subject, compact};
use crate::app::widgets::theme;
use crate::base::photometry;

/// Room that two numbers beside each other take, points.
const ROOM_FOR_TWO: f32 = 460.0;

/// Draws them, two to a line where there is room.
pub(in crate::app) fn show(ui: &mut Ui, subject: &Subject<'_>, facts: &Facts) {
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
fn numbers(facts: &Facts, deepest: u16) -> [(&'static str, String, String); 8] {
    let own = match facts.emitted.max_element() > 0.0 {
        true => ("B_e", colours(facts.emitted, "W/m²"), "The part of B that lamps emit".into()),
        false => {
            ("ρ", colours(facts.reflectance, ""), "Reflectance of the three colours, the mean over the area".into())
        }
    };
    let level = match (facts.depth, facts.level) {
        (Some(depth), Some(level)) => format!("{depth} of {deepest}, {level} below its polygon"),
        (Some(depth), None) => format!("{depth} of {deepest}"),
        _ => "–".into(),
    };
    let size = match facts.polygon {
        Some(polygon) => ("polygon", format::count(polygon), "Its number in the scene's file".into()),
        None => ("polygons", format::count(facts.polygons), "Polygons inside of the cluster".into()),
    };
    let of_light = |what: &str| format!("{what} of the three colours, the mean over the area");
    [
        ("E", colours(facts.irradiance, "W/m²"), of_light("Irradiance")),
        (
            "illuminance",
            format::quantity(facts.illuminance().into(), "lx"),
            format!("Illuminance; {}", photometry::CONVENTION),
        ),
        ("B", colours(facts.radiosity, "W/m²"), of_light("Radiosity, what is emitted and reflected")),
        (
            "luminance",
            format::quantity(facts.luminance().into(), "cd/m²"),
            format!("Luminance B/π; lumens = {}, the convention of Radiance", photometry::FORMULA),
        ),
        own,
        ("area", format::quantity(facts.area.into(), "m²"), "Area that light can reach".into()),
        ("level", level, "Levels below the root; clusters and patches count alike".into()),
        size,
    ]
}

fn colours(rgb: Vec3, unit: &str) -> String {
    let [r, g, b] = rgb.to_array().map(compact);
    format!("{r} {g} {b} {unit}").trim_end().to_owned()
}
