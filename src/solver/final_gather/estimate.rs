//! The solution's own estimate of its error: what is shown at random points, beside light that is looked for there anew.
//!
//! Each point is looked at twice, by looks that know nothing of each other. The product of the two differences has the squared error as
//! its mean, whatever the noise of the looks; so few rays for each of many points suffice. What the estimate cannot see is what all
//! looks share: an error of the light that comes from the shown solution itself, which one reflection makes smaller.

use std::ops::Range;

use glam::Vec3;
use rayon::prelude::*;

use super::lamps::Seen;
use super::places::Places;
use super::{Context, FinalGather};
use crate::cancel::CancelToken;
use crate::hierarchy::Hierarchy;
use crate::random::mix;

/// Points looked at; as many again where what they say is near the goal, a few times.
pub const POINTS: usize = 2048;
const MOST_POINTS: usize = 4 * POINTS;
/// An error of no more than so many times the goal may be the estimate's own, and is near enough to try on.
pub const NEAR: f64 = 1.25;
/// Rays of a look, to lamps and into the half space each, times the error that is asked for.
const RAYS: f64 = 0.8;
/// Rays that must meet backs before a point is believed to be hidden.
const DARK_RAYS: u32 = 32;

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
    /// One standard error less than `rms`, and one more.
    pub low: f64,
    pub high: f64,
}

/// The estimate misses what its looks share, about a tenth of the error (measured against references, `docs/accuracy/steps.md`).
const MISSED: f64 = 1.1;

impl Estimate {
    /// The error that can be promised.
    pub fn cautious(&self) -> f64 {
        (0.5 * (self.rms + self.high)).max(MISSED * self.rms)
    }
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

    /// Whether so many points are enough to tell whether a goal is reached.
    pub fn is_clear(&self, goal: f64, points: usize) -> bool {
        let is_doubtful = |estimate: Estimate| estimate.cautious() > goal && estimate.low <= NEAR * goal;
        points >= MOST_POINTS || !self.estimate().is_some_and(is_doubtful)
    }

    /// What all points say together; nothing without light.
    pub fn estimate(&self) -> Option<Estimate> {
        let (mean, energy) = (self.error / self.points, self.energy / self.points);
        let variance = (self.squares / self.points - mean * mean).max(0.0) / self.points;
        let rms = |square: f64| (square.max(0.0) / energy).sqrt();
        let error = variance.sqrt();
        (energy > 0.0).then(|| Estimate { rms: rms(mean), low: rms(mean - error), high: rms(mean.max(0.0) + error) })
    }
}

impl FinalGather {
    /// Looks at some of the points, other ones in each attempt; `None` if cancelled. Half of them lie evenly by area, half by A·|B|²: a
    /// small bright place may hold most of the error, and by area alone hardly a point would meet it.
    pub(super) fn look_at_points(
        &self,
        hierarchy: &Hierarchy,
        context: &Context,
        points: Range<usize>,
        cancel: &CancelToken,
    ) -> Option<Tally> {
        let start = mix(mix(context.seed, 0x6573_7469_6d61_7465), u64::from(self.attempt));
        let reflected = self.reflected();
        let places = self.places(hierarchy, context, &reflected);
        let rays = ((RAYS / self.goal.error) as u32).clamp(8, 64);
        let look = |cut: &mut Vec<Seen>, index: usize| {
            let number = (mix(start, (index / POINTS) as u64), index % POINTS);
            (!cancel.is_cancelled())
                .then(|| self.look_at_point(hierarchy, context, (&reflected, &places), rays, number, cut))
        };
        // Summed in order, so that the result does not depend on the threads.
        let tallies: Vec<Tally> =
            points.into_par_iter().with_min_len(16).map_init(Vec::new, look).collect::<Option<_>>()?;
        Some(tallies.into_iter().fold(Tally::default(), Tally::add))
    }

    fn look_at_point(
        &self,
        hierarchy: &Hierarchy,
        context: &Context,
        (reflected, places): (&[Vec3], &Places),
        rays: u32,
        (start, index): (u64, usize),
        cut: &mut Vec<Seen>,
    ) -> Tally {
        let Some(place) = places.at(index, start) else { return Tally::default() };
        let of = &self.display.mesh.leaves[place.leaf];
        let [u, v] = place.uv;
        let point = hierarchy.point_on(of.element, u, v);
        let surface = &context.surfaces[point.polygon as usize];
        let Some((triangle, weights)) = self.display.locate(hierarchy, of.element, point.position) else {
            return Tally::default();
        };
        // What the point stands for, m².
        let area = f64::from(hierarchy.element(of.element).sampled_area) / place.density;
        let [a, b, c] = self.display.mesh.triangles[triangle as usize].map(|corner| reflected[corner as usize]);
        let shown = weights.x * a + weights.y * b + weights.z * c;
        let lamps = self.lamps(hierarchy, context);
        let surroundings = self.surroundings(hierarchy, context);
        let (mut cast, mut is_lit) = (0, false);
        let [first, second] = [1, 2].map(|number| {
            let seed = mix(mix(start, index as u64), number);
            let lit = lamps.irradiance(point.position, point.normal, rays as f32, f32::INFINITY, seed, cut);
            cast += u64::from(lit.rays) + u64::from(rays);
            is_lit |= lit.irradiance != Vec3::ZERO;
            surface.reflectance
                * (lit.irradiance + surroundings.light_at(point.position, point.normal, seed, rays, reflected))
        });
        let is_hidden = || {
            let seed = mix(start, index as u64);
            self.darkness(context)
                .is_some_and(|darkness| darkness.encloses(point.position, point.normal, seed, DARK_RAYS))
        };
        // Where lamps shine nothing is hidden; light that interpolation leaks into what is closed does not count.
        if !is_lit && is_hidden() {
            return Tally { points: 1.0, rays: cast, ..Tally::default() };
        }
        let error = area * f64::from((first - shown).dot(second - shown));
        let energy = area * f64::from(first.dot(second));
        Tally { error, squares: error * error, energy, points: 1.0, rays: cast }
    }

    /// Half of the places lie by area, half by A·|B|²; lamps get none.
    fn places(&self, hierarchy: &Hierarchy, context: &Context, reflected: &[Vec3]) -> Places {
        let mesh = &self.display.mesh;
        let of_leaf = |leaf: usize| {
            let of = &mesh.leaves[leaf];
            if context.surfaces[of.polygon as usize].emission != Vec3::ZERO {
                return (0.0, 0.0);
            }
            let area = f64::from(hierarchy.element(of.element).sampled_area);
            let vertices =
                self.display.triangles_of(leaf as u32).flat_map(|triangle| mesh.triangles[triangle as usize]);
            let brightest = vertices.map(|vertex| reflected[vertex as usize].length_squared()).fold(0.0, f32::max);
            (area, area * f64::from(brightest))
        };
        let leaves: Vec<(f64, f64)> = (0..mesh.leaves.len()).map(of_leaf).collect();
        let all = leaves.iter().fold((0.0, 0.0), |sum, leaf| (sum.0 + leaf.0, sum.1 + leaf.1));
        let half = |part: f64, all: f64| if all > 0.0 { 0.5 * part / all } else { 0.0 };
        Places::new(leaves.iter().map(|leaf| half(leaf.0, all.0) + half(leaf.1, all.1)), POINTS)
    }
}
