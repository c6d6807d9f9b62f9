//! Which points of the room the eye sees, and where they lie in the view.

use egui::{Pos2, Rect, pos2, vec2};
use glam::{Mat4, Vec3};

use crate::geometry::Occluders;
use crate::render::Camera;

/// Surfaces nearer than this share of the distance hide a point.
const NEARLY: f32 = 0.995;
/// Points so far outside of the view still count, points: their marks reach into it.
const OUTSIDE: f32 = 15.0;
/// Rays in each direction of the view that tell whether it looks through walls.
const RAYS: [u32; 2] = [7, 5];
/// Share of them that meet a back first where it does.
const THROUGH_SHARE: f32 = 0.2;

/// A camera with what stands before it.
pub struct Eye<'a> {
    camera: &'a Camera,
    occluders: &'a Occluders,
    clip_from_world: Mat4,
    view: Rect,
    /// Points of the view for a length of 1 at a distance of 1.
    focal: f32,
}

impl<'a> Eye<'a> {
    /// The eye behind a view.
    pub fn new(view: Rect, camera: &'a Camera, occluders: &'a Occluders) -> Self {
        let focal = 0.5 * view.height() / (0.5 * camera.vfov()).tan();
        Self { camera, occluders, clip_from_world: camera.clip_from_world(aspect(view)), view, focal }
    }

    /// Whether nothing that is drawn stands before a point.
    pub fn sees(&self, point: Vec3) -> bool {
        let away = point - self.camera.eye();
        let Some(direction) = away.try_normalize() else { return true };
        let first = self.occluders.first_front(self.camera.eye(), direction);
        first.is_none_or(|hit| hit.distance > NEARLY * away.length())
    }

    /// Where a point lies, and how many points of the view a length of 1 takes there; `None`
    /// outside.
    pub fn project(&self, point: Vec3) -> Option<(Pos2, f32)> {
        let clip = self.clip_from_world * point.extend(1.0);
        if clip.w <= self.camera.near() {
            return None;
        }
        let share = vec2(0.5 + 0.5 * clip.x / clip.w, 0.5 - 0.5 * clip.y / clip.w);
        let at = pos2(self.view.left() + share.x * self.view.width(), self.view.top() + share.y * self.view.height());
        self.view.expand(OUTSIDE).contains(at).then_some((at, self.focal / clip.w))
    }

    /// Whether a good part of the view is seen through backs of faces, such as walls between the
    /// eye and a room.
    pub fn looks_through_walls(&self) -> bool {
        let [columns, rows] = RAYS;
        let meets_back = |index: &u32| {
            let at = |place: u32, of: u32| 2.0 * (place as f32 + 0.5) / of as f32 - 1.0;
            let ndc = glam::Vec2::new(at(index % columns, columns), at(index / columns, rows));
            let (origin, direction) = self.camera.ray(ndc, aspect(self.view));
            self.occluders.first_hit(origin, direction).is_some_and(|hit| !hit.front)
        };
        let through = (0..columns * rows).filter(meets_back).count();
        through as f32 >= THROUGH_SHARE * (columns * rows) as f32
    }
}

fn aspect(view: Rect) -> f32 {
    view.width() / view.height().max(1.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::CameraPose;
    use crate::scene::builtin::BuiltinScene;

    /// Truth: the seminar room's own box, and eyes within and behind its walls. The middle of one
    /// of the views passes by the room.
    #[test]
    fn a_wall_that_is_looked_through_is_noticed_wherever_it_is_in_the_view() {
        let scene = BuiltinScene::Seminar { polygons: BuiltinScene::SEMINAR_POLYGONS }.build();
        let occluders = Occluders::new(&scene);
        let (lower, upper) = scene.bounds();
        let (middle, size) = (0.5 * (lower + upper), upper - lower);
        let view = Rect::from_min_size(Pos2::ZERO, vec2(800.0, 600.0));
        let looks = |eye: Vec3, target: Vec3| {
            let pose = CameraPose { eye, target, up: scene.up_axis(), hfov_deg: 70.0 };
            let camera = Camera::from_pose(&pose, 800.0 / 600.0, (lower, upper));
            Eye::new(view, &camera, &occluders).looks_through_walls()
        };
        let inside = scene.camera.expect("sample scenes have a camera");
        assert!(!looks(inside.eye, inside.target));
        let behind = middle + Vec3::X * size.x;
        assert!(looks(behind, middle));
        // Past the corner: the middle ray meets nothing.
        let misses = |target: &Vec3| occluders.first_hit(behind, (*target - behind).normalize()).is_none();
        let mut aside = (0..100).map(|step| middle + 0.02 * step as f32 * size.z * Vec3::Z);
        let past = aside.find(misses).expect("the room ends somewhere");
        assert!(looks(behind, past), "the room fills a good part of the view");
    }

    /// Truth: a point beyond the far wall, one in front of it, and one behind the eye.
    #[test]
    fn points_behind_surfaces_are_not_seen() {
        let scene = BuiltinScene::Cornell.build();
        let occluders = Occluders::new(&scene);
        let camera = Camera::of_scene(&scene, 1.0);
        let view = Rect::from_min_size(Pos2::ZERO, vec2(500.0, 500.0));
        let eye = Eye::new(view, &camera, &occluders);
        let forward = camera.forward();
        let wall = occluders.first_front(camera.eye(), forward).expect("a wall is ahead");
        assert!(eye.sees(wall.point) && eye.sees(camera.eye() + 0.5 * wall.distance * forward));
        assert!(!eye.sees(camera.eye() + 1.1 * wall.distance * forward));
        assert!(eye.project(wall.point).is_some() && eye.project(camera.eye() - forward).is_none());
    }
}
