//! Candidates: pairs of elements that wait to be judged.

use super::form_factor::{Exchange, exchange};
use super::link::quantised;
use crate::hierarchy::{DEEPEST_SKY, ElementId, Hierarchy, Shape};

/// Patches of this level are not split further; [`Counts::depth_guard_struck`] counts how often it
/// mattered.
pub const DEEPEST_LEVEL: u8 = 12;
/// Which directions of a pair a candidate stands for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Directions {
    /// Light from `b` to `a`.
    pub to_a: bool,
    /// Light from `a` to `b`.
    pub to_b: bool,
}

impl Directions {
    /// Neither is left.
    pub fn is_empty(self) -> bool {
        !(self.to_a || self.to_b)
    }
}

/// An unordered pair that waits for a verdict in one or both directions; `a == b` for a self-link.
#[derive(Clone, Copy, Debug)]
pub struct Candidate {
    /// One end.
    pub a: ElementId,
    /// The other.
    pub b: ElementId,
    visibility: u16,
    /// Directions that are still open.
    pub directions: Directions,
    /// Whether a pair that holds this one is known to be fully visible.
    pub inherits_visible: bool,
}

impl Candidate {
    /// A pair with the visibility of the pair it came from.
    pub fn new(a: ElementId, b: ElementId, directions: Directions, visibility: f32, inherits_visible: bool) -> Self {
        Self { a, b, visibility: quantised(visibility), directions, inherits_visible }
    }

    /// The root's self-link, with which everything starts.
    pub fn root() -> Self {
        Self::new(Hierarchy::ROOT, Hierarchy::ROOT, Directions { to_a: true, to_b: false }, 1.0, false)
    }

    /// All pairs with which everything starts: the root with itself, and with what lies outside,
    /// which receives nothing.
    pub fn first(hierarchy: &Hierarchy) -> impl Iterator<Item = Self> + use<> {
        let directions = Directions { to_a: true, to_b: false };
        let from = move |outside: ElementId| Self::new(Hierarchy::ROOT, outside, directions, 1.0, false);
        std::iter::once(Self::root()).chain(hierarchy.outside().map(from))
    }

    /// Visibility of the pair it came from, 0..=1.
    pub fn visibility(&self) -> f32 {
        f32::from(self.visibility) / f32::from(u16::MAX)
    }

    /// Whether it is a cluster's link to itself.
    pub fn is_self(&self) -> bool {
        self.a == self.b
    }
}

/// Work that waits in a wave.
#[derive(Clone, Copy, Debug)]
pub enum Waiting {
    /// A pair.
    Pair(Candidate),
    /// All pairs of a cluster's child (by its number) with itself and its later siblings: a refined
    /// self-link, kept short so that plain HR's millions of pairs need not lie in memory at once.
    Siblings {
        /// The cluster.
        cluster: ElementId,
        /// Number of the child among the cluster's children.
        child: u32,
        /// First sibling that is not yet done, the child itself included.
        from: u32,
    },
}

impl Waiting {
    /// Number of pairs that it stands for.
    pub fn pairs(&self, hierarchy: &Hierarchy) -> u32 {
        match *self {
            Self::Pair(_) => 1,
            Self::Siblings { cluster, from, .. } => {
                (hierarchy.element(cluster).children().len() as u32).saturating_sub(from)
            }
        }
    }
}

/// Takes up to `limit` candidates from the front of a wave; what is left over of a row of siblings
/// goes back.
pub fn take_chunk(
    wave: &mut std::collections::VecDeque<Waiting>,
    hierarchy: &Hierarchy,
    limit: usize,
) -> Vec<Candidate> {
    let mut chunk = Vec::with_capacity(limit.min(wave.len().max(256)));
    while chunk.len() < limit {
        match wave.pop_front() {
            None => break,
            Some(Waiting::Pair(candidate)) => chunk.push(candidate),
            Some(Waiting::Siblings { cluster, child, from }) => {
                let children = hierarchy.element(cluster).children();
                let (first, count) = (children.clone().next().map_or(0, |id| id.0), children.len() as u32);
                let own = ElementId(first + child);
                let room = (limit - chunk.len()) as u32;
                let until = count.min(from.saturating_add(room));
                for other in from..until {
                    let is_self = other == child;
                    if is_self && !hierarchy.element(own).is_cluster() {
                        continue;
                    }
                    let directions = Directions { to_a: true, to_b: !is_self };
                    chunk.push(Candidate::new(own, ElementId(first + other), directions, 1.0, false));
                }
                if until < count {
                    wave.push_front(Waiting::Siblings { cluster, child, from: until });
                }
            }
        }
    }
    chunk
}

/// The end of a pair that is split: the larger by area, but a cluster before a patch where they
/// overlap (or small scattered clusters shred walls); `None` where that is a patch too deep to be
/// split.
pub fn end_to_split(hierarchy: &Hierarchy, a: ElementId, b: ElementId) -> Option<ElementId> {
    let (first, second) = (hierarchy.element(a), hierarchy.element(b));
    let larger = if first.area >= second.area { a } else { b };
    let has_sky = first.is_sky() || second.is_sky();
    let end = if has_sky || first.is_cluster() == second.is_cluster() || hierarchy.element(larger).is_cluster() {
        larger
    } else {
        match exchange(hierarchy, a, b) {
            Exchange::Facing { overlapping: true, .. } if first.is_cluster() => a,
            Exchange::Facing { overlapping: true, .. } => b,
            _ => larger,
        }
    };
    match hierarchy.element(end).shape {
        Shape::Patch(patch) if patch.level >= DEEPEST_LEVEL => None,
        // The receiver is what can still be split.
        Shape::Sky(number) if hierarchy.sky_part(number).level >= DEEPEST_SKY => {
            let other = if end == a { b } else { a };
            let is_deepest =
                matches!(hierarchy.element(other).shape, Shape::Patch(patch) if patch.level >= DEEPEST_LEVEL);
            (!is_deepest).then_some(other)
        }
        _ => Some(end),
    }
}
