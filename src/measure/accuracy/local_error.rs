//! The local error of irradiances: |ΔE|/(E + E₀) at each point, and its quantiles over the area.
//!
//! An RMS over radiosities is ruled by the brightest places; relative errors alone by the darkest.
//! E₀ is a tenth of the median of E over the area: an error counts relative to the light of its own
//! place, and where there is next to none, relative to a dim place of the scene.

use glam::DVec3;
use serde::Serialize;

use super::spread::{of_quantile, quantile, sorted};
use crate::measure::reference::Reference;

/// E₀ as a share of the median of E.
const FLOOR: f64 = 0.1;
/// The quantile that is the main figure: *9 of 10 surfaces within …*.
pub const MAIN_SHARE: f64 = 0.9;
/// Half of all normal errors are below 0.6745 of their standard deviation, 90 % below 1.6449, 95 %
/// below 1.96.
const OF_NORMAL: [(f64, f64); 3] = [(0.5, 0.674_489_750), (0.9, 1.644_853_627), (0.95, 1.959_963_985)];

/// Quantiles of the local error over the area, shares.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct LocalError {
    /// Median: half of the area is off by no more.
    pub p50: f64,
    /// 9 of 10 surfaces are off by at most this.
    pub p90: f64,
    /// Standard error of `p90`: half the distance between the quantiles one standard deviation of
    /// the rank below and above. Infinite where only one point was compared.
    pub p90_noise: f64,
    /// 95th percentile.
    pub p95: f64,
    /// Root of the mean square.
    pub rms: f64,
    /// Median of the reference's own local standard errors, colours together: `p50` cannot tell
    /// less apart.
    pub reference_noise: f64,
    /// E₀, W/m², mean of the colours.
    pub floor: f64,
}

/// A point that is compared: irradiances in W/m², mean of the colours.
#[derive(Clone, Copy, Debug)]
pub struct Compared {
    /// The truth E.
    pub truth: f64,
    /// How far from it the solution is, with its sign.
    pub difference: f64,
    /// Standard error of the truth.
    pub noise: f64,
    /// The area that the point stands for, in any unit.
    pub weight: f64,
}

impl Compared {
    /// A point of a reference, given what a solution finds there.
    pub fn new(reference: &Reference, index: usize, found: DVec3) -> Self {
        let mean = |value: DVec3| value.element_sum() / 3.0;
        let truth = mean(reference.irradiance[index]);
        Self {
            truth,
            difference: mean(found) - truth,
            // The colours of a path are bright or dark together.
            noise: mean(reference.standard_error[index]),
            weight: f64::from(reference.points[index].weight),
        }
    }
}

impl LocalError {
    /// Of points that are compared; the truth's noise is subtracted from each difference as far as
    /// it is larger.
    pub fn of(points: &[Compared]) -> Self {
        let floor = FLOOR * median_of(points);
        let relative = |value: f64, point: &Compared| {
            let scale = point.truth + floor;
            if scale > 0.0 {
                value / scale
            } else if value > 0.0 {
                1.0
            } else {
                0.0
            }
        };
        let beyond = |point: &Compared| (point.difference.powi(2) - point.noise.powi(2)).max(0.0).sqrt();
        let errors = sorted(points.iter().map(|point| (relative(beyond(point), point), point.weight)));
        let noises = sorted(points.iter().map(|point| (relative(point.noise, point), point.weight)));
        let weight: f64 = errors.iter().map(|error| error.1).sum();
        let square: f64 = errors.iter().map(|error| error.1 * error.0 * error.0).sum();
        Self {
            p50: quantile(&errors, 0.5),
            p90: quantile(&errors, MAIN_SHARE),
            p90_noise: of_quantile(&errors, MAIN_SHARE),
            p95: quantile(&errors, 0.95),
            rms: if weight > 0.0 { (square / weight).sqrt() } else { 0.0 },
            reference_noise: quantile(&noises, 0.5),
            floor,
        }
    }

    /// Local error of an unbiased estimate with these standard errors, taken for normal ones.
    pub fn of_standard_errors(estimate: &Reference) -> Self {
        let of = |index: usize| Compared::new(estimate, index, estimate.irradiance[index]);
        let points: Vec<Compared> = (0..estimate.points.len()).map(of).collect();
        let floor = FLOOR * median_of(&points);
        let scaled: Vec<(f64, f64)> = points
            .iter()
            .filter(|point| point.truth + floor > 0.0)
            .map(|point| (point.noise / (point.truth + floor), point.weight))
            .collect();
        let [p50, p90, p95] = OF_NORMAL.map(|(share, _)| quantile_of_normals(&scaled, share));
        let weight: f64 = scaled.iter().map(|point| point.1).sum();
        let square: f64 = scaled.iter().map(|point| point.1 * point.0 * point.0).sum();
        let noises = sorted(scaled.iter().copied());
        let p90_noise = of_quantile(&noises, MAIN_SHARE) * OF_NORMAL[1].1;
        let rms = if weight > 0.0 { (square / weight).sqrt() } else { 0.0 };
        Self { p50, p90, p90_noise, p95, rms, reference_noise: 0.0, floor }
    }
}

/// Median of the truth over the area, or a tenth of its mean where more than half of the area is
/// dark.
fn median_of(points: &[Compared]) -> f64 {
    let weight: f64 = points.iter().map(|point| point.weight).sum();
    let sum: f64 = points.iter().map(|point| point.weight * point.truth).sum();
    let median = quantile(&sorted(points.iter().map(|point| (point.truth, point.weight))), 0.5);
    median.max(0.1 * sum / weight.max(f64::MIN_POSITIVE))
}

/// The value below which this share of the magnitudes of normal errors lies, of given standard
/// deviations and weights: a mixture, by bisection.
fn quantile_of_normals(deviations: &[(f64, f64)], share: f64) -> f64 {
    let weight: f64 = deviations.iter().map(|point| point.1).sum();
    let largest = deviations.iter().map(|point| point.0).fold(0.0, f64::max);
    if weight <= 0.0 || largest <= 0.0 || !largest.is_finite() {
        return if largest.is_finite() { 0.0 } else { f64::INFINITY };
    }
    let below = |value: f64| {
        let of =
            |(deviation, weight): &(f64, f64)| weight * if *deviation > 0.0 { within(value / deviation) } else { 1.0 };
        deviations.iter().map(of).sum::<f64>() / weight
    };
    let (mut low, mut high) = (0.0, 8.0 * largest);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if below(middle) < share { low = middle } else { high = middle }
    }
    high
}

/// Share of normal errors within so many standard deviations.
fn within(deviations: f64) -> f64 {
    libm::erf(deviations * std::f64::consts::FRAC_1_SQRT_2)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn point(truth: f64, difference: f64, weight: f64) -> Compared {
        Compared { truth, difference, noise: 0.0, weight }
    }

    /// Truth: worked out by hand. Nine points of E = 2 that are 0.11 off, and a dark one of E = 0
    /// shown as 0.4: E₀ = 0.2, so 5 % and 200 %.
    #[test]
    fn dark_places_count_relative_to_a_dim_one() {
        let mut points = vec![point(2.0, 0.11, 1.0); 19];
        points.push(point(0.0, 0.4, 1.0));
        let found = LocalError::of(&points);
        assert!((found.floor - 0.2).abs() < 1e-12 && (found.p50 - 0.05).abs() < 1e-12, "{found:?}");
        assert!((found.p90 - 0.05).abs() < 1e-12 && (found.p95 - 2.0).abs() < 1e-12, "{found:?}");
        assert!((found.rms - ((19.0 * 0.0025 + 4.0) / 20.0_f64).sqrt()).abs() < 1e-12, "{found:?}");
        let dark = LocalError::of(&[point(0.0, 0.0, 1.0), point(0.0, 0.5, 1.0)]);
        assert_eq!((dark.p50, dark.floor), (1.0, 0.0), "light where there should be none at all is wholly wrong");
        assert_eq!(LocalError::of(&[]), LocalError::default());
    }

    /// Truth: the definition. A point of weight 3 is three points.
    #[test]
    fn a_weight_is_so_many_points() {
        let kinds = [(1.0, 0.1), (2.0, 0.4), (7.0, 0.7)];
        let of = |weights: [usize; 3], counts: [usize; 3]| {
            let points =
                kinds.into_iter().zip(weights).zip(counts).flat_map(|(((truth, off), weight), count)| {
                    (0..count).map(move |_| point(truth, off, weight as f64))
                });
            let found = LocalError::of(&points.collect::<Vec<_>>());
            [found.p50, found.p90, found.p95, found.rms, found.floor]
        };
        let pairs = of([5, 3, 1], [2, 2, 2]).into_iter().zip(of([1, 1, 1], [10, 6, 2]));
        assert!(pairs.into_iter().all(|(one, other)| (one - other).abs() < 1e-12));
    }

    /// Truth: what the noise of the truth adds to a difference is subtracted again.
    #[test]
    fn noise_is_not_taken_for_an_error() {
        let noisy = Compared { truth: 1.0, difference: 0.05, noise: 0.03, weight: 1.0 };
        let found = LocalError::of(&[noisy; 4]);
        assert!((found.p50 - 0.04 / 1.1).abs() < 1e-12 && (found.reference_noise - 0.03 / 1.1).abs() < 1e-12);
        let within = Compared { noise: 0.06, ..noisy };
        assert_eq!(LocalError::of(&[within; 4]).p90, 0.0);
    }

    /// Truth: quantiles of the normal distribution, and a mixture by hand: half of the points
    /// without an error, so that the median of the others is the 75th percentile of all.
    #[test]
    fn quantiles_of_normal_errors() {
        for (share, deviations) in OF_NORMAL {
            let found = quantile_of_normals(&[(0.2, 1.0), (0.2, 3.0)], share);
            assert!((found - 0.2 * deviations).abs() < 1e-6, "{found}");
        }
        let found = quantile_of_normals(&[(0.0, 1.0), (0.2, 1.0)], 0.75);
        assert!((found - 0.2 * OF_NORMAL[0].1).abs() < 1e-6, "{found}");
    }
}
