//! Pictures over time: how near the mesh's picture, the gathered one and a path tracer's come to a
//! converged one, and when.
//!
//! The converged picture is that of the [reference](crate::measure::reference)'s paths, by many
//! samples a pixel, made twice by halves: how far these differ tells its noise. All pictures have
//! one camera, one exposure and one tone curve. [`PictureSweep::run`] makes a [`PictureChart`],
//! which is written as CSV and JSON and drawn as pictures.

mod draw;
mod flip;
mod write;

use std::sync::Arc;
use std::time::{Duration, Instant};

use glam::{DVec3, Vec2, Vec3};
use serde::Serialize;

pub use draw::{PictureDrawing, PictureMetric};
pub use flip::mean_flip;
pub use write::{picture_csv, picture_table};

use super::sweep::within;
use crate::base::cancel::CancelToken;
use crate::geometry::Occluders;
use crate::measure::accuracy::{Compared, LocalError};
use crate::measure::reference::{View, ViewPixel, ViewRun};
use crate::read::picture::{GatheredPicture, Lens, Shading, Start, ground};
use crate::read::tone::{auto_exposure, decode_gamma, encode_gamma, tone_curve};
use crate::scene::Scene;
use crate::solve::{Snapshot, Solver, SolverError, SolverParams};

/// Keep the paths of the reference's halves and those of the curve apart.
const SALTS: [u64; 3] = [0x0068_616c_6631, 0x0068_616c_6632, 0x0063_7572_7665];
/// Samples of a pixel that one pass of a reference adds.
const BATCH: u32 = 64;

/// Pictures that are drawn, and how well.
#[derive(Clone, Debug)]
pub struct PictureSweep {
    /// Parameters of every solve, the target error aside.
    pub params: SolverParams,
    /// Target errors, shares.
    pub errors: Vec<f64>,
    /// Width and height, pixels.
    pub size: [u32; 2],
    /// Samples a pixel of the reference, a power of two, at least 4.
    pub samples: u32,
    /// Time of one picture; the path tracer doubles its samples until it has taken as long.
    pub limit: Duration,
}

/// A kind of picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum PictureKind {
    /// Light interpolated between the mesh's vertices.
    Mesh,
    /// Light gathered at every pixel.
    Gathered,
    /// Light by so many paths from every pixel.
    Paths,
}

impl PictureKind {
    /// Every kind.
    pub const ALL: [Self; 3] = [Self::Mesh, Self::Gathered, Self::Paths];

    /// Name of the kind.
    pub fn name(self) -> &'static str {
        match self {
            Self::Mesh => "mesh",
            Self::Gathered => "gathered",
            Self::Paths => "path tracer",
        }
    }
}

/// One scene's pictures.
#[derive(Clone, Debug, Serialize)]
pub struct PictureChart {
    /// The scene's name.
    pub scene: String,
    /// Width and height, pixels.
    pub size: [u32; 2],
    /// Worker threads.
    pub threads: usize,
    /// Factor on radiosities before the tone curve, m²/W: the automatic exposure of the finest
    /// solve.
    pub exposure: f32,
    /// The converged picture.
    pub reference: PictureReference,
    /// The pictures, kind by kind, the quickest first.
    pub pictures: Vec<PictureRecord>,
    /// Pictures that were not made, and why, in sentences.
    pub skipped: Vec<String>,
}

/// The converged picture of a chart.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct PictureReference {
    /// Samples a pixel.
    pub samples: u32,
    /// Mean ꟻLIP between its two halves, each of which is √2 times as noisy as the whole.
    pub flip_of_halves: f64,
    /// 90th percentile over the pixels of the standard error of E over E + E₀, by the same halves.
    pub noise_p90: f64,
}

/// A picture.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct PictureRecord {
    /// Kind of the picture.
    pub kind: PictureKind,
    /// Target error, a share; none of the path tracer.
    pub error_asked: Option<f64>,
    /// Samples a pixel, of the path tracer alone.
    pub samples: Option<u32>,
    /// Seconds from the start of the solve, or of the path tracer, to the finished picture.
    pub seconds: f64,
    /// Seconds of the solve among them.
    pub solve_seconds: f64,
    /// Mean ꟻLIP against the converged picture.
    pub flip: f64,
    /// Local error of E over the pixels.
    pub local: LocalError,
}

/// Draws the mesh; what has no graphics adapter has none.
pub trait MeshPainter {
    /// The pixels as they are shown with an exposure, m²/W, rows from above.
    ///
    /// # Errors
    /// The adapter fails.
    fn shown(&mut self, snapshot: &Snapshot, exposure: f32) -> Result<Vec<[u8; 3]>, String>;

    /// Irradiance of each pixel, W/m², and the share that surfaces cover, which it is multiplied
    /// by.
    ///
    /// # Errors
    /// The adapter fails.
    fn irradiance(&mut self, snapshot: &Snapshot) -> Result<Vec<[f32; 4]>, String>;
}

/// Picture that all others are compared with.
struct Truth {
    pixels: Vec<ViewPixel>,
    shown: Vec<[u8; 3]>,
    size: [u32; 2],
}

impl PictureSweep {
    /// Makes all pictures on the current thread pool; `progress` hears what comes next. Cancelling
    /// leaves out the rest.
    ///
    /// # Errors
    /// A solve cannot be begun.
    pub fn run(
        &self,
        scene: &Arc<Scene>,
        occluders: &Arc<Occluders>,
        lens: &Lens,
        mut mesh: Option<&mut (dyn MeshPainter + Send)>,
        cancel: &CancelToken,
        mut progress: impl FnMut(&str),
    ) -> Result<PictureChart, SolverError> {
        let seed = self.params.seed;
        progress("converged picture");
        let [one, other] = [SALTS[0], SALTS[1]].map(|salt| {
            let mut half = ViewRun::new(scene, self.view(lens), seed ^ salt);
            while half.samples() < self.samples / 2 && half.pass(BATCH.min(self.samples / 2), cancel) {}
            half.pixels()
        });
        let mut errors = self.errors.clone();
        errors.sort_by(f64::total_cmp);
        let (mut exposure, mut truth) = (1.0, None);
        let (mut pictures, mut skipped) = (Vec::new(), Vec::new());
        for error in errors {
            if cancel.is_cancelled() {
                break;
            }
            progress(&format!("target error {} %", 100.0 * error));
            let begun = Instant::now();
            let params = SolverParams { error: Some(error), ..self.params };
            let mut solver = Solver::new(scene.clone(), occluders.clone(), params, 1)?;
            within(self.limit, cancel, |cancel| solver.run(cancel));
            let snapshot = solver.snapshot();
            let solve_seconds = begun.elapsed().as_secs_f64();
            // The finest solve comes first.
            let truth = truth.get_or_insert_with(|| {
                exposure = auto_exposure(&snapshot);
                Truth::new(mean(&one, &other), self.size, exposure)
            });
            let record = |kind, seconds, (flip, local)| PictureRecord {
                kind,
                error_asked: Some(error),
                samples: None,
                seconds,
                solve_seconds,
                flip,
                local,
            };
            let Some(field) = snapshot.field.clone().filter(|_| solver.stats().converged) else {
                skipped.push(format!(
                    "a target error of {} % was not reached within {} s",
                    100.0 * error,
                    self.limit.as_secs_f64()
                ));
                continue;
            };
            if let Some(painter) = &mut mesh {
                let begun = Instant::now();
                let drawn = painter.shown(&snapshot, exposure);
                let seconds = solve_seconds + begun.elapsed().as_secs_f64();
                match drawn.and_then(|shown| Ok((shown, painter.irradiance(&snapshot)?))) {
                    Ok((shown, found)) => {
                        let found = |index: usize| {
                            let [r, g, b, coverage] = found[index];
                            per_cover(Vec3::new(r, g, b), coverage)
                        };
                        pictures.push(record(PictureKind::Mesh, seconds, truth.compare(&shown, found)));
                    }
                    Err(why) => skipped.push(format!("a picture of the mesh could not be drawn ({why})")),
                }
            }
            let begun = Instant::now();
            let mut picture = GatheredPicture::new(field, *lens, self.size, error as f32, Start::Fine, false);
            let developed = within(self.limit, cancel, |cancel| {
                while !picture.is_done() && picture.advance(cancel).is_some() {}
                !cancel.is_cancelled()
            })
            .then(|| picture.develop(&Shading { exposure, read: None }))
            .flatten();
            let seconds = solve_seconds + begun.elapsed().as_secs_f64();
            match developed.zip(picture.layers()) {
                Some((shown, layers)) => {
                    let shown: Vec<[u8; 3]> = shown.into_iter().map(|[r, g, b, _]| [r, g, b]).collect();
                    let found =
                        |index: usize| per_cover(layers.pixels[index].irradiance, layers.pixels[index].coverage);
                    pictures.push(record(PictureKind::Gathered, seconds, truth.compare(&shown, found)));
                }
                None => skipped.push(format!(
                    "a gathered picture with a noise of {} % took longer than {} s",
                    100.0 * error,
                    self.limit.as_secs_f64()
                )),
            }
        }
        let truth = truth.unwrap_or_else(|| Truth::new(mean(&one, &other), self.size, exposure));
        progress("path tracer");
        pictures.extend(self.paths(scene, lens, (&truth, exposure), cancel));
        pictures.sort_by(|a, b| (a.kind as u8).cmp(&(b.kind as u8)).then(a.seconds.total_cmp(&b.seconds)));
        Ok(PictureChart {
            scene: scene.name.clone(),
            size: self.size,
            threads: rayon::current_num_threads(),
            exposure,
            reference: truth.noise(self.samples, &one, &other, exposure),
            pictures,
            skipped,
        })
    }

    fn view(&self, lens: &Lens) -> View<impl Fn([f32; 2]) -> Vec3 + Sync + use<>> {
        let lens = *lens;
        let direction = move |[x, y]: [f32; 2]| lens.direction(Vec2::new(2.0 * x - 1.0, 1.0 - 2.0 * y));
        // As wide as the distance between the samples of a gathered picture.
        let spacing = lens.right.length() / self.size[0] as f32;
        View { eye: lens.eye, direction, size: self.size, spacing }
    }

    /// The path tracer with 1, 2, 4, … samples a pixel, up to a quarter of the reference's.
    fn paths(
        &self,
        scene: &Scene,
        lens: &Lens,
        (truth, exposure): (&Truth, f32),
        cancel: &CancelToken,
    ) -> Vec<PictureRecord> {
        let mut records = Vec::new();
        let begun = Instant::now();
        let mut run = ViewRun::new(scene, self.view(lens), self.params.seed ^ SALTS[2]);
        // The clock stands while pictures are compared.
        let mut spent = begun.elapsed();
        while spent < self.limit && run.samples() < self.samples / 4 {
            let begun = Instant::now();
            if !run.pass(run.samples().max(1), cancel) {
                break;
            }
            let pixels = run.pixels();
            let shown = shown(&pixels, self.size, exposure);
            spent += begun.elapsed();
            let (flip, local) = truth.compare(&shown, |index| pixels[index].irradiance);
            records.push(PictureRecord {
                kind: PictureKind::Paths,
                error_asked: None,
                samples: Some(run.samples()),
                seconds: spent.as_secs_f64(),
                solve_seconds: 0.0,
                flip,
                local,
            });
        }
        records
    }
}

impl Truth {
    fn new(pixels: Vec<ViewPixel>, size: [u32; 2], exposure: f32) -> Self {
        Self { shown: shown(&pixels, size, exposure), pixels, size }
    }

    /// Mean ꟻLIP of a picture, and the local error of the irradiance that it finds at its pixels.
    fn compare(&self, shown: &[[u8; 3]], found: impl Fn(usize) -> DVec3) -> (f64, LocalError) {
        let compared = self.compared(|index, truth| (found(index) - truth, 0.0));
        (mean_flip(&self.shown, shown, self.size), LocalError::of(&compared))
    }

    fn noise(&self, samples: u32, one: &[ViewPixel], other: &[ViewPixel], exposure: f32) -> PictureReference {
        let [left, right] = [one, other].map(|half| shown(half, self.size, exposure));
        let off = |index: usize, _: DVec3| (0.5 * (one[index].irradiance - other[index].irradiance), 0.0);
        PictureReference {
            samples,
            flip_of_halves: mean_flip(&left, &right, self.size),
            noise_p90: LocalError::of(&self.compared(off)).p90,
        }
    }

    /// The pixels that see nothing but surfaces that are no lamps.
    fn compared(&self, off: impl Fn(usize, DVec3) -> (DVec3, f64)) -> Vec<Compared> {
        let seen = self.pixels.iter().enumerate().filter(|(_, pixel)| pixel.receiving == 1.0);
        let grey = |colour: DVec3| colour.element_sum() / 3.0;
        let compared = |(index, pixel): (usize, &ViewPixel)| {
            let (difference, noise) = off(index, pixel.irradiance);
            Compared { truth: grey(pixel.irradiance), difference: grey(difference), noise, weight: 1.0 }
        };
        seen.map(compared).collect()
    }
}

/// Light of what covers a pixel in part; none where nothing does.
fn per_cover(light: Vec3, coverage: f32) -> DVec3 {
    if coverage > 0.0 { (light / coverage).as_dvec3() } else { DVec3::ZERO }
}

/// The mean of two pictures of as many samples.
fn mean(one: &[ViewPixel], other: &[ViewPixel]) -> Vec<ViewPixel> {
    let pixel = |(a, b): (&ViewPixel, &ViewPixel)| ViewPixel {
        radiosity: 0.5 * (a.radiosity + b.radiosity),
        irradiance: (a.receiving * a.irradiance + b.receiving * b.irradiance) / (a.receiving + b.receiving).max(1e-9),
        coverage: 0.5 * (a.coverage + b.coverage),
        receiving: 0.5 * (a.receiving + b.receiving),
    };
    one.iter().zip(other).map(pixel).collect()
}

/// The pixels as `render` shows them: exposed, bent, over its ground, gamma-encoded.
fn shown(pixels: &[ViewPixel], [width, height]: [u32; 2], exposure: f32) -> Vec<[u8; 3]> {
    let colour = |(index, pixel): (usize, &ViewPixel)| {
        let covered = pixel.coverage as f32;
        let up = 1.0 - ((index as u32 / width) as f32 + 0.5) / height as f32;
        let behind = ground(up).map(decode_gamma);
        let lit = (exposure * pixel.radiosity.as_vec3() / covered.max(1e-9)).map(tone_curve);
        let linear = behind.lerp(lit, covered);
        linear.to_array().map(|channel| (255.0 * encode_gamma(channel)).round() as u8)
    };
    pixels.iter().enumerate().map(colour).collect()
}
