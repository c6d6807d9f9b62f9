//! Walking through a scene: at eye height above the floor, and not through walls.

use glam::{Vec2, Vec3};

use crate::geometry::Occluders;
use crate::render::Camera;
use crate::scene::Scene;

/// Walking speed, m/s.
const SPEED: f32 = 1.4;
/// Eye height above the floor, m; in a lower room half of its height.
const EYE_HEIGHT: f32 = 1.6;
/// Distance that is kept to walls, m; in a lower room a share of its height.
const REACH: f32 = 0.25;
const REACH_SHARE: f32 = 0.08;
/// Height of a usual room, m.
const ROOM_HEIGHT: f32 = 2.5;

/// Scene that is walked through.
pub struct Ground<'a> {
    pub scene: &'a Scene,
    pub occluders: &'a Occluders,
    /// Unit vector upwards.
    pub up: Vec3,
    /// Height of the scene, m.
    pub height: f32,
}

impl Ground<'_> {
    /// Takes a step: to the right and forwards, each in seconds of walking. Along a wall that is in
    /// the way it slides.
    pub fn step(&self, camera: &mut Camera, by: Vec2) {
        let Some(ahead) = camera.forward().reject_from_normalized(self.up).try_normalize() else { return };
        // A doll's house is walked through by a doll.
        let scale = (self.height / ROOM_HEIGHT).min(1.0);
        let wanted = SPEED * scale * (by.x * ahead.cross(self.up) + by.y * ahead);
        let eye = camera.eye();
        let moved = self.free_part(eye, wanted);
        let eye_height = EYE_HEIGHT.min(0.5 * self.height);
        let floor = self.occluders.first_hit(eye + moved, -self.up).map(|hit| hit.point.distance(eye + moved));
        let raised = floor.filter(|floor| *floor < self.height).map_or(0.0, |floor| eye_height - floor);
        camera.move_by(moved + raised * self.up);
    }

    /// The part of a movement that no wall stops.
    fn free_part(&self, from: Vec3, wanted: Vec3) -> Vec3 {
        let reach = REACH.min(REACH_SHARE * self.height);
        let mut left = wanted;
        // In a corner two walls stop it.
        for _ in 0..3 {
            let Some(direction) = left.try_normalize() else { return Vec3::ZERO };
            let hit = self.occluders.first_hit(from, direction);
            let Some(hit) = hit.filter(|hit| hit.point.distance(from) < left.length() + reach) else { return left };
            let normal = self.scene.normal(&self.scene.polygons[hit.polygon as usize]);
            left = left.reject_from_normalized(normal).reject_from_normalized(self.up);
            if left.dot(wanted) <= 0.0 {
                return Vec3::ZERO;
            }
        }
        Vec3::ZERO
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::CameraPose;
    use crate::scene::builtin::BuiltinScene;

    /// Truth: the scene's own box. Whoever walks straight on for a minute, in any direction, stays
    /// in the room at eye height.
    #[test]
    fn nobody_walks_through_a_wall() {
        let scene = BuiltinScene::Seminar { polygons: BuiltinScene::SEMINAR_POLYGONS }.build();
        let occluders = Occluders::new(&scene);
        let (lower, upper) = scene.bounds();
        let start = scene.camera.expect("sample scenes have a camera");
        let up = scene.up_axis();
        let ground = Ground { scene: &scene, occluders: &occluders, up, height: (upper - lower).dot(up) };
        let side = up.any_orthonormal_vector();
        for turn in 0..8 {
            let angle = std::f32::consts::TAU * turn as f32 / 8.0;
            let sight = angle.cos() * side + angle.sin() * up.cross(side);
            let pose = CameraPose { target: start.eye + sight, ..start };
            let mut camera = Camera::from_pose(&pose, 1.6, (lower, upper));
            for _ in 0..600 {
                ground.step(&mut camera, Vec2::new(0.0, 0.1));
                let eye = camera.eye();
                assert!(eye.cmpge(lower).all() && eye.cmple(upper).all(), "turn {turn}: {eye}");
            }
            assert!(camera.eye().distance(start.eye) > 0.1, "turn {turn}: it has moved");
        }
    }
}
