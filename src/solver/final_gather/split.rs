//! Where leaves must be split: random points tell how well direct light is interpolated between the vertices.

use glam::Vec3;
use rayon::prelude::*;

use super::lamps::{Lamps, Seen};
use super::places::Places;
use super::{Context, FinalGather};
use crate::cancel::CancelToken;
use crate::geometry::EnclosureTest;
use crate::hierarchy::{ElementId, Hierarchy};
use crate::random::mix;

/// Points of a look per leaf, and how many they are at least and at most.
const POINTS: f64 = 0.75;
const LEAST_POINTS: usize = 512;
const MOST_POINTS: usize = 32_768;
/// Light at random points of a leaf is expected to differ from what the leaf shows by this share of it, beside a share of what
/// differs between its vertices: a shadow may lie in the midst of a leaf.
const UNSEEN: f32 = 0.4;
/// Leaves whose errors add up to this share of what is allowed are kept as they are; those that are split keep a part of theirs.
const KEPT: f64 = 0.5;
/// Leaves are not split where their width is below this share of the scene's diagonal: 1 mm in a room.
const THINNEST: f32 = 1e-4;
/// Rays that must meet backs before a point is believed to be hidden.
const DARK_RAYS: u32 = 16;
/// Share of (ρ·ΔE)² in the middle of a leaf that is its error, since the middle is a vertex itself.
const INDIRECT: f64 = 0.15;

/// What became of a look at the mesh.
pub struct Look {
    /// Squared error of direct light of each leaf, A·(ρ·ΔE)², W²/m²; the mesh's leaves in order. Right in the mean only: leaves that
    /// no point met have none.
    pub direct: Vec<f64>,
    /// Rays cast.
    pub rays: u64,
}

impl FinalGather {
    /// Squared errors of all leaves: of direct light by random points, of which there are more where more may be wrong, so that some
    /// leaves have none and others stand for them. Each look has points of its own. `None` if cancelled.
    pub(super) fn look_at_leaves(
        &self,
        hierarchy: &Hierarchy,
        context: &Context,
        cancel: &CancelToken,
    ) -> Option<Look> {
        let leaves = &self.display.mesh.leaves;
        let weights: Vec<f64> = (0..leaves.len())
            .into_par_iter()
            .with_min_len(512)
            .map(|leaf| self.may_be_wrong(leaf, hierarchy, context))
            .collect();
        let count = ((POINTS * leaves.len() as f64) as usize).clamp(LEAST_POINTS, MOST_POINTS);
        let places = Places::new(weights.iter().copied(), count);
        let start = mix(mix(context.seed, 0x0073_706c_6974), u64::from(100 * self.attempt + self.round));
        let darkness = self.darkness(context);
        let lamps = self.lamps(hierarchy, context);
        let look = |cut: &mut Vec<Seen>, index: usize| {
            if cancel.is_cancelled() {
                return None;
            }
            let nothing = (0, 0.0, 0);
            let Some(place) = places.at(index, start) else { return Some(nothing) };
            let id = leaves[place.leaf].element;
            let [u, v] = place.uv;
            let point = hierarchy.point_on(id, u, v);
            let Some(shown) = self.direct_shown(hierarchy, id, point.position) else { return Some(nothing) };
            let seed = mix(start, index as u64);
            let mut rays = 0;
            // Two looks that know nothing of each other: the product of their differences is right in the mean, whatever their
            // noise.
            let [first, second] = [1, 2].map(|look| {
                let (wanted, seed) = (0.5 * self.lamp_rays(), mix(seed, look));
                let lit = lamps.irradiance(point.position, point.normal, wanted, f32::INFINITY, seed, cut);
                rays += u64::from(lit.rays);
                lit.irradiance
            });
            let is_hidden = || {
                let encloses =
                    |dark: &EnclosureTest| dark.encloses(point.position, point.normal, mix(seed, 3), DARK_RAYS);
                darkness.as_ref().is_some_and(encloses)
            };
            if first == Vec3::ZERO && second == Vec3::ZERO && (shown == Vec3::ZERO || is_hidden()) {
                return Some((place.leaf, 0.0, rays));
            }
            let reflectance = context.surfaces[point.polygon as usize].reflectance;
            let square = f64::from((reflectance * (first - shown)).dot(reflectance * (second - shown)));
            let area = f64::from(hierarchy.element(id).sampled_area) / place.density;
            Some((place.leaf, area * square, rays))
        };
        let looked: Vec<(usize, f64, u64)> =
            (0..count).into_par_iter().with_min_len(16).map_init(Vec::new, look).collect::<Option<_>>()?;
        let mut direct = vec![0.0; leaves.len()];
        // Summed in order, so that the result does not depend on the threads.
        looked.iter().for_each(|(leaf, error, _)| direct[*leaf] += error);
        Some(Look { direct, rays: looked.iter().map(|looked| looked.2).sum() })
    }

    /// What to expect of a leaf's squared error before a look at it, W²/m² up to a factor; 0 where nothing can be done about it.
    fn may_be_wrong(&self, leaf: usize, hierarchy: &Hierarchy, context: &Context) -> f64 {
        let mesh = &self.display.mesh;
        let of = &mesh.leaves[leaf];
        let surface = &context.surfaces[of.polygon as usize];
        if surface.emission != Vec3::ZERO || self.is_thin(leaf) {
            return 0.0;
        }
        let (mut least, mut most, mut indirect) = (Vec3::INFINITY, Vec3::ZERO, Vec3::ZERO);
        for vertex in self.display.triangles_of(leaf as u32).flat_map(|triangle| mesh.triangles[triangle as usize]) {
            let direct = self.direct[vertex as usize];
            (least, most) = (least.min(direct), most.max(direct));
            indirect = indirect.max(self.indirect[vertex as usize]);
        }
        let brightness = (surface.reflectance * (most + indirect)).length();
        let range = (surface.reflectance * (most - least)).length();
        let expected = range + UNSEEN * brightness;
        f64::from(hierarchy.element(of.element).sampled_area * expected * expected)
    }

    /// A·(ρ·ΔE)² of indirect light, by what rows found in the middle of a leaf and at its corners; their noise is subtracted.
    pub(super) fn indirect_error(&self, leaf: usize) -> f64 {
        let (mesh, display) = (&self.display.mesh, &self.display);
        let Some(middle) = display.centre_of(leaf as u32).map(|middle| middle as usize) else { return 0.0 };
        if !self.noise.is_finite() || self.vertices[middle].emission != Vec3::ZERO || self.is_thin(leaf) {
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
    pub(super) fn is_thin(&self, leaf: usize) -> bool {
        let mesh = &self.display.mesh;
        let corners = self.display.triangles_of(leaf as u32).flat_map(|triangle| mesh.triangles[triangle as usize]);
        let corners: Vec<Vec3> = corners.map(|corner| Vec3::from(mesh.positions[corner as usize])).collect();
        let longest = corners.iter().map(|corner| corner.distance(corners[0])).fold(0.0, f32::max);
        mesh.leaves[leaf].area < THINNEST * self.diagonal * longest
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

    /// Tells hidden points; where both sides of all faces are bright nothing is hidden.
    pub(super) fn darkness<'a>(&self, context: &'a Context) -> Option<EnclosureTest<'a>> {
        let lamps = || self.lamp_list.clone();
        self.has_dark_sides.then(|| EnclosureTest::with_lamps(context.scene, context.occluders, lamps()))
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
