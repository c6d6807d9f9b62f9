//! A filter that shares irradiance between samples of one smooth surface.
//!
//! An edge-avoiding à-trous filter [Dammertz et al., HPG 2010] at the resolution of the samples, before
//! pixels mix surfaces. How far light is shared depends on how far away what surrounds a sample is, as
//! irradiance caching does it [Ward, Rubinstein, Clear, SIGGRAPH 1988]: in a corner or beside a contact
//! light changes within a hand's breadth, in the middle of a wall it does not.

use glam::Vec3;
use rayon::prelude::*;

use super::light::Light;
use super::{Sight, Sights};
use crate::cancel::CancelToken;
use crate::gather::grey;

/// Weights of the samples of a pass, by how many steps away they lie (a cubic B-spline).
const KERNEL: [f32; 3] = [0.375, 0.25, 0.0625];
/// Samples off the tangent plane by so much of their distance from the eye share little.
const PLANE: f32 = 0.01;
/// Surfaces that are turned further than this (cosine) from each other share nothing; the exponent on the cosine of others.
const TURNED: f32 = 0.5;
const SMOOTHNESS: i32 = 32;
/// Deviation of the weights at least, in distances between samples, after one look: less would leave noise in corners.
const LEAST_REACH: f32 = 1.5;
/// Squared deviations at which the fall-off of a weight has come to nothing.
const FAR: f32 = 8.0;

/// How far light is shared.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Filter {
    /// Passes; the last one reaches 2^passes samples.
    pub passes: u32,
    /// Deviation of the weights over a surface, as a share of the harmonic mean distance to what surrounds a sample.
    pub reach: f32,
}

impl Filter {
    /// The filter of a picture after n looks from each sample: as noise falls, less is shared. A reach that falls as n^(−1/6)
    /// lets bias and noise fall alike, as kernels over a plane do [Silverman 1986].
    pub fn after(looks: u32) -> Self {
        Self { passes: 4, reach: 0.1 * fewer(looks) }
    }

    /// A wide one, for lines of equal value, which noise would fray.
    pub fn for_lines() -> Self {
        Self { passes: 5, reach: 0.2 }
    }
}

/// Light that was shared, at a sample.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Share {
    /// Irradiance, W/m².
    pub irradiance: Vec3,
    /// Variance of its noise (mean of the colours), W²/m⁴; as if samples were independent, which overstates it.
    pub variance: f32,
}

/// What is known of the surroundings of a sample.
#[derive(Clone, Copy, Debug, Default)]
struct Surroundings {
    /// 1 / squared deviation of the weights, 1/m².
    per_reach_squared: f32,
    variance: f32,
}

impl Filter {
    /// Shares the light of all samples; `None` if cancelled.
    pub fn share(&self, sights: &Sights, light: &Light, cancel: &CancelToken) -> Option<Vec<Share>> {
        let looks = light.looks.max(1) as f32;
        let mut shares: Vec<Share> =
            light.found.par_iter().map(|found| Share { irradiance: found.irradiance / looks, variance: 0.0 }).collect();
        let around = self.surroundings(sights, light, &shares, cancel)?;
        shares.par_iter_mut().zip(&around).for_each(|(share, around)| share.variance = around.variance);
        let mut next = vec![Share::default(); shares.len()];
        for pass in 0..self.passes {
            let width = sights.size[0] as usize;
            next.par_chunks_exact_mut(width.max(1)).enumerate().for_each(|(row, next)| {
                if !cancel.is_cancelled() {
                    share_row(sights, &shares, &around, 1 << pass, row, next);
                }
            });
            std::mem::swap(&mut shares, &mut next);
        }
        (!cancel.is_cancelled()).then_some(shares)
    }

    /// Looks at the 5×5 samples around each.
    fn surroundings(
        &self,
        sights: &Sights,
        light: &Light,
        shares: &[Share],
        cancel: &CancelToken,
    ) -> Option<Vec<Surroundings>> {
        let [width, height] = sights.size.map(|side| side as usize);
        let mut around = vec![Surroundings::default(); shares.len()];
        around.par_chunks_exact_mut(width.max(1)).enumerate().for_each(|(y, row)| {
            if cancel.is_cancelled() {
                return;
            }
            for (x, around) in row.iter_mut().enumerate() {
                let here = &sights.all[y * width + x];
                if here.polygon().is_none() {
                    continue;
                }
                let per_plane = 1.0 / (PLANE * here.distance);
                let (mut total, mut nearness, mut sum, mut squares) = (0.0, 0.0, 0.0, 0.0);
                for y in y.saturating_sub(2)..(y + 3).min(height) {
                    for x in x.saturating_sub(2)..(x + 3).min(width) {
                        let index = y * width + x;
                        let weight = likeness(here, &sights.all[index], per_plane);
                        if weight > 0.0 {
                            let grey = grey(shares[index].irradiance);
                            total += weight;
                            nearness += weight * light.found[index].nearness;
                            sum += weight * grey;
                            squares += weight * grey * grey;
                        }
                    }
                }
                let mean = sum / total;
                let looks = light.looks as f32;
                let least = LEAST_REACH * fewer(light.looks) * sights.spacing * here.distance;
                let reach = (self.reach * total * looks / nearness).max(least);
                *around = Surroundings {
                    per_reach_squared: 1.0 / (reach * reach).max(f32::MIN_POSITIVE),
                    variance: (squares / total - mean * mean).max(0.0),
                };
            }
        });
        (!cancel.is_cancelled()).then_some(around)
    }
}

fn share_row(sights: &Sights, shares: &[Share], around: &[Surroundings], step: i32, row: usize, next: &mut [Share]) {
    let [width, height] = sights.size.map(|side| side as i32);
    let y = row as i32;
    for (x, next) in (0..width).zip(next) {
        let index = (y * width + x) as usize;
        let here = &sights.all[index];
        *next = shares[index];
        let per_reach_squared = around[index].per_reach_squared;
        let nearest = step as f32 * sights.spacing * here.distance;
        if here.polygon().is_none() || nearest * nearest * per_reach_squared >= FAR {
            continue;
        }
        let per_plane = 1.0 / (PLANE * here.distance);
        let (mut irradiance, mut variance, mut total) = (Vec3::ZERO, 0.0, 0.0);
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
                let sight = &sights.all[there];
                let off = sight.position.distance_squared(here.position) * per_reach_squared;
                if off >= FAR {
                    continue;
                }
                let kernel = KERNEL[right.unsigned_abs() as usize] * KERNEL[down.unsigned_abs() as usize];
                let weight = kernel * fall_off(off) * likeness(here, sight, per_plane);
                irradiance += weight * shares[there].irradiance;
                variance += weight * weight * shares[there].variance;
                total += weight;
            }
        }
        *next = Share { irradiance: irradiance / total, variance: variance / (total * total) };
    }
}

/// How far two samples are of one smooth surface, 0..=1; 1 for a sample and itself.
#[inline]
fn likeness(here: &Sight, there: &Sight, per_plane: f32) -> f32 {
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
pub(super) fn likeness_of(here: &Sight, there: &Sight) -> f32 {
    if here.polygon().is_none() || there.polygon().is_none() {
        return 0.0;
    }
    likeness(here, there, 1.0 / (PLANE * here.distance))
}

/// How far light is shared after so many looks, as a share of how far it is after one.
fn fewer(looks: u32) -> f32 {
    (looks.max(1) as f32).powf(-1.0 / 6.0)
}

/// Nearly exp(−x): 1 at 0, nothing from [`FAR`] on.
#[inline]
fn fall_off(x: f32) -> f32 {
    let base = (1.0 - x / FAR).max(0.0);
    let squared = base * base;
    let fourth = squared * squared;
    fourth * fourth
}
