//! Passes of rays over all vertices: how many, what light they bring, and how noisy it is.

use glam::Vec3;
use rayon::prelude::*;

use super::rows::Rows;
use super::vertices::Vertex;
use super::{Context, FinalGather, SPREAD, Stage};
use crate::cancel::CancelToken;
use crate::solver::memory::MemoryStop;

/// Rays of a vertex in a pass, at least and at most.
const PASS_RAYS: [f32; 2] = [24.0, 1024.0];
/// Sweeps end when they move less than this share of the light.
const TOLERANCE: f64 = 2e-3;
/// Sweeps at most.
const MOST_SWEEPS: u32 = 50;

impl FinalGather {
    /// Rays go where they decide about most light: the variance of the mean over the area is least where each vertex has rays
    /// in proportion to √A·ρE. Their number is what the goal asks for, by what was measured or, before that, by [`SPREAD`].
    pub(super) fn open_pass(&mut self, context: &Context) {
        let weight = |(vertex, of): (usize, &Vertex)| match of.emission == Vec3::ZERO {
            true => of.area.sqrt() * (of.reflectance * self.irradiance(vertex)).max_element().max(0.0),
            false => 0.0,
        };
        let weights: Vec<f32> = self.vertices.iter().enumerate().map(weight).collect();
        let sum = weights.iter().map(|weight| f64::from(*weight)).sum::<f64>();
        // Rays of all vertices together that bring the noise to the goal.
        let cast = self.rows.rays() as f64;
        let wanted = if self.noise.is_finite() {
            (cast * ((self.noise / self.goal.noise).powi(2) - 1.0)).clamp(0.0, 4.0 * cast)
        } else {
            // Two passes are needed to tell the noise.
            0.5 * (SPREAD / self.goal.noise).powi(2) * sum * sum / self.energy().max(f64::MIN_POSITIVE)
        };
        let [least, most] = PASS_RAYS;
        // Whatever fits, every vertex has a few.
        let room =
            Rows::room_in(context.memory.saturating_sub(self.bytes()), self.vertices.len(), least as usize) as f64;
        if wanted > room {
            self.memory_stop.get_or_insert(MemoryStop::Rays);
        }
        let wanted = wanted.min(room);
        let reflected = self.reflected();
        let rays = |vertex: usize| {
            let share = if sum > 0.0 { f64::from(weights[vertex]) / sum } else { 0.0 };
            let local = if wanted < room { self.local_rays(vertex, &reflected) } else { 0.0 };
            ((wanted * share) as f32).max(local).clamp(least, most).ceil() as u32
        };
        self.rows.open(&(0..weights.len()).into_par_iter().map(rays).collect::<Vec<u32>>());
        self.stage = Stage::Cast(0);
    }

    /// Gathers over the rows after a pass, and tells the noise by how the passes differ; `None` if cancelled, which leaves all as it was.
    pub(super) fn end_pass(&mut self, cancel: &CancelToken) -> Option<()> {
        let before = self.indirect.clone();
        let ended = self.converge(cancel).and_then(|()| {
            if self.rows.passes() >= 2 {
                (self.noise, self.spread) = self.measure_noise(cancel)?;
            }
            Some(())
        });
        if ended.is_none() {
            self.indirect = before;
        }
        ended
    }

    /// Gathers over the rows until nothing moves; `None` if cancelled.
    fn converge(&mut self, cancel: &CancelToken) -> Option<()> {
        for _ in 0..MOST_SWEEPS {
            let new = self.rows.gather(&self.display, &self.reflected(), cancel)?;
            let (mut moved, mut all) = (0.0, 0.0);
            for ((vertex, new), old) in self.vertices.iter().zip(&new).zip(&self.indirect) {
                moved += f64::from(vertex.area * (*new - *old).abs().max_element());
                all += f64::from(vertex.area * new.max_element());
            }
            self.indirect = new;
            if moved <= TOLERANCE * all {
                break;
            }
        }
        Some(())
    }

    /// Noise of the vertices' values as a share of the RMS radiosity, by how the passes differ; and the variance of one ray's light
    /// as a share of its square. `None` if cancelled.
    fn measure_noise(&self, cancel: &CancelToken) -> Option<(f64, f32)> {
        let passes = self.rows.passes();
        let reflected = self.reflected();
        let mean = self.rows.gather(&self.display, &reflected, cancel)?;
        let (mut squares, mut of_ray) = (0.0, 0.0);
        for pass in 0..passes {
            let one = self.rows.gather_pass(pass, &self.display, &reflected, cancel)?;
            let weight = self.rows.share_of(pass) / (passes as f64 - 1.0);
            for ((vertex, of), (one, mean)) in self.vertices.iter().enumerate().zip(one.iter().zip(&mean)) {
                if of.emission == Vec3::ZERO && !self.is_hidden(vertex) {
                    let square = weight * f64::from(of.area * (of.reflectance * (*one - *mean)).length_squared());
                    squares += square;
                    of_ray += square * f64::from(self.rows.rays_of(vertex));
                }
            }
        }
        let energy = self.energy().max(f64::MIN_POSITIVE);
        let indirect =
            |(of, indirect): (&Vertex, &Vec3)| f64::from(of.area * (of.reflectance * *indirect).length_squared());
        let indirect: f64 = self.vertices.iter().zip(&self.indirect).map(indirect).sum();
        Some(((squares / energy).sqrt(), (of_ray / indirect.max(f64::MIN_POSITIVE)) as f32))
    }
}
