//! Irradiance at a point, with its standard error: the one estimator that every reading asks.
//!
//! A look is a few rays aimed at emitters and a few cosine-distributed ones whose ends are read from
//! the field. Looks are repeated until their spread says that the mean is as exact as was asked for.

use glam::Vec3;

use super::field::{Field, Met, grey};
use super::glance::{GatherPoint, GlanceRays};
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

/// How far light is followed before the field is read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Depth {
    /// The field is read where a ray ends, unless that is nearer than the field is fine.
    Near,
    /// One reflection more is followed from wherever a ray ends.
    Further,
}

/// Ends of the rays of a look, at most as far as their numbers tell.
const MOST_ENDS: u32 = 64;
/// Rays of the look from where a ray ended.
const FURTHER: GlanceRays = GlanceRays { aimed: 2, cosine: 2 };

impl Field {
    /// Irradiance at a point of a face with this unit normal. The seed alone tells the random numbers,
    /// so a reading does not depend on others.
    pub fn irradiance_at(&self, place: (Vec3, Vec3), budget: &Budget, seed: u64, depth: Depth) -> Irradiance {
        let mut aims = Vec::new();
        self.find_aims(place.0, place.1, &mut aims);
        let (mut sum, mut squares, mut grey_squares, mut rays) = (Vec3::ZERO, Vec3::ZERO, 0.0, 0);
        let mut looks = 0;
        loop {
            let (light, cast) = self.look(place, budget.rays, (seed, looks), &mut aims, depth);
            looks += 1;
            sum += light;
            squares += light * light;
            grey_squares += grey(light) * grey(light);
            rays += u64::from(cast);
            // Whoever asks after every look stops where little was found by chance, and reads too low.
            if looks < budget.least || !(looks / budget.least).is_power_of_two() || looks % budget.least != 0 {
                continue;
            }
            let count = looks as f32;
            let mean = grey(sum) / count;
            let variance = (grey_squares / count - mean * mean).max(0.0) / (count - 1.0);
            let allowed = budget.error * (mean + self.dim());
            if looks >= budget.most || variance <= allowed * allowed {
                break;
            }
        }
        let count = looks as f32;
        let mean = sum / count;
        let variance = (squares / count - mean * mean).max(Vec3::ZERO) / (count - 1.0).max(1.0);
        Irradiance { mean, standard_error: variance.map(f32::sqrt), looks, rays }
    }

    /// Irradiance at a place of a polygon, to a standard error that is this share of the local light. It
    /// depends on the place alone.
    pub fn read(&self, polygon: u32, position: Vec3, error: f32) -> Irradiance {
        let normal = self.normal(polygon);
        let seed = position.to_array().iter().fold(u64::from(polygon), |seed, x| mix(seed, u64::from(x.to_bits())));
        self.irradiance_at((position, normal), &Budget::to_error(error), seed, Depth::Near)
    }

    /// One look: the irradiance that its rays find, W/m², and how many they were.
    pub fn look(
        &self,
        (point, normal): (Vec3, Vec3),
        rays: Rays,
        (seed, number): (u64, u32),
        aims: &mut [Aim],
        depth: Depth,
    ) -> (Vec3, u32) {
        let mut cast = 0;
        let mut light = Vec3::ZERO;
        let of_look = mix(seed, u64::from(number) + 1);
        let follow =
            |met: &Met, index: u32| self.reflected_by(met, point, depth, (mix(seed, 1), number * MOST_ENDS + index));
        let mut told = rays.cosine;
        let reflect = &mut |met: Met, weight: f32| {
            told += 1;
            let (reflected, rays) = follow(&met, told);
            cast += rays;
            light += weight * reflected;
        };
        // The upper half of the seed keeps the samples of a source in one sequence over all looks.
        let seed_of_aims = (seed << 32) | (of_look & 0xffff_ffff);
        let (emitted, aimed) = self.aim((point, normal), aims, rays.aimed, seed_of_aims, reflect);
        light += emitted;
        cast += aimed + rays.cosine;
        let scramble = (seed ^ (seed >> 32)) as u32;
        for index in 0..rays.cosine {
            let [u, v, ..] = sobol_burley::sample_4d(number * rays.cosine + index, 0, scramble);
            let direction = cosine_direction(normal, u, v);
            let Some(met) = self.meet(point, normal, direction) else { continue };
            if self.is_aimed_at(met.leaf, point, normal) {
                continue;
            }
            let (reflected, rays_beyond) = follow(&met, index);
            cast += rays_beyond;
            light += reflected / rays.cosine as f32;
        }
        (light, cast)
    }

    /// What leaves a place that a ray from `from` met, but for its emission, W/m², and the rays cast for it.
    fn reflected_by(&self, met: &Met, from: Vec3, depth: Depth, (seed, number): (u64, u32)) -> (Vec3, u32) {
        match depth {
            Depth::Near => (self.sent_back(met, from, (mix(seed, number.into()), 0)), 0),
            Depth::Further => {
                let patch = self.patch(met.leaf);
                let place = (met.position, patch.normal);
                let glance = self.glance(&GatherPoint::on_face(place), FURTHER, (seed, number));
                (self.surface(patch.polygon).reflectance * glance.irradiance(), FURTHER.aimed + FURTHER.cosine)
            }
        }
    }
}
