//! Rays through a picture.

use glam::{Vec2, Vec3};

use crate::scene::CameraPose;

/// A pinhole and the plane that the picture lies in.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lens {
    /// Where the eye is.
    pub eye: Vec3,
    /// Unit vector along the line of sight.
    pub forward: Vec3,
    /// From the middle of the picture to the middle of its right rim, at unit distance.
    pub right: Vec3,
    /// From the middle of the picture to the middle of its upper rim, at unit distance.
    pub above: Vec3,
}

impl Lens {
    /// The lens of a pose, for pictures of an aspect (width / height).
    pub fn of_pose(pose: &CameraPose, aspect: f32) -> Self {
        let forward = (pose.target - pose.eye).normalize();
        let side = forward.cross(pose.up).normalize();
        let half_width = (0.5 * pose.hfov_deg.to_radians()).tan();
        Self { eye: pose.eye, forward, right: half_width * side, above: half_width / aspect * side.cross(forward) }
    }

    /// Unit direction through a point of the picture, −1..1 to the right and upwards.
    pub fn direction(&self, ndc: Vec2) -> Vec3 {
        (self.forward + ndc.x * self.right + ndc.y * self.above).normalize()
    }
}
