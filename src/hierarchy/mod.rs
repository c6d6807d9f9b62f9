//! Placeholder for the arena of elements.

/// Index of an element in the hierarchy's arena; the root cluster is `ElementId(0)`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct ElementId(pub u32);
