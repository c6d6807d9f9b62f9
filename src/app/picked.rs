//! The element that was picked: found along a ray, followed through later snapshots.

use glam::Vec3;

use super::sources::{NamedSource, strongest};
use crate::hierarchy::ElementId;
use crate::render::pick;
use crate::scene::Scene;
use crate::solver::{InspectedElement, Leaf, Mesh, Snapshot, barycentric};

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
    /// The generation whose solver was asked for the element's links.
    asked: Option<u64>,
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
            asked: None,
            origin,
            direction,
        })
    }

    /// Finds the element in a newer snapshot; where it was subdivided, the leaf now lying under the ray takes its
    /// place. False when there is none.
    pub(super) fn follow(&mut self, snapshot: &Snapshot) -> bool {
        let mesh = &snapshot.mesh;
        // Elements are numbered anew when patches are merged back, so a number alone proves nothing.
        let is_it = |(index, leaf): (usize, &Leaf)| {
            leaf.element == self.element
                && leaf.polygon == self.leaf.polygon
                && leaf.area == self.leaf.area
                && holds(mesh, index, self.point)
        };
        let stays = mesh.leaves.get(self.index).is_some_and(|leaf| is_it((self.index, leaf)));
        let found = if stays { Some(self.index) } else { mesh.leaves.iter().enumerate().position(is_it) };
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

    /// The links that a snapshot carries for this element.
    pub(super) fn inspected_by<'a>(&self, snapshot: &'a Snapshot) -> Option<&'a InspectedElement> {
        snapshot.inspected.as_ref().filter(|inspected| inspected.element == self.element)
    }

    /// Names the sources of a newer snapshot.
    pub(super) fn note_sources(&mut self, snapshot: &Snapshot, scene: &Scene) {
        let inspected = self.inspected_by(snapshot);
        self.sources = inspected.map(|inspected| strongest(inspected, snapshot, scene)).unwrap_or_default();
    }

    /// Whether the solver of this snapshot has yet to be asked for the links; true once for each solver, since one that
    /// knows no answer must not be asked for ever.
    pub(super) fn has_to_ask(&mut self, snapshot: &Snapshot) -> bool {
        let is_asked = self.asked == Some(snapshot.generation);
        self.asked = Some(snapshot.generation);
        !is_asked
    }
}

/// How far outside of a triangle, in its own measure, a point may lie that was found on it.
const ON_EDGE: f32 = 1e-3;

/// Whether a point of its plane lies in a leaf.
fn holds(mesh: &Mesh, leaf: usize, point: Vec3) -> bool {
    // Triangles lie in the order of their leaves.
    let first = mesh.triangle_leaf.partition_point(|&of| (of as usize) < leaf);
    let own = mesh.triangle_leaf[first..].iter().take_while(|&&of| of as usize == leaf);
    let mut triangles = own.zip(&mesh.triangles[first..]);
    triangles.any(|(_, corners)| {
        let corners = corners.map(|at| Vec3::from(mesh.positions[at as usize]));
        barycentric(corners, point).min_element() >= -ON_EDGE
    })
}
