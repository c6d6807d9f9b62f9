//! What a final gather has in memory, by count, and what memory did not allow it.

use glam::Vec3;

use super::stance::Stance;
use super::vertices::Vertex;
use super::{FinalGather, MemoryStop};
use crate::hierarchy::ElementId;

/// Values of a vertex that there are at a time: direct and indirect light, that of the sweep before, what is reflected, what a pass
/// says alone, and those of two pictures.
const VALUES: usize = 10;
/// What is carried over from a vertex to the same one of a finer mesh, bytes.
const CARRIED: usize = 120;
/// What the allocator keeps beside a small allocation, bytes.
const ALLOCATION: usize = 16;

impl FinalGather {
    /// Whether more rays or vertices would fit.
    pub(super) fn has_room(&self) -> bool {
        self.memory_stop.is_none() && self.rows.has_room()
    }

    /// What memory did not allow, if anything.
    pub fn memory_stop(&self) -> Option<MemoryStop> {
        self.memory_stop
    }

    /// Memory with what is made of it while it works, bytes.
    pub fn bytes(&self) -> usize {
        let stances = size_of_val(&self.stances[..]) + self.vertices.len() * (size_of::<Stance>() + ALLOCATION);
        let vertices = self.vertices.len() * (size_of::<Vertex>() + VALUES * size_of::<Vec3>() + CARRIED);
        let looks = 2 * self.looks.len() * size_of::<(ElementId, (f64, u32))>();
        // A mesh that is split stands beside the one that it is made into.
        2 * self.display.bytes() + self.rows.bytes() + stances + vertices + looks
    }
}
