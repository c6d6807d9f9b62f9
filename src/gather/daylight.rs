//! Light from outside at a point: the sky where rays leave the scene, and the sun, at which one
//! more ray is aimed.
//!
//! The light of an even sky over open ground is found by the cosine-distributed rays that leave the
//! scene. Through openings, and where a sky is much brighter in some places, it is also looked at
//! along directions drawn by its radiance and by what is seen of it there; the balance heuristic
//! [Veach, Guibas 1995] weighs all of them.

use std::f32::consts::PI;

use glam::Vec3;

use super::field::Field;
use super::glance::GatherPoint;
use super::openings::Openings;
use crate::scene::outside::Outside;

/// Rays of a look that may find the sky.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct SkyRays {
    /// Cosine-distributed.
    pub cosine: u32,
    /// Drawn by the sky's radiance and by what is seen of it.
    pub drawn: u32,
}

impl Field {
    /// The sky and the sun, where the scene has them.
    pub(super) fn outside(&self) -> Option<&Outside> {
        self.around.outside.as_deref()
    }

    /// Radiance that the eye sees where it looks out of the scene, W/(m²·sr).
    pub fn sky_seen(&self, direction: Vec3) -> Vec3 {
        self.outside().map_or(Vec3::ZERO, |outside| outside.seen(direction))
    }

    /// Rays that may find the sky in a look of so many cosine-distributed rays; as many as `most`
    /// are drawn where the sky is uneven or seen through openings.
    pub(super) fn sky_rays(&self, cosine: u32, most: u32) -> SkyRays {
        let is_drawn = self.around.openings.is_some() || self.outside().is_some_and(|outside| !outside.is_even());
        SkyRays { cosine, drawn: if is_drawn && cosine > 0 { most } else { 0 } }
    }

    /// A direction towards the sky drawn for a point: by the radiance alone, by what is seen of it,
    /// or by either where both matter.
    fn draw_sky(&self, point: Vec3, [u, v]: [f32; 2]) -> Option<Vec3> {
        let outside = self.outside()?;
        let drawn = match (&self.around.openings, outside.is_even()) {
            (Some(openings), true) => openings.draw(outside, point, [u, v]),
            (Some(openings), false) if u < 0.5 => openings.draw(outside, point, [2.0 * u, v]),
            (Some(_), false) => outside.draw([2.0 * u - 1.0, v]),
            (None, _) => outside.draw([u, v]),
        };
        drawn.map(|drawn| drawn.direction)
    }

    /// Density with which [`Self::draw_sky`] draws a direction, 1/sr.
    fn sky_density(&self, point: Vec3, direction: Vec3) -> f32 {
        let Some(outside) = self.outside() else { return 0.0 };
        let seen = |openings: &Openings| openings.density(outside, point, direction);
        match (&self.around.openings, outside.is_even()) {
            (Some(openings), true) => seen(openings),
            (Some(openings), false) => 0.5 * (seen(openings) + outside.density(direction)),
            (None, _) => outside.density(direction),
        }
    }

    /// Irradiance by one of these rays that leaves the scene from a point under a cosine to the
    /// normal, W/m²: its share of the mean over all.
    pub(super) fn sky_along(&self, point: Vec3, direction: Vec3, cosine: f32, rays: SkyRays) -> Vec3 {
        let Some(outside) = self.outside().filter(|outside| outside.has_sky()) else { return Vec3::ZERO };
        if cosine <= 0.0 {
            return Vec3::ZERO;
        }
        let drawn = if rays.drawn > 0 { rays.drawn as f32 * self.sky_density(point, direction) } else { 0.0 };
        cosine / (rays.cosine as f32 * cosine / PI + drawn) * outside.radiance(direction)
    }

    /// Irradiance by a ray in a direction drawn for a point, W/m².
    pub(super) fn sky_drawn(&self, place: &GatherPoint, numbers: [f32; 2], rays: SkyRays) -> Vec3 {
        let Some(direction) = self.draw_sky(place.position, numbers) else { return Vec3::ZERO };
        let cosine = place.normal.dot(direction);
        if cosine > 0.0 && self.is_open(place, direction) {
            self.sky_along(place.position, direction, cosine, rays)
        } else {
            Vec3::ZERO
        }
    }

    /// Irradiance by a ray to a point of the sun's disc, W/m².
    pub(super) fn sun_light(&self, place: &GatherPoint, numbers: [f32; 2]) -> Vec3 {
        let Some(sun) = self.outside().and_then(Outside::sun) else { return Vec3::ZERO };
        let direction = sun.at(numbers);
        let cosine = place.normal.dot(direction);
        if cosine > 0.0 && self.is_open(place, direction) { cosine * sun.irradiance } else { Vec3::ZERO }
    }

    /// Rays that a look aims at the sun.
    pub(super) fn sun_rays(&self) -> u32 {
        u32::from(self.outside().is_some_and(|outside| outside.sun().is_some()))
    }

    /// Whether a direction leads from a point of a face out of the scene.
    fn is_open(&self, place: &GatherPoint, direction: Vec3) -> bool {
        place.face.dot(direction) > 0.0 && self.around.occluders.is_open(place.position, place.face, direction)
    }
}
