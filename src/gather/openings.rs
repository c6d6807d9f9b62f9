//! Where a scene is open to the sky, as some thousand rays from its surfaces find out: directions
//! in which they leave it, apart for the cells of a grid. Rays that look for the sky are drawn by
//! what is seen there, so that few of them end on walls around a window.

use glam::Vec3;
use rayon::prelude::*;

use super::field::{End, Field};
use crate::base::random::{cosine_direction, hash64};
use crate::hierarchy::Hierarchy;
use crate::scene::outside::{Drawn, Outside, SkyTable};

/// Rays that look for openings.
pub(super) const RAYS: u32 = 1 << 17;
/// Cells of the grid, about.
const CELLS: f32 = 64.0;
/// Rows and columns of a cell's directions: 7° wide.
const DIRECTIONS: [usize; 2] = [24, 48];
/// The openings seen from all cells together count as so many rays of each cell.
const RAYS_OF_ALL: f32 = 4.0;
/// Where more of the light comes in than this share, openings are found by any ray.
const WIDE_OPEN: f64 = 0.5;
/// Points of a sequence; `sobol_burley` has so many.
const SEQUENCE: u32 = 1 << 16;

/// Parts of the sky that are seen from the cells of a grid.
pub(super) struct Openings {
    lower: Vec3,
    /// Cells for each length.
    per_length: Vec3,
    counts: [usize; 3],
    /// Directions by their radiance and by how much is seen of them; none where no part of the sky
    /// is.
    tables: Vec<Option<SkyTable>>,
}

/// Rays in directions, and those of them that left the scene.
#[derive(Clone, Default)]
struct Seen {
    cast: Vec<f32>,
    open: Vec<f32>,
}

impl Seen {
    fn new() -> Self {
        let none = vec![0.0; DIRECTIONS[0] * DIRECTIONS[1]];
        Self { cast: none.clone(), open: none }
    }

    fn add(&mut self, direction: usize, is_open: bool) {
        self.cast[direction] += 1.0;
        self.open[direction] += f32::from(u8::from(is_open));
    }

    /// Share of rays that left in a direction; what others found counts as some more.
    fn share(&self, direction: usize, of_all: f32) -> f32 {
        (self.open[direction] + RAYS_OF_ALL * of_all) / (self.cast[direction] + RAYS_OF_ALL)
    }
}

impl Openings {
    /// Looks for openings from all surfaces of a field; `None` where it is open all around or no
    /// sky shines.
    pub fn find(field: &Field, outside: &Outside, seed: u64) -> Option<Self> {
        if !outside.has_sky() {
            return None;
        }
        let (lower, upper) = field.scene().bounds();
        let extent = (upper - lower).max(Vec3::splat(1e-6 * lower.distance(upper).max(f32::MIN_POSITIVE)));
        let side = (extent.element_product() / CELLS).cbrt();
        let counts =
            (extent / side).round().clamp(Vec3::ONE, Vec3::splat(CELLS)).to_array().map(|count| count as usize);
        let per_length = Vec3::from(counts.map(|count| count as f32)) / extent;
        let mut openings = Self { lower, per_length, counts, tables: Vec::new() };
        let found: Vec<(usize, usize, bool)> =
            (0..RAYS).into_par_iter().map(|ray| openings.ray(field, outside, seed, ray)).collect();
        let mut all = Seen::new();
        let mut cells = vec![Seen::new(); counts.iter().product()];
        for (cell, direction, is_open) in found {
            all.add(direction, is_open);
            cells[cell].add(direction, is_open);
        }
        let weights = outside.weights(DIRECTIONS);
        let (mut shining, mut seen) = (0.0, 0.0);
        for (direction, weight) in weights.iter().enumerate() {
            // Radiances in one unit or another: of a row, all solid angles are as the sine of its
            // angle.
            let radiance = weight / sine(direction / DIRECTIONS[1]);
            shining += radiance * f64::from(all.cast[direction]);
            seen += radiance * f64::from(all.open[direction]);
        }
        if seen > WIDE_OPEN * shining {
            return None;
        }
        let table = |cell: &Seen| {
            let seen = |direction: usize| cell.share(direction, all.share(direction, 0.0));
            let weights = weights.iter().enumerate().map(|(direction, weight)| weight * f64::from(seen(direction)));
            SkyTable::of_weights(DIRECTIONS, &weights.collect::<Vec<_>>())
        };
        openings.tables = cells.par_iter().map(table).collect();
        Some(openings)
    }

    /// One ray from a random place: its cell, its direction and whether it left the scene.
    fn ray(&self, field: &Field, outside: &Outside, seed: u64, ray: u32) -> (usize, usize, bool) {
        let scramble = hash64(seed, (ray / SEQUENCE).into()) as u32;
        let [u, v, w, x] = sobol_burley::sample_4d(ray % SEQUENCE, 0, scramble);
        let from = field.hierarchy.point_on(Hierarchy::ROOT, u, v);
        let direction = cosine_direction(from.normal, w, x);
        let is_open = matches!(field.meet(from.position, from.normal, direction), End::Outside);
        (self.cell(from.position), place(outside.in_sky(direction)), is_open)
    }

    /// The cell of a point.
    fn cell(&self, point: Vec3) -> usize {
        let along = ((point - self.lower) * self.per_length).max(Vec3::ZERO).to_array();
        let [x, y, z] = [0, 1, 2].map(|axis| (along[axis] as usize).min(self.counts[axis] - 1));
        (z * self.counts[1] + y) * self.counts[0] + x
    }

    /// A direction of the scene drawn by what is seen from a point.
    pub fn draw(&self, outside: &Outside, point: Vec3, numbers: [f32; 2]) -> Option<Drawn> {
        let table = self.tables[self.cell(point)].as_ref()?;
        Some(outside.draw_by(table, numbers))
    }

    /// Density with which [`Self::draw`] draws a direction, 1/sr.
    pub fn density(&self, outside: &Outside, point: Vec3, direction: Vec3) -> f32 {
        self.tables[self.cell(point)].as_ref().map_or(0.0, |table| table.density(outside.in_sky(direction)))
    }

    /// Memory, bytes.
    pub fn bytes(&self) -> usize {
        self.tables.iter().flatten().map(SkyTable::bytes).sum()
    }
}

/// The number of a direction of the sky (east, north, up), as rows of equal angles have it.
fn place(direction: Vec3) -> usize {
    let [rows, columns] = DIRECTIONS;
    let row = direction.z.clamp(-1.0, 1.0).acos() / std::f32::consts::PI * rows as f32;
    let azimuth = direction.x.atan2(direction.y).rem_euclid(std::f32::consts::TAU) / std::f32::consts::TAU;
    (row as usize).min(rows - 1) * columns + ((azimuth * columns as f32) as usize).min(columns - 1)
}

/// Sine of the middle angle from the zenith of a row.
fn sine(row: usize) -> f64 {
    (std::f64::consts::PI * (row as f64 + 0.5) / DIRECTIONS[0] as f64).sin()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Truth: rows of equal angles from the zenith down, columns from north over east.
    #[test]
    fn directions_are_numbered_by_where_they_point() {
        let [rows, columns] = DIRECTIONS;
        for number in 0..rows * columns {
            let (sine, height) = (std::f32::consts::PI * ((number / columns) as f32 + 0.5) / rows as f32).sin_cos();
            let (east, north) = (std::f32::consts::TAU * ((number % columns) as f32 + 0.5) / columns as f32).sin_cos();
            assert_eq!(place(Vec3::new(sine * east, sine * north, height)), number);
        }
    }
}
