//! The certificate: what is read, beside light that is looked for anew, at points that nothing else knows.
//!
//! A reading looks once from a point and reads the field where its rays end. The comparison looks from those ends once more:
//! what that changes is the field's own error as one reflection hands it on. Further reflections hand on a share ρ̄, the mean
//! reflectance, of it each (the Neumann series), but mix it over the scene: they add ρ̄/(1−ρ̄) times its mean. To that comes
//! the noise that readings have. The points are random by area and stay as they fall; the bound on the quantile is that of the
//! binomial distribution, which asks nothing of the errors.

use rayon::prelude::*;
use serde::Serialize;

use super::estimator::{Budget, Depth};
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
/// Points compared.
const POINTS: usize = 192;
/// Points of a leaf hidden in part that are tried, and the rays that tell whether one is hidden.
const TRIES: u32 = 8;
const HIDDEN_RAYS: u32 = 16;
/// Points compared between two looks at commands.
const CHUNK: usize = 4;
/// Standard error of readings, as a share of the target error.
pub const NOISE: f64 = 0.4;

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

/// A point that was compared.
#[derive(Clone, Copy, Debug)]
struct Compared {
    point: SurfacePoint,
    /// E as one looked for it anew, mean of the colours, W/m².
    truth: f32,
    /// Change of E by the field's error after one reflection, and the noise of a reading, mean of the colours, W/m².
    change: f32,
    noise: f32,
    /// Reflectance and emission, mean of the colours.
    reflectance: f32,
    emission: f32,
    rays: u64,
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
        let budget = Budget::to_error((NOISE * self.target) as f32);
        let read = field.irradiance_at(at, &budget, mix(seed, 3), Depth::Near);
        // The same rays, so that the change is not their noise.
        let same = Budget { least: read.looks, most: read.looks, ..budget };
        let beyond = field.irradiance_at(at, &same, mix(seed, 3), Depth::Further);
        let change = grey(beyond.mean - read.mean);
        // What another reading differs by, over the root of two: the noise of one.
        let other = field.irradiance_at(at, &budget, mix(seed, 4), Depth::Near);
        let noise = std::f32::consts::FRAC_1_SQRT_2 * grey(other.mean - read.mean);
        let surface = field.surface(point.polygon);
        Compared {
            point,
            truth: (grey(read.mean) + change).max(0.0),
            change,
            noise,
            reflectance: grey(surface.reflectance),
            emission: grey(surface.emission),
            rays: read.rays + beyond.rays + other.rays,
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
        if count < POINTS {
            return None;
        }
        let scale = |compared: &Compared| f64::from(compared.truth + self.dim);
        let change = |compared: &Compared| f64::from(compared.change) / scale(compared).max(f64::MIN_POSITIVE);
        let beyond = self.further * self.compared.iter().map(change).sum::<f64>() / count as f64;
        let difference = |compared: &Compared| f64::from(compared.change + compared.noise) + beyond * scale(compared);
        let error = |compared: &Compared| difference(compared).abs() / scale(compared).max(f64::MIN_POSITIVE);
        let mut errors: Vec<f64> = self.compared.iter().map(error).collect();
        let read = Quantiles::of(&mut errors);
        let bound = errors[rank_of_bound(count, SHARE, self.risk) - 1];
        let radiosity = |compared: &Compared| f64::from(compared.emission + compared.reflectance * compared.truth);
        let wrong = |compared: &Compared| f64::from(compared.reflectance) * difference(compared);
        let sum = |of: &dyn Fn(&Compared) -> f64| self.compared.iter().map(|point| of(point) * of(point)).sum::<f64>();
        let (wrong, all) = (sum(&wrong), sum(&radiosity));
        Some(Certificate {
            bound,
            read,
            radiosity_rms: if all > 0.0 { (wrong / all).sqrt() } else { 0.0 },
            points: self.compared.iter().map(|compared| (compared.point, compared.truth)).collect(),
        })
    }

    /// Rays cast.
    pub fn rays(&self) -> u64 {
        self.compared.iter().map(|compared| compared.rays).sum()
    }
}

/// The rank of the value in a sorted sample that is above the quantile of this share but for this risk: the least k with
/// P(Binomial(n, share) ≥ k) ≤ risk, at most n.
fn rank_of_bound(count: usize, share: f64, risk: f64) -> usize {
    // From the top: P(all n below) = shareⁿ, and so on.
    let mut probability = share.powi(count as i32);
    let mut above = 0.0;
    let mut rank = count;
    let odds = (1.0 - share) / share;
    while rank > 1 {
        above += probability;
        if above > risk {
            return (rank + 1).min(count);
        }
        probability *= odds * rank as f64 / (count - rank + 1) as f64;
        rank -= 1;
    }
    rank
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Truth: the binomial distribution; of 29 values the largest is above the 90 % quantile but for 0.9²⁹ = 4.7 %, and of 28 it
    /// cannot be told. Beside that, sampled coverage.
    #[test]
    fn bounds_hold_as_often_as_they_say() {
        assert_eq!(rank_of_bound(29, 0.9, 0.05), 29);
        let mut missed = 0;
        for seed in 0..2000_u64 {
            let mut values: Vec<f64> =
                (0..256).map(|index| (mix(mix(7, seed), index) >> 11) as f64 / (1_u64 << 53) as f64).collect();
            values.sort_by(f64::total_cmp);
            missed += u32::from(values[rank_of_bound(256, 0.9, 0.05) - 1] < 0.9);
        }
        // 5 % of 2,000 and four standard deviations; the bound is not far below either.
        assert!((40..140).contains(&missed), "{missed}");
    }
}
