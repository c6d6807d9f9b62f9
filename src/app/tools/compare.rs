//! The comparison tool: keep a solution as A, let B run with other settings, and see how they
//! differ.

use std::sync::Arc;

use egui::{Button, Grid, Ui};
use serde_json::Value;

use crate::app::actions::{Action, Outbox};
use crate::app::state::comparison::Comparison;
use crate::app::state::pinned::{Pinned, PinnedSolution, Sides};
use crate::app::widgets::{rows, theme};
use crate::app::{Shown, format, words};
use crate::solve::{PARAMETERS, Parameter, Snapshot, SolverParams, Stats};

/// Width of the names in a table, points.
const NAME_WIDTH: f32 = 112.0;
/// Numbers that differ by less than this share are alike.
const WORTH_TELLING: f64 = 0.01;

/// Choices of what the view shows, with names and hints.
const SIDES: [(Sides, &str, &str); 4] = [
    (
        Sides::Split,
        words::A_BESIDE_B,
        "A at the left of a divider that can be dragged, B at its right; same view, same exposure",
    ),
    (Sides::A, words::A_ALONE, "The solution that was kept"),
    (Sides::B, words::B_ALONE, "The solution that runs, exposed as A"),
    (Sides::Difference, words::DIFFERENCE, "Where B is darker or brighter than A, relative to A"),
];

/// A row of the table: name, A, B and, where it is a number, how much of A's B is.
struct Row {
    name: String,
    a: String,
    b: String,
    ratio: Option<f64>,
}

/// Draws the tool.
pub fn show(
    ui: &mut Ui,
    shown: &Shown,
    pinned: &mut Pinned,
    comparison: &Comparison,
    params: &SolverParams,
    outbox: &mut Outbox,
) {
    let Some(snapshot) = &shown.snapshot else {
        ui.label(theme::weak("Nothing to compare yet: open a scene."));
        return;
    };
    let is_kept = pinned.solution().is_some();
    if !is_kept {
        let text = "Keep the solution in view as A, then change settings: the solver goes on with B, and the view shows both side by side.";
        rows::sentence(ui, theme::weak(text));
        ui.add_space(4.0);
    }
    ui.horizontal(|ui| {
        let name = if is_kept { "Replace A" } else { words::KEEP_AS_A };
        if ui.button(name).on_hover_text("Keep the solution in view, with its settings and statistics").clicked() {
            outbox.act(Action::KeepAsA);
        }
        if ui.add_enabled(is_kept, Button::new(words::DISCARD_A)).clicked() {
            pinned.let_go();
        }
    });
    if !is_kept {
        return;
    }
    ui.add_space(6.0);
    ui.horizontal(|ui| rows::alternatives(ui, &mut pinned.sides, &SIDES));
    ui.add_space(8.0);
    let Some(kept) = pinned.solution() else { return };
    let settings = differing_settings(&kept.params, params);
    ui.add_space(4.0);
    rows::heading(ui, "Settings that differ");
    match settings.is_empty() {
        true => {
            ui.label(theme::weak("None yet: change a setting, and B goes on from there."));
        }
        false => table(ui, "settings", &settings),
    }
    ui.add_space(4.0);
    rows::heading(ui, "Results");
    table(ui, "results", &results(kept, snapshot, measured(comparison, snapshot), pinned.rms()));
}

/// The error of a snapshot by the reference of the Accuracy section, if it was measured.
pub fn measured(comparison: &Comparison, snapshot: &Arc<Snapshot>) -> Option<(f64, f64)> {
    let measured = comparison.report().measured.as_ref()?;
    let shown = &measured.error.displayed;
    Arc::ptr_eq(&measured.snapshot, snapshot).then_some((shown.rms, shown.rms_noise))
}

fn table(ui: &mut Ui, id: &str, rows: &[Row]) {
    Grid::new(id).num_columns(4).striped(true).spacing([9.0, 4.0]).show(ui, |ui| {
        for title in ["", "A", "B", ""] {
            ui.label(theme::weak(title));
        }
        ui.end_row();
        for row in rows {
            ui.scope(|ui| {
                ui.set_max_width(NAME_WIDTH);
                rows::sentence(ui, row.name.as_str());
            });
            ui.label(theme::value(row.a.as_str()));
            ui.label(theme::value(row.b.as_str()));
            let ratio = row.ratio.map_or(String::new(), |ratio| format!("× {}", format::number(ratio)));
            ui.label(theme::weak(ratio));
            ui.end_row();
        }
    });
}

/// Every parameter that differs, as files spell its values.
fn differing_settings(a: &SolverParams, b: &SolverParams) -> Vec<Row> {
    let (Ok(Value::Object(a)), Ok(Value::Object(b))) = (serde_json::to_value(a), serde_json::to_value(b)) else {
        return Vec::new();
    };
    let differ = a.iter().filter_map(|(key, of_a)| Some((key, of_a, b.get(key)?))).filter(|(_, a, b)| a != b);
    let text = |key: &str, value: &Value| match (key, value.as_f64()) {
        ("error", Some(share)) => format!("{} %", format::number(100.0 * share)),
        _ => {
            let shown = value.as_str().and_then(|name| parameter_of(key)?.shown(name));
            shown.map_or_else(|| text_of(value), str::to_owned)
        }
    };
    differ.map(|(key, a, b)| Row { name: label_of(key), a: text(key, a), b: text(key, b), ratio: None }).collect()
}

/// The parameter that files keep under a key.
fn parameter_of(key: &str) -> Option<&'static Parameter> {
    let flag = key.replace('_', "-");
    PARAMETERS.iter().find(|parameter| parameter.flag == flag)
}

/// The panel's name of a parameter.
fn label_of(key: &str) -> String {
    match parameter_of(key) {
        // Relative or in watts: the value says which.
        Some(_) if key == "epsilon" => "ε".into(),
        Some(parameter) => parameter.label.into(),
        None => key.replace('_', " "),
    }
}

fn text_of(value: &Value) -> String {
    match value {
        Value::Null => "–".into(),
        Value::Number(number) => match number.as_u64() {
            Some(whole) => format::count(whole),
            None => format::number(number.as_f64().unwrap_or(f64::NAN)),
        },
        Value::String(text) => text.clone(),
        Value::Object(object) => match object.iter().next() {
            Some((kind, Value::Number(number))) => {
                let unit = if kind == "relative" { "Φ" } else { "W" };
                format::quantity(number.as_f64().unwrap_or(f64::NAN), unit)
            }
            _ => value.to_string(),
        },
        _ => value.to_string(),
    }
}

fn results(pinned: &PinnedSolution, b: &Snapshot, measured: Option<(f64, f64)>, difference: Option<f64>) -> Vec<Row> {
    let (of_a, of_b) = (&pinned.snapshot.stats, &b.stats);
    let row = |name: &str, text: fn(f64) -> String, value: fn(&Stats) -> f64| {
        let (a, b) = (value(of_a), value(of_b));
        Row {
            name: name.into(),
            a: text(a),
            b: text(b),
            ratio: (a > 0.0 && (b / a - 1.0).abs() >= WORTH_TELLING).then(|| b / a),
        }
    };
    let count = |value: f64| format::count(value as u64);
    let mut rows = vec![
        row("Time", format::seconds, |stats| stats.seconds.total),
        row("Links", count, |stats| stats.all_links() as f64),
        row("Patches", count, |stats| stats.patches as f64),
        row("Clusters", count, |stats| stats.clusters as f64),
        row("Rays", count, |stats| stats.rays as f64),
        row("Link memory", |bytes| format::bytes(bytes as usize), |stats| stats.bytes.links as f64),
        row("Absorbed (sum of channels)", |watts| format::quantity(watts, "W"), |stats| stats.absorbed_watts),
    ];
    let percent =
        |share: Option<f64>| share.map_or("–".to_owned(), |share| format!("{} %", format::number(100.0 * share)));
    let text_row = |name: &str, a: String, b: String| Row { name: name.into(), a, b, ratio: None };
    if of_a.error_estimate.is_some() || of_b.error_estimate.is_some() {
        rows.push(text_row("Error, certified", percent(of_a.error_estimate), percent(of_b.error_estimate)));
    }
    if pinned.measured.is_some() || measured.is_some() {
        let text = |measured: Option<(f64, f64)>| {
            measured.map_or("–".to_owned(), |(rms, noise)| format::percent_with(rms, noise))
        };
        rows.push(text_row("Error, measured", text(pinned.measured), text(measured)));
    }
    rows.push(text_row("RMS of B − A", String::new(), percent(difference)));
    rows
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::solve::{ClusteringMode, Epsilon};

    /// Truth: what was changed, under the names of the panel.
    #[test]
    fn settings_that_differ_are_named_as_in_the_panel() {
        let a = SolverParams::default();
        assert!(differing_settings(&a, &a).is_empty());
        let b = SolverParams { epsilon: Epsilon::Watts(0.25), clustering: ClusteringMode::Octree, rays_min: 8, ..a };
        let mut rows: Vec<_> = differing_settings(&a, &b).into_iter().map(|row| [row.name, row.a, row.b]).collect();
        rows.sort();
        let expected =
            [["Clustering", "adaptive", "octree"], ["Min rays per link", "4", "8"], ["ε", "1.00e-4 Φ", "0.250 W"]];
        assert_eq!(rows, expected);
    }
}
