//! The element that was picked: found along a ray, followed through later snapshots.

use glam::Vec3;

use super::sources::{NamedSource, strongest};
use crate::hierarchy::ElementId;
use crate::render::{Marks, link_marks, pick};
use crate::scene::Scene;
use crate::solver::{Leaf, Snapshot};

/// A leaf element, and the ray that found it.
pub(super) struct PickedElement {
    pub element: ElementId,
    /// The leaf as the present snapshot has it.
    pub leaf: Leaf,
    /// Index of the leaf in the present snapshot.
    pub index: usize,
    /// The point that the ray met.
    pub point: Vec3,
    /// The strongest links that the present snapshot carries for it.
    pub sources: Vec<NamedSource>,
    /// How many links bring it light in the present snapshot.
    pub link_count: usize,
    /// The marks of its links, and what they were made from: generation, serial and the most that are drawn.
    marks: (Option<(u64, u64, usize)>, Marks),
    origin: Vec3,
    direction: Vec3,
}

impl PickedElement {
    /// The first leaf along a ray.
    pub(super) fn at(snapshot: &Snapshot, origin: Vec3, direction: Vec3) -> Option<Self> {
        let mesh = &snapshot.mesh;
        let found = pick(mesh, origin, direction)?;
        let index = found.leaf as usize;
        let leaf = *mesh.leaves.get(index)?;
        Some(Self {
            element: leaf.element,
            leaf,
            index,
            point: found.point,
            sources: Vec::new(),
            link_count: 0,
            marks: (None, Marks::default()),
            origin,
            direction,
        })
    }

    /// Finds the element in a newer snapshot; where it was subdivided, the leaf now lying under the ray takes its
    /// place. False when there is none.
    pub(super) fn follow(&mut self, snapshot: &Snapshot) -> bool {
        let mesh = &snapshot.mesh;
        let is_it = |leaf: &Leaf| {
            leaf.element == self.element && leaf.polygon == self.leaf.polygon && leaf.area == self.leaf.area
        };
        let stays = mesh.leaves.get(self.index).is_some_and(is_it);
        let found = if stays { Some(self.index) } else { mesh.leaves.iter().position(is_it) };
        match found {
            Some(index) => {
                self.index = index;
                self.leaf = mesh.leaves[index];
                true
            }
            None => match Self::at(snapshot, self.origin, self.direction) {
                Some(other) => {
                    *self = other;
                    true
                }
                None => false,
            },
        }
    }

    /// Counts and names the sources of a newer snapshot, where it carries them.
    pub(super) fn note_sources(&mut self, snapshot: &Snapshot, scene: &Scene) {
        let anatomy = snapshot.anatomy.as_ref().filter(|anatomy| anatomy.holds(self.element));
        let links = anatomy.map(|anatomy| anatomy.incoming(self.element)).unwrap_or_default();
        self.link_count = links.len();
        self.sources = strongest(&links, snapshot, scene);
    }

    /// Lines for its strongest links, so many at most, and a rim around it.
    pub(super) fn marks(&mut self, snapshot: &Snapshot, most: usize) -> Marks {
        let key = Some((snapshot.generation, snapshot.serial, most));
        if self.marks.0 != key {
            self.marks = (key, link_marks(snapshot, self.element, most).into());
        }
        self.marks.1.clone()
    }
}
