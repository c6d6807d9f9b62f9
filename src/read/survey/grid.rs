//! The grid of a work plane: points in the air, in cells of equal size above the floor.

use glam::Vec3;
use serde::{Deserialize, Serialize};

use super::floor::floor;
use crate::base::format::to_one_digit;
use crate::scene::Scene;

/// More points than this are refused.
pub const MOST_POINTS: usize = 40_000;

/// A level plane above the floor, and where it is measured.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct WorkPlane {
    /// Height above the floor, in the scene's length unit.
    pub height: f32,
    /// Wanted distance between points, in the same unit; cells fill the plane evenly, so it is met
    /// within rounding to whole cells.
    pub spacing: f32,
    /// Strip along the rim of the floor that is left out.
    pub margin: f32,
    /// Two opposite corners of the part that is measured, at any height; otherwise all of the floor
    /// but the margin.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub area: Option<[Vec3; 2]>,
}

impl Default for WorkPlane {
    /// A desk, measured every half metre, without the half metre along the walls (EN 12464-1).
    fn default() -> Self {
        Self { height: 0.75, spacing: 0.5, margin: 0.5, area: None }
    }
}

/// Points of a work plane.
#[derive(Clone, Debug, PartialEq)]
pub struct Grid {
    /// Unit normal of the plane, up.
    pub up: Vec3,
    /// Middles of the cells, row by row.
    pub points: Vec<Vec3>,
    /// Columns and rows.
    pub counts: [usize; 2],
    /// Distances between points along rows and between rows.
    pub steps: [f32; 2],
}

/// Why there is no grid.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum GridError {
    /// Nothing level looks up.
    #[error("the scene has no floor: no level face looks up, try other --sides")]
    NoFloor,
    /// A number that cannot be used.
    #[error("the work plane needs a height, a spacing above 0 and a margin of 0 or more, all finite")]
    BadNumber,
    /// The task area has no extent.
    #[error("the task area needs a width and a depth: draw it anew")]
    NoArea,
    /// The margin covers the floor.
    #[error("a margin of {margin} leaves nothing of a floor that is {width} × {depth}: choose a smaller one")]
    NoRoom {
        /// The margin.
        margin: f32,
        /// Extents of the floor.
        width: f32,
        /// The other one.
        depth: f32,
    },
    /// Too many points.
    #[error("a spacing of {spacing} makes {points} points, at most {MOST_POINTS} are measured: choose a larger one")]
    TooMany {
        /// The spacing.
        spacing: f32,
        /// Points that it makes.
        points: u64,
    },
}

/// Spacing of measuring points on an area of these extents, m, as EN 12464-1 asks: p = 0.2·5^log₁₀
/// d of the longer extent d, or of the shorter one where that is less than half of it; 10 m at
/// most. Rounded down to centimetres.
pub fn spacing_of(longer: f32, shorter: f32) -> f32 {
    let decisive = if longer >= 2.0 * shorter { shorter } else { longer };
    let spacing = 0.2 * 5_f32.powf(decisive.max(0.1).log10());
    ((100.0 * spacing).floor() / 100.0).clamp(0.01, 10.0)
}

impl WorkPlane {
    /// Height of the plane along the up axis of a scene, and that axis; `None` where there is no
    /// floor.
    pub fn level(&self, scene: &Scene) -> Option<(f32, Vec3)> {
        floor(scene).map(|floor| (floor.height() + self.height, floor.up))
    }

    /// Measures this part alone, at the spacing of EN 12464-1 for it.
    pub fn set_area(&mut self, corners: [Vec3; 2], up: Vec3) {
        let span = (corners[0] - corners[1]).abs();
        let sides = (0..3).filter(|&axis| up[axis] == 0.0).map(|axis| span[axis]);
        let (shorter, longer) =
            sides.fold((f32::INFINITY, 0.0_f32), |(low, high), side| (low.min(side), high.max(side)));
        self.area = Some(corners);
        self.spacing = spacing_of(longer, shorter);
    }

    /// One that suits a scene: as usual in rooms, smaller in models of other sizes.
    pub fn for_scene(scene: &Scene) -> Self {
        let usual = Self::default();
        let Some(floor) = floor(scene) else { return usual };
        let (lower, upper) = scene.bounds();
        let room = (upper - lower).dot(floor.up.abs());
        let extent = floor.upper - floor.lower;
        let smaller =
            (0..3).filter(|&axis| floor.up[axis] == 0.0).map(|axis| extent[axis]).fold(f32::INFINITY, f32::min);
        if room > 1.5 && smaller > 2.5 {
            let larger = (0..3).filter(|&axis| floor.up[axis] == 0.0).map(|axis| extent[axis]).fold(0.0, f32::max);
            let spacing = spacing_of(larger - 2.0 * usual.margin, smaller - 2.0 * usual.margin);
            return Self { spacing, ..usual };
        }
        let step = to_one_digit((smaller / 12.0).max(1e-6));
        Self { height: to_one_digit((room / 4.0).max(1e-6)), spacing: step, margin: step, area: None }
    }

    /// Points of the grid.
    ///
    /// # Errors
    /// A scene without a floor, or numbers that cannot be used.
    pub fn grid(&self, scene: &Scene) -> Result<Grid, GridError> {
        let is_good = self.height.is_finite() && self.spacing > 0.0 && self.spacing.is_finite();
        if !(is_good && self.margin >= 0.0 && self.margin.is_finite()) {
            return Err(GridError::BadNumber);
        }
        let floor = floor(scene).ok_or(GridError::NoFloor)?;
        let axes: Vec<usize> = (0..3).filter(|&axis| floor.up[axis] == 0.0).collect();
        let [across, along] = [axes[0], axes[1]];
        let extent = |axis: usize| floor.upper[axis] - floor.lower[axis];
        let (first, rooms) = match self.area {
            Some([a, b]) => {
                let span = (a - b).abs();
                if ![across, along].iter().all(|&axis| span[axis] > 0.0 && span[axis].is_finite()) {
                    return Err(GridError::NoArea);
                }
                (a.min(b), [across, along].map(|axis| span[axis]))
            }
            None => (floor.lower + self.margin, [across, along].map(|axis| extent(axis) - 2.0 * self.margin)),
        };
        if rooms.iter().any(|room| *room <= 0.0) {
            let [width, depth] = [across, along].map(extent);
            return Err(GridError::NoRoom { margin: self.margin, width, depth });
        }
        let cells = rooms.map(|room| (f64::from(room) / f64::from(self.spacing)).round().max(1.0));
        if cells[0] * cells[1] > MOST_POINTS as f64 {
            return Err(GridError::TooMany { spacing: self.spacing, points: (cells[0] * cells[1]) as u64 });
        }
        let counts = cells.map(|cells| cells as usize);
        let steps = [0, 1].map(|side: usize| rooms[side] / counts[side] as f32);
        let level = floor.height() + self.height;
        let point = |(row, column): (usize, usize)| {
            let mut point = level * floor.up;
            point[across] = first[across] + (column as f32 + 0.5) * steps[0];
            point[along] = first[along] + (row as f32 + 0.5) * steps[1];
            point
        };
        let places = (0..counts[1]).flat_map(|row| (0..counts[0]).map(move |column| (row, column)));
        Ok(Grid { up: floor.up, points: places.map(point).collect(), counts, steps })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::GroupId;

    fn hall() -> Scene {
        let mut scene = Scene::new("hall");
        let grey = scene.add_material("grey", Vec3::splat(0.5), Vec3::ZERO);
        let at = |x: f32, z: f32| Vec3::new(x, 1.0, z);
        scene.add_quad([at(0.0, 0.0), at(0.0, 6.0), at(10.0, 6.0), at(10.0, 0.0)], grey, GroupId(0));
        scene
    }

    /// Written out by hand: a floor of 10 × 6 at height 1 with a margin of 1, in cells of 2 × 2.
    #[test]
    fn cells_fill_the_plane() {
        let plane = WorkPlane { height: 0.75, spacing: 2.0, margin: 1.0, area: None };
        let grid = plane.grid(&hall()).expect("a floor");
        assert_eq!((grid.counts, grid.steps, grid.up), ([4, 2], [2.0, 2.0], Vec3::Y));
        assert_eq!(grid.points[0], Vec3::new(2.0, 1.75, 2.0));
        assert_eq!(grid.points[7], Vec3::new(8.0, 1.75, 4.0));
        // A spacing that does not fit becomes one that does.
        let grid = WorkPlane { spacing: 3.0, ..plane }.grid(&hall()).expect("a floor");
        assert_eq!((grid.counts, grid.steps), ([3, 1], [8.0 / 3.0, 4.0]));
    }

    /// Written out by hand: a task area of 3 × 2 whose corners are given in either order, in cells
    /// of 1 × 1, without a margin.
    #[test]
    fn cells_fill_a_task_area() {
        let [a, b] = [Vec3::new(5.0, 7.0, 1.0), Vec3::new(2.0, 0.0, 3.0)];
        for area in [[a, b], [b, a]] {
            let plane = WorkPlane { height: 0.75, spacing: 1.0, margin: 9.0, area: Some(area) };
            let grid = plane.grid(&hall()).expect("a floor");
            assert_eq!((grid.counts, grid.steps), ([3, 2], [1.0, 1.0]));
            assert_eq!((grid.points[0], grid.points[5]), (Vec3::new(2.5, 1.75, 1.5), Vec3::new(4.5, 1.75, 2.5)));
        }
        let flat = WorkPlane { area: Some([a, a]), ..WorkPlane::default() };
        assert_eq!(flat.grid(&hall()), Err(GridError::NoArea));
    }

    #[test]
    fn planes_that_cannot_be_measured() {
        let plane = WorkPlane::default();
        assert_eq!(plane.grid(&Scene::new("empty")), Err(GridError::NoFloor));
        assert!(matches!(WorkPlane { margin: 3.0, ..plane }.grid(&hall()), Err(GridError::NoRoom { .. })));
        assert!(matches!(WorkPlane { spacing: 1e-3, ..plane }.grid(&hall()), Err(GridError::TooMany { .. })));
        for bad in [0.0, -1.0, f32::NAN, f32::INFINITY] {
            assert_eq!(WorkPlane { spacing: bad, ..plane }.grid(&hall()), Err(GridError::BadNumber));
        }
    }

    /// Truth: the standard's formula, by hand: 5^0 = 1, 5^1 = 5, and a long corridor is judged by
    /// its width.
    #[test]
    fn spacing_follows_the_standard() {
        assert_eq!([spacing_of(1.0, 1.0), spacing_of(10.0, 6.0), spacing_of(40.0, 1.0)], [0.2, 1.0, 0.2]);
        assert!(spacing_of(1e6, 1e6) == 10.0 && spacing_of(-1.0, -1.0) >= 0.01);
    }
}
