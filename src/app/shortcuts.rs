//! Keyboard shortcuts: one table that is acted upon and shown.
//!
//! Keys that move the camera belong to [`crate::app::view::viewport`]; the list shows them too.

use egui::{Context, Event, Grid, Id, Key, Modifiers, RichText, Ui};

use crate::app::actions::{Action, Outbox};
use crate::app::tools::Tool;
use crate::app::widgets::theme;
use crate::app::{panels, words};

/// A key with its modifiers, how it is written, and what it does, in words and as an action.
type Shortcut = (Key, Modifiers, &'static str, &'static str, Action);

const SHORTCUTS: [Shortcut; 15] = [
    (Key::Space, Modifiers::NONE, "Space", "pause, run", Action::PauseOrRun),
    (Key::Period, Modifiers::NONE, ".", "step one wave", Action::Step),
    (Key::R, Modifiers::COMMAND, "Ctrl R", "solve again from scratch", Action::Restart),
    (Key::O, Modifiers::COMMAND, "Ctrl O", "open a scene", Action::ChooseScene),
    (Key::Num1, Modifiers::NONE, "1", "inspector", Action::ToggleTool(Tool::Inspector)),
    (Key::Num2, Modifiers::NONE, "2", "link matrix", Action::ToggleTool(Tool::Matrix)),
    (Key::Num3, Modifiers::NONE, "3", "clusters", Action::ToggleTool(Tool::Clusters)),
    (Key::Num4, Modifiers::NONE, "4", "measure", Action::ToggleTool(Tool::Measure)),
    (Key::Num5, Modifiers::NONE, "5", "compare", Action::ToggleTool(Tool::Compare)),
    (Key::Num6, Modifiers::NONE, "6", "export", Action::ToggleTool(Tool::Export)),
    (Key::X, Modifiers::NONE, "X", "keep the solution as A", Action::KeepAsA),
    (Key::O, Modifiers::NONE, "O", "element outlines", Action::ToggleOutlines),
    (Key::F11, Modifiers::NONE, "F11", "full screen, the picture alone", Action::ToggleFullScreen),
    (Key::Questionmark, Modifiers::NONE, "?", "this list", Action::ToggleKeys),
    (Key::Escape, Modifiers::NONE, "Esc", "deselect, end placing and drawing, leave full screen", Action::Leave),
];

/// Size of the list, points: egui would find it only after some frames.
const LIST_WIDTH: f32 = 670.0;
const LIST_HEIGHT: f32 = 430.0;

/// Shortcut that egui handles by itself.
const SCALING: (&str, &str) = ("Ctrl + − 0", "interface larger, smaller, as it was");

/// Asks for what the keys of this frame do; not while a text is being typed.
pub fn act(ctx: &Context, view: Option<Id>, outbox: &mut Outbox) {
    if ctx.text_edit_focused() {
        return;
    }
    let pressed = |input: &egui::InputState| -> Vec<Action> { input.events.iter().filter_map(action_of).collect() };
    // Space presses the button that has the focus.
    let is_view_focused = ctx.memory(|memory| memory.focused()).is_none_or(|focused| view == Some(focused));
    let is_meant = |action: &Action| *action != Action::PauseOrRun || is_view_focused;
    ctx.input(pressed).into_iter().filter(is_meant).for_each(|action| outbox.act(action));
}

fn action_of(event: &Event) -> Option<Action> {
    let Event::Key { key, pressed: true, repeat: false, modifiers, .. } = event else { return None };
    let fits = |(of, with, ..): &&Shortcut| of == key && with.command == modifiers.command && !modifiers.alt;
    SHORTCUTS.iter().find(fits).map(|(.., action)| action.clone())
}

/// The list of all keys, over everything, while it is asked for.
pub fn show_list(ctx: &Context, is_open: &mut bool) {
    egui::Window::new(words::MOUSE_AND_KEYS)
        .id(egui::Id::unique("keys"))
        .open(is_open)
        .collapsible(false)
        .resizable(false)
        .anchor(egui::Align2::CENTER_CENTER, [0.0, 0.0])
        .default_width(LIST_WIDTH)
        .min_width(LIST_WIDTH)
        .show(ctx, |ui| {
            ui.set_min_size(egui::vec2(LIST_WIDTH, LIST_HEIGHT));
            egui::Frame::new().inner_margin(8).show(ui, |ui| {
                ui.horizontal_top(|ui| {
                    column(ui, "In the view", &panels::controls::CONTROLS);
                    ui.add_space(24.0);
                    let keys = SHORTCUTS.iter().map(|(_, _, key, effect, _)| (*key, *effect)).chain([SCALING]);
                    column(ui, "Anywhere", &keys.collect::<Vec<_>>());
                });
            });
        });
}

fn column(ui: &mut Ui, title: &str, rows: &[(&str, &str)]) {
    ui.vertical(|ui| {
        ui.label(RichText::new(title).strong());
        ui.add_space(4.0);
        Grid::new(title).num_columns(2).spacing([16.0, 4.0]).show(ui, |ui| {
            for (key, effect) in rows {
                ui.label(theme::value(*key));
                ui.label(*effect);
                ui.end_row();
            }
        });
    });
}

#[cfg(test)]
mod tests {
    use super::*;

    fn press(key: Key, modifiers: Modifiers) -> Option<Action> {
        action_of(&Event::Key { key, physical_key: None, pressed: true, repeat: false, modifiers })
    }

    /// Every shortcut of the table is found by its own keys, so none hides another, and none takes
    /// a key that flies.
    #[test]
    fn each_key_does_one_thing() {
        for (key, modifiers, name, _, action) in SHORTCUTS {
            assert_eq!(press(key, modifiers), Some(action), "{name}");
            let flies = [Key::W, Key::A, Key::S, Key::D, Key::Q, Key::E, Key::F, Key::Home].contains(&key);
            assert!(!flies, "{name} moves the camera");
        }
        assert_eq!(press(Key::Questionmark, Modifiers::SHIFT), Some(Action::ToggleKeys));
        assert_eq!(press(Key::R, Modifiers::NONE), None);
        assert_eq!(press(Key::Num1, Modifiers::COMMAND), None);
    }
}
