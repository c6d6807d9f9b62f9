//! Compass and zenith in the coordinates of a scene.

use glam::{DVec3, Vec3};

/// The axes of the outside in a scene's coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Axes {
    east: Vec3,
    north: Vec3,
    pub(super) up: Vec3,
}

impl Axes {
    /// Those of a scene whose up is this unit vector along an axis: east is x, north is −z, or y
    /// where z is up.
    pub fn with_up(up: Vec3) -> Self {
        let north = if up.y.abs() > 0.5 { -Vec3::Z } else { Vec3::Y };
        Self { east: north.cross(up), north, up }
    }

    /// Azimuth from north towards east and elevation of a direction of the scene, degrees.
    pub fn angles(&self, direction: DVec3) -> [f32; 2] {
        let [east, north, up] = [self.east, self.north, self.up].map(|axis| axis.as_dvec3().dot(direction));
        let azimuth = east.atan2(north).to_degrees().rem_euclid(360.0);
        [azimuth as f32, up.atan2(east.hypot(north)).to_degrees() as f32]
    }

    /// A direction of the scene as (east, north, up).
    pub(super) fn of_sky(&self, direction: Vec3) -> Vec3 {
        Vec3::new(self.east.dot(direction), self.north.dot(direction), self.up.dot(direction))
    }

    /// A direction of the sky in the scene.
    pub(super) fn of_scene(&self, direction: Vec3) -> Vec3 {
        direction.x * self.east + direction.y * self.north + direction.z * self.up
    }
}
