//! Irradiance at the samples of a picture, as looks add it up.

use glam::Vec3;
use rayon::prelude::*;

use super::Sights;
use crate::cancel::CancelToken;
use crate::gather::{Field, GlanceRays};
use crate::random::mix;

/// Rays of each look: a few, for many samples share what they find.
const RAYS: GlanceRays = GlanceRays { aimed: 1, cosine: 2 };
/// Sides of the blocks whose samples share a sequence of random numbers; a power of two.
const BLOCK: u32 = 64;

/// What the looks from a sample found.
#[derive(Clone, Copy, Debug, Default)]
pub struct Found {
    /// Sum over the looks of the irradiance, W/m².
    pub irradiance: Vec3,
    /// Sum over the looks of the mean of 1 / distance to what surrounds the sample.
    pub nearness: f32,
}

/// Irradiance at the samples of a picture.
#[derive(Clone, Debug)]
pub struct Light {
    /// Of each sample.
    pub found: Vec<Found>,
    /// Looks from each.
    pub looks: u32,
}

impl Light {
    /// Nothing found yet.
    pub fn new(sights: &Sights) -> Self {
        Self { found: vec![Found::default(); sights.all.len()], looks: 0 }
    }

    /// Looks once more from every sample. `None` if cancelled; the light is then spoilt.
    pub fn look(&mut self, field: &Field, sights: &Sights, cancel: &CancelToken) -> Option<()> {
        let width = (sights.size[0] as usize).max(1);
        let pass = u64::from(self.looks);
        let rows = self.found.par_chunks_exact_mut(width).zip(sights.all.par_chunks_exact(width));
        rows.enumerate().for_each(|(row, (found, sights))| {
            let row = row as u32;
            for (column, (found, sight)) in (0_u32..).zip(found.iter_mut().zip(sights)) {
                if column % BLOCK == 0 && cancel.is_cancelled() {
                    return;
                }
                if sight.polygon().is_none() {
                    continue;
                }
                let block = u64::from(row / BLOCK) << 32 | u64::from(column / BLOCK);
                let index = interleave(column % BLOCK) | interleave(row % BLOCK) << 1;
                let glance = field.glance((sight.position, sight.normal), RAYS, (mix(block, pass), index));
                found.irradiance += glance.irradiance;
                found.nearness += glance.nearness;
            }
        });
        self.looks += 1;
        (!cancel.is_cancelled()).then_some(())
    }
}

/// Spreads the lower 16 bits out to every second one (Morton order).
fn interleave(bits: u32) -> u32 {
    let bits = (bits | bits << 8) & 0x00ff_00ff;
    let bits = (bits | bits << 4) & 0x0f0f_0f0f;
    let bits = (bits | bits << 2) & 0x3333_3333;
    (bits | bits << 1) & 0x5555_5555
}
