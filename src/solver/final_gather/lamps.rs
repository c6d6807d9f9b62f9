//! Direct light at a point: lamps by their exact form factors, seen by rays that are shared out by what each lamp could send.
//!
//! What shines like a lamp is one: the inside of a lamp's shade reflects more than all the room does, out of a corner that random
//! rays hardly meet. Such surfaces count by all that they send, and rays that meet them find nothing more.

use std::f32::consts::PI;

use glam::Vec3;

use super::super::form_factor::point_to_polygon;
use crate::hierarchy::{Element, ElementId, Hierarchy, Patch, PatchSums, Shape};
use crate::random::{fraction, mix};
use crate::visibility::Occluders;

/// A cluster of lamps this small, as a share of its distance, is one lamp: a ray to a random point of it tells as much as a ray to one
/// of its members.
const SMALL: f32 = 0.1;

/// Steps of the two-dimensional sequence of the plastic number (Roberts), as 32-bit fractions.
const STEPS: [u32; 2] = [3_242_174_889, 2_447_445_414];

/// What the lamps of a scene send.
pub struct Sent {
    /// Radiosity of each polygon that is a lamp, zero for the others, W/m².
    pub radiosity: Vec<Vec3>,
    /// Power of the initial patches, W (largest colour).
    powers: PatchSums,
}

impl Sent {
    /// By the radiosity that each polygon sends as a lamp.
    pub fn new(hierarchy: &Hierarchy, radiosity: Vec<Vec3>) -> Self {
        let power = |&id: &ElementId| {
            let element = hierarchy.element(id);
            let Shape::Patch(patch) = element.shape else { return 0.0 };
            f64::from(element.sampled_area * radiosity[patch.polygon as usize].max_element())
        };
        let powers = PatchSums::new(hierarchy.initial_patches().iter().map(power));
        Self { radiosity, powers }
    }
}

/// All that shines.
#[derive(Clone, Copy)]
pub struct Lamps<'a> {
    /// Elements.
    pub hierarchy: &'a Hierarchy,
    /// What the lamps send.
    pub sent: &'a Sent,
    /// What stops light.
    pub occluders: &'a Occluders,
}

/// Light at a point and what it cost.
#[derive(Clone, Copy, Debug, Default)]
pub struct Lit {
    /// Irradiance, W/m².
    pub irradiance: Vec3,
    /// Rays cast.
    pub rays: u32,
}

/// A lamp, or a small cluster of them, as a point sees it.
#[derive(Clone, Copy, Debug)]
pub struct Seen {
    id: ElementId,
    /// What it could send, W/m² (largest colour), and for a patch its form factor.
    most: f32,
    form_factor: f32,
}

impl Lamps<'_> {
    /// Irradiance that lamps send to a point, by about so many rays; `cut` is room to work in.
    pub fn irradiance(&self, point: Vec3, normal: Vec3, rays: f32, seed: u64, cut: &mut Vec<Seen>) -> Lit {
        cut.clear();
        self.collect(Hierarchy::ROOT, point, normal, cut);
        let total: f32 = cut.iter().map(|seen| seen.most).sum();
        let mut lit = Lit::default();
        if total <= 0.0 {
            return lit;
        }
        for (index, seen) in cut.iter().enumerate() {
            let seed = mix(seed, index as u64);
            let wanted = rays * seen.most / total;
            // What deserves less than a ray gets one by chance, and counts for all those that get none.
            let chance = wanted.min(1.0);
            if fraction(mix(seed, 1) as u32) >= chance {
                continue;
            }
            let count = wanted.ceil().max(1.0) as u32;
            let light = match self.hierarchy.element(seen.id).shape {
                Shape::Patch(patch) => self.of_patch(seen, &patch, point, normal, count, seed),
                Shape::Cluster(_) => self.of_cluster(seen.id, point, normal, count, seed),
            };
            lit.irradiance += light.irradiance / chance;
            lit.rays += light.rays;
        }
        lit
    }

    fn collect(&self, id: ElementId, point: Vec3, normal: Vec3, cut: &mut Vec<Seen>) {
        let element = self.hierarchy.element(id);
        match &element.shape {
            Shape::Cluster(cluster) => {
                let power = self.sent.powers.over(cluster);
                let span = element.centre - point;
                if power <= 0.0 || normal.dot(span) + normal.abs().dot(cluster.half_extent) <= 0.0 {
                    return;
                }
                let distance_squared = span.length_squared();
                if cluster.half_extent.length_squared() < SMALL * SMALL * distance_squared {
                    let cosine = (normal.dot(span) / distance_squared.sqrt()).max(SMALL);
                    let most = power as f32 * cosine / (PI * distance_squared);
                    cut.push(Seen { id, most, form_factor: 0.0 });
                } else {
                    element.children().for_each(|child| self.collect(child, point, normal, cut));
                }
            }
            Shape::Patch(patch) => {
                let emission = self.sent.radiosity[patch.polygon as usize].max_element();
                if emission <= 0.0 || patch.normal.dot(point - element.centre) <= 0.0 {
                    return;
                }
                let (corners, count) = self.hierarchy.corner_positions(patch);
                let form_factor = point_to_polygon(point, normal, &corners[..count]) * self.exposed(element, patch);
                if form_factor > 0.0 {
                    cut.push(Seen { id, most: form_factor * emission, form_factor });
                }
            }
        }
    }

    fn exposed(&self, element: &Element, patch: &Patch) -> f32 {
        let whole = self.hierarchy.whole_area(element, patch);
        if whole > 0.0 { element.sampled_area / whole } else { 0.0 }
    }

    /// B_e·F·V with V weighted by the kernel, since rays to the near end of a lamp decide about more light.
    fn of_patch(&self, seen: &Seen, patch: &Patch, point: Vec3, normal: Vec3, count: u32, seed: u64) -> Lit {
        let (mut all, mut visible, mut rays) = (0.0, 0.0, 0);
        for target in self.points(seen.id, count, seed) {
            let kernel = kernel(point, normal, target.position, target.normal);
            if kernel > 0.0 {
                all += kernel;
                rays += 1;
                if !self.occluders.occluded(point, target.position) {
                    visible += kernel;
                }
            }
        }
        let share = if all > 0.0 { visible / all } else { 0.0 };
        Lit { irradiance: seen.form_factor * share * self.sent.radiosity[patch.polygon as usize], rays }
    }

    fn of_cluster(&self, id: ElementId, point: Vec3, normal: Vec3, count: u32, seed: u64) -> Lit {
        let Shape::Cluster(cluster) = &self.hierarchy.element(id).shape else { return Lit::default() };
        let power = self.sent.powers.over(cluster) as f32;
        let mut lit = Lit::default();
        for target in self.points(id, count, seed) {
            let kernel = kernel(point, normal, target.position, target.normal);
            if kernel > 0.0 {
                lit.rays += 1;
                if !self.occluders.occluded(point, target.position) {
                    // Points lie by power: each stands for the same number of watts, in the colour of its lamp.
                    let emission = self.sent.radiosity[target.polygon as usize];
                    lit.irradiance += kernel * power / count as f32 * emission / emission.max_element();
                }
            }
        }
        lit
    }

    fn points(&self, id: ElementId, count: u32, seed: u64) -> impl Iterator<Item = crate::hierarchy::SurfacePoint> {
        let start = mix(seed, 2);
        let start = [start as u32, (start >> 32) as u32];
        (0..count).map(move |index| {
            let coordinate = |axis: usize| fraction(start[axis].wrapping_add(STEPS[axis].wrapping_mul(index)));
            self.hierarchy.point_on_by(&self.sent.powers, id, coordinate(0), coordinate(1))
        })
    }
}

/// cosθ·cosθ'/(πd²) between two points, 1/m²; 0 where one faces away.
fn kernel(point: Vec3, normal: Vec3, target: Vec3, target_normal: Vec3) -> f32 {
    let span = target - point;
    let square = span.length_squared();
    let (cosine, target_cosine) = (normal.dot(span), -target_normal.dot(span));
    if cosine > 0.0 && target_cosine > 0.0 && square > 0.0 { cosine * target_cosine / (PI * square * square) } else { 0.0 }
}
