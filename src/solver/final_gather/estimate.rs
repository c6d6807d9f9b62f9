//! The solution's own estimate of its error: what is shown at random points, beside light that is looked for there anew.
//!
//! Each point is looked at twice, by looks that know nothing of each other. The product of the two differences has the squared error as
//! its mean, whatever the noise of the looks; so few rays for each of many points suffice. What the estimate cannot see is what all
//! looks share: an error of the light that comes from the shown solution itself, which one reflection makes smaller.

use std::ops::Range;

use glam::Vec3;
use rayon::prelude::*;

use super::lamps::Seen;
use super::{Context, FinalGather};
use crate::hierarchy::Hierarchy;
use crate::random::{fraction, mix};

/// Points looked at.
pub const POINTS: usize = 2048;
/// Rays of a look, to lamps and into the half space each, times the error that is asked for.
const RAYS: f64 = 0.8;
/// Rays that must meet backs before a point is believed to be hidden.
const DARK_RAYS: u32 = 32;
/// Steps of the two-dimensional sequence of the plastic number (Roberts), as 32-bit fractions.
const STEPS: [u32; 2] = [3_242_174_889, 2_447_445_414];

/// What points found so far.
#[derive(Clone, Copy, Debug, Default)]
pub struct Tally {
    /// Σ of products of differences, and of their squares.
    error: f64,
    squares: f64,
    /// Σ of products of what the looks found.
    energy: f64,
    points: f64,
    /// Rays cast.
    pub rays: u64,
}

/// An error with its standard error, as shares of the RMS radiosity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// RMS error.
    pub rms: f64,
    /// One standard error more than `rms`.
    pub high: f64,
}

impl Tally {
    /// Adds what further points found.
    pub fn add(self, other: Self) -> Self {
        Self {
            error: self.error + other.error,
            squares: self.squares + other.squares,
            energy: self.energy + other.energy,
            points: self.points + other.points,
            rays: self.rays + other.rays,
        }
    }

    /// What all points say together; nothing without light.
    pub fn estimate(&self) -> Option<Estimate> {
        let (mean, energy) = (self.error / self.points, self.energy / self.points);
        let variance = (self.squares / self.points - mean * mean).max(0.0) / self.points;
        let rms = |square: f64| (square.max(0.0) / energy).sqrt();
        (energy > 0.0).then(|| Estimate { rms: rms(mean), high: rms(mean.max(0.0) + variance.sqrt()) })
    }
}

impl FinalGather {
    /// Looks at some of the points; `round` chooses which ones.
    pub(super) fn look_at_points(&self, hierarchy: &Hierarchy, context: &Context, round: u32, points: Range<usize>) -> Tally {
        let start = mix(mix(context.seed, 0x6573_7469_6d61_7465), u64::from(round));
        let reflected = self.reflected();
        let rays = ((RAYS / self.goal.error) as u32).clamp(8, 64);
        let look = |cut: &mut Vec<Seen>, index: usize| self.look_at_point(hierarchy, context, &reflected, rays, (start, index), cut);
        // Summed in order, so that the result does not depend on the threads.
        let tallies: Vec<Tally> = points.into_par_iter().with_min_len(16).map_init(Vec::new, look).collect();
        tallies.into_iter().fold(Tally::default(), Tally::add)
    }

    fn look_at_point(
        &self,
        hierarchy: &Hierarchy,
        context: &Context,
        reflected: &[Vec3],
        rays: u32,
        (start, index): (u64, usize),
        cut: &mut Vec<Seen>,
    ) -> Tally {
        let from = [start as u32, (start >> 32) as u32];
        let [u, v] = [0, 1].map(|axis: usize| fraction(from[axis].wrapping_add(STEPS[axis].wrapping_mul(index as u32))));
        let point = hierarchy.point_on(Hierarchy::ROOT, u, v);
        let surface = &context.surfaces[point.polygon as usize];
        let Some((triangle, weights)) = self.display.locate(hierarchy, self.patches[point.polygon as usize], point.position)
        else {
            return Tally::default();
        };
        if surface.emission != Vec3::ZERO {
            return Tally::default();
        }
        let [a, b, c] = self.display.mesh.triangles[triangle as usize].map(|corner| reflected[corner as usize]);
        let shown = weights.x * a + weights.y * b + weights.z * c;
        let lamps = self.lamps(hierarchy, context);
        let surroundings = self.surroundings(hierarchy, context);
        let (mut cast, mut is_lit) = (0, false);
        let [first, second] = [1, 2].map(|number| {
            let seed = mix(mix(start, index as u64), number);
            let lit = lamps.irradiance(point.position, point.normal, rays as f32, seed, cut);
            cast += u64::from(lit.rays) + u64::from(rays);
            is_lit |= lit.irradiance != Vec3::ZERO;
            surface.reflectance * (lit.irradiance + surroundings.light_at(point.position, point.normal, seed, rays, reflected))
        });
        let is_hidden = || {
            let seed = mix(start, index as u64);
            self.darkness(context).is_some_and(|darkness| darkness.encloses(point.position, point.normal, seed, DARK_RAYS))
        };
        // Where lamps shine nothing is hidden; light that interpolation leaks into what is closed does not count.
        if !is_lit && is_hidden() {
            return Tally { rays: cast, ..Tally::default() };
        }
        let error = f64::from((first - shown).dot(second - shown));
        Tally { error, squares: error * error, energy: f64::from(first.dot(second)), points: 1.0, rays: cast }
    }
}
