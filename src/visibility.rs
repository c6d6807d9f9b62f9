//! Occluders: the ray BVH over the scene's faces (obvhs), which stop light from either side.

use std::time::Duration;

use glam::{Vec3, Vec3A};
use obvhs::BvhBuildParams;
use obvhs::cwbvh::{CwBvh, builder::build_cwbvh_from_tris};
use obvhs::ray::{Ray, RayHit};
use obvhs::triangle::Triangle;

use crate::scene::Scene;

/// Rays start and end this share of their length away from the surfaces they join, so that they do not meet them.
const RELATIVE_OFFSET: f32 = 1e-5;

/// obvhs misses boxes that end nearer than 10⁻⁴ to a ray's origin: in a BVH of size 1 every corner of a room would leak one ray in
/// 10,000. In one of this size that is 3·10⁻⁶ of the scene. Its checks of its own boxes allow for 10⁻⁵, which is why it is no larger.
const SIZE_IN_BVH: f32 = 32.0;

/// Three times the distance from a ray's origin within which obvhs may miss a face, in the BVH's units.
const LEAST_DISTANCE: f32 = 3e-4;

/// Where a ray first meets a face.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// Distance along the ray, in lengths of its direction.
    pub distance: f32,
    /// Index into [`Scene::polygons`].
    pub polygon: u32,
    /// Whether the ray meets the bright side that the winding shows.
    pub front: bool,
}

/// The faces of a scene in a BVH; each face once, whichever sides of it are bright.
pub struct Occluders {
    bvh: CwBvh,
    triangles: Vec<Triangle>,
    polygon_of_triangle: Vec<u32>,
    /// Power of two that brings the scene to a size near [`SIZE_IN_BVH`], in which the BVH is built: the same scene in units that
    /// differ by powers of two meets the same rays, bit for bit.
    scale: f32,
}

impl Occluders {
    /// Builds the BVH over every face of the scene that is not the second side of another.
    pub fn new(scene: &Scene) -> Self {
        let mut triangles = Vec::with_capacity(2 * scene.polygons.len());
        for (index, polygon) in scene.polygons.iter().enumerate().filter(|(_, polygon)| !polygon.is_back) {
            let ([a, b, c, d], count) = scene.corner_positions(polygon);
            let fan = [[a, b, c], [a, c, d]];
            triangles.extend(fan.into_iter().take(count - 2).map(|corners| (corners, index as u32)));
        }
        Self::of_triangles(&triangles)
    }

    /// Builds the BVH over triangles, anticlockwise from their bright side, each of which is told as a polygon of that number when a ray
    /// meets it.
    pub fn of_triangles(faces: &[([Vec3; 3], u32)]) -> Self {
        let corners = faces.iter().flat_map(|(corners, _)| corners);
        let extent = corners.fold(0.0_f32, |extent, corner| extent.max(corner.abs().max_element()));
        let scale =
            if extent > 0.0 && extent.is_finite() { SIZE_IN_BVH * (-extent.log2().floor()).exp2() } else { 1.0 };
        let scaled = |([a, b, c], _): &([Vec3; 3], u32)| {
            let [v0, v1, v2] = [a, b, c].map(|corner| Vec3A::from(scale * *corner));
            Triangle { v0, v1, v2 }
        };
        let triangles: Vec<Triangle> = faces.iter().map(scaled).collect();
        // The plain presets lose a factor of 5 in ray speed on large scenes.
        let params = BvhBuildParams {
            search_depth_threshold: 0,
            reinsertion_batch_ratio: 0.5,
            ..BvhBuildParams::medium_build()
        };
        let bvh = build_cwbvh_from_tris(&triangles, params, &mut Duration::default());
        let reorder = |index: &u32| *index as usize;
        let polygon_of_triangle = bvh.primitive_indices.iter().map(reorder).map(|index| faces[index].1).collect();
        let triangles = bvh.primitive_indices.iter().map(reorder).map(|index| triangles[index]).collect();
        Self { bvh, triangles, polygon_of_triangle, scale }
    }

    /// How far from a face a ray must start so as not to meet it, in the scene's length unit.
    pub fn least_distance(&self) -> f32 {
        LEAST_DISTANCE / self.scale
    }

    /// Whether a face stops the light between two points, their own surfaces aside.
    #[inline]
    pub fn occluded(&self, from: Vec3, to: Vec3) -> bool {
        if self.triangles.is_empty() {
            return false;
        }
        let from = Vec3A::from(self.scale * from);
        let span = Vec3A::from(self.scale * to) - from;
        let length = span.length();
        if length <= 0.0 {
            return false;
        }
        let offset = RELATIVE_OFFSET * length;
        let ray = Ray::new(from, without_negative_zeros(span / length), offset, length - offset);
        !self.bvh.ray_traverse_miss(ray, |ray, index| self.triangles[index].intersect(ray))
    }

    /// Whether a face stops the light between two points of faces with these unit normals, each of which is bright on the side of the other.
    ///
    /// A point of a face lies on either side of it, by rounding, and the ray of a near point that lies behind would meet the face
    /// under a small angle: the inside of a lamp's shade would be in its own shadow. So both ends are lifted off their faces.
    #[inline]
    pub fn occluded_above(&self, from: (Vec3, Vec3), to: (Vec3, Vec3)) -> bool {
        let lift = self.least_distance();
        self.occluded(from.0 + lift * from.1, to.0 + lift * to.1)
    }

    /// The first face along a ray, at least `nearest` away; `direction` must be a unit vector.
    pub fn closest_hit(&self, origin: Vec3, direction: Vec3, nearest: f32) -> Option<Hit> {
        self.closest(origin, direction, nearest, |triangle, ray| triangle.intersect(ray))
    }

    /// The first bright side along a ray, as a picture shows it: backs are looked through.
    pub fn closest_front(&self, origin: Vec3, direction: Vec3, nearest: f32) -> Option<Hit> {
        self.closest(origin, direction, nearest, |triangle, ray| match triangle.compute_normal().dot(ray.direction) {
            ..0.0 => triangle.intersect(ray),
            _ => f32::INFINITY,
        })
    }

    #[inline]
    fn closest(
        &self,
        origin: Vec3,
        direction: Vec3,
        nearest: f32,
        meet: impl Fn(&Triangle, &Ray) -> f32,
    ) -> Option<Hit> {
        if self.triangles.is_empty() {
            return None;
        }
        let origin = self.scale * origin;
        let nearest = self.scale * nearest;
        let ray = Ray::new(origin.into(), without_negative_zeros(direction.into()), nearest, f32::INFINITY);
        let mut hit = RayHit::none();
        let found = self.bvh.ray_traverse(ray, &mut hit, |ray, index| meet(&self.triangles[index], ray));
        found.then(|| {
            let index = hit.primitive_id as usize;
            let front = self.triangles[index].compute_normal().dot(direction.into()) < 0.0;
            Hit { distance: hit.t / self.scale, polygon: self.polygon_of_triangle[index], front }
        })
    }
}

/// A ray along an axis whose other components are −0 misses every face in obvhs: its octant does not fit its inverse.
fn without_negative_zeros(direction: Vec3A) -> Vec3A {
    direction + Vec3A::ZERO
}

#[cfg(test)]
mod tests {
    use std::f32::consts::TAU;

    use super::*;
    use crate::random::{even_point, mix};

    /// Truth: the inside of a convex shade sees all of itself. It is tilted and stands off the origin, so that rounding puts points on
    /// either side of their faces.
    #[test]
    fn no_face_is_in_its_own_shadow() {
        let centre = Vec3::new(-1.43, 1.13, -1.84);
        let axis = Vec3::new(0.3, 0.8, -0.2).normalize();
        let (across, along) = axis.any_orthonormal_pair();
        let rim = |number: u32, radius: f32, height: f32| {
            let (sine, cosine) = (TAU * number as f32 / 16.0).sin_cos();
            centre + height * axis + radius * (cosine * across + sine * along)
        };
        let wall = |number: u32| {
            let (low, high) = ([0, 1].map(|n| rim(number + n, 0.09, 0.0)), [0, 1].map(|n| rim(number + n, 0.03, 0.12)));
            [[low[0], high[0], low[1]], [low[1], high[0], high[1]]]
        };
        let faces: Vec<([Vec3; 3], u32)> = (0..16).flat_map(|number| wall(number).map(|face| (face, number))).collect();
        let occluders = Occluders::of_triangles(&faces);
        let point = |seed: u64, index: u32| {
            let ([a, b, c], _) = faces[mix(seed, index.into()) as usize % faces.len()];
            let [u, v] = even_point(seed, index).map(|number| 0.5 * number);
            let inward = (b - a).cross(c - a).normalize();
            let towards_axis = inward.dot(centre + 0.06 * axis - a).signum();
            (a + u * (b - a) + v * (c - a), towards_axis * inward)
        };
        let blocked = |is_blocked: &dyn Fn((Vec3, Vec3), (Vec3, Vec3)) -> bool| {
            let pairs = (0..20_000).map(|index| (point(1, index), point(2, index)));
            let facing = pairs.filter(|(from, to)| {
                let span = to.0 - from.0;
                from.1.dot(span) > 1e-4 && -to.1.dot(span) > 1e-4
            });
            facing.filter(|(from, to)| is_blocked(*from, *to)).count()
        };
        assert_eq!(blocked(&|from, to| occluders.occluded_above(from, to)), 0);
        assert!(blocked(&|from, to| occluders.occluded(from.0, to.0)) > 0, "a test that rounding cannot fail");
    }
}
