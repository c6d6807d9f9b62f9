//! Requests of panels, tools and keys that others carry out: commands to the worker, and
//! actions of the window.

use egui::Context;
use glam::Vec3;

use crate::app::state::exports::Item;
use crate::app::state::messages::Topic;
use crate::app::state::settings::LinksOf;
use crate::app::tools::{Tool, compare, export};
use crate::app::{App, panels};
use crate::hierarchy::ElementId;
use crate::scene::{CameraPose, Reading};
use crate::worker::{Command, RunState};

/// Commands and actions that a frame gives rise to.
#[derive(Default)]
pub struct Outbox {
    pub commands: Vec<Command>,
    actions: Vec<Action>,
}

impl Outbox {
    /// Asks the worker for something.
    pub fn push(&mut self, command: Command) {
        self.commands.push(command);
    }

    /// Asks the worker for several things, or for none.
    pub fn extend(&mut self, commands: impl IntoIterator<Item = Command>) {
        self.commands.extend(commands);
    }

    /// Asks the window for something.
    pub fn act(&mut self, action: Action) {
        self.actions.push(action);
    }
}

/// Action of the window.
#[derive(Clone, Debug, PartialEq)]
pub enum Action {
    /// Selects an element, patch or cluster.
    Pick(ElementId),
    Deselect,
    /// Ends what goes on: the list of keys, the full screen, placing, or else the selection.
    Leave,
    ShowCard,
    /// Draws the links of the selection, or none.
    ToggleLinks,
    ToggleOutlines,
    ToggleKeys,
    ToggleFullScreen,
    ToggleSettings,
    ToggleTool(Tool),
    OpenTool(Tool),
    PauseOrRun,
    Step,
    Restart,
    /// Plays the solve slowly, with all that shows how the method works.
    Study,
    /// Keeps the solution in view as A.
    KeepAsA,
    Undo,
    Redo,
    /// Looks from elsewhere.
    GoTo(CameraPose),
    /// Turns the eye towards a point, unless that is in view.
    TurnTowards(Vec3),
    /// Opens the system's dialog for a scene.
    ChooseScene,
    /// Reads the scene in view again, in another way.
    Read(Reading),
    /// Reads the scene in view again, since its file has changed.
    Reload,
    /// Writes the settings file beside the scene; one that is there already only if it
    /// `overwrites`.
    SaveSettings {
        overwrites: bool,
    },
    Export(Item),
    /// Says something worth knowing.
    Note(Topic, String),
    /// Says that something cannot be done.
    Fail(Topic, String),
}

impl App {
    /// Does what was asked of the window since the last time.
    pub(super) fn perform(&mut self, ctx: &Context, outbox: &mut Outbox) {
        for action in std::mem::take(&mut outbox.actions) {
            self.perform_one(action, ctx, outbox);
        }
    }

    fn perform_one(&mut self, action: Action, ctx: &Context, outbox: &mut Outbox) {
        let run = self.shown.status.run;
        let Self { layout, tools, edits, view, .. } = self;
        match action {
            Action::Pick(id) => self.pick_element(id),
            Action::Leave if layout.are_keys_shown => layout.are_keys_shown = false,
            Action::Leave if layout.is_full_picture => self.toggle_full_screen(ctx),
            // What a click does comes back first, then what it chose.
            Action::Leave if tools.measuring.is_placing() => tools.measuring.stop_placing(),
            Action::Leave | Action::Deselect => self.deselect(),
            Action::ShowCard => layout.is_card_open = true,
            Action::ToggleLinks => {
                let of = &mut edits.display.links.of;
                *of = if *of == LinksOf::Picked { LinksOf::Nothing } else { LinksOf::Picked };
            }
            Action::ToggleOutlines => edits.display.show_elements = !edits.display.show_elements,
            Action::ToggleKeys => layout.are_keys_shown = !layout.are_keys_shown,
            Action::ToggleFullScreen => self.toggle_full_screen(ctx),
            Action::ToggleSettings => layout.toggle_settings(ctx, &mut tools.open),
            Action::ToggleTool(tool) => tools.open = (tools.open != Some(tool)).then_some(tool),
            Action::OpenTool(tool) => tools.open = Some(tool),
            Action::PauseOrRun => match run {
                RunState::Paused => outbox.push(Command::Resume),
                RunState::Running => outbox.push(Command::Pause),
                RunState::Idle | RunState::Finished => {}
            },
            Action::Step if matches!(run, RunState::Running | RunState::Paused) => outbox.push(Command::StepWave),
            Action::Restart if self.shown.info.is_some() => outbox.push(Command::Restart),
            Action::Step | Action::Restart => {}
            Action::Study => self.study(ctx),
            Action::KeepAsA => {
                if let Some(snapshot) = self.shown.snapshot.clone() {
                    let measured = compare::measured(&tools.comparison, &snapshot);
                    tools.pinned.keep(snapshot, edits.params, measured, view.exposure);
                    tools.open = Some(Tool::Compare);
                }
            }
            Action::Undo => self.undo(false, outbox),
            Action::Redo => self.undo(true, outbox),
            Action::GoTo(pose) => view.viewport.go_to(&pose),
            Action::TurnTowards(point) => view.viewport.turn_towards_unseen(point),
            Action::ChooseScene => self.documents.files.open_dialog(ctx),
            Action::Read(reading) => {
                let settings = self.settings();
                outbox.extend(settings.source().map(|source| Command::Load(source, reading, settings.light)));
            }
            Action::Reload => {
                let settings = self.settings();
                if let Some(source) = settings.source() {
                    outbox.push(Command::Load(source.clone(), settings.reading, settings.light));
                    self.documents.watch.note_reloading(source);
                }
            }
            Action::SaveSettings { overwrites } => match panels::scene::sidecar_of(&self.shown) {
                Some(path) if path.exists() && !overwrites => {
                    self.documents.files.sidecar_in_question = Some(path);
                }
                Some(_) => outbox.push(Command::SaveSidecar(self.kept())),
                None => {}
            },
            Action::Note(topic, sentence) => self.messages.note(topic, sentence),
            Action::Fail(topic, sentence) => self.messages.error(topic, sentence),
            Action::Export(item) => {
                let settings = self.settings();
                let viewport = &self.view.viewport;
                export::begin(&mut self.documents.exports, item, &self.shown, viewport, settings, &self.wake);
            }
        }
    }
}
