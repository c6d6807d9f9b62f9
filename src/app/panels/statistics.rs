//! The statistics section: counts, times, memory and power of the snapshot in view.

use egui::Ui;

use super::super::{Shown, format, theme};
use crate::solver::Stats;

/// Draws the section.
pub(super) fn show(ui: &mut Ui, shown: &Shown) {
    let Some(snapshot) = &shown.snapshot else {
        ui.label(theme::weak("No solution yet."));
        return;
    };
    for (index, (name, value)) in rows(&snapshot.stats).into_iter().enumerate() {
        let fill = if index % 2 == 0 { ui.visuals().faint_bg_color } else { egui::Color32::TRANSPARENT };
        egui::Frame::new().fill(fill).inner_margin(egui::Margin::symmetric(4, 1)).show(ui, |ui| {
            ui.horizontal(|ui| {
                ui.label(theme::weak(name));
                ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| ui.label(theme::value(value)));
            });
        });
    }
}

fn rows(stats: &Stats) -> Vec<(&'static str, String)> {
    let mut rows = vec![
        ("ε", format::quantity(stats.epsilon_watts, "W")),
        ("ε relative", format::quantity(stats.epsilon_relative, "Φ")),
        ("initial patches", format::count(stats.initial_patches)),
        ("clusters", format::count(stats.clusters)),
        ("patches", format::count(stats.patches)),
        ("elements", format::count(stats.elements)),
        ("links", format::count(stats.links)),
        ("pairs judged", format::count(stats.pairs_judged)),
        ("rays", format::count(stats.rays)),
        ("rounds", format::count(stats.iterations)),
        ("time: clusters", format::seconds(stats.seconds.hierarchy)),
        ("time: refining", format::seconds(stats.seconds.refine)),
        ("time: gathering", format::seconds(stats.seconds.gather)),
        ("time: vertices", format::seconds(stats.seconds.reconstruct)),
        ("first snapshot after", format::seconds(stats.seconds.first_snapshot)),
        ("total", format::seconds(stats.seconds.total)),
        ("links in memory", format::bytes(stats.bytes.links)),
        ("elements in memory", format::bytes(stats.bytes.elements)),
        ("rows in memory", format::bytes(stats.bytes.rows)),
        ("emitted", format::quantity(stats.emitted_watts, "W")),
        ("absorbed", format::quantity(stats.absorbed_watts, "W")),
    ];
    rows.push(("memory counted", format::bytes(stats.bytes.counted)));
    rows.push(("memory budget", format::bytes(stats.bytes.budget)));
    if let Some(stop) = stats.memory_stop {
        rows.push(("stopped by memory", stop.what().to_owned()));
    }
    if let Some(asked) = stats.error_asked {
        let percent = |share: f64| format!("{} %", format::number(100.0 * share));
        rows.push(("error asked", percent(asked)));
        rows.push(("error estimated", stats.error_estimate.map_or("not yet".to_owned(), percent)));
    }
    if stats.depth_guard_struck > 0 {
        rows.push(("depth guard struck", format::count(stats.depth_guard_struck)));
    }
    if stats.clamped_leaves > 0 {
        rows.push(("leaves scaled back", format::count(stats.clamped_leaves)));
    }
    rows
}
