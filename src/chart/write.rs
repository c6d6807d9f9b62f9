//! A chart as a table.

use std::fmt::Write as _;

use super::record::{Chart, RunRecord};
use crate::solver::SolverParams;

/// The chart as CSV: a row for each run, with every parameter, then one for each state of the path tracer.
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

/// Names and values of the solver's parameters, ε, sides and threads aside, which their tables tell in their own way.
pub(crate) fn parameter_columns(params: &SolverParams) -> [(&'static str, String); 10] {
    [
        ("clustering", name(serde_json::to_value(params.clustering))),
        ("octree_depth", params.octree_depth.to_string()),
        ("cluster_model", name(serde_json::to_value(params.cluster_model))),
        ("oracle", name(serde_json::to_value(params.oracle))),
        ("push", name(serde_json::to_value(params.push))),
        ("partial_factor", params.partial_factor.to_string()),
        ("visibility_factor", params.visibility_factor.to_string()),
        ("rays_min", params.rays_min.to_string()),
        ("rays_max", params.rays_max.to_string()),
        ("seed", params.seed.to_string()),
    ]
}

/// The name of a choice, as the command line spells it.
fn name(value: serde_json::Result<serde_json::Value>) -> String {
    value.ok().and_then(|value| value.as_str().map(str::to_owned)).unwrap_or_default()
}

/// A Markdown table of the displayed error, a row for each setting and a column for each ε: RMS ± its standard error, and time.
pub fn error_table(chart: &Chart) -> String {
    let mut epsilons: Vec<f64> = chart.runs.iter().map(|run| run.epsilon_relative).collect();
    epsilons.sort_by(|a, b| b.total_cmp(a));
    epsilons.dedup_by(|a, b| (*a / *b - 1.0).abs() < 1e-6);
    let mut settings: Vec<&str> = chart.runs.iter().map(|run| run.setting.as_str()).collect();
    settings.dedup();
    let mut text = String::from("| ε/Φ |");
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
                    let shown = &run.error.displayed;
                    let error = crate::format::plus_minus(100.0 * shown.rms, 100.0 * shown.rms_noise);
                    let _ = write!(text, " {error} %, {} |", crate::format::seconds(run.seconds.total));
                }
                Some(_) => text += " not finished |",
                None => text += " |",
            }
        }
        text += "\n";
    }
    text
}
