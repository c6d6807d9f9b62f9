//! The patches of a field, as what sweeps over all of them reads them.

use crate::hierarchy::{ElementId, Hierarchy, Shape};

/// The patches of a hierarchy by the little that sweeps over all of them read.
#[derive(Clone, Default)]
pub struct Patches {
    /// Those that were not split, in the order of the arena.
    pub leaves: Vec<ElementId>,
    /// Those that were split, parents before their parts.
    pub split: Vec<ElementId>,
    /// Polygon of each patch, parallel to the arena.
    pub polygons: Vec<u32>,
}

impl Patches {
    /// Those of a hierarchy.
    pub fn of(hierarchy: &Hierarchy) -> Self {
        let mut patches = Self { polygons: vec![0; hierarchy.elements().len()], ..Self::default() };
        for id in hierarchy.ids() {
            let element = hierarchy.element(id);
            if let Shape::Patch(patch) = &element.shape {
                patches.polygons[id.index()] = patch.polygon;
                if element.is_leaf() { &mut patches.leaves } else { &mut patches.split }.push(id);
            }
        }
        patches
    }

    /// Takes up the parts of leaves that were split.
    pub fn split(&mut self, hierarchy: &Hierarchy, leaves: &[ElementId]) {
        self.polygons.resize(hierarchy.elements().len(), 0);
        let mut is_split = vec![false; self.polygons.len()];
        for leaf in leaves {
            is_split[leaf.index()] = true;
            for part in hierarchy.element(*leaf).children() {
                self.polygons[part.index()] = self.polygons[leaf.index()];
                self.leaves.push(part);
            }
        }
        self.leaves.retain(|leaf| !is_split[leaf.index()]);
        self.split.extend(leaves);
    }
}
