//! Error of a link, estimated for views from what is known of the link; refinement does not ask
//! for it (`docs/paper/tried.md`).
//!
//! Four parts ([Sillion & Drettakis 95] for mixed visibility):
//! - *kernel*: how much F varies over the receiver, which shows one value (half of it: values are
//!   joined linearly),
//! - *visibility*: 2V(1−V), the mean deviation of what is seen or not, for the share that falls on
//!   the receiver,
//! - *noise*: the standard error of V by so many rays,
//! - *source*: how much B varies over the source, for the share that F and V vary with it.

use super::super::form_factor::{Exchange, exchange};
use super::super::link::VisibilitySource;
use super::{LinkView, SolutionView};
use crate::geometry::point_to_polygon;
use crate::hierarchy::{ElementId, Hierarchy, Shape};

/// Share of the kernel's deviation that counts: leaves are shown joined linearly. This and the
/// other weights are those by which refinement did best, while it went by this error.
const KERNEL_WEIGHT: f32 = 0.5;
/// Weight of the source's part: near pairs are bright together, so its errors add up where others
/// cancel.
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
    pub visibility: f32,
    /// Visibility by few rays.
    pub noise: f32,
    /// Radiosity over the source.
    pub source: f32,
}

impl LinkError {
    /// All causes as independent ones, W.
    pub fn total(&self) -> f32 {
        (self.kernel.powi(2) + self.visibility.powi(2) + self.noise.powi(2) + self.source.powi(2)).sqrt()
    }
}

impl SolutionView {
    /// Power that a link is likely to misplace, make up or lose by each cause, W. Nobody looked at
    /// an unjudged link: it counts as if no ray had met it. A self-link may be wrong by all that it
    /// could carry.
    pub fn error(&self, link: &LinkView) -> LinkError {
        let (hierarchy, receiver, source) = (&*self.hierarchy, link.receiver, link.source);
        let max_radiosity = self.radiosity(source).max_element();
        if receiver == source {
            return LinkError { visibility: max_radiosity * hierarchy.element(source).area, ..LinkError::default() };
        }
        if max_radiosity <= 0.0 {
            return LinkError::default();
        }
        let Exchange::Facing { estimate, bound, overlapping } = exchange(hierarchy, receiver, source) else {
            // One end lies behind the other: all that the link carries is wrong.
            return LinkError { visibility: link.power.max_element(), ..LinkError::default() };
        };
        if overlapping && bound > estimate {
            return LinkError { visibility: TOUCHING_WEIGHT * max_radiosity * bound, ..LinkError::default() };
        }
        let power = max_radiosity * estimate;
        let (seen, noise) = seen_and_noise(link);
        // Many of the links that are kept look darker by chance than they are.
        let at_least = seen.max(0.5);
        let (own, other) = (extent(hierarchy, receiver), extent(hierarchy, source));
        let share = if own > 0.0 { own / (own + other) } else { 0.0 };
        let uneven = self.radiosity_stddev(source) / max_radiosity;
        let over_source = match hierarchy.element(source).shape {
            _ if uneven <= 0.0 => 0.0,
            // Its faces are turned all ways.
            Shape::Cluster(_) => 1.0,
            Shape::Patch(_) => kernel_variation(hierarchy, source, receiver),
            Shape::Sky(_) => OVER_SKY,
        };
        let with_visibility = (over_source.powi(2) + (1.0 - seen) / seen.max(1e-6)).sqrt().min(1.0);
        LinkError {
            kernel: KERNEL_WEIGHT * power * at_least * kernel_variation(hierarchy, receiver, source),
            visibility: power * 2.0 * at_least * (1.0 - at_least) * share,
            noise: NOISE_WEIGHT * power * noise,
            source: SOURCE_WEIGHT * power * at_least * uneven * with_visibility,
        }
    }

    /// Standard deviation of radiosity over an element's leaves, W/m².
    fn radiosity_stddev(&self, id: ElementId) -> f32 {
        let of_all = self.radiosity_stddev.get_or_init(|| {
            let max_radiosity: Vec<f32> =
                self.light.radiosity.iter().map(|radiosity| radiosity.max_element()).collect();
            radiosity_stddev_of(&self.hierarchy, &max_radiosity)
        });
        of_all.get(id.index()).copied().unwrap_or(0.0)
    }
}

/// Standard deviation of radiosity over the leaves of each element, W/m²; `max_radiosity` is
/// parallel to the arena.
fn radiosity_stddev_of(hierarchy: &Hierarchy, max_radiosity: &[f32]) -> Vec<f32> {
    let mut radiosity_stddev = vec![0.0_f32; max_radiosity.len()];
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
    radiosity_stddev
}

/// The V that a link's rays make likely, and its standard error; exact where a pair that holds the
/// link was seen in full.
fn seen_and_noise(link: &LinkView) -> (f32, f32) {
    let (visibility, rays) = match link.visibility_source {
        VisibilitySource::Inherited => return (1.0, 0.0),
        VisibilitySource::None => (link.visibility, 0.0),
        VisibilitySource::Clear(rays) => (1.0, f32::from(rays)),
        VisibilitySource::Rays(rays) => (link.visibility, f32::from(rays)),
    };
    let seen = (visibility * rays + PRIOR) / (rays + 2.0 * PRIOR);
    (seen, (seen * (1.0 - seen) / (rays + 1.0)).sqrt())
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
fn kernel_variation(hierarchy: &Hierarchy, over: ElementId, other: ElementId) -> f32 {
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

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use crate::scene::{GroupId, Scene};
    use crate::solve::{ClusteringMode, Solver, SolverParams};

    /// Error of the link from a lamp to a floor of side 1 below it, off its middle, as a share of
    /// the link's power.
    fn error_of_lamp(height: f32, lamp_side: f32) -> f32 {
        let mut scene = Scene::new("floor");
        let mut add = |centre: Vec3, side: f32, reflectance: f32, emission: f32, order: [usize; 4]| {
            let material = scene.add_material("square", Vec3::splat(reflectance), Vec3::splat(emission));
            let at = |x: f32, y: f32| centre + 0.5 * side * Vec3::new(x, y, 0.0);
            let corners = [at(-1.0, -1.0), at(1.0, -1.0), at(1.0, 1.0), at(-1.0, 1.0)];
            scene.add_quad(order.map(|corner| corners[corner]), material, GroupId(0));
        };
        add(Vec3::ZERO, 1.0, 0.5, 0.0, [0, 1, 2, 3]);
        add(Vec3::new(0.3, 0.3, height), lamp_side, 0.0, 1.0, [3, 2, 1, 0]);
        // The self-link is refined, and nothing else.
        let params = SolverParams { clustering: ClusteringMode::None, rays_min: 64, ..SolverParams::with_epsilon(0.9) };
        let view = Solver::solved_view(scene, params);
        let link = view.all_links().max_by(|a, b| a.power.x.total_cmp(&b.power.x)).expect("a link");
        view.error(&link).total() / link.power.x
    }

    /// Truth: from 20 sides away cosθ·cosθ'/d² varies by some 0.3 % over the floor, and 64 free
    /// rays leave about 1 %; from 0.3 sides, one corner gets more than ten times what the others
    /// get.
    #[test]
    fn an_unevenly_lit_floor_has_the_larger_error() {
        let (far, near) = (error_of_lamp(20.0, 1.0), error_of_lamp(0.3, 0.1));
        assert!(far < 0.02 && near > 0.2, "far {far}, near {near}");
    }
}
