//! Lambert's formula: the form factor from a point to the part of a polygon that lies above its
//! horizon \[Lambert 1760; Baum, Rushmeier, Winget: *Improving radiosity solutions through the use
//! of analytically determined form-factors*, SIGGRAPH 1989, eq 9\].

use std::f32::consts::{PI, TAU};

use glam::Vec3;

/// Coefficients of `arccos(x)/√(1−x²)` for x in 0..=1, from the constant on; its relative error is
/// 1e-8 before rounding.
const ARC: [f32; 10] = [
    std::f32::consts::FRAC_PI_2,
    -0.999_995_8,
    0.785_258_7,
    -0.664_815_4,
    0.576_202_45,
    -0.480_019_63,
    0.347_402_3,
    -0.191_148_56,
    0.067_372_724,
    -0.011_053_119,
];

/// The part of a triangle or quad above the horizon of a point, in spans from there.
#[derive(Clone, Copy, Debug)]
pub struct AboveHorizon {
    corners: [Vec3; Self::MOST_CORNERS],
    count: usize,
}

impl AboveHorizon {
    /// Corners of a quad that one plane cuts, at most.
    pub const MOST_CORNERS: usize = 5;

    /// The part of a convex polygon above the horizon of a point with this unit normal.
    pub fn new(point: Vec3, normal: Vec3, polygon: &[Vec3]) -> Self {
        let mut above = Self { corners: [Vec3::ZERO; Self::MOST_CORNERS], count: 0 };
        for (index, &corner) in polygon.iter().enumerate() {
            let (from, to) = (corner - point, polygon[(index + 1) % polygon.len()] - point);
            let (from_height, to_height) = (normal.dot(from), normal.dot(to));
            if from_height >= 0.0 {
                above.push(from);
            }
            if (from_height > 0.0 && to_height < 0.0) || (from_height < 0.0 && to_height > 0.0) {
                above.push(from + (to - from) * (from_height / (from_height - to_height)));
            }
        }
        above
    }

    fn push(&mut self, corner: Vec3) {
        // A quad that is bent a little may have one more.
        if let Some(place) = self.corners.get_mut(self.count) {
            *place = corner;
            self.count += 1;
        }
    }

    /// Corners of the part; none where all lies below the horizon.
    #[inline]
    pub fn corners(&self) -> &[Vec3] {
        &self.corners[..self.count]
    }
}

/// Form factor from a point with this unit normal to a polygon with the corners anticlockwise as
/// seen from its bright side, without occlusion.
pub fn point_to_polygon(point: Vec3, normal: Vec3, polygon: &[Vec3]) -> f32 {
    let above = AboveHorizon::new(point, normal, polygon);
    let form_factor = far_away(normal, above.corners()).unwrap_or_else(|| lambert(normal, above.corners()));
    form_factor.clamp(0.0, 1.0)
}

/// A polygon is far away if its corners are seen this close to its middle, as the square of a
/// tangent: there its edges' angles cancel but for their last bits, and it is as good as a point
/// with an area, both to 1e-4.
const FAR_AWAY: f32 = 1e-4;

/// Form factor to a small polygon far away, its corners seen from the receiving point; `None` where
/// it is near.
fn far_away(normal: Vec3, corners: &[Vec3]) -> Option<f32> {
    let middle = corners.iter().sum::<Vec3>() / corners.len().max(1) as f32;
    let squared = middle.length_squared();
    if corners.is_empty() || !corners.iter().all(|corner| corner.distance_squared(middle) < FAR_AWAY * squared) {
        return None;
    }
    let next = corners.iter().cycle().skip(1);
    let area: Vec3 = corners.iter().zip(next).map(|(a, b)| 0.5 * (*a - middle).cross(*b - middle)).sum();
    Some(-normal.dot(middle) * area.dot(middle) / (PI * squared * squared))
}

/// Form factor from the origin, with this unit normal, to a polygon wholly above its horizon;
/// positive where the polygon shows its bright side, anticlockwise as seen from the origin.
///
/// Each edge adds its angle times the unit normal of the plane through it and the origin. Of two
/// unit vectors, the angle over its sine is a smooth function of its cosine, which takes fewer
/// steps than an arc tangent and gives the same bits on all machines.
#[inline]
pub fn lambert(normal: Vec3, corners: &[Vec3]) -> f32 {
    let Some(last) = corners.last() else { return 0.0 };
    let (mut from, mut sum) = (last.normalize_or_zero(), Vec3::ZERO);
    for corner in corners {
        let to = corner.normalize_or_zero();
        let cross = from.cross(to);
        sum += arc_over_sine(from.dot(to), cross.length()) * cross;
        from = to;
    }
    -normal.dot(sum) / TAU
}

/// An angle over its sine, by its cosine and sine.
#[inline]
fn arc_over_sine(cosine: f32, sine: f32) -> f32 {
    let x = cosine.abs();
    let acute = ARC.iter().rev().fold(0.0, |sum, coefficient| sum * x + coefficient);
    if cosine >= 0.0 { acute } else { PI / sine.max(f32::MIN_POSITIVE) - acute }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Truth: the angle itself, in double precision.
    #[test]
    fn angles_are_right_to_rounding() {
        for step in 1..3_141 {
            let angle = f64::from(step) * 1e-3;
            let (sine, cosine) = angle.sin_cos();
            let error = f64::from(arc_over_sine(cosine as f32, sine as f32)) * sine / angle - 1.0;
            // Rounding of the cosine alone changes obtuse angles by as much.
            assert!(error.abs() < 4e-7, "{angle}: off by {error:e}");
        }
        assert_eq!(arc_over_sine(1.0, 0.0), 1.0);
    }

    /// Truth: a square of side 2 at a height of 1 is seen by (4/π)·(1/√2)·arctan(1/√2) \[Howell, *A
    /// catalog of radiation heat transfer configuration factors*, B-4\]; from a corner, on an edge,
    /// and with a point in a corner of the polygon, all is finite.
    #[test]
    fn a_square_above_a_point() {
        let square = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]].map(|[x, y]| Vec3::new(y, x, 1.0));
        let truth = 4.0 / PI * 0.5_f32.sqrt() * 0.5_f32.sqrt().atan();
        assert!((lambert(Vec3::Z, &square) - truth).abs() < 3e-7);
        let from_edge = square.map(|corner| corner - Vec3::new(1.0, 0.0, 1.0));
        let from_corner = square.map(|corner| corner - square[2]);
        assert!(lambert(Vec3::Z, &from_edge).is_finite() && lambert(Vec3::Z, &from_corner).is_finite());
        assert_eq!(lambert(Vec3::Z, &[]), 0.0);
    }
}
