//! The reference's own tree of boxes over triangles: binary, cut by the surface-area heuristic over
//! bins \[Wald, *On fast construction of SAH-based bounding volume hierarchies*, 2007\], then
//! collapsed into nodes of four children.
//!
//! Boxes are single-precision numbers and so much larger than what they hold that no rounding loses
//! a triangle.

use glam::Vec3;

use super::triangle::Ray;

/// Children of a node: as many boxes are tested at once.
const WIDTH: usize = 4;
/// Bins along the axis that is cut.
const BINS: usize = 16;
/// Triangles of a leaf that is not worth a cut.
const LEAF: usize = 4;
/// Cost of a triangle beside that of a box.
const TRIANGLE_COST: f32 = 1.5;
/// Below this depth ranges are halved by number, which bounds the depth.
const DEEPEST_CUT: usize = 32;
/// Nodes that can wait: three of each level, of which there are at most [`DEEPEST_CUT`] and the 32
/// of halving.
const STACK: usize = 3 * (DEEPEST_CUT + 32);
/// Boxes are larger than what they hold by this share of the scene's largest coordinate M. Rounding
/// the origin of a ray moves it by 2⁻²⁴ M; three roundings of a distance of at most 2 M amount to
/// 6·2⁻²⁴ M.
const PADDING: f32 = 8.0 / 16_777_216.0;

/// The tree; triangles are those that it was built of, in [`Bvh::order`].
#[derive(Debug)]
pub struct Bvh {
    nodes: Vec<Node>,
    /// The triangles in the order of the leaves, by their numbers.
    pub order: Vec<u32>,
    /// The largest coordinate of any corner.
    pub extent: f32,
}

/// Boxes of four children, axis by axis; those that are not there are empty.
#[derive(Clone, Copy, Debug)]
struct Node {
    lower: [[f32; WIDTH]; 3],
    upper: [[f32; WIDTH]; 3],
    child: [Child; WIDTH],
}

/// Content of a box: the first triangle of a leaf and how many there are, or a node and 0. Packed,
/// for what waits is much of a ray's work.
#[derive(Clone, Copy, Debug, Default)]
struct Child(u32);

impl Child {
    const COUNT_BITS: u32 = 3;

    fn new(first: u32, count: u32) -> Self {
        debug_assert!(count <= LEAF as u32 && first < 1 << (32 - Self::COUNT_BITS), "it fits into 32 bits");
        Self(first << Self::COUNT_BITS | count)
    }

    fn first(self) -> usize {
        (self.0 >> Self::COUNT_BITS) as usize
    }

    fn count(self) -> usize {
        (self.0 & ((1 << Self::COUNT_BITS) - 1)) as usize
    }
}

/// A box around things.
#[derive(Clone, Copy, Debug)]
struct Bounds {
    lower: Vec3,
    upper: Vec3,
}

/// A node of the binary tree.
enum Branch {
    Leaf { bounds: Bounds, first: u32, count: u32 },
    Fork { bounds: Bounds, halves: Box<[Branch; 2]> },
}

impl Bounds {
    const NONE: Self = Self { lower: Vec3::INFINITY, upper: Vec3::NEG_INFINITY };

    fn with(self, other: Self) -> Self {
        Self { lower: self.lower.min(other.lower), upper: self.upper.max(other.upper) }
    }

    fn of(corners: &[Vec3; 3]) -> Self {
        let [a, b, c] = *corners;
        Self { lower: a.min(b).min(c), upper: a.max(b).max(c) }
    }

    /// Half of its surface.
    fn surface(&self) -> f32 {
        let Vec3 { x, y, z } = (self.upper - self.lower).max(Vec3::ZERO);
        x * y + y * z + z * x
    }

    fn centre(&self) -> Vec3 {
        0.5 * self.lower + 0.5 * self.upper
    }
}

impl Branch {
    fn bounds(&self) -> &Bounds {
        match self {
            Self::Leaf { bounds, .. } | Self::Fork { bounds, .. } => bounds,
        }
    }
}

impl Bvh {
    /// The tree over these triangles.
    pub fn new(triangles: &[[Vec3; 3]]) -> Self {
        let bounds: Vec<Bounds> = triangles.iter().map(Bounds::of).collect();
        let corners = triangles.iter().flatten();
        let extent = corners.fold(0.0_f32, |extent, corner| extent.max(corner.abs().max_element()));
        let mut order: Vec<u32> = (0..triangles.len() as u32).collect();
        let mut bvh = Self { nodes: Vec::new(), order: Vec::new(), extent };
        if !order.is_empty() {
            let root = branch(&bounds, &mut order, 0, 0);
            bvh.nodes.reserve(triangles.len() / 2);
            bvh.collapse(root);
        }
        bvh.order = order;
        bvh
    }

    /// Adds the node of a branch and of all below; returns its number.
    fn collapse(&mut self, root: Branch) -> u32 {
        let padding = Vec3::splat(PADDING * self.extent);
        let mut children = match root {
            Branch::Fork { halves, .. } => Vec::from(*halves as [Branch; 2]),
            leaf @ Branch::Leaf { .. } => vec![leaf],
        };
        while children.len() < WIDTH {
            let surface = |child: &Branch| match child {
                Branch::Leaf { .. } => -1.0,
                Branch::Fork { bounds, .. } => bounds.surface(),
            };
            let largest = (0..children.len()).max_by(|a, b| surface(&children[*a]).total_cmp(&surface(&children[*b])));
            let Some(largest) = largest.filter(|index| matches!(children[*index], Branch::Fork { .. })) else { break };
            if let Branch::Fork { halves, .. } = children.swap_remove(largest) {
                children.extend(*halves);
            }
        }
        let index = self.nodes.len();
        let empty = ([[f32::INFINITY; WIDTH]; 3], [[f32::NEG_INFINITY; WIDTH]; 3]);
        self.nodes.push(Node { lower: empty.0, upper: empty.1, child: [Child::default(); WIDTH] });
        for (slot, child) in children.into_iter().enumerate() {
            let (lower, upper) = (child.bounds().lower - padding, child.bounds().upper + padding);
            let child = match child {
                Branch::Leaf { first, count, .. } => Child::new(first, count),
                fork @ Branch::Fork { .. } => Child::new(self.collapse(fork), 0),
            };
            let node = &mut self.nodes[index];
            for axis in 0..3 {
                (node.lower[axis][slot], node.upper[axis][slot]) = (lower[axis], upper[axis]);
            }
            node.child[slot] = child;
        }
        index as u32
    }

    /// Goes through the leaves that a ray may meet no farther than `limit`, near ones first. `look`
    /// is given ranges of [`Bvh::order`] and says how far to look from then on; a negative number
    /// ends it. The ray begins within the scene's box.
    #[inline]
    pub fn visit(&self, ray: &Ray, limit: f64, mut look: impl FnMut(std::ops::Range<usize>) -> f64) {
        if self.nodes.is_empty() {
            return;
        }
        let origin = ray.origin.as_vec3().to_array();
        let inverse = ray.direction.to_array().map(|component| (1.0 / component) as f32);
        let mut farthest = above(limit);
        let mut stack = [(0.0_f32, Child::default()); STACK];
        let mut waiting = 1;
        while waiting > 0 {
            waiting -= 1;
            let (nearest, child) = stack[waiting];
            if nearest > farthest {
                continue;
            }
            if child.count() > 0 {
                let limit = look(child.first()..child.first() + child.count());
                if limit < 0.0 {
                    return;
                }
                farthest = above(limit);
                continue;
            }
            let node = &self.nodes[child.first()];
            let (near, far) = node.slabs(&origin, &inverse);
            let begin = waiting;
            for slot in 0..WIDTH {
                if near[slot] <= far[slot] && near[slot] <= farthest && far[slot] >= 0.0 {
                    // Kept in order, the nearest on top.
                    let mut place = waiting;
                    while place > begin && stack[place - 1].0 < near[slot] {
                        stack[place] = stack[place - 1];
                        place -= 1;
                    }
                    stack[place] = (near[slot], node.child[slot]);
                    waiting += 1;
                }
            }
        }
    }
}

impl Node {
    /// Where a ray enters and leaves each box.
    #[inline]
    fn slabs(&self, origin: &[f32; 3], inverse: &[f32; 3]) -> ([f32; WIDTH], [f32; WIDTH]) {
        let (mut near, mut far) = ([f32::NEG_INFINITY; WIDTH], [f32::INFINITY; WIDTH]);
        for axis in 0..3 {
            let (enter, leave) = if inverse[axis].is_sign_positive() {
                (&self.lower[axis], &self.upper[axis])
            } else {
                (&self.upper[axis], &self.lower[axis])
            };
            for slot in 0..WIDTH {
                let (entered, left) =
                    ((enter[slot] - origin[axis]) * inverse[axis], (leave[slot] - origin[axis]) * inverse[axis]);
                // 0 · ∞ says nothing: such a number changes neither.
                near[slot] = if entered > near[slot] { entered } else { near[slot] };
                far[slot] = if left < far[slot] { left } else { far[slot] };
            }
        }
        (near, far)
    }
}

/// A single-precision number that is not below this one.
fn above(value: f64) -> f32 {
    (value as f32) * (1.0 + 2.0 * f32::EPSILON)
}

/// The branch over the triangles in `order`, which it sorts; the first of them is number `offset`.
fn branch(bounds: &[Bounds], order: &mut [u32], offset: u32, depth: usize) -> Branch {
    let around = |part: &[u32]| part.iter().fold(Bounds::NONE, |all, triangle| all.with(bounds[*triangle as usize]));
    let all = around(order);
    let count = order.len();
    let leaf = Branch::Leaf { bounds: all, first: offset, count: count as u32 };
    if count == 1 {
        return leaf;
    }
    let middle = if depth < DEEPEST_CUT {
        match cut(bounds, order, all.surface()) {
            Some(cut) => cut,
            None if count <= LEAF => return leaf,
            None => count / 2,
        }
    } else {
        count / 2
    };
    let (left, right) = order.split_at_mut(middle);
    let halves = [branch(bounds, left, offset, depth + 1), branch(bounds, right, offset + middle as u32, depth + 1)];
    Branch::Fork { bounds: all, halves: Box::new(halves) }
}

/// Sorts triangles to either side of the best cut and says how many are on the first; `None` where
/// none is worth it.
fn cut(bounds: &[Bounds], order: &mut [u32], surface: f32) -> Option<usize> {
    let centres = order.iter().fold(Bounds::NONE, |all, triangle| {
        let centre = bounds[*triangle as usize].centre();
        all.with(Bounds { lower: centre, upper: centre })
    });
    let size = centres.upper - centres.lower;
    let bin_of = |triangle: u32, axis: usize| {
        let share = (bounds[triangle as usize].centre()[axis] - centres.lower[axis]) / size[axis];
        ((share * BINS as f32) as usize).min(BINS - 1)
    };
    let mut best: Option<(f32, usize, usize)> = None;
    for axis in (0..3).filter(|axis| size[*axis] > 0.0) {
        let mut bins = [(Bounds::NONE, 0_usize); BINS];
        for &triangle in order.iter() {
            let bin = &mut bins[bin_of(triangle, axis)];
            *bin = (bin.0.with(bounds[triangle as usize]), bin.1 + 1);
        }
        let mut right = [(Bounds::NONE, 0_usize); BINS + 1];
        for index in (0..BINS).rev() {
            right[index] = (right[index + 1].0.with(bins[index].0), right[index + 1].1 + bins[index].1);
        }
        let mut left = (Bounds::NONE, 0_usize);
        for index in 1..BINS {
            left = (left.0.with(bins[index - 1].0), left.1 + bins[index - 1].1);
            if left.1 == 0 || right[index].1 == 0 {
                continue;
            }
            let cost = left.0.surface() * left.1 as f32 + right[index].0.surface() * right[index].1 as f32;
            if best.is_none_or(|(least, ..)| cost < least) {
                best = Some((cost, axis, index));
            }
        }
    }
    let (cost, axis, border) = best?;
    let whole = TRIANGLE_COST * order.len() as f32 * surface;
    if order.len() <= LEAF && surface + TRIANGLE_COST * cost >= whole {
        return None;
    }
    // Stable, so that the tree depends on the order of the triangles alone.
    let (mut left, mut right) = (Vec::with_capacity(order.len()), Vec::new());
    for &triangle in order.iter() {
        if bin_of(triangle, axis) < border { left.push(triangle) } else { right.push(triangle) }
    }
    let middle = left.len();
    left.extend(right);
    order.copy_from_slice(&left);
    Some(middle)
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;
    use crate::measure::reference::sequence::hash64;

    /// Numbers in −1..1.
    struct Random(u64);

    impl Random {
        fn number(&mut self) -> f64 {
            self.0 += 1;
            2.0 * (hash64(17, self.0) >> 11) as f64 / (1_u64 << 53) as f64 - 1.0
        }

        fn vector(&mut self) -> DVec3 {
            DVec3::new(self.number(), self.number(), self.number())
        }
    }

    /// Everything that a ray meets ahead of its origin, by distance and number.
    fn all_met(triangles: &[[Vec3; 3]], numbers: impl Iterator<Item = usize>, ray: &Ray) -> Vec<(u64, usize)> {
        let met = numbers.filter_map(|number| Some((ray.meet(&triangles[number])?.distance, number)));
        let mut met: Vec<(u64, usize)> = met
            .filter(|(distance, _)| *distance >= 0.0)
            .map(|(distance, number)| (distance.to_bits(), number))
            .collect();
        met.sort_unstable();
        met
    }

    fn by_tree(bvh: &Bvh, triangles: &[[Vec3; 3]], ray: &Ray) -> Vec<(u64, usize)> {
        let mut looked_at = Vec::new();
        bvh.visit(ray, f64::INFINITY, |range| {
            looked_at.extend(bvh.order[range].iter().map(|number| *number as usize));
            f64::INFINITY
        });
        all_met(triangles, looked_at.into_iter(), ray)
    }

    /// Truth: a plain loop over all triangles. Random ones, needles and flat ones among them, in
    /// scenes of 10⁻⁴ to 10⁴ m about the origin and beside it; rays at random, along the axes,
    /// along edges and through corners.
    #[test]
    fn every_meeting_of_a_plain_loop_is_found() {
        let mut random = Random(0);
        let mut count = 0;
        for (scale, beside) in [(1.0, 0.0), (1e-4, 0.0), (1e4, 0.0), (1.0, 3000.0), (1e-2, -1.0)] {
            let mut corner =
                |size: f64, around: DVec3| (scale * (around + size * random.vector()) + DVec3::splat(beside)).as_vec3();
            let mut around = Random(9);
            let triangles: Vec<[Vec3; 3]> = (0..300)
                .map(|index| {
                    let (size, place) = (if index % 10 == 0 { 1.0 } else { 0.1 }, around.vector());
                    let mut triangle = [0, 1, 2].map(|_| corner(size, place));
                    if index % 3 == 0 {
                        // Level: its box has no height.
                        triangle[1].y = triangle[0].y;
                        triangle[2].y = triangle[0].y;
                    }
                    triangle
                })
                .collect();
            let bvh = Bvh::new(&triangles);
            for index in 0..600_usize {
                let target = triangles[index % triangles.len()];
                let origin = triangles[(7 * index + 3) % triangles.len()][index % 3].as_dvec3();
                let to = match index % 4 {
                    0 => target[0].as_dvec3(),
                    1 => target[1].as_dvec3().midpoint(target[2].as_dvec3()),
                    _ => target[0].as_dvec3() + scale * 0.02 * around.vector(),
                };
                let direction = match index % 7 {
                    0 => DVec3::X,
                    1 => DVec3::NEG_Y,
                    _ => (to - origin).normalize_or(DVec3::Z),
                };
                let ray = Ray::new(origin, direction);
                let plain = all_met(&triangles, 0..triangles.len(), &ray);
                count += plain.len();
                assert_eq!(by_tree(&bvh, &triangles, &ray), plain, "scale {scale}, ray {index}: {ray:?}");
            }
        }
        assert!(count > 5_000, "{count} meetings");
    }

    /// Truth: topology. A closed surface lets no ray out, through edges and corners neither: rays
    /// from inside a ball of 320 triangles at its corners and at the middles of its edges.
    #[test]
    fn a_closed_surface_has_no_cracks() {
        let mut triangles: Vec<[Vec3; 3]> = Vec::new();
        for signs in 0..8 {
            let sign = |bit: usize| if signs >> bit & 1 == 0 { 1.0 } else { -1.0 };
            triangles.push([sign(0) * Vec3::X, sign(1) * Vec3::Y, sign(2) * Vec3::Z]);
        }
        for _ in 0..3 {
            let quarters = |[a, b, c]: [Vec3; 3]| {
                let middle = |p: Vec3, q: Vec3| (0.5 * (p + q)).normalize();
                // The same sum, and so the same bits, from either triangle.
                let (ab, bc, ca) = (middle(a, b), middle(b, c), middle(c, a));
                [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
            };
            triangles = triangles.into_iter().flat_map(quarters).collect();
        }
        let bvh = Bvh::new(&triangles);
        let mut random = Random(4);
        for triangle in &triangles {
            let [a, b, c] = triangle.map(|corner| corner.as_dvec3());
            for target in [a, b, c, a.midpoint(b), b.midpoint(c), c.midpoint(a), a.lerp(b, 0.3)] {
                let origin = 0.5 * random.vector();
                let ray = Ray::new(origin, (target - origin).normalize());
                assert!(!by_tree(&bvh, &triangles, &ray).is_empty(), "{origin} sees out at {target}");
            }
        }
    }

    #[test]
    fn nothing_and_equal_triangles_are_trees() {
        let ray = Ray::new(DVec3::ZERO, DVec3::Z);
        assert!(by_tree(&Bvh::new(&[]), &[], &ray).is_empty());
        let alike = vec![[Vec3::new(-1.0, -1.0, 1.0), Vec3::new(1.0, -1.0, 1.0), Vec3::new(0.0, 1.0, 1.0)]; 1000];
        assert_eq!(by_tree(&Bvh::new(&alike), &alike, &ray).len(), 1000);
    }
}
