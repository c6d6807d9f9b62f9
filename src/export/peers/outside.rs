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

/// Radiances of the sky by the direction of each pixel's middle, rows from the zenith down;
/// `direction` tells the direction of an azimuth's share of the full circle and an angle from the
/// zenith's share of the half circle.
pub fn sky_pixels(outside: &Outside, direction: impl Fn(f32, f32) -> Vec3) -> Vec<Vec3> {
    let [width, height] = SKY_SIZE;
    let pixel = |index: usize| {
        let (x, y) = ((index % width) as f32 + 0.5, (index / width) as f32 + 0.5);
        outside.radiance(direction(x / width as f32, y / height as f32))
    };
    (0..width * height).map(pixel).collect()
}

/// Angles of a pixel: its azimuth's and its zenith angle's sine and cosine.
pub fn angles(across: f32, down: f32) -> [(f32, f32); 2] {
    [(2.0 * PI * across).sin_cos(), (PI * down).sin_cos()]
}

/// A far disc that shines like the sun: its middle, radius and radiance.
pub fn sun_disc(scene: &Scene, outside: &Outside) -> Option<(Vec3, f32, Vec3)> {
    let sun = outside.sun()?;
    let (lower, upper) = scene.bounds();
    let distance = FAR * lower.distance(upper).max(f32::MIN_POSITIVE);
    Some((0.5 * (lower + upper) + distance * sun.direction, distance * SUN_RADIUS.tan(), sun.radiance()))
}
