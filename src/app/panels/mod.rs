//! The panels around the view: each takes what it shows and writes commands into the outbox.

pub(super) mod accuracy;
pub(super) mod appearance;
pub(super) mod controls;
pub(super) mod costs;
pub(super) mod display;
pub(super) mod empty;
pub(super) mod hint;
pub(super) mod legend;
pub(super) mod light;
pub(super) mod links;
pub(super) mod parameters;
pub(super) mod picked;
mod readings;
pub(super) mod readout;
pub(super) mod scene;
pub(super) mod solver;
pub(super) mod statistics;
pub(super) mod status_bar;

use egui::{CollapsingHeader, RichText, ScrollArea, Ui};

use super::{App, Outbox, theme};
use crate::worker::Command;

/// The left panel with its sections and the bar below.
pub(super) fn show_sides(app: &mut App, ui: &mut Ui, outbox: &mut Outbox) {
    egui::Panel::bottom("status").show(ui, |ui| {
        status_bar::show(ui, &app.shown, app.painted.as_ref(), &app.time_left, &app.clock);
    });
    egui::Panel::left("sections").default_size(theme::PANEL_WIDTH).size_range(300.0..=480.0).show(ui, |ui| {
        ScrollArea::vertical().auto_shrink([false, false]).show(ui, |ui| {
            // Beside the scroll bar, which floats.
            egui::Frame::new().inner_margin(egui::Margin { right: 8, top: 4, bottom: 8, left: 0 }).show(ui, |ui| {
                show_sections(app, ui, outbox);
            });
        });
    });
}

fn show_sections(app: &mut App, ui: &mut Ui, outbox: &mut Outbox) {
    let camera = app.view.pose();
    let mut chosen = scene::Chosen::default();
    section(ui, "Scene", true, None, |ui| chosen = scene::show(ui, &app.shown, &mut app.files, camera, outbox));
    if let Some(pose) = chosen.view {
        app.view.go_to(&pose);
    }
    if let Some(info) = app.shown.info.clone() {
        // A dark scene opens the section that helps; with a lamp it is one of many.
        let dark = !info.has_light;
        let title = if dark { "Light: none yet" } else { "Light" };
        section(ui, title, dark, Some("light"), |ui| {
            light::show(ui, &app.shown, &app.params, &mut app.light, outbox);
        });
    }
    let present = app.shown.info.as_ref().map(|info| &info.scene.reading);
    let reading = chosen.reading.or_else(|| {
        let material = app.light.take_opaque()?;
        let mut reading = present?.clone();
        reading.opaque.push(material);
        Some(reading)
    });
    if let Some(reading) = reading {
        let settings = app.settings();
        outbox.extend(settings.source().map(|source| Command::Load(source, reading, settings.light)));
    }
    section(ui, "Solver", true, None, |ui| solver::show(ui, &app.shown, &mut app.params, outbox));
    section(ui, "Display", true, None, |ui| {
        display::show(ui, &app.shown, &mut app.display, app.reading.last().as_ref())
    });
    if let Some(info) = app.shown.info.clone() {
        let (comparison, wake) = (&mut app.comparison, &app.wake);
        let mut outcome = Ok(());
        section(ui, "Accuracy", false, None, |ui| outcome = accuracy::show(ui, &info, comparison, wake));
        if let Err(sentence) = outcome {
            app.messages.error(sentence);
        }
    }
    section(ui, "Statistics", false, None, |ui| statistics::show(ui, &app.shown));
    section(ui, "Appearance", false, None, |ui| appearance::show(ui, &mut app.appearance));
    section(ui, "Mouse and keys", false, None, |ui| controls::show(ui, &mut app.are_keys_shown));
}

/// A section that can be folded away; `id` tells sections apart whose title changes.
fn section(ui: &mut Ui, title: &str, is_open: bool, id: Option<&str>, contents: impl FnOnce(&mut Ui)) {
    let heading = RichText::new(title).strong().size(14.0);
    CollapsingHeader::new(heading)
        .id_salt((id.unwrap_or(title), is_open && id.is_some()))
        .default_open(is_open)
        .show_unindented(ui, |ui| {
            ui.add_space(2.0);
            contents(ui);
            ui.add_space(4.0);
        });
    ui.separator();
}
