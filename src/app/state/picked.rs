//! The element that a person chose, by a click into the view or by name, and how it is found again
//! in later snapshots.
//!
//! A chosen element is remembered as its path from the root. A snapshot that does not know all of
//! it, such as one of a former step, shows the deepest element of the path that it knows; the rest
//! is taken up again when it is there.

use glam::Vec3;
use rustc_hash::FxHashMap;

use crate::hierarchy::ElementId;
use crate::render::pick;
use crate::solve::Snapshot;
use crate::transport::SolutionView;

/// A patch or cluster, and how it was found.
pub struct PickedElement {
    /// The element as the present snapshot has it.
    pub element: ElementId,
    /// The point that was clicked, or the element's centre.
    pub point: Vec3,
    found: Found,
    /// Ids and keys from the root down to what was chosen; empty while no solution view was there.
    path: Vec<(ElementId, u64)>,
    /// Generation of the ids.
    generation: u64,
}

/// How an element was found.
#[derive(Clone, Copy)]
enum Found {
    /// As the first leaf along a ray: where it is subdivided, the leaf then lying under the ray
    /// takes its place.
    ByRay { origin: Vec3, direction: Vec3 },
    /// By its id: it stays what it is.
    ById,
}

impl PickedElement {
    /// The first leaf along a ray.
    pub fn at(snapshot: &Snapshot, origin: Vec3, direction: Vec3) -> Option<Self> {
        let found = pick(&snapshot.mesh, origin, direction)?;
        let element = snapshot.mesh.leaves.get(found.leaf as usize)?.element;
        let found_by = Found::ByRay { origin, direction };
        Some(Self::new(snapshot, element, found.point, found_by))
    }

    /// Any element; `None` where the snapshot does not know it.
    pub fn by_id(snapshot: &Snapshot, element: ElementId) -> Option<Self> {
        let solution_view = snapshot.solution_view.as_ref().filter(|solution_view| solution_view.holds(element))?;
        let centre = solution_view.hierarchy().element(element).centre;
        Some(Self::new(snapshot, element, centre, Found::ById))
    }

    fn new(snapshot: &Snapshot, element: ElementId, point: Vec3, found: Found) -> Self {
        let mut picked = Self { element, point, found, path: Vec::new(), generation: snapshot.generation };
        if let Some(solution_view) = &snapshot.solution_view {
            picked.note_path(solution_view);
        }
        picked
    }

    fn note_path(&mut self, solution_view: &SolutionView) {
        if solution_view.holds(self.element) {
            let key = |id: ElementId| solution_view.hierarchy().element(id).key;
            self.path = solution_view.path(self.element).into_iter().map(|id| (id, key(id))).collect();
        }
    }

    /// Finds the element in a newer snapshot. False when nothing of its path is there.
    pub fn follow(&mut self, snapshot: &Snapshot) -> bool {
        if let Found::ByRay { origin, direction } = self.found
            && !self.is_leaf_of(snapshot)
        {
            let Some(other) = Self::at(snapshot, origin, direction) else { return false };
            *self = other;
            return true;
        }
        let Some(solution_view) = &snapshot.solution_view else {
            // Nobody can tell elements of another hierarchy apart without it.
            return snapshot.generation == self.generation || !self.path.is_empty();
        };
        if self.path.is_empty() {
            self.note_path(solution_view);
        }
        match deepest_known(&self.path, solution_view) {
            Some(element) => {
                self.element = element;
                if snapshot.generation != self.generation {
                    self.generation = snapshot.generation;
                    self.note_path(solution_view);
                }
                true
            }
            None => false,
        }
    }

    /// Whether the element is a leaf of this snapshot.
    fn is_leaf_of(&self, snapshot: &Snapshot) -> bool {
        snapshot.generation == self.generation && snapshot.mesh.leaves.iter().any(|leaf| leaf.element == self.element)
    }
}

/// The deepest element of a path that is there: under its own id, or under another one where
/// elements were numbered anew.
fn deepest_known(path: &[(ElementId, u64)], solution_view: &SolutionView) -> Option<ElementId> {
    let hierarchy = solution_view.hierarchy();
    let &(last, key) = path.last()?;
    if solution_view.holds(last) && hierarchy.element(last).key == key {
        return Some(last);
    }
    let depth_of: FxHashMap<u64, usize> = path.iter().enumerate().map(|(depth, &(_, key))| (key, depth)).collect();
    let known = hierarchy.ids().filter_map(|id| Some((*depth_of.get(&hierarchy.element(id).key)?, id)));
    known.max().map(|(_, id)| id)
}
