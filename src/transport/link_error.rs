//! The error oracle: refines a link while the power that it is likely to misplace, make up or lose
//! exceeds ε, whatever it carries.
//!
//! Four parts, all from what is known of a link at any time, so that a stored one can be judged
//! again ([SD95] for mixed sight, [BW96] for which end to split):
//! - *kernel*: how much F varies over the receiver, which shows one value (half of it: values are joined linearly),
//! - *sight*: 2V(1−V), the mean deviation of what is seen or not, for the share that falls on the receiver,
//! - *noise*: the standard error of V by so many rays,
//! - *source*: how much B varies over the source, for the share that F and V vary with it.

use super::candidate::{DEEPEST_LEVEL, end_to_split};
use super::form_factor::{Exchange, exchange, point_to_polygon};
use super::link::{Link, VisibilitySource};
use super::oracle::Oracle;
use super::verdict::{Decision, Rejection};
use super::visibility::{VisibilityEstimate, VisibilityKind};
use crate::hierarchy::{DEEPEST_SKY, ElementId, Hierarchy, Shape};

/// Share of the kernel's deviation that counts: leaves are shown joined linearly, and 1 needs twice
/// the patches for the same error in the Cornell box (2,306 at 7.2 % against 1,331 at 6.7 %).
const KERNEL_WEIGHT: f32 = 0.5;
/// Weight of the source's part: near pairs are bright together, so its errors add up where others
/// cancel. From 1 to 2 the Cornell box's error falls from 7.2 to 6.1 % for a quarter more links.
const SOURCE_WEIGHT: f32 = 2.0;
/// Weight of V's standard error, which differs from link to link and cancels in part.
const NOISE_WEIGHT: f32 = 0.5;
/// Of the power between boxes that touch, of which no estimate is known, half counts as error.
const TOUCHING_WEIGHT: f32 = 0.5;
/// Rays of which none came through are as good as this many half ones (Krichevsky & Trofimov's
/// prior, half a ray of either kind).
const PRIOR: f32 = 0.5;
/// Variation of the cosine over a part of the sky.
const OVER_SKY: f32 = 0.5;
/// Patches nearer than this many times the larger one's size vary by their form factors from
/// points, others by their centres.
const NEAR: f32 = 2.5;

/// Estimated error of a link by cause, W.
#[derive(Clone, Copy, Debug, Default)]
pub struct LinkError {
    /// Kernel over the receiver.
    pub kernel: f32,
    /// Visibility over the receiver.
    pub sight: f32,
    /// Visibility by few rays.
    pub noise: f32,
    /// Radiosity over the source.
    pub source: f32,
}

impl LinkError {
    /// All causes as independent ones, W.
    pub fn total(&self) -> f32 {
        (self.kernel.powi(2) + self.sight.powi(2) + self.noise.powi(2) + self.source.powi(2)).sqrt()
    }
}

/// Standard deviation of radiosity over the leaves of each element, W/m²; `max_radiosity` is
/// parallel to the arena.
pub fn radiosity_stddev_of(hierarchy: &Hierarchy, max_radiosity: &[f32], radiosity_stddev: &mut Vec<f32>) {
    radiosity_stddev.clear();
    radiosity_stddev.resize(max_radiosity.len(), 0.0);
    // Children come after their parent.
    for (index, element) in hierarchy.elements().iter().enumerate().take(max_radiosity.len()).rev() {
        let of_child = |child: ElementId| {
            let away = max_radiosity[child.index()] - max_radiosity[index];
            hierarchy.element(child).area * (radiosity_stddev[child.index()].powi(2) + away * away)
        };
        let sum: f32 = element.children().map(of_child).sum();
        if element.area > 0.0 {
            radiosity_stddev[index] = (sum / element.area).sqrt();
        }
    }
}

impl Oracle<'_> {
    /// Decides about a direction of a pair by the error of the link that it would get.
    pub fn decide_by_error(
        &self,
        receiver: ElementId,
        link: Link,
        facing: Facing,
        sight: &VisibilityEstimate,
    ) -> Decision {
        let source = link.source();
        if self.max_radiosity[source.index()] <= 0.0 {
            return Decision::Accept(link.unjudged());
        }
        let rays = match sight.kind {
            VisibilityKind::None => return Decision::Reject(Rejection::Occluded),
            VisibilityKind::Unknown => Some(0),
            VisibilityKind::Full if sight.asked == 0 => None,
            VisibilityKind::Full | VisibilityKind::Partial => Some(sight.asked),
        };
        let error = self.error_of(receiver, source, facing, sight.visibility, rays);
        if error.total() <= self.thresholds.epsilon || !self.may_split {
            return Decision::Accept(link);
        }
        let Some(larger) = end_to_split(self.hierarchy, receiver, source) else { return Decision::AcceptAtGuard(link) };
        let most = error.kernel.max(error.sight).max(error.noise).max(error.source);
        let end = if facing.overlapping || most == error.noise {
            larger
        } else if most == error.source {
            source
        } else {
            receiver
        };
        let is_deepest = |id: ElementId| match self.hierarchy.element(id).shape {
            Shape::Patch(patch) => patch.level >= DEEPEST_LEVEL,
            Shape::Sky(number) => self.hierarchy.sky_part(number).level >= DEEPEST_SKY,
            Shape::Cluster(_) => false,
        };
        Decision::Refine(if is_deepest(end) { larger } else { end })
    }

    /// Whether a stored link exceeds the error allowed by the present radiosities.
    pub fn fails_by_error(&self, receiver: ElementId, link: &Link, margin: f32) -> bool {
        let source = link.source();
        let allowed = margin * self.thresholds.epsilon;
        if receiver == source {
            return self.max_radiosity[source.index()] * self.hierarchy.element(source).area > allowed;
        }
        let Exchange::Facing { estimate, bound, overlapping } = exchange(self.hierarchy, receiver, source) else {
            return true;
        };
        let facing = Facing { estimate, bound, overlapping };
        link.visibility_source() == VisibilitySource::None
            || self.exceeds_error(receiver, link, facing, allowed)
                && end_to_split(self.hierarchy, receiver, source).is_some()
    }

    /// Whether a link's error exceeds what is allowed, W; always where nobody looked.
    pub fn exceeds_error(&self, receiver: ElementId, link: &Link, facing: Facing, allowed: f32) -> bool {
        let Some((visibility, rays)) = seen_by(link.visibility(), link.visibility_source()) else { return true };
        self.error_of(receiver, link.source(), facing, visibility, rays).total() > allowed
    }

    /// Whether a touching pair is refined whatever its visibility.
    pub fn is_refined_unseen(&self, bound_power: f32) -> bool {
        TOUCHING_WEIGHT * bound_power > self.thresholds.epsilon
    }

    fn error_of(
        &self,
        receiver: ElementId,
        source: ElementId,
        facing: Facing,
        visibility: f32,
        rays: Option<u32>,
    ) -> LinkError {
        let light = SourceLight {
            max_radiosity: self.max_radiosity[source.index()],
            radiosity_stddev: self.radiosity_stddev[source.index()],
        };
        estimated_error(self.hierarchy, (receiver, source), facing, light, (visibility, rays))
    }
}

/// The V and the rays by which a stored link is judged; `None` where nobody looked.
pub fn seen_by(visibility: f32, visibility_source: VisibilitySource) -> Option<(f32, Option<u32>)> {
    match visibility_source {
        VisibilitySource::None => None,
        VisibilitySource::Inherited => Some((1.0, None)),
        VisibilitySource::Clear(rays) => Some((1.0, Some(rays.into()))),
        VisibilitySource::Rays(rays) => Some((visibility, Some(rays.into()))),
    }
}

/// A source's light, largest colour, W/m².
#[derive(Clone, Copy, Debug)]
pub struct SourceLight {
    /// Radiosity B.
    pub max_radiosity: f32,
    /// Standard deviation of the radiosity over the source's leaves.
    pub radiosity_stddev: f32,
}

/// Estimated error of a link (receiver, source) with mean visibility V by so many rays; `None`
/// where a pair that holds it was seen in full.
pub fn estimated_error(
    hierarchy: &Hierarchy,
    (receiver, source): (ElementId, ElementId),
    facing: Facing,
    light: SourceLight,
    (visibility, rays): (f32, Option<u32>),
) -> LinkError {
    let max_radiosity = light.max_radiosity;
    if facing.overlapping && facing.bound > facing.estimate {
        return LinkError { sight: TOUCHING_WEIGHT * max_radiosity * facing.bound, ..LinkError::default() };
    }
    let power = max_radiosity * facing.estimate;
    let (seen, noise) = match rays {
        None => (1.0, 0.0),
        Some(rays) => {
            let rays = rays as f32;
            let seen = (visibility * rays + PRIOR) / (rays + 2.0 * PRIOR);
            (seen, (seen * (1.0 - seen) / (rays + 1.0)).sqrt())
        }
    };
    // Links kept because few rays came through by chance, while those by which more came through
    // are refined, lose light: 9 % of the seminar room's at 1e-4, 7 % with this.
    let at_least = seen.max(0.5);
    let (own, other) = (extent(hierarchy, receiver), extent(hierarchy, source));
    let share = if own > 0.0 { own / (own + other) } else { 0.0 };
    let uneven = light.radiosity_stddev / max_radiosity;
    let over_source = match hierarchy.element(source).shape {
        _ if uneven <= 0.0 => 0.0,
        // Its faces are turned all ways.
        Shape::Cluster(_) => 1.0,
        Shape::Patch(_) => kernel_variation(hierarchy, source, receiver),
        Shape::Sky(_) => OVER_SKY,
    };
    let with_sight = (over_source.powi(2) + (1.0 - seen) / seen.max(1e-6)).sqrt().min(1.0);
    LinkError {
        kernel: KERNEL_WEIGHT * power * at_least * kernel_variation(hierarchy, receiver, source),
        sight: power * 2.0 * at_least * (1.0 - at_least) * share,
        noise: NOISE_WEIGHT * power * noise,
        source: SOURCE_WEIGHT * power * at_least * uneven * with_sight,
    }
}

/// Form factors of a pair by geometry, times area, m².
#[derive(Clone, Copy, Debug)]
pub struct Facing {
    /// Estimated exchange G = A_r·F.
    pub estimate: f32,
    /// Bound of the estimate where boxes touch.
    pub bound: f32,
    /// Whether they do.
    pub overlapping: bool,
}

/// Side of an element: of a square of a patch's area, of the mean face of a cluster's box, m.
fn extent(hierarchy: &Hierarchy, id: ElementId) -> f32 {
    let element = hierarchy.element(id);
    match &element.shape {
        Shape::Patch(_) | Shape::Sky(_) => element.area.sqrt(),
        Shape::Cluster(cluster) => (2.0 * cluster.half_extent.length_squared()).sqrt(),
    }
}

/// Standard deviation over an element of the kernel towards another, as a share of its mean: from a
/// patch's corners, of a linear function; over a cluster that of 1/d², for each of its faces gets
/// its own cosine.
pub fn kernel_variation(hierarchy: &Hierarchy, over: ElementId, other: ElementId) -> f32 {
    let (to, from) = (hierarchy.element(over), hierarchy.element(other));
    let patch = match &to.shape {
        Shape::Patch(patch) => patch,
        Shape::Sky(_) => return 0.0,
        Shape::Cluster(cluster) => {
            let variance = cluster.half_extent.length_squared() / 3.0;
            let of_other = match &from.shape {
                Shape::Cluster(other) => other.half_extent.length_squared() / 3.0,
                Shape::Patch(_) => from.area / 12.0,
                // From infinity, all places are alike.
                Shape::Sky(_) => return 0.0,
            };
            let square = (from.centre - to.centre).length_squared() + variance + of_other;
            return if square > 0.0 { 2.0 * (variance / square).sqrt() } else { 0.0 };
        }
    };
    let (corners, count) = hierarchy.corner_positions(patch);
    let mut values = [0.0_f32; 4];
    match &from.shape {
        Shape::Patch(source) => {
            let (source_corners, source_count) = hierarchy.corner_positions(source);
            let near = (from.centre - to.centre).length_squared() < NEAR * NEAR * from.area.max(to.area);
            for (value, &corner) in values.iter_mut().zip(&corners[..count]) {
                let span = from.centre - corner;
                let square = span.length_squared();
                *value = if !near {
                    patch.normal.dot(span).max(0.0) * (-source.normal.dot(span)).max(0.0) / (square * square)
                } else if source.normal.dot(span) < 0.0 {
                    // A corner in the edge of the source sees nothing of it or half the sphere: a
                    // step inwards.
                    let point = corner + 0.05 * (to.centre - corner);
                    point_to_polygon(point, patch.normal, &source_corners[..source_count])
                } else {
                    0.0
                };
            }
        }
        Shape::Cluster(cluster) => {
            let variance = cluster.half_extent.length_squared() / 3.0;
            for (value, &corner) in values.iter_mut().zip(&corners[..count]) {
                let span = from.centre - corner;
                let square = span.length_squared() + variance;
                *value = (patch.normal.dot(span) + 0.5 * variance.sqrt()).max(0.0) / (square * square.sqrt());
            }
        }
        Shape::Sky(_) => return 0.0,
    }
    deviation(&values[..count]) / 3.0_f32.sqrt()
}

/// Root of the mean squared distance from the mean, as a share of the mean.
fn deviation(values: &[f32]) -> f32 {
    let count = values.len() as f32;
    let mean = values.iter().sum::<f32>() / count;
    let square = values.iter().map(|value| (value - mean).powi(2)).sum::<f32>() / count;
    if mean > 0.0 { square.sqrt() / mean } else { 0.0 }
}
