//! The bar below: what the solver is doing or what is known of its solution, how far it is, and the
//! counts that grow meanwhile.

use egui::{Color32, ProgressBar, Ui};

use crate::app::state::time_left::{Clock, Course, TICK};
use crate::app::view::gathering::Painted;
use crate::app::widgets::{rows, theme};
use crate::app::{Shown, format, words};
use crate::solve::{MemoryStop, Phase, Stats};
use crate::worker::{ErrorOfMesh, RunState, Status};

/// Least width of the sentence, points: what stands beside it keeps its place while it works.
const SENTENCE_WIDTH: f32 = 138.0;

/// Letters of the state of the gathered picture.
const PICTURE_LETTERS: usize = 16;

/// A sentence with its colour, and what helps.
struct Said {
    text: String,
    colour: Color32,
    hint: Option<String>,
}

/// Draws the bar.
pub fn show(
    ui: &mut Ui,
    (shown, is_view_dark): (&Shown, bool),
    painted: Option<&Painted>,
    course: &Course,
    clock: &Clock,
) {
    let more = clock.seconds();
    if more.is_some() {
        ui.ctx().request_repaint_after(TICK);
    }
    ui.add_space(2.0);
    ui.horizontal(|ui| {
        ui.set_min_height(22.0);
        let stats = shown.stats();
        let is_dark = shown.info.as_ref().is_some_and(|info| !info.has_light);
        let mut said = said(&shown.status, stats, is_dark, course.share(), ui.visuals().text_color());
        if is_view_dark && shown.status.run == RunState::Finished {
            // What is certified may all lie elsewhere.
            said =
                Said { text: format!("{}; {}", said.text, words::NOTHING_SEEN_IS_LIT), colour: theme::ACCENT, ..said };
        }
        rows::dot(ui, 10.0, said.colour);
        ui.scope(|ui| {
            ui.set_min_width(SENTENCE_WIDTH);
            let label = ui.add(egui::Label::new(said.text).truncate());
            if let Some(hint) = said.hint {
                label.on_hover_text(hint);
            }
        });
        let Some(stats) = stats else { return };
        let run = shown.status.run;
        if matches!(run, RunState::Running | RunState::Paused) {
            show_progress(ui, course.share());
        }
        let time_left = course.seconds(more.unwrap_or(0.0)).filter(|_| run == RunState::Running);
        if let Some(painted) = painted {
            show_cell(ui, words::PICTURE, &picture(painted));
        }
        for (name, value) in cells(stats, run, more.unwrap_or(0.0), time_left) {
            show_cell(ui, name, &value);
        }
    });
    ui.add_space(2.0);
}

/// Sentence on what the solver does, or on what is known of its solution, and no more than that.
fn said(status: &Status, stats: Option<&Stats>, is_dark: bool, share: f32, neutral: Color32) -> Said {
    let said = |text: String, colour| Said { text, colour, hint: None };
    if let Some(name) = &status.loading {
        return said(format!("Loading {name}"), theme::ACCENT);
    }
    let phase = || stats.map_or("Starting".to_owned(), |stats| phase(stats, share));
    match (status.run, stats) {
        (RunState::Idle, _) => said("Nothing to solve".into(), theme::TEXT_WEAK),
        (RunState::Running, _) => said(phase(), theme::ACCENT),
        (RunState::Paused, _) => said(format!("Paused: {}", phase()), theme::TEXT_WEAK),
        (RunState::Finished, _) if is_dark => said(words::NOTHING_EMITS.into(), theme::TEXT_WEAK),
        // The timeline shows a former step of a solve that has ended.
        (RunState::Finished, Some(stats)) if stats.phase != Phase::Done && stats.memory_stop.is_none() => {
            said(format!("{}: {}", words::FORMER_STEP, phase()), neutral)
        }
        (RunState::Finished, Some(stats)) => result(status, stats, neutral),
        (RunState::Finished, None) => said("Finished".into(), neutral),
    }
}

fn phase(stats: &Stats, share: f32) -> String {
    match stats.phase {
        Phase::Hierarchy => "Building clusters".to_owned(),
        // Between waves the stored links are tested again, since B has grown.
        Phase::Refine if stats.wave == 0 => format!("{}, pass {}", words::TESTING_LINKS, stats.iterations + 1),
        Phase::Refine => format!("Refining, wave {}", stats.wave),
        Phase::Gather => format!("Gathering, iteration {}", stats.iterations + 1),
        Phase::Reconstruct => format!("{}: {:.0} %", words::FINAL_GATHER, 100.0 * share),
        Phase::Done => "Done".to_owned(),
    }
}

/// Sentence on a finished solution.
fn result(status: &Status, stats: &Stats, neutral: Color32) -> Said {
    let within = |figure: String| format!("{} {figure} %", words::SURFACES_WITHIN);
    let percent = |share: f64| format::short(100.0 * share);
    let known = stats.error_estimate.map(|error| within(percent(error)));
    if let Some(stop) = stats.memory_stop {
        let error = known.unwrap_or_else(|| words::ERROR_NOT_MEASURED.into());
        let text = format!("{}: memory limit reached; {error}", words::STOPPED);
        return Said { text, colour: theme::ACCENT, hint: Some(memory_hint(stop)) };
    }
    match (stats.error_asked, stats.error_estimate) {
        (Some(asked), Some(found)) if found <= asked => Said {
            text: format!("{}: {}", words::TARGET_REACHED, within(percent(asked))),
            colour: theme::DONE,
            hint: Some(format!("Certified at random points with 95 % confidence: {}", within(percent(found)))),
        },
        (Some(asked), Some(found)) => Said {
            text: format!("{}: {}, target {} %", words::STOPPED, within(percent(found)), percent(asked)),
            colour: theme::ACCENT,
            hint: Some("A finer final gather lowers this error no further in this scene.".into()),
        },
        _ => {
            let error = match (known, status.mesh_error) {
                (Some(known), _) => format!(": {known}"),
                (None, ErrorOfMesh::Measured(found)) => {
                    format!(": {}", within(format::plus_minus(100.0 * found.p90, 100.0 * found.standard_error)))
                }
                (None, ErrorOfMesh::Measuring) => "; measuring the error".to_owned(),
                (None, ErrorOfMesh::Unknown) => format!("; {}", words::ERROR_NOT_MEASURED),
            };
            let hint = "No link exceeds the threshold ε any more. The error is that of the light shown, found at random points by a \
                        gather there; ± one standard error";
            Said { text: format!("{}{error}", words::LINKS_SETTLED), colour: neutral, hint: Some(hint.into()) }
        }
    }
}

/// Why a solve stopped, and what helps.
fn memory_hint(stop: MemoryStop) -> String {
    format!(
        "The memory limit is reached, and so {}. Raise the memory limit or the target error in the section Quality.",
        stop.in_words()
    )
}

fn show_progress(ui: &mut Ui, share: f32) {
    let name = format!("{} {:.0} %", words::PROGRESS, 100.0 * share);
    let response = ui.add(ProgressBar::new(share).desired_width(110.0).desired_height(6.0).fill(theme::ACCENT));
    response.widget_info(|| egui::WidgetInfo::labeled(egui::accesskit::Role::ProgressIndicator, true, &name));
    response.on_hover_text(&name);
}

/// How far the gathered picture is: it is worked on until its noise is below the target error. As
/// wide in all its states, so that nothing jumps.
fn picture(painted: &Painted) -> String {
    let percent = |share: f32| format::short(100.0 * f64::from(share));
    let noise = percent(painted.noise);
    let text = match painted.is_done {
        true => format!("noise {noise} %"),
        false => format!("noise {noise} → {} %", percent(painted.goal())),
    };
    format!("{text:<PICTURE_LETTERS$}")
}

fn cells(stats: &Stats, run: RunState, more_seconds: f64, time_left: Option<f64>) -> Vec<(&'static str, String)> {
    let mut cells = Vec::new();
    if let Some(seconds) = time_left {
        cells.push(("Left", format!("about {}", format::seconds(seconds))));
    }
    if run != RunState::Finished
        && let Some(error) = stats.error_so_far
    {
        cells.push(("Error so far", format!("{} %", format::number(100.0 * error))));
    }
    if stats.candidates_left > 0 {
        cells.push(("Links to test", format::count(stats.candidates_left)));
    }
    cells.extend([
        ("Time", format::seconds(stats.seconds.total + more_seconds)),
        ("Patches", format::count(stats.patches)),
        ("Links", format::count(stats.all_links())),
        ("Rays", format::count(stats.rays)),
        ("Clusters", format::count(stats.clusters)),
    ]);
    cells
}

/// A name and its value, left out where there is no more room: a cell cut in two is worse than
/// none.
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
