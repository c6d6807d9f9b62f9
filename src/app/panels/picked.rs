//! The card of the selected element, over the view's corner, on request: what it is, how it is lit and by what. The inspector, which
//! tells more, takes its place.

use egui::{Align2, Grid, Rect, RichText, Ui};
use glam::Vec3;

use crate::app::state::facts::Facts;
use crate::app::state::inspection::Inspection;
use crate::app::tools::Tool;
use crate::app::widgets::theme;
use crate::app::{App, format, words};
use crate::hierarchy::ElementId;
use crate::scene::Scene;
use crate::solve::Snapshot;
use crate::transport::{LinkView, SolutionView};

/// Width of the card, points.
const WIDTH: f32 = 288.0;
/// A narrower view would be hidden by more than a few lines, points.
const WIDE_ENOUGH: f32 = 640.0;
/// So many links are shown, the strongest.
const MOST: usize = 5;

/// Draws the card; nothing when nothing is picked.
pub(in crate::app) fn show(app: &mut App, ui: &mut Ui, rect: Rect) {
    if app.tools.open == Some(Tool::Inspector) || !app.layout.is_card_open {
        return;
    }
    let (Some(picked), Some(snapshot), Some(info)) = (&app.picked, &app.shown.snapshot, &app.shown.info) else {
        return;
    };
    let (element, scene) = (picked.element, &info.scene);
    let (mut close, mut inspect) = (false, false);
    let at = rect.right_top() + egui::vec2(-10.0, 10.0);
    egui::Area::new(egui::Id::unique("picked")).pivot(Align2::RIGHT_TOP).fixed_pos(at).show(ui.ctx(), |ui| {
        theme::over_the_view(ui);
        let frame = egui::Frame::popup(ui.style()).fill(theme::PANEL.gamma_multiply(0.94)).inner_margin(10);
        frame.show(ui, |ui| {
            ui.set_width(WIDTH);
            ui.horizontal(|ui| {
                ui.label(RichText::new(words::SELECTED_ELEMENT).strong().size(14.0));
                ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
                    close = ui.button(words::CLOSE).on_hover_text("Deselect (Esc)").clicked();
                    let hint = "Open the inspector: all its links, and what holds it";
                    inspect = ui.button(words::INSPECT).on_hover_text(hint).clicked();
                });
            });
            if let Some(facts) = &app.tools.inspection.facts {
                show_facts(ui, facts);
            }
            if rect.width() >= WIDE_ENOUGH {
                show_sources(ui, &mut app.tools.inspection, snapshot, scene, element);
            }
        });
    });
    if close {
        app.deselect();
    }
    if inspect {
        app.tools.open = Some(Tool::Inspector);
    }
}

fn show_facts(ui: &mut Ui, facts: &Facts) {
    let or_dash = |text: &str| if text.is_empty() { "–".to_owned() } else { text.to_owned() };
    Grid::new("picked facts").num_columns(2).spacing([12.0, 3.0]).show(ui, |ui| {
        let mut row = |name: &str, value: RichText| {
            ui.label(theme::weak(name));
            ui.add(egui::Label::new(value).truncate());
            ui.end_row();
        };
        match (&facts.material, facts.polygon) {
            (Some(material), Some(polygon)) => {
                row("Material", RichText::new(material).strong());
                row("Group", RichText::new(or_dash(&facts.group)).strong());
                row("Polygon", theme::value(format::count(polygon)));
            }
            _ => row("Cluster of", theme::value(format::things(facts.polygons, "polygon", "polygons"))),
        }
        row("Area", theme::value(format::quantity(facts.area.into(), "m²")));
        match (facts.level, facts.depth) {
            (Some(level), _) => row("Level", theme::value(level.to_string())),
            (None, Some(depth)) => row("Level", theme::value(depth.to_string())),
            (None, None) => {}
        }
        row("E  W/m²", theme::value(colours(facts.irradiance)));
        row("B  W/m²", theme::value(colours(facts.radiosity)));
    });
}

fn colours(rgb: Vec3) -> String {
    rgb.to_array().map(|value| format!("{:>7}", format::number(value.into()))).join(" ")
}

fn show_sources(ui: &mut Ui, inspection: &mut Inspection, snapshot: &Snapshot, scene: &Scene, element: ElementId) {
    ui.separator();
    let Some(solution_view) = snapshot.solution_view.as_ref().filter(|solution_view| solution_view.holds(element))
    else {
        ui.label(theme::weak("Asking for its links…"));
        return;
    };
    let count = inspection.links.len();
    if count == 0 {
        ui.label("No link brings it light");
        return;
    }
    let links = format::things(count, "link", "links");
    let heading = format!("{}, E in W/m² ({links}):", words::TOP_SOURCES);
    ui.add(egui::Label::new(heading).wrap());
    let strongest: Vec<LinkView> = inspection.links.iter().take(MOST).copied().collect();
    Grid::new("sources").num_columns(2).spacing([12.0, 2.0]).show(ui, |ui| {
        for link in strongest {
            ui.label(theme::value(format!("{:>9}", format::number(link.irradiance.max_element().into()))));
            let name = name_of_source(inspection, solution_view, scene, &link);
            let details = format!(
                "{name}: {}; E {}, F = {}, V = {:.2}, {} to the whole receiver",
                whose(&link),
                colours(link.irradiance),
                format::number(link.form_factor.into()),
                link.visibility,
                format::quantity(link.power.into(), "W"),
            );
            ui.add(egui::Label::new(name).truncate()).on_hover_text(details);
            ui.end_row();
        }
    });
}

fn name_of_source(inspection: &mut Inspection, solution_view: &SolutionView, scene: &Scene, link: &LinkView) -> String {
    match link.source == link.receiver {
        true => "itself, among its parts".to_owned(),
        false => inspection.name(solution_view, scene, link.source).to_owned(),
    }
}

/// Whose link brings the light, seen from the inspected element.
pub(in crate::app) fn whose(link: &LinkView) -> String {
    whose_end(link.levels_up, link.receiver_is_cluster)
}

/// Whose link takes the light away, likewise.
pub(in crate::app) fn whose_light(link: &LinkView) -> String {
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
