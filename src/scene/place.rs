//! Places: a file's own coordinates, and those of the scene that was made of it.
//!
//! f32 tells apart what is a millimetre apart only some kilometres around zero, and files of
//! surveyed places lie at hundreds. Such a scene is moved to zero while its coordinates are f64
//! yet, and [`Scene::origin`] says by how much; everything that is written out or read in speaks
//! the file's coordinates.

use glam::{DVec3, Vec3};
use serde::{Deserialize, Serialize};

use super::{CameraPose, Scene};

/// A scene is moved where its middle is farther from zero than so many times its size: nearer ones
/// lose no more than two bits.
const FAR: f64 = 4.0;

/// The largest coordinate of a scene, in its length unit: the fourth power of a distance must stay
/// a finite f32.
pub(super) const MAX_COORDINATE: f32 = 1e9;

/// The largest coordinate that a file may have, in its length unit: f64 tells a tenth of a unit
/// there.
const MAX_IN_FILE: f64 = 1e15;

/// Whether a file's place is finite and not too far off to reckon with.
pub(super) fn is_usable(place: DVec3) -> bool {
    place.abs().cmple(DVec3::splat(MAX_IN_FILE)).all()
}

/// Where in a file's coordinates the zero of a scene with this box goes: along each axis zero, or
/// where that is far off a multiple of a power of two, so that nothing is rounded and a scene that
/// was moved by such a multiple becomes what it was.
pub(super) fn origin(lower: DVec3, upper: DVec3) -> DVec3 {
    let size = (upper - lower).max_element();
    if !(size > 0.0 && size.is_finite()) {
        return DVec3::ZERO;
    }
    let step = size.log2().ceil().exp2();
    let along = |middle: f64| if middle.abs() > FAR * size { (middle / step).round() * step } else { 0.0 };
    DVec3::from((0.5 * (lower + upper)).to_array().map(along))
}

/// How far the vertices of a file reach, and which of them reach farthest; `P` tells where a vertex
/// stands.
#[derive(Clone, Debug)]
pub(super) struct Reach<P> {
    /// Lowest and highest coordinate along each axis.
    ends: [[Option<(f64, P)>; 2]; 3],
}

impl<P: Copy> Reach<P> {
    pub fn new() -> Self {
        Self { ends: [[None; 2]; 3] }
    }

    /// Adds a vertex.
    pub fn add(&mut self, vertex: DVec3, place: P) {
        for (ends, at) in self.ends.iter_mut().zip(vertex.to_array()) {
            let [low, high] = ends;
            if low.is_none_or(|(low, _)| at < low) {
                *low = Some((at, place));
            }
            if high.is_none_or(|(high, _)| at > high) {
                *high = Some((at, place));
            }
        }
    }

    /// A vertex that lies too far from the middle of the scene, if there is one.
    pub fn too_far(&self) -> Option<P> {
        let end = |side: usize| DVec3::from(self.ends.map(|ends| ends[side].map_or(0.0, |(at, _)| at)));
        let origin = origin(end(0), end(1)).to_array();
        let all =
            self.ends.iter().zip(origin).flat_map(|(ends, origin)| ends.iter().flatten().map(move |end| (end, origin)));
        let mut beyond = all.filter(|((at, _), origin)| (at - origin).abs() > f64::from(MAX_COORDINATE));
        beyond.next().map(|((_, place), _)| *place)
    }
}

/// A view in a file's coordinates, as sidecars, settings and the command line give it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct FiledCamera {
    /// Eye position, in the file's length unit.
    pub eye: DVec3,
    /// The point looked at.
    pub target: DVec3,
    /// Up direction; need not be normalised.
    pub up: DVec3,
    /// Horizontal field of view, degrees.
    pub hfov_deg: f64,
}

impl FiledCamera {
    /// The view in the coordinates of a scene.
    pub fn in_scene(&self, scene: &Scene) -> CameraPose {
        CameraPose {
            eye: scene.from_file(self.eye),
            target: scene.from_file(self.target),
            up: self.up.as_vec3(),
            hfov_deg: self.hfov_deg as f32,
        }
    }
}

impl CameraPose {
    /// The view in the coordinates of a scene's file.
    pub fn in_file(&self, scene: &Scene) -> FiledCamera {
        FiledCamera {
            eye: scene.to_file(self.eye),
            target: scene.to_file(self.target),
            up: DVec3::from(self.up.to_array().map(shortest)),
            hfov_deg: shortest(self.hfov_deg),
        }
    }
}

impl Scene {
    /// A point in the coordinates of the scene's file, with the digits that its f32 stand for.
    pub fn to_file(&self, point: Vec3) -> DVec3 {
        to_file(self.origin, point)
    }

    /// A point of the file's coordinates in the scene's.
    pub fn from_file(&self, point: DVec3) -> Vec3 {
        (point - self.origin).as_vec3()
    }
}

/// As [`Scene::to_file`], by the scene's origin.
pub(crate) fn to_file(origin: DVec3, point: Vec3) -> DVec3 {
    origin + DVec3::from(point.to_array().map(shortest))
}

/// An f32 as the f64 with the same few digits, so that it is written as 39.3 and not
/// 39.29999923706055.
pub(super) fn shortest(value: f32) -> f64 {
    value.to_string().parse().unwrap_or_else(|_| value.into())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Truth: near scenes stay where they are, and what is moved far off comes back to the bit.
    #[test]
    fn what_is_far_comes_back() {
        let (lower, upper) = (DVec3::new(-1.0, 0.0, 0.5), DVec3::new(4.0, 3.0, 4.5));
        assert_eq!(origin(lower, upper), DVec3::ZERO);
        for far in [16_000.0, 262_144.0, 1e6, -1e9] {
            let moved = far * DVec3::new(1.0, 0.0, -1.0);
            assert_eq!(origin(lower + moved, upper + moved), moved);
        }
        assert_eq!(origin(DVec3::INFINITY, DVec3::NEG_INFINITY), DVec3::ZERO);
        assert_eq!(origin(DVec3::ONE, DVec3::ONE), DVec3::ZERO);
    }

    #[test]
    fn places_go_there_and_back() {
        let mut scene = Scene::new("far");
        scene.origin = DVec3::new(1e6, 0.0, -262_144.0);
        let point = scene.to_file(Vec3::new(0.1, 0.2, 0.3));
        assert_eq!(point.y, 0.2);
        assert_eq!(scene.from_file(point), Vec3::new(0.1, 0.2, 0.3));
        assert!((point.x - 1_000_000.1).abs() < 1e-9);
    }
}
