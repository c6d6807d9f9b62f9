//! Local errors: how wrong, relative to what little light there is, leaves make what they light.
//!
//! An RMS has no place for a room that is lit through a slit alone, a thousand times darker than the one beside it; yet it is lit by the few
//! leaves at the slit, and a bright corner of one of them counts for a third of it. What leaves say by their middles alone differs
//! there from what they say by their corners, and rows tell whom that concerns [after Smits, Arvo, Salesin, *An importance-driven
//! radiosity algorithm*, SIGGRAPH 1992].

use glam::Vec3;

use super::split::threshold;
use super::{FinalGather, USUAL_ERROR};

/// Light below this share of the RMS radiosity counts as that much: relative to nothing, all is wrong.
const DARKEST: f32 = 1e-4;
/// The part of the area whose errors are at most the local error: the rest is crevices, of which there are always some.
const QUANTILE: f64 = 0.75;
/// Local errors may be so many times the error that is asked for.
const ALLOWED: f64 = 1.2;
/// Variance along a ray of a vertex, as a multiple of the square of all its light, above which it gets rays for its own sake: next to all
/// its light comes out of one corner.
const SPIKY: f32 = 2.5;

/// What doubtful leaves do to the light of all vertices that see them.
#[derive(Clone, Debug, Default)]
pub struct Local {
    /// Relative error that comes from elsewhere: three quarters of the area have less.
    pub error: f64,
    /// What each leaf of the mesh adds to the mean square of such errors, each at most 1.
    parts: Vec<f64>,
}

impl FinalGather {
    /// Leaves of the present mesh that are to be split for what they do to others, in order; once for each attempt.
    pub(super) fn doubtful_leaves(&mut self) -> Vec<usize> {
        let Some(local) = self.local.take() else { return Vec::new() };
        let threshold = threshold(&local.parts, self.local_allowed().powi(2));
        let is_doubtful = |leaf: &usize| local.parts[*leaf] >= threshold && !self.is_thin(*leaf);
        (0..local.parts.len()).filter(is_doubtful).collect()
    }

    /// The local error that is allowed. It is no stricter than with the usual goal: crevices would take all the work.
    pub(super) fn local_allowed(&self) -> f64 {
        ALLOWED * self.goal.error.max(USUAL_ERROR)
    }

    /// Rays that a vertex lacks for its own light to be no noisier than was asked for, whatever it weighs; none where light comes
    /// from everywhere.
    pub(super) fn local_rays(&self, vertex: usize, reflected: &[Vec3]) -> f32 {
        let rays = self.rows.rays_of(vertex) as f32;
        let light = self.irradiance(vertex).element_sum();
        if rays < 2.0 || light <= 0.0 || self.vertices[vertex].emission != Vec3::ZERO {
            return 0.0;
        }
        let variance = self.rows.variance(vertex, &self.display, reflected) / (light * light);
        if variance > SPIKY { variance / self.goal.error.max(USUAL_ERROR).powi(2) as f32 - rays } else { 0.0 }
    }

    /// Finds local errors, as far as rows tell.
    pub(super) fn local(&self) -> Local {
        let mesh = &self.display.mesh;
        let reflected = self.reflected();
        let doubt = |leaf: usize| self.doubt(leaf, &reflected);
        let doubts: Vec<f32> = (0..mesh.leaves.len()).map(doubt).collect();
        let area: f64 = self.vertices.iter().map(|of| f64::from(of.area)).sum();
        let darkest = DARKEST * (self.energy() / area).sqrt() as f32;
        let mut errors: Vec<(f32, f64)> = Vec::new();
        let mut local = Local { error: 0.0, parts: vec![0.0; doubts.len()] };
        for (vertex, of) in self.vertices.iter().enumerate() {
            if of.emission != Vec3::ZERO || self.is_hidden(vertex) {
                continue;
            }
            let leaves = || self.rows.seen_by(vertex).map(|triangle| mesh.triangle_leaf[triangle as usize] as usize);
            let of_one = 1.0 / (self.rows.rays_of(vertex) as f32 * self.irradiance(vertex).element_sum().max(darkest));
            let relative = (of_one * leaves().map(|leaf| doubts[leaf]).sum::<f32>()).abs().min(1.0);
            let weight = f64::from(of.area) / area;
            errors.push((relative, weight));
            for leaf in leaves() {
                local.parts[leaf] += weight * f64::from(relative * of_one * doubts[leaf].abs());
            }
        }
        errors.sort_by(|one, other| one.0.total_cmp(&other.0));
        let all: f64 = errors.iter().map(|error| error.1).sum();
        let mut below = 0.0;
        let is_within = |error: &&(f32, f64)| {
            below += error.1;
            below <= QUANTILE * all
        };
        local.error = errors.iter().take_while(is_within).last().map_or(0.0, |error| f64::from(error.0));
        local
    }

    /// What a leaf sends beyond what it may send, in W/m² of all colours: by its corners beyond its middle; and where it has no vertex
    /// there, by straight lines between its vertices beyond curves along which light falls by the same share with each step.
    fn doubt(&self, leaf: usize, reflected: &[Vec3]) -> f32 {
        let (mesh, display) = (&self.display.mesh, &self.display);
        let of = |vertex: u32| reflected[vertex as usize].element_sum();
        let triangles = display.triangles_of(leaf as u32).map(|triangle| mesh.triangles[triangle as usize]);
        if let Some(middle) = display.centre_of(leaf as u32) {
            let count = triangles.len() as f32;
            return 2.0 / 3.0 * (triangles.map(|[_, corner, _]| of(corner)).sum::<f32>() / count - of(middle));
        }
        let range = |(least, most): (f32, f32), vertex: u32| (least.min(of(vertex)), most.max(of(vertex)));
        let (least, most) = triangles.flatten().fold((f32::INFINITY, 0.0), range);
        let ratio = most / least.max(f32::MIN_POSITIVE);
        // Where the two are alike, their mean is as good and rounding worse.
        if ratio < 1.01 { 0.0 } else { 0.5 * (most + least) - (most - least) / ratio.ln() }
    }
}
