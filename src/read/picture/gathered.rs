//! A picture that becomes better, step by step.

use std::sync::Arc;

use glam::Vec3;
use rayon::prelude::*;

use super::develop::{develop, radiosity};
use super::filter::Share;
use super::light::{TILE, Tiles};
use super::{Filter, Lens, Light, LineLabel, Shading, VisibleSurface, VisibleSurfaces, labels};
use crate::base::cancel::CancelToken;
use crate::base::photometry::Quantity;
use crate::gather::{Field, grey};
use crate::hierarchy::ElementId;

/// A coarse picture looks from one pixel in so many, in each direction.
const COARSE: u32 = 3;
/// Samples in each direction of a pixel.
const FINE: u32 = 2;
/// Passes, at most.
const MOST_PASSES: u32 = 256;
/// Tiles are looked from again until this many times the root mean square of their noise is below
/// what was asked for: nine tenths of normal errors are below that.
const NINE_TENTHS: f32 = 1.645;
/// The noise of a picture is that below which this share of its samples lies.
const NOISE_SHARE: f32 = 0.9;

/// Where a picture starts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Start {
    /// With something to be seen soon.
    Coarse,
    /// With all samples at once.
    Fine,
}

/// Samples of a picture, and the light found at them.
struct Level {
    visible: Arc<VisibleSurfaces>,
    light: Light,
}

/// Stage of a picture.
enum Stage {
    Coarse,
    /// One sample a pixel.
    Pixels(Arc<VisibleSurfaces>),
    Samples,
    Refine(Level),
    Done,
}

/// The picture as it can be shown.
struct Shown {
    visible: Arc<VisibleSurfaces>,
    shares: Vec<Share>,
    /// For lines of equal value.
    smooth: Option<Vec<Share>>,
    noise: f32,
    /// Tiles that are still too noisy.
    noisy: Tiles,
}

/// Light and place at a pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PixelLight {
    /// The scene's polygon in its first sample that sees one.
    pub polygon: u32,
    /// Place on it.
    pub position: Vec3,
    /// Irradiance there, W/m².
    pub irradiance: Vec3,
}

/// A picture of a field; immutable but for [`GatheredPicture::advance`].
pub struct GatheredPicture {
    field: Arc<Field>,
    lens: Lens,
    size: [u32; 2],
    /// Noise that suffices, as a share of the local light.
    error: f32,
    has_lines: bool,
    stage: Stage,
    shown: Option<Shown>,
}

impl GatheredPicture {
    /// A picture of so many pixels, until nine tenths of its samples have less noise than `error`,
    /// as a share of the local light. Lines of equal value need light that is smoothed for them.
    pub fn new(field: Arc<Field>, lens: Lens, size: [u32; 2], error: f32, start: Start, has_lines: bool) -> Self {
        let stage = match start {
            Start::Coarse => Stage::Coarse,
            Start::Fine => Stage::Samples,
        };
        Self { field, lens, size, error, has_lines, stage, shown: None }
    }

    /// Does one more pass on the current thread pool; afterwards there is something new to be seen.
    /// `None` if cancelled: what is shown stays, but the picture gets no better.
    pub fn advance(&mut self, cancel: &CancelToken) -> Option<()> {
        let stage = std::mem::replace(&mut self.stage, Stage::Done);
        let look = |per_side| VisibleSurfaces::look(&self.field, &self.lens, self.size, per_side, cancel).map(Arc::new);
        self.stage = match stage {
            Stage::Coarse => {
                let visible = look(1)?;
                let coarse = Arc::new(visible.thinned(COARSE));
                let mut light = Light::new(&coarse);
                light.look(&self.field, &coarse, &Tiles::all(coarse.size), cancel)?;
                let shown = self.share(&coarse, &light, cancel)?;
                self.shown = Some(shown.spread_to(&visible, COARSE));
                Stage::Pixels(visible)
            }
            Stage::Pixels(visible) => {
                let mut light = Light::new(&visible);
                light.look(&self.field, &visible, &Tiles::all(self.size), cancel)?;
                self.shown = Some(self.share(&visible, &light, cancel)?);
                Stage::Samples
            }
            Stage::Samples => {
                let visible = look(FINE)?;
                let light = Light::new(&visible);
                self.refine(Level { visible, light }, cancel)?
            }
            Stage::Refine(level) => self.refine(level, cancel)?,
            Stage::Done => Stage::Done,
        };
        Some(())
    }

    fn refine(&mut self, mut level: Level, cancel: &CancelToken) -> Option<Stage> {
        // Light is shared anew when there is half as much again of it: the filter takes time as
        // well.
        let passes = (level.light.passes / 2).max(1);
        let all = Tiles::all(self.size);
        for _ in 0..passes {
            let noisy = match &self.shown {
                Some(shown) if level.light.passes >= FINE * FINE => &shown.noisy,
                _ => &all,
            };
            level.light.look(&self.field, &level.visible, noisy, cancel)?;
        }
        let shown = self.share(&level.visible, &level.light, cancel)?;
        let is_done = shown.noise <= self.error || level.light.passes >= MOST_PASSES;
        tracing::debug!(
            passes = level.light.passes,
            noise = shown.noise,
            asked = self.error,
            is_done,
            "picture pass ended"
        );
        self.shown = Some(shown);
        Some(if is_done { Stage::Done } else { Stage::Refine(level) })
    }

    fn share(&self, visible: &Arc<VisibleSurfaces>, light: &Light, cancel: &CancelToken) -> Option<Shown> {
        let shares = Filter::PICTURE.share(visible, light, cancel)?;
        let smooth = match self.has_lines {
            true => Some(Filter::LINES.share(visible, light, cancel)?),
            false => None,
        };
        let (noise, noisy) = self.noise_of(visible, &shares);
        Some(Shown { visible: visible.clone(), shares, smooth, noise, noisy })
    }

    /// Noise below which nine tenths of the samples lie, as a share of the local light, and where
    /// it is above what was asked for.
    fn noise_of(&self, visible: &VisibleSurfaces, shares: &[Share]) -> (f32, Tiles) {
        let dim = self.field.dim();
        let of = |(surface, share): (&VisibleSurface, &Share)| {
            let noise = share.noise.abs() / (grey(share.irradiance) + dim);
            (surface.reflectance != Vec3::ZERO && noise.is_finite()).then_some(noise)
        };
        let [width, height] = visible.size;
        let side = visible.per_side;
        let noisy = Tiles::chosen([width / side, height / side], |[x, y]| {
            let (mut count, mut squares) = (0.0, 0.0);
            for row in side * y..(side * (y + TILE)).min(height) {
                let range = (row * width + side * x) as usize..(row * width + (side * (x + TILE)).min(width)) as usize;
                for noise in visible.all[range.clone()].iter().zip(&shares[range]).filter_map(of) {
                    count += 1.0;
                    squares += noise * noise;
                }
            }
            NINE_TENTHS * NINE_TENTHS * squares > count * self.error * self.error
        });
        let mut noises: Vec<f32> = visible.all.par_iter().zip(shares).filter_map(of).collect();
        if noises.is_empty() {
            return (0.0, noisy);
        }
        let place = ((noises.len() - 1) as f32 * NOISE_SHARE) as usize;
        (*noises.select_nth_unstable_by(place, f32::total_cmp).1, noisy)
    }

    /// Whether nothing is left to do.
    pub fn is_done(&self) -> bool {
        matches!(self.stage, Stage::Done)
    }

    /// The noise that nine tenths of the samples stay below, as a share of the local light, once
    /// there is a picture.
    pub fn noise(&self) -> Option<f32> {
        self.shown.as_ref().map(|shown| shown.noise)
    }

    /// Width and height, pixels.
    pub fn size(&self) -> [u32; 2] {
        self.size
    }

    /// The pixels as they are shown, gamma-encoded, rows from above; `None` before the first pass
    /// has ended.
    pub fn develop(&self, shading: &Shading) -> Option<Vec<[u8; 4]>> {
        let shown = self.shown.as_ref()?;
        let smooth = shown.smooth.as_ref().unwrap_or(&shown.shares);
        Some(develop(&shown.visible, &shown.shares, smooth, shading))
    }

    /// Where the values of lines of equal value (W/m²) can be written along them; none before the
    /// first pass has ended.
    pub fn line_labels(&self, quantity: Quantity, lines: &[f32]) -> Vec<LineLabel> {
        let Some(shown) = self.shown.as_ref().filter(|_| !lines.is_empty()) else { return Vec::new() };
        labels::places(&shown.visible, shown.smooth.as_ref().unwrap_or(&shown.shares), quantity, lines)
    }

    /// Light and place at a pixel; `None` where nothing is seen.
    pub fn at(&self, [x, y]: [u32; 2]) -> Option<PixelLight> {
        let shown = self.shown.as_ref()?;
        let visible = &shown.visible;
        let side = visible.per_side;
        let inside = x < self.size[0] && y < self.size[1];
        let index = |k: u32| ((y * side + k / side) * visible.size[0] + x * side + k % side) as usize;
        let mut samples = (0..side * side).filter(|_| inside).map(index);
        samples.find_map(|index| {
            let surface = &visible.all[index];
            let irradiance = shown.shares[index].irradiance;
            Some(PixelLight { polygon: surface.polygon()?, position: surface.position, irradiance })
        })
    }

    /// The layers of a picture in physical units; `None` before the first pass has ended.
    pub fn layers(&self) -> Option<Layers> {
        let shown = self.shown.as_ref()?;
        let visible = &shown.visible;
        let side = visible.per_side as usize;
        let [width, height] = self.size.map(|side| side as usize);
        let share = 1.0 / (side * side) as f32;
        let pixel = |index: usize| {
            let (x, y) = (index % width, index / width);
            let mut pixel = LayersAt { depth: f32::INFINITY, ..LayersAt::default() };
            for k in 0..side * side {
                let sample = (y * side + k / side) * width * side + x * side + k % side;
                let (surface, irradiance) = (&visible.all[sample], shown.shares[sample].irradiance);
                let (Some(polygon), Some(radiosity)) = (surface.polygon(), radiosity(surface, irradiance)) else {
                    continue;
                };
                pixel.coverage += share;
                pixel.radiosity += share * radiosity;
                pixel.irradiance += share * irradiance;
                pixel.normal += share * surface.normal;
                pixel.albedo += share * surface.reflectance;
                let depth = self.lens.forward.dot(surface.position - self.lens.eye);
                if depth < pixel.depth {
                    (pixel.depth, pixel.element) = (depth, Some(self.field.leaf_at(polygon, surface.position)));
                }
            }
            pixel
        };
        Some(Layers { size: self.size, pixels: (0..width * height).into_par_iter().map(pixel).collect() })
    }
}

/// A picture in physical units, rows from above.
#[derive(Clone, Debug, PartialEq)]
pub struct Layers {
    /// Width and height, pixels.
    pub size: [u32; 2],
    /// Means over the samples of each pixel.
    pub pixels: Vec<LayersAt>,
}

/// Layers at a pixel; sums are multiplied by the coverage.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LayersAt {
    /// Radiosity B, W/m².
    pub radiosity: Vec3,
    /// Irradiance E, W/m².
    pub irradiance: Vec3,
    /// Normal of what is seen.
    pub normal: Vec3,
    /// Reflectance.
    pub albedo: Vec3,
    /// Share of the pixel that surfaces cover.
    pub coverage: f32,
    /// Distance of the nearest sample along the line of sight, in the scene's unit; infinite where
    /// nothing is seen.
    pub depth: f32,
    /// The leaf there.
    pub element: Option<ElementId>,
}

impl Shown {
    /// The light at the samples of a finer grid, of which this one holds one in so many in each
    /// direction: each takes the means of those around it that see its own surface, or else the
    /// nearest.
    fn spread_to(&self, visible: &Arc<VisibleSurfaces>, step: u32) -> Self {
        let from = &self.visible;
        let [width, height] = from.size.map(|side| side as i32);
        let spread = |shares: &[Share]| -> Vec<Share> {
            let at = |index: usize| {
                let here = &visible.all[index];
                let (x, y) = (index as u32 % visible.size[0], index as u32 / visible.size[0]);
                let middle = (step / 2) as f32;
                let [u, v] = [x, y].map(|place| (place as f32 - middle) / step as f32);
                let (mut sum, mut total, mut nearest) = (Share::default(), 0.0, (f32::INFINITY, Share::default()));
                for row in [v.floor() as i32, v.floor() as i32 + 1] {
                    for column in [u.floor() as i32, u.floor() as i32 + 1] {
                        let place = row.clamp(0, height - 1) * width + column.clamp(0, width - 1);
                        let (surface, share) = (&from.all[place as usize], shares[place as usize]);
                        if surface.polygon().is_none() {
                            continue;
                        }
                        let apart = surface.position.distance_squared(here.position);
                        if apart < nearest.0 {
                            nearest = (apart, share);
                        }
                        let tent = (1.0 - (u - column as f32).abs()) * (1.0 - (v - row as f32).abs());
                        let weight = tent.max(1e-3) * super::filter::likeness_of(here, surface);
                        sum.irradiance += weight * share.irradiance;
                        sum.noise += weight * share.noise;
                        total += weight;
                    }
                }
                match total > 0.0 {
                    true => Share { irradiance: sum.irradiance / total, noise: sum.noise / total },
                    false => nearest.1,
                }
            };
            (0..visible.all.len()).into_par_iter().map(at).collect()
        };
        let smooth = self.smooth.as_deref().map(spread);
        Self {
            visible: visible.clone(),
            shares: spread(&self.shares),
            smooth,
            noise: self.noise,
            noisy: self.noisy.clone(),
        }
    }
}
