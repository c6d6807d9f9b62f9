//! A chart as a table.

use std::fmt::Write as _;

use super::record::{Chart, PathTracerRecord, RunRecord};
use crate::measure::records::{self, Record};
use crate::solve::{SolverParams, name_of};

/// The chart as CSV: a row for each run, with every parameter, then one for each state of the path
/// tracer.
pub fn csv(chart: &Chart) -> String {
    let runs = chart.runs.iter().map(|run| of_run(run, chart));
    let path_tracer = chart.path_tracer.iter().map(|record| of_path_tracer(record, chart));
    records::csv(&runs.chain(path_tracer).collect::<Vec<_>>())
}

fn of_path_tracer(record: &PathTracerRecord, chart: &Chart) -> Record {
    vec![
        ("scene", chart.scene.clone()),
        ("setting", "path tracer".to_owned()),
        ("seconds", record.seconds.to_string()),
        ("rms", record.error.to_string()),
        ("rms_noise", record.error_noise.to_string()),
        ("local_median", record.local_median.to_string()),
        ("local_median_noise", record.local_median_noise.to_string()),
        ("local_e_p50", record.local.p50.to_string()),
        ("local_e_p90", record.local.p90.to_string()),
        ("local_e_p90_noise", record.local.p90_noise.to_string()),
        ("local_e_p95", record.local.p95.to_string()),
        ("local_e_rms", record.local.rms.to_string()),
        ("vertices", record.points.to_string()),
        ("threads", chart.threads.to_string()),
        ("paths", record.paths.to_string()),
    ]
}

fn of_run(run: &RunRecord, chart: &Chart) -> Record {
    let optional = |error: Option<f64>| error.map(|error| error.to_string()).unwrap_or_default();
    let (shown, local) = (&run.error.displayed, &run.error.local);
    let mut record = vec![
        ("scene", chart.scene.clone()),
        ("setting", run.setting.clone()),
        ("epsilon_relative", run.epsilon_relative.to_string()),
        ("epsilon_watts", run.epsilon_watts.to_string()),
    ];
    record.extend(parameter_columns(&run.params));
    record.extend([
        ("threads", chart.threads.to_string()),
        ("converged", run.converged.to_string()),
        ("seconds", run.seconds.total.to_string()),
        ("links", run.links.to_string()),
        ("rays", run.rays.to_string()),
        ("pairs_judged", run.pairs_judged.to_string()),
        ("clusters", run.clusters.to_string()),
        ("patches", run.patches.to_string()),
        ("vertices", run.vertices.to_string()),
        ("iterations", run.iterations.to_string()),
        ("error_asked", optional(run.error_asked)),
        ("error_estimate", optional(run.error_estimate)),
        ("clamped_leaves", run.clamped_leaves.to_string()),
        ("link_bytes", run.bytes.links.to_string()),
        ("rms", shown.rms.to_string()),
        ("rms_noise", shown.rms_noise.to_string()),
        ("rms_leaves", run.error.leaves.rms.to_string()),
        ("below_noise", shown.below_noise.to_string()),
        ("bias", shown.bias.to_string()),
        ("bias_r", shown.bias_rgb[0].to_string()),
        ("bias_g", shown.bias_rgb[1].to_string()),
        ("bias_b", shown.bias_rgb[2].to_string()),
        ("local_e_p50", local.p50.to_string()),
        ("local_e_p90", local.p90.to_string()),
        ("local_e_p90_noise", local.p90_noise.to_string()),
        ("local_e_p95", local.p95.to_string()),
        ("local_e_rms", local.rms.to_string()),
        ("local_median", shown.local_median.to_string()),
        ("local_median_noise", shown.local_median_noise.to_string()),
        ("local_p95", shown.local_p95.to_string()),
        ("dark_median", shown.dark_median.to_string()),
        ("dark_p95", shown.dark_p95.to_string()),
        ("reference_noise", chart.reference.noise.to_string()),
        ("pareto", run.pareto.to_string()),
    ]);
    record
}

/// Names and values of the solver's parameters, ε, sides and threads aside, which their tables tell
/// in their own way.
pub(crate) fn parameter_columns(params: &SolverParams) -> [(&'static str, String); 10] {
    [
        ("clustering", name_of(&params.clustering)),
        ("octree_depth", params.octree_depth.to_string()),
        ("cluster_model", name_of(&params.cluster_model)),
        ("reconstruct", name_of(&params.shown_by())),
        ("push", name_of(&params.push)),
        ("partial_factor", params.partial_factor.to_string()),
        ("visibility_factor", params.visibility_factor.to_string()),
        ("rays_min", params.rays_min.to_string()),
        ("rays_max", params.rays_max.to_string()),
        ("seed", params.seed.to_string()),
    ]
}

/// A Markdown table of the target error, the certificate, and the measured error, its
/// metrics named in the line above; nothing where no run was asked for an error. The path tracer's
/// time is that of as many points as the run has vertices, to the same 90th percentile.
pub fn target_table(chart: &Chart) -> String {
    let asked: Vec<&RunRecord> = chart.runs.iter().filter(|run| run.error_asked.is_some() && run.converged).collect();
    if asked.is_empty() {
        return String::new();
    }
    let mut text = format!(
        "{LOCAL_ERROR}\n\n| target | certificate | p50 | p90 | p95 | RMS of B | time | links | vertices | path tracer | ratio |\n|{}\n",
        " ---: |".repeat(11)
    );
    for run in asked {
        let (shown, local) = (&run.error.displayed, &run.error.local);
        // Its error falls with the root of its paths, which take time in proportion to the points.
        let tracer = chart
            .path_tracer
            .last()
            .map(|last| last.seconds * (last.local.p90 / local.p90).powi(2) * run.vertices as f64 / last.points as f64);
        let _ = writeln!(
            text,
            "| {} | {} | {} | {} % | {} | {} % | {} | {} | {} | {} | {} |",
            percent(run.error_asked.unwrap_or_default()),
            run.error_estimate.map_or("–".into(), percent),
            percent(local.p50),
            crate::base::format::plus_minus(100.0 * local.p90, 100.0 * local.p90_noise),
            percent(local.p95),
            crate::base::format::plus_minus(100.0 * shown.rms, 100.0 * shown.rms_noise),
            crate::base::format::seconds(run.seconds.total),
            crate::base::format::count(run.links),
            crate::base::format::count(run.vertices),
            tracer.map_or("–".into(), crate::base::format::seconds),
            tracer.map_or("–".into(), |tracer| format!("{:.1}", tracer / run.seconds.total)),
        );
    }
    text
}

/// Caption of the tables: the metrics of their figures.
const LOCAL_ERROR: &str = "p50, p90, p95: quantiles over the area of the local error |ΔE|/(E + E0), E0 a tenth of the median of E; ± one standard error.";

fn percent(share: f64) -> String {
    format!("{:.1} %", 100.0 * share)
}

/// A Markdown table of the displayed error, a row for each setting and a column for each ε: p90 of
/// the local error ± its standard error, RMS of B, and time.
pub fn error_table(chart: &Chart) -> String {
    let by_threshold = || chart.runs.iter().filter(|run| run.error_asked.is_none());
    let mut epsilons: Vec<f64> = by_threshold().map(|run| run.epsilon_relative).collect();
    epsilons.sort_by(|a, b| b.total_cmp(a));
    epsilons.dedup_by(|a, b| (*a / *b - 1.0).abs() < 1e-6);
    let mut settings: Vec<&str> = by_threshold().map(|run| run.setting.as_str()).collect();
    settings.dedup();
    let mut text = format!("{LOCAL_ERROR} Each cell: p90, RMS of B, time.\n\n| ε/Φ |");
    // A String takes any text.
    for epsilon in &epsilons {
        let _ = write!(text, " {epsilon:.0e} |");
    }
    text += &format!("\n| --- |{}\n", " ---: |".repeat(epsilons.len()));
    for setting in settings {
        let _ = write!(text, "| {setting} |");
        for epsilon in &epsilons {
            let at = |run: &&RunRecord| run.setting == setting && (run.epsilon_relative / epsilon - 1.0).abs() < 1e-6;
            match chart.runs.iter().find(at) {
                Some(run) if run.converged => {
                    let (local, rms) = (&run.error.local, run.error.displayed.rms);
                    let error = crate::base::format::plus_minus(100.0 * local.p90, 100.0 * local.p90_noise);
                    let time = crate::base::format::seconds(run.seconds.total);
                    let _ = write!(text, " {error} %, {}, {time} |", percent(rms));
                }
                Some(_) => text += " not finished |",
                None => text += " |",
            }
        }
        text += "\n";
    }
    text
}
