//! The panels beside the view: the sections at the left, the bar below, and the dock at the right.

use egui::{CollapsingHeader, RichText, ScrollArea, Ui};

use crate::app::panels::{accuracy, appearance, controls, display, light, quality, scene, statistics, status_bar};
use crate::app::state::messages::Topic;
use crate::app::tools::{self, TOOLS, Tool};
use crate::app::widgets::theme;
use crate::app::{App, Outbox, layout, words};

impl App {
    /// The left panel with its sections and the bar below.
    pub(super) fn show_sides(&mut self, ui: &mut Ui, outbox: &mut Outbox) {
        egui::Panel::bottom("status").show(ui, |ui| {
            let has_light = self.shown.info.as_ref().is_some_and(|info| info.has_light);
            let is_view_dark = has_light && self.view.metering.is_dark();
            let (painted, progress) = (self.view.painted.as_ref(), &self.progress);
            status_bar::show(ui, (&self.shown, is_view_dark), painted, &progress.course, &progress.clock);
        });
        let sides = self.layout.sides(ui.ctx(), self.tools.open);
        let Some(most) = sides.settings else {
            self.layout.settings_width = 0.0;
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
                    ui.scope_builder(same, |ui| self.show_sections(ui, outbox));
                });
            });
        });
        self.layout.settings_width = shown.response.rect.width();
    }

    fn show_sections(&mut self, ui: &mut Ui, outbox: &mut Outbox) {
        let Self { shown, edits, view, tools, layout, .. } = self;
        section(ui, words::SCENE, true, None, |ui| scene::show(ui, shown, &mut self.documents.files, outbox));
        if let Some(info) = &shown.info {
            // A dark scene opens the section that helps, which stays open once there is light; with
            // a lamp it is one of many.
            let title = if info.has_light { words::LIGHT } else { "Light: none yet" };
            section(ui, title, edits.light.was_dark, Some("light"), |ui| {
                let eye = view.viewport.pose().map(|pose| pose.eye);
                light::show(ui, (shown, eye), &edits.params, &mut edits.light, outbox);
            });
        }
        section(ui, words::QUALITY, true, None, |ui| quality::show(ui, shown, &mut edits.params, outbox));
        // Who solves by ε wants to see the parameters.
        let (is_open, is_opened) = (edits.params.error.is_none(), std::mem::take(&mut layout.opens_method));
        let method = Fold { title: words::METHOD, is_open, id: Some("method"), is_opened };
        method.show(ui, |ui| quality::show_method(ui, shown.stats(), &mut edits.params, outbox));
        section(ui, words::DISPLAY, true, None, |ui| {
            display::show(ui, shown, &mut edits.display, view.reading.last().as_ref(), view.exposure);
        });
        if let Some(info) = &shown.info {
            let mut outcome = Ok(());
            section(ui, words::ACCURACY, false, None, |ui| {
                outcome = accuracy::show(ui, info, &mut tools.comparison, &self.wake);
            });
            if let Err(sentence) = outcome {
                self.messages.error(Topic::Reference, sentence);
            }
        }
        section(ui, words::STATISTICS, false, None, |ui| statistics::show(ui, shown));
        section(ui, words::APPEARANCE, false, None, |ui| appearance::show(ui, &mut layout.appearance));
        section(ui, words::MOUSE_AND_KEYS, false, None, |ui| controls::show(ui, &mut layout.are_keys_shown));
    }

    /// The open tool, if one is.
    pub(super) fn show_dock(&mut self, ui: &mut Ui, outbox: &mut Outbox) {
        let Self { shown, edits, view, tools, layout, .. } = self;
        let Some((open, name, hint)) = TOOLS.iter().find(|(tool, ..)| tools.open == Some(*tool)) else { return };
        let widths = tools::WIDTHS;
        let most = layout.sides(ui.ctx(), tools.open).all - layout.settings_width;
        let most = most.max(*widths.start()).min(*widths.end());
        let panel = egui::Panel::right(*name).default_size(open.first_width().min(most));
        panel.size_range(*widths.start()..=most).show(ui, |ui| {
            ui.horizontal(|ui| {
                ui.label(RichText::new(*name).strong().size(14.0)).on_hover_text(*hint);
                ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
                    if ui.button(words::CLOSE_TOOL).clicked() {
                        tools.open = None;
                    }
                });
            });
            ui.separator();
            let names = &mut tools.inspection.names;
            let scrolled = ScrollArea::vertical().auto_shrink([false, false]);
            match open {
                // These fill the dock and scroll by themselves.
                Tool::Inspector => {
                    let (inspector, inspection) = (&mut tools.inspector, &mut tools.inspection);
                    tools::inspector::show(ui, shown, inspector, inspection, &mut view.pointing, outbox);
                }
                Tool::Matrix => {
                    let (matrix, pointing) = (&mut tools.matrix, &mut view.pointing);
                    tools::matrix::show(ui, shown, matrix, names, pointing, &self.wake, outbox);
                }
                Tool::Clusters => tools::clusters::show(ui, shown, &mut tools.clusters, names, view, edits, outbox),
                Tool::Measure => {
                    let (measuring, messages) = (&mut tools.measuring, &mut self.messages);
                    scrolled.show(ui, |ui| tools::measure::show(ui, shown, measuring, messages, &self.wake));
                }
                Tool::Compare => {
                    let (pinned, comparison) = (&mut tools.pinned, &tools.comparison);
                    scrolled.show(ui, |ui| tools::compare::show(ui, shown, pinned, comparison, &edits.params, outbox));
                }
                Tool::Export => {
                    let (exports, pixels) = (&mut self.documents.exports, view.viewport.pixels());
                    scrolled.show(ui, |ui| tools::export::show(ui, shown, exports, pixels, outbox));
                }
            }
        });
    }
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
