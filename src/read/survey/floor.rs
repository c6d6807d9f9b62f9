//! Where a scene's floor is: the lowest level surface that is large.

use glam::Vec3;

use super::lit_mesh::LEVEL;
use crate::scene::{Polygon, Scene};

/// Level faces whose heights differ by no more than this share of the scene's height are one
/// surface.
const SLAB: f32 = 0.01;
/// A floor has at least this share of the area of all level faces that look up.
const LEAST_SHARE: f32 = 0.15;

/// A floor as a rectangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Floor {
    /// Up, along an axis.
    pub up: Vec3,
    /// Lower corner of the box around it.
    pub lower: Vec3,
    /// Upper corner.
    pub upper: Vec3,
}

impl Floor {
    /// Height of the floor, along [`Self::up`].
    pub fn height(&self) -> f32 {
        self.upper.dot(self.up).max(self.lower.dot(self.up))
    }
}

/// The floor of a scene; `None` where nothing level looks up.
pub fn floor(scene: &Scene) -> Option<Floor> {
    let up = scene.up_axis();
    let mut level: Vec<(f32, f32, &Polygon)> = Vec::new();
    for polygon in &scene.polygons {
        if scene.normal(polygon).dot(up) > LEVEL {
            let (corners, count) = scene.corner_positions(polygon);
            let height = corners[..count].iter().map(|corner| corner.dot(up)).fold(f32::INFINITY, f32::min);
            level.push((height, scene.area(polygon), polygon));
        }
    }
    level.sort_by(|a, b| a.0.total_cmp(&b.0));
    let total: f32 = level.iter().map(|(_, area, _)| area).sum();
    let (lower, upper) = scene.bounds();
    let thickness = SLAB * (upper - lower).dot(up.abs());
    let slab_from = |first: usize| {
        let end = level.partition_point(|(height, ..)| *height <= level[first].0 + thickness);
        &level[first..end]
    };
    let area = |slab: &[(f32, f32, &Polygon)]| slab.iter().map(|(_, area, _)| area).sum::<f32>();
    let lowest = (0..level.len()).map(slab_from).find(|slab| area(slab) >= LEAST_SHARE * total);
    let largest = || (0..level.len()).map(slab_from).max_by(|a, b| area(a).total_cmp(&area(b)));
    let faces = lowest.or_else(largest)?;
    let mut floor = Floor { up, lower: Vec3::INFINITY, upper: Vec3::NEG_INFINITY };
    for (.., polygon) in faces {
        let (corners, count) = scene.corner_positions(polygon);
        for corner in &corners[..count] {
            (floor.lower, floor.upper) = (floor.lower.min(*corner), floor.upper.max(*corner));
        }
    }
    Some(floor)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::GroupId;
    use crate::scene::builtin::BuiltinScene;

    /// Truth: how the scenes were built. A small step below the floor, and tables above it, are
    /// none.
    #[test]
    fn the_lowest_large_level_surface_is_the_floor() {
        let mut scene = Scene::new("step");
        let grey = scene.add_material("grey", Vec3::splat(0.5), Vec3::ZERO);
        let square = |side: f32, y: f32| {
            let at = |x: f32, z: f32| Vec3::new(side * x, y, side * z);
            [at(0.0, 0.0), at(0.0, 1.0), at(1.0, 1.0), at(1.0, 0.0)]
        };
        for (side, height) in [(0.5, -1.0), (4.0, 0.0), (2.0, 0.8), (1.0, 2.0)] {
            scene.add_quad(square(side, height), grey, GroupId(0));
        }
        let found = floor(&scene).expect("a floor");
        assert_eq!((found.height(), found.up, found.upper.x), (0.0, Vec3::Y, 4.0));
        assert_eq!(floor(&Scene::new("empty")), None);
        for builtin in BuiltinScene::ALL {
            let scene = builtin.build();
            let found = floor(&scene).expect("rooms have floors");
            let (lower, upper) = scene.bounds();
            assert!(found.height() - lower.dot(found.up) < 0.05 * (upper - lower).dot(found.up), "{}", scene.name);
        }
    }
}
