//! The solver section: run, pause, step, restart, and every parameter.

use egui::{Button, Ui};

use super::super::{Outbox, Shown};
use super::parameters;
use crate::solver::SolverParams;
use crate::worker::{Command, RunState};

/// Draws the section; a changed parameter goes out at once, the worker merges bursts.
pub(super) fn show(ui: &mut Ui, shown: &Shown, params: &mut SolverParams, outbox: &mut Outbox) {
    show_transport(ui, shown.status.run, shown.info.is_some(), outbox);
    ui.add_space(4.0);
    let stats = shown.snapshot.as_ref().map(|snapshot| &snapshot.stats);
    if parameters::show(ui, params, stats) {
        outbox.push(Command::SetParams(*params));
    }
}

fn show_transport(ui: &mut Ui, run: RunState, has_scene: bool, outbox: &mut Outbox) {
    ui.horizontal(|ui| {
        let (name, hint, command) = match run {
            RunState::Paused => ("Run", "Go on refining", Command::Resume),
            _ => ("Pause", "Stop after the present step", Command::Pause),
        };
        let can_toggle = matches!(run, RunState::Running | RunState::Paused);
        if ui.add_enabled(can_toggle, Button::new(name).min_size(egui::vec2(64.0, 0.0))).on_hover_text(hint).clicked() {
            outbox.push(command);
        }
        let step = ui.add_enabled(can_toggle, Button::new("Step one wave"));
        if step.on_hover_text("Refine until the present wave ends, then pause").clicked() {
            outbox.push(Command::StepWave);
        }
        let restart = ui.add_enabled(has_scene, Button::new("Restart"));
        if restart.on_hover_text("Solve afresh from the root's self-link").clicked() {
            outbox.push(Command::Restart);
        }
    });
}
