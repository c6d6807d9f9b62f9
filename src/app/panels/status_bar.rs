//! The bar below: what the solver is doing, how far it is, and the counts that grow meanwhile.

use egui::{ProgressBar, Ui};

use super::super::gathering::Painted;
use super::super::time_left::{Clock, TICK, TimeLeft};
use super::super::{Shown, format, theme};
use crate::solver::{MemoryStop, Phase, Stats};
use crate::worker::RunState;

/// Draws the bar.
pub(super) fn show(ui: &mut Ui, shown: &Shown, painted: Option<&Painted>, time_left: &TimeLeft, clock: &Clock) {
    let more = clock.seconds();
    if more.is_some() {
        ui.ctx().request_repaint_after(TICK);
    }
    ui.add_space(2.0);
    ui.horizontal(|ui| {
        ui.set_min_height(22.0);
        let stats = shown.snapshot.as_ref().map(|snapshot| &snapshot.stats);
        let is_dark = shown.info.as_ref().is_some_and(|info| !info.has_light);
        let (text, colour) = state(shown.status.run, stats, is_dark);
        let (dot, _) = ui.allocate_exact_size(egui::vec2(10.0, 10.0), egui::Sense::hover());
        ui.painter().circle_filled(dot.center(), 4.0, colour);
        ui.scope(|ui| {
            ui.set_min_width(138.0);
            let label = ui.label(text);
            if let Some(stop) =
                stats.filter(|_| shown.status.run == RunState::Finished).and_then(|stats| stats.memory_stop)
            {
                label.on_hover_text(memory_hint(stop));
            }
        });
        let Some(stats) = stats else { return };
        show_progress(ui, shown.status.run, stats);
        let time_left = time_left.seconds().filter(|_| shown.status.run == RunState::Running);
        if let Some(painted) = painted {
            show_cell(ui, "picture", &picture(painted));
        }
        for (name, value) in cells(stats, more.unwrap_or(0.0), time_left) {
            show_cell(ui, name, &value);
        }
    });
    ui.add_space(2.0);
}

fn state(run: RunState, stats: Option<&Stats>, is_dark: bool) -> (String, egui::Color32) {
    let phase = stats.map(|stats| match stats.phase {
        Phase::Hierarchy => "Building clusters".to_owned(),
        // Between rounds the stored links are judged again, since B has grown.
        Phase::Refine if stats.wave == 0 => format!("Judging, round {}", stats.iterations + 1),
        Phase::Refine => format!("Refining, wave {}", stats.wave),
        Phase::Gather => "Gathering".to_owned(),
        Phase::Reconstruct => "Final gather".to_owned(),
        Phase::Done => "Done".to_owned(),
    });
    match run {
        RunState::Idle => ("Nothing to solve".into(), theme::TEXT_WEAK),
        RunState::Running => (phase.unwrap_or_else(|| "Starting".into()), theme::ACCENT),
        RunState::Paused => (format!("Paused: {}", phase.unwrap_or_default()), theme::TEXT_WEAK),
        RunState::Finished if is_dark => ("Nothing emits light".into(), theme::TEXT_WEAK),
        RunState::Finished => {
            if stats.is_some_and(|stats| stats.memory_stop.is_some()) {
                return ("Stopped: memory full".into(), theme::ACCENT);
            }
            let converged = stats.is_none_or(|stats| stats.converged);
            let missed = stats.and_then(|stats| stats.error_estimate.filter(|error| Some(*error) > stats.error_asked));
            if let Some(error) = missed {
                return (format!("Reached {} % only", format::number(100.0 * error)), theme::ACCENT);
            }
            (if converged { "Converged" } else { "Finished" }.into(), theme::DONE)
        }
    }
}

/// Why a solve stopped, and what helps.
fn memory_hint(stop: MemoryStop) -> String {
    format!(
        "The memory budget is used up, and so {}. Give more memory in the solver's parameters, or ask for a larger error.",
        stop.in_words()
    )
}

fn show_progress(ui: &mut Ui, run: RunState, stats: &Stats) {
    let share = match run {
        RunState::Finished => Some(1.0),
        _ => stats.progress,
    };
    let bar = ProgressBar::new(share.unwrap_or(0.0)).desired_width(110.0).desired_height(6.0).fill(theme::ACCENT);
    let response = ui.add(bar);
    let name = share.map_or("Progress not known".to_owned(), |share| format!("Progress {:.0} %", 100.0 * share));
    let _ = response.on_hover_text(name);
}

/// How far the gathered picture is.
fn picture(Painted { noise, is_done, .. }: &Painted) -> String {
    let noise = format::number(100.0 * f64::from(*noise));
    if *is_done { format!("noise {noise} %") } else { format!("noise {noise} % …") }
}

fn cells(stats: &Stats, more_seconds: f64, time_left: Option<f64>) -> Vec<(&'static str, String)> {
    let mut cells = vec![
        ("time", format::seconds(stats.seconds.total + more_seconds)),
        ("patches", format::count(stats.patches)),
        ("links", format::count(stats.links)),
        ("candidates", format::count(stats.candidates_left)),
        ("rays", format::count(stats.rays)),
        ("clusters", format::count(stats.clusters)),
    ];
    if let Some(error) = stats.error_estimate {
        cells.insert(1, ("error", format!("{} %", format::number(100.0 * error))));
    }
    if let Some(seconds) = time_left {
        cells.insert(1, ("left in round", format!("about {}", format::seconds(seconds))));
    }
    cells
}

/// A name and its value, left out where there is no more room: a cell cut in two is worse than none.
fn show_cell(ui: &mut Ui, name: &str, value: &str) {
    let font = egui::TextStyle::Monospace.resolve(ui.style());
    let letters = value.chars().count().max(7) as f32;
    let value_width = letters * ui.ctx().fonts_mut(|fonts| fonts.glyph_width(&font, '0'));
    let name_font = egui::TextStyle::Body.resolve(ui.style());
    let name_width: f32 = name.chars().map(|c| ui.ctx().fonts_mut(|fonts| fonts.glyph_width(&name_font, c))).sum();
    if ui.available_width() < value_width + name_width + 24.0 {
        return;
    }
    ui.add_space(8.0);
    ui.spacing_mut().item_spacing.x = 5.0;
    ui.label(theme::weak(name));
    ui.add_sized([value_width, 18.0], egui::Label::new(theme::value(value)).halign(egui::Align::Min));
}
