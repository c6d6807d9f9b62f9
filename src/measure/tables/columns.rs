//! Rows of tables and records: the paper's, ours, and those that were left out.

use super::lab::{LeftOut, Run};
use super::paper;
use super::report::Table;
use crate::base::format::{bytes, count, grouped, number, quantity};
use crate::measure::chart::parameter_columns;
use crate::measure::records::Record;

/// A column of a table of runs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Column {
    /// Polygons of the room.
    Polygons,
    /// Median time.
    Time,
    /// Polygons that became patches.
    InitialPatches,
    /// Leaf patches.
    Patches,
    /// Clusters.
    Clusters,
    /// Pairs that the oracle judged.
    Pairs,
    /// Links.
    Links,
    /// Visibility rays.
    Rays,
    /// Links, elements and radiosities.
    Memory,
    /// Displayed RMS error.
    Rms,
    /// Median of the displayed local error.
    Median,
}

impl Column {
    fn head(self) -> &'static str {
        match self {
            Self::Polygons => "polygons",
            Self::Time => "time",
            Self::InitialPatches => "initial patches",
            Self::Patches => "patches",
            Self::Clusters => "clusters",
            Self::Pairs => "pairs judged",
            Self::Links => "links",
            Self::Rays => "rays",
            Self::Memory => "memory",
            Self::Rms => "error, RMS",
            Self::Median => "error, median",
        }
    }

    fn of_run(self, run: &Run) -> String {
        match self {
            Self::Polygons => count(run.polygons),
            Self::Time => quantity(run.time(), "s"),
            Self::InitialPatches => count(run.stats.initial_patches),
            Self::Patches => count(run.stats.patches),
            Self::Clusters => count(run.stats.clusters),
            Self::Pairs => count(run.stats.pairs_judged),
            Self::Links => count(run.stats.links),
            Self::Rays => count(run.stats.rays),
            Self::Memory => bytes(run.bytes()),
            Self::Rms => run.rms_text(),
            Self::Median => run.local_median_text(),
        }
    }

    fn of_paper(self, row: &paper::Row) -> String {
        match self {
            Self::Time => format!("{} s", grouped(row.seconds)),
            Self::Polygons | Self::InitialPatches => count(row.initial_patches),
            Self::Patches => count(row.patches),
            Self::Clusters => row.clusters.map_or("–".into(), count),
            Self::Links => count(row.links),
            Self::Pairs | Self::Rays | Self::Memory | Self::Rms | Self::Median => "–".into(),
        }
    }
}

/// A share in per cent.
pub fn percent(share: f64) -> String {
    if share.is_finite() { format!("{} %", number(100.0 * share)) } else { "–".into() }
}

/// A ratio: 102×.
pub fn times(ratio: f64) -> String {
    format!("{}×", number(ratio))
}

/// The paper's rows above ours; what was left out keeps its place.
pub fn table(caption: String, columns: &[Column], of_paper: &[paper::Row], runs: &[Result<Run, LeftOut>]) -> Table {
    let head = std::iter::once("".to_owned()).chain(columns.iter().map(|column| column.head().to_owned())).collect();
    let paper_row = |row: &paper::Row| {
        let cells = columns.iter().map(|column| column.of_paper(row));
        std::iter::once(format!("paper: {}", row.name)).chain(cells).collect()
    };
    let our_row = |run: &Result<Run, LeftOut>| match run {
        Ok(run) => {
            let cells = columns.iter().map(|column| column.of_run(run));
            std::iter::once(run.setting.clone()).chain(cells).collect()
        }
        Err(left_out) => {
            let cell = |(index, column): (usize, &Column)| match column {
                Column::Polygons => count(left_out.polygons),
                _ if index == columns.iter().position(|column| *column != Column::Polygons).unwrap_or(0) => {
                    "left out".to_owned()
                }
                _ => "–".to_owned(),
            };
            std::iter::once(left_out.setting.clone()).chain(columns.iter().enumerate().map(cell)).collect()
        }
    };
    let rows = of_paper.iter().map(paper_row).chain(runs.iter().map(our_row)).collect();
    Table { caption, head, rows }
}

/// A sentence for each run that was left out.
pub fn left_out_remarks(runs: &[Result<Run, LeftOut>]) -> Vec<String> {
    let of = |left_out: &LeftOut| {
        format!("Left out: {}, {} polygons: {}.", left_out.setting, count(left_out.polygons), left_out.why)
    };
    runs.iter().filter_map(|run| run.as_ref().err()).map(of).collect()
}

/// The paper's rows and ours as records.
pub fn records(scene: &str, of_paper: &[paper::Row], runs: &[Result<Run, LeftOut>]) -> Vec<Record> {
    let paper_record = |row: &paper::Row| {
        vec![
            ("source", "paper".to_owned()),
            ("scene", scene.to_owned()),
            ("setting", row.name.to_owned()),
            ("seconds", row.seconds.to_string()),
            ("initial_patches", row.initial_patches.to_string()),
            ("patches", row.patches.to_string()),
            ("clusters", row.clusters.map_or(String::new(), |clusters| clusters.to_string())),
            ("links", row.links.to_string()),
        ]
    };
    let our_record = |run: &Result<Run, LeftOut>| match run {
        Ok(run) => record(run),
        Err(left_out) => vec![
            ("source", "selflink".to_owned()),
            ("scene", scene.to_owned()),
            ("setting", left_out.setting.clone()),
            ("initial_patches", left_out.polygons.to_string()),
            ("left_out", left_out.why.clone()),
        ],
    };
    of_paper.iter().map(paper_record).chain(runs.iter().map(our_record)).collect()
}

/// A run with every parameter and count.
fn record(run: &Run) -> Record {
    let stats = &run.stats;
    let mut record = vec![
        ("source", "selflink".to_owned()),
        ("scene", run.scene.to_owned()),
        ("setting", run.setting.clone()),
        ("seconds", run.time().to_string()),
        ("initial_patches", stats.initial_patches.to_string()),
        ("patches", stats.patches.to_string()),
        ("clusters", stats.clusters.to_string()),
        ("links", stats.links.to_string()),
        ("left_out", String::new()),
        ("seconds_of_runs", run.seconds.iter().map(f64::to_string).collect::<Vec<_>>().join(" ")),
        ("hierarchy_seconds", stats.seconds.hierarchy.to_string()),
        ("refine_seconds", stats.seconds.refine.to_string()),
        ("gather_seconds", stats.seconds.gather.to_string()),
        ("pairs_judged", stats.pairs_judged.to_string()),
        ("rays", stats.rays.to_string()),
        ("links_with_rays", run.links_with_rays.to_string()),
        ("links_at_bound", run.links_at_bound.to_string()),
        ("link_bytes", stats.bytes.links.to_string()),
        ("element_bytes", stats.bytes.elements.to_string()),
        ("iterations", stats.iterations.to_string()),
        ("clamped_leaves", stats.clamped_leaves.to_string()),
        ("depth_guard_struck", stats.depth_guard_struck.to_string()),
        ("epsilon_relative", stats.epsilon_relative.to_string()),
        ("epsilon_watts", stats.epsilon_watts.to_string()),
    ];
    record.extend(parameter_columns(&run.params));
    record.push(("threads", run.threads.to_string()));
    if let Some(error) = &run.error {
        record.extend([
            ("rms", error.displayed.rms.to_string()),
            ("rms_noise", error.displayed.rms_noise.to_string()),
            ("rms_leaves", error.leaves.rms.to_string()),
            ("bias", error.displayed.bias.to_string()),
            ("local_median", error.displayed.local_median.to_string()),
            ("local_median_noise", error.displayed.local_median_noise.to_string()),
            ("local_p95", error.displayed.local_p95.to_string()),
            ("dark_median", error.displayed.dark_median.to_string()),
            ("dark_p95", error.displayed.dark_p95.to_string()),
            ("reference_noise", error.reference_noise.to_string()),
            ("reference_points", error.points.to_string()),
        ]);
    }
    record
}
