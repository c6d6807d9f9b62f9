//! Irradiance at the samples of a picture, as looks add it up.
//!
//! A pass looks from one sample of each pixel, the next pass from another one: samples of one
//! surface share what they find ([`super::Filter`]), so few need a look of their own. Those that
//! have nobody to share with, beside edges and on what is thin, get one in the first pass.

use glam::Vec3;
use rayon::prelude::*;

use super::filter::is_alike;
use super::{VisibleSurface, VisibleSurfaces};
use crate::base::cancel::CancelToken;
use crate::base::random::hash64;
use crate::gather::{Field, GatherPoint, GlanceRays, grey};

/// Rays of each look: a few, for many samples share what they find.
const RAYS: GlanceRays = GlanceRays { aimed: 1, cosine: 2 };
/// Parts of light that are shared apart: by emitters, by what others reflect, by the sun.
pub(super) const PARTS: usize = 3;
/// The last of them.
pub(super) const SUN: usize = 2;
/// Sides of the blocks whose pixels share a sequence of random numbers; a power of two.
const BLOCK: u32 = 64;
/// Sides of the tiles of pixels that are looked from again or not, as a whole; a power of two up to
/// that of blocks.
pub(super) const TILE: u32 = 16;

/// Light that the looks from a sample found.
#[derive(Clone, Copy, Debug, Default)]
pub struct Found {
    /// Sums over the looks of the irradiance by emitters, by what others reflect, and by the sun,
    /// W/m².
    pub sums: [Vec3; PARTS],
    /// The sums (mean of the colours) with the sign of every other look turned, which tell the
    /// noise.
    pub signed: [f32; PARTS],
    /// Sum of the signs.
    pub signs: f32,
    /// Sum over the looks of the mean of 1 / distance to what surrounds the sample.
    pub nearness: f32,
    /// Looks.
    pub looks: f32,
}

/// Irradiance at the samples of a picture.
#[derive(Clone, Debug)]
pub struct Light {
    /// Of each sample.
    pub found: Vec<Found>,
    /// Passes over the picture.
    pub passes: u32,
}

impl Light {
    /// Nothing found yet.
    pub fn new(visible: &VisibleSurfaces) -> Self {
        Self { found: vec![Found::default(); visible.all.len()], passes: 0 }
    }

    /// Looks once more from the tiles that are wanted; all are in the first pass. `None` if
    /// cancelled: the light is then spoilt.
    pub fn look(
        &mut self,
        field: &Field,
        visible: &VisibleSurfaces,
        wanted: &Tiles,
        cancel: &CancelToken,
    ) -> Option<()> {
        let width = (visible.size[0] as usize).max(1);
        let (pass, side) = (self.passes, visible.per_side);
        self.found.par_chunks_exact_mut(width).enumerate().for_each(|(row, found)| {
            let row = row as u32;
            for (column, found) in (0_u32..).zip(found) {
                if column % BLOCK == 0 && cancel.is_cancelled() {
                    return;
                }
                let surface = &visible.all[row as usize * width + column as usize];
                let (x, y) = (column / side, row / side);
                if surface.polygon().is_none() || !wanted.holds(x, y) {
                    continue;
                }
                let is_chosen = is_chosen([column, row], side, pass);
                if !is_chosen && (pass > 0 || has_chosen_neighbour(visible, surface, [column, row])) {
                    continue;
                }
                let quarter = if is_chosen { 0 } else { 1 + (row % side * side + column % side) };
                let block = u64::from(y / BLOCK) << 32 | u64::from(x / BLOCK) << 3 | u64::from(quarter);
                let index = interleave(x % BLOCK) | interleave(y % BLOCK) << 1;
                let place = GatherPoint { position: surface.position, normal: surface.normal, face: surface.face };
                let glance = field.glance(&place, RAYS, (hash64(block, u64::from(pass)), index));
                // Neighbours differ in sign, as do looks from one sample.
                let sign = if (hash64(u64::from(column) << 32 | u64::from(row), 1) as u32)
                    .wrapping_add(found.looks as u32)
                    .is_multiple_of(2)
                {
                    1.0
                } else {
                    -1.0
                };
                for (part, light) in [glance.direct, glance.indirect, glance.sun].into_iter().enumerate() {
                    found.sums[part] += light;
                    found.signed[part] += sign * grey(light);
                }
                found.signs += sign;
                found.nearness += glance.nearness;
                found.looks += 1.0;
            }
        });
        self.passes += 1;
        (!cancel.is_cancelled()).then_some(())
    }
}

/// Whether a pass looks from this sample of its pixel.
fn is_chosen([column, row]: [u32; 2], side: u32, pass: u32) -> bool {
    let (x, y) = (column / side, row / side);
    (row % side) * side + column % side == (x + 2 * y + pass) % (side * side)
}

/// Whether a sample that the first pass chose lies beside this one and is of its surface.
fn has_chosen_neighbour(visible: &VisibleSurfaces, here: &VisibleSurface, [column, row]: [u32; 2]) -> bool {
    let [width, height] = visible.size;
    let mut near = (row.saturating_sub(2)..(row + 3).min(height))
        .flat_map(|y| (column.saturating_sub(2)..(column + 3).min(width)).map(move |x| [x, y]));
    near.any(|[x, y]| is_chosen([x, y], visible.per_side, 0) && is_alike(here, &visible.all[(y * width + x) as usize]))
}

/// Which tiles of a picture are looked from.
#[derive(Clone, Debug)]
pub struct Tiles {
    across: u32,
    wanted: Vec<bool>,
}

impl Tiles {
    /// All of a picture of this size, pixels.
    pub fn all([width, height]: [u32; 2]) -> Self {
        let across = width.div_ceil(TILE);
        Self { across, wanted: vec![true; (across * height.div_ceil(TILE)) as usize] }
    }

    /// Those of a picture whose number, counted row by row, is asked to be wanted.
    pub(super) fn chosen(size: [u32; 2], is_wanted: impl Fn([u32; 2]) -> bool + Sync) -> Self {
        let mut tiles = Self::all(size);
        let across = tiles.across;
        let place = |index: u32| [index % across * TILE, index / across * TILE];
        tiles.wanted.par_iter_mut().enumerate().for_each(|(index, wanted)| *wanted = is_wanted(place(index as u32)));
        tiles
    }

    fn holds(&self, x: u32, y: u32) -> bool {
        self.wanted[(y / TILE * self.across + x / TILE) as usize]
    }
}

/// Spreads the lower 16 bits out to every second one (Morton order).
fn interleave(bits: u32) -> u32 {
    let bits = (bits | bits << 8) & 0x00ff_00ff;
    let bits = (bits | bits << 4) & 0x0f0f_0f0f;
    let bits = (bits | bits << 2) & 0x3333_3333;
    (bits | bits << 1) & 0x5555_5555
}
