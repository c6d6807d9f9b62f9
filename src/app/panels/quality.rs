//! The quality section: how good the light is to be, and running, pausing and stepping. The fold
//! *Method* below it has the rest.

use egui::{Button, Ui};

use crate::app::actions::{Action, Outbox};
use crate::app::panels::parameters;
use crate::app::widgets::rows;
use crate::app::{Shown, format, words};
use crate::solve::{ParameterId, SolverParams, Stats, USUAL_ERROR};
use crate::worker::{Command, RunState};

/// Qualities with the target errors that they stand for.
const QUALITIES: [(&str, f64); 3] = [(words::DRAFT, 0.2), ("Good", USUAL_ERROR), ("Final", 0.02)];

/// Draws the section; a changed parameter goes out at once, the worker merges bursts.
pub fn show(ui: &mut Ui, shown: &Shown, params: &mut SolverParams, outbox: &mut Outbox) {
    let before = *params;
    show_qualities(ui, params);
    for id in [ParameterId::Error, ParameterId::Memory] {
        parameters::show_one(ui, id, params, shown.stats());
    }
    if *params != before {
        outbox.push(Command::SetParams(*params));
    }
    ui.add_space(4.0);
    show_transport(ui, shown.status.run, shown.info.is_some(), outbox);
}

/// Draws the fold of the method's parameters.
pub fn show_method(ui: &mut Ui, stats: Option<&Stats>, params: &mut SolverParams, outbox: &mut Outbox) {
    if parameters::show_method(ui, params, stats) {
        outbox.push(Command::SetParams(*params));
    }
}

fn show_qualities(ui: &mut Ui, params: &mut SolverParams) {
    rows::row(ui, "Quality level", |ui| {
        let choices = ui.horizontal(|ui| {
            for (name, error) in QUALITIES {
                let is_chosen = params.error == Some(error);
                let hint = format!("Target error {} %", format::short(100.0 * error));
                if ui.selectable_label(is_chosen, name).on_hover_text(hint).clicked() {
                    params.error = Some(error);
                }
            }
        });
        choices.response
    });
}

fn show_transport(ui: &mut Ui, run: RunState, has_scene: bool, outbox: &mut Outbox) {
    ui.horizontal_wrapped(|ui| {
        let (name, hint, command) = match run {
            RunState::Paused => (words::RUN, "Go on refining", Command::Resume),
            _ => (words::PAUSE, "Stop after the present step", Command::Pause),
        };
        let can_toggle = matches!(run, RunState::Running | RunState::Paused);
        if ui.add_enabled(can_toggle, Button::new(name).min_size(egui::vec2(56.0, 0.0))).on_hover_text(hint).clicked() {
            outbox.push(command);
        }
        let step = ui.add_enabled(can_toggle, Button::new(words::STEP_ONE_WAVE));
        if step.on_hover_text("Refine until the present wave ends, then pause").clicked() {
            outbox.push(Command::StepWave);
        }
        let restart = ui.add_enabled(has_scene, Button::new("Restart"));
        if restart.on_hover_text("Solve again from scratch").clicked() {
            outbox.push(Command::Restart);
        }
        let study = ui.add_enabled(has_scene, Button::new(words::STUDY));
        let hint = "Open the method's parameters, draw the links of a level, and replay the solve slowly from the root's self-link";
        if study.on_hover_text(hint).clicked() {
            outbox.act(Action::Study);
        }
    });
}
