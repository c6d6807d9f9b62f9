//! From irradiance at samples to the colours of pixels.

use glam::Vec3;
use rayon::prelude::*;

use super::filter::{Share, is_alike};
use super::{VisibleSurface, VisibleSurfaces};
use crate::base::photometry::{Quantity, weighted};
use crate::read::tone::{decode_gamma, encode_gamma, tone_curve};

/// Colours of the ground behind a scene, gamma-encoded: at the lower and at the upper rim.
const GROUND: [Vec3; 2] = [Vec3::new(0.15, 0.15, 0.16), Vec3::new(0.24, 0.25, 0.27)];
/// Half the width of a line of equal value, and of the shade beside it, pixels.
const LINE_HALF_WIDTH: f32 = 0.75;
const LINE_SHADE: f32 = 1.0;

/// How a picture shows light.
#[derive(Clone, Copy)]
pub struct Shading<'a> {
    /// Factor on radiosities before the tone curve, m²/W.
    pub exposure: f32,
    /// False colours of the surfaces, if there are any.
    pub read: Option<FalseColours<'a>>,
}

/// A quantity as false colours and lines of equal value.
#[derive(Clone, Copy)]
pub struct FalseColours<'a> {
    /// Which.
    pub quantity: Quantity,
    /// The gamma-encoded colour of a value (W/m², weighted as the eye does); without it surfaces
    /// stay lit.
    pub colour: Option<&'a (dyn Fn(f32) -> Vec3 + Sync)>,
    /// Values of lines, W/m², and their gamma-encoded colours.
    pub lines: &'a [(f32, Vec3)],
}

/// The colour behind a scene, gamma-encoded, from 0 at the lower to 1 at the upper rim.
pub fn ground(up: f32) -> Vec3 {
    GROUND[0].lerp(GROUND[1], up)
}

/// Radiosity of a sample, W/m²; `None` where nothing is seen.
pub(super) fn radiosity(surface: &VisibleSurface, irradiance: Vec3) -> Option<Vec3> {
    surface.polygon().map(|_| surface.emission + surface.reflectance * irradiance)
}

/// The pixels of a picture, gamma-encoded, rows from above; `smooth` are irradiances for lines.
pub(super) fn develop(
    visible: &VisibleSurfaces,
    shares: &[Share],
    smooth: &[Share],
    shading: &Shading,
) -> Vec<[u8; 4]> {
    let side = visible.per_side as usize;
    let [width, height] = visible.size.map(|samples| samples as usize / side);
    let mut pixels = vec![[0, 0, 0, 255]; width * height];
    let samples_in =
        |x: usize, y: usize| (0..side * side).map(move |k| (y * side + k / side) * width * side + x * side + k % side);
    pixels.par_chunks_exact_mut(width.max(1)).enumerate().for_each(|(y, row)| {
        let up = 1.0 - (y as f32 + 0.5) / height as f32;
        let ground = ground(up).map(decode_gamma);
        for (x, pixel) in row.iter_mut().enumerate() {
            let colour_of = |index: usize| {
                let surface = &visible.all[index];
                let Some(radiosity) = radiosity(surface, shares[index].irradiance) else {
                    // Of the sky, emission is all there is.
                    let is_sky = surface.emission != Vec3::ZERO;
                    return if is_sky { (shading.exposure * surface.emission).map(tone_curve) } else { ground };
                };
                let lit = (shading.exposure * radiosity).map(tone_curve);
                let Some(read) = &shading.read else { return lit };
                let value = |share: &Share| value(surface, share, read.quantity);
                let filled = read.colour.map(|colour| colour(value(&shares[index])));
                let base = filled.unwrap_or_else(|| lit.map(encode_gamma));
                let drawn = match read.lines {
                    [] => base,
                    // What a lamp receives is of no use to anybody.
                    _ if surface.emission != Vec3::ZERO => base,
                    lines => {
                        let value = value(&smooth[index]);
                        let slope = slope(visible, smooth, index, read.quantity) * side as f32;
                        with_lines(base, lines, (value, slope), filled.is_none())
                    }
                };
                drawn.map(decode_gamma)
            };
            // Samples are clamped by the tone curve before they are averaged, so that the rims of
            // lamps are smooth.
            let mean = samples_in(x, y).map(colour_of).sum::<Vec3>() / (side * side) as f32;
            let [r, g, b] = mean.to_array().map(|channel| (255.0 * encode_gamma(channel)).round() as u8);
            *pixel = [r, g, b, 255];
        }
    });
    pixels
}

/// Reading of a sample, W/m².
pub(super) fn value(surface: &VisibleSurface, share: &Share, quantity: Quantity) -> f32 {
    match quantity {
        Quantity::Irradiance => weighted(share.irradiance.into()),
        Quantity::Radiosity => weighted(radiosity(surface, share.irradiance).unwrap_or_default().into()),
    }
}

/// How fast a value changes from one sample to the next.
fn slope(visible: &VisibleSurfaces, shares: &[Share], index: usize, quantity: Quantity) -> f32 {
    let [width, height] = visible.size.map(|side| side as usize);
    let (x, y) = (index % width, index / width);
    let here = &visible.all[index];
    let at = |index: usize| value(&visible.all[index], &shares[index], quantity);
    let beside = |before: Option<usize>, after: Option<usize>| {
        let like = |other: &usize| is_alike(here, &visible.all[*other]);
        match (before.filter(like), after.filter(like)) {
            (Some(before), Some(after)) => 0.5 * (at(after) - at(before)),
            (Some(other), None) | (None, Some(other)) => at(other) - at(index),
            (None, None) => 0.0,
        }
    };
    let across = beside((x > 0).then(|| index - 1), (x + 1 < width).then_some(index + 1));
    let along = beside((y > 0).then(|| index - width), (y + 1 < height).then_some(index + width));
    across.hypot(along)
}

/// A colour with the lines that pass it; what shines through is shaded beside them.
fn with_lines(mut colour: Vec3, lines: &[(f32, Vec3)], (value, slope): (f32, f32), shaded: bool) -> Vec3 {
    for &(at, line) in lines {
        if slope <= 1e-6 * at {
            // A plain has no lines, even at their height.
            continue;
        }
        let distance = (value - at).abs() / slope;
        if shaded {
            let shade = (LINE_HALF_WIDTH + LINE_SHADE + 0.5 - distance).clamp(0.0, 1.0);
            colour *= 1.0 - 0.5 * shade;
        }
        colour = colour.lerp(line, (LINE_HALF_WIDTH + 0.5 - distance).clamp(0.0, 1.0));
    }
    colour
}
