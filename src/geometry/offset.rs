//! Offsets: how a ray leaves a face without meeting it again.
//!
//! A straight line that leaves a plane never comes back to it. So the origin of a ray is not lifted
//! by some distance, which would have to be larger than any rounding and smaller than any gap: the
//! ray passes over the faces in whose plane it starts. Those are the face itself, its twin that is
//! bright on the other side, and neighbours in the same plane. Whether a plane holds a point is
//! found by a bound on the rounding of both, coordinate by coordinate \[Pharr, Jakob, Humphreys:
//! PBRT 4, section 6.8\].

use glam::Vec3A;

/// Roundings that a point of a face and the plane of a triangle may have gone through. A corner is
/// rounded once, a point made of corners seven times (PBRT 4, equation 6.23), the height of a point
/// above a plane three times; that they hardly ever add up leaves room for the corners of a twin
/// that is cut otherwise. The smallest number without a fault in the tests below is 2.
const ROUNDINGS: f32 = 8.0;

/// A triangle is made wider by no more than this share of its size, however little a line tells of
/// it.
pub(super) const WIDEST: f32 = 1e-3;

/// Faces whose normals have at least this cosine (2.6°) run alike: over the distances at which
/// planes meet here, they are one.
const PARALLEL: f32 = 0.999;

/// The bound γ(n) = nε/(1 − nε) on the relative error of n roundings.
fn gamma(roundings: f32) -> f32 {
    let unit = 0.5 * f32::EPSILON;
    roundings * unit / (1.0 - roundings * unit)
}

/// The cross product of two vectors with every sign positive: what its roundings are shares of.
#[inline]
fn absolute_cross(a: Vec3A, b: Vec3A) -> Vec3A {
    let (a, b) = (a.abs(), b.abs());
    Vec3A::new(a.y * b.z + a.z * b.y, a.z * b.x + a.x * b.z, a.x * b.y + a.y * b.x)
}

/// A triangle by a corner and the sides that lines are tested against.
#[derive(Clone, Copy, Debug)]
pub(super) struct Triangle {
    /// The first corner.
    pub corner: Vec3A,
    /// From the second corner to the first.
    pub first: Vec3A,
    /// From the first corner to the third.
    pub last: Vec3A,
}

impl Triangle {
    /// By its corners, anticlockwise from its bright side.
    pub fn new([a, b, c]: [Vec3A; 3]) -> Self {
        Self { corner: a, first: a - b, last: c - a }
    }
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
        let Triangle { corner, first, last } = *triangle;
        let across = first.cross(last);
        let to_corner = corner - origin;
        let turned = direction.cross(to_corner);
        let descent = -across.dot(direction);
        let inverse = -1.0 / descent;
        let (u, v) = (turned.dot(last) * inverse, turned.dot(first) * inverse);
        let beside = -u.min(v).min(1.0 - u - v);
        // A line that runs alongside crosses nothing: its weights are infinite or no numbers.
        let is_met = inverse.is_finite()
            && (beside <= 0.0 || (beside <= WIDEST && beside <= Self::widening(triangle, origin, direction, inverse)));
        is_met.then(|| Self { distance: across.dot(to_corner) * inverse, across: -across, descent, weights: [u, v] })
    }

    /// By how much of its size a triangle is wider: rounding must leave no crack between two of
    /// them.
    #[cold]
    fn widening(triangle: &Triangle, origin: Vec3A, direction: Vec3A, inverse: f32) -> f32 {
        let sides = triangle.first.abs() + triangle.last.abs();
        gamma(ROUNDINGS) * absolute_cross(direction, triangle.corner - origin).dot(sides) * inverse.abs()
    }

    /// How far rounding may set the point met from where the planes of coincident faces are met, in
    /// lengths of the direction; `slack` as in [`End::holds`].
    pub fn tolerance(&self, triangle: &Triangle, origin: Vec3A, slack: f32) -> f32 {
        self.rounding(triangle, origin, slack) / self.descent.abs()
    }

    /// Whether two triangles are turned against each other.
    pub fn is_opposite(&self, other: &Self) -> bool {
        -self.across.dot(other.across) >= PARALLEL * self.across.length() * other.across.length()
    }

    /// Bound on the error of a point's height above the triangle's plane, times the length of
    /// `across`.
    fn rounding(&self, triangle: &Triangle, point: Vec3A, slack: f32) -> f32 {
        // An axis along which the triangle has no extent adds nothing.
        let most = absolute_cross(triangle.first, triangle.last);
        gamma(ROUNDINGS) * most.dot(point.abs() + triangle.corner.abs()) + slack * self.across.length()
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
    /// Whether the ray is past a triangle that it crosses, because its end lies in the triangle's
    /// plane: where they run alike, and where the end lies on the rim of another face, which it
    /// leaves on the bright side. `slack` is how far points of the triangle's polygon may lie off
    /// its plane, beyond rounding.
    #[inline]
    pub fn holds(&self, triangle: &Triangle, crossing: &Crossing, slack: f32) -> bool {
        let height = crossing.across.dot(self.point - triangle.corner).abs();
        if height > crossing.rounding(triangle, self.point, slack) {
            return false;
        }
        let runs_alike = crossing.across.dot(self.normal).abs() >= PARALLEL * crossing.across.length();
        runs_alike || crossing.across.dot(self.away) > 0.0
    }
}

#[cfg(test)]
mod tests {
    use glam::{Quat, Vec3};

    use super::*;
    use crate::base::random::{cosine_direction, hash64, r2_sequence};
    use crate::geometry::Occluders;

    type Face = [Vec3; 3];

    /// The triangles of a box, bright inside; each face is cut along one diagonal or the other.
    fn room(size: Vec3, other_diagonal: bool) -> Vec<Face> {
        let corner = |index: usize| Vec3::from([0, 1, 2].map(|axis| size[axis] * (((index >> axis) & 1) as f32 - 0.5)));
        let sides = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
        let cut = |[a, b, c, d]: [usize; 4]| match other_diagonal {
            true => [[a, b, d], [b, c, d]],
            false => [[a, b, c], [a, c, d]],
        };
        let inside = |face: [usize; 3]| {
            let [a, b, c] = face.map(corner);
            if (b - a).cross(c - a).dot(a) < 0.0 { [a, b, c] } else { [a, c, b] }
        };
        sides.into_iter().flat_map(cut).map(inside).collect()
    }

    fn turned(face: &Face) -> Face {
        let [a, b, c] = *face;
        [a, c, b]
    }

    fn numbered(faces: &[Face]) -> Vec<(Face, u32)> {
        faces.iter().enumerate().map(|(index, face)| (*face, index as u32)).collect()
    }

    /// A random point of a face, with its normal.
    fn point_on(face: &Face, seed: u64, index: u32) -> (Vec3, Vec3) {
        let [a, b, c] = *face;
        let [u, v] = r2_sequence(hash64(seed, 0), index);
        let (u, v) = if u + v > 1.0 { (1.0 - u, 1.0 - v) } else { (u, v) };
        (a + u * (b - a) + v * (c - a), (b - a).cross(c - a).normalize())
    }

    /// Truth: a closed room keeps its rays, whatever its size, place and turn, and whether or not
    /// its faces have twins that are bright outside and cut otherwise: each ray meets a face of the
    /// room itself, not its own, from the bright side.
    #[test]
    fn closed_rooms_keep_their_rays_at_any_size() {
        for (case, size) in [1e-4_f32, 1e-2, 1.0, 30.0, 1e4].into_iter().enumerate() {
            for turn in [Quat::IDENTITY, Quat::from_euler(glam::EulerRot::XYZ, 0.3, 1.1, -0.7)] {
                let middle = 3.0 * size * Vec3::new(0.5, -0.2, 0.3);
                let place = |face: &Face| face.map(|corner| middle + turn * corner);
                let inner: Vec<Face> = room(size * Vec3::new(1.0, 0.6, 0.8), false).iter().map(place).collect();
                let twins = room(size * Vec3::new(1.0, 0.6, 0.8), true);
                let twins = twins.iter().map(place).map(|face| turned(&face));
                for with_twins in [false, true] {
                    let outer: Vec<Face> = twins.clone().filter(|_| with_twins).collect();
                    // Twins come first, so that a tie by order would be theirs.
                    let faces = [&outer[..], &inner[..]].concat();
                    let occluders = Occluders::of_triangles(&numbered(&faces));
                    for ray in 0..4_000_u32 {
                        let seed = hash64(case as u64, ray.into());
                        let from = outer.len() + seed as usize % inner.len();
                        let (point, normal) = point_on(&faces[from], 3, ray);
                        let [u, v] = r2_sequence(hash64(5, 0), ray);
                        let hit = occluders.ray_from(point, normal, cosine_direction(normal, u, v));
                        let what = || format!("size {size}, turned {turn}, twins {with_twins}: {hit:?} from {point}");
                        let hit = hit.unwrap_or_else(|| panic!("{}", what()));
                        assert!(hit.front && hit.polygon as usize >= outer.len(), "{}", what());
                        let side = |face: usize| (face - outer.len()) / 2;
                        assert_ne!(side(hit.polygon as usize), side(from), "{}", what());
                        let (other, other_normal) = point_on(&faces[hit.polygon as usize], 7, ray);
                        assert!(occluders.sees((point, normal), (other, other_normal)), "{} to {other}", what());
                        assert!(occluders.sees((other, other_normal), (point, normal)), "{} to {other}", what());
                    }
                }
            }
        }
    }

    /// Truth: a line parallel to a face does not cross it, also where it runs along an edge, just
    /// above or below: in rooms whose rays leave along a wall, such lines are met in boxes of the
    /// BVH that are a little larger than their faces.
    #[test]
    fn lines_alongside_cross_nothing() {
        let [a, b, c, d] = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]].map(|[x, y]| Vec3A::new(x, y, 0.0));
        for [v0, v1, v2] in [[a, b, c], [a, c, d], [b, c, d], [a, b, d], [c, b, a], [d, c, a]] {
            let triangle = Triangle::new([v0, v1, v2]);
            for (from, to) in [(v0, v1), (v1, v2), (v2, v0), (v1, v0), (v2, v1), (v0, v2)] {
                let direction = (to - from).normalize();
                for beside in [-0.3, -0.1, 0.1, 0.3] {
                    for height in [-0.003, -0.001, 0.001, 0.003] {
                        let origin = from - direction + beside * direction.cross(Vec3A::Z) + height * Vec3A::Z;
                        let distance = Crossing::of(&triangle, origin, direction).map(|met| met.distance);
                        assert_eq!(distance, None, "{triangle:?}: {origin} + {direction}");
                    }
                }
            }
        }
    }

    /// Truth: a sheet 1 mm in front of a wall hides it, and a sheet 1 mm behind hides nothing; up
    /// to half a kilometre from the middle of the scene, where f32 knows 0.06 mm.
    #[test]
    fn faces_a_millimetre_apart_are_two() {
        for size in [0.1_f32, 10.0, 1e3] {
            for turn in [Quat::IDENTITY, Quat::from_euler(glam::EulerRot::XYZ, 0.3, 1.1, -0.7)] {
                let square = |height: f32| {
                    let corner = |x: f32, y: f32| turn * Vec3::new(0.5 * size * x, 0.5 * size * y, 0.5 * size + height);
                    [corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0)]
                };
                let faces = [square(0.0), turned(&square(0.001))];
                let lower = numbered(&faces);
                let normal = turn * Vec3::Z;
                let occluders = Occluders::of_triangles(&lower);
                for ray in 0..2_000 {
                    let middle = faces[0].iter().sum::<Vec3>() / 3.0;
                    let [u, v] = r2_sequence(hash64(5, 0), ray);
                    let start = middle + 0.5 * (point_on(&faces[0], 3, ray).0 - middle);
                    let direction = cosine_direction(normal, u, v);
                    let hit = occluders.ray_from(start, normal, direction);
                    // A ray that is too slanted passes by the sheet.
                    let passes = 0.001 / direction.dot(normal) > 0.1 * size;
                    assert!(passes || hit.is_some_and(|hit| hit.front && hit.polygon == 1), "{hit:?} from {start}");
                    let away = occluders.ray_from(start, -normal, -direction);
                    assert!(away.is_none(), "{away:?} behind {start}");
                }
            }
        }
    }
}
