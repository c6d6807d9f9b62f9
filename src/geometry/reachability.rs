//! Reachability: which parts of a face light can reach at all.
//!
//! Things stand on tables, lamps are screwed to ceilings, frames run behind panes: much of a room's
//! surface lies inside of something and sees nothing but the backs of faces, which send no light.
//! Such parts must not count as area. A patch that lies half under a box would else be shown half
//! as bright as it is beside the box, and would send half of its light into the box: in the seminar
//! room 7 % of the area is hidden like this, and took 6 % of the power with it.
//!
//! Each polygon that is large enough is cut into 4^k cells, the very quarters into which refinement
//! would split it, and rays from four points tell how much of each is hidden. A patch then has the
//! area that is reachable. Random points of it lie on all cells that are reachable at all, so that
//! none of the light that goes to them is missed.

use glam::Vec3;
use rayon::prelude::*;

use super::{EnclosureTest, Occluders};
use crate::base::random::hash64;
use crate::scene::{Polygon, Scene};

/// Cells have about this share of a scene's area: a square of 30 cm in a seminar room.
const CELL_SHARE: f32 = 1.0 / 4_096.0;
/// A polygon is cut into no more than 4^5 cells.
const MOST_LEVELS: u32 = 5;
/// Points looked at in a cell, one in each of its quarters.
const POINTS: u8 = 4;
/// Rays that must all meet backs before a point is believed to be hidden: of one that sees a sixth
/// of the room, one in twenty is mistaken for hidden.
const RAYS: u32 = 16;

/// The hidden parts of each polygon of a scene.
#[derive(Clone, Debug, Default)]
pub struct Reachability {
    /// Cells of each polygon; empty where nothing is hidden in the whole scene.
    polygons: Vec<Cells>,
    /// How many points of each cell are reachable, for the polygons that are hidden in part.
    reachable: Vec<u8>,
}

/// The cells of a patch, the quarters of its quarters in the order of their numbers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Cells {
    first: u32,
    /// A power of four; 0 stands for a patch that is reachable wholly, as far as is known.
    count: u32,
}

/// How much of a patch is reachable, as shares of its area.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shares {
    /// Share of the area that light can reach.
    pub reachable: f32,
    /// The cells of which light can reach a part: where random points lie.
    pub sampled: f32,
}

impl Cells {
    /// Whether the whole patch is reachable.
    #[inline]
    pub fn are_all_reachable(self) -> bool {
        self.count == 0
    }

    fn range(self) -> std::ops::Range<usize> {
        self.first as usize..(self.first + self.count) as usize
    }
}

impl Reachability {
    /// Looks at a scene whose occluders these are.
    pub fn new(scene: &Scene, occluders: &Occluders) -> Self {
        if !scene.has_dark_sides() {
            return Self::default();
        }
        let total: f32 = scene.polygons.iter().map(|polygon| scene.area(polygon)).sum();
        let test = EnclosureTest::new(scene, occluders);
        let look = |(index, polygon): (usize, &Polygon)| {
            reachable_points(scene, &test, index as u32, polygon, CELL_SHARE * total)
        };
        let looked: Vec<Vec<u8>> = scene.polygons.par_iter().enumerate().map(look).collect();
        let mut reachability = Self::default();
        if looked.iter().all(Vec::is_empty) {
            return reachability;
        }
        for reachable in looked {
            reachability
                .polygons
                .push(Cells { first: reachability.reachable.len() as u32, count: reachable.len() as u32 });
            reachability.reachable.extend(reachable);
        }
        reachability
    }

    /// The cells of a polygon.
    pub fn of_polygon(&self, polygon: u32) -> Cells {
        self.polygons.get(polygon as usize).copied().unwrap_or_default()
    }

    /// The cells of a quarter of the patch that has these; a single cell is not cut further.
    pub fn of_quarter(&self, cells: Cells, quarter: u32) -> Cells {
        if cells.count < 4 {
            return cells;
        }
        let count = cells.count / 4;
        let part = Cells { first: cells.first + quarter * count, count };
        if self.reachable[part.range()].iter().all(|points| *points == POINTS) { Cells::default() } else { part }
    }

    /// How much of a patch with these cells is reachable.
    pub fn shares(&self, cells: Cells) -> Shares {
        if cells.count == 0 {
            return Shares { reachable: 1.0, sampled: 1.0 };
        }
        let reachable = self.reachable[cells.range()].iter().map(|points| f32::from(*points)).sum::<f32>();
        let sampled = self.sampled_cells(cells) as f32;
        Shares {
            reachable: reachable / (f32::from(POINTS) * cells.count as f32),
            sampled: sampled / cells.count as f32,
        }
    }

    /// How much of the cell at a corner of a patch is reachable, as a share of its area; corners
    /// are numbered like the quarters that hold them.
    pub fn share_at_corner(&self, cells: Cells, corner: u32) -> f32 {
        if cells.are_all_reachable() {
            return 1.0;
        }
        // The quarter of that number, of its quarters that of the same number, and so on.
        let cell = cells.first + corner * (cells.count - 1) / 3;
        f32::from(self.reachable[cell as usize]) / f32::from(POINTS)
    }

    /// The cell at `u` in 0..1 of all cells of a patch that are reachable at all, as the quarters
    /// that lead to it from the patch, and how far `u` is into it; `None` where nothing is
    /// reachable.
    pub fn sampled_cell(&self, cells: Cells, u: f32) -> Option<(impl Iterator<Item = u32> + use<>, f32)> {
        let sampled = self.sampled_cells(cells);
        let wanted = u.clamp(0.0, 1.0) * sampled as f32;
        let rank = (wanted as u32).min(sampled.checked_sub(1)?);
        let mut places = (0..cells.count).filter(|cell| self.reachable[(cells.first + cell) as usize] > 0);
        let cell = places.nth(rank as usize)?;
        let levels = cells.count.ilog2() / 2;
        let quarters = (0..levels).rev().map(move |level| (cell >> (2 * level)) & 3);
        Some((quarters, (wanted - rank as f32).clamp(0.0, 1.0)))
    }

    /// Memory, bytes.
    pub fn bytes(&self) -> usize {
        size_of_val(&self.polygons[..]) + size_of_val(&self.reachable[..])
    }

    fn sampled_cells(&self, cells: Cells) -> u32 {
        self.reachable[cells.range()].iter().filter(|points| **points > 0).count() as u32
    }
}

/// How many points of each cell of a polygon are reachable; nothing where all are.
fn reachable_points(scene: &Scene, test: &EnclosureTest, index: u32, polygon: &Polygon, cell: f32) -> Vec<u8> {
    let area = scene.area(polygon);
    if area < 0.25 * cell {
        return Vec::new();
    }
    let levels = (0.5 * (area / cell).log2()).round().clamp(0.0, MOST_LEVELS as f32) as u32;
    let (corners, corner_count) = scene.corner_positions(polygon);
    let normal = scene.normal(polygon);
    let reachable = |cell: u32| {
        let quarters = (0..levels).rev().map(|level| (cell >> (2 * level)) & 3);
        let corners = quarters.fold(corners, |corners, number| quarter(corners, corner_count, number));
        let is_reachable = |part: &u32| {
            let seed = hash64(u64::from(index), u64::from(u32::from(POINTS) * cell + part));
            // Anywhere in the quarter: what is as regular as the cells must not meet all their
            // middles.
            let point = point_in(quarter(corners, corner_count, *part), corner_count, uniform(hash64(seed, 1)));
            !test.is_enclosed(point, normal, seed, RAYS)
        };
        (0..u32::from(POINTS)).filter(is_reachable).count() as u8
    };
    let cells: Vec<u8> = (0..1_u32 << (2 * levels)).map(reachable).collect();
    if cells.iter().all(|points| *points == POINTS) { Vec::new() } else { cells }
}

/// Corners of one of the quarters into which a triangle or quad is split.
pub fn quarter([a, b, c, d]: [Vec3; 4], corner_count: usize, number: u32) -> [Vec3; 4] {
    let middle = |from: Vec3, to: Vec3| 0.5 * (from + to);
    if corner_count == 3 {
        let (ab, bc, ca) = (middle(a, b), middle(b, c), middle(c, a));
        return match number {
            0 => [a, ab, ca, d],
            1 => [ab, b, bc, d],
            2 => [ca, bc, c, d],
            _ => [bc, ca, ab, d],
        };
    }
    let (ab, bc, cd, da) = (middle(a, b), middle(b, c), middle(c, d), middle(d, a));
    let centre = (a + b + c + d) / 4.0;
    match number {
        0 => [a, ab, centre, da],
        1 => [ab, b, bc, centre],
        2 => [centre, bc, c, cd],
        _ => [da, centre, cd, d],
    }
}

/// The point of a triangle or quad at `(u, v)`.
pub(super) fn point_in([a, b, c, d]: [Vec3; 4], corner_count: usize, [u, v]: [f32; 2]) -> Vec3 {
    if corner_count == 3 {
        let (u, v) = if u + v > 1.0 { (1.0 - u, 1.0 - v) } else { (u, v) };
        return a + u * (b - a) + v * (c - a);
    }
    a.lerp(b, u).lerp(d.lerp(c, u), v)
}

/// Two numbers in 0..1 of a hash.
pub(super) fn uniform(number: u64) -> [f32; 2] {
    [number >> 40, (number >> 8) & 0xff_ffff].map(|bits| bits as f32 / 16_777_216.0)
}
