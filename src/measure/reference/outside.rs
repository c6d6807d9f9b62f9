//! Sky and sun in paths, by code of the reference's own: directions are drawn from cells of equal
//! solid angle.

use std::f64::consts::{PI, TAU};
use std::sync::Arc;

use glam::DVec3;

use super::path::cosine_at;
use super::surfaces::{Surfaces, Vertex};
use crate::scene::Scene;
use crate::scene::outside::{Outside, SUN_RADIUS};

/// Bands of equal height, and cells of each.
const BANDS: usize = 96;
const CELLS: usize = 192;
/// Samples of the sky along each side of a cell.
const SAMPLES: usize = 4;
/// Share of the drawn directions that heed no cell's brightness: a sample may miss a bright place.
const EVENLY: f64 = 0.1;

/// Sky and sun of a scene.
pub struct Daylight {
    outside: Arc<Outside>,
    /// Unit vector towards the sun and irradiance of a face turned to it, W/m².
    sun: Option<(DVec3, DVec3)>,
    /// Sum of the cells' brightness up to and including each; none where the sky is dark.
    up_to: Vec<f64>,
}

impl Daylight {
    /// The outside of a scene, where it shines.
    pub fn new(scene: &Scene) -> Option<Self> {
        let outside = scene.outside()?.clone();
        let sun = outside.sun().map(|sun| (sun.direction.as_dvec3().normalize(), sun.irradiance.as_dvec3()));
        let mut sum = 0.0;
        let mut up_to = Vec::new();
        if outside.has_sky() {
            for cell in 0..BANDS * CELLS {
                let place = |sample: usize| (sample as f64 + 0.5) / SAMPLES as f64;
                let brightness = |sample: usize| {
                    let direction = direction_in(cell, [place(sample % SAMPLES), place(sample / SAMPLES)]);
                    f64::from(outside.radiance(direction.as_vec3()).max_element())
                };
                sum += (0..SAMPLES * SAMPLES).map(brightness).sum::<f64>();
                up_to.push(sum);
            }
        }
        Some(Self { outside, sun, up_to })
    }

    /// Irradiance by a random direction of the sky and one of the sun, with the weight of the
    /// former against the direction that the path takes by chance.
    pub fn light(&self, surfaces: &Surfaces, from: &Vertex, sky: [[f32; 2]; 2], sun: [f32; 2]) -> DVec3 {
        self.sun_light(surfaces, from, sun) + self.sky_light(surfaces, from, sky)
    }

    fn sun_light(&self, surfaces: &Surfaces, from: &Vertex, [u, v]: [f32; 2]) -> DVec3 {
        let Some((towards, irradiance)) = self.sun else { return DVec3::ZERO };
        let (east, north) = towards.any_orthonormal_pair();
        let radius = f64::from(u).sqrt() * f64::from(SUN_RADIUS);
        let (sine, cosine) = (TAU * f64::from(v)).sin_cos();
        let direction = (towards + radius * (cosine * east + sine * north)).normalize();
        let height = cosine_at(from, direction);
        if height > 0.0 && surfaces.is_open(from, direction) { height * irradiance } else { DVec3::ZERO }
    }

    fn sky_light(&self, surfaces: &Surfaces, from: &Vertex, [[pick, mixed], [u, v]]: [[f32; 2]; 2]) -> DVec3 {
        let Some(&total) = self.up_to.last().filter(|total| **total > 0.0) else { return DVec3::ZERO };
        let count = self.up_to.len();
        let cell = if f64::from(mixed) < EVENLY {
            (f64::from(pick) * count as f64) as usize
        } else {
            self.up_to.partition_point(|up_to| *up_to <= f64::from(pick) * total)
        };
        let direction = direction_in(cell.min(count - 1), [u.into(), v.into()]);
        let cosine = cosine_at(from, direction);
        if cosine <= 0.0 || !surfaces.is_open(from, direction) {
            return DVec3::ZERO;
        }
        let radiance = self.outside.radiance(direction.as_vec3()).as_dvec3();
        // L·cosθ over the sum of both densities: the balance heuristic.
        radiance * cosine / (self.density(direction) + cosine / PI)
    }

    /// Irradiance by the direction that a path takes by chance, where it leaves the scene.
    pub fn met(&self, from: &Vertex, direction: DVec3) -> DVec3 {
        let cosine = cosine_at(from, direction);
        let radiance = self.outside.radiance(direction.as_vec3()).as_dvec3();
        if cosine > 0.0 { radiance * cosine / (self.density(direction) + cosine / PI) } else { DVec3::ZERO }
    }

    /// Density of a drawn direction, 1/sr.
    fn density(&self, direction: DVec3) -> f64 {
        let Some(&total) = self.up_to.last().filter(|total| **total > 0.0) else { return 0.0 };
        let band = ((1.0 - direction.z) * 0.5 * BANDS as f64) as usize;
        let place = (direction.y.atan2(direction.x).rem_euclid(TAU) / TAU * CELLS as f64) as usize;
        let cell = band.min(BANDS - 1) * CELLS + place.min(CELLS - 1);
        let own = self.up_to[cell] - if cell > 0 { self.up_to[cell - 1] } else { 0.0 };
        let count = self.up_to.len() as f64;
        (EVENLY + (1.0 - EVENLY) * own / total * count) / (4.0 * PI)
    }
}

/// The direction at a place of a cell, 0..1 along both sides.
fn direction_in(cell: usize, [u, v]: [f64; 2]) -> DVec3 {
    let height = 1.0 - 2.0 * ((cell / CELLS) as f64 + v) / BANDS as f64;
    let (sine, cosine) = (TAU * ((cell % CELLS) as f64 + u) / CELLS as f64).sin_cos();
    let radius = (1.0 - height * height).max(0.0).sqrt();
    DVec3::new(radius * cosine, radius * sine, height)
}
