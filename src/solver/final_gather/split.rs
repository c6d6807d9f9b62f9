//! Where leaves must be split: random points tell how well direct light is interpolated between the vertices.

use glam::Vec3;
use rayon::prelude::*;

use super::lamps::{Lamps, Seen};
use super::{Context, FinalGather};
use crate::cancel::CancelToken;
use crate::exposure::Darkness;
use crate::hierarchy::{ElementId, Hierarchy};
use crate::random::{even_point, mix};
use crate::solver::Leaf;

/// Random points per leaf: on average and at most. Large bright leaves get more.
const POINTS: f64 = 1.5;
const MOST_POINTS: f64 = 32.0;
/// A leaf is not looked at where all its light would be less than this share of its part of the allowed error.
const NEGLIGIBLE: f64 = 0.05;
/// Leaves whose errors add up to this share of what is allowed are kept as they are; those that are split keep a part of theirs.
const KEPT: f64 = 0.7;
/// Leaves are not split where their width is below this share of the scene's diagonal: 5 mm in a room. What is so many times brighter than
/// the RMS may be so many times thinner, for the edge of a shadow there holds as much more of the error, down to the second share.
const THINNEST: [f32; 2] = [5e-4, 2e-5];
/// Points of a leaf that by the range of light over its vertices is likely to hold so much error that it must be split, times how much more:
/// one or two points often miss the edge of a shadow, and the leaf would be kept.
const DOUBTFUL_POINTS: f64 = 4.0;
const MOST_DOUBTFUL_POINTS: f64 = 16.0;
/// Rays that must meet backs before a point is believed to be hidden.
const DARK_RAYS: u32 = 16;
/// Share of (ρ·ΔE)² in the middle of a leaf that is its error, since the middle is a vertex itself.
const INDIRECT: f64 = 0.15;

/// What became of a look at the mesh.
pub struct Look {
    /// Of each leaf, in the mesh's order.
    pub leaves: Vec<Looked>,
    /// Squared error as a share of the squared range of light over a leaf, in the mean.
    pub share: f64,
}

/// What random points of a leaf told.
#[derive(Clone, Copy, Debug, Default)]
pub struct Looked {
    /// Squared error A·(ρ·ΔE)², W²/m².
    pub error: f64,
    /// What the points told of direct light.
    pub points: Points,
    /// Squared range of ρE over the leaf's vertices, (W/m²)².
    range: f64,
    /// Rays cast.
    pub rays: u64,
}

/// Random points of a leaf; those that follow come from the same sequence.
#[derive(Clone, Copy, Debug, Default)]
pub struct Points {
    /// Points tried, and those among them that light can reach.
    tried: u32,
    found: u32,
    /// Σ of (ρ·ΔE)² over these, (W/m²)².
    sum: f64,
}

impl Points {
    /// Mean of (ρ·ΔE)², (W/m²)².
    fn mean(&self) -> f64 {
        if self.found > 0 { self.sum / f64::from(self.found) } else { 0.0 }
    }
}

impl FinalGather {
    /// Squared errors of all leaves; what was found of those that were kept counts on. `None` if cancelled.
    pub(super) fn look_at_leaves(
        &self,
        hierarchy: &Hierarchy,
        context: &Context,
        cancel: &CancelToken,
    ) -> Option<Look> {
        let leaves = &self.display.mesh.leaves;
        let energies: Vec<f64> =
            (0..leaves.len()).into_par_iter().with_min_len(512).map(|leaf| self.most(leaf)).collect();
        let mean = energies.iter().sum::<f64>() / leaves.len().max(1) as f64;
        let darkness = self.darkness(context);
        let lamps = self.lamps(hierarchy, context);
        let negligible = NEGLIGIBLE * self.goal.mesh * self.goal.mesh * mean;
        let square = self.mean_square();
        let mut shown = self.direct.clone();
        self.fill_hidden(&mut shown);
        let look = |cut: &mut Vec<Seen>, leaf: usize| {
            if cancel.is_cancelled() {
                return None;
            }
            let of = &leaves[leaf];
            if energies[leaf] <= negligible
                || self.is_thin(leaf, energies[leaf], square)
                || context.surfaces[of.polygon as usize].emission != Vec3::ZERO
            {
                return Some(Looked::default());
            }
            let reflectance = context.surfaces[of.polygon as usize].reflectance;
            let range = self.range(leaf, reflectance, &shown);
            let points = self.kept.get(&of.element).copied().unwrap_or_default();
            let mut looked = Looked { points, range, ..Looked::default() };
            let key = hierarchy.element(of.element).key;
            let start = mix(mix(context.seed, 0x0073_706c_6974), key);
            for index in points.tried..self.points_wanted(of, energies[leaf] / mean, range) {
                looked.points.tried += 1;
                let [u, v] = even_point(start, index);
                let point = hierarchy.point_on(of.element, u, v);
                let seed = mix(mix(key, context.seed), u64::from(index));
                let Some(shown) = self.shown_at(hierarchy, of.element, point.position, &shown) else { continue };
                // Two looks that know nothing of each other: the product of their differences is right in the mean, whatever
                // their noise.
                let [first, second] = [1, 2].map(|look| {
                    let rays = 0.5 * self.lamp_rays();
                    let lit = lamps.irradiance(point.position, point.normal, rays, f32::INFINITY, mix(seed, look), cut);
                    looked.rays += u64::from(lit.rays);
                    lit.irradiance
                });
                let is_hidden = || {
                    darkness
                        .as_ref()
                        .is_some_and(|darkness| darkness.encloses(point.position, point.normal, seed, DARK_RAYS))
                };
                if first == Vec3::ZERO && second == Vec3::ZERO && is_hidden() {
                    continue;
                }
                looked.points.sum += f64::from((reflectance * (first - shown)).dot(reflectance * (second - shown)));
                looked.points.found += 1;
            }
            looked.error = f64::from(of.exposed_area) * looked.points.mean() + self.indirect_error(leaf);
            Some(looked)
        };
        let looked: Vec<Looked> =
            (0..leaves.len()).into_par_iter().with_min_len(16).map_init(Vec::new, look).collect::<Option<_>>()?;
        let (mut found, mut all) = (0.0, 0.0);
        for (leaf, looked) in leaves.iter().zip(&looked).filter(|(_, looked)| looked.points.found > 0) {
            found += f64::from(leaf.exposed_area) * looked.points.mean();
            all += f64::from(leaf.exposed_area) * looked.range;
        }
        let share = if all > 0.0 { (found / all).clamp(0.0, 1.0) } else { 0.0 };
        Some(Look { leaves: looked, share })
    }

    /// Points at which a leaf should be looked: by its share of the mean energy, and by the error that is expected of such a range of
    /// light over it.
    fn points_wanted(&self, leaf: &Leaf, energy: f64, range: f64) -> u32 {
        let (threshold, share) = self.expected;
        let doubtful = DOUBTFUL_POINTS * f64::from(leaf.exposed_area) * share * range / threshold;
        (POINTS * energy).clamp(1.0, MOST_POINTS).max(doubtful.min(MOST_DOUBTFUL_POINTS)).round() as u32
    }

    /// Squared range of ρE over the vertices of a leaf, (W/m²)².
    fn range(&self, leaf: usize, reflectance: Vec3, irradiance: &[Vec3]) -> f64 {
        let mesh = &self.display.mesh;
        let vertices = self.display.triangles_of(leaf as u32).flat_map(|triangle| mesh.triangles[triangle as usize]);
        let (mut low, mut high) = (Vec3::INFINITY, Vec3::NEG_INFINITY);
        for vertex in vertices {
            low = low.min(irradiance[vertex as usize]);
            high = high.max(irradiance[vertex as usize]);
        }
        f64::from((reflectance * (high - low)).length_squared())
    }

    /// A·(ρ·ΔE)² of indirect light, by what rows found in the middle of a leaf and at its corners; their noise is subtracted.
    fn indirect_error(&self, leaf: usize) -> f64 {
        let (mesh, display) = (&self.display.mesh, &self.display);
        let Some(middle) = display.centre_of(leaf as u32).map(|middle| middle as usize) else { return 0.0 };
        if !self.noise.is_finite() {
            return 0.0;
        }
        let rim = display.triangles_of(leaf as u32).map(|triangle| mesh.triangles[triangle as usize][1] as usize);
        let (mut sum, mut noise, mut count) = (Vec3::ZERO, 0.0, 0.0);
        let square_of_noise = |vertex: usize| {
            self.spread * self.indirect[vertex].length_squared() / self.rows.rays_of(vertex).max(1) as f32
        };
        for vertex in rim {
            sum += self.indirect[vertex];
            noise += square_of_noise(vertex);
            count += 1.0;
        }
        let difference = (self.indirect[middle] - sum / count).length_squared();
        let square = difference - square_of_noise(middle) - noise / (count * count);
        let reflectance = self.vertices[middle].reflectance.max_element();
        INDIRECT * f64::from(mesh.leaves[leaf].exposed_area * reflectance * reflectance * square)
    }

    /// Whether a leaf of this energy is too thin to be split; `square` is the mean of |ρE|² over all the area, (W/m²)².
    fn is_thin(&self, leaf: usize, energy: f64, square: f64) -> bool {
        let mesh = &self.display.mesh;
        let corners = self.display.triangles_of(leaf as u32).flat_map(|triangle| mesh.triangles[triangle as usize]);
        let corners: Vec<Vec3> = corners.map(|corner| Vec3::from(mesh.positions[corner as usize])).collect();
        let longest = corners.iter().map(|corner| corner.distance(corners[0])).fold(0.0, f32::max);
        let brightness = (energy / (f64::from(mesh.leaves[leaf].exposed_area) * square)).sqrt() as f32;
        let thinnest = (THINNEST[0] / brightness.max(1.0)).max(THINNEST[1]);
        mesh.leaves[leaf].area < thinnest * self.diagonal * longest
    }

    /// Mean of |ρE|² over the area, (W/m²)².
    fn mean_square(&self) -> f64 {
        let area: f64 = self.vertices.iter().map(|vertex| f64::from(vertex.area)).sum();
        self.energy() / area.max(f64::MIN_POSITIVE)
    }

    /// A·|ρE|² of a leaf if all of it were as bright as its brightest vertex.
    fn most(&self, leaf: usize) -> f64 {
        let mesh = &self.display.mesh;
        let vertices = self.display.triangles_of(leaf as u32).flat_map(|triangle| mesh.triangles[triangle as usize]);
        let brightness = vertices.map(|vertex| {
            (self.vertices[vertex as usize].reflectance * self.irradiance(vertex as usize)).length_squared()
        });
        f64::from(mesh.leaves[leaf].exposed_area * brightness.fold(0.0, f32::max))
    }

    /// What the vertices around, which have these values, show at a point of a leaf.
    fn shown_at(&self, hierarchy: &Hierarchy, leaf: ElementId, point: Vec3, values: &[Vec3]) -> Option<Vec3> {
        let (triangle, weights) = self.display.locate(hierarchy, leaf, point)?;
        let [a, b, c] = self.display.mesh.triangles[triangle as usize].map(|vertex| values[vertex as usize]);
        Some(weights.x * a + weights.y * b + weights.z * c)
    }

    pub(super) fn lamps<'a>(&'a self, hierarchy: &'a Hierarchy, context: &'a Context) -> Lamps<'a> {
        Lamps { hierarchy, sent: &self.sent, occluders: context.occluders }
    }

    /// Tells hidden points; where both sides of faces are bright there are no backs, and nothing is hidden.
    pub(super) fn darkness<'a>(&self, context: &'a Context) -> Option<Darkness<'a>> {
        let lamps = || self.lamp_list.clone();
        self.back_of.is_empty().then(|| Darkness::with_lamps(context.scene, context.occluders, lamps()))
    }
}

/// The error above which leaves must be split for the others to add up to no more than allowed.
pub fn threshold(errors: &[f64], allowed: f64) -> f64 {
    let mut sorted = errors.to_vec();
    sorted.sort_by(f64::total_cmp);
    let mut sum = 0.0;
    let kept = sorted.iter().take_while(|error| {
        sum += **error;
        sum <= KEPT * allowed
    });
    let kept = kept.count();
    sorted.get(kept).copied().unwrap_or(f64::INFINITY)
}
