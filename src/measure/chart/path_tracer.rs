//! The path tracer as a curve: its error over time on one fixed set of points.

use std::time::{Duration, Instant};

use super::record::PathTracerRecord;
use crate::base::cancel::CancelToken;
use crate::measure::accuracy::{LocalError, of_standard_errors};
use crate::measure::reference::{ReferenceRun, random_points};
use crate::scene::Scene;

/// Keeps its points and paths apart from those of the reference.
const SALT: u64 = 0x0063_7572_7665;
/// Half of all normal errors are below this share of their standard deviation.
const MEDIAN_OF_NORMAL: f64 = 0.6745;

/// Lets it compute `points` random points for `limit`, and writes down how far it is after 2, 4, 8,
/// … passes.
pub fn curve(scene: &Scene, points: usize, seed: u64, limit: Duration, cancel: &CancelToken) -> Vec<PathTracerRecord> {
    let seed = seed ^ SALT;
    let points = random_points(scene, points, seed);
    let mut records = Vec::new();
    if points.is_empty() {
        return records;
    }
    let mut run = ReferenceRun::new(scene, points.into(), seed);
    // The clock stands while the error is counted up.
    let mut spent = Duration::ZERO;
    while spent < limit {
        let begun = Instant::now();
        if !run.pass(cancel) {
            break;
        }
        spent += begun.elapsed();
        if run.passes() >= 2 && run.passes().is_power_of_two() {
            let reference = run.reference();
            let of_sigma = of_standard_errors(&reference);
            records.push(PathTracerRecord {
                points: reference.points.len(),
                paths: reference.paths,
                seconds: spent.as_secs_f64(),
                error: reference.noise(),
                error_noise: of_sigma.rms_noise,
                local_median: MEDIAN_OF_NORMAL * of_sigma.local_median,
                local_median_noise: MEDIAN_OF_NORMAL * of_sigma.local_median_noise,
                local: LocalError::of_standard_errors(&reference),
            });
        }
    }
    records
}
