//! The panels around the view: each takes what it shows and writes commands into the outbox.

pub(in crate::app) mod accuracy;
pub(in crate::app) mod appearance;
pub(in crate::app) mod controls;
pub(in crate::app) mod costs;
pub(in crate::app) mod display;
pub(in crate::app) mod empty;
pub(in crate::app) mod hint;
pub(in crate::app) mod legend;
pub(in crate::app) mod light;
pub(in crate::app) mod links;
pub(in crate::app) mod parameters;
pub(in crate::app) mod picked;
pub(in crate::app) mod quality;
mod readings;
pub(in crate::app) mod readout;
pub(in crate::app) mod scene;
pub(in crate::app) mod statistics;
pub(in crate::app) mod status_bar;
pub(in crate::app) mod step;
pub(in crate::app) mod tag;

use egui::{CollapsingHeader, RichText, ScrollArea, Ui};

use crate::app::state::messages::Topic;
use crate::app::widgets::theme;
use crate::app::{App, Outbox, layout, words};
use crate::worker::Command;

/// The left panel with its sections and the bar below.
pub(in crate::app) fn show_sides(app: &mut App, ui: &mut Ui, outbox: &mut Outbox) {
    egui::Panel::bottom("status").show(ui, |ui| {
        let is_view_dark = app.view.metering.is_dark() && app.shown.info.as_ref().is_some_and(|info| info.has_light);
        let (painted, progress) = (app.view.painted.as_ref(), &app.progress);
        status_bar::show(ui, (&app.shown, is_view_dark), painted, &progress.course, &progress.clock);
    });
    let sides = layout::Sides::of(app, ui.ctx());
    let Some(most) = sides.settings else {
        app.layout.settings_width = 0.0;
        return;
    };
    let widths = layout::LEAST_SETTINGS.min(most)..=most;
    // Where they have little room, beside a tool or in a small window, they keep the width that
    // they have otherwise for later.
    let id = if most < theme::PANEL_WIDTH { "narrow sections" } else { "sections" };
    let panel = egui::Panel::left(id).default_size(theme::PANEL_WIDTH.min(most)).size_range(widths);
    let shown = panel.show(ui, |ui| {
        ScrollArea::vertical().auto_shrink([false, false]).show(ui, |ui| {
            // Beside the scroll bar, which floats.
            egui::Frame::new().inner_margin(egui::Margin { right: 8, top: 4, bottom: 8, left: 0 }).show(ui, |ui| {
                // What is folded away is so in either.
                let same = egui::UiBuilder::new().scope_id(egui::Id::unique("settings"));
                ui.scope_builder(same, |ui| show_sections(app, ui, outbox));
            });
        });
    });
    app.layout.settings_width = shown.response.rect.width();
}

fn show_sections(app: &mut App, ui: &mut Ui, outbox: &mut Outbox) {
    let kept = app.kept();
    let mut chosen = scene::Chosen::default();
    section(ui, words::SCENE, true, None, |ui| {
        chosen = scene::show(ui, &app.shown, &mut app.documents.files, kept, outbox)
    });
    if let Some(pose) = chosen.view {
        app.view.viewport.go_to(&pose);
    }
    if let Some(info) = app.shown.info.clone() {
        // A dark scene opens the section that helps, which stays open once there is light; with a
        // lamp it is one of many.
        let dark = !info.has_light;
        let title = if dark { words::LIGHT_NONE_YET } else { words::LIGHT };
        section(ui, title, app.edits.light.was_dark, Some("light"), |ui| {
            let eye = app.view.viewport.pose().map(|pose| pose.eye);
            light::show(ui, (&app.shown, eye), &app.edits.params, &mut app.edits.light, outbox);
            if let Some(place) = app.edits.light.to_be_seen.take() {
                app.view.viewport.turn_towards_unseen(place);
            }
        });
    }
    let present = app.shown.info.as_ref().map(|info| &info.scene.reading);
    let reading = chosen.reading.or_else(|| app.edits.light.take_reading(present?));
    if let Some(reading) = reading {
        let settings = app.settings();
        outbox.extend(settings.source().map(|source| Command::Load(source, reading, settings.light)));
    }
    let mut asked = quality::Asked::default();
    section(ui, words::QUALITY, true, None, |ui| asked = quality::show(ui, &app.shown, &mut app.edits.params, outbox));
    if asked.study {
        app.study(ui.ctx());
    }
    // Who solves by ε wants to see the parameters.
    let (is_open, is_opened) = (app.edits.params.error.is_none(), std::mem::take(&mut app.layout.opens_method));
    let method = Fold { title: words::METHOD, is_open, id: Some("method"), is_opened };
    let stats = app.shown.snapshot.as_ref().map(|snapshot| &snapshot.stats);
    method.show(ui, |ui| quality::show_method(ui, stats, &mut app.edits.params, outbox));
    section(ui, words::DISPLAY, true, None, |ui| {
        display::show(ui, &app.shown, &mut app.edits.display, app.view.reading.last().as_ref(), app.view.exposure)
    });
    if let Some(info) = app.shown.info.clone() {
        let (comparison, wake) = (&mut app.tools.comparison, &app.wake);
        let mut outcome = Ok(());
        section(ui, words::ACCURACY, false, None, |ui| outcome = accuracy::show(ui, &info, comparison, wake));
        if let Err(sentence) = outcome {
            app.messages.error(Topic::Reference, sentence);
        }
    }
    section(ui, words::STATISTICS, false, None, |ui| statistics::show(ui, &app.shown));
    section(ui, words::APPEARANCE, false, None, |ui| appearance::show(ui, &mut app.layout.appearance));
    section(ui, words::MOUSE_AND_KEYS, false, None, |ui| controls::show(ui, &mut app.layout.are_keys_shown));
}

/// A section that can be folded away.
struct Fold<'a> {
    title: &'a str,
    /// Whether it is open at first.
    is_open: bool,
    /// Tells sections apart whose title changes.
    id: Option<&'a str>,
    /// Whether it is to be opened now.
    is_opened: bool,
}

impl Fold<'_> {
    fn show(self, ui: &mut Ui, contents: impl FnOnce(&mut Ui)) {
        let heading = RichText::new(self.title).strong().size(14.0);
        CollapsingHeader::new(heading)
            .id_salt((self.id.unwrap_or(self.title), self.is_open && self.id.is_some()))
            .default_open(self.is_open)
            .open(self.is_opened.then_some(true))
            .show_unindented(ui, |ui| {
                ui.add_space(2.0);
                contents(ui);
                ui.add_space(4.0);
            });
        ui.separator();
    }
}

/// A section as it was left.
fn section(ui: &mut Ui, title: &str, is_open: bool, id: Option<&str>, contents: impl FnOnce(&mut Ui)) {
    Fold { title, is_open, id, is_opened: false }.show(ui, contents);
}
