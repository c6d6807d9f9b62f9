//! Which leaf lies under the mouse.

use glam::Vec3;

use crate::solver::snapshot::Mesh;

/// Where a ray first meets a bright side.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Picked {
    /// Index into [`Mesh::leaves`].
    pub leaf: u32,
    /// The point met.
    pub point: Vec3,
    /// Distance from the ray's origin, in lengths of its direction.
    pub distance: f32,
}

/// The first leaf along a ray that turns its bright side to it.
pub fn pick(_mesh: &Mesh, _origin: Vec3, _direction: Vec3) -> Option<Picked> {
    None
}
