//! Merging patches back: the reverse of [`Hierarchy::subdivide`], for a solution that needs fewer
//! of them.

use rustc_hash::FxHashMap;

use super::sky::Surroundings;
use super::{ElementId, Hierarchy};

/// Stands for an element that is gone.
const GONE: u32 = u32::MAX;

/// Where the elements of a hierarchy are found in the one that was made of it.
pub struct Renumbering(Vec<u32>);

impl Renumbering {
    /// The new id of an element; `None` if it was merged into its parent.
    pub fn of(&self, old: ElementId) -> Option<ElementId> {
        self.0.get(old.index()).filter(|new| **new != GONE).map(|new| ElementId(*new))
    }

    /// New number of an element or, where it is gone, of the nearest element above it that is left.
    pub fn of_nearest(&self, before: &Hierarchy, old: ElementId) -> Option<ElementId> {
        std::iter::successors(Some(old), |&id| before.elements.get(id.index())?.parent()).find_map(|id| self.of(id))
    }

    /// Brings a table that was parallel to the former arena into the new order.
    pub fn reorder<T: Copy>(&self, table: &[T]) -> Vec<T> {
        table.iter().zip(&self.0).filter(|(_, new)| **new != GONE).map(|(value, _)| *value).collect()
    }
}

impl Hierarchy {
    /// The hierarchy with only those patches split that `stays_split` answers yes for; a patch
    /// below one that does not is not asked about. Elements keep their order, and what they are to
    /// the last bit.
    pub fn merged_back(&self, stays_split: impl Fn(ElementId) -> bool) -> (Self, Renumbering) {
        let initial = self.cluster_count + self.initial_patches.len() + self.outside().len();
        let mut merged = Self {
            elements: self.elements[..initial].to_vec(),
            vertices: self.vertices[..self.initial_vertices].to_vec(),
            midpoints: FxHashMap::default(),
            initial_patches: self.initial_patches.clone(),
            area_sums: self.area_sums.clone(),
            reachability: self.reachability.clone(),
            cluster_count: self.cluster_count,
            leaf_count: self.initial_patches.len(),
            initial_vertices: self.initial_vertices,
            smooth_surfaces: self.smooth_surfaces.clone(),
            around: self.around.as_ref().map(Surroundings::whole),
        };
        for patch in merged.elements.iter_mut().filter(|element| !element.is_cluster()) {
            (patch.first_child, patch.child_count) = (0, 0);
        }
        let mut new_ids = vec![GONE; self.elements.len()];
        for (index, new) in new_ids[..initial].iter_mut().enumerate() {
            *new = index as u32;
        }
        // In the order in which they were split, which is that of their quarters.
        let mut split: Vec<ElementId> = self.ids().filter(|&id| self.is_split_patch(id)).collect();
        split.sort_unstable_by_key(|&id| self.element(id).first_child);
        for old in split {
            let new = new_ids[old.index()];
            if new == GONE || !stays_split(old) {
                continue;
            }
            let first_quarter = merged.elements.len() as u32;
            merged.subdivide(ElementId(new));
            for (number, quarter) in self.element(old).children().enumerate() {
                new_ids[quarter.index()] = first_quarter + number as u32;
            }
        }
        (merged, Renumbering(new_ids))
    }

    fn is_split_patch(&self, id: ElementId) -> bool {
        let element = self.element(id);
        !element.is_cluster() && !element.is_leaf()
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::super::ClusteringMode;
    use super::*;
    use crate::scene::builtin::BuiltinScene;

    /// Truth: a hierarchy in which nothing else was ever split.
    #[test]
    fn a_patch_merged_back_leaves_no_trace() {
        let scene = BuiltinScene::Cornell.build();
        let new = || Hierarchy::new(&scene, Arc::default(), ClusteringMode::Adaptive, 1);
        let (mut wanted, mut hierarchy) = (new(), new());
        let patches = hierarchy.initial_patches().to_vec();
        for &patch in &patches[..3] {
            hierarchy.subdivide(patch);
        }
        for patch in [patches[0], patches[2]] {
            wanted.subdivide(patch);
        }
        let third = hierarchy.element(patches[2]).children().nth(1).expect("four quarters");
        let below_second = hierarchy.element(patches[1]).children().nth(3).expect("four quarters");
        hierarchy.subdivide(third);
        hierarchy.subdivide(below_second);
        wanted.subdivide(wanted.element(patches[2]).children().nth(1).expect("four quarters"));

        let (merged, renumbering) = hierarchy.merged_back(|id| id != patches[1]);
        assert_eq!(format!("{:?}", merged.elements), format!("{:?}", wanted.elements));
        assert_eq!(merged.vertices, wanted.vertices);
        assert_eq!((merged.leaf_count, merged.midpoints.len()), (wanted.leaf_count, wanted.midpoints.len()));
        assert_eq!(renumbering.of(below_second), None);
        assert_eq!(renumbering.of_nearest(&hierarchy, below_second), Some(patches[1]));
        let new_third = renumbering.of(third).expect("it stays");
        assert_eq!(merged.element(new_third).key, hierarchy.element(third).key);
        let keys: Vec<u64> = hierarchy.elements.iter().map(|element| element.key).collect();
        let kept: Vec<u64> = merged.elements.iter().map(|element| element.key).collect();
        assert_eq!(renumbering.reorder(&keys), kept);
    }
}
