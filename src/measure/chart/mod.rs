//! Speed against accuracy: the same scene solved with many settings, each run's error beside its
//! time, links and rays.
//!
//! A [`Sweep`] is a list of named settings and thresholds; [`Sweep::run`] makes a [`Chart`] of it,
//! which is written as CSV and JSON and drawn as pictures. The path tracer stands in the same chart
//! with the same clock. A [`PictureSweep`] does the same for pictures.

mod axis;
mod draw;
mod pareto;
mod path_tracer;
mod picture;
mod record;
mod sweep;
mod write;

pub use draw::{Against, DrawError, Drawing, Plot, Shown, draw_png, draw_svg};
pub use picture::{
    MeshPainter, PictureChart, PictureDrawing, PictureKind, PictureMetric, PictureRecord, PictureReference,
    PictureSweep, mean_flip, picture_csv, picture_table,
};
pub use record::{Chart, PathTracerRecord, ReferenceRecord, RunRecord, SkippedRun};
pub(crate) use sweep::within;
pub use sweep::{Setting, Sweep, usual_epsilons, usual_settings};
pub(crate) use write::parameter_columns;
pub use write::{csv, error_table, target_table};
