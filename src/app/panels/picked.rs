//! The card of the selected element, over the view's corner, on request: what it is, how it is lit
//! and by what. The inspector, which tells more, takes its place.

use egui::{Align2, Grid, Rect, RichText, Ui};
use glam::Vec3;

use crate::app::actions::{Action, Outbox};
use crate::app::state::facts::Facts;
use crate::app::state::inspection::Inspection;
use crate::app::tools::Tool;
use crate::app::view::overlays::{Overlays, Place};
use crate::app::widgets::{rows, theme};
use crate::app::{Shown, format, words};
use crate::hierarchy::ElementId;
use crate::solve::Snapshot;
use crate::transport::LinkView;

/// Width of the card, points.
const WIDTH: f32 = 288.0;
/// A narrower view would be hidden by more than a few lines, points.
const WIDE_ENOUGH: f32 = 640.0;
/// In a narrower view the card leaves the line above it to the readout, points.
const BESIDE_READOUT: f32 = 800.0;
/// Height of that line, points.
const READOUT_HEIGHT: f32 = 34.0;
/// So many links are shown, the strongest.
const MOST: usize = 5;

/// Width of the view that the card leaves to the readout, points.
pub fn room_beside(view: Rect, is_shown: bool) -> f32 {
    let taken = if is_shown && view.width() >= BESIDE_READOUT { WIDTH + 40.0 } else { 0.0 };
    view.width() - taken
}

/// Draws the card; nothing when nothing is picked.
pub fn show(
    ui: &Ui,
    rect: Rect,
    shown: &Shown,
    overlays: &mut Overlays,
    inspection: &mut Inspection,
    outbox: &mut Outbox,
) {
    let (Some(element), Some(snapshot)) = (shown.picked_element(), &shown.snapshot) else { return };
    let mut place = Place::at_rim("card", rect, Align2::RIGHT_TOP);
    if rect.width() < BESIDE_READOUT {
        place.at.y += READOUT_HEIGHT;
    }
    overlays.card(ui, place, 10, |ui| {
        ui.set_width(WIDTH);
        ui.horizontal(|ui| {
            ui.label(RichText::new(words::SELECTED_ELEMENT).strong().size(14.0));
            ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
                if ui.button(words::CLOSE).on_hover_text("Deselect (Esc)").clicked() {
                    outbox.act(Action::Deselect);
                }
                let hint = "Open the inspector: all its links, and what holds it";
                if ui.button(words::INSPECT).on_hover_text(hint).clicked() {
                    outbox.act(Action::OpenTool(Tool::Inspector));
                }
            });
        });
        let name = inspection.name(element);
        ui.add(egui::Label::new(RichText::new(name).strong()).truncate());
        if let Some(facts) = &inspection.facts {
            let deepest = snapshot.solution_view.as_ref().map(|solution_view| solution_view.deepest());
            show_facts(ui, facts, deepest);
        }
        if rect.width() >= WIDE_ENOUGH {
            show_sources(ui, inspection, snapshot, element);
        }
    });
}

fn show_facts(ui: &mut Ui, facts: &Facts, deepest: Option<u16>) {
    Grid::new("picked facts").num_columns(2).spacing([12.0, 3.0]).show(ui, |ui| {
        let mut row = |name: &str, value: String| {
            ui.label(theme::weak(name));
            ui.add(egui::Label::new(theme::value(value)).truncate());
            ui.end_row();
        };
        match facts.polygon {
            Some(polygon) => row("Polygon", format::count(polygon)),
            None => row("Cluster of", format::things(facts.polygons, "polygon", "polygons")),
        }
        row("Area", format::quantity(facts.area.into(), "m²"));
        if let Some((level, deepest)) = facts.level.zip(deepest) {
            row(words::LEVEL, format!("{level} of {deepest}"));
        }
        row(words::MEAN_ILLUMINANCE, format::quantity(facts.illuminance().into(), "lx"));
        for (name, irradiance, _) in facts.irradiances() {
            row(name, colours(irradiance));
        }
        row("B", colours(facts.radiosity));
    });
}

fn colours(rgb: Vec3) -> String {
    let [r, g, b] = rgb.to_array().map(|value| format::number(value.into()));
    format!("{r} {g} {b} W/m²")
}

fn show_sources(ui: &mut Ui, inspection: &mut Inspection, snapshot: &Snapshot, element: ElementId) {
    ui.separator();
    if !snapshot.solution_view.as_ref().is_some_and(|solution_view| solution_view.holds(element)) {
        ui.label(theme::weak("Asking for its links…"));
        return;
    }
    let count = inspection.links.len();
    if count == 0 {
        ui.label("No link brings it light");
        return;
    }
    let links = format::things(count, "link", "links");
    let heading = format!("{}, E in W/m² ({links}):", words::TOP_SOURCES);
    rows::sentence(ui, heading);
    let strongest: Vec<LinkView> = inspection.links.iter().take(MOST).copied().collect();
    Grid::new("sources").num_columns(2).spacing([12.0, 2.0]).show(ui, |ui| {
        for link in strongest {
            ui.label(theme::value(format!("{:>9}", format::number(link.irradiance.max_element().into()))));
            let name = name_of_source(inspection, &link);
            let details = format!(
                "{name}: {}; E {}, F = {}, V = {:.2}, {} to the whole receiver",
                whose(&link),
                colours(link.irradiance),
                format::number(link.form_factor.into()),
                link.visibility,
                format::quantity(link.power.element_sum().into(), "W"),
            );
            ui.add(egui::Label::new(name).truncate()).on_hover_text(details);
            ui.end_row();
        }
    });
}

fn name_of_source(inspection: &mut Inspection, link: &LinkView) -> String {
    match link.source == link.receiver {
        true => "itself, among its parts".to_owned(),
        false => inspection.names.full(link.source).to_owned(),
    }
}

/// Whose link brings the light, seen from the inspected element.
pub fn whose(link: &LinkView) -> String {
    whose_end(link.levels_up, link.receiver_is_cluster)
}

/// Whose link takes the light away, likewise.
pub fn whose_light(link: &LinkView) -> String {
    whose_end(link.levels_up, link.source_is_cluster)
}

fn whose_end(levels_up: i16, is_cluster: bool) -> String {
    let kind = if is_cluster { "cluster" } else { "patch" };
    match levels_up {
        0 => "a link of the element's own".to_owned(),
        1 => format!("a link of the {kind} that holds it"),
        levels if levels > 0 => format!("a link of the {kind} {levels} levels above it"),
        levels => {
            let below = format::things(usize::from(levels.unsigned_abs()), "level", "levels");
            format!("a link of a {kind} inside of it, {below} below")
        }
    }
}
