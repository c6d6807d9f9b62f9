//! The order of the hierarchy as room on a line: children lie side by side inside of their parent.
//!
//! Views that lay elements out side by side read their places here.

use super::{ElementId, Hierarchy, Shape};

/// Measure by which an element gets room.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Room {
    /// Area: room shows where power can go, and stays while elements are split.
    #[default]
    Area,
    /// The initial patches in it, which quarters share: small things are to be seen, and room stays
    /// as well.
    Polygons,
    /// The leaves in it: most room for what was refined most.
    Leaves,
}

impl Room {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Area, Self::Polygons, Self::Leaves];
}

/// Share of the line, at its end, for sky and sun.
const OUTSIDE: f64 = 0.08;

/// Where each element lies on the line from 0 to 1.
#[derive(Clone, Debug)]
pub struct Order {
    spans: Vec<[f64; 2]>,
}

impl Order {
    /// The places of all elements.
    pub fn new(hierarchy: &Hierarchy, room: Room) -> Self {
        let weights = weights(hierarchy, room);
        let elements = hierarchy.elements();
        let mut spans = vec![[0.0_f64, 1.0]; elements.len()];
        let outside = hierarchy.outside();
        let (count, begin) = (outside.len(), if outside.len() > 0 { 1.0 - OUTSIDE } else { 1.0 });
        spans[Hierarchy::ROOT.index()] = [0.0, begin];
        for (number, id) in outside.enumerate() {
            spans[id.index()] = [number, number + 1].map(|place| begin + OUTSIDE * place as f64 / count as f64);
        }
        // Parents precede their children in the arena.
        for (index, element) in elements.iter().enumerate() {
            let [start, end] = spans[index];
            let total: f64 = element.children().map(|child| weights[child.index()]).sum();
            let (mut at, mut before) = (start, 0.0);
            let count = element.children().len();
            for (number, child) in element.children().enumerate() {
                before += weights[child.index()];
                // Hidden elements have no area, but their place.
                let share = if total > 0.0 { before / total } else { (number + 1) as f64 / count as f64 };
                let next = if number + 1 == count { end } else { (start + share * (end - start)).min(end) };
                spans[child.index()] = [at, next];
                at = next;
            }
        }
        Self { spans }
    }

    /// Beginning and end of an element's place.
    #[inline]
    pub fn span(&self, id: ElementId) -> [f64; 2] {
        self.spans[id.index()]
    }

    /// The elements that lie at a place, from the root (or what lies outside) down to a leaf.
    pub fn path_at(&self, hierarchy: &Hierarchy, place: f64) -> Vec<ElementId> {
        let mut outside = hierarchy.outside().filter(|id| (self.span(*id)[0]..self.span(*id)[1]).contains(&place));
        let mut at = outside.next().unwrap_or(Hierarchy::ROOT);
        let mut path = vec![at];
        loop {
            let children = hierarchy.element(at).children();
            // An element without room is passed over.
            let holds = |child: &ElementId| self.span(*child)[1] > place;
            let Some(child) = children.clone().find(holds).or_else(|| children.last()) else { return path };
            path.push(child);
            at = child;
        }
    }
}

fn weights(hierarchy: &Hierarchy, room: Room) -> Vec<f64> {
    let elements = hierarchy.elements();
    match room {
        Room::Area => elements.iter().map(|element| f64::from(element.area)).collect(),
        Room::Polygons => {
            let mut weights = vec![1.0; elements.len()];
            for (index, element) in elements.iter().enumerate() {
                match (&element.shape, element.parent()) {
                    (Shape::Cluster(cluster), _) => weights[index] = f64::from(cluster.patch_count),
                    (Shape::Patch(patch), Some(parent)) if patch.level > 0 => {
                        weights[index] = weights[parent.index()] / 4.0;
                    }
                    _ => {}
                }
            }
            weights
        }
        Room::Leaves => {
            let mut weights: Vec<f64> =
                elements.iter().map(|element| if element.is_leaf() { 1.0 } else { 0.0 }).collect();
            for (index, element) in elements.iter().enumerate().rev() {
                if let Some(parent) = element.parent() {
                    weights[parent.index()] += weights[index];
                }
            }
            weights
        }
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::geometry::Reachability;
    use crate::hierarchy::ClusteringMode;
    use crate::scene::builtin::BuiltinScene;

    fn hierarchy() -> Hierarchy {
        let scene = BuiltinScene::from_name("office").expect("ours").build();
        let mut hierarchy = Hierarchy::new(&scene, Arc::new(Reachability::default()), ClusteringMode::Adaptive, 4);
        for id in [hierarchy.initial_patches()[7], hierarchy.initial_patches()[1000]] {
            hierarchy.subdivide(id);
        }
        let deeper = hierarchy.element(hierarchy.initial_patches()[7]).children().nth(2).expect("it was split");
        hierarchy.subdivide(deeper);
        hierarchy
    }

    /// Truth: children tile their parent exactly, whatever they get room for.
    #[test]
    fn children_tile_their_parent() {
        let hierarchy = hierarchy();
        for room in Room::ALL {
            let order = Order::new(&hierarchy, room);
            assert_eq!(order.span(Hierarchy::ROOT), [0.0, 1.0]);
            for id in hierarchy.ids() {
                let children: Vec<ElementId> = hierarchy.element(id).children().collect();
                let [start, end] = order.span(id);
                if let (Some(&first), Some(&last)) = (children.first(), children.last()) {
                    assert_eq!((order.span(first)[0], order.span(last)[1]), (start, end));
                }
                for pair in children.windows(2) {
                    assert_eq!(order.span(pair[0])[1], order.span(pair[1])[0]);
                }
            }
        }
    }

    /// Truth: by leaves each leaf has the same room, by polygons each polygon, by area what its
    /// area says.
    #[test]
    fn room_is_for_what_was_asked() {
        let hierarchy = hierarchy();
        let width = |order: &Order, id| order.span(id)[1] - order.span(id)[0];
        let (by_leaves, by_polygons) = (Order::new(&hierarchy, Room::Leaves), Order::new(&hierarchy, Room::Polygons));
        let by_area = Order::new(&hierarchy, Room::Area);
        let (patches, root) = (hierarchy.initial_patches(), hierarchy.element(Hierarchy::ROOT).area);
        for &patch in patches {
            assert!((width(&by_polygons, patch) * patches.len() as f64 - 1.0).abs() < 1e-6);
            let share = f64::from(hierarchy.element(patch).area / root);
            assert!((width(&by_area, patch) - share).abs() < 1e-3 * share + 1e-9);
        }
        let leaves = hierarchy.leaf_count() as f64;
        for id in hierarchy.ids().filter(|&id| hierarchy.element(id).is_leaf()) {
            assert!((width(&by_leaves, id) * leaves - 1.0).abs() < 1e-6);
        }
    }

    /// Truth: the middle of each leaf's place lies in it and in all that hold it.
    #[test]
    fn places_lead_to_their_leaves() {
        let hierarchy = hierarchy();
        let order = Order::new(&hierarchy, Room::Leaves);
        for id in hierarchy.ids().filter(|&id| hierarchy.element(id).is_leaf()) {
            let [start, end] = order.span(id);
            let path = order.path_at(&hierarchy, 0.5 * (start + end));
            assert_eq!(path.last(), Some(&id));
            assert_eq!(path.first(), Some(&Hierarchy::ROOT));
        }
    }
}
