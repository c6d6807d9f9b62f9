//! Passes: from which leaves a gather looks, how often, and with how many rays.

use glam::Vec3;

use super::field::Field;
use super::glance::GlanceRays;
use super::groups::Groups;
use super::refine::{self, Importance};
use super::samples::Queue;
use super::{Full, Gather, Stage};
use crate::base::cancel::CancelToken;
use crate::hierarchy::ElementId;

/// Looks between two looks at commands, as far as leaves are not looked from more often.
const CHUNK: u32 = 4096;
/// Rays of a look from a leaf that are aimed, an even number.
pub(super) const AIMED: u32 = 4;
/// Looks from a leaf that tell how light differs over it: one from each quarter.
const LOOKS: u32 = 4;
/// Looks from all leaves together, by what they count, of which each gets one to [`LOOKS`]: where a
/// hundred thousand small faces share the light, one look from each says as much of it.
const LOOKS_FOR_ALL: f64 = 4e5;
/// Cosine-distributed rays of a look, times the target error.
const COSINE: f64 = 0.4;
/// Cosine-distributed rays that are shared out by the power that leaves send, times the square of
/// the target error: the noise of what a leaf sends is shared by all who read it.
const RAYS_BY_POWER: f64 = 500.0;
/// Looks from a leaf for that, at most.
const MOST_LOOKS: f64 = 2000.0;
/// Variation of direct light over a leaf that is allowed, as a multiple of the target error:
/// readings look for emitters themselves, so the field is to be right in the mean alone.
pub(super) const MESH_PER_TARGET: f64 = 1.5;
/// Rounds of splitting leaves.
pub(super) const MOST_ROUNDS: u32 = 6;
/// Rounds that each further attempt begins with, for it knows better than the one before what
/// matters to whom.
pub(super) const AGAIN: u32 = 3;
/// Bytes of a leaf with what is kept of it beside its samples.
const LEAF_BYTES: usize = 600;
/// Bytes of a look beside those of its cosine-distributed rays, four each.
const LOOK_BYTES: usize = 72;

impl Gather {
    /// Rays of each look of a pass: as many in all passes, so that their samples count alike.
    pub(super) fn rays_of_look(&self) -> GlanceRays {
        GlanceRays { aimed: AIMED, cosine: ((COSINE / self.target()) as u32).clamp(4, 64) & !1 }
    }

    /// Looks from the next chunk of the queue; where the one after it starts.
    pub(super) fn draw(&mut self, first: usize, rays: GlanceRays, cancel: &CancelToken) -> Option<usize> {
        let mut looks = 0;
        let part = self.queue[first..].iter().take_while(|(_, of_leaf)| {
            let has_room = looks < CHUNK;
            looks += of_leaf;
            has_room
        });
        let end = first + part.count();
        let is_done = self.samples.draw(&self.field, &self.queue[first..end], rays, self.goal.seed, cancel);
        is_done.then_some(end)
    }

    /// Splits the leaves over which light is too uneven, or opens a pass if there are none; `None`
    /// if cancelled.
    pub(super) fn refine(&mut self, cancel: &CancelToken) -> Option<()> {
        let mut split = Vec::new();
        if self.round < MOST_ROUNDS {
            let variances = self.samples.variances(&self.field.reflected, cancel)?;
            let allowed = MESH_PER_TARGET * self.aim;
            split = refine::leaves_to_split(&self.field, &self.importance, &variances, allowed);
        }
        let split = self.within_memory(split);
        if split.is_empty() {
            self.open_pass()
        } else {
            self.split(&split)
        }
        Some(())
    }

    /// The leaves to split, or none where there is no room for their parts.
    pub(super) fn within_memory(&mut self, split: Vec<ElementId>) -> Vec<ElementId> {
        let leaves = self.field.hierarchy.leaf_count() + 3 * split.len();
        let of_looks = LOOKS as usize * (4 * self.rays_of_look().cosine as usize + LOOK_BYTES);
        if leaves * (LEAF_BYTES + of_looks) > self.goal.memory {
            self.full.get_or_insert(Full::Leaves);
            return Vec::new();
        }
        split
    }

    /// Splits leaves, and queues their parts for a look at emitters.
    pub(super) fn split(&mut self, leaves: &[ElementId]) {
        self.round += 1;
        self.field.split(leaves);
        self.samples.split(&self.field, leaves);
        self.importance.split(&self.field, leaves);
        self.of_links.resize(self.field.hierarchy.elements().len(), Vec3::ZERO);
        let mut queue = Queue::new();
        for leaf in leaves {
            for child in self.field.hierarchy.element(*leaf).children() {
                self.of_links[child.index()] = self.of_links[leaf.index()];
                queue.push((child, LOOKS));
            }
        }
        self.queue = queue;
        self.stage = Stage::Direct(0);
    }

    /// Aims at what is bright from now on, and queues all leaves for cosine-distributed rays: some
    /// for each, and for those that send much, more.
    pub(super) fn open_pass(&mut self) {
        self.field.find_secondary();
        let field = &self.field;
        let brought = self.importance.brought_by(field);
        let cosine = self.rays_of_look().cosine;
        let by_power = RAYS_BY_POWER / (self.aim * self.aim) / f64::from(cosine);
        let more = |leaf: ElementId| (by_power * brought(leaf)).min(MOST_LOOKS);
        let (planned, finer) = (planned_looks(field, &self.importance), (self.target() / self.aim).round());
        // Those that share looks get more of them together, each as many times as it had, so that
        // all count as they did.
        let [of_more, of_all] = self.groups.leaves().fold([0.0, 0.0], |[of_more, of_all], leaf| {
            [of_more + more(leaf), of_all + self.groups.planned(leaf).unwrap_or(0.0)]
        });
        let denser = if of_all > 0.0 { finer + of_more / of_all } else { finer };
        let looks = |leaf: ElementId| match self.groups.planned(leaf) {
            Some(looks) => denser * looks,
            None if field.area(leaf) > 0.0 => finer * planned(leaf).max(1.0) + more(leaf),
            None => 0.0,
        };
        // Later passes add to what is there.
        let missing = |(leaf, looks): (ElementId, u32)| (leaf, looks.saturating_sub(self.samples.whole_looks(leaf)));
        let looks = whole_numbers(field.leaves().map(|leaf| (leaf, looks(leaf))));
        let mut queue: Queue = looks.map(missing).filter(|(_, looks)| *looks > 0).collect();
        drop(planned);
        self.afford(&mut queue, AIMED + cosine);
        // An end of a ray takes four bytes.
        let bytes: usize = queue.iter().map(|(_, looks)| *looks as usize * (4 * cosine as usize + LOOK_BYTES)).sum();
        if bytes > self.goal.memory.saturating_sub(self.bytes()) {
            self.full.get_or_insert(Full::Looks);
            queue.iter_mut().for_each(|(leaf, looks)| {
                *looks = (*looks).min(u32::from(self.samples.whole_looks(*leaf) == 0));
            });
            queue.retain(|(_, looks)| *looks > 0);
        }
        self.queue = queue;
        self.stage = Stage::Cast(0);
    }

    /// Takes from a queue what this attempt has no rays for.
    pub(super) fn afford(&self, queue: &mut Queue, rays_of_look: u32) {
        let planned: u64 = queue.iter().map(|(_, looks)| u64::from(looks * rays_of_look)).sum();
        let share = self.most_rays.saturating_sub(self.rays()) as f64 / planned.max(1) as f64;
        if share < 1.0 {
            queue.iter_mut().for_each(|(_, looks)| *looks = ((share * f64::from(*looks)) as u32).max(1));
        }
    }
}

/// Looks that are planned from each leaf of a field in any case: less than one from those that may
/// [share looks](super::groups).
pub(super) fn planned_looks<'a>(field: &'a Field, importance: &'a Importance) -> impl Fn(ElementId) -> f64 + use<'a> {
    let share = importance.share_of(field);
    move |leaf| {
        let looks = (LOOKS_FOR_ALL * share(leaf)).min(f64::from(LOOKS));
        if field.area(leaf) <= 0.0 || Groups::may_hold(field, leaf) { looks } else { looks.max(1.0) }
    }
}

/// Whole numbers of looks near these, so that any run of leaves gets as many in all: less than one
/// each is one from some of them.
pub(super) fn whole_numbers(looks: impl Iterator<Item = (ElementId, f64)>) -> impl Iterator<Item = (ElementId, u32)> {
    looks.scan(0.5, |rest, (leaf, looks)| {
        *rest += looks;
        let whole = rest.floor();
        *rest -= whole;
        Some((leaf, whole as u32))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Truth: what an attempt may cast, but for the one look that each leaf in a queue keeps.
    #[test]
    fn an_attempt_casts_what_it_can_afford() {
        let mut gather = Gather::of_cornell();
        gather.most_rays = 20_000;
        let plenty: Queue = gather.field().leaves().map(|leaf| (leaf, 1000)).collect();
        let mut queue = plenty.clone();
        gather.afford(&mut queue, 10);
        let planned: u64 = queue.iter().map(|(_, looks)| 10 * u64::from(*looks)).sum();
        let of_one_look = 10 * queue.len() as u64;
        assert!(planned <= 20_000 + of_one_look && planned + of_one_look >= 20_000, "{planned} rays");
        let mut little: Queue = plenty.iter().take(3).map(|(leaf, _)| (*leaf, 2)).collect();
        gather.afford(&mut little, 10);
        assert!(little.iter().all(|(_, looks)| *looks == 2), "what can be afforded stays");
    }
}
