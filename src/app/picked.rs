//! The element that was picked: found along a ray, followed through later snapshots.

use std::collections::HashMap;

use glam::Vec3;

use super::sources::{NamedSource, strongest};
use crate::hierarchy::ElementId;
use crate::render::pick;
use crate::scene::Scene;
use crate::solver::{InspectedElement, Leaf, Mesh, Snapshot};

/// A leaf element, and the ray that found it.
pub(super) struct PickedElement {
    pub element: ElementId,
    /// The leaf as the present snapshot has it.
    pub leaf: Leaf,
    /// Index of the leaf in the present snapshot.
    pub index: usize,
    /// The point that the ray met.
    pub point: Vec3,
    /// The rim of the leaf, as pairs of points.
    pub outline: Vec<[Vec3; 2]>,
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
        let outline = outline_of(mesh, found.leaf);
        Some(Self {
            element: leaf.element,
            leaf,
            index,
            point: found.point,
            outline,
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
        let is_it = |leaf: &Leaf| {
            leaf.element == self.element && leaf.polygon == self.leaf.polygon && leaf.area == self.leaf.area
        };
        let stays = mesh.leaves.get(self.index).is_some_and(is_it);
        let found = if stays { Some(self.index) } else { mesh.leaves.iter().position(is_it) };
        match found {
            Some(index) => {
                if !stays || self.outline.is_empty() {
                    self.outline = outline_of(mesh, index as u32);
                }
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

/// The edges that only one triangle of the leaf has.
fn outline_of(mesh: &Mesh, leaf: u32) -> Vec<[Vec3; 2]> {
    let mut uses: HashMap<[u32; 2], u32> = HashMap::new();
    let triangles = mesh.triangles.iter().zip(&mesh.triangle_leaf).filter(|(_, of)| **of == leaf);
    for (&[a, b, c], _) in triangles {
        for [from, to] in [[a, b], [b, c], [c, a]] {
            *uses.entry([from.min(to), from.max(to)]).or_default() += 1;
        }
    }
    let rim = uses.into_iter().filter(|(_, count)| *count == 1);
    rim.map(|(ends, _)| ends.map(|end| Vec3::from(mesh.positions[end as usize]))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A square of two triangles has four edges on its rim; the diagonal is none of them.
    #[test]
    fn the_rim_has_no_inner_edges() {
        let mesh = Mesh {
            positions: vec![[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]],
            triangles: vec![[0, 1, 2], [0, 2, 3]],
            triangle_leaf: vec![0, 0],
            ..Mesh::default()
        };
        let rim = outline_of(&mesh, 0);
        assert_eq!(rim.len(), 4);
        let length: f32 = rim.iter().map(|[from, to]| from.distance(*to)).sum();
        assert!((length - 4.0).abs() < 1e-6);
    }
}
