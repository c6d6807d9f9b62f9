//! The accuracy section: a reference made in the background, the error of the picture by it, and a
//! chart of error over time.

use std::sync::Arc;

use egui::{Color32, ProgressBar, Slider, Ui};
use egui_plot::{FilledArea, Line, Plot, PlotPoints, Points};

use crate::app::state::comparison::{Comparison, POINTS, Run, RunPoint, Shading};
use crate::app::widgets::{rows, theme};
use crate::app::{Wake, format, words};
use crate::measure::accuracy::SolutionError;
use crate::measure::reference::LEAST_PASSES;
use crate::measure::reference_worker::GOAL;
use crate::worker::SceneInfo;

/// Height of the chart, points.
const CHART_HEIGHT: f32 = 170.0;
/// Errors below this are drawn there: a logarithm has no zero.
const LEAST_ERROR: f64 = 1e-3;

/// Draws the section; a sentence where a reference was asked for and cannot be made.
pub fn show(ui: &mut Ui, info: &Arc<SceneInfo>, comparison: &mut Comparison, wake: &Wake) -> Result<(), String> {
    let outcome = match comparison.report().is_active {
        true => {
            show_reference(ui, comparison);
            Ok(())
        }
        false => show_offer(ui, info, comparison, wake),
    };
    if let Some(error) = comparison.error() {
        show_error(ui, error);
        show_shading(ui, &mut comparison.shading);
    }
    if !comparison.runs().is_empty() {
        show_chart(ui, comparison.runs());
        if comparison.runs().len() > 1 && ui.button("Forget earlier curves").clicked() {
            comparison.forget_runs();
        }
    }
    outcome
}

fn show_offer(ui: &mut Ui, info: &Arc<SceneInfo>, comparison: &mut Comparison, wake: &Wake) -> Result<(), String> {
    ui.label(theme::weak("How far is this picture from the truth? A path tracer finds out in the background."));
    let slider = Slider::new(&mut comparison.points, POINTS).logarithmic(true);
    let hint = "Points on the surfaces that are compared; more of them show errors in finer detail";
    rows::widget(ui, "Points", slider, hint);
    let can_compare = info.has_light;
    let button = ui.add_enabled(can_compare, egui::Button::new(words::COMPARE_WITH_REFERENCE));
    if button.on_disabled_hover_text("Nothing in this scene emits light").clicked() {
        let begun = comparison.begin(&info.scene, wake);
        return begun.map_err(|error| format!("No reference can be made, no thread is left ({error})."));
    }
    Ok(())
}

fn show_reference(ui: &mut Ui, comparison: &mut Comparison) {
    let report = comparison.report();
    let (text, share) = match report.noise {
        None => {
            let pass = (report.passes + 1).min(LEAST_PASSES);
            (format!("first paths, pass {pass} of {LEAST_PASSES}"), 0.0)
        }
        Some(noise) if report.is_done => (format!("noise {}", percent(noise)), 1.0),
        // Noise falls as the root of the paths.
        Some(noise) => (format!("noise {}, goal {}", percent(noise), percent(GOAL)), (GOAL / noise).powi(2).min(1.0)),
    };
    let points = format::count(report.points);
    rows::row(ui, "Reference", |ui| {
        ui.label(theme::value(text)).on_hover_text(format!(
            "Path-traced at {points} points; the noise is subtracted from the errors below. Kept on disk for the next time."
        ))
    });
    if let Some(left) = report.seconds_left.filter(|_| !report.is_done) {
        ui.label(theme::weak(format!("About {} left", format::seconds(left))));
    }
    ui.horizontal_wrapped(|ui| {
        ui.add(ProgressBar::new(share as f32).desired_width(200.0).desired_height(6.0).fill(theme::ACCENT));
        if ui.button(words::STOP_COMPARING).clicked() {
            comparison.stop();
        }
    });
    if let Some(failure) = &comparison.report().cache_failure {
        ui.label(theme::weak(failure));
    }
}

fn show_error(ui: &mut Ui, error: &SolutionError) {
    let shown = &error.displayed;
    let rms = match shown.below_noise {
        true => format!("below {}", percent(error.reference_noise)),
        false => percent_with(shown.rms, shown.rms_noise),
    };
    let mut row = |name: &str, value: String, hint: &str| {
        rows::row(ui, name, |ui| ui.label(theme::value(value)).on_hover_text(hint));
    };
    row(
        "Error (RMS)",
        rms,
        "Of the radiosity as displayed, over the area of all surfaces but the lamps, relative to its RMS; ± one standard error, \
         for other points would find another error. Where a few bright points hold most of it, that is large",
    );
    row(
        "…of the elements",
        percent_with(error.leaves.rms, error.leaves.rms_noise),
        "Error with one value for each element, not interpolated",
    );
    row("Bias", format!("{:+.1} %", 100.0 * shown.bias), "Mean difference: too bright is positive");
    let of_light = &error.local;
    let [p50, p95] = [of_light.p50, of_light.p95].map(percent);
    row(
        "Local error, 9 of 10",
        percent_with(of_light.p90, of_light.p90_noise),
        "9 of 10 surfaces are read within this: the 90th percentile over the area of |ΔE|/(E + E₀), E₀ a tenth of the median \
         of E; ± its standard error",
    );
    row("…p50, p95", format!("{p50}, {p95}"), "Median and 95th percentile of the same local error");
    let local = format!("{}, {}", percent_with(shown.local_median, shown.local_median_noise), percent(shown.local_p95));
    row(
        "…of B alone",
        local,
        "Relative to each point's own radiosity: median ± its standard error, and 95th percentile over the area",
    );
    let dark = format!("{}, {}", percent(shown.dark_median), percent(shown.dark_p95));
    row("…where it is dark", dark, "Local error of B over the darker half of the area");
}

fn show_shading(ui: &mut Ui, shading: &mut Shading) {
    rows::row(ui, "Show", |ui| {
        let all = [(Shading::Lit, "light"), (Shading::Error, "error"), (Shading::Difference, "difference")];
        ui.horizontal(|ui| all.map(|(value, name)| ui.selectable_value(shading, value, name))).response
    });
}

fn show_chart(ui: &mut Ui, runs: &[Run]) {
    ui.add_space(4.0);
    ui.label(theme::weak("Error (RMS) over time, ±1 standard error; earlier settings faint"));
    let power_of_ten = |mark: egui_plot::GridMark, unit: &str, factor: f64| {
        let decimals = (-(mark.value + factor.log10())).round().max(0.0) as usize;
        format!("{:.decimals$} {unit}", factor * 10f64.powf(mark.value))
    };
    Plot::new("error over time")
        .height(CHART_HEIGHT)
        .allow_drag(false)
        .allow_zoom(false)
        .allow_scroll(false)
        .allow_boxed_zoom(false)
        .show_x(false)
        .show_y(false)
        .set_margin_fraction(egui::vec2(0.06, 0.12))
        .x_grid_spacer(egui_plot::uniform_grid_spacer(|_| [1.0, 1.0, 1.0]))
        .y_grid_spacer(egui_plot::uniform_grid_spacer(|_| [1.0, 1.0, 1.0]))
        .x_axis_formatter(move |mark, _| power_of_ten(mark, "s", 1.0))
        .y_axis_formatter(move |mark, _| power_of_ten(mark, "%", 100.0))
        .include_y(-1.0)
        .include_y(0.0)
        .include_x(-2.0)
        .include_x(0.0)
        .show(ui, |plot| {
            // Beneath all lines.
            if let Some(run) = runs.last() {
                plot.add(band(run));
            }
            for (index, run) in runs.iter().enumerate() {
                let is_present = index + 1 == runs.len();
                let colour = if is_present { theme::ACCENT } else { faint(index) };
                let points: Vec<[f64; 2]> =
                    run.points.iter().map(|point| logarithms(point.seconds, point.error)).collect();
                let end = points.last().copied();
                let bar = run.points.last().map(|point| ends(point).to_vec());
                let width = if is_present { 2.0 } else { 1.2 };
                plot.line(Line::new(run.name.clone(), PlotPoints::from(points)).color(colour).width(width));
                if let Some(bar) = bar {
                    plot.line(Line::new(run.name.clone(), PlotPoints::from(bar)).color(colour).width(1.0));
                }
                if let Some(end) = end {
                    plot.points(Points::new(run.name.clone(), vec![end]).color(colour).radius(3.0));
                }
            }
        });
    for (index, run) in runs.iter().enumerate().rev() {
        let colour = if index + 1 == runs.len() { theme::ACCENT } else { faint(index) };
        let end = run.points.last().map(|at| format!("{} after {}", percent(at.error), format::seconds(at.seconds)));
        ui.horizontal(|ui| {
            rows::dot(ui, 8.0, colour);
            ui.add(egui::Label::new(theme::weak(format!("{}: {}", run.name, end.unwrap_or_default()))).truncate());
        });
    }
}

/// One standard error to either side of a run's curve.
fn band(run: &Run) -> FilledArea {
    let ends: Vec<_> = run.points.iter().map(ends).collect();
    let of = |end: usize, axis: usize| ends.iter().map(|ends| ends[end][axis]).collect::<Vec<_>>();
    FilledArea::new(run.name.clone(), &of(0, 0), &of(0, 1), &of(1, 1)).fill_color(theme::ACCENT.gamma_multiply(0.25))
}

/// One standard error below and above a point; the point itself where nothing is known of its
/// noise.
fn ends(point: &RunPoint) -> [[f64; 2]; 2] {
    let noise = if point.noise.is_finite() { point.noise } else { 0.0 };
    [-1.0, 1.0].map(|sign| logarithms(point.seconds, point.error + sign * noise))
}

fn logarithms(seconds: f64, error: f64) -> [f64; 2] {
    [seconds.max(1e-4).log10(), error.max(LEAST_ERROR).log10()]
}

/// The colour of an earlier run's curve.
fn faint(index: usize) -> Color32 {
    const COLOURS: [Color32; 4] = [
        Color32::from_rgb(96, 130, 168),
        Color32::from_rgb(110, 150, 120),
        Color32::from_rgb(150, 120, 150),
        Color32::from_rgb(140, 140, 110),
    ];
    COLOURS[index % COLOURS.len()]
}

/// With its standard error: 12.4 ± 0.8 %.
fn percent_with(share: f64, standard_error: f64) -> String {
    match share {
        10.0.. => percent(share),
        _ => format!("{} %", format::plus_minus(100.0 * share, 100.0 * standard_error)),
    }
}

fn percent(share: f64) -> String {
    let percent = 100.0 * share;
    match percent {
        // Where next to no light is, any is far too much.
        1000.0.. => "over 1,000 %".to_owned(),
        10.0.. => format!("{percent:.0} %"),
        _ => format!("{percent:.1} %"),
    }
}
