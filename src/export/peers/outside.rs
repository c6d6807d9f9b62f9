//! The outside for other programs: the sky as a picture all around, the sun as a direction with its
//! disc.

use std::f32::consts::PI;

use glam::Vec3;

use crate::scene::Scene;
use crate::scene::outside::{Outside, SUN_RADIUS};

/// Width and height of a sky's picture, pixels.
pub const SKY_SIZE: [usize; 2] = [1024, 512];
/// A disc that stands for the sun is so many times the scene's diagonal away: directions to it
/// differ by 1e-4.
const FAR: f32 = 1e4;

/// Radiances of the sky by the direction of each pixel's middle, rows from the zenith (y) down; −z
/// lies at the left and right rim, x a quarter from the left.
pub fn sky_pixels(outside: &Outside) -> impl Iterator<Item = Vec3> {
    let [width, height] = SKY_SIZE;
    (0..width * height).map(move |index| {
        let (x, y) = ((index % width) as f32 + 0.5, (index / width) as f32 + 0.5);
        let (sine, cosine) = (2.0 * PI * (x / width as f32)).sin_cos();
        let (height_sine, height) = (PI * (y / height as f32)).sin_cos();
        outside.radiance(Vec3::new(height_sine * sine, height, -height_sine * cosine))
    })
}

/// A far disc that shines like the sun: its middle, radius and radiance.
pub fn sun_disc(scene: &Scene, outside: &Outside) -> Option<(Vec3, f32, Vec3)> {
    let sun = outside.sun()?;
    let (lower, upper) = scene.bounds();
    let distance = FAR * lower.distance(upper).max(f32::MIN_POSITIVE);
    Some((0.5 * (lower + upper) + distance * sun.direction, distance * SUN_RADIUS.tan(), sun.radiance()))
}
