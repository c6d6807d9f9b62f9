//! The tree as light reads it: where it passes over all elements, memory is what it waits for, so
//! each element is the little that is asked of it. Leaves, which are most of it, are passed over by
//! all threads, elements with children by one.

use std::ops::Range;

use glam::Vec3;
use rayon::prelude::*;

use crate::hierarchy::{Element, Hierarchy, Shape};

/// Leaves that one task passes over at least; a fixed number where sums are made, for them to be
/// the same for any number of threads.
pub const CHUNK: usize = 1 << 13;
/// Stands for "no parent".
const NONE: u32 = u32::MAX;

/// Kind of an element.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    Cluster,
    /// A patch that was split.
    Split,
    /// A patch that was not.
    Leaf,
    /// Sky or sun, whose light stays as it is.
    Sky,
}

/// An element.
#[derive(Clone, Copy, Debug)]
pub struct Node {
    parent: u32,
    /// Polygon of a patch.
    pub polygon: u32,
    /// Area that light can reach, m².
    pub area: f32,
    /// Unit normal of a patch.
    pub normal: Vec3,
    pub kind: Kind,
    has_children: bool,
}

/// An element with children.
#[derive(Clone, Debug)]
pub struct Inner {
    pub index: usize,
    pub children: Range<usize>,
    /// Place of its parent among the elements with children, or [`NONE`].
    parent: u32,
}

/// All elements, parallel to the arena, and those with children, parents first.
pub struct Nodes {
    all: Vec<Node>,
    inner: Vec<Inner>,
}

impl Node {
    fn of(element: &Element) -> Self {
        let (kind, polygon, normal) = match element.shape {
            Shape::Patch(patch) if element.is_leaf() => (Kind::Leaf, patch.polygon, patch.normal),
            Shape::Patch(patch) => (Kind::Split, patch.polygon, patch.normal),
            Shape::Cluster(_) => (Kind::Cluster, NONE, Vec3::ZERO),
            Shape::Sky(_) => (Kind::Sky, NONE, Vec3::ZERO),
        };
        Self {
            normal,
            parent: element.parent().map_or(NONE, |parent| parent.0),
            polygon,
            area: element.area,
            kind,
            has_children: !element.is_leaf(),
        }
    }

    /// Index of the parent.
    pub fn parent(&self) -> Option<usize> {
        (self.parent != NONE).then_some(self.parent as usize)
    }

    /// Whether it has children.
    pub fn has_children(&self) -> bool {
        self.has_children
    }

    /// Whether it is a patch, split or not.
    pub fn is_patch(&self) -> bool {
        matches!(self.kind, Kind::Leaf | Kind::Split)
    }
}

impl Nodes {
    /// Those of a hierarchy.
    pub fn new(hierarchy: &Hierarchy) -> Self {
        let elements = hierarchy.elements();
        let all: Vec<Node> = elements.par_iter().with_min_len(CHUNK).map(Node::of).collect();
        let with_children: Vec<usize> = (0..all.len()).filter(|index| all[*index].has_children).collect();
        let mut places = vec![NONE; all.len()];
        let inner = with_children.into_iter().zip(0_u32..).map(|(index, place)| {
            places[index] = place;
            let children = elements[index].children();
            let first = children.clone().next().map_or(0, |child| child.index());
            let parent = all[index].parent().map_or(NONE, |parent| places[parent]);
            Inner { index, children: first..first + children.len(), parent }
        });
        Self { inner: inner.collect(), all }
    }

    /// All of them.
    pub fn all(&self) -> &[Node] {
        &self.all
    }

    /// Those with children, parents first.
    pub fn inner(&self) -> impl DoubleEndedIterator<Item = &Inner> {
        self.inner.iter()
    }

    /// Sets the radiosity of all elements with children, but those that lie outside, from their
    /// leaves', by area.
    pub fn pull(&self, radiosity: &mut [Vec3]) {
        // Σ A·B of the children, W: first of the leaves among them.
        let of_leaves = |inner: &Inner| -> Vec3 {
            let children = inner.children.clone().filter(|child| self.all[*child].kind == Kind::Leaf);
            children.map(|child| self.all[child].area * radiosity[child]).sum()
        };
        let mut power: Vec<Vec3> = self.inner.par_iter().with_min_len(CHUNK / 8).map(of_leaves).collect();
        for (place, inner) in self.inner.iter().enumerate().rev() {
            let node = &self.all[inner.index];
            if node.kind == Kind::Sky {
                continue;
            }
            radiosity[inner.index] = if node.area > 0.0 { power[place] / node.area } else { Vec3::ZERO };
            let own = node.area * radiosity[inner.index];
            if let Some(above) = power.get_mut(inner.parent as usize) {
                *above += own;
            }
        }
    }
}
