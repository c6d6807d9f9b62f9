//! Passes of paths over all points, and what they add up to.
//!
//! The first passes, the pilot, send the same number of paths from every point. How far these
//! scatter decides how many each point gets of all later ones, and the pilot counts no more: a mean
//! whose number of samples depended on the samples themselves would be biased.

use std::sync::Arc;

use glam::DVec3;
use rayon::prelude::*;

use super::key::Key;
use super::path::Tracer;
use super::points::SurfacePoint;
use super::sequence::hash64;
use super::share::shares;
use super::sums::{BATCH, PILOT, State, Sums, reflected};
use crate::base::cancel::CancelToken;
use crate::scene::Scene;

/// Irradiances at points, as well as they are known.
#[derive(Clone, Debug)]
pub struct Reference {
    /// The points.
    pub points: Arc<[SurfacePoint]>,
    /// Mean irradiance E of each, W/m².
    pub irradiance: Vec<DVec3>,
    /// Standard error of each mean, W/m²; infinite before the second batch.
    pub standard_error: Vec<DVec3>,
    /// Paths that it stands on.
    pub paths: u64,
}

/// A reference in the making.
pub struct ReferenceRun {
    tracer: Tracer,
    points: Arc<[SurfacePoint]>,
    seed: u64,
    key: Key,
    state: State,
    /// Batches of each point per later pass, 1 on average; empty during the pilot.
    shares: Vec<f64>,
}

impl ReferenceRun {
    /// A run that has made no pass, of a scene whose faces are turned and doubled as it is solved
    /// ([`crate::geometry::orient::apply`]).
    pub fn new(scene: &Scene, points: Arc<[SurfacePoint]>, seed: u64) -> Self {
        let none = vec![Sums::default(); points.len()];
        Self {
            tracer: Tracer::new(scene),
            key: Key::of(scene, &points, seed),
            state: State { passes: 0, pilot: none.clone(), counted: none },
            shares: Vec::new(),
            points,
            seed,
        }
    }

    /// Sends a batch of paths from every point, on average; false if cancelled, which leaves the
    /// run as it was.
    ///
    /// The result is the same bit for bit for any number of threads.
    pub fn pass(&mut self, cancel: &CancelToken) -> bool {
        let pass = self.state.passes;
        if pass == PILOT && self.shares.is_empty() {
            self.shares = shares(&self.points, &self.state.pilot);
        }
        let batches =
            (0..self.points.len()).flat_map(|point| self.batches(point, pass).map(move |batch| (point, batch)));
        let batches: Vec<(usize, u32)> = batches.collect();
        let trace = |&(point, batch): &(usize, u32)| {
            let seed = hash64(hash64(self.seed, point as u64), u64::from(batch));
            (!cancel.is_cancelled()).then(|| (point, self.tracer.irradiance(&self.points[point], seed, BATCH)))
        };
        let Some(means) = batches.par_iter().map(trace).collect::<Option<Vec<_>>>() else { return false };
        let sums = if pass < PILOT { &mut self.state.pilot } else { &mut self.state.counted };
        for (point, mean) in means {
            let sums = &mut sums[point];
            sums.count += 1;
            sums.mean += mean;
            sums.square += mean * mean;
        }
        self.state.passes += 1;
        true
    }

    /// The numbers of the batches that a pass makes at a point.
    fn batches(&self, point: usize, pass: u32) -> std::ops::Range<u32> {
        if pass < PILOT {
            return pass..pass + 1;
        }
        let up_to = |passes: u32| PILOT + (f64::from(passes) * self.shares[point]) as u32;
        up_to(pass - PILOT)..up_to(pass - PILOT + 1)
    }

    /// Passes made so far, those read from a cache included.
    pub fn passes(&self) -> u32 {
        self.state.passes
    }

    /// Passes that are still to be made until the noise, which is this now, is as low as `goal`:
    /// it falls as the root of the paths. Those of the pilot do not count in the end.
    pub fn passes_left(&self, noise: f64, goal: f64) -> f64 {
        let passes = self.state.passes;
        let counted = if self.is_past_pilot() { passes - PILOT } else { passes.min(PILOT) };
        let needed = f64::from(PILOT) + f64::from(counted) * (noise / goal).powi(2);
        (needed - f64::from(passes)).max(0.0)
    }

    /// Whether the pilot counts no more.
    fn is_past_pilot(&self) -> bool {
        self.state.passes >= 2 * PILOT
    }

    /// The points.
    pub fn points(&self) -> &Arc<[SurfacePoint]> {
        &self.points
    }

    /// Key of the values: scene, points and seed.
    pub fn key(&self) -> &Key {
        &self.key
    }

    /// Present state of the reference.
    pub fn reference(&self) -> Reference {
        // Until then the pilot is the better one.
        let sums = if self.is_past_pilot() { &self.state.counted } else { &self.state.pilot };
        Reference {
            points: self.points.clone(),
            irradiance: sums.iter().map(Sums::mean).collect(),
            standard_error: sums.iter().map(Sums::standard_error).collect(),
            paths: sums.iter().map(|sums| u64::from(sums.count) * u64::from(BATCH)).sum(),
        }
    }

    pub(super) fn state(&self) -> &State {
        &self.state
    }

    /// Goes on from a state that was saved.
    pub(super) fn restore(&mut self, state: State) {
        self.state = state;
        self.shares = if self.state.passes > PILOT { shares(&self.points, &self.state.pilot) } else { Vec::new() };
    }
}

impl Reference {
    /// Radiosity of a point as far as it is reflected, ρE, W/m²; lamps' own light is left out.
    pub fn radiosity(&self, index: usize) -> DVec3 {
        self.points[index].reflectance.as_dvec3() * self.irradiance[index]
    }

    /// Standard error of [`Self::radiosity`], W/m².
    pub fn radiosity_error(&self, index: usize) -> DVec3 {
        reflected(&self.points[index], self.standard_error[index])
    }

    /// Relative RMS noise of the radiosities over the points, by their weights, all colours
    /// together. Where nothing is reflected, that of the irradiances.
    pub fn noise(&self) -> f64 {
        let sum = |of: &dyn Fn(usize) -> DVec3| {
            let square = |(index, point): (usize, &SurfacePoint)| f64::from(point.weight) * of(index).length_squared();
            self.points.iter().enumerate().map(square).sum::<f64>()
        };
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
}
