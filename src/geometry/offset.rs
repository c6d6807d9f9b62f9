//! Offsets: how a ray leaves a face without meeting it again.
//!
//! A straight line that leaves a plane never comes back to it. So the origin of a ray is not lifted by some distance, which would have
//! to be larger than any rounding and smaller than any gap: the ray passes over the faces in whose plane it starts. Those
//! are the face itself, its twin that is bright on the other side, and neighbours in the same plane. Whether a plane holds a point is
//! told by a bound on the rounding of both, coordinate by coordinate \[Pharr, Jakob, Humphreys: PBRT 4, section 6.8\].

use glam::Vec3A;
use obvhs::triangle::Triangle;

/// Roundings that a point of a face and the plane of a triangle may have gone through. A corner is rounded once, a point made of
/// corners seven times (PBRT 4, equation 6.23), the height of a point above a plane three times; that they hardly ever add up leaves
/// room for the corners of a twin that is cut otherwise. The smallest number without a fault in the tests below is 3.
const ROUNDINGS: f32 = 8.0;

/// Faces whose normals have at least this cosine (2.6°) run alike: over the distances at which planes meet here, they are one.
const PARALLEL: f32 = 0.999;

/// The bound γ(n) = nε/(1 − nε) on the relative error of n roundings.
fn gamma(roundings: f32) -> f32 {
    let unit = 0.5 * f32::EPSILON;
    roundings * unit / (1.0 - roundings * unit)
}

/// Where a line meets a triangle (Möller and Trumbore, JGT 2(1), 1997).
#[derive(Clone, Copy)]
pub(super) struct Crossing {
    /// Distance from the line's origin, in lengths of its direction; may be negative.
    pub distance: f32,
    /// Twice the triangle's area vector.
    pub across: Vec3A,
    /// `across` times the direction: negative where the line meets the side that the winding shows.
    pub descent: f32,
    /// Weights of the second and third corner.
    pub weights: [f32; 2],
}

impl Crossing {
    /// Where a line from `origin` along `direction` meets a triangle, edges included.
    #[inline]
    pub fn of(triangle: &Triangle, origin: Vec3A, direction: Vec3A) -> Option<Self> {
        let (first, last) = (triangle.v0 - triangle.v1, triangle.v2 - triangle.v0);
        let across = first.cross(last);
        let to_corner = triangle.v0 - origin;
        let turned = direction.cross(to_corner);
        let descent = -across.dot(direction);
        let inverse = -1.0 / descent;
        let (u, v) = (turned.dot(last) * inverse, turned.dot(first) * inverse);
        // What is not a number fails here.
        (u >= 0.0 && v >= 0.0 && 1.0 - u - v >= 0.0).then(|| Self {
            distance: across.dot(to_corner) * inverse,
            across: -across,
            descent,
            weights: [u, v],
        })
    }

    /// How far rounding may set the point met from where the planes of coincident faces are met, in lengths of the direction; `slack`
    /// as in [`End::holds`].
    pub fn tolerance(&self, triangle: &Triangle, origin: Vec3A, slack: f32) -> f32 {
        self.rounding(triangle, origin, slack) / self.descent.abs()
    }

    /// Whether two triangles are turned against each other.
    pub fn is_opposite(&self, other: &Self) -> bool {
        -self.across.dot(other.across) >= PARALLEL * self.across.length() * other.across.length()
    }

    /// Bound on the error of a point's height above the triangle's plane, times the length of `across`.
    fn rounding(&self, triangle: &Triangle, point: Vec3A, slack: f32) -> f32 {
        let (first, last) = ((triangle.v0 - triangle.v1).abs(), (triangle.v2 - triangle.v0).abs());
        // The cross product with every sign positive: an axis along which the triangle has no extent adds nothing.
        let most = Vec3A::new(
            first.y * last.z + first.z * last.y,
            first.z * last.x + first.x * last.z,
            first.x * last.y + first.y * last.x,
        );
        gamma(ROUNDINGS) * most.dot(point.abs() + triangle.v0.abs()) + slack * self.across.length()
    }
}

/// An end of a ray on a face.
#[derive(Clone, Copy)]
pub(super) struct End {
    /// Position.
    pub point: Vec3A,
    /// Unit normal of the face.
    pub normal: Vec3A,
    /// Unit vector along the ray, away from the face.
    pub away: Vec3A,
}

impl End {
    /// Whether the ray is past a triangle that it crosses, because its end lies in the triangle's plane: where they run alike, and where
    /// the end lies on the rim of another face, which it leaves on the bright side. `slack` is how far points of the triangle's polygon
    /// may lie off its plane, beyond rounding.
    #[inline]
    pub fn holds(&self, triangle: &Triangle, crossing: &Crossing, slack: f32) -> bool {
        let height = crossing.across.dot(self.point - triangle.v0).abs();
        if height > crossing.rounding(triangle, self.point, slack) {
            return false;
        }
        let runs_alike = crossing.across.dot(self.normal).abs() >= PARALLEL * crossing.across.length();
        runs_alike || crossing.across.dot(self.away) > 0.0
    }
}
