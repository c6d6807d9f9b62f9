//! Random directions of a sky by its radiance: a table over bands of elevation and azimuth.

use std::f64::consts::{PI, TAU};

use glam::{DVec3, Vec3};

/// A table of cells, rows from the zenith down; within a cell all solid angle is alike.
#[derive(Clone, Debug)]
pub struct SkyTable {
    rows: usize,
    columns: usize,
    /// Probability of all cells up to and including each, row by row.
    up_to: Vec<f32>,
}

/// A direction that was drawn, in the sky's own frame (east, north, up).
#[derive(Clone, Copy, Debug)]
pub struct Drawn {
    /// Unit vector.
    pub direction: Vec3,
    /// Probability density, 1/sr.
    pub density: f32,
}

impl SkyTable {
    /// A table of so many rows and columns, where `radiance` tells the radiance (of the largest
    /// colour) of a direction; `None` for a dark sky.
    pub fn new(size: [usize; 2], radiance: impl Fn(DVec3) -> f64) -> Option<Self> {
        Self::of_weights(size, &Self::weights(size, radiance))
    }

    /// Mean radiance times solid angle of each cell, row by row.
    pub fn weights([rows, columns]: [usize; 2], radiance: impl Fn(DVec3) -> f64) -> Vec<f64> {
        let mut weights = Vec::with_capacity(rows * columns);
        for row in 0..rows {
            let bounds = [row, row + 1].map(|row| (PI * row as f64 / rows as f64).cos());
            let solid_angle = (bounds[0] - bounds[1]) * TAU / columns as f64;
            for column in 0..columns {
                // Wherever a sample shines, the cell can be drawn.
                let sample = |i: usize, j: usize| {
                    let height = bounds[0] + (bounds[1] - bounds[0]) * (i as f64 + 0.5) / 3.0;
                    radiance(direction(height, TAU * (column as f64 + (j as f64 + 0.5) / 3.0) / columns as f64))
                };
                let sum: f64 = (0..9).map(|index| sample(index / 3, index % 3)).sum();
                weights.push(sum / 9.0 * solid_angle);
            }
        }
        weights
    }

    /// A table of so many rows and columns whose cells are drawn by these weights, row by row;
    /// `None` where all of them are 0.
    pub fn of_weights([rows, columns]: [usize; 2], weights: &[f64]) -> Option<Self> {
        let total: f64 = weights.iter().sum();
        let mut sum = 0.0;
        let up_to = weights.iter().map(|weight| {
            sum += weight / total;
            sum as f32
        });
        (total > 0.0 && total.is_finite()).then(|| Self { rows, columns, up_to: up_to.collect() })
    }

    /// The direction that two numbers in 0..1 draw.
    pub fn draw(&self, [u, v]: [f32; 2]) -> Drawn {
        let last = self.up_to.len() - 1;
        let cell = self.up_to.partition_point(|up_to| *up_to <= u).min(last);
        let probability = self.probability(cell);
        let before = if cell > 0 { self.up_to[cell - 1] } else { 0.0 };
        let along = if probability > 0.0 { ((u - before) / probability).clamp(0.0, 1.0) } else { 0.5 };
        let (row, column) = (cell / self.columns, cell % self.columns);
        let [upper, lower] = self.heights(row);
        let azimuth = TAU * (column as f64 + f64::from(along)) / self.columns as f64;
        let height = upper + (lower - upper) * f64::from(v);
        Drawn { direction: direction(height, azimuth).as_vec3(), density: probability / self.solid_angle(row) }
    }

    /// Probability density of a direction, 1/sr.
    pub fn density(&self, direction: Vec3) -> f32 {
        let row = (f64::from(direction.z.clamp(-1.0, 1.0)).acos() / PI * self.rows as f64) as usize;
        let azimuth = f64::from(direction.x).atan2(f64::from(direction.y)).rem_euclid(TAU);
        let column = ((azimuth / TAU * self.columns as f64) as usize).min(self.columns - 1);
        let row = row.min(self.rows - 1);
        self.probability(row * self.columns + column) / self.solid_angle(row)
    }

    /// Memory, bytes.
    pub fn bytes(&self) -> usize {
        size_of_val(&self.up_to[..])
    }

    fn probability(&self, cell: usize) -> f32 {
        self.up_to[cell] - if cell > 0 { self.up_to[cell - 1] } else { 0.0 }
    }

    fn heights(&self, row: usize) -> [f64; 2] {
        [row, row + 1].map(|row| (PI * row as f64 / self.rows as f64).cos())
    }

    fn solid_angle(&self, row: usize) -> f32 {
        let [upper, lower] = self.heights(row);
        ((upper - lower) * TAU / self.columns as f64) as f32
    }
}

/// The direction of a height above the horizon's plane (the sine of its elevation) and an azimuth
/// from north towards east.
fn direction(height: f64, azimuth: f64) -> DVec3 {
    let radius = (1.0 - height * height).max(0.0).sqrt();
    DVec3::new(radius * azimuth.sin(), radius * azimuth.cos(), height)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::random::r2_sequence;

    /// Truth: densities sum to 1 over the sphere, and drawn directions have the density that the
    /// table tells of them.
    #[test]
    fn directions_are_drawn_by_their_density() {
        let radiance = |d: DVec3| if d.z > 0.0 { 0.1 + d.z + 20.0 * f64::from(u8::from(d.x > 0.9)) } else { 0.0 };
        let table = SkyTable::new([32, 64], radiance).expect("a bright sky");
        let (mut whole, count) = (0.0, 20_000);
        let (mut mean, mut truth) = (Vec3::ZERO, Vec3::ZERO);
        for index in 0..count {
            let [u, v] = r2_sequence(3, index);
            let even = direction(f64::from(1.0 - 2.0 * u), TAU * f64::from(v)).as_vec3();
            whole += table.density(even) * 4.0 * PI as f32 / count as f32;
            truth += table.density(even) * 4.0 * PI as f32 / count as f32 * even;
            let drawn = table.draw([u, v]);
            mean += drawn.direction / count as f32;
            if index % 37 == 0 {
                let density = table.density(drawn.direction);
                assert!((density - drawn.density).abs() <= 0.02 * drawn.density, "{density} {}", drawn.density);
            }
        }
        assert!((whole - 1.0).abs() < 0.01, "{whole}");
        assert!(mean.distance(truth) < 0.02, "{mean} {truth}");
        assert!(SkyTable::new([4, 4], |_| 0.0).is_none());
    }
}
