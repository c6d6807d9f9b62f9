//! Rays against triangles in double precision, watertight: a ray meets one of two triangles that
//! share an edge, or both, never neither \[Woop, Benthin, Wald, *Watertight Ray/Triangle
//! Intersection*, JCGT 2(1), 2013\].
//!
//! Corners are single-precision numbers and so are exact here; what is computed of them is off by
//! some 10⁻¹⁵ of the scene.

use glam::{DVec3, Vec3};

/// A ray with what its tests share.
#[derive(Clone, Copy, Debug)]
pub struct Ray {
    /// Where it begins.
    pub origin: DVec3,
    /// Unit direction.
    pub direction: DVec3,
    /// The axes of the sheared space, the longest component of the direction last.
    axes: [usize; 3],
    /// Factors that shear the direction onto the last axis and make it one unit long.
    shear: [f64; 3],
}

/// Where a ray meets a triangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Meeting {
    /// Distance from the origin.
    pub distance: f64,
    /// Barycentric weights of the corners; they sum to 1.
    pub weights: [f64; 3],
    /// Whether the corners run anticlockwise as seen from the origin.
    pub is_front: bool,
}

impl Ray {
    /// A ray along a unit vector.
    pub fn new(origin: DVec3, direction: DVec3) -> Self {
        let size = direction.abs();
        let last = if size.x > size.y && size.x > size.z {
            0
        } else if size.y > size.z {
            1
        } else {
            2
        };
        let (mut first, mut second) = ((last + 1) % 3, (last + 2) % 3);
        if direction[last] < 0.0 {
            // Keeps the winding.
            (first, second) = (second, first);
        }
        let along = direction[last];
        let shear = [direction[first] / along, direction[second] / along, 1.0 / along];
        Self { origin, direction, axes: [first, second, last], shear }
    }

    /// Where it meets a triangle, edges included, from either side; also behind its origin.
    #[inline]
    pub fn meet(&self, corners: &[Vec3; 3]) -> Option<Meeting> {
        let [first, second, last] = self.axes;
        let sheared = |corner: &Vec3| {
            let height = f64::from(corner[last]) - self.origin[last];
            let x = f64::from(corner[first]) - self.origin[first] - self.shear[0] * height;
            let y = f64::from(corner[second]) - self.origin[second] - self.shear[1] * height;
            (x, y, height)
        };
        let [a, b, c] = [sheared(&corners[0]), sheared(&corners[1]), sheared(&corners[2])];
        // Twice the areas opposite the corners: an edge gives both of its triangles the same number
        // with another sign.
        let u = c.0 * b.1 - c.1 * b.0;
        let v = a.0 * c.1 - a.1 * c.0;
        let w = b.0 * a.1 - b.1 * a.0;
        if (u < 0.0 || v < 0.0 || w < 0.0) && (u > 0.0 || v > 0.0 || w > 0.0) {
            return None;
        }
        let sum = u + v + w;
        if sum == 0.0 {
            return None;
        }
        let weights = [u / sum, v / sum, w / sum];
        let distance = self.shear[2] * (weights[0] * a.2 + weights[1] * b.2 + weights[2] * c.2);
        Some(Meeting { distance, weights, is_front: sum > 0.0 })
    }
}

/// The point of a triangle with these weights.
#[inline]
pub fn point_of(corners: &[Vec3; 3], weights: [f64; 3]) -> DVec3 {
    let [a, b, c] = corners.map(|corner| corner.as_dvec3());
    weights[0] * a + weights[1] * b + weights[2] * c
}
