//! The statistics section: counts, times, memory and power of the snapshot in view.

use egui::Ui;

use crate::app::widgets::theme;
use crate::app::{Shown, format};
use crate::gather::Quantiles;
use crate::solve::Stats;

/// Draws the section.
pub(in crate::app) fn show(ui: &mut Ui, shown: &Shown) {
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
        ("Threshold ε", format::quantity(stats.epsilon_watts, "W")),
        ("Threshold ε over Φ", format::quantity(stats.epsilon_relative, "Φ")),
        ("Initial patches", format::count(stats.initial_patches)),
        ("Clusters", format::count(stats.clusters)),
        ("Patches", format::count(stats.patches)),
        ("Elements", format::count(stats.elements)),
        ("Links", format::count(stats.links)),
        ("Links tested", format::count(stats.pairs_judged)),
        ("Rays", format::count(stats.rays)),
        ("Iterations", format::count(stats.iterations)),
        ("Time: clusters", format::seconds(stats.seconds.hierarchy)),
        ("Time: refining", format::seconds(stats.seconds.refine)),
        ("Time: gathering", format::seconds(stats.seconds.gather)),
        ("Time: final gather", format::seconds(stats.seconds.reconstruct)),
        ("First picture after", format::seconds(stats.seconds.first_snapshot)),
        ("Time: total", format::seconds(stats.seconds.total)),
        ("Memory: links", format::bytes(stats.bytes.links)),
        ("Memory: elements", format::bytes(stats.bytes.elements)),
        ("Memory: gather samples", format::bytes(stats.bytes.rows)),
        ("Emitted, sum of channels", format::quantity(stats.emitted_watts, "W")),
        ("Absorbed, sum of channels", format::quantity(stats.absorbed_watts, "W")),
    ];
    if stats.entering_watts > 0.0 {
        rows.push(("Entering from outside", format::quantity(stats.entering_watts, "W")));
    }
    rows.push(("Memory: all counted", format::bytes(stats.bytes.counted)));
    rows.push(("Memory limit", format::bytes(stats.bytes.budget)));
    if let Some(stop) = stats.memory_stop {
        rows.push(("Stopped by memory", stop.what().to_owned()));
    }
    if let Some(asked) = stats.error_asked {
        rows.push(("Target error", percent(asked)));
        rows.push(("9 of 10 surfaces within", stats.error_estimate.map_or("not certified yet".to_owned(), percent)));
    }
    if let Some(found) = &stats.error {
        rows.push(("Local error p50, p90, p95", quantiles(&found.read)));
        rows.push(("…of the bare mesh", quantiles(&found.mesh)));
        rows.push(("RMS error of B", percent(found.radiosity_rms)));
    }
    if stats.depth_guard_struck > 0 {
        rows.push(("Depth limit reached", format::count(stats.depth_guard_struck)));
    }
    if stats.clamped_leaves > 0 {
        rows.push(("Leaves scaled back", format::count(stats.clamped_leaves)));
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
