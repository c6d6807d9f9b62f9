//! The statistics section: counts, times, memory and power of the snapshot in view.

use egui::Ui;

use super::super::{Shown, format, theme};
use crate::gather::Quantiles;
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
        ("time: final gather", format::seconds(stats.seconds.reconstruct)),
        ("first snapshot after", format::seconds(stats.seconds.first_snapshot)),
        ("total", format::seconds(stats.seconds.total)),
        ("links in memory", format::bytes(stats.bytes.links)),
        ("elements in memory", format::bytes(stats.bytes.elements)),
        ("gather samples in memory", format::bytes(stats.bytes.rows)),
        ("emitted", format::quantity(stats.emitted_watts, "W")),
        ("absorbed", format::quantity(stats.absorbed_watts, "W")),
    ];
    if stats.entering_watts > 0.0 {
        rows.push(("entering from outside", format::quantity(stats.entering_watts, "W")));
    }
    rows.push(("memory counted", format::bytes(stats.bytes.counted)));
    rows.push(("memory budget", format::bytes(stats.bytes.budget)));
    if let Some(stop) = stats.memory_stop {
        rows.push(("stopped by memory", stop.what().to_owned()));
    }
    if let Some(asked) = stats.error_asked {
        rows.push(("target error", percent(asked)));
        rows.push(("9 of 10 surfaces within", stats.error_estimate.map_or("not yet".to_owned(), percent)));
    }
    if let Some(found) = &stats.error {
        rows.push(("local error p50, p90, p95", quantiles(&found.read)));
        rows.push(("…of the bare mesh", quantiles(&found.mesh)));
        rows.push(("RMS error of B", percent(found.radiosity_rms)));
    }
    if stats.depth_guard_struck > 0 {
        rows.push(("depth guard struck", format::count(stats.depth_guard_struck)));
    }
    if stats.clamped_leaves > 0 {
        rows.push(("leaves scaled back", format::count(stats.clamped_leaves)));
    }
    rows
}

/// Quantiles over the area of the local error |ΔE|/(E + E₀), in per cent.
fn quantiles(of: &Quantiles) -> String {
    format!("{}, {}, {}", percent(of.p50), percent(of.p90), percent(of.p95))
}

fn percent(share: f64) -> String {
    format!("{} %", format::number(100.0 * share))
}
