//! Memory of a solve, counted in bytes, and where refinement stops for the sake of a budget.
//!
//! Counted are the tables by their lengths, with what is made of them while a step, a picture or a
//! window works: so the count, and what is decided by it, is the same for any number of threads and
//! on any machine. What the graphics driver takes, and what a parser takes while a scene is read,
//! is not counted. `docs/limits.md` tells how near the count is to the process's memory.

use serde::Serialize;

use super::timeline::Timeline;
use super::{Solver, SolverError};
use crate::gather::Gather;
use crate::hierarchy::{ElementId, Hierarchy};
use crate::transport::{Link, Refinement, Waiting};

/// A link while it waits to be taken into the table.
const NEW_LINK: usize = size_of::<(ElementId, Link)>();
/// A link in the table: itself, a copy of the table that a picture is made of, the table that
/// either grows into, and how its light is handed down.
const LINK: usize = 3 * size_of::<Link>() + 8;
/// A pair that waits: itself, and what it comes to where it is not refined: a link in either
/// direction, one of which is kept.
const WAITING: usize = size_of::<Waiting>() + 2 * NEW_LINK + LINK;
/// An element beside itself in the arena: its light (also that of a picture and of a sweep), what
/// verdicts look at, what a sweep reads and writes, where its links start, and its part of the
/// table of midpoints while that grows.
const ELEMENT: usize = 3 * 40 + 8 + 36 + 16 + 24;
/// A leaf as triangles: the mesh that is shown and the one that is being made, how values of leaves
/// become values of vertices, and two pictures of values.
const LEAF: usize = 2 * 106 + 51 + 120 + 2 * 53;
/// Where a window looks, one more picture, and one more copy of the mesh.
const LEAF_IN_WINDOW: usize = 106 + 53;
/// Where a window looks, the solution views of three pictures, and the order of one by sources.
const LINK_IN_WINDOW: usize = 3 * size_of::<Link>() + 12 + NEW_LINK;
/// Where a window looks, the light of three pictures, and two copies of the arena.
const ELEMENT_IN_WINDOW: usize = 3 * 40 + 2 * 140;
/// A leaf that a final gather starts with, with its share of the elements above it, and one pass of
/// the fewest looks.
pub(super) const GATHERED_LEAF: usize = 2000;

/// The part that could not be refined further within the memory budget.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum MemoryStop {
    /// Anything: the scene alone takes as much.
    Scene,
    /// Links and the elements that they join.
    Links,
    /// The leaves of the final gather.
    Vertices,
    /// The looks from its leaves.
    Rays,
}

impl MemoryStop {
    /// Name of the part, in one word.
    pub fn what(self) -> &'static str {
        match self {
            Self::Scene => "scene",
            Self::Links => "links",
            Self::Vertices => "mesh",
            Self::Rays => "rays",
        }
    }

    /// Consequence of the stop, for a person.
    pub fn in_words(self) -> &'static str {
        match self {
            Self::Scene => "the scene alone takes as much, and nothing was refined",
            Self::Links => "links are coarser than was asked for",
            Self::Vertices => "the mesh is coarser than the error asks for",
            Self::Rays => "the final gather has fewer rays than the error asks for",
        }
    }
}

/// Whether plain HR's links fit into so many bytes, should every pair become one.
pub fn check_pairs_fit(patches: u64, budget: u64) -> Result<(), SolverError> {
    let pairs = patches * patches.saturating_sub(1);
    // A link and its receiver while it waits to be taken into the table.
    let needed = pairs * (size_of::<Link>() + NEW_LINK) as u64;
    if needed <= budget / 2 {
        return Ok(());
    }
    Err(SolverError::TooManyPairs { pairs, needed_mib: needed >> 20, budget_mib: budget >> 20 })
}

impl Solver {
    /// Bytes that scene and solution take, by count.
    pub(super) fn counted_bytes(&self) -> usize {
        self.bytes_of_links() + self.gather.as_ref().map_or(0, Gather::bytes)
    }

    /// Bytes that the solution may take in all.
    pub(super) fn budget_bytes(&self) -> usize {
        usize::try_from(self.params.memory.bytes()).unwrap_or(usize::MAX)
    }

    /// Bytes that all but the final gather may take: where one is to come, it has half of what the
    /// scene leaves.
    pub(super) fn budget_of_links(&self) -> usize {
        let (budget, scene) = (self.budget_bytes(), self.scene_bytes());
        if self.is_to_gather() { scene.min(budget) + budget.saturating_sub(scene) / 2 } else { budget }
    }

    /// Bytes that a final gather may take.
    pub(super) fn budget_of_gather(&self) -> usize {
        self.budget_bytes().saturating_sub(self.bytes_of_links())
    }

    /// Whether a window keeps copies beside the solver's own tables.
    pub(super) fn is_watched(&self) -> bool {
        self.timeline.is_some()
    }

    fn scene_bytes(&self) -> usize {
        // A window also keeps the scene as its file has it.
        let copies = if self.is_watched() { 2 } else { 1 };
        copies * self.scene().bytes() + self.links.occluders().bytes() + size_of_val(self.links.surfaces())
    }

    /// Bytes that refinement does not change.
    pub(super) fn lasting_bytes(&self) -> usize {
        let of_link = if self.is_watched() { LINK + LINK_IN_WINDOW } else { LINK };
        let timeline = self.timeline.as_ref().map_or(0, Timeline::bytes);
        let tables = size_of_val(self.links.normal_moments());
        self.scene_bytes() + tables + timeline + self.links().len() * of_link
    }

    fn bytes_of_links(&self) -> usize {
        self.lasting_bytes() + growing_bytes(self.links.refinement(), self.hierarchy(), self.is_watched())
    }

    /// Whether the leaves that there are leave room for a final gather.
    pub(super) fn has_room_for_gather(&self) -> bool {
        self.hierarchy().leaf_count() * GATHERED_LEAF <= self.budget_of_gather()
    }
}

/// Bytes that refinement adds to: elements, and pairs in every state.
pub(super) fn growing_bytes(refinement: &Refinement, hierarchy: &Hierarchy, is_watched: bool) -> usize {
    let watched = usize::from(is_watched);
    let elements = hierarchy.elements().len() * (ELEMENT + watched * ELEMENT_IN_WINDOW);
    let leaves = hierarchy.leaf_count() * (LEAF + watched * LEAF_IN_WINDOW);
    let (wave, next_wave) = refinement.waiting_len();
    let accepted = refinement.accepted.len() * (NEW_LINK + LINK + watched * LINK_IN_WINDOW);
    let waiting = (wave + next_wave) * (WAITING + watched * 2 * LINK_IN_WINDOW);
    hierarchy.bytes() + elements + leaves + accepted + waiting + 2 * size_of_val(&refinement.occluded[..])
}
