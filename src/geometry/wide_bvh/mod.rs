//! A BVH of four boxes a node and four triangles a leaf, so that each ray tests four at once.
//!
//! obvhs builds a binary tree by its surface area; nodes take over the children of their largest
//! children until they have four \[Wald, Benthin, Boulos: *Getting rid of packets*, RT 2008\].
//! Boxes are a little too large, so that the rounding of rays leaves no crack between triangles of
//! two leaves.

mod lanes;

use std::time::Duration;

use glam::Vec3A;
use obvhs::BvhBuildParams;
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::builder::build_bvh2_from_tris;
use rayon::prelude::*;

use super::offset::Triangle;
use lanes::{LANES, Leaf, Lines, Node, lanes};

/// Marks a child that is a leaf.
const LEAF: u32 = 1 << 31;
/// Boxes are larger on each side by this share of the largest coordinate: 64 roundings of it.
const WIDER: f32 = 32.0 * f32::EPSILON;
/// Entries that wait in the traversal of all but very deep trees.
const SHORT: usize = 96;
/// Largest coordinate of the triangles that obvhs is shown: its checks of its own boxes allow for
/// 10⁻⁵.
const SIZE_IN_OBVHS: f32 = 32.0;

/// The leaf that stopped the last ray, if any: what stops one often stops the next one too.
#[derive(Clone, Copy, Debug)]
pub struct LastStop(u32);

impl Default for LastStop {
    fn default() -> Self {
        Self(u32::MAX)
    }
}

/// How much is done for the speed of rays.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Effort {
    /// A tree for many rays.
    Thorough,
    /// A tree for few rays, built in a third of the time.
    Quick,
}

/// The share of nodes put in better places at a time: half of them gives the fastest rays, and
/// above so many triangles as many nodes as there. With a tenth, of 580,000 triangles, rays are
/// slower by 5 % and the tree is built in a third of the time.
const SHARE_IMPROVED: f32 = 0.5;
const MOST_IMPROVED: f32 = 60_000.0;
/// Share of nodes that are improved where few rays are to come.
const SHARE_IMPROVED_QUICKLY: f32 = 0.02;

impl Effort {
    fn share_improved(self, triangles: usize) -> f32 {
        match self {
            Self::Thorough => SHARE_IMPROVED.min(MOST_IMPROVED / triangles.max(1) as f32),
            Self::Quick => SHARE_IMPROVED_QUICKLY,
        }
    }
}

/// The tree.
pub(super) struct WideBvh {
    nodes: Vec<Node>,
    leaves: Vec<Leaf>,
    /// Entries that may wait in a traversal.
    depth: usize,
}

impl WideBvh {
    /// Builds a tree over triangles, and tells in which order it numbers them.
    pub fn new(corners: &[[Vec3A; 3]], effort: Effort) -> (Self, Vec<u32>) {
        let extent = corners.iter().flatten().fold(0.0_f32, |extent, corner| extent.max(corner.abs().max_element()));
        let is_usable = extent > 0.0 && extent.is_finite();
        // A power of two changes no bit of what is built.
        let scale = if is_usable { SIZE_IN_OBVHS * (-extent.log2().floor()).exp2() } else { 1.0 };
        let scaled =
            |[v0, v1, v2]: &[Vec3A; 3]| obvhs::triangle::Triangle { v0: scale * *v0, v1: scale * *v1, v2: scale * *v2 };
        let triangles: Vec<_> = corners.par_iter().map(scaled).collect();
        // The plain presets lose a factor of 5 in ray speed on large scenes.
        let params = BvhBuildParams {
            search_depth_threshold: 0,
            reinsertion_batch_ratio: effort.share_improved(triangles.len()),
            post_collapse_reinsertion_batch_ratio_multiplier: 0.0,
            max_prims_per_leaf: 1,
            ..BvhBuildParams::medium_build()
        };
        let binary = build_bvh2_from_tris(&triangles, params, &mut Duration::default());
        let mut tree = Self { nodes: Vec::new(), leaves: Vec::new(), depth: 1 };
        let mut order = Vec::with_capacity(corners.len());
        if !binary.nodes.is_empty() {
            tree.widen(&binary, corners, (scale.recip(), WIDER * extent), &mut order);
        }
        (tree, order)
    }

    /// Makes nodes of a binary tree that is `unscale` times too small for the triangles; boxes grow
    /// by `wider`.
    fn widen(&mut self, binary: &Bvh2, corners: &[[Vec3A; 3]], (unscale, wider): (f32, f32), order: &mut Vec<u32>) {
        let counts = counts(binary);
        let is_leaf = |node: usize| counts[node] as usize <= LANES;
        self.nodes.push(Node::EMPTY);
        let mut waiting = vec![(0, 0, 1)];
        while let Some((from, to, depth)) = waiting.pop() {
            let (mut children, mut count) = ([from; LANES], 1);
            while count < LANES {
                let area = |child: &usize| binary.nodes[children[*child]].aabb.half_area();
                let inner = (0..count).filter(|child| !is_leaf(children[*child]));
                let Some(largest) = inner.max_by(|a, b| area(a).total_cmp(&area(b))) else { break };
                let first = binary.nodes[children[largest]].first_index as usize;
                (children[largest], children[count]) = (first, first + 1);
                count += 1;
            }
            for (lane, child) in children.into_iter().take(count).enumerate() {
                let bounds = &binary.nodes[child].aabb;
                for axis in 0..3 {
                    self.nodes[to].bounds[0][axis][lane] = unscale * bounds.min[axis] - wider;
                    self.nodes[to].bounds[1][axis][lane] = unscale * bounds.max[axis] + wider;
                }
                self.nodes[to].children[lane] = if is_leaf(child) {
                    self.add_leaf(binary, child, corners, order)
                } else {
                    waiting.push((child, self.nodes.len(), depth + 1));
                    self.nodes.push(Node::EMPTY);
                    (self.nodes.len() - 1) as u32
                };
            }
            self.depth = self.depth.max((LANES - 1) * depth + 1);
        }
    }

    fn add_leaf(&mut self, binary: &Bvh2, node: usize, corners: &[[Vec3A; 3]], order: &mut Vec<u32>) -> u32 {
        let mut leaf = Leaf::starting_at(order.len() as u32);
        let mut waiting = vec![node];
        while let Some(node) = waiting.pop() {
            let node = &binary.nodes[node];
            let first = node.first_index as usize;
            if node.prim_count == 0 {
                waiting.extend([first + 1, first]);
                continue;
            }
            for &number in &binary.primitive_indices[first..first + node.prim_count as usize] {
                leaf.set(order.len() - leaf.start as usize, &Triangle::new(corners[number as usize]));
                order.push(number);
            }
        }
        self.leaves.push(leaf);
        LEAF | (self.leaves.len() - 1) as u32
    }

    /// Memory, bytes.
    pub fn bytes(&self) -> usize {
        size_of_val(&self.nodes[..]) + size_of_val(&self.leaves[..])
    }

    /// Nodes that wait at first: the root, unless the tree or the ray is none.
    #[inline]
    fn start(&self, origin: Vec3A, direction: Vec3A) -> usize {
        usize::from(!self.nodes.is_empty() && origin.is_finite() && direction.is_finite())
    }

    /// Whether one of the triangles that the ray may cross before the limit stops it, which `stops`
    /// decides by their number. Those that stopped the last ray are looked at first.
    #[inline]
    pub fn is_stopped(
        &self,
        (origin, direction, limit): (Vec3A, Vec3A, f32),
        last: &mut LastStop,
        mut stops: impl FnMut(&Triangle, usize) -> bool,
    ) -> bool {
        let lines = Lines::new(origin, direction);
        let mut stops_at = |leaf: &Leaf| {
            lanes(leaf.meet(&lines, limit)).any(|lane| stops(&leaf.triangle(lane), leaf.start as usize + lane))
        };
        if self.leaves.get(last.0 as usize).is_some_and(&mut stops_at) {
            return true;
        }
        let (mut short, mut long);
        let waiting: &mut [u32] = if self.depth <= SHORT {
            short = [0; SHORT];
            &mut short
        } else {
            long = vec![0; self.depth];
            &mut long
        };
        let mut count = self.start(origin, direction);
        while count > 0 {
            count -= 1;
            let next = waiting[count];
            if next & LEAF != 0 {
                let leaf = next & !LEAF;
                if stops_at(&self.leaves[leaf as usize]) {
                    last.0 = leaf;
                    return true;
                }
                continue;
            }
            let node = &self.nodes[next as usize];
            for lane in lanes(node.meet(&lines, limit).1) {
                waiting[count] = node.children[lane];
                count += 1;
            }
        }
        false
    }

    /// Shows the triangles that the ray may cross, those of nearer boxes first; `meet` returns the
    /// distance beyond which nothing matters any more.
    #[inline]
    pub fn walk(&self, origin: Vec3A, direction: Vec3A, mut meet: impl FnMut(&Triangle, usize) -> f32) {
        let lines = Lines::new(origin, direction);
        let (mut short, mut long);
        let waiting: &mut [(f32, u32)] = if self.depth <= SHORT {
            short = [(0.0, 0); SHORT];
            &mut short
        } else {
            long = vec![(0.0, 0); self.depth];
            &mut long
        };
        let mut count = self.start(origin, direction);
        let mut limit = f32::INFINITY;
        while count > 0 {
            count -= 1;
            let (distance, next) = waiting[count];
            if distance > limit {
                continue;
            }
            if next & LEAF != 0 {
                let leaf = &self.leaves[(next & !LEAF) as usize];
                for lane in lanes(leaf.meet(&lines, limit)) {
                    limit = limit.min(meet(&leaf.triangle(lane), leaf.start as usize + lane));
                }
                continue;
            }
            let node = &self.nodes[next as usize];
            let (distances, met) = node.meet(&lines, limit);
            let start = count;
            for lane in lanes(met) {
                let entry = (distances[lane], node.children[lane]);
                // The nearest one comes last.
                let mut place = count;
                while place > start && waiting[place - 1].0 < entry.0 {
                    waiting[place] = waiting[place - 1];
                    place -= 1;
                }
                waiting[place] = entry;
                count += 1;
            }
        }
    }
}

/// Triangles below each node of a binary tree.
fn counts(binary: &Bvh2) -> Vec<u32> {
    let mut order = Vec::with_capacity(binary.nodes.len());
    let mut waiting = vec![0];
    while let Some(index) = waiting.pop() {
        order.push(index);
        let node = &binary.nodes[index];
        if node.prim_count == 0 {
            let first = node.first_index as usize;
            waiting.extend([first, first + 1]);
        }
    }
    let mut counts = vec![0; binary.nodes.len()];
    for index in order.into_iter().rev() {
        let node = &binary.nodes[index];
        let first = node.first_index as usize;
        counts[index] = if node.prim_count > 0 { node.prim_count } else { counts[first] + counts[first + 1] };
    }
    counts
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::random::{hash64, r2_sequence};
    use crate::geometry::offset::Crossing;

    fn number(seed: u64, index: usize) -> f32 {
        r2_sequence(hash64(seed, index as u64), 1)[0]
    }

    fn point(seed: u64, index: usize) -> Vec3A {
        Vec3A::from_array([0, 1, 2].map(|axis| number(seed, 3 * index + axis)))
    }

    /// Distance to the nearest triangle and its number, by the tree and by a test of each triangle.
    fn nearest(
        tree: &WideBvh,
        order: &[u32],
        corners: &[[Vec3A; 3]],
        origin: Vec3A,
        direction: Vec3A,
    ) -> [Option<f32>; 2] {
        let crossing = |triangle: &Triangle| {
            Crossing::of(triangle, origin, direction).map(|met| met.distance).filter(|distance| *distance >= 0.0)
        };
        let mut found: Option<f32> = None;
        tree.walk(origin, direction, |triangle, index| {
            assert_eq!(triangle.corner, corners[order[index] as usize][0], "the order is that of the tree");
            let Some(distance) = crossing(triangle) else { return f32::INFINITY };
            found = Some(found.map_or(distance, |before| before.min(distance)));
            distance
        });
        let all = corners.iter().filter_map(|corners| crossing(&Triangle::new(*corners)));
        [found, all.reduce(f32::min)]
    }

    /// Truth: each triangle tested by itself.
    #[test]
    fn the_tree_finds_what_each_triangle_by_itself_does() {
        for (count, effort) in
            [1, 3, 4, 5, 300].map(|count| (count, Effort::Thorough)).into_iter().chain([(300, Effort::Quick)])
        {
            let corner = |index: usize| {
                let first = point(1, index);
                [first, first + 0.2 * (point(2, index) - 0.5), first + 0.2 * (point(3, index) - 0.5)]
            };
            let corners: Vec<_> = (0..count).map(corner).collect();
            let (tree, order) = WideBvh::new(&corners, effort);
            let mut met = 0;
            for ray in 0..2_000 {
                let direction = match ray % 4 {
                    // Along an axis the inverse of the direction is infinite.
                    0 => Vec3A::AXES[ray % 3] * if ray % 8 == 0 { 1.0 } else { -1.0 } + Vec3A::ZERO,
                    _ => (point(4, ray) - 0.5).normalize(),
                };
                let origin = point(5, ray);
                let [found, wanted] = nearest(&tree, &order, &corners, origin, direction);
                assert_eq!(found, wanted, "{count} triangles, ray {ray}");
                let stops = |limit: f32| {
                    tree.is_stopped((origin, direction, limit), &mut LastStop::default(), |triangle, _| {
                        let crossing = Crossing::of(triangle, origin, direction);
                        crossing.is_some_and(|met| (0.0..=limit).contains(&met.distance))
                    })
                };
                assert_eq!(stops(f32::INFINITY), wanted.is_some());
                if let Some(wanted) = wanted {
                    met += 1;
                    assert!(stops(wanted) && !stops(0.999 * wanted));
                }
            }
            assert!(count < 300 || met > 300, "{met} rays met something");
        }
    }

    /// Truth: each triangle is met from in front of it. Where each is larger than the one before,
    /// the tree is deep; the list for trees that are deeper still serves as well.
    #[test]
    fn deep_trees_are_walked_whole() {
        let corner = |index: usize| {
            let at = 1.3_f32.powi(index as i32 - 100);
            [Vec3A::new(at, 0.0, 0.0), Vec3A::new(1.1 * at, 0.0, 0.0), Vec3A::new(at, 0.1 * at, 0.0)]
        };
        let corners: Vec<_> = (0..200).map(corner).collect();
        let (mut tree, order) = WideBvh::new(&corners, Effort::Thorough);
        assert!(tree.depth > 50, "no deep tree: {}", tree.depth);
        for depth in [tree.depth, SHORT + 1] {
            tree.depth = depth;
            for [a, b, c] in &corners {
                let middle = 0.4 * *a + 0.3 * *b + 0.3 * *c;
                let [found, wanted] = nearest(&tree, &order, &corners, middle + a.x * Vec3A::Z, Vec3A::NEG_Z);
                assert!(found.is_some() && found == wanted, "{found:?}, not {wanted:?}");
            }
        }
    }

    #[test]
    fn rays_that_are_no_numbers_meet_nothing() {
        let (tree, _) = WideBvh::new(&[[Vec3A::ZERO, Vec3A::X, Vec3A::Y]], Effort::Quick);
        let (empty, _) = WideBvh::new(&[], Effort::Thorough);
        for (tree, origin, direction) in
            [(&tree, Vec3A::NAN, Vec3A::Z), (&tree, Vec3A::ZERO, Vec3A::NAN), (&empty, Vec3A::ZERO, Vec3A::Z)]
        {
            assert!(!tree.is_stopped((origin, direction, f32::INFINITY), &mut LastStop::default(), |_, _| true));
            tree.walk(origin, direction, |_, _| panic!("nothing to be met"));
        }
    }
}
