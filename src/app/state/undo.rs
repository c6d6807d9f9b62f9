//! Undo and redo of settings: the solver's parameters, the display, lamps and materials, daylight,
//! the task area.
//!
//! A drag of a slider is one step, however many values it passes: what is set is looked at when the
//! pointer and all keys are let go. The camera and what is picked are no settings.

use egui::{Button, Context, Key, KeyboardShortcut, Modifiers, Ui};

use crate::app::actions::{Action, Outbox};
use crate::app::state::lighting::Lighting;
use crate::app::state::settings::DisplaySettings;
use crate::app::{App, words};
use crate::scene::TaskArea;
use crate::scene::outside::Daylight;
use crate::solve::SolverParams;
use crate::worker::Command;

/// Steps that are remembered.
const MOST_STEPS: usize = 200;

const UNDO: KeyboardShortcut = KeyboardShortcut::new(Modifiers::COMMAND, Key::Z);
const REDO: KeyboardShortcut = KeyboardShortcut::new(Modifiers::COMMAND.plus(Modifiers::SHIFT), Key::Z);

/// All that can be undone, as it stood at one time.
#[derive(Clone, Debug, PartialEq)]
pub struct Undoable {
    params: SolverParams,
    display: DisplaySettings,
    lighting: Lighting,
    daylight: Daylight,
    task_area: Option<TaskArea>,
}

impl Undoable {
    /// Name of the first setting that differs, for a person.
    fn difference(&self, other: &Self) -> &'static str {
        if self.params != other.params {
            "the solver's parameters"
        } else if self.lighting.luminaires != other.lighting.luminaires {
            "luminaires"
        } else if self.lighting != other.lighting {
            "lamps and materials"
        } else if self.daylight != other.daylight {
            "daylight"
        } else if self.task_area != other.task_area {
            "the task area"
        } else {
            "the display"
        }
    }
}

/// Former settings, and those that were undone.
#[derive(Default)]
pub struct History {
    /// As it stood when everything was last let go.
    now: Option<Undoable>,
    past: Vec<Undoable>,
    future: Vec<Undoable>,
}

impl History {
    /// Takes up what is set now as a new step, if it differs.
    pub fn note(&mut self, settings: &Undoable) {
        let is_new = self.now.as_ref() != Some(settings);
        if is_new && let Some(former) = self.now.replace(settings.clone()) {
            self.past.push(former);
            self.future.clear();
            if self.past.len() > MOST_STEPS {
                self.past.remove(0);
            }
        }
    }

    /// Takes what is set now as no person's doing: there is nothing to undo.
    pub fn take_as_given(&mut self, settings: Undoable) {
        self.now = Some(settings);
    }

    /// Takes the last change back, or makes the one again that was taken back last.
    fn step(&mut self, again: bool, settings: Undoable) -> Option<Undoable> {
        // A drag that is not over yet is a step too.
        self.note(&settings);
        let (from, to) = if again { (&mut self.future, &mut self.past) } else { (&mut self.past, &mut self.future) };
        self.now = Some(from.pop()?);
        to.push(settings);
        self.now.clone()
    }
}

impl App {
    /// All that can be undone, as it stands.
    pub(in crate::app) fn undoable(&self) -> Undoable {
        Undoable {
            params: self.edits.params,
            display: self.edits.display.clone(),
            lighting: self.edits.light.lighting.clone(),
            daylight: self.edits.light.daylight.spec.clone(),
            task_area: self.tools.measuring.task_area(),
        }
    }

    /// Takes the last change back, or makes the one again that was taken back last.
    pub(in crate::app) fn undo(&mut self, again: bool, outbox: &mut Outbox) {
        let settings = self.edits.history.step(again, self.undoable());
        let Some(Undoable { params, display, lighting, daylight, task_area }) = settings else { return };
        if params != self.edits.params {
            outbox.push(Command::SetParams(params));
        }
        outbox.extend(lighting.commands_since(&self.edits.light.lighting));
        // The worker hears of luminaires at the end of the frame.
        self.edits.light.lighting = lighting;
        if daylight != self.edits.light.daylight.spec {
            self.edits.light.daylight.spec.clone_from(&daylight);
            outbox.push(Command::SetDaylight(daylight));
        }
        (self.edits.params, self.edits.display) = (params, display);
        if task_area != self.tools.measuring.task_area()
            && let Some(info) = &self.shown.info
        {
            self.tools.measuring.set_task_area(task_area, info.scene.up_axis());
        }
    }
}

/// Ctrl+Z and Ctrl+Shift+Z, unless text is being typed.
pub fn take_keys(ctx: &Context, outbox: &mut Outbox) {
    if ctx.text_edit_focused() {
        return;
    }
    // The longer one first: a shortcut does not mind further modifiers.
    if ctx.input_mut(|input| input.consume_shortcut(&REDO)) {
        outbox.act(Action::Redo);
    } else if ctx.input_mut(|input| input.consume_shortcut(&UNDO)) {
        outbox.act(Action::Undo);
    }
}

/// The two buttons.
pub fn show_buttons(ui: &mut Ui, history: &History, settings: &Undoable, outbox: &mut Outbox) {
    let past = history.past.last().map(|former| former.difference(settings));
    let future = history.future.last().map(|later| later.difference(settings));
    let button = |ui: &mut Ui, [name, nothing]: [&str; 2], what: Option<&str>, shortcut: &KeyboardShortcut| {
        let keys = ui.ctx().format_shortcut(shortcut);
        let response = ui.add_enabled(what.is_some(), Button::new(name));
        let response = match what {
            Some(what) => response.on_hover_text(format!("{name} the last change of {what} ({keys})")),
            None => response.on_disabled_hover_text(format!("{nothing} ({keys})")),
        };
        response.clicked()
    };
    if button(ui, [words::UNDO, "Nothing to undo"], past, &UNDO) {
        outbox.act(Action::Undo);
    }
    if button(ui, [words::REDO, "Nothing to redo"], future, &REDO) {
        outbox.act(Action::Redo);
    }
}

/// Whether a person is in the middle of setting something.
pub fn is_busy(ctx: &Context) -> bool {
    ctx.egui_is_using_pointer()
        || ctx.text_edit_focused()
        || ctx.input(|input| input.pointer.any_down() || !input.keys_down.is_empty())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn with_level(cluster_level: u16) -> Undoable {
        let display = DisplaySettings { cluster_level, ..DisplaySettings::default() };
        Undoable {
            params: SolverParams::default(),
            display,
            lighting: Lighting::default(),
            daylight: Daylight::default(),
            task_area: None,
        }
    }

    /// Truth: a list of what was set, walked back and forth; a new change ends what could be
    /// redone.
    #[test]
    fn steps_are_taken_back_and_made_again() {
        let mut history = History::default();
        for level in [1, 2, 2, 3] {
            history.note(&with_level(level));
        }
        assert_eq!(history.step(false, with_level(3)), Some(with_level(2)));
        assert_eq!(history.step(false, with_level(2)), Some(with_level(1)));
        assert_eq!(history.step(false, with_level(1)), None);
        assert_eq!(history.step(true, with_level(1)), Some(with_level(2)));
        history.note(&with_level(7));
        assert_eq!(history.step(true, with_level(7)), None);
        assert_eq!(history.step(false, with_level(7)), Some(with_level(2)));
    }

    /// Truth: settings that the program makes by itself are neither a step nor undone.
    #[test]
    fn what_is_given_is_no_step() {
        let mut history = History::default();
        history.take_as_given(with_level(1));
        history.take_as_given(with_level(2));
        assert_eq!(history.step(false, with_level(2)), None);
    }
}
