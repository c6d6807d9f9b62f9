//! A chart as a table.

use std::fmt::Write as _;

use super::record::{Chart, RunRecord};
use crate::solve::{SolverParams, name_of};

/// The chart as CSV: a row for each run, with every parameter, then one for each state of the path
/// tracer.
pub fn csv(chart: &Chart) -> String {
    let columns = columns(None, chart);
    let mut text = columns.iter().map(|(name, _)| *name).collect::<Vec<_>>().join(",") + "\n";
    for run in &chart.runs {
        let values: Vec<String> = self::columns(Some(run), chart).into_iter().map(|(_, value)| value).collect();
        text += &(values.join(",") + "\n");
    }
    for record in &chart.path_tracer {
        let of = |name: &str| match name {
            "scene" => chart.scene.clone(),
            "setting" => "path tracer".to_owned(),
            "seconds" => record.seconds.to_string(),
            "rms" => record.error.to_string(),
            "rms_noise" => record.error_noise.to_string(),
            "local_median" => record.local_median.to_string(),
            "local_median_noise" => record.local_median_noise.to_string(),
            "local_e_p50" => record.local.p50.to_string(),
            "local_e_p90" => record.local.p90.to_string(),
            "local_e_p90_noise" => record.local.p90_noise.to_string(),
            "local_e_p95" => record.local.p95.to_string(),
            "local_e_rms" => record.local.rms.to_string(),
            "vertices" => record.points.to_string(),
            "threads" => chart.threads.to_string(),
            "paths" => record.paths.to_string(),
            _ => String::new(),
        };
        text += &(columns.iter().map(|(name, _)| of(name)).collect::<Vec<_>>().join(",") + "\n");
    }
    text
}

/// Names and values of the columns; values are empty without a run.
fn columns(run: Option<&RunRecord>, chart: &Chart) -> Vec<(&'static str, String)> {
    let of = |value: &dyn Fn(&RunRecord) -> String| run.map(value).unwrap_or_default();
    // Names alone where there is no run: any parameters have them.
    let parameters = parameter_columns(&run.map_or_else(SolverParams::default, |run| run.params));
    let parameters = parameters.map(|(name, value)| (name, if run.is_some() { value } else { String::new() }));
    let mut columns = vec![
        ("scene", chart.scene.clone()),
        ("setting", of(&|run| format!("\"{}\"", run.setting))),
        ("epsilon_relative", of(&|run| run.epsilon_relative.to_string())),
        ("epsilon_watts", of(&|run| run.epsilon_watts.to_string())),
    ];
    columns.extend(parameters);
    columns.extend([
        ("threads", chart.threads.to_string()),
        ("converged", of(&|run| run.converged.to_string())),
        ("seconds", of(&|run| run.seconds.total.to_string())),
        ("links", of(&|run| run.links.to_string())),
        ("rays", of(&|run| run.rays.to_string())),
        ("pairs_judged", of(&|run| run.pairs_judged.to_string())),
        ("clusters", of(&|run| run.clusters.to_string())),
        ("patches", of(&|run| run.patches.to_string())),
        ("vertices", of(&|run| run.vertices.to_string())),
        ("iterations", of(&|run| run.iterations.to_string())),
        ("error_asked", of(&|run| run.error_asked.map(|error| error.to_string()).unwrap_or_default())),
        ("error_estimate", of(&|run| run.error_estimate.map(|error| error.to_string()).unwrap_or_default())),
        ("clamped_leaves", of(&|run| run.clamped_leaves.to_string())),
        ("link_bytes", of(&|run| run.bytes.links.to_string())),
        ("rms", of(&|run| run.error.displayed.rms.to_string())),
        ("rms_noise", of(&|run| run.error.displayed.rms_noise.to_string())),
        ("rms_leaves", of(&|run| run.error.leaves.rms.to_string())),
        ("below_noise", of(&|run| run.error.displayed.below_noise.to_string())),
        ("bias", of(&|run| run.error.displayed.bias.to_string())),
        ("bias_r", of(&|run| run.error.displayed.bias_rgb[0].to_string())),
        ("bias_g", of(&|run| run.error.displayed.bias_rgb[1].to_string())),
        ("bias_b", of(&|run| run.error.displayed.bias_rgb[2].to_string())),
        ("local_e_p50", of(&|run| run.error.local.p50.to_string())),
        ("local_e_p90", of(&|run| run.error.local.p90.to_string())),
        ("local_e_p90_noise", of(&|run| run.error.local.p90_noise.to_string())),
        ("local_e_p95", of(&|run| run.error.local.p95.to_string())),
        ("local_e_rms", of(&|run| run.error.local.rms.to_string())),
        ("local_median", of(&|run| run.error.displayed.local_median.to_string())),
        ("local_median_noise", of(&|run| run.error.displayed.local_median_noise.to_string())),
        ("local_p95", of(&|run| run.error.displayed.local_p95.to_string())),
        ("dark_median", of(&|run| run.error.displayed.dark_median.to_string())),
        ("dark_p95", of(&|run| run.error.displayed.dark_p95.to_string())),
        ("reference_noise", chart.reference.noise.to_string()),
        ("pareto", of(&|run| run.pareto.to_string())),
        ("paths", String::new()),
    ]);
    columns
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
