//! The camera: a turntable around a target, which can also look round and fly. No window types.

use glam::{BVec3, Mat4, Quat, Vec2, Vec3};

use crate::read::picture::Lens;
use crate::scene::{CameraPose, Scene};

/// Vertical field of view when nothing else is asked for, radians (36° is a 50 mm lens turned
/// upright).
const DEFAULT_VFOV: f32 = 0.7;
/// Field of view limits, radians.
const VFOV_RANGE: (f32, f32) = (0.02, 2.8);
/// The line of sight stays this far from the up axis, radians, so that an orbit never flips over a
/// pole.
const POLE_GAP: f32 = 0.01;
/// Near plane as a share of the scene's diagonal. Reversed depth in floats resolves a constant
/// share of the distance whatever the near plane is, so it can be as close as a person ever comes.
const NEAR_SHARE: f32 = 1e-5;
/// Speed of flight, scene diagonals a second.
const FLY_SPEED: f32 = 0.15;
/// A framed scene stays a little away from the picture's rim.
const FRAME_MARGIN: f32 = 1.05;
/// Nearest and farthest distance from eye to target, scene diagonals.
const DISTANCE_SHARES: (f32, f32) = (1e-4, 4.0);

/// Where the eye is and what it sees; right-handed, looking from `eye` to `target`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    eye: Vec3,
    target: Vec3,
    /// Unit axis of the turntable.
    up: Vec3,
    /// Vertical field of view, radians; the horizontal one follows from the picture's aspect.
    vfov: f32,
    lower: Vec3,
    upper: Vec3,
}

impl Camera {
    /// A pose seen with an aspect (width / height), in a scene with these bounds; a pose without a
    /// view (eye on target, not finite) frames the scene instead.
    pub fn from_pose(pose: &CameraPose, aspect: f32, bounds: (Vec3, Vec3)) -> Self {
        let up = pose.up.try_normalize().unwrap_or(Vec3::Y);
        let framed = Self::frame(bounds, up, aspect);
        let sight = pose.target - pose.eye;
        if !(pose.eye.is_finite() && sight.length_squared() > 0.0 && sight.is_finite() && pose.hfov_deg.is_finite()) {
            return framed;
        }
        let hfov = pose.hfov_deg.to_radians().clamp(VFOV_RANGE.0, VFOV_RANGE.1);
        let vfov = 2.0 * ((hfov / 2.0).tan() / sane_aspect(aspect)).atan();
        let vfov = vfov.clamp(VFOV_RANGE.0, VFOV_RANGE.1);
        let mut camera = Self { eye: pose.eye, target: pose.target, up, vfov, ..framed };
        camera.set_sight(sight);
        camera.target = camera.eye + camera.sight();
        camera
    }

    /// The scene's own view, or one of everything, with an aspect (width / height).
    pub fn of_scene(scene: &Scene, aspect: f32) -> Self {
        let bounds = scene.bounds();
        let framed = || Self::frame(bounds, scene.up_axis(), aspect);
        scene.camera.map_or_else(framed, |pose| Self::from_pose(&pose, aspect, bounds))
    }

    /// A view of everything from the front, the right and above; `up` is a unit vector.
    pub fn frame(bounds: (Vec3, Vec3), up: Vec3, aspect: f32) -> Self {
        let back = if up.z.abs() > 0.5 { -Vec3::Y } else { Vec3::Z };
        let mut camera = Self {
            eye: 0.45 * Vec3::X + 0.4 * up + back,
            target: Vec3::ZERO,
            up,
            vfov: DEFAULT_VFOV,
            lower: bounds.0,
            upper: bounds.1,
        };
        camera.frame_all(bounds, aspect);
        camera
    }

    /// Moves until the scene's box fills the picture; the direction of sight, the up axis and the
    /// lens stay.
    pub fn frame_all(&mut self, bounds: (Vec3, Vec3), aspect: f32) {
        self.set_bounds(bounds);
        let forward = self.forward();
        let (side, above) = self.screen_axes();
        let half_height = (0.5 * self.vfov).tan();
        let half_width = half_height * sane_aspect(aspect);
        let centre = 0.5 * (self.lower + self.upper);
        // How far before the centre the eye must be for each corner to lie inside the picture.
        let distances = (0..8).map(|corner| {
            let upper = BVec3::new(corner & 1 != 0, corner & 2 != 0, corner & 4 != 0);
            let offset = Vec3::select(upper, self.upper, self.lower) - centre;
            let reach = (offset.dot(side).abs() / half_width).max(offset.dot(above).abs() / half_height);
            reach - offset.dot(forward)
        });
        let distance = FRAME_MARGIN * distances.fold(0.0, f32::max);
        self.target = centre;
        self.eye = centre - forward * if distance > 0.0 { distance } else { self.scene_size() };
    }

    /// Tells the camera the size of the scene, on which near plane and speeds depend.
    pub fn set_bounds(&mut self, bounds: (Vec3, Vec3)) {
        let usable = bounds.0.is_finite() && bounds.1.is_finite() && bounds.0.cmple(bounds.1).all();
        (self.lower, self.upper) = if usable { bounds } else { (Vec3::ZERO, Vec3::ZERO) };
    }

    /// The pose, to be saved; the horizontal field of view is that of the given aspect.
    pub fn pose(&self, aspect: f32) -> CameraPose {
        CameraPose { eye: self.eye, target: self.target, up: self.up, hfov_deg: self.hfov(aspect).to_degrees() }
    }

    /// Eye position.
    pub fn eye(&self) -> Vec3 {
        self.eye
    }

    /// Unit vector of sight.
    pub fn forward(&self) -> Vec3 {
        self.sight().normalize()
    }

    /// Vertical field of view, radians.
    pub fn vfov(&self) -> f32 {
        self.vfov
    }

    /// Horizontal field of view at an aspect, radians.
    pub fn hfov(&self, aspect: f32) -> f32 {
        2.0 * ((0.5 * self.vfov).tan() * sane_aspect(aspect)).atan()
    }

    /// Turns the eye around the target by radians, as if the scene were dragged to the right and
    /// downwards.
    pub fn orbit(&mut self, right: f32, down: f32) {
        let sight = self.turned(self.sight(), -right, -down);
        self.eye = self.target - sight;
    }

    /// Drags the scene at the target's distance along the picture, in shares of the picture's
    /// height, to the right and downwards.
    pub fn pan(&mut self, right: f32, down: f32) {
        let height = 2.0 * self.sight().length() * (0.5 * self.vfov).tan();
        let (side, above) = self.screen_axes();
        self.shift(height * (down * above - right * side));
    }

    /// Multiplies the distance to the target: below 1 comes nearer.
    pub fn zoom(&mut self, factor: f32) {
        if factor.is_finite() && factor > 0.0 {
            let size = self.scene_size();
            let distance = self.sight().length() * factor;
            let distance = distance.clamp(DISTANCE_SHARES.0 * size, DISTANCE_SHARES.1 * size);
            self.eye = self.target - self.forward() * distance;
        }
    }

    /// Flies along right, up axis and line of sight; each in seconds at a speed that suits the
    /// scene's size.
    pub fn fly(&mut self, local: Vec3) {
        let (side, _) = self.screen_axes();
        let step = local.x * side + local.y * self.up + local.z * self.forward();
        self.shift(FLY_SPEED * self.scene_size() * step);
    }

    /// Turns the eye towards a point, around which orbits then turn.
    pub fn look_at(&mut self, point: Vec3) {
        let sight = point - self.eye;
        if sight.is_finite() && sight.length() > DISTANCE_SHARES.0 * self.scene_size() {
            self.set_sight(sight);
        }
    }

    /// World to clip space for an aspect: depth is reversed and has no far plane, near / distance
    /// (1 at the near plane, 0 at infinity).
    pub fn clip_from_world(&self, aspect: f32) -> Mat4 {
        let focal = 1.0 / (0.5 * self.vfov).tan();
        let clip_from_view = Mat4::from_cols_array_2d(&[
            [focal / sane_aspect(aspect), 0.0, 0.0, 0.0],
            [0.0, focal, 0.0, 0.0],
            [0.0, 0.0, 0.0, -1.0],
            [0.0, 0.0, self.near(), 0.0],
        ]);
        let (side, above) = self.screen_axes();
        let back = -self.forward();
        let world_from_view =
            Mat4::from_cols(side.extend(0.0), above.extend(0.0), back.extend(0.0), self.eye.extend(1.0));
        clip_from_view * world_from_view.inverse()
    }

    /// Distance of the near plane, in the scene's unit.
    pub fn near(&self) -> f32 {
        NEAR_SHARE * self.scene_size()
    }

    /// The ray through a point of the picture, −1..1 to the right and upwards: eye and unit
    /// direction.
    pub fn ray(&self, ndc: Vec2, aspect: f32) -> (Vec3, Vec3) {
        let (side, above) = self.screen_axes();
        let reach = (0.5 * self.vfov).tan() * ndc;
        let direction = self.forward() + reach.x * sane_aspect(aspect) * side + reach.y * above;
        (self.eye, direction.normalize())
    }

    /// The lens of gathered pictures of an aspect: the same rays as [`Self::ray`].
    pub fn lens(&self, aspect: f32) -> Lens {
        let (side, above) = self.screen_axes();
        let reach = (0.5 * self.vfov).tan();
        Lens { eye: self.eye, forward: self.forward(), right: reach * sane_aspect(aspect) * side, above: reach * above }
    }

    /// Diagonal of the scene's box; 1 for an empty scene.
    pub fn scene_size(&self) -> f32 {
        let diagonal = (self.upper - self.lower).length();
        if diagonal > 0.0 && diagonal.is_finite() { diagonal } else { 1.0 }
    }

    fn sight(&self) -> Vec3 {
        self.target - self.eye
    }

    /// Unit vectors to the right and upwards in the picture.
    fn screen_axes(&self) -> (Vec3, Vec3) {
        let forward = self.forward();
        let side = forward.cross(self.up).normalize();
        (side, side.cross(forward))
    }

    /// Moves eye and target alike.
    pub fn move_by(&mut self, by: Vec3) {
        self.shift(by);
    }

    /// Looks along a direction at all of the scene.
    pub fn look_along(&mut self, sight: Vec3, bounds: (Vec3, Vec3), aspect: f32) {
        if sight.is_finite() && sight != Vec3::ZERO {
            self.set_sight(sight);
        }
        self.frame_all(bounds, aspect);
    }

    fn shift(&mut self, by: Vec3) {
        if by.is_finite() {
            self.eye += by;
            self.target += by;
        }
    }

    /// Points the eye along `sight`, away from the poles.
    fn set_sight(&mut self, sight: Vec3) {
        // A vector along the axis has no heading; any will do.
        let level = sight.reject_from_normalized(self.up);
        let heading = level.try_normalize().unwrap_or_else(|| self.up.any_orthonormal_vector());
        let pitch = sight.dot(self.up).atan2(level.length());
        self.target = self.eye + sight.length() * self.direction(heading, pitch);
    }

    /// A sight turned left around the up axis and upwards, radians, its length kept.
    fn turned(&self, sight: Vec3, left: f32, upwards: f32) -> Vec3 {
        if !(left.is_finite() && upwards.is_finite()) {
            return sight;
        }
        let level = sight.reject_from_normalized(self.up);
        let heading = Quat::from_axis_angle(self.up, left) * level.normalize();
        let pitch = sight.dot(self.up).atan2(level.length()) + upwards;
        sight.length() * self.direction(heading, pitch)
    }

    fn direction(&self, heading: Vec3, pitch: f32) -> Vec3 {
        let limit = std::f32::consts::FRAC_PI_2 - POLE_GAP;
        let (sin, cos) = pitch.clamp(-limit, limit).sin_cos();
        cos * heading + sin * self.up
    }
}

/// An aspect that can be divided by, also for a window folded to nothing.
fn sane_aspect(aspect: f32) -> f32 {
    if aspect.is_finite() && aspect > 0.0 { aspect.clamp(1e-3, 1e3) } else { 1.0 }
}

#[cfg(test)]
mod tests {
    use std::f32::consts::{FRAC_PI_2, PI};

    use glam::vec2;

    use super::*;

    const BOUNDS: (Vec3, Vec3) = (Vec3::new(-3.0, 0.0, -2.0), Vec3::new(5.0, 3.0, 2.0));

    fn camera() -> Camera {
        let pose =
            CameraPose { eye: Vec3::new(1.0, 1.5, 6.0), target: Vec3::new(0.5, 1.0, 0.0), up: Vec3::Y, hfov_deg: 70.0 };
        Camera::from_pose(&pose, 1.6, BOUNDS)
    }

    fn ndc(camera: &Camera, point: Vec3, aspect: f32) -> Vec3 {
        camera.clip_from_world(aspect).project_point3(point)
    }

    #[test]
    fn a_pose_comes_back_as_it_was_given() {
        let pose =
            CameraPose { eye: Vec3::new(1.0, 1.5, 6.0), target: Vec3::new(0.5, 1.0, 0.0), up: Vec3::Z, hfov_deg: 70.0 };
        let back = Camera::from_pose(&pose, 1.6, BOUNDS).pose(1.6);
        assert!((back.hfov_deg - 70.0).abs() < 1e-3 && back.up == Vec3::Z && back.eye == pose.eye);
        assert!(back.target.distance(pose.target) < 1e-5, "{back:?}");
    }

    /// Truth: what is seen as a whole stands upright whichever axis points up, seen from its front
    /// and from above.
    #[test]
    fn everything_is_seen_upright() {
        for (up, front) in [(Vec3::Y, Vec3::Z), (Vec3::Z, -Vec3::Y)] {
            let camera = Camera::frame(BOUNDS, up, 1.6);
            let from_middle = camera.eye - 0.5 * (BOUNDS.0 + BOUNDS.1);
            assert!(camera.up == up && from_middle.dot(up) > 0.0 && from_middle.dot(front) > 0.0, "{camera:?}");
        }
    }

    #[test]
    fn a_pose_that_is_no_view_frames_the_scene() {
        let good = camera().pose(1.6);
        let framed = Camera::frame(BOUNDS, Vec3::Y, 1.6);
        for bad in [
            CameraPose { eye: good.target, ..good },
            CameraPose { eye: Vec3::NAN, ..good },
            CameraPose { hfov_deg: f32::NAN, ..good },
            CameraPose { target: Vec3::INFINITY, ..good },
        ] {
            assert_eq!(Camera::from_pose(&bad, 1.6, BOUNDS), framed);
        }
    }

    #[test]
    fn the_target_is_in_the_middle_and_the_horizontal_field_of_view_is_as_asked() {
        let camera = camera();
        let middle = ndc(&camera, camera.target, 1.6);
        assert!(middle.truncate().length() < 1e-5, "{middle}");
        // Truth: the definition. A direction turned by half of 70° to the right lies on the
        // picture's rim.
        let turned = Quat::from_axis_angle(Vec3::Y, -35f32.to_radians());
        let level =
            Camera::from_pose(&CameraPose { target: Vec3::new(1.0, 1.5, 0.0), ..camera.pose(1.6) }, 1.6, BOUNDS);
        let rim = ndc(&level, level.eye() + turned * level.forward(), 1.6);
        assert!((rim.x - 1.0).abs() < 1e-5 && rim.y.abs() < 1e-5, "{rim}");
    }

    #[test]
    fn depth_is_one_at_the_near_plane_and_falls_towards_zero() {
        let camera = camera();
        let at = |distance: f32| ndc(&camera, camera.eye() + distance * camera.forward(), 1.6).z;
        assert!((at(camera.near()) - 1.0).abs() < 1e-2);
        // Distances that differ by a hundred-thousandth are distinguished, near by and far away.
        for distance in [0.01, 1.0, 10.0, 1000.0] {
            assert!(at(distance) > at(distance * 1.00001) && at(distance * 1.00001) > 0.0, "{distance}");
        }
    }

    #[test]
    fn a_ray_meets_the_point_that_projects_to_it() {
        let camera = camera();
        for place in [vec2(0.0, 0.0), vec2(-0.9, 0.7), vec2(0.3, -0.8)] {
            let (origin, direction) = camera.ray(place, 1.6);
            assert!((direction.length() - 1.0).abs() < 1e-6);
            let projected = ndc(&camera, origin + 7.0 * direction, 1.6);
            assert!(projected.truncate().distance(place) < 1e-5, "{place} {projected}");
            assert!(camera.lens(1.6).direction(place).distance(direction) < 1e-6);
        }
    }

    #[test]
    fn framing_puts_every_corner_into_the_picture_and_fills_it() {
        for aspect in [0.4, 1.0, 2.5] {
            let camera = Camera::frame(BOUNDS, Vec3::Y, aspect);
            let corners = (0..8).map(|bits| {
                let upper = BVec3::new(bits & 1 != 0, bits & 2 != 0, bits & 4 != 0);
                ndc(&camera, Vec3::select(upper, BOUNDS.1, BOUNDS.0), aspect)
            });
            let widest = corners.map(|corner| corner.x.abs().max(corner.y.abs())).fold(0.0, f32::max);
            assert!((0.85..1.0).contains(&widest), "aspect {aspect}: {widest}");
        }
        // Neither an empty scene nor a folded window leads to what is not a number.
        for (bounds, aspect) in [((Vec3::ZERO, Vec3::ZERO), 1.0), ((Vec3::NAN, Vec3::INFINITY), 1.0), (BOUNDS, 0.0)] {
            assert!(Camera::frame(bounds, Vec3::Y, aspect).clip_from_world(aspect).is_finite());
        }
    }

    #[test]
    fn an_orbit_keeps_target_and_distance_and_never_flips_over_a_pole() {
        let mut camera = camera();
        let (target, distance) = (camera.target, camera.eye().distance(camera.target));
        for step in 0..400 {
            // Far over the pole and back, with some turning.
            let (side_before, _) = camera.screen_axes();
            camera.orbit(0.03, if step < 200 { 0.1 } else { -0.1 });
            let (side, above) = camera.screen_axes();
            assert!(above.dot(Vec3::Y) > 0.0, "upside down at step {step}");
            assert!(side.dot(side_before) > 0.99, "turned round at step {step}");
            assert_eq!(camera.target, target);
            assert!((camera.eye().distance(target) / distance - 1.0).abs() < 1e-4, "step {step}");
        }
        // A full turn comes back.
        let mut turned = self::camera();
        (0..100).for_each(|_| turned.orbit(2.0 * PI / 100.0, 0.0));
        assert!(turned.eye().distance(self::camera().eye()) < 1e-3);
    }

    #[test]
    fn dragging_moves_the_scene_with_the_mouse() {
        // Orbit: what is before the target goes right and down with the mouse.
        let mut camera = camera();
        let before = camera.target - 0.3 * camera.forward();
        camera.orbit(0.1, 0.1);
        let moved = ndc(&camera, before, 1.6);
        assert!(moved.x > 0.0 && moved.y < 0.0, "{moved}");
        // Pan: the old target is where the mouse is, half a height to the right and a quarter down.
        let mut camera = self::camera();
        let old = camera.target;
        camera.pan(0.5, 0.25);
        let moved = ndc(&camera, old, 1.6).truncate();
        assert!(moved.distance(vec2(1.0 / 1.6, -0.5)) < 1e-4, "{moved}");
    }

    #[test]
    fn zoom_and_flight_follow_the_scene_s_size() {
        let mut camera = camera();
        let distance = camera.eye().distance(camera.target);
        camera.zoom(0.5);
        assert!((camera.eye().distance(camera.target) / distance - 0.5).abs() < 1e-5);
        (0..1000).for_each(|_| camera.zoom(0.5));
        assert!(camera.eye().distance(camera.target) > 0.0 && camera.clip_from_world(1.0).is_finite());
        for bad in [0.0, -1.0, f32::NAN, f32::INFINITY] {
            let before = camera;
            camera.zoom(bad);
            assert_eq!(camera, before);
        }
        let mut camera = self::camera();
        let (eye, forward) = (camera.eye(), camera.forward());
        camera.fly(2.0 * Vec3::Z);
        let way = camera.eye() - eye;
        assert!((way.length() - 2.0 * FLY_SPEED * camera.scene_size()).abs() < 1e-4 && way.dot(forward) > 0.0);
    }

    #[test]
    fn looking_at_a_point_puts_it_in_the_middle() {
        let mut camera = camera();
        let (eye, point) = (camera.eye(), Vec3::new(-2.0, 0.2, 1.0));
        camera.look_at(point);
        assert!(camera.eye() == eye && camera.target.distance(point) < 1e-4);
        assert!(ndc(&camera, point, 1.6).truncate().length() < 1e-4);
        // Straight down has no heading; the camera keeps off the pole.
        camera.look_at(eye - 5.0 * Vec3::Y);
        assert!(camera.clip_from_world(1.6).is_finite());
        let pitch = camera.forward().dot(Vec3::Y).asin();
        assert!((pitch + FRAC_PI_2).abs() < 2.0 * POLE_GAP, "{pitch}");
    }
}
