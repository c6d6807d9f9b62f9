//! The view: mouse and keys move the camera, clicks pick; the picture is drawn by
//! [`crate::app::view::paint`].

use egui::{Key, PointerButton, Rect, Response, Ui};
use glam::{Vec2, Vec3};

use crate::app::Shown;
use crate::app::view::camera_menu::Whole;
use crate::app::view::eye::Eye;
use crate::app::view::first_view::FirstView;
use crate::app::view::paint::Picture;
use crate::app::view::walk::Ground;
use crate::geometry::Occluders;
use crate::read::survey::Ray;
use crate::render::Camera;
use crate::scene::{CameraPose, Scene};
use crate::worker::SceneInfo;

/// A drag across the view's height turns the camera by this, radians.
const TURN_PER_HEIGHT: f32 = std::f32::consts::PI;
/// Change of the distance's logarithm for each point of scrolling.
const ZOOM_PER_POINT: f32 = 0.002;
/// Flying speed with shift held, as a factor.
const FAST: f32 = 4.0;
/// Longest time of flight in one frame, seconds: a frame that took long must not throw the eye
/// through a wall.
const LONGEST_FLIGHT: f32 = 0.1;

/// Where the eye is, and where it started.
pub struct Viewport {
    camera: Option<Camera>,
    bounds: (Vec3, Vec3),
    /// Upwards in a view of everything.
    up: Vec3,
    start: Option<CameraPose>,
    first: FirstView,
    rect: Rect,
    /// Whether keys walk instead of flying.
    pub walks: bool,
    /// Views of the scene that a person kept.
    bookmarks: Vec<CameraPose>,
    /// The widget that takes mouse and keys.
    id: Option<egui::Id>,
    /// Picture that was drawn last.
    picture: Option<Picture>,
}

impl Default for Viewport {
    fn default() -> Self {
        Self {
            camera: None,
            bounds: (Vec3::ZERO, Vec3::ZERO),
            up: Vec3::Y,
            start: None,
            first: FirstView::default(),
            rect: Rect::ZERO,
            walks: false,
            bookmarks: Vec::new(),
            id: None,
            picture: None,
        }
    }
}

/// A click into the view, as a ray.
pub struct Clicked {
    pub origin: Vec3,
    pub direction: Vec3,
    pub is_double: bool,
}

impl Viewport {
    /// Looks at a new scene, from `first` or from its own camera where it has one.
    pub fn start_with(&mut self, scene: &Scene, first: Option<CameraPose>) {
        self.first = FirstView::of(first);
        self.bounds = scene.bounds();
        self.up = scene.up_axis();
        self.start = scene.camera;
        // Made when the view's aspect is known.
        self.camera = None;
        self.bookmarks.clone_from(&scene.bookmarks);
    }

    /// Goes back to the scene's own view.
    pub fn reset(&mut self) {
        self.camera = Some(self.start_camera());
    }

    /// Looks at all of the scene from outside.
    pub fn show_whole(&mut self, whole: Whole) {
        let (bounds, up, aspect) = (self.bounds, self.up, self.aspect());
        if let Some(camera) = self.camera.as_mut() {
            camera.look_along(whole.sight(up), bounds, aspect);
        }
    }

    /// Horizontal field of view, degrees.
    pub fn field_of_view(&self) -> Option<f32> {
        self.camera.map(|camera| camera.hfov(self.aspect()).to_degrees())
    }

    /// Sets the horizontal field of view, degrees; the eye stays.
    pub fn set_field_of_view(&mut self, degrees: f32) {
        if let Some(pose) = self.pose() {
            self.go_to(&CameraPose { hfov_deg: degrees, ..pose });
        }
    }

    /// Keeps the present view.
    pub fn add_bookmark(&mut self) {
        self.bookmarks.extend(self.pose());
    }

    /// Views that were kept.
    pub fn bookmarks(&self) -> &[CameraPose] {
        &self.bookmarks
    }

    /// Forgets a view that was kept.
    pub fn remove_bookmark(&mut self, index: usize) {
        self.bookmarks.remove(index);
    }

    /// Goes on looking as before at a scene that was read anew.
    pub fn go_on_with(&mut self, scene: &Scene) {
        self.bounds = scene.bounds();
        self.up = scene.up_axis();
        self.start = scene.camera;
    }

    /// Where the view lies in the window, points.
    pub fn rect(&self) -> Rect {
        self.rect
    }

    /// Takes the room that is left of the window, and follows mouse and keys there; where an area
    /// is drawn, drags do not turn the view.
    pub fn follow(&mut self, ui: &Ui, response: &Response, shown: &Shown, draws_area: bool) {
        (self.rect, self.id) = (response.rect, Some(response.id));
        if shown.snapshot.is_none() {
            return;
        }
        self.take_first_view();
        if response.clicked() || response.drag_started() {
            response.request_focus();
        }
        if !draws_area {
            self.steer(ui, response);
        }
        self.fly(ui, response, shown.info.as_deref());
    }

    /// The camera, once there is a view.
    pub fn camera(&self) -> Option<Camera> {
        self.camera
    }

    /// Remembers the picture that is drawn.
    pub fn note_picture(&mut self, picture: &Picture) {
        self.picture = Some(picture.clone());
    }

    /// The widget that takes mouse and keys, once it was drawn.
    pub fn id(&self) -> Option<egui::Id> {
        self.id
    }

    /// Size of what was drawn last, pixels.
    pub fn pixels(&self) -> [u32; 2] {
        self.picture.as_ref().map_or([0; 2], |picture| picture.size)
    }

    /// Picture that was drawn last, in another size, pixels.
    pub fn picture(&self, size: [u32; 2]) -> Option<Picture> {
        self.picture.clone().map(|picture| Picture { size, ..picture })
    }

    /// The present view, to be saved.
    pub fn pose(&self) -> Option<CameraPose> {
        self.camera.map(|camera| camera.pose(self.aspect()))
    }

    /// Looks from elsewhere.
    pub fn go_to(&mut self, pose: &CameraPose) {
        self.camera = Some(Camera::from_pose(pose, self.aspect(), self.bounds));
    }

    /// Turns the eye towards a point.
    pub fn look_at(&mut self, point: Vec3) {
        if let Some(camera) = self.camera.as_mut() {
            camera.look_at(point);
        }
    }

    /// Turns the eye towards a point that lies beyond the edges of the view; one within them moves
    /// nothing.
    pub fn turn_towards_unseen(&mut self, point: Vec3) {
        let aspect = self.aspect();
        if let Some(camera) = self.camera.as_mut() {
            let clip = camera.clip_from_world(aspect) * point.extend(1.0);
            if clip.w <= 0.0 || clip.x.abs() > clip.w || clip.y.abs() > clip.w {
                camera.look_at(point);
            }
        }
    }

    /// Width over height.
    pub fn aspect(&self) -> f32 {
        if self.rect.height() > 0.0 { self.rect.width() / self.rect.height() } else { 1.0 }
    }

    /// The camera of the scene's start.
    fn start_camera(&self) -> Camera {
        match &self.start {
            Some(pose) => Camera::from_pose(pose, self.aspect(), self.bounds),
            None => Camera::frame(self.bounds, self.up, self.aspect()),
        }
    }

    fn take_first_view(&mut self) {
        let mut first = std::mem::take(&mut self.first);
        let suited = |pose: Option<&CameraPose>| match pose {
            Some(pose) => Camera::from_pose(pose, self.aspect(), self.bounds),
            None => self.start_camera(),
        };
        self.camera = first.follow(self.camera, suited);
        self.first = first;
    }

    /// Mouse and wheel.
    fn steer(&mut self, ui: &Ui, response: &Response) {
        let Some(mut camera) = self.camera else { return };
        let drag = response.drag_delta() / self.rect.height().max(1.0);
        let shift = ui.input(|input| input.modifiers.shift);
        if response.dragged_by(PointerButton::Primary) && !shift {
            camera.orbit(TURN_PER_HEIGHT * drag.x, TURN_PER_HEIGHT * drag.y);
        } else if response.dragged() {
            camera.pan(drag.x, drag.y);
        }
        if response.contains_pointer() {
            let (scroll, pinch) = ui.input(|input| (input.smooth_scroll_delta().y, input.zoom_delta()));
            if scroll != 0.0 || pinch != 1.0 {
                camera.zoom((-ZOOM_PER_POINT * scroll).exp() / pinch);
            }
        }
        self.camera = Some(camera);
    }

    /// Keys; only while the view has the person's attention and no text is being typed.
    fn fly(&mut self, ui: &Ui, response: &Response, info: Option<&SceneInfo>) {
        let attends = response.has_focus() || response.contains_pointer();
        if !attends || ui.ctx().text_edit_focused() {
            return;
        }
        let (local, seconds, frame_all, home) = ui.input(|input| {
            let axis = |plus, minus| f32::from(i8::from(input.key_down(plus)) - i8::from(input.key_down(minus)));
            let local = match input.modifiers.command || input.modifiers.alt {
                true => Vec3::ZERO,
                false => Vec3::new(axis(Key::D, Key::A), axis(Key::E, Key::Q), axis(Key::W, Key::S)),
            };
            let speed = if input.modifiers.shift { FAST } else { 1.0 };
            let seconds = input.stable_dt.min(LONGEST_FLIGHT);
            (speed * local, seconds, input.key_pressed(Key::F), input.key_pressed(Key::Home))
        });
        let aspect = self.aspect();
        if home {
            self.reset();
        }
        let (bounds, up, walks) = (self.bounds, self.up, self.walks);
        let Some(camera) = self.camera.as_mut() else { return };
        if frame_all {
            camera.frame_all(bounds, aspect);
        }
        if local != Vec3::ZERO {
            match info.filter(|_| walks) {
                Some(info) => {
                    let height = (bounds.1 - bounds.0).dot(up).abs();
                    let ground = Ground { scene: &info.scene, occluders: &info.occluders, up, height };
                    ground.step(camera, seconds * Vec2::new(local.x, local.z));
                }
                None => camera.fly(seconds * local),
            }
            ui.ctx().request_repaint();
        }
    }

    /// Where a point of the scene lies in the window; `None` behind the eye.
    pub fn project(&self, point: Vec3) -> Option<egui::Pos2> {
        let camera = self.camera?;
        let clip = camera.clip_from_world(self.aspect()) * point.extend(1.0);
        let share = egui::vec2(0.5 + 0.5 * clip.x / clip.w, 0.5 - 0.5 * clip.y / clip.w);
        (clip.w > camera.near()).then(|| self.rect.min + share * self.rect.size())
    }

    /// Whether nothing that is drawn stands before a point of the scene.
    pub fn sees(&self, point: Vec3, occluders: &Occluders) -> bool {
        self.camera.is_none_or(|camera| Eye::new(self.rect, &camera, occluders).sees(point))
    }

    /// Length at a point of the scene that takes so many points of the window across the sight;
    /// `None` behind the eye.
    pub fn length_of(&self, point: Vec3, points: f32) -> Option<f32> {
        let camera = self.camera?;
        let across = camera.forward().any_orthonormal_vector();
        let step = 1e-2 * (point - camera.eye()).length();
        let along = (self.project(point + step * across)? - self.project(point)?).length() / step;
        (along > 0.0 && along.is_finite()).then(|| points / along)
    }

    /// The ray under a place in the window.
    pub fn ray_at(&self, at: egui::Pos2) -> Option<Ray> {
        let share = (at - self.rect.min) / self.rect.size();
        let ndc = Vec2::new(2.0 * share.x - 1.0, 1.0 - 2.0 * share.y);
        let (origin, direction) = self.camera?.ray(ndc, self.aspect());
        Some(Ray { origin, direction })
    }

    /// The ray under a click.
    pub fn clicked(&self, response: &Response) -> Option<Clicked> {
        let is_double = response.double_clicked();
        if !(response.clicked() || is_double) {
            return None;
        }
        let Ray { origin, direction } = self.ray_at(response.interact_pointer_pos()?)?;
        Some(Clicked { origin, direction, is_double })
    }
}
