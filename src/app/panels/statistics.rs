//! The statistics section: counts, times, memory and power of the snapshot in view.

use egui::Ui;

use crate::app::widgets::{rows, theme};
use crate::app::{Shown, format};
use crate::base::format::percent;
use crate::gather::Quantiles;
use crate::solve::Stats;

/// Share of the power by which sums over a large scene may be off by rounding.
const ROUNDING: f64 = 1e-4;

/// Draws the section.
pub fn show(ui: &mut Ui, shown: &Shown) {
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
    if let Some(remark) = remark(&snapshot.stats) {
        rows::notice(ui, remark);
    }
}

/// Says so where more power is absorbed than there is.
fn remark(stats: &Stats) -> Option<String> {
    let given = stats.emitted_watts + stats.entering_watts;
    let surplus = stats.absorbed_watts - given;
    (surplus > ROUNDING * given).then(|| {
        let source = if stats.entering_watts > 0.0 { "emitted and entering" } else { "emitted" };
        let percent = if given > 0.0 { format!(", {} %", format::number(100.0 * surplus / given)) } else { String::new() };
        format!(
            "{} more is absorbed than is {source}{percent}: coarse links make up light. A smaller error or ε brings this down.",
            format::quantity(surplus, "W")
        )
    })
}

fn rows(stats: &Stats) -> Vec<(&'static str, String)> {
    let mut rows = vec![
        ("Threshold ε", format::quantity(stats.epsilon_watts, "W")),
        ("Threshold ε over Φ, strongest channel", format::quantity(stats.epsilon_relative, "Φ")),
        ("Initial patches", format::count(stats.initial_patches)),
        ("Clusters", format::count(stats.clusters)),
        ("Patches", format::count(stats.patches)),
        ("Elements", format::count(stats.elements)),
        ("Links", format::count(stats.all_links())),
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
        ("Memory: gather samples", format::bytes(stats.bytes.gather_samples)),
        ("Emitted, sum of channels", format::quantity(stats.emitted_watts, "W")),
        ("Absorbed, sum of channels", format::quantity(stats.absorbed_watts, "W")),
    ];
    if stats.entering_watts > 0.0 {
        rows.push(("Entering, sum of channels", format::quantity(stats.entering_watts, "W")));
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
    [of.p50, of.p90, of.p95].map(percent).join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Truth: what is absorbed was emitted or came in; powers by hand.
    #[test]
    fn more_absorbed_than_there_is_is_said() {
        let stats = |emitted_watts, entering_watts, absorbed_watts| Stats {
            emitted_watts,
            entering_watts,
            absorbed_watts,
            ..Stats::default()
        };
        for sound in
            [stats(100.0, 0.0, 90.0), stats(100.0, 50.0, 149.0), stats(100.0, 0.0, 100.001), stats(0.0, 0.0, 0.0)]
        {
            assert_eq!(remark(&sound), None, "{sound:?}");
        }
        let said = remark(&stats(100.0, 0.0, 103.0)).expect("3 W too much");
        assert!(said.starts_with("3.00 W more is absorbed than is emitted, 3.00 %"), "{said}");
        let said = remark(&stats(60.0, 40.0, 103.0)).expect("3 W too much");
        assert!(said.contains("emitted and entering"), "{said}");
    }
}
