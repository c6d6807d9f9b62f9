//! Input and output of clustering strategies: boxes of polygons, and clusters within clusters.

use glam::Vec3;

use crate::scene::Scene;

/// Result of a clustering strategy: clusters within clusters, polygons in them.
#[derive(Default)]
pub(super) struct Grouping {
    /// Clusters inside.
    pub(super) groupings: Vec<Grouping>,
    /// Polygons directly inside.
    pub(super) polygons: Vec<u32>,
}

/// Steps of [`PolygonBounds`] along the scene's longest side.
const GRID: f32 = 65_536.0;

/// Box of each polygon on a grid over the scene, as strategies read it.
///
/// On a grid, faces that lie at the same place do so exactly, and ties stay ties: the same scene in
/// other units, where coordinates round otherwise, gets the same clusters.
pub(super) struct PolygonBounds {
    pub(super) lower: Vec<Vec3>,
    pub(super) upper: Vec<Vec3>,
}

impl PolygonBounds {
    pub(super) fn new(scene: &Scene) -> Self {
        let (origin, end) = scene.bounds();
        let side = (end - origin).max_element();
        let on_grid =
            |position: Vec3| if side > 0.0 { ((position - origin) / side * GRID).round() } else { Vec3::ZERO };
        let bounds = |polygon| {
            let (positions, count) = scene.corner_positions(polygon);
            let around = |f: fn(Vec3, Vec3) -> Vec3| positions[1..count].iter().copied().fold(positions[0], f);
            (on_grid(around(Vec3::min)), on_grid(around(Vec3::max)))
        };
        let (lower, upper) = scene.polygons.iter().map(bounds).unzip();
        Self { lower, upper }
    }

    /// Twice the middle of a polygon's box.
    pub(super) fn doubled_middle(&self, polygon: u32) -> Vec3 {
        self.lower[polygon as usize] + self.upper[polygon as usize]
    }

    /// The box around some polygons.
    pub(super) fn around(&self, polygons: &[u32]) -> (Vec3, Vec3) {
        polygons.iter().fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(lower, upper), &polygon| {
            (lower.min(self.lower[polygon as usize]), upper.max(self.upper[polygon as usize]))
        })
    }
}

impl Grouping {
    /// The grouping without clusters of one member and without empty ones; `None` if nothing is
    /// left.
    pub(super) fn tidied(self) -> Option<Self> {
        let mut tidy = Self { groupings: Vec::with_capacity(self.groupings.len()), polygons: self.polygons };
        for inner in self.groupings.into_iter().filter_map(Self::tidied) {
            match (inner.groupings.is_empty(), inner.polygons.as_slice()) {
                (true, &[only]) => tidy.polygons.push(only),
                _ => tidy.groupings.push(inner),
            }
        }
        match (tidy.groupings.len(), tidy.polygons.len()) {
            (0, 0) => None,
            (1, 0) => tidy.groupings.pop(),
            _ => Some(tidy),
        }
    }
}
