//! The certificate: readings beside a second gather, at points that nothing else knows.
//!
//! A reading looks once from a point and reads the field where its rays end. The comparison looks
//! from those ends once more: what that changes is the field's own error as one reflection hands it
//! on. Further reflections hand on a share ρ̄, the mean reflectance, of its power each (the Neumann
//! series), and mix it over the scene until it lies there as all light does: they add ρ̄/(1−ρ̄)
//! times its share of the light that is reflected. To that comes the noise that readings have, a
//! normal one of their standard error: that they know themselves, so no reading is made for it; as
//! far as the change is noisy itself, that stands for it. So each point, random by area and never
//! replaced, has an error that is known up to a normal deviation, and the bound follows (`bound`).
//! Where it is kept, some more points by A·|B|² tell the RMS error of B, which few bright leaves
//! may rule.

use rayon::prelude::*;

use super::bound::{POINTS, PointError, Quantiles, bound, may_be_kept, share_beyond};
use super::compared::{Compared, Density, LeafSampler};
use super::estimator::MOST_RAYS;
use super::field::Field;
use crate::base::cancel::CancelToken;
use crate::hierarchy::SurfacePoint;

/// Probability that a run reports a bound that does not hold, over all its looks.
pub const RISK: f64 = 0.05;
/// Points after which a running error is reported.
const LEAST_TOLD: usize = 32;
/// Points by A·|B|².
const POINTS_BY_POWER: usize = 32;
/// Points compared between two looks at commands.
const CHUNK: usize = 16;
/// Rays of a reading, as a multiple of those that it should take, before more are worth their time:
/// a few points in crevices need many times as many as all others together, and as long as the
/// bound is kept without them it does not matter what they say.
const BLUNT_RAYS: f32 = 4.0;
/// Standard error of readings, as a share of the target error.
pub const NOISE: f64 = 0.33;

/// Error of readings as far as it is known.
#[derive(Clone, Debug, Default)]
pub struct Certificate {
    /// Nine tenths of the area are within this, with a probability of 1 − [`RISK`].
    pub bound: f64,
    /// Quantiles of the error at the points.
    pub read: Quantiles,
    /// RMS error of B over the area, as a share of its RMS, by all points that were compared.
    pub radiosity_rms: f64,
    /// The points with their irradiance and its standard error (means of the colours, W/m²).
    pub points: Vec<(SurfacePoint, f32, f32)>,
}

/// What a comparison does next.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Next {
    /// The blunt ones of the points by area once more, with as many rays as readings may take.
    Sharpen,
    /// Further points of this density.
    Points(Density),
    /// Nothing: enough is known.
    Nothing,
}

/// A comparison at work.
#[derive(Clone, Debug)]
pub struct Certifying {
    target: f64,
    risk: f64,
    sampler: LeafSampler,
    /// ρ̄/(1−ρ̄).
    further: f64,
    dim: f32,
    /// By area, and by A·|B|².
    compared: Vec<Compared>,
    of_power: Vec<Compared>,
    /// Whether points get as many rays as readings may take, and how many of those compared before
    /// were looked at again for that.
    is_sharp: bool,
    sharpened: usize,
    /// Rays of what was replaced.
    rays_replaced: u64,
    is_thorough: bool,
}

impl Certifying {
    /// Starts over a field, with a share of the run's risk. Attempts of one seed have the same
    /// points, which no field is made for, so that chance alone makes none look better than the one
    /// before.
    pub fn new(field: &Field, target: f64, risk: f64, seed: u64) -> Self {
        let sampler = LeafSampler::new(field, seed);
        let mean = sampler.mean_reflectance();
        Self {
            target,
            risk,
            sampler,
            further: mean / (1.0 - mean),
            dim: field.dim(),
            compared: Vec::new(),
            of_power: Vec::new(),
            is_sharp: false,
            sharpened: 0,
            rays_replaced: 0,
            is_thorough: false,
        }
    }

    /// Compares at some more points; `None` if cancelled.
    pub fn advance(&mut self, field: &Field, cancel: &CancelToken) -> Option<()> {
        let density = match self.next() {
            Next::Sharpen => return self.sharpen(field, cancel),
            Next::Points(density) => density,
            Next::Nothing => return Some(()),
        };
        let most_rays = if self.is_sharp { MOST_RAYS } else { BLUNT_RAYS };
        let known = if density == Density::Area { self.compared.len() } else { self.of_power.len() };
        let compare = |index: usize| (!cancel.is_cancelled()).then(|| self.compare(field, (density, index), most_rays));
        let found: Vec<Compared> = (known..known + CHUNK).into_par_iter().map(compare).collect::<Option<_>>()?;
        if density == Density::Area { &mut self.compared } else { &mut self.of_power }.extend(found);
        Some(())
    }

    /// Looks once more at some of the blunt points; `None` if cancelled.
    fn sharpen(&mut self, field: &Field, cancel: &CancelToken) -> Option<()> {
        let is_blunt = |index: &usize| self.compared[*index].is_blunt;
        let blunt: Vec<usize> = (self.sharpened..self.compared.len()).filter(is_blunt).take(CHUNK).collect();
        let compare =
            |index: &usize| (!cancel.is_cancelled()).then(|| self.compare(field, (Density::Area, *index), MOST_RAYS));
        let found: Vec<Compared> = blunt.par_iter().map(compare).collect::<Option<_>>()?;
        self.sharpened = blunt.last().map_or(self.compared.len(), |last| last + 1);
        for (index, found) in blunt.into_iter().zip(found) {
            self.rays_replaced += self.compared[index].rays;
            self.compared[index] = found;
        }
        self.is_sharp = self.sharpened == self.compared.len();
        Some(())
    }

    /// Compares at a point as exactly as the target asks for.
    fn compare(&self, field: &Field, point: (Density, usize), most_rays: f32) -> Compared {
        self.sampler.compare(field, point, (NOISE * self.target) as f32, most_rays)
    }

    /// What is done next.
    fn next(&self) -> Next {
        if self.is_empty() {
            return Next::Nothing;
        }
        if !POINTS.contains(&self.compared.len()) {
            return Next::Points(Density::Area);
        }
        let errors = self.errors(&self.compared);
        let is_kept = bound(&errors, self.risk) <= self.target;
        let is_hopeless = !may_be_kept(&errors, self.target, self.risk);
        let is_in_vain = !self.is_thorough && is_hopeless;
        // Unkept, for all that is known so far: noise of the blunt ones alone may be to blame.
        if !is_kept && !self.is_sharp && (is_hopeless || !self.has_more()) {
            let exact = PointError { mean: 0.0, deviation: 0.0 };
            let at_best =
                self.compared.iter().zip(&errors).map(|(point, error)| if point.is_blunt { exact } else { *error });
            if may_be_kept(&at_best.collect::<Vec<_>>(), self.target, self.risk) {
                return Next::Sharpen;
            }
        }
        if !is_kept && !is_in_vain && self.has_more() {
            Next::Points(Density::Area)
        } else if self.sampler.power() > 0.0 && !is_in_vain && self.of_power.len() < POINTS_BY_POWER {
            Next::Points(Density::Power)
        } else {
            Next::Nothing
        }
    }

    /// The part of its risk that it took: as many as there were looks at the bound.
    pub fn risk_taken(&self) -> f64 {
        let looks = POINTS.iter().filter(|count| **count <= self.compared.len()).count();
        self.risk * looks as f64 / POINTS.len() as f64
    }

    /// Whether more points can be compared.
    pub fn has_more(&self) -> bool {
        !self.is_empty() && self.compared.len() < POINTS[POINTS.len() - 1]
    }

    /// Compares at all points from now on, unless the target is seen to be kept: nothing finer will
    /// follow.
    pub fn be_thorough(&mut self) {
        self.is_thorough = true;
    }

    /// Share of the points that are off by more than the target, by another comparison of the same
    /// seed and by this one, at the points of both: a quantile of so few says less.
    pub fn beside(&self, other: &Self) -> [f64; 2] {
        let count = self.compared.len().min(other.compared.len());
        [other, self].map(|one| share_beyond(&one.errors(&one.compared[..count]), 0.0, self.target).0)
    }

    /// The certificate, once enough points were compared to tell whether the target is kept, or
    /// that it is not.
    pub fn certificate(&self) -> Option<Certificate> {
        if self.next() != Next::Nothing {
            return None;
        }
        if self.is_empty() {
            return Some(Certificate::default());
        }
        let errors = self.errors(&self.compared);
        Some(Certificate {
            bound: bound(&errors, self.risk),
            read: Quantiles::of_points(&errors),
            radiosity_rms: self.radiosity_rms(),
            points: self.compared().collect(),
        })
    }

    /// RMS error of B over its RMS, by points of both kinds; each counts as much as its place has
    /// few of both [the balance heuristic, Veach, Guibas, *Optimally combining sampling
    /// techniques*, 1995].
    fn radiosity_rms(&self) -> f64 {
        let [by_area, by_power] = [&self.compared, &self.of_power].map(|points| points.len() as f64);
        let (mut wrong, mut all) = (0.0, 0.0);
        for points in [&self.compared, &self.of_power] {
            for (compared, error) in points.iter().zip(self.errors(points)) {
                let weight = 1.0 / (by_area + by_power * compared.by_power);
                let reflectance = f64::from(compared.reflectance);
                let known = error.mean * compared.scale(self.dim);
                // The change is noisy itself, which adds to its square; single points may come out
                // below 0 for that.
                let noise = f64::from(compared.reading_noise).powi(2) - f64::from(compared.change_noise).powi(2);
                wrong += weight * reflectance * reflectance * (known * known + noise);
                all += weight * f64::from(compared.emission + compared.reflectance * compared.truth).powi(2);
            }
        }
        if all > 0.0 { (wrong.max(0.0) / all).sqrt() } else { 0.0 }
    }

    /// Local errors of points: the field's own, with what further reflections add to it, and the
    /// noise of a reading.
    fn errors(&self, points: &[Compared]) -> Vec<PointError> {
        let [further, further_noise] = self.handed_on();
        let error = |one: &Compared| {
            let reading = f64::from(one.reading_noise).powi(2) - f64::from(one.change_noise).powi(2);
            let of_further = (further_noise * f64::from(one.truth)).powi(2);
            PointError {
                mean: (f64::from(one.change) + further * f64::from(one.truth)) / one.scale(self.dim),
                deviation: (reading.max(0.0) + of_further).sqrt() / one.scale(self.dim),
            }
        };
        points.iter().map(error).collect()
    }

    /// Change of the light by all reflections after the first one, as a share of the light, with
    /// the standard error of that share.
    fn handed_on(&self) -> [f64; 2] {
        let (mut changes, mut lights) = (0.0, 0.0);
        for one in &self.compared {
            changes += f64::from(one.reflectance * one.change);
            lights += f64::from(one.reflectance * one.truth);
        }
        if lights <= 0.0 {
            return [0.0; 2];
        }
        let share = changes / lights;
        // Of a quotient of two means [Cochran, *Sampling techniques*, 1977, 2.11].
        let residual =
            |one: &Compared| f64::from(one.reflectance) * (f64::from(one.change) - share * f64::from(one.truth));
        let squares: f64 = self.compared.iter().map(|one| residual(one).powi(2)).sum();
        [share, squares.sqrt() / lights].map(|value| self.further * value)
    }

    /// The points compared so far, with their irradiance and its standard error (means of the
    /// colours, W/m²).
    pub fn compared(&self) -> impl ExactSizeIterator<Item = (SurfacePoint, f32, f32)> {
        self.compared
            .iter()
            .map(|compared| (compared.point, compared.truth, compared.noise.hypot(compared.change_noise)))
    }

    /// Whether there is nothing to compare at.
    pub fn is_empty(&self) -> bool {
        self.sampler.area() <= 0.0
    }

    /// Share of the points, by a scale on which few of them are much, for few often suffice.
    pub fn progress(&self) -> f32 {
        (self.compared.len() as f32 / POINTS[POINTS.len() - 1] as f32).sqrt()
    }

    /// The local error within which nine tenths of the points are, once there are enough of them to
    /// tell.
    pub fn error_so_far(&self) -> Option<f64> {
        (self.compared.len() >= LEAST_TOLD).then(|| Quantiles::of_points(&self.errors(&self.compared)).p90)
    }

    /// Rays cast.
    pub fn rays(&self) -> u64 {
        self.rays_replaced + self.compared.iter().chain(&self.of_power).map(|compared| compared.rays).sum::<u64>()
    }
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;
    use crate::gather::Gather;
    use crate::gather::field::grey;
    use crate::hierarchy::ElementId;

    /// Truth: readings at the same points. They report no more noise than the checks say, which
    /// know the change as exactly as they should and the light itself half as exactly.
    #[test]
    fn a_check_knows_the_noise_of_readings() {
        let mut gather = Gather::of_cornell();
        while !gather.is_ready() {
            gather.step(&CancelToken::new()).expect("nobody cancels");
        }
        let (field, error) = (gather.field(), 0.02);
        let leaves: Vec<ElementId> = field.leaves().filter(|leaf| !field.emits(*leaf)).collect();
        let (mut noisier, mut halved) = (0, 0);
        for (number, leaf) in leaves.iter().step_by(leaves.len() / 20).enumerate() {
            let point = field.hierarchy().point_on(*leaf, 0.3, 0.6);
            let at = (point.position, point.normal);
            let read = field.irradiance_at(at, error, number as u64);
            let checked = field.checked_at(at, error, number as u64, MOST_RAYS);
            let allowed = error * (grey(checked.found.mean) + field.dim());
            assert!(checked.reading_noise >= allowed && checked.change_noise <= 1.001 * allowed, "{checked:?}");
            assert!(checked.noise <= 2.001 * allowed, "{checked:?}");
            noisier += u32::from(grey(read.standard_error) > 1.1 * checked.reading_noise);
            halved += u32::from(checked.noise > allowed);
        }
        assert!(noisier <= 2 && halved > 2, "{noisier} readings are noisier, {halved} checks less exact");
    }

    fn of_place(truth: f32, change: f32, by_power: f64) -> Compared {
        Compared {
            point: SurfacePoint { position: Vec3::ZERO, normal: Vec3::Y, polygon: 0 },
            truth,
            change,
            noise: 0.0,
            reading_noise: 0.0,
            change_noise: 0.0,
            reflectance: 0.5,
            emission: 0.0,
            by_power,
            is_blunt: false,
            rays: 0,
        }
    }

    /// Of these points by area and by power, with E₀ = 0.1 and a mean reflectance of 0.5.
    fn of_points(compared: Vec<Compared>, of_power: Vec<Compared>) -> Certifying {
        Certifying {
            target: 0.05,
            risk: RISK,
            sampler: LeafSampler::default(),
            further: 1.0,
            dim: 0.1,
            compared,
            of_power,
            is_sharp: false,
            sharpened: 0,
            rays_replaced: 0,
            is_thorough: false,
        }
    }

    /// Truth: the sum over the two kinds of places themselves. A tenth of the area is ten times as
    /// bright and off by half, the rest by a tenth; points by area and by power meet each as often
    /// as they should.
    #[test]
    fn the_rms_of_radiosity_is_that_of_the_area() {
        // Shares of A·B²: 0.9 to 0.1·100.
        let (dim, bright) = (of_place(1.0, 0.1, 1.0 / 10.9), of_place(10.0, 5.0, 100.0 / 10.9));
        let points = |of_dim: usize, of_bright: usize| [vec![dim; of_dim], vec![bright; of_bright]].concat();
        let alone = Certifying { further: 0.0, ..of_points(points(90, 10), points(9, 100)) };
        let wanted = ((0.9 * 0.01 + 0.1 * 25.0) / (0.9 + 0.1 * 100.0_f64)).sqrt();
        let found = alone.radiosity_rms();
        assert!((found - wanted).abs() < 1e-3 * wanted, "{found}, should be {wanted}");
    }

    /// Truth: by hand. Nine tenths of the points have 1 W/m² and change by a tenth of it, which a
    /// mean reflectance of a half hands on once more; dark corners, wrong by far more than they
    /// have, add no light that could be handed on.
    #[test]
    fn further_reflections_hand_on_power() {
        let certifying =
            of_points([vec![of_place(1.0, 0.1, 1.0); 90], vec![of_place(0.0, -0.05, 1.0); 10]].concat(), vec![]);
        let wanted = (90.0 * 0.1 - 10.0 * 0.05) / 90.0;
        let [further, noise] = certifying.handed_on();
        assert!((further - wanted).abs() < 1e-6 && noise < 0.05 * wanted, "{further} ± {noise}, not {wanted}");
        let errors = certifying.errors(&certifying.compared);
        assert!((errors[0].mean - (0.1 + wanted) / 1.1).abs() < 1e-6, "{:?}", errors[0]);
        assert!((errors[99].mean + 0.5).abs() < 1e-6 && errors[99].deviation == 0.0, "{:?}", errors[99]);
    }

    /// Truth: by hand. At the points of both a fifth and a tenth are off by more than the target.
    #[test]
    fn attempts_are_compared_at_the_points_of_both() {
        let points = |count: usize, wrong: usize| {
            let compared = (0..count).map(|number| of_place(0.9, if number < wrong { 1.0 } else { 0.0 }, 1.0));
            Certifying { further: 0.0, ..of_points(compared.collect(), vec![]) }
        };
        assert_eq!(points(100, 10).beside(&points(50, 10)), [0.2, 0.2]);
        assert_eq!(points(100, 5).beside(&points(50, 10)), [0.2, 0.1]);
    }
}
