//! The sky behind a scene, for pictures of the mesh: gathered ones find it by their own rays.

use std::f32::consts::PI;

use glam::vec2;
use rayon::prelude::*;

use super::{Lens, ground};
use crate::read::tone::{encode_gamma, tone_curve};
use crate::scene::outside::Outside;

/// The picture where nothing of the scene is seen, gamma-encoded, rows from above, with an exposure
/// (m²/W): the sky, and the usual ground where it is black.
pub fn sky_behind(outside: &Outside, lens: &Lens, exposure: f32, [width, height]: [u32; 2]) -> Vec<[u8; 4]> {
    let mut pixels = vec![[0, 0, 0, 255]; width as usize * height as usize];
    pixels.par_chunks_exact_mut(width.max(1) as usize).enumerate().for_each(|(y, row)| {
        let down = (y as f32 + 0.5) / height as f32;
        for (x, pixel) in row.iter_mut().enumerate() {
            let across = (x as f32 + 0.5) / width as f32;
            let radiance = outside.radiance(lens.direction(vec2(2.0 * across - 1.0, 1.0 - 2.0 * down)));
            let colour = if radiance.max_element() > 0.0 {
                (exposure * PI * radiance).map(|light| encode_gamma(tone_curve(light)))
            } else {
                ground(1.0 - down)
            };
            let [r, g, b] = colour.to_array().map(|channel| (255.0 * channel).round() as u8);
            *pixel = [r, g, b, 255];
        }
    });
    pixels
}
