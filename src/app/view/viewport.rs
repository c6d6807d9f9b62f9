//! The view: mouse and keys move the camera, clicks pick; the picture is drawn by
//! [`crate::app::view::paint`].

use egui::{Key, PointerButton, Rect, Response, Sense, Ui};
use glam::{Vec2, Vec3};

use crate::app::tools::Tool;
use crate::app::view::camera_menu::Whole;
use crate::app::view::divider;
use crate::app::view::eye::Eye;
use crate::app::view::first_view::FirstView;
use crate::app::view::gizmo;
use crate::app::view::highlight::Highlight;
use crate::app::view::line_labels;
use crate::app::view::measure_marks;
use crate::app::view::paint::Picture;
use crate::app::view::walk::Ground;
use crate::app::widgets::theme;
use crate::app::{App, Outbox, panels};
use crate::geometry::Occluders;
use crate::read::survey::Ray;
use crate::render::{Camera, Display, Exposure, Marks};
use crate::scene::{CameraPose, Scene};
use crate::solve::USUAL_ERROR;
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

/// Longest side of the picture, pixels: what every device draws.
const LARGEST_PICTURE: f32 = 8192.0;

/// Name of the view for assistive technology and tests.
const VIEW_NAME: &str = "View";

/// Where the eye is, and where it started.
pub(in crate::app) struct Viewport {
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
pub(in crate::app) struct Clicked {
    pub origin: Vec3,
    pub direction: Vec3,
    pub is_double: bool,
}

impl Viewport {
    /// Looks at a new scene, from `first` or from its own camera where it has one.
    pub(in crate::app) fn start_with(&mut self, scene: &Scene, first: Option<CameraPose>) {
        self.first = FirstView::of(first);
        self.bounds = scene.bounds();
        self.up = scene.up_axis();
        self.start = scene.camera;
        // Made when the view's aspect is known.
        self.camera = None;
        self.bookmarks.clone_from(&scene.bookmarks);
    }

    /// Goes back to the scene's own view.
    pub(in crate::app) fn reset(&mut self) {
        self.camera = Some(self.start_camera());
    }

    /// Looks at all of the scene from outside.
    pub(in crate::app) fn show_whole(&mut self, whole: Whole) {
        let (bounds, up, aspect) = (self.bounds, self.up, self.aspect());
        if let Some(camera) = self.camera.as_mut() {
            camera.look_along(whole.sight(up), bounds, aspect);
        }
    }

    /// Horizontal field of view, degrees.
    pub(in crate::app) fn field_of_view(&self) -> Option<f32> {
        self.camera.map(|camera| camera.hfov(self.aspect()).to_degrees())
    }

    /// Sets the horizontal field of view, degrees; the eye stays.
    pub(in crate::app) fn set_field_of_view(&mut self, degrees: f32) {
        if let Some(pose) = self.pose() {
            self.go_to(&CameraPose { hfov_deg: degrees, ..pose });
        }
    }

    /// Keeps the present view.
    pub(in crate::app) fn add_bookmark(&mut self) {
        self.bookmarks.extend(self.pose());
    }

    /// Views that were kept.
    pub(in crate::app) fn bookmarks(&self) -> &[CameraPose] {
        &self.bookmarks
    }

    /// Forgets a view that was kept.
    pub(in crate::app) fn remove_bookmark(&mut self, index: usize) {
        self.bookmarks.remove(index);
    }

    /// Goes on looking as before at a scene that was read anew.
    pub(in crate::app) fn go_on_with(&mut self, scene: &Scene) {
        self.bounds = scene.bounds();
        self.up = scene.up_axis();
        self.start = scene.camera;
    }

    /// Where the view lies in the window, points.
    pub(in crate::app) fn rect(&self) -> Rect {
        self.rect
    }

    /// The widget that takes mouse and keys, once it was drawn.
    pub(in crate::app) fn id(&self) -> Option<egui::Id> {
        self.id
    }

    /// Size of what was drawn last, pixels.
    pub(in crate::app) fn pixels(&self) -> [u32; 2] {
        self.picture.as_ref().map_or([0; 2], |picture| picture.size)
    }

    /// Picture that was drawn last, in another size, pixels.
    pub(in crate::app) fn picture(&self, size: [u32; 2]) -> Option<Picture> {
        self.picture.clone().map(|picture| Picture { size, ..picture })
    }

    /// The present view, to be saved.
    pub(in crate::app) fn pose(&self) -> Option<CameraPose> {
        self.camera.map(|camera| camera.pose(self.aspect()))
    }

    /// Looks from elsewhere.
    pub(in crate::app) fn go_to(&mut self, pose: &CameraPose) {
        self.camera = Some(Camera::from_pose(pose, self.aspect(), self.bounds));
    }

    /// Turns the eye towards a point.
    pub(in crate::app) fn look_at(&mut self, point: Vec3) {
        if let Some(camera) = self.camera.as_mut() {
            camera.look_at(point);
        }
    }

    /// Turns the eye towards a point that lies beyond the edges of the view; one within them moves
    /// nothing.
    pub(in crate::app) fn turn_towards_unseen(&mut self, point: Vec3) {
        let aspect = self.aspect();
        if let Some(camera) = self.camera.as_mut() {
            let clip = camera.clip_from_world(aspect) * point.extend(1.0);
            if clip.w <= 0.0 || clip.x.abs() > clip.w || clip.y.abs() > clip.w {
                camera.look_at(point);
            }
        }
    }

    fn aspect(&self) -> f32 {
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
    pub(in crate::app) fn project(&self, point: Vec3) -> Option<egui::Pos2> {
        let camera = self.camera?;
        let clip = camera.clip_from_world(self.aspect()) * point.extend(1.0);
        let share = egui::vec2(0.5 + 0.5 * clip.x / clip.w, 0.5 - 0.5 * clip.y / clip.w);
        (clip.w > camera.near()).then(|| self.rect.min + share * self.rect.size())
    }

    /// Whether nothing that is drawn stands before a point of the scene.
    pub(in crate::app) fn sees(&self, point: Vec3, occluders: &Occluders) -> bool {
        self.camera.is_none_or(|camera| Eye::new(self.rect, &camera, occluders).sees(point))
    }

    /// Length at a point of the scene that takes so many points of the window across the sight;
    /// `None` behind the eye.
    pub(in crate::app) fn length_of(&self, point: Vec3, points: f32) -> Option<f32> {
        let camera = self.camera?;
        let across = camera.forward().any_orthonormal_vector();
        let step = 1e-2 * (point - camera.eye()).length();
        let along = (self.project(point + step * across)? - self.project(point)?).length() / step;
        (along > 0.0 && along.is_finite()).then(|| points / along)
    }

    /// The ray under a place in the window.
    pub(in crate::app) fn ray_at(&self, at: egui::Pos2) -> Option<Ray> {
        let share = (at - self.rect.min) / self.rect.size();
        let ndc = Vec2::new(2.0 * share.x - 1.0, 1.0 - 2.0 * share.y);
        let (origin, direction) = self.camera?.ray(ndc, self.aspect());
        Some(Ray { origin, direction })
    }

    /// The ray under a click.
    fn clicked(&self, response: &Response) -> Option<Clicked> {
        let is_double = response.double_clicked();
        if !(response.clicked() || is_double) {
            return None;
        }
        let Ray { origin, direction } = self.ray_at(response.interact_pointer_pos()?)?;
        Some(Clicked { origin, direction, is_double })
    }
}

/// Draws the view over all that is left of the window, and what lies over it.
pub(in crate::app) fn show(app: &mut App, ui: &mut Ui, outbox: &mut Outbox) -> Option<Clicked> {
    let (rect, response) = ui.allocate_exact_size(ui.available_size(), Sense::click_and_drag());
    response.widget_info(|| egui::WidgetInfo::labeled(egui::accesskit::Role::Canvas, true, VIEW_NAME));
    (app.view.viewport.rect, app.view.viewport.id) = (rect, Some(response.id));
    panels::hint::show_way_back(app, ui, rect);
    ui.painter().rect_filled(rect, 0.0, theme::WELL);
    let Some(latest) = app.shown.snapshot.clone() else {
        panels::empty::show(app, ui, rect, outbox);
        return None;
    };
    let snapshot = app.shown.in_view.clone().unwrap_or(latest);
    app.view.viewport.take_first_view();
    if response.clicked() || response.drag_started() {
        response.request_focus();
    }
    if app.tools.measuring.draws_area {
        draw_area(app, &response);
    } else {
        app.view.viewport.steer(ui, &response);
    }
    app.view.viewport.fly(ui, &response, app.shown.info.as_deref());
    let clicked = app.view.viewport.clicked(&response);
    // While the view turns nothing can be read, nor off surfaces that lie elsewhere than in the
    // scene.
    let can_read = !response.dragged() && !app.view.clusters.is_exploded();
    let pointer = response.hover_pos().filter(|_| can_read).and_then(|at| app.view.viewport.ray_at(at));
    app.tools.measuring.point_at(pointer, &app.wake);
    if app.tools.open.is_some_and(Tool::marks_what_is_pointed_at)
        && let Some(reading) = app.tools.measuring.under_pointer()
    {
        app.view.pointing.at(Highlight::Element(reading.leaf.element));
    }

    let (mut is_unlit, mut looks_through_walls) = (false, false);
    if let Some(camera) = app.view.viewport.camera {
        let scale = ui.ctx().pixels_per_point();
        let deepest = snapshot.clusters.iter().map(|cluster| cluster.level).max().unwrap_or(0);
        let is_dark = app.shown.info.as_ref().is_some_and(|info| !info.has_light);
        let picked = app.picked.as_ref().map(|picked| picked.element);
        let (beside, chosen) = (app.tools.pinned.beside(), app.edits.display.display());
        // Colours that stand for errors would be none of the solution beside.
        let errors = if beside.is_none() { app.tools.comparison.painted() } else { None };
        let other = app.tools.pinned.painted().or(errors);
        let has_errors = other.is_some();
        let other = other.or_else(|| app.tools.pinned.alone());
        // Clusters are shown of the present solution, where nothing else is asked for.
        let level = (beside.is_none() && other.is_none()).then(|| app.edits.display.cluster_level.min(deepest));
        let by_clusters = app.view.clusters.painted(&snapshot, level);
        let marks = match &snapshot.solution_view {
            Some(solution_view) if app.view.clusters.is_exploded() => {
                app.view.clusters.marks(solution_view, picked, app.view.pointing.now())
            }
            _ => {
                let links = &app.edits.display.links;
                app.tools.clusters.with_group(app.view.marks.over(
                    &snapshot,
                    picked,
                    &app.tools.inspection,
                    links,
                    app.view.pointing.now(),
                ))
            }
        };
        let open_ground = app.shown.info.as_ref().and_then(|info| info.open_ground.ok());
        let reading = app.view.reading.follow(&snapshot, open_ground, &app.edits.display.reading);
        if let Some(info) = &app.shown.info {
            // A lamp that is dimmed is to be seen dimmer.
            let is_held = ui.ctx().egui_is_using_pointer() && !response.dragged();
            let aspect = app.view.viewport.aspect();
            app.view.exposure = app.view.metering.follow(&snapshot, info, &camera, aspect, is_held);
            if app.view.metering.is_behind() {
                ui.ctx().request_repaint_after(crate::app::REPAINT_INTERVAL_ON_CPU);
            }
        }
        // In false colours and beside another solution, darkness is what is shown.
        let is_plain = beside.is_none() && other.is_none() && by_clusters.is_none();
        let own_colours = match is_plain && reading.is_none() {
            true => app.view.own_colours.painted(&snapshot, app.shown.info.as_ref()),
            false => None,
        };
        let is_dark_here = !is_dark && is_plain && snapshot.field.is_some() && app.view.metering.is_dark();
        is_unlit = (own_colours.is_some() || is_dark_here) && app.shown.status.loading.is_none();
        let metered = app.tools.pinned.exposure(app.view.exposure);
        let display = Display {
            exposure: Exposure::Manual { stops: chosen.exposure.factor(metered).log2() },
            as_colours: has_errors || own_colours.is_some() || (by_clusters.is_some() && app.view.clusters.coloured),
            reading,
        };
        let size = picture_size(rect.size() * scale);
        // What stands beside, or for something else than light, is the mesh's.
        let can_gather = app.edits.display.is_gathered && is_plain && own_colours.is_none() && snapshot.field.is_some();
        app.view.painted = match can_gather {
            true => app.view.gathering.follow(&snapshot, &camera, &display, size, ui.ctx()),
            false => {
                app.view.gathering.rest();
                None
            }
        };
        let picture = Picture {
            outside: app.shown.info.as_ref().and_then(|info| info.scene.outside().cloned()),
            camera,
            display,
            gathered: app.view.painted.as_ref().map(|painted| (painted.serial, painted.pixels.clone())),
            noise: can_gather.then(|| snapshot.stats.error_asked.unwrap_or(USUAL_ERROR) as f32),
            snapshot: other.or(by_clusters).or(own_colours.clone()).unwrap_or(snapshot),
            beside,
            overlay: app.edits.display.overlay(
                deepest,
                is_dark && own_colours.is_none(),
                if app.layout.is_full_picture { Marks::default() } else { marks },
            ),
            size,
        };
        app.view.viewport.picture = Some(picture.clone());
        picture.add_to(&ui.painter_at(rect), rect);
        if let Some((painted, reading)) = app.view.painted.as_ref().zip(reading) {
            line_labels::show(ui, rect, &painted.pixels, reading.shown_in);
        }
        if let Some(info) = &app.shown.info {
            let eye = Eye::new(rect, &camera, &info.occluders);
            // What was measured is of the present.
            if app.tools.playback.step.is_none() {
                measure_marks::show(ui, rect, &eye, &app.tools.measuring, reading.as_ref());
            }
            if app.tools.open == Some(Tool::Measure)
                && let Some(outline) = app.tools.measuring.area_outline(&info.scene)
            {
                let corners = outline.map(|corner| app.view.viewport.project(corner));
                measure_marks::show_area(&ui.painter_at(rect), corners);
            }
            looks_through_walls = eye.looks_through_walls();
        }
    }
    app.view.overlays.clear();
    divider::show(ui, rect, &mut app.tools.pinned);
    gizmo::show(app, ui, rect);
    panels::empty::show_loading(app, ui, rect, outbox);
    if !app.layout.is_full_picture {
        // What comes first keeps its place.
        panels::readout::show(app, ui, rect);
        panels::step::show(app, ui, rect);
        panels::picked::show(app, ui, rect);
        panels::legend::show_meaning(app, ui, rect);
        panels::links::show_legend(app, ui, rect);
        if is_unlit {
            panels::light::show_ways_to_light(app, ui, rect, outbox);
        }
        panels::readout::show_notes(app, ui, rect, looks_through_walls);
        panels::tag::show(app, ui, rect);
        panels::hint::show_first_lines(app, ui, rect);
    }
    panels::empty::show_drop_hint(ui, rect);
    clicked
}

/// Lets a drag draw a task area on the work plane.
fn draw_area(app: &mut App, response: &Response) {
    let Some(info) = app.shown.info.clone() else { return };
    let ctx = &response.ctx;
    let from = ctx.input(|input| input.pointer.press_origin()).or(app.tools.measuring.pressed);
    app.tools.measuring.pressed = from;
    let ends = from.zip(response.interact_pointer_pos());
    let rays = ends.and_then(|(from, to)| app.view.viewport.ray_at(from).zip(app.view.viewport.ray_at(to)));
    if let Some((from, to)) = rays.filter(|_| response.dragged() || response.drag_stopped()) {
        app.tools.measuring.draw_area(&info.scene, [from, to], response.drag_stopped());
    }
    if response.drag_stopped()
        && app.tools.measuring.plane.area.is_some()
        && let Some(snapshot) = app.shown.in_view.clone()
    {
        app.tools.measuring.measure_plane(&info.scene, &snapshot, &app.wake);
    }
    ctx.set_cursor_icon(egui::CursorIcon::Crosshair);
}

/// Pixels of a view of this size: at least one, and no more than every device draws; what is larger
/// is drawn coarser.
fn picture_size(pixels: egui::Vec2) -> [u32; 2] {
    let shrink = (LARGEST_PICTURE / pixels.max_elem().max(1.0)).min(1.0);
    [pixels.x, pixels.y].map(|side| if side.is_finite() { (shrink * side).round().max(1.0) as u32 } else { 1 })
}
