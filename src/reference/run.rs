//! Passes of paths over all points, and what they add up to.

use std::sync::Arc;

use glam::{DVec3, Vec3};
use rayon::prelude::*;

use super::cache::Key;
use super::path::Tracer;
use super::points::SurfacePoint;
use super::sequence::{Sequence, mix};
use crate::cancel::CancelToken;
use crate::scene::Scene;
use crate::visibility::Occluders;

/// Paths that a pass sends from each point, a power of two. They share one scrambled sequence; more paths in it lower the noise faster,
/// fewer leave more passes from which the error is known, and let a pass be stopped sooner.
pub const PATHS_OF_PASS: u32 = 64;

/// Irradiances at points, as well as they are known.
#[derive(Clone, Debug)]
pub struct Reference {
    /// The points.
    pub points: Arc<[SurfacePoint]>,
    /// Mean irradiance E of each, W/m².
    pub irradiance: Vec<DVec3>,
    /// Standard error of each mean, W/m²; infinite before the second pass.
    pub standard_error: Vec<DVec3>,
    /// Paths from each point.
    pub paths: u64,
}

/// Sums over the passes at one point, per colour.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Sums {
    /// Σ of the passes' means, W/m².
    pub mean: DVec3,
    /// Σ of their squares.
    pub square: DVec3,
}

/// A reference in the making.
pub struct ReferenceRun {
    tracer: Tracer,
    points: Arc<[SurfacePoint]>,
    seed: u64,
    key: Key,
    passes: u32,
    sums: Vec<Sums>,
}

impl ReferenceRun {
    /// A run that has made no pass; `occluders` must be the scene's own ([`crate::orient::apply`]).
    pub fn new(scene: &Scene, occluders: Arc<Occluders>, points: Arc<[SurfacePoint]>, seed: u64) -> Self {
        Self {
            tracer: Tracer::new(scene, occluders),
            key: Key::of(scene, &points, seed),
            passes: 0,
            sums: vec![Sums::default(); points.len()],
            points,
            seed,
        }
    }

    /// Sends paths from every point; false if cancelled, which leaves the run as it was.
    ///
    /// The result is the same bit for bit for any number of threads.
    pub fn pass(&mut self, cancel: &CancelToken) -> bool {
        let batch = |(index, point): (usize, &SurfacePoint)| {
            if cancel.is_cancelled() {
                return None;
            }
            let seed = mix(mix(self.seed, index as u64), u64::from(self.passes));
            let paths = (0..PATHS_OF_PASS).map(|path| Sequence::new(seed, path, PATHS_OF_PASS));
            let sum: DVec3 = paths.map(|random| self.tracer.irradiance(point, &random).as_dvec3()).sum();
            Some(sum / f64::from(PATHS_OF_PASS))
        };
        let means: Option<Vec<DVec3>> = self.points.par_iter().enumerate().map(batch).collect();
        let Some(means) = means else { return false };
        for (sums, mean) in self.sums.iter_mut().zip(means) {
            sums.mean += mean;
            sums.square += mean * mean;
        }
        self.passes += 1;
        true
    }

    /// Passes made so far, those read from a cache included.
    pub fn passes(&self) -> u32 {
        self.passes
    }

    /// The points.
    pub fn points(&self) -> &Arc<[SurfacePoint]> {
        &self.points
    }

    /// What decides its values: scene, points and seed.
    pub fn key(&self) -> &Key {
        &self.key
    }

    /// What is known now.
    pub fn reference(&self) -> Reference {
        let passes = f64::from(self.passes);
        let mean = |sums: &Sums| if self.passes > 0 { sums.mean / passes } else { DVec3::ZERO };
        let error = |sums: &Sums| {
            if self.passes < 2 {
                return DVec3::INFINITY;
            }
            let mean = mean(sums);
            let variance = (sums.square / passes - mean * mean).max(DVec3::ZERO);
            (variance / (passes - 1.0)).map(f64::sqrt)
        };
        Reference {
            points: self.points.clone(),
            irradiance: self.sums.iter().map(mean).collect(),
            standard_error: self.sums.iter().map(error).collect(),
            paths: u64::from(self.passes) * u64::from(PATHS_OF_PASS),
        }
    }

    pub(super) fn sums(&self) -> &[Sums] {
        &self.sums
    }

    /// Goes on from a state that was saved.
    pub(super) fn restore(&mut self, passes: u32, sums: Vec<Sums>) {
        (self.passes, self.sums) = (passes, sums);
    }
}

impl Reference {
    /// Radiosity of a point as far as it is reflected, ρE, W/m²; lamps' own light is left out.
    pub fn radiosity(&self, index: usize) -> DVec3 {
        self.points[index].reflectance.as_dvec3() * self.irradiance[index]
    }

    /// Standard error of [`Self::radiosity`], W/m².
    pub fn radiosity_error(&self, index: usize) -> DVec3 {
        let reflectance = self.points[index].reflectance;
        // 0 · ∞ where nothing is known yet and nothing is reflected.
        let of = |rho: f32, error: f64| if rho > 0.0 { f64::from(rho) * error } else { 0.0 };
        let error = self.standard_error[index];
        DVec3::new(of(reflectance.x, error.x), of(reflectance.y, error.y), of(reflectance.z, error.z))
    }

    /// Relative RMS noise of the radiosities over the points, all colours together; for [`super::random_points`] this is
    /// weighted by area. Where nothing is reflected, that of the irradiances.
    pub fn noise(&self) -> f64 {
        let sum = |of: &dyn Fn(usize) -> DVec3| (0..self.points.len()).map(|i| of(i).length_squared()).sum::<f64>();
        let (noise, signal) = (sum(&|index| self.radiosity_error(index)), sum(&|index| self.radiosity(index)));
        if signal > 0.0 {
            return (noise / signal).sqrt();
        }
        let (noise, signal) = (sum(&|index| self.standard_error[index]), sum(&|index| self.irradiance[index]));
        if signal > 0.0 {
            (noise / signal).sqrt()
        } else if self.paths > 0 {
            0.0
        } else {
            f64::INFINITY
        }
    }

    /// Mean irradiance over the points and its standard error, W/m²: the spread between points counts, so that random points
    /// stand for the surfaces that they lie on.
    pub fn mean(&self) -> (DVec3, DVec3) {
        let count = self.points.len() as f64;
        let mean = self.irradiance.iter().sum::<DVec3>() / count;
        let spread: DVec3 = self.irradiance.iter().map(|value| (*value - mean) * (*value - mean)).sum();
        (mean, (spread / (count * (count - 1.0))).map(f64::sqrt))
    }

    /// Irradiances as a view draws them.
    pub fn irradiance_f32(&self) -> Vec<Vec3> {
        self.irradiance.iter().map(|value| value.as_vec3()).collect()
    }
}
