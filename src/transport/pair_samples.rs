//! Pair samples: pairs of random points on two elements, and visibility rays between those that
//! face each other (section 2.4).
//!
//! For patches the samples tell how much of the other end is seen. For clusters the same points
//! also tell how their polygons are turned: a box of furniture, a lamp or a wall made of pieces is
//! not the cloud of randomly turned faces that the mean cosine of ¼ stands for, and the power of a
//! link that was stored with that cosine is lost or made up.

use std::f32::consts::PI;

use glam::Vec3;

use crate::base::random::{fraction, hash64};
use crate::geometry::{LastStop, Occluders, point_to_polygon};
use crate::hierarchy::{ElementId, Hierarchy, PatchSums, Shape, SurfacePoint};

/// How many rays a pair gets.
#[derive(Clone, Copy, Debug)]
pub struct RayBudget {
    /// Rays where any comes through; 0 to look at the points alone.
    pub rays: u32,
    /// Rays before a pair counts as occluded; at least `rays`.
    pub rays_if_blocked: u32,
    /// End as soon as one ray came through and one did not.
    pub stop_when_mixed: bool,
}

/// Sums over the pairs of points of two elements.
#[derive(Clone, Copy, Debug, Default)]
pub struct PairSamples {
    /// Pairs of points looked at.
    pub pairs: u32,
    /// Rays cast between those that face each other.
    pub cast: u32,
    /// Rays that met nothing.
    pub visible: u32,
    /// Sum over pairs of the kernel cosθ·cosθ'/(πd²), zero for those that do not face each other,
    /// 1/m².
    kernel: f32,
    /// Sum of the kernel over pairs with a ray between them, 1/m².
    rayed_kernel: f32,
    /// Sum of the kernel over visible pairs, 1/m².
    visible_kernel: f32,
}

impl PairSamples {
    /// Mean visibility, each pair of points counted by the light it would carry.
    pub fn visibility(&self) -> f32 {
        if self.rayed_kernel > 0.0 { (self.visible_kernel / self.rayed_kernel).min(1.0) } else { 0.0 }
    }

    /// Mean of the kernel cosθ·cosθ'/(πd²) over all pairs, 1/m².
    pub fn mean_kernel(&self) -> f32 {
        if self.pairs > 0 { self.kernel / self.pairs as f32 } else { 0.0 }
    }

    /// Mean over all pairs of the kernel times visibility, 1/m².
    pub fn mean_visible_kernel(&self) -> f32 {
        self.mean_kernel() * self.visibility()
    }

    fn is_mixed(&self) -> bool {
        self.visible > 0 && self.visible < self.cast
    }
}

/// Density of the points of pair samples.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SampleDensity {
    /// Evenly over both ends.
    Even,
    /// Even by area, with other points than `Even`.
    EvenAgain,
    /// Over the first end by what it emits, evenly over the second, which receives.
    EmissionOfA,
    /// The other way round.
    EmissionOfB,
}

/// Samples pairs of elements; the points depend on what the two are and on the seed, not on who
/// asks.
#[derive(Clone, Copy)]
pub struct RaySampler<'a> {
    /// Faces that stop light.
    pub occluders: &'a Occluders,
    /// Seed of all points.
    pub seed: u64,
    /// Where light is emitted.
    pub emission: &'a PatchSums,
}

/// The patch of a pair of patch and cluster: seen from a point of the cluster as a whole, so that
/// points may lie as near to it as they like.
struct WholePatch {
    is_a: bool,
    corners: [Vec3; 4],
    count: usize,
    centre: Vec3,
    normal: Vec3,
    area: f32,
}

impl WholePatch {
    fn of(hierarchy: &Hierarchy, (a, b): (ElementId, ElementId)) -> Option<Self> {
        let (first, second) = (hierarchy.element(a), hierarchy.element(b));
        let (is_a, element) = match (first.is_cluster(), second.is_cluster()) {
            (false, true) if first.is_patch() => (true, first),
            (true, false) if second.is_patch() => (false, second),
            _ => return None,
        };
        let Shape::Patch(patch) = &element.shape else { return None };
        let (corners, count) = hierarchy.corner_positions(patch);
        let area = hierarchy.whole_area(element, patch);
        Some(Self { is_a, corners, count, centre: element.centre, normal: patch.normal, area })
    }

    /// Mean over the patch of the kernel to a point, 1/m².
    fn mean_kernel(&self, point: &SurfacePoint) -> f32 {
        if self.normal.dot(point.position - self.centre) <= 0.0 {
            return 0.0;
        }
        point_to_polygon(point.position, point.normal, &self.corners[..self.count]) / self.area
    }
}

/// Steps of the four-dimensional R-sequence (Roberts), inverse powers of the root of x⁵ = x + 1, as
/// 32-bit fractions.
const STEPS: [u32; 4] = [3_679_390_609, 3_152_041_523, 2_700_274_806, 2_313_257_605];
/// Pairs of points on patches tried for each ray before an end is said to turn its back.
const TRIES: u32 = 8;
/// Pairs of points of which a cluster's form factor is made at least.
const FEWEST_PAIRS: u32 = 12;

impl RaySampler<'_> {
    /// Whether an element is a cluster that emits, so that its light may come from a part of it
    /// alone.
    pub fn emits_in_part(&self, hierarchy: &Hierarchy, source: ElementId) -> bool {
        self.emission.of(hierarchy, source) > 0.0
    }

    /// Looks at pairs of points of two elements, with rays between those that face each other.
    pub fn sample_pairs(
        &self,
        hierarchy: &Hierarchy,
        (a, b): (ElementId, ElementId),
        density: SampleDensity,
        budget: RayBudget,
    ) -> PairSamples {
        let (a_key, b_key) = (hierarchy.element(a).key, hierarchy.element(b).key);
        // The same points for both directions: order the ends by what they are.
        let a_is_first = a_key <= b_key;
        let purpose = match density {
            SampleDensity::Even => 0,
            SampleDensity::EmissionOfA => 1 + u64::from(a_is_first),
            SampleDensity::EmissionOfB => 1 + u64::from(!a_is_first),
            SampleDensity::EvenAgain => 3,
        };
        let pair = hash64(hash64(a_key.min(b_key), a_key.max(b_key)), self.seed);
        let (low, high) = (hash64(pair, 1 + 2 * purpose), hash64(pair, 2 + 2 * purpose));
        let start = [low as u32, (low >> 32) as u32, high as u32, (high >> 32) as u32];
        let clusters = u32::from(hierarchy.element(a).is_cluster()) + u32::from(hierarchy.element(b).is_cluster());
        // Between clusters the number of pairs is fixed, about so many that the wanted number of
        // them face each other: to stop at a number of rays would make the mean kernel depend on
        // it.
        let pairs_for = |rays: u32| match (clusters, density) {
            (0, _) => rays.saturating_mul(TRIES),
            (_, SampleDensity::Even | SampleDensity::EvenAgain) => (rays << clusters).max(FEWEST_PAIRS),
            _ => (rays << (clusters - 1)).max(FEWEST_PAIRS),
        };
        let (pairs, pairs_if_blocked) = (pairs_for(budget.rays), pairs_for(budget.rays_if_blocked));
        // Points stand for this area; nearer to each other than its size they say no more than
        // that.
        let smallest = hierarchy.element(a).sampled_area.min(hierarchy.element(b).sampled_area) / pairs.max(1) as f32;
        if hierarchy.element(a).is_sky() || hierarchy.element(b).is_sky() {
            let limits = [pairs, pairs_if_blocked];
            return self.survey_outside(hierarchy, (a, b), (start, a_is_first), (limits, clusters > 0), budget);
        }
        let whole_patch = WholePatch::of(hierarchy, (a, b));
        let points = |id: ElementId, by_emission: SampleDensity| {
            hierarchy.points_on((density == by_emission).then_some(self.emission), id)
        };
        let (on_a, on_b) = (points(a, SampleDensity::EmissionOfA), points(b, SampleDensity::EmissionOfB));
        let (mut samples, mut last) = (PairSamples::default(), LastStop::default());
        for index in 0..pairs_if_blocked {
            let enough = if clusters > 0 { index >= pairs } else { samples.cast >= budget.rays };
            let blocked = samples.visible == 0 && samples.cast < budget.rays_if_blocked;
            if enough && !blocked {
                break;
            }
            let coordinate = |axis: usize| fraction(start[axis].wrapping_add(STEPS[axis].wrapping_mul(index)));
            let (u, v) = if a_is_first { (0, 2) } else { (2, 0) };
            let from = on_a.at(coordinate(u), coordinate(u + 1));
            let to = on_b.at(coordinate(v), coordinate(v + 1));
            let span = to.position - from.position;
            let distance_squared = span.length_squared();
            let to_unit = distance_squared.sqrt().recip();
            let (cosine_a, cosine_b) = (from.normal.dot(span) * to_unit, -to.normal.dot(span) * to_unit);
            samples.pairs += 1;
            let faces = cosine_a > 0.0 && cosine_b > 0.0;
            let kernel = if faces { cosine_a * cosine_b / (PI * distance_squared + smallest) } else { 0.0 };
            samples.kernel += match &whole_patch {
                Some(patch) => patch.mean_kernel(if patch.is_a { &to } else { &from }),
                None => kernel,
            };
            if budget.rays == 0 {
                samples.rayed_kernel += kernel;
                samples.visible_kernel += kernel;
                continue;
            }
            if !faces {
                continue;
            }
            samples.rayed_kernel += kernel;
            samples.cast += 1;
            if self.occluders.sees_after(&mut last, (from.position, from.normal), (to.position, to.normal)) {
                samples.visible += 1;
                samples.visible_kernel += kernel;
            }
            if samples.is_mixed() && budget.stop_when_mixed {
                break;
            }
        }
        samples
    }

    /// Looks from points of an element along directions of a part of what lies outside, in likewise
    /// fixed order.
    fn survey_outside(
        &self,
        hierarchy: &Hierarchy,
        (a, b): (ElementId, ElementId),
        (start, a_is_first): ([u32; 4], bool),
        ([pairs, pairs_if_blocked], has_cluster): ([u32; 2], bool),
        budget: RayBudget,
    ) -> PairSamples {
        let (receiver, source, is_first) =
            if hierarchy.element(b).is_sky() { (a, b, a_is_first) } else { (b, a, !a_is_first) };
        let mut samples = PairSamples::default();
        let Shape::Sky(number) = hierarchy.element(source).shape else { return samples };
        let (part, area) = (hierarchy.sky_part(number), hierarchy.element(source).area);
        for index in 0..pairs_if_blocked {
            let enough = if has_cluster { index >= pairs } else { samples.cast >= budget.rays };
            let blocked = samples.visible == 0 && samples.cast < budget.rays_if_blocked;
            if enough && !blocked {
                break;
            }
            let coordinate = |axis: usize| fraction(start[axis].wrapping_add(STEPS[axis].wrapping_mul(index)));
            let (u, v) = if is_first { (0, 2) } else { (2, 0) };
            let from = hierarchy.point_on(receiver, coordinate(u), coordinate(u + 1));
            let (direction, stands_for) = part.direction_at(coordinate(v), coordinate(v + 1));
            let cosine = from.normal.dot(direction);
            samples.pairs += 1;
            // So that the part's area times the mean is the form factor.
            let kernel = cosine.max(0.0) * stands_for / (PI * area);
            samples.kernel += kernel;
            if budget.rays == 0 {
                samples.rayed_kernel += kernel;
                samples.visible_kernel += kernel;
                continue;
            }
            if cosine <= 0.0 {
                continue;
            }
            samples.rayed_kernel += kernel;
            samples.cast += 1;
            if self.occluders.is_open(from.position, from.normal, direction) {
                samples.visible += 1;
                samples.visible_kernel += kernel;
            }
            if samples.is_mixed() && budget.stop_when_mixed {
                break;
            }
        }
        samples
    }
}
