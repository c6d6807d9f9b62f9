//! Where leaves must be split: random points tell how well direct light is interpolated between the vertices.

use glam::Vec3;
use rayon::prelude::*;

use super::lamps::{Lamps, Seen};
use super::{Context, FinalGather};
use crate::cancel::CancelToken;
use crate::exposure::Darkness;
use crate::hierarchy::{ElementId, Hierarchy};
use crate::random::{even_point, mix};

/// Random points per leaf: on average and at most. Large bright leaves get more.
const POINTS: f64 = 1.5;
const MOST_POINTS: f64 = 32.0;
/// A leaf is not looked at where all its light would be less than this share of its part of the allowed error.
const NEGLIGIBLE: f64 = 0.05;
/// Leaves whose errors add up to this share of what is allowed are kept as they are; those that are split keep a part of theirs.
const KEPT: f64 = 0.7;
/// Leaves are not split where their width is below this share of the scene's diagonal: 5 mm in a room.
const THINNEST: f32 = 5e-4;
/// Rays that must meet backs before a point is believed to be hidden.
const DARK_RAYS: u32 = 16;
/// Share of (ρ·ΔE)² in the middle of a leaf that is its error, since the middle is a vertex itself.
const INDIRECT: f64 = 0.15;

/// What became of a look at the mesh.
pub struct Look {
    /// Squared error of each leaf, A·(ρ·ΔE)², W²/m²; the mesh's leaves in order.
    pub errors: Vec<f64>,
    /// Rays cast.
    pub rays: u64,
}

impl FinalGather {
    /// Squared errors of all leaves; those that were kept before are not looked at again. `None` if cancelled.
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
        let look = |cut: &mut Vec<Seen>, leaf: usize| {
            if cancel.is_cancelled() {
                return None;
            }
            let of = &leaves[leaf];
            if let Some(error) = self.kept.get(&of.element) {
                return Some((*error, 0));
            }
            if energies[leaf] <= negligible
                || self.is_thin(leaf)
                || context.surfaces[of.polygon as usize].emission != Vec3::ZERO
            {
                return Some((0.0, 0));
            }
            let count = (POINTS * energies[leaf] / mean).round().clamp(1.0, MOST_POINTS) as u32;
            let reflectance = context.surfaces[of.polygon as usize].reflectance;
            let key = hierarchy.element(of.element).key;
            let start = mix(mix(context.seed, 0x0073_706c_6974), key);
            let (mut sum, mut rays, mut found) = (0.0, 0, 0);
            for index in 0..count {
                let [u, v] = even_point(start, index);
                let point = hierarchy.point_on(of.element, u, v);
                let seed = mix(mix(key, context.seed), u64::from(index));
                let Some(shown) = self.direct_shown(hierarchy, of.element, point.position) else { continue };
                // Two looks that know nothing of each other: the product of their differences is right in the mean, whatever
                // their noise.
                let [first, second] = [1, 2].map(|look| {
                    let lit = lamps.irradiance(
                        point.position,
                        point.normal,
                        0.5 * self.lamp_rays(),
                        f32::INFINITY,
                        mix(seed, look),
                        cut,
                    );
                    rays += u64::from(lit.rays);
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
                sum += f64::from((reflectance * (first - shown)).dot(reflectance * (second - shown)));
                found += 1;
            }
            let mean = if found > 0 { sum / f64::from(found) } else { 0.0 };
            Some((f64::from(of.exposed_area) * mean + self.indirect_error(leaf), rays))
        };
        let looked: Vec<(f64, u64)> =
            (0..leaves.len()).into_par_iter().with_min_len(16).map_init(Vec::new, look).collect::<Option<_>>()?;
        Some(Look {
            errors: looked.iter().map(|looked| looked.0).collect(),
            rays: looked.iter().map(|looked| looked.1).sum(),
        })
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

    /// Whether a leaf is too thin to be split.
    fn is_thin(&self, leaf: usize) -> bool {
        let mesh = &self.display.mesh;
        let corners = self.display.triangles_of(leaf as u32).flat_map(|triangle| mesh.triangles[triangle as usize]);
        let corners: Vec<Vec3> = corners.map(|corner| Vec3::from(mesh.positions[corner as usize])).collect();
        let longest = corners.iter().map(|corner| corner.distance(corners[0])).fold(0.0, f32::max);
        mesh.leaves[leaf].area < THINNEST * self.diagonal * longest
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

    /// Direct irradiance as the vertices around show it at a point of a leaf.
    fn direct_shown(&self, hierarchy: &Hierarchy, leaf: ElementId, point: Vec3) -> Option<Vec3> {
        let (triangle, weights) = self.display.locate(hierarchy, leaf, point)?;
        let [a, b, c] = self.display.mesh.triangles[triangle as usize].map(|vertex| self.direct[vertex as usize]);
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
