//! The card of the picked element, over the view's corner: what it is, how it is lit and by what.

use egui::{Align2, Grid, Rect, RichText, Ui};

use super::super::picked::PickedElement;
use super::super::sources::NamedSource;
use super::super::{App, format, theme};
use crate::scene::Scene;
use crate::solver::Snapshot;

/// Width of the card, points.
const WIDTH: f32 = 288.0;

/// Draws the card; nothing when nothing is picked.
pub(in super::super) fn show(app: &mut App, ui: &mut Ui, rect: Rect) {
    let (Some(picked), Some(snapshot), Some(info)) = (&app.picked, &app.shown.snapshot, &app.shown.info) else {
        return;
    };
    let mut close = false;
    let at = rect.right_top() + egui::vec2(-10.0, 10.0);
    egui::Area::new(egui::Id::unique("picked")).pivot(Align2::RIGHT_TOP).fixed_pos(at).show(ui.ctx(), |ui| {
        let frame = egui::Frame::popup(ui.style()).fill(theme::PANEL.gamma_multiply(0.94)).inner_margin(10);
        frame.show(ui, |ui| {
            ui.set_width(WIDTH);
            ui.horizontal(|ui| {
                ui.label(RichText::new("Picked element").strong().size(14.0).color(theme::TEXT_STRONG));
                ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
                    close = ui.button("Close").on_hover_text("Let go of the element").clicked();
                });
            });
            show_facts(ui, picked, snapshot, &info.scene);
            show_sources(ui, picked, snapshot);
        });
    });
    if close {
        app.picked = None;
    }
}

fn show_facts(ui: &mut Ui, picked: &PickedElement, snapshot: &Snapshot, scene: &Scene) {
    let leaf = &picked.leaf;
    let material = scene.materials.get(leaf.material.0 as usize).map_or("–", |material| material.name.as_str());
    let group = scene.polygons.get(leaf.polygon as usize).map(|polygon| scene.group_path(polygon.group));
    let group = group.filter(|path| !path.is_empty()).unwrap_or_else(|| "–".into());
    Grid::new("picked facts").num_columns(2).spacing([12.0, 3.0]).show(ui, |ui| {
        let mut row = |name: &str, value: RichText| {
            ui.label(theme::weak(name));
            ui.add(egui::Label::new(value).truncate());
            ui.end_row();
        };
        row("material", RichText::new(material).color(theme::TEXT_STRONG));
        row("group", RichText::new(group).color(theme::TEXT_STRONG));
        row("polygon", theme::value(format::count(leaf.polygon)));
        row("area", theme::value(format::quantity(leaf.area.into(), "m²")));
        row("level", theme::value(leaf.level.to_string()));
        row("E  W/m²", theme::value(colours(snapshot.leaf_irradiance.get(picked.index))));
        row("B  W/m²", theme::value(colours(snapshot.leaf_radiosity.get(picked.index))));
    });
}

fn colours(rgb: Option<&[f32; 3]>) -> String {
    rgb.map_or("–".into(), |rgb| rgb.map(|value| format!("{:>7}", format::number(value.into()))).join(" "))
}

fn show_sources(ui: &mut Ui, picked: &PickedElement, snapshot: &Snapshot) {
    ui.separator();
    if snapshot.anatomy.is_none() {
        ui.label(theme::weak("Asking for its links…"));
        return;
    }
    let count = picked.link_count;
    if count == 0 {
        ui.label("No link brings it light");
        return;
    }
    let links = format::things(count, "link", "links");
    let heading = format!("E by source, W/m² ({links} of it and of all that holds it; the strongest):");
    ui.add(egui::Label::new(heading).wrap());
    Grid::new("sources").num_columns(2).spacing([12.0, 2.0]).show(ui, |ui| {
        for source in &picked.sources {
            let NamedSource { link, name } = source;
            ui.label(theme::value(format!("{:>9}", format::number(link.irradiance.max_element().into()))));
            let details = format!(
                "{name}: {}; E {}, F = {}, V = {:.2}, {} to the whole receiver",
                source.receiver(),
                colours(Some(&link.irradiance.to_array())),
                format::number(link.form_factor.into()),
                link.visibility,
                format::quantity(link.power.into(), "W"),
            );
            ui.add(egui::Label::new(name.as_str()).truncate()).on_hover_text(details);
            ui.end_row();
        }
    });
}
