//! The certificate: what is read, beside light that is looked for anew, at points that nothing else knows.
//!
//! A reading looks once from a point and reads the field where its rays end. The comparison looks from those ends once more:
//! what that changes is the field's own error as one reflection hands it on. Further reflections hand on a share ρ̄, the mean
//! reflectance, of it each (the Neumann series), but mix it over the scene: they add ρ̄/(1−ρ̄) times its mean. To that comes
//! the noise that readings have, a normal one of their standard error; as far as the change is noisy itself, that stands for it.
//! So each point, random by area and never replaced, has a probability of being off by more than any x, and the mean of these
//! is the share of the area that is. Its own standard error over the points tells how sure that is.

use libm::erfc;
use rayon::prelude::*;
use serde::Serialize;

use super::estimator::Checked;
use super::field::{Field, grey};
use crate::cancel::CancelToken;
use crate::hierarchy::{ElementId, SurfacePoint};
use crate::random::{even_point, mix};

/// The share of the area that is to be within the target error.
pub const SHARE: f64 = 0.9;
/// Probability that a run reports a bound that does not hold, over all its looks.
pub const RISK: f64 = 0.05;
/// The mean reflectance counts as no more than this.
const MOST_REFLECTANCE: f64 = 0.9;
/// Points compared: so many, and more where these leave it open whether the target is kept.
const POINTS: [usize; 4] = [64, 96, 192, 384];
/// Points that count as missed beside those compared: a share of which few points tell is not normally distributed [as
/// Agresti, Coull, *Approximate is better than "exact"*, The American Statistician 52, 1998].
const ADDED_MISSES: f64 = 2.0;
/// Standard errors beyond which a field is seen to be too coarse.
const HOPELESS: f64 = 2.0;
/// Points after which a running error is told.
const LEAST_TOLD: usize = 32;
/// Points of a leaf hidden in part that are tried, and the rays that tell whether one is hidden.
const TRIES: u32 = 8;
const HIDDEN_RAYS: u32 = 16;
/// Points compared between two looks at commands.
const CHUNK: usize = 16;
/// Standard error of readings, as a share of the target error.
pub const NOISE: f64 = 0.33;

/// Quantiles over the area of the local error |ΔE|/(E + E₀).
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Quantiles {
    /// Median.
    pub p50: f64,
    /// Nine tenths of the area are within this.
    pub p90: f64,
    /// 95 % of the area are within this.
    pub p95: f64,
    /// Root of the mean square.
    pub rms: f64,
}

impl Quantiles {
    /// Of the errors at some points that stand for equal areas, which are sorted.
    pub fn of(errors: &mut [f64]) -> Self {
        errors.sort_by(f64::total_cmp);
        let count = errors.len();
        if count == 0 {
            return Self::default();
        }
        let quantile = |share: f64| errors[((share * count as f64).ceil() as usize).clamp(1, count) - 1];
        let squares: f64 = errors.iter().map(|error| error * error).sum();
        let rms = (squares / count as f64).sqrt();
        Self { p50: quantile(0.5), p90: quantile(SHARE), p95: quantile(0.95), rms }
    }

    fn of_points(errors: &[PointError]) -> Self {
        let count = errors.len() as f64;
        let beyond = |limit: f64| errors.iter().map(|error| error.exceeds(limit)).sum::<f64>() / count;
        let quantile = |share: f64| least_limit(beyond, 1.0 - share);
        let squares: f64 = errors.iter().map(|error| error.mean.powi(2) + error.deviation.powi(2)).sum();
        Self { p50: quantile(0.5), p90: quantile(SHARE), p95: quantile(0.95), rms: (squares / count).sqrt() }
    }
}

/// What is known of the error of readings.
#[derive(Clone, Debug, Default)]
pub struct Certificate {
    /// Nine tenths of the area are within this, with a probability of 1 − [`RISK`].
    pub bound: f64,
    /// What was found at the points.
    pub read: Quantiles,
    /// RMS error of B over the area, as a share of its RMS.
    pub radiosity_rms: f64,
    /// The points with their irradiance (mean of the colours, W/m²).
    pub points: Vec<(SurfacePoint, f32)>,
}

/// A point that was compared; all lights are means of the colours, W/m².
#[derive(Clone, Copy, Debug)]
struct Compared {
    point: SurfacePoint,
    /// E as one looked for it anew.
    truth: f32,
    /// Change of E by the field's error after one reflection.
    change: f32,
    /// Standard error of a reading, and of the change.
    noise: f32,
    change_noise: f32,
    reflectance: f32,
    emission: f32,
    rays: u64,
}

/// Local error at a point: normally distributed.
#[derive(Clone, Copy, Debug)]
struct PointError {
    mean: f64,
    deviation: f64,
}

impl PointError {
    /// Probability that it is larger than this.
    fn exceeds(self, limit: f64) -> f64 {
        let beyond = |distance: f64| {
            if self.deviation > 0.0 {
                0.5 * erfc(distance / (std::f64::consts::SQRT_2 * self.deviation))
            } else {
                f64::from(u8::from(distance < 0.0))
            }
        };
        beyond(limit - self.mean) + beyond(limit + self.mean)
    }
}

/// The share of points that are off by more than this, and the standard error of that share; so many points that were missed
/// are added.
fn share_beyond(errors: &[PointError], added: f64, limit: f64) -> (f64, f64) {
    let count = errors.len() as f64 + added;
    let (mut sum, mut squares) = (added, added);
    for error in errors {
        let share = error.exceeds(limit);
        sum += share;
        squares += share * share;
    }
    let mean = sum / count;
    (mean, ((squares / count - mean * mean).max(0.0) / (count - 1.0)).sqrt())
}

/// What nine tenths of the area are within, with a probability of 1 − `risk` over all counts of points that are tried.
fn bound(errors: &[PointError], risk: f64) -> f64 {
    let sure = deviations(risk / POINTS.len() as f64);
    let at_most = |limit: f64| {
        let (beyond, error) = share_beyond(errors, ADDED_MISSES, limit);
        beyond + sure * error
    };
    least_limit(at_most, 1.0 - SHARE)
}

/// Whether so many are beyond the target that more points would not help.
fn is_hopeless(errors: &[PointError], target: f64) -> bool {
    let (beyond, error) = share_beyond(errors, 0.0, target);
    beyond - HOPELESS * error > 1.0 - SHARE
}

/// The least limit at which a falling function is no more than this.
fn least_limit(of: impl Fn(f64) -> f64, allowed: f64) -> f64 {
    let mut high = 1e-4;
    while of(high) > allowed && high < 1e6 {
        high *= 2.0;
    }
    let mut low = 0.0;
    for _ in 0..30 {
        let middle = 0.5 * (low + high);
        *(if of(middle) > allowed { &mut low } else { &mut high }) = middle;
    }
    high
}

/// Standard deviations that a normal variable exceeds with this probability.
fn deviations(probability: f64) -> f64 {
    least_limit(|limit| 0.5 * erfc(limit / std::f64::consts::SQRT_2), probability)
}

/// A comparison at work.
#[derive(Clone, Debug)]
pub struct Certifying {
    target: f64,
    risk: f64,
    seed: u64,
    leaves: Vec<ElementId>,
    /// Σ of areas up to each leaf, m².
    ends: Vec<f64>,
    /// ρ̄/(1−ρ̄).
    further: f64,
    dim: f32,
    compared: Vec<Compared>,
    is_thorough: bool,
}

impl Certifying {
    /// Starts over a field; each attempt of a run takes half of the risk that is left.
    pub fn new(field: &Field, target: f64, attempt: u32, seed: u64) -> Self {
        let (mut sum, mut reflectance) = (0.0, 0.0);
        let leaves: Vec<ElementId> = field.leaves().filter(|leaf| !field.emits(*leaf)).collect();
        let mut ends = Vec::with_capacity(leaves.len());
        for leaf in &leaves {
            let area = f64::from(field.area(*leaf));
            sum += area;
            reflectance += area * f64::from(grey(field.surface(field.patch(*leaf).polygon).reflectance));
            ends.push(sum);
        }
        let mean = if sum > 0.0 { f64::min(reflectance / sum, MOST_REFLECTANCE) } else { 0.0 };
        Self {
            target,
            risk: RISK * 0.5_f64.powi(attempt as i32 + 1),
            seed,
            leaves,
            ends,
            further: mean / (1.0 - mean),
            dim: field.dim(),
            compared: Vec::new(),
            is_thorough: false,
        }
    }

    /// Compares at some more points; `None` if cancelled.
    pub fn advance(&mut self, field: &Field, cancel: &CancelToken) -> Option<()> {
        if self.total() <= 0.0 {
            return Some(());
        }
        let first = self.compared.len();
        let compare = |index: usize| (!cancel.is_cancelled()).then(|| self.compare(field, index));
        let found: Vec<Compared> = (first..first + CHUNK).into_par_iter().map(compare).collect::<Option<_>>()?;
        self.compared.extend(found);
        Some(())
    }

    /// Whether more points can be compared.
    pub fn has_more(&self) -> bool {
        self.total() > 0.0 && self.compared.len() < POINTS[POINTS.len() - 1]
    }

    /// Compares at all points from now on, unless the target is seen to be kept: nothing finer will follow.
    pub fn be_thorough(&mut self) {
        self.is_thorough = true;
    }

    fn total(&self) -> f64 {
        self.ends.last().copied().unwrap_or(0.0)
    }

    fn compare(&self, field: &Field, index: usize) -> Compared {
        let seed = mix(self.seed, index as u64);
        // A low-discrepancy sequence over the leaves, so that any number of points is spread evenly.
        let [along, _] = even_point(mix(self.seed, 1), index as u32);
        let wanted = f64::from(along) * self.total();
        let place = self.ends.partition_point(|end| *end <= wanted).min(self.ends.len() - 1);
        let [u, v] = even_point(mix(self.seed, 2), index as u32);
        let point = self.exposed_point(field, self.leaves[place], [u, v], seed);
        let at = (point.position, point.normal);
        let error = (NOISE * self.target) as f32;
        let Checked { read, noise, change, change_noise } = field.checked_at(at, error, mix(seed, 3));
        let surface = field.surface(point.polygon);
        Compared {
            point,
            truth: (grey(read.mean) + change).max(0.0),
            change,
            noise,
            change_noise,
            reflectance: grey(surface.reflectance),
            emission: grey(surface.emission),
            rays: read.rays,
        }
    }

    /// A point of a leaf that does not hide under something, unless all of it seems to.
    fn exposed_point(&self, field: &Field, leaf: ElementId, [u, v]: [f32; 2], seed: u64) -> SurfacePoint {
        let point = field.hierarchy.point_on(leaf, u, v);
        if !field.patch(leaf).is_hidden_in_part() {
            return point;
        }
        let other = |number: u32| {
            let [u, v] = even_point(mix(seed, 6), number);
            field.hierarchy.point_on(leaf, u, v)
        };
        let mut points = std::iter::once(point).chain((0..TRIES).map(other));
        points.find(|point| !field.hides(point.position, point.normal, mix(seed, 7), HIDDEN_RAYS)).unwrap_or(point)
    }

    /// What was found, once enough points were compared to tell whether the target is kept, or that it is not.
    pub fn certificate(&self) -> Option<Certificate> {
        if self.total() <= 0.0 {
            return Some(Certificate::default());
        }
        let count = self.compared.len();
        if !POINTS.contains(&count) {
            return None;
        }
        let errors = self.errors();
        let bound = bound(&errors, self.risk);
        let is_told = bound <= self.target || !self.is_thorough && is_hopeless(&errors, self.target);
        if !is_told && self.has_more() {
            return None;
        }
        let read = Quantiles::of_points(&errors);
        let sum = |of: &dyn Fn(&Compared, &PointError) -> f64| {
            self.compared.iter().zip(&errors).map(|(compared, error)| of(compared, error)).sum::<f64>()
        };
        let all = sum(&|compared, _| f64::from(compared.emission + compared.reflectance * compared.truth).powi(2));
        let wrong = sum(&|compared, error| {
            let scale = f64::from(compared.reflectance) * self.scale(compared);
            scale * scale * (error.mean.powi(2) + error.deviation.powi(2))
        });
        Some(Certificate {
            bound,
            read,
            radiosity_rms: if all > 0.0 { (wrong / all).sqrt() } else { 0.0 },
            points: self.compared.iter().map(|compared| (compared.point, compared.truth)).collect(),
        })
    }

    /// E + E₀, W/m².
    fn scale(&self, compared: &Compared) -> f64 {
        f64::from(compared.truth + self.dim).max(f64::MIN_POSITIVE)
    }

    fn errors(&self) -> Vec<PointError> {
        let change = |compared: &Compared| f64::from(compared.change) / self.scale(compared);
        let mean = self.compared.iter().map(change).sum::<f64>() / self.compared.len() as f64;
        let error = |compared: &Compared| {
            let variance = f64::from(compared.noise).powi(2) - f64::from(compared.change_noise).powi(2);
            PointError {
                mean: change(compared) + self.further * mean,
                deviation: variance.max(0.0).sqrt() / self.scale(compared),
            }
        };
        self.compared.iter().map(error).collect()
    }

    /// The points compared so far, with their irradiance and its standard error (means of the colours, W/m²).
    pub fn compared(&self) -> impl ExactSizeIterator<Item = (SurfacePoint, f32, f32)> {
        self.compared
            .iter()
            .map(|compared| (compared.point, compared.truth, compared.noise.hypot(compared.change_noise)))
    }

    /// Whether there is nothing to compare at.
    pub fn is_empty(&self) -> bool {
        self.total() <= 0.0
    }

    /// Share of the points that usually suffice.
    pub fn progress(&self) -> f32 {
        (self.compared.len() as f32 / POINTS[0] as f32).min(1.0)
    }

    /// The local error within which nine tenths of the points are, once there are enough of them to tell.
    pub fn error_so_far(&self) -> Option<f64> {
        (self.compared.len() >= LEAST_TOLD).then(|| Quantiles::of_points(&self.errors()).p90)
    }

    /// Rays cast.
    pub fn rays(&self) -> u64 {
        self.compared.iter().map(|compared| compared.rays).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::fraction;

    /// Truth: tables of the normal distribution.
    #[test]
    fn normal_deviations() {
        assert!((deviations(0.025) - 1.959_964).abs() < 1e-4);
        let error = PointError { mean: 0.0, deviation: 2.0 };
        assert!((error.exceeds(2.0) - 0.317_311).abs() < 1e-5);
        assert_eq!(PointError { mean: 0.3, deviation: 0.0 }.exceeds(0.2), 1.0);
    }

    /// Sampled coverage, where 90 % of all points are within 1: errors that are all much alike,
    /// and good ones with rare outliers.
    #[test]
    fn bounds_hold_as_often_as_they_say() {
        const RUNS: u32 = 2000;
        const RISK: f64 = 0.025;
        let number = |seed: u32, index: usize| f64::from(fraction(mix(mix(7, seed.into()), index as u64) as u32));
        let uniform = |seed, index| PointError { mean: number(seed, index) / 0.9, deviation: 0.0 };
        let outliers = |seed, index| {
            let mean = if number(seed, index) < 0.1 { 10.0 } else { 0.99 };
            PointError { mean, deviation: 0.0 }
        };
        for of in [&uniform as &dyn Fn(u32, usize) -> PointError, &outliers] {
            let is_missed = |seed: &u32| {
                let errors: Vec<PointError> = (0..POINTS[POINTS.len() - 1]).map(|index| of(*seed, index)).collect();
                POINTS.iter().any(|count| bound(&errors[..*count], RISK) < 1.0 - 1e-6)
            };
            let missed = f64::from((0..RUNS).filter(is_missed).count() as u32);
            // Four standard deviations more than the risk; the bound is not far below either.
            let expected = RISK * f64::from(RUNS);
            assert!(missed < expected + 4.0 * expected.sqrt(), "{missed}");
            assert!(missed > 0.1 * expected, "{missed}");
        }
    }
}
