//! Places where the values of lines of equal value can be written along them.

use glam::{Vec2, Vec3};
use rayon::prelude::*;

use super::VisibleSurfaces;
use super::develop::value;
use super::filter::{Share, is_alike};
use crate::base::photometry::Quantity;

/// Half of what a written value takes along its line, pixels.
const HALF_LENGTH: f32 = 22.0;
/// Least distance between two labels of one line, and of any two, pixels.
const APART: [f32; 2] = [190.0, 56.0];
/// In each square of this side and for each line one place is looked at, pixels.
const CELL: f32 = 40.0;
/// A line is straight enough where its value is met along the label within this many pixels.
const STRAIGHT: f32 = 4.0;

/// Where the dark rim of a written value lies, pixels from its letters: x to the right, y
/// downwards.
pub const LABEL_RIM: [[f32; 2]; 8] =
    [[-1.3, 0.0], [1.3, 0.0], [0.0, -1.3], [0.0, 1.3], [-0.9, -0.9], [0.9, -0.9], [-0.9, 0.9], [0.9, 0.9]];

/// A place for the value of a line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LineLabel {
    /// Middle of the label, pixels from the upper left corner.
    pub at: Vec2,
    /// Direction of the line there, anticlockwise from the right as seen, −π/2..π/2.
    pub angle: f32,
    /// Value of the line, W/m².
    pub value: f32,
}

/// The field of values that lines are drawn of.
struct Values<'a> {
    visible: &'a VisibleSurfaces,
    smooth: &'a [Share],
    quantity: Quantity,
}

impl Values<'_> {
    fn index(&self, x: i64, y: i64) -> Option<usize> {
        let [width, height] = self.visible.size.map(i64::from);
        ((0..width).contains(&x) && (0..height).contains(&y)).then(|| (y * width + x) as usize)
    }

    fn at(&self, index: usize) -> f32 {
        value(&self.visible.all[index], &self.smooth[index], self.quantity)
    }

    /// The value at a neighbour on the same smooth surface.
    fn like(&self, here: usize, x: i64, y: i64) -> Option<f32> {
        let there = self.index(x, y)?;
        is_alike(&self.visible.all[here], &self.visible.all[there]).then(|| self.at(there))
    }

    /// Change of the value for each sample to the right and downwards, over some samples.
    fn gradient(&self, here: usize, x: i64, y: i64, step: i64) -> Option<Vec2> {
        let along = |dx: i64, dy: i64| {
            let (before, after) = (self.like(here, x - dx, y - dy)?, self.like(here, x + dx, y + dy)?);
            Some((after - before) / (2 * step) as f32)
        };
        Some(Vec2::new(along(step, 0)?, along(0, step)?))
    }
}

/// Where labels of these lines may stand: on one surface, where the line is nearly straight, apart
/// from each other.
pub(super) fn places(visible: &VisibleSurfaces, smooth: &[Share], quantity: Quantity, lines: &[f32]) -> Vec<LineLabel> {
    let values = Values { visible, smooth, quantity };
    let side = visible.per_side as f32;
    let cell = (CELL * side) as usize;
    let [width, height] = visible.size.map(|samples| samples as usize);
    // The crossing that lies nearest to the middle of a square stands for it.
    let in_square = |left: usize, top: usize, line: f32| {
        let inside =
            (top..(top + cell).min(height)).flat_map(|y| (left..(left + cell).min(width)).map(move |x| (x, y)));
        let middle = Vec2::new((left + cell / 2) as f32, (top + cell / 2) as f32);
        let crossing = inside
            .filter(|&(x, y)| crosses(&values, x, y, line))
            .min_by(|a, b| distance(*a, middle).total_cmp(&distance(*b, middle)));
        crossing.and_then(|(x, y)| label(&values, x as i64, y as i64, line, side))
    };
    let in_row = |row: usize| -> Vec<(f32, LineLabel)> {
        let squares = (0..width).step_by(cell).flat_map(|left| lines.iter().map(move |&line| (left, line)));
        squares.filter_map(|(left, line)| in_square(left, row * cell, line)).collect()
    };
    let rows: Vec<_> = (0..height.div_ceil(cell)).into_par_iter().map(in_row).collect();
    let mut found = rows.concat();
    found.sort_by(|(a, _), (b, _)| a.total_cmp(b));
    let mut labels: Vec<LineLabel> = Vec::new();
    for (_, label) in found {
        let is_apart = |other: &LineLabel| {
            let least = if other.value == label.value { APART[0] } else { APART[1] };
            other.at.distance(label.at) >= least
        };
        if labels.iter().all(is_apart) {
            labels.push(label);
        }
    }
    labels
}

fn distance((x, y): (usize, usize), from: Vec2) -> f32 {
    Vec2::new(x as f32, y as f32).distance_squared(from)
}

/// Whether a line passes between a sample and one of the next ones.
fn crosses(values: &Values<'_>, x: usize, y: usize, line: f32) -> bool {
    let [width, height] = values.visible.size.map(|samples| samples as usize);
    let here = y * width + x;
    if values.visible.all[here].emission != Vec3::ZERO {
        return false;
    }
    let value = values.at(here);
    let passes = |there: usize| {
        let other = values.at(there);
        (value - line) * (other - line) < 0.0 && is_alike(&values.visible.all[here], &values.visible.all[there])
    };
    (x + 1 < width && passes(here + 1)) || (y + 1 < height && passes(here + width))
}

/// A label at a crossing, and how far the line leaves it; `None` where it would not lie along the
/// line.
fn label(values: &Values<'_>, x: i64, y: i64, line: f32, side: f32) -> Option<(f32, LineLabel)> {
    let here = values.index(x, y)?;
    let gradient = values.gradient(here, x, y, (2.0 * side) as i64)?;
    let steepness = gradient.length();
    let along = Vec2::new(-gradient.y, gradient.x).try_normalize()?;
    let along = if along.x < 0.0 { -along } else { along };
    let mut off = 0.0_f32;
    for share in [-1.0, -0.5, 0.5, 1.0] {
        let aside = share * HALF_LENGTH * side * along;
        let value = values.like(here, x + aside.x.round() as i64, y + aside.y.round() as i64)?;
        off = off.max((value - line).abs() / (steepness * side));
    }
    let at = (Vec2::new(x as f32, y as f32) + 0.5) / side;
    // Rows count downwards.
    let angle = (-along.y).atan2(along.x);
    (off <= STRAIGHT).then_some((off, LineLabel { at, angle, value: line }))
}
