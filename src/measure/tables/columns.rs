//! Rows of tables and records: the paper's, ours, and those that were left out.

use super::lab::{LeftOut, Run};
use super::paper;
use crate::base::format::{bytes, count, grouped, number, quantity};
use crate::measure::chart::parameter_columns;
use crate::measure::records::{Record, Table, columns, optional};

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
        let mut record =
            vec![("source", "paper".to_owned()), ("scene", scene.to_owned()), ("setting", row.name.into())];
        record.extend(columns!(row; seconds, initial_patches, patches));
        record.push(optional("clusters", row.clusters));
        record.extend(columns!(row; links));
        record
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
    let (stats, seconds) = (&run.stats, &run.stats.seconds);
    let mut record = vec![("source", "selflink".to_owned())];
    record.extend(columns!(run; scene, setting));
    record.push(("seconds", run.time().to_string()));
    record.extend(columns!(stats; initial_patches, patches, clusters, links));
    record.extend([
        ("left_out", String::new()),
        ("seconds_of_runs", run.seconds.iter().map(f64::to_string).collect::<Vec<_>>().join(" ")),
        ("hierarchy_seconds", seconds.hierarchy.to_string()),
        ("refine_seconds", seconds.refine.to_string()),
        ("gather_seconds", seconds.gather.to_string()),
    ]);
    record.extend(columns!(stats; pairs_judged, rays));
    record.extend(columns!(run; links_with_rays, links_at_bound));
    record.extend([("link_bytes", stats.bytes.links.to_string()), ("element_bytes", stats.bytes.elements.to_string())]);
    record.extend(columns!(stats; iterations, clamped_leaves, depth_guard_struck, epsilon_relative, epsilon_watts));
    record.extend(parameter_columns(&run.params));
    record.extend(columns!(run; threads));
    if let Some(error) = &run.error {
        let shown = &error.displayed;
        record.extend(columns!(shown; rms, rms_noise));
        record.push(("rms_leaves", error.leaves.rms.to_string()));
        record.extend(columns!(shown; bias, local_median, local_median_noise, local_p95, dark_median, dark_p95));
        record.extend(columns!(error; reference_noise));
        record.push(("reference_points", error.points.to_string()));
    }
    record
}
