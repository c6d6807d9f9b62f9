//! Form factors without occlusion, as one symmetric *exchange* G = A_r·F(r←s) = A_s·F(s←r), in m².
//!
//! Far patches use the kernel between their centres with its curvature over both, near and touching
//! ones the analytic point-to-polygon form factor averaged over points of the smaller; a cluster's
//! cosine is ¼, the mean projected area of randomly turned one-sided faces [Sillion 95, eqs 8–15].

use std::f32::consts::PI;

use glam::Vec3;

use crate::geometry::point_to_polygon;
use crate::hierarchy::{Cluster, Element, ElementId, Hierarchy, Patch, Shape, SkyPart};

/// A cluster's mean cosine: projected over total area of randomly turned one-sided faces.
pub const CLUSTER_COSINE: f32 = 0.25;
/// Patches nearer than this many times the larger one's size (square root of area) get the analytic
/// form factor.
const NEAR: f32 = 2.5;
/// So do those where the kernel's curvature changes its mean by more than this share: what the
/// expansion leaves out is about the square of that, 1 %.
const MOST_CURVED: f32 = 0.1;
/// Behind a plane up to this share of an element's size still counts as on it: f32 noise of
/// coplanar faces.
const PLANE_TOLERANCE: f32 = 1e-4;

/// Exchange of light between a pair of elements by geometry alone.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Exchange {
    /// One end lies wholly behind the other's plane: no light passes.
    FacingAway,
    /// They see each other unless something is between them.
    Facing {
        /// Estimate of G = A_r·F(r←s), m².
        estimate: f32,
        /// Form factor that the oracle judges by: the estimate, or a bound where boxes touch and
        /// the estimate means little. Of the light that a cluster sends evenly into all directions
        /// at most half meets a plane, or a box beside it.
        bound: f32,
        /// Whether the ends' boxes overlap or touch.
        overlapping: bool,
    },
}

/// The exchange between two different elements.
pub fn exchange(hierarchy: &Hierarchy, a: ElementId, b: ElementId) -> Exchange {
    // The same order of the same numbers whichever end asks: the same bits for both directions.
    let (a, b) = if hierarchy.element(a).key <= hierarchy.element(b).key { (a, b) } else { (b, a) };
    let (first, second) = (hierarchy.element(a), hierarchy.element(b));
    if first.area <= 0.0 || second.area <= 0.0 {
        // Hidden wholly: no light goes there or comes from there.
        return Exchange::FacingAway;
    }
    match (&first.shape, &second.shape) {
        (Shape::Patch(p), Shape::Patch(q)) => patches(hierarchy, (first, p), (second, q)),
        (Shape::Patch(p), Shape::Cluster(c)) => patch_and_cluster(hierarchy, (first, p), (second, c)),
        (Shape::Cluster(c), Shape::Patch(p)) => patch_and_cluster(hierarchy, (second, p), (first, c)),
        (Shape::Cluster(c), Shape::Cluster(d)) => clusters((first, c), (second, d)),
        (_, Shape::Sky(number)) => from_outside(first, hierarchy.sky_part(*number)),
        (Shape::Sky(number), _) => from_outside(second, hierarchy.sky_part(*number)),
    }
}

/// G from a part of what lies outside: the area times the projected solid angle over π, exact for a
/// patch that sees all of it or to which it is alike everywhere.
fn from_outside(receiver: &Element, part: &SkyPart) -> Exchange {
    let form_factor = match &receiver.shape {
        Shape::Patch(patch) if part.is_above(patch.normal) => patch.normal.dot(part.weighted).max(0.0) / PI,
        Shape::Patch(patch) => point_to_polygon(Vec3::ZERO, patch.normal, &part.corners),
        Shape::Cluster(_) => CLUSTER_COSINE * part.solid_angle / PI,
        // The parts of the outside send each other nothing.
        Shape::Sky(_) => 0.0,
    };
    if form_factor <= 0.0 {
        return Exchange::FacingAway;
    }
    let estimate = receiver.area * form_factor;
    Exchange::Facing { estimate, bound: estimate, overlapping: false }
}

/// Self-exchange G = A·F of a cluster: what its polygons send to each other, estimated as in a
/// homogeneous sphere of the same volume and area (`1 − P_escape`, [Sillion 95]; κ = ΣA/(4V), eq
/// 15).
pub fn self_exchange(element: &Element, cluster: &Cluster) -> f32 {
    let half = cluster.half_extent;
    // A flat box gets the thickness of a hundredth of its size: its volume must not vanish.
    let padded = half.max(Vec3::splat(0.01 * half.max_element()));
    let volume = 8.0 * padded.x * padded.y * padded.z;
    if volume <= 0.0 {
        return 0.0;
    }
    let radius = (0.75 * volume / PI).cbrt();
    let depth = element.area / (4.0 * volume) * radius;
    element.area * (1.0 - escape_from_sphere(depth))
}

/// Share of the light born evenly in a homogeneous sphere that leaves it, by the optical depth κR
/// of its radius.
fn escape_from_sphere(depth: f32) -> f32 {
    let t = f64::from(depth);
    if t < 0.05 {
        // Series of the closed form, which cancels here.
        return (1.0 - 0.75 * t) as f32;
    }
    (3.0 / (8.0 * t * t * t) * (2.0 * t * t - 1.0 + (1.0 + 2.0 * t) * (-2.0 * t).exp())) as f32
}

fn patches(hierarchy: &Hierarchy, (first, p): (&Element, &Patch), (second, q): (&Element, &Patch)) -> Exchange {
    let (p_positions, p_count) = hierarchy.corner_positions(p);
    let (q_positions, q_count) = hierarchy.corner_positions(q);
    let (p_corners, q_corners) = (&p_positions[..p_count], &q_positions[..q_count]);
    if all_behind(first, p, q_corners) || all_behind(second, q, p_corners) {
        return Exchange::FacingAway;
    }
    let between = second.centre - first.centre;
    let distance_squared = between.length_squared();
    // Cosines times distance.
    let (p_height, q_height) = (p.normal.dot(between), -q.normal.dot(between));
    let (p_whole, q_whole) = (hierarchy.whole_area(first, p), hierarchy.whole_area(second, q));
    let near = distance_squared < NEAR * NEAR * p_whole.max(q_whole) || p_height <= 0.0 || q_height <= 0.0;
    let far = (!near).then(|| from_centres((first, p, p_corners), (second, q, q_corners))).flatten();
    let estimate = far.unwrap_or_else(|| {
        let ((small, s, s_corners), (large, l, l_corners), l_whole) = if (p_whole, first.key) <= (q_whole, second.key) {
            ((first, p, p_corners), (second, q, q_corners), q_whole)
        } else {
            ((second, q, q_corners), (first, p, p_corners), p_whole)
        };
        // What is hidden of the larger one sends as little of its light as it takes of its area.
        analytic(small, s.normal, s_corners, large, l, l_corners) * (large.area / l_whole)
    });
    Exchange::Facing { estimate, bound: estimate, overlapping: false }
}

/// G by the kernel k = cosθ·cosθ'/(πd²) between the centres and its second derivatives: its mean
/// over both patches is k + ½·tr(H·C) with the Hessian H in the span between the points and the sum
/// C of the patches' covariances, which are a twelfth of the sum over corners of (v−c)(v−c)ᵀ for
/// triangles and parallelograms alike. `None` where that changes k too much.
fn from_centres(
    (first, p, p_corners): (&Element, &Patch, &[Vec3]),
    (second, q, q_corners): (&Element, &Patch, &[Vec3]),
) -> Option<f32> {
    let span = second.centre - first.centre;
    let square = span.length_squared();
    let (p_height, q_height) = (p.normal.dot(span), -q.normal.dot(span));
    let heights = p_height * q_height;
    // Second derivative along `e` of heights/square², times square².
    let curvature = |e: Vec3| {
        let (by_p, by_q, along) = (p.normal.dot(e), q.normal.dot(e), span.dot(e) / square);
        -2.0 * by_p * by_q - 8.0 * (q_height * by_p - p_height * by_q) * along
            + heights * (24.0 * along * along - 4.0 * e.length_squared() / square)
    };
    let over = |corners: &[Vec3], centre: Vec3| corners.iter().map(|&corner| curvature(corner - centre)).sum::<f32>();
    let change = (over(p_corners, first.centre) + over(q_corners, second.centre)) / 24.0;
    let is_mild = change.abs() <= MOST_CURVED * heights;
    is_mild.then(|| (heights + change) * first.area * second.area / (PI * square * square))
}

/// Gauss points of order 3 on the unit interval and their weights.
const GAUSS: [(f32, f32); 3] = [(0.112_701_66, 0.277_777_8), (0.5, 0.444_444_45), (0.887_298_35, 0.277_777_8)];

/// G by the form factor from points of the smaller patch to the whole larger one.
fn analytic(small: &Element, normal: Vec3, corners: &[Vec3], large: &Element, l: &Patch, l_corners: &[Vec3]) -> f32 {
    // Far for its own size, a patch needs one point.
    let distance_squared = (large.centre - small.centre).length_squared();
    let one_point = small.area * 64.0 < large.area.min(distance_squared);
    let at = |point: Vec3| {
        let in_front = l.normal.dot(point - large.centre) > 0.0;
        if in_front { point_to_polygon(point, normal, l_corners) } else { 0.0 }
    };
    if one_point {
        return small.area * at(small.centre);
    }
    let mut mean = 0.0;
    for (u, u_weight) in GAUSS {
        for (v, v_weight) in GAUSS {
            mean += u_weight * v_weight * at(mapped(corners, u, v));
        }
    }
    small.area * mean
}

/// Point of a triangle or quad at `(u, v)`; for a triangle the square is folded along `v` with a
/// root, for equal areas.
fn mapped(corners: &[Vec3], u: f32, v: f32) -> Vec3 {
    match *corners {
        [a, b, c] => {
            let root = u.sqrt();
            a + root * ((1.0 - v) * (b - a) + v * (c - a))
        }
        [a, b, c, d] => a.lerp(b, u).lerp(d.lerp(c, u), v),
        _ => unreachable!("a patch has three or four corners"),
    }
}

/// Whether points lie behind (or in) a patch's plane.
fn all_behind(element: &Element, patch: &Patch, points: &[Vec3]) -> bool {
    let highest =
        points.iter().map(|&point| patch.normal.dot(point - element.centre)).fold(f32::NEG_INFINITY, f32::max);
    let reach = points.iter().map(|&point| (point - element.centre).length_squared()).fold(0.0, f32::max).sqrt();
    highest <= PLANE_TOLERANCE * reach
}

fn patch_and_cluster(
    hierarchy: &Hierarchy,
    (element, patch): (&Element, &Patch),
    (other, cluster): (&Element, &Cluster),
) -> Exchange {
    let between = other.centre - element.centre;
    let middle_height = patch.normal.dot(between);
    let reach = patch.normal.abs().dot(cluster.half_extent);
    let highest = middle_height + reach;
    if highest <= PLANE_TOLERANCE * (between.length() + cluster.half_extent.length()) {
        return Exchange::FacingAway;
    }
    // Only the part of the box before the plane is seen, at its own mean height.
    let lowest = (middle_height - reach).max(0.0);
    let seen = if reach > 0.0 { ((highest - lowest) / (2.0 * reach)).min(1.0) } else { 1.0 };
    let height = 0.5 * (highest + lowest);
    let distance_squared = between.length_squared().max(height * height);
    let cosine = (height / distance_squared.sqrt()).min(1.0) * seen;
    let larger_area = element.area.max(CLUSTER_COSINE * other.area);
    let estimate = cosine * CLUSTER_COSINE * element.area * other.area / (PI * distance_squared + larger_area);
    let (positions, count) = hierarchy.corner_positions(patch);
    let lower = positions[1..count].iter().copied().fold(positions[0], Vec3::min);
    let upper = positions[1..count].iter().copied().fold(positions[0], Vec3::max);
    let gap =
        ((0.5 * (lower + upper) - other.centre).abs() - 0.5 * (upper - lower) - cluster.half_extent).max_element();
    with_bound(estimate, gap <= 0.0, element.area.min(0.5 * seen * other.area))
}

fn clusters((first, c): (&Element, &Cluster), (second, d): (&Element, &Cluster)) -> Exchange {
    let between = second.centre - first.centre;
    let larger_area = CLUSTER_COSINE * first.area.max(second.area);
    let areas = CLUSTER_COSINE * CLUSTER_COSINE * first.area * second.area;
    let estimate = areas / (PI * between.length_squared() + larger_area);
    let gap = (between.abs() - c.half_extent - d.half_extent).max_element();
    with_bound(estimate, gap <= 0.0, 0.5 * first.area.min(second.area))
}

fn with_bound(estimate: f32, overlapping: bool, most: f32) -> Exchange {
    let bound = if overlapping { most } else { estimate };
    Exchange::Facing { estimate, bound, overlapping }
}
