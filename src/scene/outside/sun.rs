//! The sun as light comes from it: a disc.

use std::f32::consts::{PI, TAU};

use glam::Vec3;

/// Angular radius of the sun, radians: 16 arc minutes.
pub const SUN_RADIUS: f32 = 0.004_65;

/// The sun, a disc of even radiance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sun {
    /// Unit vector towards its middle.
    pub direction: Vec3,
    /// Irradiance of a face turned to it, W/m² per colour.
    pub irradiance: Vec3,
}

impl Sun {
    /// Radiance of its disc, W/(m²·sr): irradiance over π·sin²r.
    pub fn radiance(&self) -> Vec3 {
        self.irradiance / (PI * SUN_RADIUS.sin().powi(2))
    }

    /// Solid angle of its disc, sr.
    pub fn solid_angle() -> f32 {
        // 2π(1 − cos r) without cancellation.
        4.0 * PI * (0.5 * SUN_RADIUS).sin().powi(2)
    }

    /// Whether a direction lies on its disc.
    pub fn holds(&self, direction: Vec3) -> bool {
        // The chord tells small angles that a cosine in single precision does not.
        direction.distance_squared(self.direction) <= (2.0 * (0.5 * SUN_RADIUS).sin()).powi(2)
    }

    /// The direction that two numbers in 0..1 pick, evenly over the disc's solid angle.
    pub fn at(&self, [u, v]: [f32; 2]) -> Vec3 {
        let (east, north) = self.direction.any_orthonormal_pair();
        let (sine, cosine) = (TAU * v).sin_cos();
        let radius = u.sqrt() * SUN_RADIUS;
        (self.direction + radius * (cosine * east + sine * north)).normalize()
    }
}
