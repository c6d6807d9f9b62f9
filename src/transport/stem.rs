//! The stem of the tree: as much of it as light is moved over.
//!
//! Of a large scene few elements have links. The stem holds those that a link ends in or hands
//! light to, all that holds them, and the children of these. Within what hangs on its rim no link
//! ends: what it reflects is the same linear function of what reaches it in every sweep, so no
//! sweep passes over it.

use glam::Vec3;

use super::nodes::{Kind, Node, Nodes};
use crate::hierarchy::ElementId;

/// Stands for "no parent".
const NONE: u32 = u32::MAX;

/// An element of the stem.
#[derive(Clone, Copy, Debug)]
pub struct StemElement {
    /// Place in the arena.
    pub index: usize,
    /// The element.
    pub node: Node,
    /// Whether no link ends below it.
    pub is_rim: bool,
    parent: u32,
}

/// The stem, parents first.
pub struct Stem {
    elements: Vec<StemElement>,
    /// Place in the stem of each element of the arena, or of the one on the rim around it.
    places: Vec<u32>,
}

impl StemElement {
    /// Place of the parent.
    pub fn parent(&self) -> Option<usize> {
        (self.parent != NONE).then_some(self.parent as usize)
    }
}

impl Stem {
    /// The stem with these ends of links.
    pub fn new(nodes: &Nodes, ends: impl Iterator<Item = ElementId>) -> Self {
        let nodes = nodes.all();
        let mut is_needed = vec![false; nodes.len()];
        for end in ends {
            let mut next = Some(end.index());
            while let Some(index) = next.filter(|index| !is_needed[*index]) {
                is_needed[index] = true;
                next = nodes[index].parent();
            }
        }
        let (mut elements, mut places) = (Vec::new(), Vec::with_capacity(nodes.len()));
        for (index, node) in nodes.iter().enumerate() {
            let parent = node.parent();
            if parent.is_some_and(|parent| !is_needed[parent]) {
                places.push(parent.map_or(NONE, |parent| places[parent]));
                continue;
            }
            places.push(elements.len() as u32);
            let is_rim = !(is_needed[index] && node.has_children());
            let parent = parent.map_or(NONE, |parent| places[parent]);
            elements.push(StemElement { index, node: *node, is_rim, parent });
        }
        Self { elements, places }
    }

    /// Elements of the stem, parents first.
    pub fn elements(&self) -> &[StemElement] {
        &self.elements
    }

    /// Place of an element, or of the one on the rim that holds it.
    #[inline]
    pub fn place(&self, index: usize) -> usize {
        self.places[index] as usize
    }

    /// A table over the arena, as the stem needs of it.
    pub fn of<T: Copy>(&self, table: &[T]) -> Vec<T> {
        self.elements.iter().map(|element| table[element.index]).collect()
    }

    /// Sets the radiosity of all but the rim and what lies outside from the rim's, by area.
    pub fn pull(&self, radiosity: &mut [Vec3]) {
        let mut power = vec![Vec3::ZERO; self.elements.len()];
        for (place, element) in self.elements.iter().enumerate().rev() {
            let Node { area, kind, .. } = element.node;
            if kind == Kind::Sky {
                continue;
            }
            if !element.is_rim {
                radiosity[place] = if area > 0.0 { power[place] / area } else { Vec3::ZERO };
            }
            if let Some(parent) = element.parent() {
                power[parent] += area * radiosity[place];
            }
        }
    }
}
