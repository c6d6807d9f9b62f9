//! Which leaves light reaches: those that some chain of rays joins to a lamp or to the outside.
//!
//! Two-sided files hold the insides of tubes, books and cushions, half of a room's faces, and whole
//! rooms may lie behind a closed door. No light gets there, so no look is spent on them. Some rays
//! from each leaf join it to what they meet; what is then joined to no emitter is dark. A set that
//! few rays looked out of gets more of them first.

use petgraph::unionfind::UnionFind;
use rayon::prelude::*;

use super::field::{End, Field};
use crate::base::cancel::CancelToken;
use crate::base::random::{cosine_direction, hash64};
use crate::hierarchy::ElementId;

/// Rays from each leaf.
const RAYS: u32 = 2;
/// Rays that find no way out of a set of leaves before it counts as dark.
const RAYS_OF_SET: u32 = 64;
/// Leaves between two looks at commands.
const CHUNK: usize = 1 << 14;

/// A search at work.
pub struct Reaching {
    /// Sets of elements; the one past the last stands for all emitters and the outside.
    sets: UnionFind<u32>,
    /// Leaves to cast rays from, each from this number of its rays up to that one.
    queue: Vec<(ElementId, u32, u32)>,
    next: usize,
    is_second: bool,
    seed: u64,
    /// Rays cast.
    pub rays: u64,
}

impl Reaching {
    /// Starts over the leaves of a field.
    pub fn new(field: &Field, seed: u64) -> Self {
        let elements = field.hierarchy().elements().len();
        let mut sets = UnionFind::new(elements + 1);
        for leaf in field.leaves().filter(|leaf| field.emits(*leaf)) {
            sets.union(leaf.0, elements as u32);
        }
        let queue = field.leaves().map(|leaf| (leaf, 0, RAYS)).collect();
        Self { sets, queue, next: 0, is_second: false, seed, rays: 0 }
    }

    /// Casts some more rays; whether that was all, or `None` if cancelled, with nothing changed.
    pub fn advance(&mut self, field: &Field, cancel: &CancelToken) -> Option<bool> {
        let emitters = field.hierarchy().elements().len() as u32;
        let end = (self.next + CHUNK).min(self.queue.len());
        let seed = self.seed;
        let meet = |&(leaf, first, end): &(ElementId, u32, u32)| {
            (!cancel.is_cancelled()).then(|| (first..end).map(|ray| meet(field, leaf, ray, seed)).collect::<Vec<_>>())
        };
        let chunk = &self.queue[self.next..end];
        let found: Vec<Vec<Option<ElementId>>> = chunk.par_iter().with_min_len(128).map(meet).collect::<Option<_>>()?;
        for ((leaf, ..), met) in chunk.iter().zip(found) {
            self.rays += met.len() as u64;
            for met in met {
                self.sets.union(leaf.0, met.map_or(emitters, |met| met.0));
            }
        }
        self.next = end;
        if end < self.queue.len() {
            return Some(false);
        }
        if !std::mem::replace(&mut self.is_second, true) {
            self.look_again(field);
        }
        Some(self.next == self.queue.len())
    }

    /// Queues leaves of dark sets that few rays looked out of.
    fn look_again(&mut self, field: &Field) {
        let dark: Vec<ElementId> = field.leaves().filter(|leaf| !self.is_lit(*leaf)).collect();
        let mut sizes = vec![0_u32; field.hierarchy().elements().len()];
        dark.iter().for_each(|leaf| sizes[self.sets.find(leaf.0) as usize] += 1);
        let more = |leaf: &ElementId| {
            let end = RAYS_OF_SET.div_ceil(sizes[self.sets.find(leaf.0) as usize]);
            (end > RAYS).then_some((*leaf, RAYS, end))
        };
        self.queue = dark.iter().filter_map(more).collect();
        self.next = 0;
    }

    /// Whether light reaches a leaf, once the search is done.
    pub fn is_lit(&self, leaf: ElementId) -> bool {
        self.sets.find(leaf.0) == self.sets.find(self.sets.len() as u32 - 1)
    }
}

/// The leaf that a ray meets; `None` where it leaves the scene or meets a back, behind which nobody
/// knows what emits.
fn meet(field: &Field, leaf: ElementId, ray: u32, seed: u64) -> Option<ElementId> {
    let hierarchy = field.hierarchy();
    let seed = hash64(seed, hierarchy.element(leaf).key);
    let [u, v, w, x] = sobol_burley::sample_4d(ray, 0, (seed ^ (seed >> 32)) as u32);
    let point = hierarchy.point_on(leaf, u, v);
    match field.meet(point.position, point.normal, cosine_direction(point.normal, w, x)) {
        End::Face(met) => Some(met.leaf),
        End::Outside | End::Back => None,
    }
}
