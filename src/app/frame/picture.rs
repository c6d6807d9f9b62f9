//! The view: its picture, put together from what is to be shown, and what lies over it.

use std::sync::Arc;

use egui::{Rect, Response, Sense, Ui};

use crate::app::panels::{empty, hint, legend, light, links, picked, readout, step, tag};
use crate::app::tools::Tool;
use crate::app::view::eye::Eye;
use crate::app::view::highlight::Highlight;
use crate::app::view::paint::Picture;
use crate::app::view::viewport::Clicked;
use crate::app::view::{divider, gizmo, line_labels, measure_marks};
use crate::app::widgets::theme;
use crate::app::{App, Outbox, REPAINT_INTERVAL_ON_CPU};
use crate::render::{Camera, Display, Marks};
use crate::solve::{Snapshot, USUAL_ERROR};

/// Longest side of the picture, pixels: what every device draws.
const LARGEST_PICTURE: f32 = 8192.0;

/// Name of the view for assistive technology and tests.
const VIEW_NAME: &str = "View";

impl App {
    /// Draws the view over all that is left of the window, and what lies over it.
    pub(super) fn show_view(&mut self, ui: &mut Ui, outbox: &mut Outbox) -> Option<Clicked> {
        let (rect, response) = ui.allocate_exact_size(ui.available_size(), Sense::click_and_drag());
        response.widget_info(|| egui::WidgetInfo::labeled(egui::accesskit::Role::Canvas, true, VIEW_NAME));
        self.view.viewport.follow(ui, &response, &self.shown, self.tools.measuring.draws_area);
        if self.layout.is_full_picture {
            hint::show_way_back(ui, rect, outbox);
        }
        ui.painter().rect_filled(rect, 0.0, theme::WELL);
        let Some(latest) = self.shown.snapshot.clone() else {
            empty::show(ui, &self.shown, rect, outbox);
            return None;
        };
        let snapshot = self.shown.in_view.clone().unwrap_or(latest);
        if self.tools.measuring.draws_area {
            self.draw_area(&response);
        }
        let clicked = self.view.viewport.clicked(&response);
        self.point(&response);
        let (mut is_unlit, mut looks_through_walls) = (false, false);
        if let Some(camera) = self.view.viewport.camera() {
            is_unlit = self.draw_picture(ui, &response, snapshot, &camera);
            looks_through_walls = self.show_measured(ui, rect, &camera);
        }
        self.show_over(ui, rect, is_unlit, looks_through_walls, outbox);
        clicked
    }

    /// Reads the surface under the pointer.
    fn point(&mut self, response: &Response) {
        let (view, tools) = (&mut self.view, &mut self.tools);
        // While the view turns nothing can be read, nor off surfaces that lie elsewhere than in the
        // scene.
        let can_read = !response.dragged() && !view.clusters.is_exploded();
        let pointer = response.hover_pos().filter(|_| can_read).and_then(|at| view.viewport.ray_at(at));
        tools.measuring.point_at(pointer, &self.wake);
        if tools.open.is_some_and(Tool::marks_what_is_pointed_at)
            && let Some(reading) = tools.measuring.under_pointer()
        {
            view.pointing.at(Highlight::Element(reading.leaf.element));
        }
    }

    /// Draws the picture; whether nothing lights what is seen.
    fn draw_picture(&mut self, ui: &Ui, response: &Response, snapshot: Arc<Snapshot>, camera: &Camera) -> bool {
        let Self { shown, view, tools, edits, .. } = self;
        let (rect, info) = (response.rect, shown.info.as_ref());
        let deepest = snapshot.clusters.iter().map(|cluster| cluster.level).max().unwrap_or(0);
        let is_dark = info.is_some_and(|info| !info.has_light);
        let picked = shown.picked_element();
        let beside = tools.pinned.beside();
        // Colours that stand for errors would be none of the solution beside.
        let errors = if beside.is_none() { tools.comparison.painted() } else { None };
        let other = tools.pinned.painted().or(errors);
        let has_errors = other.is_some();
        let other = other.or_else(|| tools.pinned.alone());
        // Clusters are shown of the present solution, where nothing else is asked for.
        let level = (beside.is_none() && other.is_none()).then(|| edits.display.cluster_level.min(deepest));
        let by_clusters = view.clusters.painted(&snapshot, level);
        let pointed = view.pointing.now();
        let marks = match &snapshot.solution_view {
            Some(solution_view) if view.clusters.is_exploded() => view.clusters.marks(solution_view, picked, pointed),
            _ => {
                let marks = view.marks.over(&snapshot, picked, &tools.inspection, &edits.display.links, pointed);
                tools.clusters.with_group(marks)
            }
        };
        let open_ground = info.and_then(|info| info.open_ground.ok());
        let reading = view.reading.follow(&snapshot, open_ground, &edits.display.reading);
        if let Some(info) = info {
            // A lamp that is dimmed is to be seen dimmer.
            let is_held = ui.ctx().egui_is_using_pointer() && !response.dragged();
            view.exposure = view.metering.follow(&snapshot, info, camera, view.viewport.aspect(), is_held);
            if view.metering.is_behind() {
                ui.ctx().request_repaint_after(REPAINT_INTERVAL_ON_CPU);
            }
        }
        // In false colours and beside another solution, darkness is what is shown.
        let is_plain = beside.is_none() && other.is_none() && by_clusters.is_none();
        let own_colours = match is_plain && reading.is_none() {
            true => view.own_colours.painted(&snapshot, info),
            false => None,
        };
        let is_dark_here = !is_dark && is_plain && snapshot.field.is_some() && view.metering.is_dark();
        let is_unlit = own_colours.is_some() || is_dark_here;
        let metered = tools.pinned.exposure(view.exposure);
        let display = Display {
            exposure: edits.display.exposure(metered),
            as_colours: has_errors || own_colours.is_some() || (by_clusters.is_some() && view.clusters.coloured),
            reading,
        };
        let size = picture_size(rect.size() * ui.ctx().pixels_per_point());
        // What stands beside, or for something else than light, is the mesh's.
        let can_gather = edits.display.is_gathered && is_plain && own_colours.is_none() && snapshot.field.is_some();
        view.painted = match can_gather {
            true => view.gathering.follow(&snapshot, camera, &display, size, ui.ctx()),
            false => {
                view.gathering.rest();
                None
            }
        };
        let marks = if self.layout.is_full_picture { Marks::default() } else { marks };
        let picture = Picture {
            outside: info.and_then(|info| info.scene.outside().cloned()),
            camera: *camera,
            display,
            gathered: view.painted.as_ref().map(|painted| (painted.serial, painted.pixels.clone())),
            noise: can_gather.then(|| snapshot.stats.error_asked.unwrap_or(USUAL_ERROR) as f32),
            overlay: edits.display.overlay(deepest, is_dark && own_colours.is_none(), marks),
            snapshot: other.or(by_clusters).or(own_colours).unwrap_or(snapshot),
            beside,
            size,
        };
        view.viewport.note_picture(&picture);
        picture.add_to(&ui.painter_at(rect), rect);
        is_unlit
    }

    /// Draws what was measured over the picture; whether that looks through walls.
    fn show_measured(&self, ui: &Ui, rect: Rect, camera: &Camera) -> bool {
        let (view, tools) = (&self.view, &self.tools);
        let reading = view.reading.last();
        if let Some((painted, reading)) = view.painted.as_ref().zip(reading) {
            line_labels::show(ui, rect, &painted.pixels, reading.shown_in);
        }
        let Some(info) = &self.shown.info else { return false };
        let eye = Eye::new(rect, camera, &info.occluders);
        // What was measured is of the present.
        if tools.playback.step.is_none() {
            measure_marks::show(ui, rect, &eye, &tools.measuring, reading.as_ref());
        }
        if tools.open == Some(Tool::Measure)
            && let Some(outline) = tools.measuring.area_outline(&info.scene)
        {
            let corners = outline.map(|corner| view.viewport.project(corner));
            measure_marks::show_area(&ui.painter_at(rect), corners);
        }
        eye.looks_through_walls()
    }

    /// Draws handles, cards, legends and notes over the view.
    fn show_over(&mut self, ui: &mut Ui, rect: Rect, is_unlit: bool, looks_through_walls: bool, outbox: &mut Outbox) {
        let Self { shown, view, tools, edits, layout, .. } = self;
        view.overlays.clear();
        divider::show(ui, rect, &mut tools.pinned);
        if !layout.is_full_picture && !view.clusters.is_exploded() {
            gizmo::show(ui, rect, &view.viewport, &mut edits.light);
        }
        empty::show_loading(ui, shown, rect, outbox);
        if !layout.is_full_picture {
            // The inspector tells all that card and tag tell.
            let tells_less = tools.open != Some(Tool::Inspector);
            let has_card = tells_less && layout.is_card_open && shown.picked.is_some();
            // What comes first keeps its place.
            readout::show(ui, rect, shown, view, &tools.measuring, has_card);
            step::show(ui, rect, shown, &mut view.overlays);
            if has_card {
                picked::show(ui, rect, shown, &mut view.overlays, &mut tools.inspection, outbox);
            }
            legend::show_meaning(ui, rect, view, tools, &edits.display.reading);
            links::show_legend(ui, rect, shown, view, edits.display.links.style.colour);
            if is_unlit && shown.status.loading.is_none() {
                light::show_ways_to_light(ui, rect, shown, view, &mut edits.light, outbox);
            }
            readout::show_notes(ui, rect, view, &tools.measuring, looks_through_walls);
            if tells_less && !has_card {
                tag::show(ui, rect, shown, view, tools, edits.display.links.of, outbox);
            }
            hint::show_first_lines(ui, rect, &mut view.overlays, &mut layout.appearance.is_hint_shown);
        }
        empty::show_drop_hint(ui, rect);
    }

    /// Lets a drag draw a task area on the work plane.
    fn draw_area(&mut self, response: &Response) {
        let Some(info) = &self.shown.info else { return };
        let (measuring, viewport) = (&mut self.tools.measuring, &self.view.viewport);
        let ctx = &response.ctx;
        let from = ctx.input(|input| input.pointer.press_origin()).or(measuring.pressed);
        measuring.pressed = from;
        let ends = from.zip(response.interact_pointer_pos());
        let rays = ends.and_then(|(from, to)| viewport.ray_at(from).zip(viewport.ray_at(to)));
        if let Some((from, to)) = rays.filter(|_| response.dragged() || response.drag_stopped()) {
            measuring.draw_area(&info.scene, [from, to], response.drag_stopped());
        }
        if response.drag_stopped()
            && measuring.plane.area.is_some()
            && let Some(snapshot) = &self.shown.in_view
        {
            measuring.measure_plane(&info.scene, snapshot, &self.wake);
        }
        ctx.set_cursor_icon(egui::CursorIcon::Crosshair);
    }
}

/// Pixels of a view of this size: at least one, and no more than every device draws; what is larger
/// is drawn coarser.
fn picture_size(pixels: egui::Vec2) -> [u32; 2] {
    let shrink = (LARGEST_PICTURE / pixels.max_elem().max(1.0)).min(1.0);
    [pixels.x, pixels.y].map(|side| if side.is_finite() { (shrink * side).round().max(1.0) as u32 } else { 1 })
}
