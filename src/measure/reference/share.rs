//! How many of the paths each point gets.

use super::points::SurfacePoint;
use super::sums::{Sums, reflected};

/// The least share of a point, in batches per pass, whatever the pilot found there: it may have
/// missed what is rare.
const LEAST: f64 = 0.25;
/// Share of the paths that goes by the scatter itself; the rest goes by the scatter relative to the
/// mean.
const BY_SCATTER: f64 = 0.65;
/// The largest share: beyond it one point would keep a pass too long.
const MOST: f64 = 64.0;

/// Batches of each point per pass, 1 on average.
///
/// Most of what is to be shared goes by how far a point's batches scatter, which lowers the noise
/// over all points the most \[Neyman 1934\], and by the root of what it counts; the rest by how far
/// they do relative to their mean, which counts for the local error of dark places.
pub fn shares(points: &[SurfacePoint], pilot: &[Sums]) -> Vec<f64> {
    let scatter = |(point, sums): (&SurfacePoint, &Sums)| {
        let (error, mean) = (sums.standard_error(), sums.mean());
        let reflects = point.reflectance.max_element() > 0.0;
        let of = |value| if reflects { reflected(point, value) } else { value };
        let (error, mean) = (of(error).length(), of(mean).length());
        // A pilot that met light in one batch of eight tells no more than that.
        (f64::from(point.weight).sqrt() * error, if mean > 0.0 { (error / mean).min(1.0) } else { 0.0 })
    };
    let scatters: Vec<(f64, f64)> = points.iter().zip(pilot).map(scatter).collect();
    let sums = scatters.iter().fold((0.0, 0.0), |sums, scatter| (sums.0 + scatter.0, sums.1 + scatter.1));
    let count = points.len() as f64;
    let part = |value: f64, sum: f64| if sum > 0.0 && sum.is_finite() { value / sum * count } else { 1.0 };
    let share = |scatter: &(f64, f64)| {
        let wanted = BY_SCATTER * part(scatter.0, sums.0) + (1.0 - BY_SCATTER) * part(scatter.1, sums.1);
        (LEAST + (1.0 - LEAST) * wanted).min(MOST)
    };
    scatters.iter().map(share).collect()
}
