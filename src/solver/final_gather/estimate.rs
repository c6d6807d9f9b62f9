//! The solution's own estimate of its error: what is shown at random points, beside light that is looked for there anew.
//!
//! Each point is looked at twice, by looks that know nothing of each other. The product of the two differences has the squared error as
//! its mean, whatever the noise of the looks; so few rays for each of many points suffice. What the estimate cannot see is what all
//! looks share: an error of the light that comes from the shown solution itself, which one reflection makes smaller.

use std::ops::Range;

use glam::Vec3;
use rayon::prelude::*;

use super::lamps::Seen;
use super::places::{Place, Places};
use super::{Context, FinalGather};
use crate::cancel::CancelToken;
use crate::hierarchy::Hierarchy;
use crate::random::{even_point, mix};

/// Points looked at; as many again where what they say is near the goal, a few times.
pub const POINTS: usize = 2048;
const MOST_POINTS: usize = 4 * POINTS;
/// An error of no more than so many times the goal may be the estimate's own, and is near enough to try on.
pub const NEAR: f64 = 1.25;
/// Rays of a look, to lamps and into the half space each, times the error that is asked for.
const RAYS: f64 = 0.8;
/// Rays that must meet backs before a point is believed to be hidden.
const DARK_RAYS: u32 = 32;

/// A point that holds more than this share of the squared error is not believed without others of its leaf: a small bright spot on a
/// large leaf is met hardly ever, and would then stand for all of it.
const RULES: f64 = 0.5;
/// So many others.
const OTHERS: usize = 64;

/// What points found so far.
#[derive(Clone, Copy, Debug, Default)]
pub struct Tally {
    /// Σ of products of differences, and of their squares.
    error: f64,
    squares: f64,
    /// The largest of the products, and the number of its point.
    largest: (f64, usize),
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
            largest: if other.largest.0 > self.largest.0 { other.largest } else { self.largest },
            energy: self.energy + other.energy,
            points: self.points + other.points,
            rays: self.rays + other.rays,
        }
    }

    /// The point that rules all others, if one does.
    pub fn ruler(&self) -> Option<usize> {
        (self.largest.0 > RULES * self.error).then_some(self.largest.1)
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
        let reflected = self.reflected();
        let places = self.places(hierarchy, context, &reflected);
        let look = |cut: &mut Vec<Seen>, index: usize| {
            let (start, index) = self.point(context, index);
            let Some(place) = places.at(index, start) else { return Some(Tally::default()) };
            let seed = mix(start, index as u64);
            (!cancel.is_cancelled()).then(|| self.look_at_place(hierarchy, context, &reflected, (place, seed), cut))
        };
        // Summed in order, so that the result does not depend on the threads.
        let numbers = points.clone();
        let tallies: Vec<Tally> =
            points.into_par_iter().with_min_len(16).map_init(Vec::new, look).collect::<Option<_>>()?;
        let number = |(index, tally): (usize, Tally)| Tally { largest: (tally.error, index), ..tally };
        Some(numbers.zip(tallies).map(number).fold(Tally::default(), Tally::add))
    }

    /// Replaces what one point said by the mean of others of its leaf; `None` if cancelled.
    pub(super) fn doubt_point(
        &self,
        hierarchy: &Hierarchy,
        context: &Context,
        tally: Tally,
        index: usize,
        cancel: &CancelToken,
    ) -> Option<Tally> {
        let reflected = self.reflected();
        let (start, within) = self.point(context, index);
        let Some(place) = self.places(hierarchy, context, &reflected).at(within, start) else { return Some(tally) };
        let seed = mix(mix(start, within as u64), 3);
        let look = |cut: &mut Vec<Seen>, other: usize| {
            let place = Place { uv: even_point(seed, other as u32), ..place };
            let seed = mix(seed, other as u64);
            (!cancel.is_cancelled()).then(|| self.look_at_place(hierarchy, context, &reflected, (place, seed), cut))
        };
        let others: Vec<Tally> = (0..OTHERS).into_par_iter().map_init(Vec::new, look).collect::<Option<_>>()?;
        let others = others.into_iter().fold(Tally::default(), Tally::add);
        let (mean, former) = (others.error / OTHERS as f64, tally.largest.0);
        Some(Tally {
            error: tally.error - former + mean,
            squares: tally.squares - former * former + mean * mean,
            largest: (0.0, 0),
            rays: tally.rays + others.rays,
            ..tally
        })
    }

    /// Seed and number of a point of the present attempt; every [`POINTS`] lie as those before, elsewhere.
    fn point(&self, context: &Context, index: usize) -> (u64, usize) {
        let start = mix(mix(context.seed, 0x6573_7469_6d61_7465), u64::from(self.attempt));
        (mix(start, (index / POINTS) as u64), index % POINTS)
    }

    fn look_at_place(
        &self,
        hierarchy: &Hierarchy,
        context: &Context,
        reflected: &[Vec3],
        (place, seed): (Place, u64),
        cut: &mut Vec<Seen>,
    ) -> Tally {
        let rays = ((RAYS / self.goal.error) as u32).clamp(8, 64);
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
            let seed = mix(seed, number);
            let lit = lamps.irradiance(point.position, point.normal, rays as f32, f32::INFINITY, seed, cut);
            cast += u64::from(lit.rays) + u64::from(rays);
            is_lit |= lit.irradiance != Vec3::ZERO;
            surface.reflectance
                * (lit.irradiance + surroundings.light_at(point.position, point.normal, seed, rays, reflected))
        });
        let is_hidden = || {
            self.darkness(context)
                .is_some_and(|darkness| darkness.encloses(point.position, point.normal, seed, DARK_RAYS))
        };
        // Where lamps shine nothing is hidden; light that interpolation leaks into what is closed does not count.
        if !is_lit && is_hidden() {
            return Tally { points: 1.0, rays: cast, ..Tally::default() };
        }
        let error = area * f64::from((first - shown).dot(second - shown));
        let energy = area * f64::from(first.dot(second));
        Tally { error, squares: error * error, energy, points: 1.0, rays: cast, ..Tally::default() }
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

#[cfg(test)]
mod tests {
    use super::*;

    /// Truth: by hand. A point that holds 99 of 100 parts of the squared error rules; among two of 49 none does.
    #[test]
    fn a_point_that_rules_is_named() {
        let tally = |errors: &[f64]| {
            let point = |(index, error): (usize, &f64)| Tally {
                error: *error,
                squares: error * error,
                energy: 1.0,
                points: 1.0,
                largest: (*error, index),
                ..Tally::default()
            };
            errors.iter().enumerate().map(point).fold(Tally::default(), Tally::add)
        };
        assert_eq!(tally(&[0.5, 99.0, 0.5]).ruler(), Some(1));
        assert_eq!(tally(&[1.0, 49.0, 49.0, 1.0]).ruler(), None);
        assert_eq!(tally(&[]).ruler(), None);
        let estimate = tally(&[0.0, 4.0]).estimate().expect("there is light");
        assert!(
            (estimate.rms - 2.0_f64.sqrt()).abs() < 1e-12
                && estimate.low < estimate.rms
                && estimate.rms < estimate.high
        );
        assert!(!tally(&[0.0, 4.0]).is_clear(1.3, POINTS) && tally(&[0.0, 4.0]).is_clear(0.5, POINTS));
    }
}
