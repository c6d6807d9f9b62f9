//! A polygon as one point sees it: its form factor, and points on it that stand for equal parts of
//! that.
//!
//! A far polygon is sampled by area, a near one by solid angle [Arvo, *Stratified sampling of
//! spherical triangles*, SIGGRAPH 1995]: by area, most of the light of a lamp that touches a wall
//! would come from the few samples beside the contact.

use std::f32::consts::PI;

use glam::Vec3;

use crate::geometry::{AboveHorizon, lambert};
use crate::hierarchy::point_on_polygon;

/// A polygon whose radius is above this share of its distance is sampled by solid angle.
const NEAR: f32 = 0.25;
/// Triangles of smaller solid angles (sr) are sampled by area: rounding would decide about
/// directions.
const LEAST_SOLID_ANGLE: f32 = 1e-3;

/// The part of a polygon above a point's horizon.
#[derive(Clone, Copy, Debug)]
pub struct Facet {
    above: AboveHorizon,
    is_near: bool,
    /// Form factor from the point to the polygon, unoccluded.
    pub form_factor: f32,
}

/// A sample of a facet.
#[derive(Clone, Copy, Debug)]
pub struct FacetSample {
    /// From the point to the place on the polygon.
    pub span: Vec3,
    /// Share of the facet's form factor that the sample stands for, up to a factor common to all
    /// samples of one facet.
    pub kernel: f32,
}

impl Facet {
    /// The part of a polygon (corners anticlockwise from its bright side) that a point with this
    /// unit normal sees; `None` where it lies below the horizon or shows its back.
    pub fn new(point: Vec3, normal: Vec3, polygon: &[Vec3]) -> Option<Self> {
        let above = AboveHorizon::new(point, normal, polygon);
        let used = above.corners();
        if used.len() < 3 {
            return None;
        }
        let form_factor = lambert(normal, used);
        let centre = used.iter().sum::<Vec3>() / used.len() as f32;
        let radius_squared = used.iter().map(|corner| corner.distance_squared(centre)).fold(0.0, f32::max);
        let is_near = radius_squared > NEAR * NEAR * centre.length_squared();
        (form_factor > 0.0).then_some(Self { above, is_near, form_factor: form_factor.min(1.0) })
    }

    /// The samples of a facet with this polygon normal, by points of the unit square.
    pub fn samples(&self, normal: Vec3, polygon_normal: Vec3) -> FacetSampler<'_> {
        let corners = self.corners();
        let mut angles = [SphericalTriangle::default(); AboveHorizon::MOST_CORNERS - 2];
        let mut total = 0.0;
        if self.is_near {
            for (index, angle) in angles[..corners.len() - 2].iter_mut().enumerate() {
                *angle = SphericalTriangle::new([corners[0], corners[index + 1], corners[index + 2]]);
                total += angle.area;
            }
        }
        let by_area = !self.is_near || total < LEAST_SOLID_ANGLE || !total.is_finite();
        FacetSampler { facet: self, normal, polygon_normal, angles, total: if by_area { 0.0 } else { total } }
    }

    fn corners(&self) -> &[Vec3] {
        self.above.corners()
    }
}

/// Draws samples of a facet.
pub struct FacetSampler<'a> {
    facet: &'a Facet,
    normal: Vec3,
    polygon_normal: Vec3,
    angles: [SphericalTriangle; AboveHorizon::MOST_CORNERS - 2],
    /// Solid angle of the facet, sr; 0 where it is sampled by area.
    total: f32,
}

impl FacetSampler<'_> {
    /// The sample at a point of the unit square; its kernel is 0 where it shows nothing.
    pub fn at(&self, [u, v]: [f32; 2]) -> FacetSample {
        if self.total > 0.0 { self.by_solid_angle(u, v) } else { self.by_area(u, v) }
    }

    /// Domain over which samples are spread evenly: solid angle, sr, or area; the form factor is
    /// the mean kernel times this, over π.
    pub fn measure(&self) -> f32 {
        if self.total > 0.0 { self.total } else { fan_area(self.facet.corners()) }
    }

    fn by_area(&self, u: f32, v: f32) -> FacetSample {
        let corners = self.facet.corners();
        let span = match *corners {
            [_, _, _] | [_, _, _, _] => point_on_polygon(corners, u, v),
            // Three triangles of which the middle one is as likely as its share of the fan.
            _ => point_on_fan(corners, u, v),
        };
        let square = span.length_squared();
        let cosines = self.normal.dot(span).max(0.0) * (-self.polygon_normal.dot(span)).max(0.0);
        let kernel = if square > 0.0 { cosines / (square * square) } else { 0.0 };
        FacetSample { span, kernel }
    }

    fn by_solid_angle(&self, u: f32, v: f32) -> FacetSample {
        let nothing = FacetSample { span: self.normal, kernel: 0.0 };
        let mut rest = u * self.total;
        let mut index = 0;
        while index + 3 < self.facet.corners().len() && rest >= self.angles[index].area {
            rest -= self.angles[index].area;
            index += 1;
        }
        let triangle = &self.angles[index];
        if triangle.area <= 0.0 {
            return nothing;
        }
        let direction = triangle.direction((rest / triangle.area).clamp(0.0, 1.0), v);
        // Where the direction meets the plane of the polygon.
        let towards = self.polygon_normal.dot(direction);
        let distance = self.polygon_normal.dot(self.facet.corners()[0]) / towards;
        let cosine = self.normal.dot(direction);
        if !(distance > 0.0 && distance.is_finite() && towards < 0.0 && cosine > 0.0) {
            return nothing;
        }
        FacetSample { span: distance * direction, kernel: cosine }
    }
}

fn fan_area(corners: &[Vec3]) -> f32 {
    let area = |pair: &[Vec3]| 0.5 * (pair[0] - corners[0]).cross(pair[1] - corners[0]).length();
    corners[1..].windows(2).map(area).sum()
}

fn point_on_fan(corners: &[Vec3], u: f32, v: f32) -> Vec3 {
    let area = |index: usize| (corners[index + 1] - corners[0]).cross(corners[index + 2] - corners[0]).length();
    let triangles = corners.len() - 2;
    let total: f32 = (0..triangles).map(area).sum();
    let mut rest = u * total;
    let mut index = 0;
    while index + 1 < triangles && rest >= area(index) {
        rest -= area(index);
        index += 1;
    }
    let share = if area(index) > 0.0 { (rest / area(index)).clamp(0.0, 1.0) } else { 0.5 };
    point_on_polygon(&[corners[0], corners[index + 1], corners[index + 2]], share, v)
}

/// A triangle on the unit sphere about the origin.
#[derive(Clone, Copy, Debug, Default)]
struct SphericalTriangle {
    a: Vec3,
    b: Vec3,
    c: Vec3,
    /// Angle at `a`, its sine and cosine.
    alpha: f32,
    sin_alpha: f32,
    cos_alpha: f32,
    /// Cosine of the side from `a` to `b`.
    cos_side: f32,
    /// Solid angle, sr.
    area: f32,
}

impl SphericalTriangle {
    fn new(corners: [Vec3; 3]) -> Self {
        let [a, b, c] = corners.map(Vec3::normalize_or_zero);
        let normals = [a.cross(b), b.cross(c), c.cross(a)].map(Vec3::normalize_or_zero);
        if normals.contains(&Vec3::ZERO) {
            return Self::default();
        }
        let [ab, bc, ca] = normals;
        let angle = |from: Vec3, to: Vec3| from.angle_between(-to);
        let (alpha, beta, gamma) = (angle(ab, ca), angle(bc, ab), angle(ca, bc));
        let (sin_alpha, cos_alpha) = alpha.sin_cos();
        let area = (alpha + beta + gamma - PI).max(0.0);
        Self { a, b, c, alpha, sin_alpha, cos_alpha, cos_side: a.dot(b), area }
    }

    /// The direction at `(u, v)`; equal areas of the unit square are equal solid angles.
    ///
    /// `u` chooses the sub-triangle of that share of the area which the arc from `b` cuts off, `v`
    /// a place on the arc from `b` to the new corner.
    fn direction(&self, u: f32, v: f32) -> Vec3 {
        let (s, t) = (u * self.area - self.alpha).sin_cos();
        let (p, q) = (t - self.cos_alpha, s + self.sin_alpha * self.cos_side);
        let below = (q * s + p * t) * self.sin_alpha;
        // A thin triangle, whose far corner stands for all of its far side.
        let far = if below.abs() > 0.0 { ((q * t - p * s) * self.cos_alpha - q) / below } else { 1.0 };
        let far = far.clamp(-1.0, 1.0);
        let corner = far * self.a + (1.0 - far * far).max(0.0).sqrt() * perpendicular(self.c, self.a);
        let height = 1.0 - v * (1.0 - corner.dot(self.b));
        height * self.b + (1.0 - height * height).max(0.0).sqrt() * perpendicular(corner, self.b)
    }
}

/// The unit vector in the plane of `of` and `to` that is perpendicular to `to`.
fn perpendicular(of: Vec3, to: Vec3) -> Vec3 {
    (of - of.dot(to) * to).normalize_or_zero()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::random::r2_sequence;
    use crate::geometry::point_to_polygon;

    fn square(height: f32, side: f32, shift: f32) -> [Vec3; 4] {
        // Bright side down.
        let at = |x: f32, y: f32| Vec3::new(shift + side * x, side * y, height);
        [at(-0.5, -0.5), at(-0.5, 0.5), at(0.5, 0.5), at(0.5, -0.5)]
    }

    /// Truth: Lambert's formula; a sampler whose kernel is right has a mean kernel of π·F per solid
    /// angle or per area, whichever it samples.
    #[test]
    fn samples_add_up_to_the_form_factor() {
        for (height, side, shift) in
            [(1.0, 0.1, 0.0), (0.5, 1.0, 0.2), (0.05, 1.0, 0.3), (2.0, 6.0, 2.5), (0.01, 0.1, 0.0)]
        {
            let polygon = square(height, side, shift);
            for normal in [Vec3::Z, Vec3::new(0.6, 0.0, 0.8), Vec3::new(-0.9, 0.3, 0.1).normalize()] {
                let Some(facet) = Facet::new(Vec3::ZERO, normal, &polygon) else { continue };
                let exact = point_to_polygon(Vec3::ZERO, normal, &polygon);
                assert!((facet.form_factor - exact).abs() < 1e-5, "{height} {side} {normal}");
                let sampler = facet.samples(normal, Vec3::NEG_Z);
                let count = 20_000;
                let mean = (0..count).map(|index| sampler.at(r2_sequence(7, index)).kernel).sum::<f32>() / count as f32;
                let found = mean * sampler.measure() / PI;
                assert!((found - exact).abs() < 0.01 * exact, "{height} {side} {shift} {normal}: {found} {exact}");
                let on_plane =
                    |index: u32| (sampler.at(r2_sequence(9, index)).span.z - height).abs() < 1e-4 * (1.0 + side);
                assert!((0..200).filter(|index| sampler.at(r2_sequence(9, *index)).kernel > 0.0).all(on_plane));
            }
        }
    }

    #[test]
    fn backs_and_what_lies_below_the_horizon_show_nothing() {
        let polygon = square(1.0, 1.0, 0.0);
        let reversed = [polygon[3], polygon[2], polygon[1], polygon[0]];
        assert!(Facet::new(Vec3::ZERO, Vec3::Z, &reversed).is_none());
        assert!(Facet::new(Vec3::ZERO, Vec3::NEG_Z, &polygon).is_none());
    }
}
