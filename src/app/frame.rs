//! A frame: news, panels and view, and the commands that come of them.

mod picture;
mod sides;

use std::path::PathBuf;

use crate::app::actions::Action;
use crate::app::state::messages::Topic;
use crate::app::state::{files, settings, undo, watch};
use crate::app::view::camera_menu;
use crate::app::widgets::dialog::DialogAnswer;
use crate::app::{App, DISPLAY_KEY, Outbox, RECENT_KEY, shortcuts, timeline, tools, words};
use crate::base::panic_report;
use crate::scene::Source;
use crate::worker::Command;

impl App {
    fn open_dropped_files(&mut self, ctx: &egui::Context, outbox: &mut Outbox) {
        let dropped: Vec<PathBuf> =
            ctx.input(|input| input.raw.dropped_files.iter().map(|file| file.path().to_owned()).collect());
        let Some((path, remark)) = files::choose_dropped(&dropped) else { return };
        outbox.push(Command::load(Source::File(path.to_owned())));
        if let Some(remark) = remark {
            self.messages.note(Topic::Remark, remark);
        }
    }
}

impl eframe::App for App {
    fn logic(&mut self, ctx: &egui::Context, _frame: &mut eframe::Frame) {
        self.take_up_news(ctx);
        self.layout.appearance.follow(ctx);
        if self.graphics.state.lost().is_some() {
            ctx.send_viewport_cmd(egui::ViewportCommand::Close);
        }
    }

    fn ui(&mut self, ui: &mut egui::Ui, _frame: &mut eframe::Frame) {
        let ctx = &ui.ctx().clone();
        let mut outbox = Outbox::default();
        self.open_dropped_files(ctx, &mut outbox);
        if let Some(answer) = self.documents.files.field.dialog.poll() {
            match answer {
                DialogAnswer::Chosen(path) => outbox.push(Command::load(Source::File(path))),
                DialogAnswer::NoDialog => self.messages.note(Topic::Opening, files::NO_DIALOG.into()),
            }
        }
        shortcuts::act(ctx, self.view.viewport.id(), &mut outbox);
        undo::take_keys(ctx, &mut outbox);
        self.perform(ctx, &mut outbox);
        self.inspect_picked(ctx);
        self.end_study();
        if !self.layout.is_full_picture {
            self.show_sides(ui, &mut outbox);
            self.perform(ctx, &mut outbox);
            egui::Panel::top("tools").show(ui, |ui| {
                ui.horizontal(|ui| {
                    let are_shown = self.layout.sides(ctx, self.tools.open).settings.is_some();
                    let settings = ui.selectable_label(are_shown, words::SETTINGS);
                    if settings.on_hover_text("Show or hide the panels at the left").clicked() {
                        outbox.act(Action::ToggleSettings);
                    }
                    camera_menu::show(ui, &mut self.view.viewport);
                    undo::show_buttons(ui, &self.edits.history, &self.undoable(), &mut outbox);
                    tools::show_bar(ui, self.tools.open, self.layout.are_keys_shown, &mut outbox);
                });
            });
            self.perform(ctx, &mut outbox);
            self.show_dock(ui, &mut outbox);
            self.perform(ctx, &mut outbox);
            timeline::show(ui, &self.shown, &mut self.tools.playback);
        }
        egui::CentralPanel::no_frame().show(ui, |ui| {
            ui.spacing_mut().item_spacing.y = 0.0;
            self.messages.show(ui);
            watch::show(ui, &mut self.documents.watch, &mut outbox);
            if let Some(clicked) = self.show_view(ui, &mut outbox) {
                self.pick(clicked);
            }
        });
        self.perform(ctx, &mut outbox);
        shortcuts::show_list(ctx, &mut self.layout.are_keys_shown);
        let links_wanted = match self.edits.display.links.of {
            settings::LinksOf::Level => true,
            settings::LinksOf::Picked => self.shown.picked.is_some(),
            settings::LinksOf::Nothing => self.layout.is_card_open && self.shown.picked.is_some(),
        };
        let wants_solution_view = links_wanted
            || self.view.clusters.is_active()
            || self.tools.open.is_some_and(tools::Tool::reads_solution_view);
        outbox.extend(self.tools.playback.command(wants_solution_view));
        self.view.pointing.end_frame(ctx);
        let is_busy = undo::is_busy(ctx);
        outbox.extend(self.edits.light.luminaires_command(is_busy));
        if !is_busy {
            let settings = self.undoable();
            self.edits.history.note(&settings);
        }
        if !outbox.commands.is_empty() {
            panic_report::note_settings(self.settings().to_json().unwrap_or_default());
        }
        for command in outbox.commands {
            if command.solves_anew() {
                self.messages.resolve(Topic::Solving);
            }
            if let Command::Load(source, _, light) = &command {
                self.documents.opened.ask(source, light);
                self.documents.watch.note_asked(source);
                // What was kept for the first scene is none of another one's.
                self.documents.opened.camera = None;
            }
            self.worker.send(command);
        }
    }

    fn save(&mut self, storage: &mut dyn eframe::Storage) {
        eframe::set_value(storage, RECENT_KEY, &self.documents.files.recent());
        eframe::set_value(storage, DISPLAY_KEY, &self.edits.display);
        self.layout.appearance.keep(storage);
        self.keep_session(storage);
    }
}
