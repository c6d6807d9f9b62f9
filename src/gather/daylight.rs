//! Light from outside at a point: the sky where rays leave the scene, and the sun, at which one more ray is aimed.
//!
//! The light of an even sky is found by the cosine-distributed rays that leave the scene. A sky that is much brighter in some
//! places is also looked at along directions drawn by its radiance; the balance heuristic [Veach, Guibas 1995] weighs both.

use std::f32::consts::PI;

use glam::Vec3;

use super::field::Field;
use super::glance::GatherPoint;
use crate::scene::outside::Outside;

/// Rays of a look that may find the sky.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct SkyRays {
    /// Cosine-distributed.
    pub cosine: u32,
    /// Drawn by the sky's radiance.
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

    /// Rays that may find the sky in a look of so many cosine-distributed rays; as many as `most` are drawn where the sky is uneven.
    pub(super) fn sky_rays(&self, cosine: u32, most: u32) -> SkyRays {
        let is_uneven = self.outside().is_some_and(|outside| !outside.is_even());
        SkyRays { cosine, drawn: if is_uneven && cosine > 0 { most } else { 0 } }
    }

    /// Irradiance by one of these rays that leaves the scene under a cosine to the normal, W/m²: its share of the mean over all.
    pub(super) fn sky_along(&self, direction: Vec3, cosine: f32, rays: SkyRays) -> Vec3 {
        let Some(outside) = self.outside().filter(|outside| outside.has_sky()) else { return Vec3::ZERO };
        if cosine <= 0.0 {
            return Vec3::ZERO;
        }
        let drawn = if rays.drawn > 0 { rays.drawn as f32 * outside.density(direction) } else { 0.0 };
        cosine / (rays.cosine as f32 * cosine / PI + drawn) * outside.radiance(direction)
    }

    /// Irradiance by a ray in a direction drawn by the sky's radiance, W/m².
    pub(super) fn sky_drawn(&self, place: &GatherPoint, numbers: [f32; 2], rays: SkyRays) -> Vec3 {
        let Some(drawn) = self.outside().and_then(|outside| outside.draw(numbers)) else { return Vec3::ZERO };
        let cosine = place.normal.dot(drawn.direction);
        if cosine > 0.0 && self.is_open(place, drawn.direction) {
            self.sky_along(drawn.direction, cosine, rays)
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
