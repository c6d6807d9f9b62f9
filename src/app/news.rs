//! News of the worker, taken up at the beginning of a frame.

use std::sync::Arc;

use crate::app::panels::light::LightEditor;
use crate::app::state::messages::Topic;
use crate::app::state::undo::History;
use crate::app::{App, tools};
use crate::worker::{Event, RunState, SceneInfo};

/// A scene whose first snapshot has not come yet.
pub struct Incoming {
    /// Facts about the scene.
    pub info: Arc<SceneInfo>,
    /// A new scene rather than an edit: the camera starts afresh.
    pub is_new: bool,
}

impl App {
    /// Takes up everything that the worker has to say.
    pub(super) fn take_up_news(&mut self, ctx: &egui::Context) {
        // Events before the snapshot: whoever has read the event of a scene finds that scene's
        // snapshot or an older one.
        while let Some(event) = self.worker.try_event() {
            self.take_up(event);
        }
        while let Ok(failure) = self.graphics.drawing_failures.try_recv() {
            self.messages.error(Topic::Drawing, format!("The view cannot be drawn: {failure}."));
        }
        self.shown.status = self.worker.status();
        self.tools.comparison.note(self.shown.snapshot.as_ref(), &self.shown.status.params);
        self.tools.pinned.note(self.shown.snapshot.as_ref(), &self.wake);
        self.documents.exports.poll();
        if let Some(sentence) = self.documents.watch.poll() {
            self.messages.note(Topic::Remark, sentence);
        }
        self.progress.clock.note(self.shown.status.run, false);
        let Some(latest) = self.worker.latest() else { return };
        if let Some(incoming) = self.incoming.take_if(|incoming| incoming.info.generation <= latest.generation) {
            self.adopt(ctx, incoming);
        } else if self.incoming.is_some() {
            return;
        }
        let is_newer = self.shown.snapshot.as_ref().is_none_or(|shown| !Arc::ptr_eq(shown, &latest));
        if is_newer {
            self.progress.course.note(&latest, &self.shown.status.params);
            self.progress.clock.note(self.shown.status.run, true);
            self.tools.playback.follow(&latest);
            self.follow_picked(&latest);
            self.shown.snapshot = Some(latest);
        }
        self.follow_measuring();
    }

    /// Shows the surveyor what is in view, and takes up what it found.
    fn follow_measuring(&mut self) {
        let Some(latest) = &self.shown.snapshot else { return };
        let in_view = self.view.best.follow(latest, self.shown.info.as_ref());
        if let Some(info) = &self.shown.info {
            let is_settled = matches!(self.shown.status.run, RunState::Finished | RunState::Paused);
            self.tools.measuring.note(&info.scene, &in_view, latest, is_settled);
        }
        self.shown.in_view = Some(in_view);
    }

    fn take_up(&mut self, event: Event) {
        match event {
            Event::SceneLoaded(info) => {
                if let Some(path) = &info.path {
                    self.documents.files.note_opened(path);
                }
                self.documents.opened.note(&info);
                self.messages.forget_errors();
                self.messages.resolve(Topic::Opening);
                self.incoming = Some(Incoming { info, is_new: true });
            }
            Event::SceneEdited(info) => {
                let known = self.shown.info.as_ref().map_or(&[][..], |shown| &shown.scene.skipped.notes[..]);
                for note in info.scene.skipped.notes.iter().filter(|note| !known.contains(note)) {
                    self.messages.note(Topic::Remark, note.clone());
                }
                let is_new = self.incoming.as_ref().is_some_and(|incoming| incoming.is_new);
                self.incoming = Some(Incoming { info, is_new });
            }
            Event::LoadFailed(sentence) => {
                self.documents.watch.forget_reload();
                self.messages.error(Topic::Opening, sentence);
            }
            Event::SolveFailed(sentence) => {
                self.messages.error(Topic::Solving, sentence);
                self.edits.params = self.worker.status().params;
                if let Some(info) = &self.shown.info {
                    self.edits.light.take_back_luminaires(&info.scene);
                }
                self.edits.history.take_as_given(self.undoable());
            }
            Event::Finished => {}
            Event::Saved(path) => {
                self.documents.watch.accept(&path);
                self.messages.note(Topic::Saving, format!("Saved {}.", path.display()));
            }
            Event::SaveFailed(sentence) => self.messages.error(Topic::Saving, sentence),
        }
    }

    /// Brings a scene into view whose first snapshot is there.
    fn adopt(&mut self, ctx: &egui::Context, incoming: Incoming) {
        let Incoming { info, is_new } = incoming;
        self.tools.comparison.follow_scene(&info.scene, is_new);
        if is_new {
            let title = format!("{} – Selflink", info.scene.name);
            ctx.send_viewport_cmd(egui::ViewportCommand::Title(title));
            let is_reload = self.documents.watch.take_reloading();
            self.documents.watch.start_with(&info, &self.wake);
            self.deselect();
            self.tools.clusters = tools::Clusters::default();
            self.tools.pinned.let_go();
            let former = self.shown.info.as_ref().map(|former| former.scene.name.as_str());
            self.documents.exports.suggest(&info.scene.name, former);
            if is_reload {
                self.view.viewport.go_on_with(&info.scene);
            } else {
                let first = self.documents.opened.camera.take().map(|camera| camera.in_scene(&info.scene));
                self.view.viewport.start_with(&info.scene, first);
                self.tools.measuring.start_with(&info.scene);
                // A correction made for another scene's light would make this one black or white.
                self.edits.display.auto_stops = 0.0;
            }
            self.edits.light = LightEditor::for_scene(&info.scene);
            self.edits.history = History::default();
            self.edits.history.take_as_given(self.undoable());
        }
        self.edits.light.follow(&info.scene);
        self.shown.info = Some(info);
    }
}
