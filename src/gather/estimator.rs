//! Irradiance at a point, with its standard error: the one estimator that every reading asks.
//!
//! A look is a few rays aimed at emitters and a few cosine-distributed ones whose ends are read from
//! the field. Looks are repeated until their spread says that the mean is as exact as was asked for.

use glam::Vec3;

use super::field::{End, Field, Met, grey};
use super::glance::{GatherPoint, GlanceRays, is_near};
use super::sources::Aim;
use crate::random::{cosine_direction, mix};

/// Rays of one look: aimed ones (about so many), and cosine-distributed ones.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rays {
    /// Aimed at emitters and secondary emitters.
    pub aimed: f32,
    /// Cosine-distributed.
    pub cosine: u32,
}

/// How exact an irradiance is to be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Budget {
    /// Rays of each look.
    pub rays: Rays,
    /// Looks, at least.
    pub least: u32,
    /// Looks, at most.
    pub most: u32,
    /// Looks end when the standard error is below this share of E + E₀ (mean of the colours).
    pub error: f32,
}

impl Budget {
    /// Rays of a look: enough for the balance of direct and indirect light, few enough to tell a spread
    /// from several.
    const LOOK: Rays = Rays { aimed: 8.0, cosine: 32 };

    /// Until the standard error is this share of the local light.
    pub fn to_error(error: f32) -> Self {
        Self { rays: Self::LOOK, least: 8, most: 256, error }
    }
}

/// An irradiance and how sure it is.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Irradiance {
    /// E, W/m².
    pub mean: Vec3,
    /// Its standard error, W/m².
    pub standard_error: Vec3,
    /// Looks.
    pub looks: u32,
    /// Rays cast.
    pub rays: u64,
}

/// A reading beside light that was looked for anew.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Checked {
    /// The reading.
    pub read: Irradiance,
    /// Its standard error (mean of the colours), W/m².
    pub noise: f32,
    /// What E changes by (mean of the colours) where one reflection more is followed from the ends of its rays, W/m².
    pub change: f32,
    /// Standard error of that, W/m².
    pub change_noise: f32,
}

/// Whether light is followed by one reflection more from wherever the field was read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Check {
    No,
    Yes,
}

/// What a look finds.
#[derive(Clone, Copy, Debug, Default)]
struct Seen {
    /// Irradiance, W/m².
    light: Vec3,
    /// What it changes by in a check, W/m².
    change: Vec3,
    /// Rays cast.
    rays: u32,
}

/// Sums over looks.
#[derive(Clone, Copy, Debug, Default)]
struct Sums {
    looks: u32,
    light: Vec3,
    squares: Vec3,
    grey_squares: f32,
    /// Σ of changes and of their squares (mean of the colours).
    change: f32,
    change_squares: f32,
    rays: u64,
}

/// Ends of the rays of a look, at most as far as their numbers tell.
const MOST_ENDS: u32 = 64;
/// Rays of a look that are drawn by the radiance of an uneven sky.
const DRAWN: u32 = 8;
/// Rays of a look to the sun's disc: in a penumbra, the few looks of a reading must tell the part of it that is seen.
const TO_SUN: u32 = 4;
/// Rays of the look from where a ray ended.
const FURTHER: GlanceRays = GlanceRays { aimed: 2, cosine: 2 };

impl Field {
    /// Irradiance at a point of a face with this unit normal. The seed alone tells the random numbers,
    /// so a reading does not depend on others.
    pub fn irradiance_at(&self, place: (Vec3, Vec3), budget: &Budget, seed: u64) -> Irradiance {
        self.sums(place, budget, seed, Check::No).irradiance()
    }

    /// The same reading, with what its error looks like.
    pub fn checked_at(&self, place: (Vec3, Vec3), budget: &Budget, seed: u64) -> Checked {
        let sums = self.sums(place, budget, seed, Check::Yes);
        let (_, variance) = mean_and_variance(sums.looks, grey(sums.light), sums.grey_squares);
        let (change, change_variance) = mean_and_variance(sums.looks, sums.change, sums.change_squares);
        Checked { read: sums.irradiance(), noise: variance.sqrt(), change, change_noise: change_variance.sqrt() }
    }

    fn sums(&self, place: (Vec3, Vec3), budget: &Budget, seed: u64, check: Check) -> Sums {
        let mut aims = Vec::new();
        self.find_aims(place.0, place.1, &mut aims);
        let mut sums = Sums::default();
        loop {
            let seen = self.look(place, budget.rays, (seed, sums.looks), &mut aims, check);
            sums.add(&seen);
            // Whoever asks after every look stops where little was found by chance, and reads too low.
            let looks = sums.looks;
            if looks < budget.least || !(looks / budget.least).is_power_of_two() || looks % budget.least != 0 {
                continue;
            }
            let (mean, variance) = mean_and_variance(looks, grey(sums.light), sums.grey_squares);
            let allowed = budget.error * (mean + self.dim());
            if looks >= budget.most || variance <= allowed * allowed {
                return sums;
            }
        }
    }

    /// Irradiance at a place of a polygon, to a standard error that is this share of the local light. It
    /// depends on the place alone.
    pub fn read(&self, polygon: u32, position: Vec3, error: f32) -> Irradiance {
        // Off its plane by rounding, a place would lie behind its face.
        let position = self.on_plane(self.leaf_at(polygon, position), position);
        let normal = self.normal(polygon);
        let seed = position.to_array().iter().fold(u64::from(polygon), |seed, x| mix(seed, u64::from(x.to_bits())));
        self.irradiance_at((position, normal), &Budget::to_error(error), seed)
    }

    fn look(
        &self,
        (point, normal): (Vec3, Vec3),
        rays: Rays,
        (seed, number): (u64, u32),
        aims: &mut [Aim],
        check: Check,
    ) -> Seen {
        let mut seen = Seen::default();
        let of_look = mix(seed, u64::from(number) + 1);
        let of_ends = mix(seed, 1);
        let read = |seen: &mut Seen, met: &Met, weight: f32, index: u32| {
            let number = number * MOST_ENDS + index;
            let sent = self.sent_back(met, point, (mix(of_ends, number.into()), 0));
            seen.light += weight * sent;
            // Where the path went on, the field was not read here.
            if check == Check::Yes && !is_near(self.hierarchy.element(met.leaf).area, met.position, point) {
                let patch = self.patch(met.leaf);
                let further = GatherPoint::on_face((met.position, patch.normal));
                let further = self.glance(&further, FURTHER, (of_ends, number)).irradiance();
                seen.change += weight * (self.surface(patch.polygon).reflectance * further - sent);
                seen.rays += FURTHER.aimed + FURTHER.cosine;
            }
        };
        let mut index = rays.cosine;
        let reflect = &mut |met: Met, weight: f32| {
            index += 1;
            read(&mut seen, &met, weight, index);
        };
        // The upper half of the seed keeps the samples of a source in one sequence over all looks.
        let seed_of_aims = (seed << 32) | (of_look & 0xffff_ffff);
        let (emitted, aimed) = self.aim((point, normal), aims, rays.aimed, seed_of_aims, reflect);
        seen.light += emitted;
        seen.rays += aimed + rays.cosine;
        let scramble = (seed ^ (seed >> 32)) as u32;
        let sky = self.sky_rays(rays.cosine, DRAWN);
        for index in 0..rays.cosine {
            let [u, v, ..] = sobol_burley::sample_4d(number * rays.cosine + index, 0, scramble);
            let direction = cosine_direction(normal, u, v);
            match self.meet(point, normal, direction) {
                End::Face(met) if !self.is_aimed_at(met.leaf, point, normal) => {
                    read(&mut seen, &met, 1.0 / rays.cosine as f32, index);
                }
                End::Outside => seen.light += self.sky_along(direction, normal.dot(direction), sky),
                End::Face(_) | End::Back => {}
            }
        }
        if self.outside().is_some() {
            let place = GatherPoint::on_face((point, normal));
            for ray in number * DRAWN..number * DRAWN + sky.drawn {
                let [u, v, ..] = sobol_burley::sample_4d(ray, 1, scramble);
                seen.light += self.sky_drawn(&place, [u, v], sky);
            }
            for ray in number * TO_SUN..(number + 1) * TO_SUN * self.sun_rays() {
                let [u, v, ..] = sobol_burley::sample_4d(ray, 2, scramble);
                seen.light += self.sun_light(&place, [u, v]) / TO_SUN as f32;
            }
            seen.rays += sky.drawn + TO_SUN * self.sun_rays();
        }
        seen
    }
}

impl Sums {
    fn add(&mut self, seen: &Seen) {
        let change = grey(seen.change);
        self.looks += 1;
        self.light += seen.light;
        self.squares += seen.light * seen.light;
        self.grey_squares += grey(seen.light) * grey(seen.light);
        self.change += change;
        self.change_squares += change * change;
        self.rays += u64::from(seen.rays);
    }

    fn irradiance(&self) -> Irradiance {
        let count = self.looks as f32;
        let mean = self.light / count;
        let variance = (self.squares / count - mean * mean).max(Vec3::ZERO) / (count - 1.0).max(1.0);
        Irradiance { mean, standard_error: variance.map(f32::sqrt), looks: self.looks, rays: self.rays }
    }
}

/// Mean of values and the variance of that, from their number, sum and sum of squares.
fn mean_and_variance(count: u32, sum: f32, squares: f32) -> (f32, f32) {
    let count = count as f32;
    let mean = sum / count;
    (mean, (squares / count - mean * mean).max(0.0) / (count - 1.0).max(1.0))
}
