//! That light of every pair of patches is accounted for exactly once.
//!
//! Truth: counting. Refinement only ever replaces a pair by its parts.

use rustc_hash::{FxHashMap, FxHashSet};
use selflink::hierarchy::{ElementId, Hierarchy, Shape};
use selflink::solve::Solver;

/// The initial patch that a patch is a part of, and the share of its area: at each level by the
/// areas of all parts, which add up to their whole only as far as f32 tells the corners of a needle
/// apart.
fn initial_patch(hierarchy: &Hierarchy, patch: ElementId) -> (ElementId, f64) {
    let (mut id, mut share) = (patch, 1.0);
    while let Shape::Patch(shape) = hierarchy.element(id).shape
        && shape.level > 0
    {
        let parent = hierarchy.element(id).parent().expect("a patch below the first level has a parent");
        let area = |id: ElementId| f64::from(hierarchy.element(id).area);
        let whole: f64 = hierarchy.element(parent).children().map(area).sum();
        share *= area(id) / whole;
        id = parent;
    }
    (id, share)
}

/// How often each ordered pair of initial patches is covered, as a share of the pair's areas, by
/// what was stored or rejected.
fn covered(solver: &Solver) -> FxHashMap<(ElementId, ElementId), f64> {
    let hierarchy = solver.hierarchy();
    let below = |id: ElementId| match &hierarchy.element(id).shape {
        Shape::Cluster(cluster) => hierarchy.patches_below(cluster).iter().map(|&patch| (patch, 1.0)).collect(),
        Shape::Patch(_) => vec![initial_patch(hierarchy, id)],
        Shape::Sky(_) => Vec::new(),
    };
    let mut covered = FxHashMap::default();
    for (receiver, source) in accounted(solver) {
        for (to, to_share) in below(receiver) {
            for (from, from_share) in below(source) {
                // What an accepted self-link of a cluster stands for leaves out each patch with
                // itself.
                if receiver != source || to != from {
                    *covered.entry((to, from)).or_insert(0.0) += to_share * from_share;
                }
            }
        }
    }
    covered
}

/// Receivers and sources of all stored links and rejections.
fn accounted(solver: &Solver) -> Vec<(ElementId, ElementId)> {
    let of = |receiver: ElementId| solver.links().of(receiver).iter().map(move |link| (receiver, link.source()));
    let stored = solver.hierarchy().ids().flat_map(of);
    stored.chain(solver.rejected().iter().map(|pair| (pair.receiver, pair.source))).collect()
}

/// The element and all that hold it.
fn with_ancestors(hierarchy: &Hierarchy, id: ElementId) -> impl Iterator<Item = ElementId> {
    std::iter::successors(Some(id), |&id| hierarchy.element(id).parent())
}

/// Asserts that every ordered pair of different initial patches is covered exactly once; the solver
/// must have recorded its rejections.
pub fn check_coverage(solver: &Solver, what: &str) {
    let hierarchy = solver.hierarchy();
    let covered = covered(solver);
    let patches = hierarchy.initial_patches();
    for &to in patches {
        for &from in patches {
            let share = covered.get(&(to, from)).copied().unwrap_or(0.0);
            let wanted = if to == from { 0.0 } else { 1.0 };
            // Sums of a few thousand shares in f64.
            assert!((share - wanted).abs() < 1e-9, "{what}: {to:?} ← {from:?} is covered {share} times");
        }
    }
    // The sum might hide a part that is covered twice beside one that is not: no pair may hold
    // another.
    let pairs: Vec<_> = accounted(solver);
    let set: FxHashSet<_> = pairs.iter().copied().collect();
    assert_eq!(set.len(), pairs.len(), "{what}: a pair is accounted for twice");
    for &(receiver, source) in &pairs {
        for to in with_ancestors(hierarchy, receiver) {
            for from in with_ancestors(hierarchy, source) {
                let holds = (to, from) != (receiver, source) && set.contains(&(to, from));
                assert!(!holds, "{what}: {to:?} ← {from:?} holds {receiver:?} ← {source:?}");
            }
        }
    }
}
