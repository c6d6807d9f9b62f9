//! A filter that shares irradiance between samples of one smooth surface.
//!
//! An edge-avoiding à-trous filter [Dammertz et al., HPG 2010] at the resolution of the samples,
//! before pixels mix surfaces. How far light is shared depends on how far away what surrounds a
//! sample is, as irradiance caching does it [Ward, Rubinstein, Clear, SIGGRAPH 1988]: in a corner
//! or beside a contact light changes within a hand's breadth, in the middle of a wall it does not.
//!
//! A mean is the light at the mean place of what it was made of. Beside the rim of a surface that
//! lies further in than the sample does; so the mean place goes through the filter beside the
//! light, whose slope then leads back to the sample: light that changes linearly is kept, as local
//! linear regression keeps it [Cleveland 1979].

mod slope;

use glam::{Vec3, Vec4};
use rayon::prelude::*;
use slope::at_own_place;

use super::light::{Light, PARTS, SUN, TILE};
use super::visible_surfaces::Place;
use super::{VisibleSurface, VisibleSurfaces};
use crate::base::cancel::CancelToken;
use crate::gather::grey;

/// Weights of the samples of a pass, by how many steps away they lie (a cubic B-spline).
const KERNEL: [f32; 3] = [0.375, 0.25, 0.0625];
/// Samples off the tangent plane by so much of their distance from the eye share little.
const PLANE: f32 = 0.01;
/// Surfaces that are turned further than this (cosine) from each other share nothing; the exponent
/// on the cosine of others.
const TURNED: f32 = 0.5;
const SMOOTHNESS: i32 = 32;
/// Deviation of the weights at least, in distances between samples, after one look: less would
/// leave noise in corners. Direct light has shadows whose edges are to stay, indirect light is
/// smoother than that. The sun's edges are as sharp as those of what casts them: its light goes no
/// further than to samples that nobody looked from.
const LEAST_REACH: [f32; PARTS] = [4.0, 12.0, 1.0];
/// Samples that are less alike are of different surfaces.
const ALIKE: f32 = 0.5;
/// A sample is as bright as so many times the light of those around it, at most: the little that is
/// lost of what few rays find is less than the spots that these would leave.
const BRIGHTEST: f32 = 16.0;
/// Squared deviations at which the fall-off of a weight has come to nothing.
const FAR: f32 = 8.0;
/// How far light is shared.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Filter {
    /// Passes; the last one reaches 2^passes samples.
    pub passes: u32,
    /// Deviation of the weights over a surface after one look, as a share of the harmonic mean
    /// distance to what surrounds a sample: for direct light, for indirect light and for the sun's.
    pub reach: [f32; PARTS],
}

impl Filter {
    /// The filter of pictures.
    pub const PICTURE: Self = Self { passes: 4, reach: [0.1, 0.15, 0.0] };
    /// A wide one, for lines of equal value, which noise would fray.
    pub const LINES: Self = Self { passes: 5, reach: [0.2, 0.3, 0.0] };
}

/// Light that was shared, at a sample.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Share {
    /// Irradiance, W/m².
    pub irradiance: Vec3,
    /// Noise of the light: a draw from the distribution of its error (mean of the colours), W/m².
    pub noise: f32,
}

/// The first parts of the light on their way through the filter: colours, and the noise as the
/// fourth.
#[derive(Clone, Copy, Debug)]
struct Mixed<const N: usize> {
    light: [Vec4; N],
    /// Looks that stand behind each.
    weight: [f32; N],
    /// From the sample to the mean place of what each was made of, in the scene's length.
    shift: [Vec3; N],
}

impl<const N: usize> Mixed<N> {
    const NOTHING: Self = Self { light: [Vec4::ZERO; N], weight: [0.0; N], shift: [Vec3::ZERO; N] };
}

/// 1 / squared deviations of the weights of each part at a sample, 1/m².
type Narrowness<const N: usize> = [f32; N];

impl Filter {
    /// Shares the light of all samples; `None` if cancelled.
    ///
    /// As noise falls with the looks n, less is shared: a reach that falls as n^(−1/6) lets bias
    /// and noise fall alike, as kernels over a plane do [Silverman 1986]. What is shared depends on
    /// where samples lie and on what surrounds them, never on their light, so noise goes through
    /// the filter as light does.
    pub fn share(&self, visible: &VisibleSurfaces, light: &Light, cancel: &CancelToken) -> Option<Vec<Share>> {
        let has_sun = light.found.par_iter().any(|found| found.sums[SUN] != Vec3::ZERO);
        match has_sun {
            true => self.share_parts::<PARTS>(visible, light, cancel),
            false => self.share_parts::<SUN>(visible, light, cancel),
        }
    }

    /// Shares the first parts of the light: the sun's comes last, and costs nothing where it does
    /// not shine.
    fn share_parts<const N: usize>(
        &self,
        visible: &VisibleSurfaces,
        light: &Light,
        cancel: &CancelToken,
    ) -> Option<Vec<Share>> {
        let places: Vec<Place> = visible.all.par_iter().map(VisibleSurface::place).collect();
        let (mut mixed, narrowness) = self.start::<N>(visible, &places, light, cancel)?;
        let mut next = vec![Mixed::NOTHING; mixed.len()];
        let grid = Grid { size: visible.size.map(|side| side as i32), spacing: visible.spacing, places: &places };
        let width = (visible.size[0] as usize).max(1);
        for pass in 0..self.passes {
            next.par_chunks_exact_mut(width).enumerate().for_each(|(row, next)| {
                if !cancel.is_cancelled() {
                    share_row(&grid, &mixed, &narrowness, 1 << pass, row, next);
                }
            });
            std::mem::swap(&mut mixed, &mut next);
        }
        let mut shares = vec![Share::default(); mixed.len()];
        let widest = 1 << self.passes.saturating_sub(1);
        shares.par_chunks_exact_mut(width).enumerate().for_each(|(row, shares)| {
            for (column, share) in shares.iter_mut().enumerate() {
                if column % TILE as usize == 0 && cancel.is_cancelled() {
                    return;
                }
                let light = at_own_place(&grid, &mixed, &narrowness, widest, row * width + column);
                *share = Share { irradiance: light.truncate(), noise: light.w };
            }
        });
        (!cancel.is_cancelled()).then_some(shares)
    }

    /// Looks at the 5×5 samples around each.
    fn start<const N: usize>(
        &self,
        visible: &VisibleSurfaces,
        places: &[Place],
        light: &Light,
        cancel: &CancelToken,
    ) -> Option<(Vec<Mixed<N>>, Vec<Narrowness<N>>)> {
        let [width, height] = visible.size.map(|side| side as usize);
        let mut mixed = vec![Mixed::NOTHING; light.found.len()];
        let mut narrowness = vec![[0.0; N]; light.found.len()];
        let rows = mixed.par_chunks_exact_mut(width.max(1)).zip(narrowness.par_chunks_exact_mut(width.max(1)));
        rows.enumerate().for_each(|(y, (mixed, narrowness))| {
            if cancel.is_cancelled() {
                return;
            }
            for (x, (mixed, narrowness)) in mixed.iter_mut().zip(narrowness).enumerate() {
                let index = y * width + x;
                let here = &places[index];
                if !here.is_seen() {
                    continue;
                }
                let per_plane = 1.0 / (PLANE * here.distance);
                let (mut samples, mut looks, mut nearness, mut sums) = (0.0, 0.0, 0.0, [0.0; N]);
                for y in y.saturating_sub(2)..(y + 3).min(height) {
                    for x in x.saturating_sub(2)..(x + 3).min(width) {
                        let found = &light.found[y * width + x];
                        let weight = likeness(here, &places[y * width + x], per_plane);
                        if weight > 0.0 {
                            samples += weight;
                            looks += weight * found.looks;
                            nearness += weight * found.nearness;
                            for (sum, of_found) in sums.iter_mut().zip(found.sums) {
                                *sum += weight * grey(of_found);
                            }
                        }
                    }
                }
                if looks <= 0.0 {
                    continue;
                }
                let narrowing = fewer(looks / samples * (visible.per_side * visible.per_side) as f32);
                let spacing = visible.spacing * here.distance;
                let surroundings = looks / nearness.max(f32::MIN_POSITIVE);
                for part in 0..N {
                    let reach = narrowing * (self.reach[part] * surroundings).max(LEAST_REACH[part] * spacing);
                    narrowness[part] = 1.0 / (reach * reach).max(f32::MIN_POSITIVE);
                }
                let found = &light.found[index];
                if found.looks > 0.0 {
                    let own: [f32; N] = std::array::from_fn(|part| grey(found.sums[part]));
                    let of_others = (sums.iter().sum::<f32>() - own.iter().sum::<f32>()) / (looks - found.looks);
                    let most = if looks > found.looks { BRIGHTEST * of_others * found.looks } else { f32::INFINITY };
                    let of = |part: usize| {
                        // What is left of one look without a partner is compared with the looks
                        // around.
                        let noise = found.signed[part] - found.signs * sums[part] / looks;
                        let kept = if own[part] > most { most / own[part] } else { 1.0 };
                        kept * found.sums[part].extend(noise) / found.looks
                    };
                    *mixed = Mixed { light: std::array::from_fn(of), weight: [found.looks; N], ..Mixed::NOTHING };
                }
            }
        });
        (!cancel.is_cancelled()).then_some((mixed, narrowness))
    }
}

/// Samples of a picture, row by row.
struct Grid<'a> {
    /// Width and height.
    size: [i32; 2],
    /// Distance between samples, as a share of the distance from the eye.
    spacing: f32,
    places: &'a [Place],
}

fn share_row<const N: usize>(
    grid: &Grid,
    mixed: &[Mixed<N>],
    narrowness: &[Narrowness<N>],
    step: i32,
    row: usize,
    next: &mut [Mixed<N>],
) {
    let [width, height] = grid.size;
    let y = row as i32;
    for (x, next) in (0..width).zip(next) {
        let index = (y * width + x) as usize;
        let here = &grid.places[index];
        *next = mixed[index];
        let narrowness = narrowness[index];
        let widest = narrowness.into_iter().fold(f32::INFINITY, f32::min);
        let nearest = step as f32 * grid.spacing * here.distance;
        if !here.is_seen() || nearest * nearest * widest >= FAR {
            continue;
        }
        let per_plane = 1.0 / (PLANE * here.distance);
        let (mut light, mut weights, mut kernels) = ([Vec4::ZERO; N], [0.0; N], [0.0; N]);
        let mut shift = [Vec3::ZERO; N];
        for down in -2_i32..=2 {
            let y = y + down * step;
            if !(0..height).contains(&y) {
                continue;
            }
            for right in -2_i32..=2 {
                let x = x + right * step;
                if !(0..width).contains(&x) {
                    continue;
                }
                let there = (y * width + x) as usize;
                let place = &grid.places[there];
                let away = place.position - here.position;
                let square = away.length_squared();
                if square * widest >= FAR {
                    continue;
                }
                let likeness = likeness(here, place, per_plane);
                if likeness <= 0.0 {
                    continue;
                }
                let kernel = likeness * KERNEL[right.unsigned_abs() as usize] * KERNEL[down.unsigned_abs() as usize];
                let there = &mixed[there];
                for part in 0..N {
                    let kernel = kernel * fall_off(square * narrowness[part]);
                    let weight = kernel * there.weight[part];
                    light[part] += weight * there.light[part];
                    shift[part] += weight * (away + there.shift[part]);
                    weights[part] += weight;
                    kernels[part] += kernel;
                }
            }
        }
        for part in 0..N {
            if weights[part] > 0.0 {
                next.light[part] = light[part] / weights[part];
                next.weight[part] = weights[part] / kernels[part];
                next.shift[part] = shift[part] / weights[part];
            }
        }
    }
}

/// How far two samples are of one smooth surface, 0..=1; 1 for a sample and itself.
#[inline]
fn likeness(here: &Place, there: &Place, per_plane: f32) -> f32 {
    if here.is_beside(there) {
        return 1.0;
    }
    let cosine = here.normal.dot(there.normal);
    if cosine <= TURNED {
        return 0.0;
    }
    let off = here.normal.dot(there.position - here.position) * per_plane;
    cosine.powi(SMOOTHNESS) * fall_off(off * off)
}

/// How far two samples are of one smooth surface, 0..=1.
pub(super) fn likeness_of(here: &VisibleSurface, there: &VisibleSurface) -> f32 {
    if here.polygon().is_none() || there.polygon().is_none() {
        return 0.0;
    }
    likeness(&here.place(), &there.place(), 1.0 / (PLANE * here.distance))
}

/// Whether two samples are of one smooth surface, so that they can share light.
pub(super) fn is_alike(here: &VisibleSurface, there: &VisibleSurface) -> bool {
    likeness_of(here, there) > ALIKE
}

/// How far light is shared after so many looks from a pixel, as a share of how far it is after one.
fn fewer(looks: f32) -> f32 {
    looks.max(1.0).powf(-1.0 / 6.0)
}

/// Nearly exp(−x): 1 at 0, nothing from [`FAR`] on.
#[inline]
fn fall_off(x: f32) -> f32 {
    let base = (1.0 - x / FAR).max(0.0);
    let squared = base * base;
    let fourth = squared * squared;
    fourth * fourth
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::read::picture::light::Found;

    /// A floor of two by one and a half seen from above, with light that rises across it.
    fn floor(size: [u32; 2]) -> (VisibleSurfaces, Light, Vec<f32>) {
        let spacing = 2.0 / size[0] as f32;
        let places = (0..size[1]).flat_map(|y| (0..size[0]).map(move |x| Vec3::new(x as f32, y as f32, 0.0) * spacing));
        let all: Vec<_> = places.map(|place| VisibleSurface::on(0, place, Vec3::Z, 1.0)).collect();
        let rising: Vec<f32> = all.iter().map(|seen| 2.0 + seen.position.x + 0.5 * seen.position.y).collect();
        let found = rising.iter().map(|light| {
            let sums = [Vec3::splat(0.5 * light), Vec3::splat(0.5 * light), Vec3::ZERO];
            Found { sums, looks: 1.0, nearness: 0.5, ..Found::default() }
        });
        let light = Light { found: found.collect(), passes: 1 };
        (VisibleSurfaces { size, per_side: 1, spacing, all }, light, rising)
    }

    #[test]
    fn light_that_rises_evenly_is_kept_up_to_the_rim() {
        let (visible, light, rising) = floor([64, 48]);
        let shares = Filter::PICTURE.share(&visible, &light, &CancelToken::new()).unwrap();
        let off = |(share, light): (&Share, &f32)| (share.irradiance.x / light - 1.0).abs();
        let worst = shares.iter().zip(&rising).map(off).fold(0.0, f32::max);
        // Ends of the slope's own samples and its caution leave 1.0 %; of means alone, 9 % are
        // left.
        assert!(worst < 0.015, "off by {:.2} %", 100.0 * worst);
    }
}
