//! Clusters from geometry alone: a surface-area heuristic over centroids, with several children a
//! node.
//!
//! The paper leaves adaptive clustering as future work (section 3.2). A polygon goes where the
//! middle of its box is, so boxes may overlap and nothing stays at the root because it straddles a
//! plane; large polygons (walls, table tops) stay high in the tree, beside the clusters of what
//! they enclose, so that they do not blow up the boxes of small things.

use glam::Vec3;
use rayon::prelude::*;

use super::grouping::{Grouping, PolygonBounds};

/// Clusters of this many polygons are not split further.
const MOST_IN_LEAF: usize = 4;
/// Children that a cluster is given at most, besides large polygons.
const MOST_CHILDREN: usize = 2;
/// A polygon whose box has more than this share of the node's box's surface is a child of the node
/// itself.
const LARGE_SHARE: f32 = 0.1;
/// Bins of the heuristic along each axis.
const BINS: usize = 32;
/// Below this many polygons a subtree is built on the thread at hand.
const PARALLEL_FROM: usize = 4096;

/// Groups polygons by place and size.
pub(super) fn group(bounds: &PolygonBounds, polygons: Vec<u32>) -> Grouping {
    if polygons.len() <= MOST_IN_LEAF {
        return Grouping { groupings: Vec::new(), polygons };
    }
    let (lower, upper) = bounds.around(&polygons);
    let large_from = LARGE_SHARE * box_surface(lower, upper);
    let is_large =
        |&polygon: &u32| box_surface(bounds.lower[polygon as usize], bounds.upper[polygon as usize]) > large_from;
    let (mut large, small): (Vec<u32>, Vec<u32>) = polygons.into_iter().partition(is_large);
    if small.is_empty() {
        // Many polygons of the node's own size, such as a stack of sheets: size tells nothing,
        // place must.
        return children(bounds, std::mem::take(&mut large));
    }
    let mut grouping = if large.is_empty() { children(bounds, small) } else { group(bounds, small) };
    if large.is_empty() {
        return grouping;
    }
    if grouping.groupings.len() + grouping.polygons.len() <= MOST_CHILDREN {
        grouping.polygons.append(&mut large);
        return grouping;
    }
    Grouping { groupings: vec![grouping], polygons: large }
}

/// Splits polygons into a few spatial parts and groups each.
fn children(bounds: &PolygonBounds, polygons: Vec<u32>) -> Grouping {
    let mut parts = vec![polygons];
    while parts.len() < MOST_CHILDREN {
        let surface = |part: &[u32]| {
            let (lower, upper) = bounds.around(part);
            box_surface(lower, upper)
        };
        let splittable = parts.iter().enumerate().filter(|(_, part)| part.len() > MOST_IN_LEAF);
        let Some((widest, _)) = splittable.max_by(|(_, a), (_, b)| surface(a).total_cmp(&surface(b))) else { break };
        let (left, right) = split(bounds, std::mem::take(&mut parts[widest]));
        parts[widest] = left;
        parts.push(right);
    }
    let total: usize = parts.iter().map(Vec::len).sum();
    let groupings = if total >= PARALLEL_FROM {
        parts.into_par_iter().map(|part| group(bounds, part)).collect()
    } else {
        parts.into_iter().map(|part| group(bounds, part)).collect()
    };
    Grouping { groupings, polygons: Vec::new() }
}

/// Half the surface of a box.
fn box_surface(lower: Vec3, upper: Vec3) -> f32 {
    let extent = (upper - lower).max(Vec3::ZERO);
    extent.x * extent.y + extent.y * extent.z + extent.z * extent.x
}

#[derive(Clone, Copy)]
struct Bin {
    lower: Vec3,
    upper: Vec3,
    count: usize,
}

impl Bin {
    const EMPTY: Self = Self { lower: Vec3::INFINITY, upper: Vec3::NEG_INFINITY, count: 0 };

    fn joined(self, other: Self) -> Self {
        Self { lower: self.lower.min(other.lower), upper: self.upper.max(other.upper), count: self.count + other.count }
    }

    fn cost(&self) -> f32 {
        if self.count == 0 { 0.0 } else { box_surface(self.lower, self.upper) * self.count as f32 }
    }
}

/// Two non-empty halves by the binned surface-area heuristic; by order where all middles coincide.
fn split(bounds: &PolygonBounds, mut polygons: Vec<u32>) -> (Vec<u32>, Vec<u32>) {
    let (lowest, highest) = polygons.iter().fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(lower, upper), &polygon| {
        let middle = bounds.doubled_middle(polygon);
        (lower.min(middle), upper.max(middle))
    });
    let extent = highest - lowest;
    let bin_of = |polygon: u32, axis: usize| {
        let share = (bounds.doubled_middle(polygon)[axis] - lowest[axis]) / extent[axis];
        ((share * BINS as f32) as usize).min(BINS - 1)
    };
    let mut best: Option<(f32, usize, usize)> = None;
    for axis in (0..3).filter(|&axis| extent[axis] > 0.0) {
        let mut bins = [Bin::EMPTY; BINS];
        for &polygon in &polygons {
            let bin = &mut bins[bin_of(polygon, axis)];
            let (lower, upper) = (bounds.lower[polygon as usize], bounds.upper[polygon as usize]);
            *bin = bin.joined(Bin { lower, upper, count: 1 });
        }
        let mut right_cost = [0.0; BINS];
        let mut right = Bin::EMPTY;
        for index in (1..BINS).rev() {
            right = right.joined(bins[index]);
            right_cost[index] = right.cost();
        }
        let mut left = Bin::EMPTY;
        for index in 1..BINS {
            left = left.joined(bins[index - 1]);
            let cost = left.cost() + right_cost[index];
            let two_sided = left.count > 0 && left.count < polygons.len();
            if two_sided && best.is_none_or(|(least, ..)| cost < least) {
                best = Some((cost, axis, index));
            }
        }
    }
    match best {
        Some((_, axis, first_right)) => polygons.into_iter().partition(|&polygon| bin_of(polygon, axis) < first_right),
        None => {
            let right = polygons.split_off(polygons.len() / 2);
            (polygons, right)
        }
    }
}
