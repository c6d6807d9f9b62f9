//! Four boxes or four triangles at once, and the ray that is tested against them.

use glam::{Vec3A, Vec4};

use crate::geometry::offset::{Triangle, WIDEST};

/// Boxes of a node, triangles of a leaf.
pub const LANES: usize = 4;
/// Rounding may set the far side of a box nearer by this share of its distance: 1 + 2γ(3) \[Ize:
/// *Robust BVH ray traversal*, JCGT 2(2), 2013\], and some more.
const FARTHER: f32 = 1.0 + 4.0 * f32::EPSILON;

/// Four boxes with what they hold.
#[derive(Clone, Copy)]
#[repr(align(16))]
pub struct Node {
    /// Least and largest coordinates of the boxes along each axis, m.
    pub bounds: [[Vec4; 3]; 2],
    /// A node, or a leaf with `LEAF`.
    pub children: [u32; LANES],
}

/// Up to four triangles, as `Triangle` has them.
#[derive(Clone, Copy)]
#[repr(align(16))]
pub struct Leaf {
    corner: [Vec4; 3],
    first: [Vec4; 3],
    last: [Vec4; 3],
    /// Number of the first triangle in the order of the tree.
    pub start: u32,
}

/// A ray, with each number four times.
pub struct Lines {
    origin: [Vec4; 3],
    direction: [Vec4; 3],
    inverse: [Vec4; 3],
    /// Along each axis the bound that the ray meets first: 0 for the least.
    nearer: [usize; 3],
}

impl Node {
    /// Boxes that hold nothing.
    pub const EMPTY: Self =
        Self { bounds: [[Vec4::INFINITY; 3], [Vec4::NEG_INFINITY; 3]], children: [u32::MAX; LANES] };

    /// Distances to the boxes, and a bit for each that the line meets before the limit.
    #[inline]
    pub fn meet(&self, lines: &Lines, limit: f32) -> ([f32; LANES], u32) {
        let mut near = Vec4::ZERO;
        let mut far = Vec4::splat(limit);
        for axis in 0..3 {
            let nearer = lines.nearer[axis] & 1;
            let to = |bound: usize| (self.bounds[bound][axis] - lines.origin[axis]) * lines.inverse[axis];
            // A line in the plane of a side is at no distance from it; both functions pass over
            // what is no number.
            near = to(nearer).max(near);
            far = (to(1 - nearer) * FARTHER).min(far);
        }
        (near.to_array(), near.cmple(far).bitmask())
    }
}

impl Leaf {
    /// Without triangles, the first of which has this number.
    pub fn starting_at(start: u32) -> Self {
        Self { corner: [Vec4::ZERO; 3], first: [Vec4::ZERO; 3], last: [Vec4::ZERO; 3], start }
    }

    pub fn set(&mut self, lane: usize, triangle: &Triangle) {
        for axis in 0..3 {
            self.corner[axis][lane] = triangle.corner[axis];
            self.first[axis][lane] = triangle.first[axis];
            self.last[axis][lane] = triangle.last[axis];
        }
    }

    pub fn triangle(&self, lane: usize) -> Triangle {
        let of = |sides: &[Vec4; 3]| Vec3A::from_array(sides.map(|side| side[lane]));
        Triangle { corner: of(&self.corner), first: of(&self.first), last: of(&self.last) }
    }

    /// A bit for each triangle that `Crossing::of` may find the line to cross between 0 and the
    /// limit: the same sums in the same order, with the widest rim that it may give a triangle.
    #[inline]
    pub fn meet(&self, lines: &Lines, limit: f32) -> u32 {
        let across = cross(&self.first, &self.last);
        let to_corner = [0, 1, 2].map(|axis| self.corner[axis] - lines.origin[axis]);
        let turned = cross(&lines.direction, &to_corner);
        let inverse = Vec4::ONE / dot(&across, &lines.direction);
        let (u, v) = (dot(&turned, &self.last) * inverse, dot(&turned, &self.first) * inverse);
        let inside = u.min(v).min(Vec4::ONE - u - v);
        let distance = dot(&across, &to_corner) * inverse;
        // None of these holds for what is no number, as in lanes without a triangle.
        inside.cmpge(Vec4::splat(-WIDEST)).bitmask()
            & distance.cmpge(Vec4::ZERO).bitmask()
            & distance.cmple(Vec4::splat(limit)).bitmask()
    }
}

#[inline]
fn cross(a: &[Vec4; 3], b: &[Vec4; 3]) -> [Vec4; 3] {
    [a[1] * b[2] - b[1] * a[2], a[2] * b[0] - b[2] * a[0], a[0] * b[1] - b[0] * a[1]]
}

#[inline]
fn dot(a: &[Vec4; 3], b: &[Vec4; 3]) -> Vec4 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

impl Lines {
    #[inline]
    pub fn new(origin: Vec3A, direction: Vec3A) -> Self {
        let splat = |of: Vec3A| of.to_array().map(Vec4::splat);
        Self {
            origin: splat(origin),
            direction: splat(direction),
            inverse: splat(direction.recip()),
            nearer: direction.to_array().map(|along| usize::from(along < 0.0)),
        }
    }
}

/// The bits of a mask that are set, from the lowest.
#[inline]
pub fn lanes(mut mask: u32) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        let lane = mask.trailing_zeros() as usize;
        mask &= mask.wrapping_sub(1);
        (lane < LANES).then_some(lane)
    })
}
