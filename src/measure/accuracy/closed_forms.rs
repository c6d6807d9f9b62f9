//! Form factors and irradiances that are known exactly; all lengths in one unit, all values in f64.
//!
//! Sources: J. R. Howell, *A catalogue of radiation heat transfer configuration factors* (C-11,
//! C-14 and the 16-term sums); J. H. Lambert's formula for a point and a polygon; conservation of
//! power for closed rooms.

use std::f64::consts::PI;

use glam::DVec3;

/// An interval.
pub type Span = [f64; 2];

/// F between two equal rectangles a × b that face each other at distance c (Howell C-11).
pub fn facing_rectangles(a: f64, b: f64, c: f64) -> f64 {
    let (x, y) = (a / c, b / c);
    let (rx, ry) = ((1.0 + x * x).sqrt(), (1.0 + y * y).sqrt());
    let log = 0.5 * (rx * rx * ry * ry / (1.0 + x * x + y * y)).ln();
    let arcs = x * ry * (x / ry).atan() + y * rx * (y / rx).atan() - x * x.atan() - y * y.atan();
    2.0 / (PI * x * y) * (log + arcs)
}

/// F from a rectangle l × w to one of l × h that stands at right angles on their common edge l
/// (Howell C-14).
pub fn adjoining_rectangles(l: f64, w: f64, h: f64) -> f64 {
    let (w, h) = (w / l, h / l);
    let (w2, h2) = (w * w, h * h);
    let diagonal = (h2 + w2).sqrt();
    let arcs = w * (1.0 / w).atan() + h * (1.0 / h).atan() - diagonal * (1.0 / diagonal).atan();
    let sum = 1.0 + w2 + h2;
    let log = ((1.0 + w2) * (1.0 + h2) / sum).ln()
        + w2 * (w2 * sum / ((1.0 + w2) * (w2 + h2))).ln()
        + h2 * (h2 * sum / ((1.0 + h2) * (h2 + w2))).ln();
    (arcs + 0.25 * log) / (PI * w)
}

/// Exchange A·F of two parallel rectangles at distance `z`: x and y of one, ξ and η of the other.
pub fn parallel_exchange(x: Span, y: Span, xi: Span, eta: Span, z: f64) -> f64 {
    corners([x, y, xi, eta], |[x, y, xi, eta]| {
        let (a, b) = (x - xi, y - eta);
        let (ra, rb) = (a.hypot(z), b.hypot(z));
        (b * ra * (b / ra).atan() + a * rb * (a / rb).atan() - 0.5 * z * z * (a * a + b * b + z * z).ln()) / (2.0 * PI)
    })
}

/// Exchange A·F of two perpendicular rectangles: one spans x and y at z = 0, the other z = ξ and y
/// = η at x = 0.
pub fn perpendicular_exchange(x: Span, y: Span, xi: Span, eta: Span) -> f64 {
    corners([x, y, xi, eta], |[x, y, xi, eta]| {
        let (c, d) = (x.hypot(xi), y - eta);
        let reach = c * c + d * d;
        let slope = if c > 0.0 { d * c * (d / c).atan() } else { 0.0 };
        let log = if reach > 0.0 { 0.25 * (c * c - d * d) * reach.ln() } else { 0.0 };
        (slope - log) / (2.0 * PI)
    })
}

/// Alternating sum over the ends of four intervals.
fn corners(spans: [Span; 4], term: impl Fn([f64; 4]) -> f64) -> f64 {
    let corner = |index: usize| {
        let ends = std::array::from_fn(|axis| spans[axis][index >> axis & 1]);
        if index.count_ones().is_multiple_of(2) { term(ends) } else { -term(ends) }
    };
    (0..16).map(corner).sum()
}

/// F from a small area to a polygon: Lambert's formula over the part above the area's horizon. A
/// polygon of uniform radiosity B gives it the irradiance B·F. Corners in either sense of rotation.
pub fn point_to_polygon(point: DVec3, normal: DVec3, polygon: &[DVec3]) -> f64 {
    let height = |corner: DVec3| (corner - point).dot(normal);
    let mut above = Vec::with_capacity(polygon.len() + 1);
    for (index, &from) in polygon.iter().enumerate() {
        let to = polygon[(index + 1) % polygon.len()];
        let (low, high) = (height(from), height(to));
        if low >= 0.0 {
            above.push(from - point);
        }
        if (low < 0.0) != (high < 0.0) {
            above.push(from.lerp(to, low / (low - high)) - point);
        }
    }
    let edge = |index: usize| {
        let (from, to) = (above[index], above[(index + 1) % above.len()]);
        let across = from.cross(to);
        let sine = across.length();
        if sine > 0.0 { sine.atan2(from.dot(to)) * across.dot(normal) / sine } else { 0.0 }
    };
    ((0..above.len()).map(edge).sum::<f64>() / (2.0 * PI)).abs()
}

/// F from a small area to a parallel rectangle a × b at distance c that has a corner on the area's
/// normal.
pub fn point_to_corner_rectangle(a: f64, b: f64, c: f64) -> f64 {
    let (a, b) = (a / c, b / c);
    let (ra, rb) = ((1.0 + a * a).sqrt(), (1.0 + b * b).sqrt());
    (a / ra * (b / ra).atan() + b / rb * (a / rb).atan()) / (2.0 * PI)
}

/// Irradiance in a closed sphere or, as the mean over all faces, in any closed room of one
/// reflectance ρ: what is emitted in all, over A·(1−ρ). In a sphere every point sees every area
/// alike, F = A/4πR², so there it holds at every point whatever emits.
pub fn closed_room(power: f64, area: f64, reflectance: f64) -> f64 {
    power / (area * (1.0 - reflectance))
}

/// Illuminance of a plane under a small Lambertian lamp that faces it at height h: I₀·cos²θ/d² =
/// I₀·h²/d⁴.
pub fn small_lamp(intensity: f64, height: f64, aside: f64) -> f64 {
    let distance_squared = height * height + aside * aside;
    intensity * height * height / (distance_squared * distance_squared)
}

#[cfg(test)]
mod tests {
    use super::*;

    const UNIT: Span = [0.0, 1.0];

    fn near(value: f64, truth: f64, tolerance: f64) {
        assert!((value - truth).abs() < tolerance, "{value} instead of {truth}");
    }

    /// Truth: values computed elsewhere by quadrature and by Monte Carlo, and the sum of a cube's
    /// form factors.
    #[test]
    fn rectangles() {
        near(facing_rectangles(1.0, 1.0, 1.0), 0.199_824_895_7, 1e-10);
        near(facing_rectangles(2.0, 1.0, 0.5), 0.508_988_669_0, 1e-10);
        near(adjoining_rectangles(1.0, 1.0, 1.0), 0.200_043_776_1, 1e-10);
        near(adjoining_rectangles(1.0, 1.0, 0.5), 0.146_186_679_1, 1e-10);
        near(facing_rectangles(1.0, 1.0, 1.0) + 4.0 * adjoining_rectangles(1.0, 1.0, 1.0), 1.0, 1e-12);
        near(parallel_exchange(UNIT, UNIT, UNIT, UNIT, 1.0), facing_rectangles(1.0, 1.0, 1.0), 1e-12);
        near(parallel_exchange(UNIT, UNIT, [2.0, 3.0], UNIT, 1.0), 0.015_275_450_1, 1e-10);
        near(parallel_exchange(UNIT, UNIT, [1.0, 2.0], [1.0, 2.0], 2.0), 0.035_107_100_9, 1e-10);
        near(perpendicular_exchange(UNIT, UNIT, [0.0, 0.5], UNIT), adjoining_rectangles(1.0, 1.0, 0.5), 1e-12);
        near(perpendicular_exchange([1.0, 2.0], UNIT, [1.0, 2.0], UNIT), 0.032_938_162_3, 1e-10);
        near(perpendicular_exchange([0.5, 1.5], UNIT, [0.25, 1.25], [2.0, 3.0]), 0.008_179_128_8, 1e-10);
    }

    /// Truth: the corner formula; by symmetry a wall that stands half below the horizon counts with
    /// its upper half.
    #[test]
    fn points_and_polygons() {
        let at = |x: f64, y: f64, z: f64| DVec3::new(x, y, z);
        let roof = [at(0., 0., 0.7), at(2., 0., 0.7), at(2., 3., 0.7), at(0., 3., 0.7)];
        near(point_to_polygon(DVec3::ZERO, DVec3::Z, &roof), point_to_corner_rectangle(2.0, 3.0, 0.7), 1e-12);
        let wall = |low: f64| [at(1., -1., low), at(1., 1., low), at(1., 1., 1.), at(1., -1., 1.)];
        near(
            point_to_polygon(DVec3::ZERO, DVec3::Z, &wall(-1.0)),
            point_to_polygon(DVec3::ZERO, DVec3::Z, &wall(0.0)),
            1e-12,
        );
        near(point_to_polygon(DVec3::ZERO, DVec3::NEG_Z, &roof), 0.0, 1e-15);
    }

    /// Truth: the tables of CIE 171:2006, 5.2 and 5.8, as recomputed and published.
    #[test]
    fn published_values() {
        for ((x, y), lux) in [((0.0, 0.0), 111.11), ((0.5, 0.0), 105.19), ((1.0, 0.0), 90.0), ((1.5, 1.5), 49.38)] {
            near(small_lamp(1000.0, 3.0, f64::hypot(x, y)), lux, 0.005);
        }
        near(closed_room(10_000.0, 96.0, 0.5) - 10_000.0 / 96.0, 104.17, 0.005);
        near(closed_room(10_000.0, 96.0, 0.95) - 10_000.0 / 96.0, 1979.2, 0.05);
    }
}
