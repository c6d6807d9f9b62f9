//! A chart as a table.

use super::record::{Chart, PathTracerRecord, RunRecord};
use crate::base::format::{count, percent_with, seconds};
use crate::measure::accuracy::LocalError;
use crate::measure::records::{self, Record, Table, columns, optional};
use crate::solve::{SolverParams, name_of};

/// The chart as CSV: a row for each run, with every parameter, then one for each state of the path
/// tracer.
pub fn csv(chart: &Chart) -> String {
    let runs = chart.runs.iter().map(|run| of_run(run, chart));
    let path_tracer = chart.path_tracer.iter().map(|record| of_path_tracer(record, chart));
    records::csv(&runs.chain(path_tracer).collect::<Vec<_>>())
}

fn of_path_tracer(record: &PathTracerRecord, chart: &Chart) -> Record {
    let mut row = vec![("scene", chart.scene.clone()), ("setting", "path tracer".to_owned())];
    row.extend(columns!(record; seconds));
    row.extend([("rms", record.error.to_string()), ("rms_noise", record.error_noise.to_string())]);
    row.extend(columns!(record; local_median, local_median_noise));
    row.extend(local_columns(&record.local));
    row.extend([("vertices", record.points.to_string()), ("threads", chart.threads.to_string())]);
    row.extend(columns!(record; paths));
    row
}

fn of_run(run: &RunRecord, chart: &Chart) -> Record {
    let shown = &run.error.displayed;
    let [r, g, b] = shown.bias_rgb.map(|bias| bias.to_string());
    let mut row = vec![("scene", chart.scene.clone())];
    row.extend(columns!(run; setting, epsilon_relative, epsilon_watts));
    row.extend(parameter_columns(&run.params));
    row.extend(columns!(chart; threads));
    row.extend(columns!(run; converged));
    row.push(("seconds", run.seconds.total.to_string()));
    row.extend(columns!(run; links, rays, pairs_judged, clusters, patches, vertices, iterations));
    row.extend([optional("error_asked", run.error_asked), optional("error_estimate", run.error_estimate)]);
    row.extend(columns!(run; clamped_leaves));
    row.push(("link_bytes", run.bytes.links.to_string()));
    row.extend(columns!(shown; rms, rms_noise));
    row.push(("rms_leaves", run.error.leaves.rms.to_string()));
    row.extend(columns!(shown; below_noise, bias));
    row.extend([("bias_r", r), ("bias_g", g), ("bias_b", b)]);
    row.extend(local_columns(&run.error.local));
    row.extend(columns!(shown; local_median, local_median_noise, local_p95, dark_median, dark_p95));
    row.push(("reference_noise", chart.reference.noise.to_string()));
    row.extend(columns!(run; pareto));
    row
}

fn local_columns(local: &LocalError) -> [(&'static str, String); 5] {
    let LocalError { p50, p90, p90_noise, p95, rms, .. } = *local;
    let names = ["local_e_p50", "local_e_p90", "local_e_p90_noise", "local_e_p95", "local_e_rms"];
    let mut values = [p50, p90, p90_noise, p95, rms].into_iter();
    names.map(|name| (name, values.next().map_or_else(String::new, |value| value.to_string())))
}

/// Names and values of the solver's parameters, ε, sides and threads aside, which their tables tell
/// in their own way.
pub(crate) fn parameter_columns(params: &SolverParams) -> Record {
    let mut row = vec![("clustering", name_of(&params.clustering))];
    row.extend(columns!(params; octree_depth));
    row.extend([
        ("cluster_model", name_of(&params.cluster_model)),
        ("reconstruct", name_of(&params.shown_by())),
        ("push", name_of(&params.push)),
    ]);
    row.extend(columns!(params; partial_factor, visibility_factor, rays_min, rays_max, seed));
    row
}

/// A Markdown table of the target error, the certificate, and the measured error, its
/// metrics named in the line above; nothing where no run was asked for an error. The path tracer's
/// time is that of as many points as the run has vertices, to the same 90th percentile.
pub fn target_table(chart: &Chart) -> String {
    let asked: Vec<&RunRecord> = chart.runs.iter().filter(|run| run.error_asked.is_some() && run.converged).collect();
    if asked.is_empty() {
        return String::new();
    }
    let row = |run: &&RunRecord| {
        let (shown, local) = (&run.error.displayed, &run.error.local);
        // Its error falls with the root of its paths, which take time in proportion to the points.
        let tracer = chart
            .path_tracer
            .last()
            .map(|last| last.seconds * (last.local.p90 / local.p90).powi(2) * run.vertices as f64 / last.points as f64);
        vec![
            percent(run.error_asked.unwrap_or_default()),
            run.error_estimate.map_or("–".into(), percent),
            percent(local.p50),
            percent_with(local.p90, local.p90_noise),
            percent(local.p95),
            percent_with(shown.rms, shown.rms_noise),
            seconds(run.seconds.total),
            count(run.links),
            count(run.vertices),
            tracer.map_or("–".into(), seconds),
            tracer.map_or("–".into(), |tracer| format!("{:.1}", tracer / run.seconds.total)),
        ]
    };
    let head =
        ["target", "certificate", "p50", "p90", "p95", "RMS of B", "time", "links", "vertices", "path tracer", "ratio"];
    Table::new(LOCAL_ERROR, head, asked.iter().map(row).collect()).markdown_with(0)
}

/// Caption of the tables: the metrics of their figures.
const LOCAL_ERROR: &str = "p50, p90, p95: quantiles over the area of the local error |ΔE|/(E + E0), E0 a tenth of the median of E; ± one standard error.";

/// A share in per cent, with a decimal.
pub(super) fn percent(share: f64) -> String {
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
    let cell = |setting: &str, epsilon: f64| {
        let at = |run: &&RunRecord| run.setting == setting && (run.epsilon_relative / epsilon - 1.0).abs() < 1e-6;
        match chart.runs.iter().find(at) {
            Some(run) if run.converged => {
                let (local, rms) = (&run.error.local, run.error.displayed.rms);
                let error = percent_with(local.p90, local.p90_noise);
                format!("{error}, {}, {}", percent(rms), seconds(run.seconds.total))
            }
            Some(_) => "not finished".to_owned(),
            None => String::new(),
        }
    };
    let row = |setting: &str| {
        std::iter::once(setting.to_owned()).chain(epsilons.iter().map(|epsilon| cell(setting, *epsilon))).collect()
    };
    let head = std::iter::once("ε/Φ".to_owned()).chain(epsilons.iter().map(|epsilon| format!("{epsilon:.0e}")));
    let caption = format!("{LOCAL_ERROR} Each cell: p90, RMS of B, time.");
    Table { caption, head: head.collect(), rows: settings.into_iter().map(row).collect() }.markdown()
}
