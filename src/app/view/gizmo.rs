//! Handles of the luminaire at hand, over the view: an arrow along each axis that moves it when it
//! is dragged.

use egui::{Align2, Color32, FontId, Painter, Pos2, Rect, Sense, Stroke, Ui, vec2};
use glam::Vec3;

use crate::app::panels::light::LightEditor;
use crate::app::view::measure_marks::show_rim;
use crate::app::view::viewport::Viewport;
use crate::app::words;
use crate::read::survey::Ray;

/// Length of an arrow, points.
const ARROW: f32 = 64.0;
/// Side of the square at the tip that takes the pointer, points.
const GRIP: f32 = 24.0;
/// Side of a square along the shaft that does, points.
const SHAFT_GRIP: f32 = 14.0;
/// An arrow that is shorter than this, points, points at the eye: it cannot be dragged.
const SHORTEST: f32 = 14.0;
/// Part of the unit of length by which an axis is projected.
const STEP: f32 = 1e-2;
/// Colours of the axes, as everywhere.
const AXES: [(Vec3, &str, &str, Color32); 3] = [
    (Vec3::X, "x", "Move the luminaire along x", Color32::from_rgb(235, 80, 80)),
    (Vec3::Y, "y", words::MOVE_ALONG_Y, Color32::from_rgb(95, 200, 95)),
    (Vec3::Z, "z", "Move the luminaire along z", Color32::from_rgb(90, 140, 255)),
];

/// A drag that goes on: where the luminaire was when it began, and where along the axis the pointer
/// took hold.
#[derive(Clone, Copy, Debug, Default)]
struct Hold {
    centre: Vec3,
    at: f32,
}

/// How far along a line the point lies that is nearest to a ray; `None` where they run alike.
fn nearest_along(point: Vec3, axis: Vec3, ray: &Ray) -> Option<f32> {
    let direction = ray.direction.try_normalize()?;
    let across = axis.dot(direction);
    let sine_squared = 1.0 - across * across;
    let between = ray.origin - point;
    (sine_squared > 1e-4).then(|| (axis.dot(between) - across * direction.dot(between)) / sine_squared)
}

/// Draws the handles and follows them.
pub fn show(ui: &Ui, rect: Rect, viewport: &Viewport, light: &mut LightEditor) {
    let Some(form) = light.selected_mut().map(|luminaire| luminaire.form) else { return };
    let painter = ui.painter_at(rect);
    let outline: Vec<_> = form.outline().iter().map(|corner| viewport.project(*corner)).collect();
    show_rim(&painter, &outline, Stroke::new(1.5, Color32::from_rgb(255, 210, 90)));
    let Some(middle) = viewport.project(form.centre) else { return };
    for (axis, letter, name, colour) in AXES {
        let step = STEP * form.size;
        let Some(beside) = viewport.project(form.centre + step * axis) else { continue };
        let per_length = (beside - middle) / step;
        // As long for every axis as the longest could be: those that point at the eye are short.
        let Some(length) = viewport.length_of(form.centre, ARROW) else { continue };
        let arrow = length * per_length;
        if arrow.length() < SHORTEST {
            continue;
        }
        let tip = middle + arrow;
        let grip = take_hold(ui, name, middle, tip);
        grip.widget_info(|| egui::WidgetInfo::labeled(egui::accesskit::Role::Slider, true, name));
        let is_held = grip.dragged() || grip.hovered();
        draw_arrow(&painter, middle, tip, letter, if is_held { Color32::WHITE } else { colour });
        let id = grip.id;
        if let Some(ray) = grip.interact_pointer_pos().and_then(|at| viewport.ray_at(at)) {
            if grip.drag_started()
                && let Some(at) = nearest_along(form.centre, axis, &ray)
            {
                ui.data_mut(|data| data.insert_temp(id, Hold { centre: form.centre, at }));
            }
            let hold: Option<Hold> = ui.data(|data| data.get_temp(id));
            if let Some(hold) = hold.filter(|_| grip.dragged())
                && let Some(now) = nearest_along(hold.centre, axis, &ray)
                && let Some(luminaire) = light.selected_mut()
            {
                luminaire.form.centre = hold.centre + (now - hold.at) * axis;
            }
        }
        let _ = grip.on_hover_cursor(egui::CursorIcon::Grab).on_hover_text(name);
    }
    painter.circle(middle, 4.0, Color32::WHITE, Stroke::new(1.0, Color32::BLACK));
}

/// Areas by which the pointer takes hold of an arrow: its tip, and squares along its shaft, away
/// from the middle where the arrows meet.
fn take_hold(ui: &Ui, name: &str, middle: Pos2, tip: Pos2) -> egui::Response {
    let take = |at: Pos2, side: f32, number: usize| {
        let id = ui.scope_id().with((name, number));
        ui.interact(Rect::from_center_size(at, vec2(side, side)), id, Sense::click_and_drag())
    };
    let count = ((tip - middle).length() / SHAFT_GRIP) as usize;
    let along = |number: usize| tip + (number as f32 / count as f32) * (middle - tip);
    let shaft = (1..=count * 2 / 3).map(|number| take(along(number), SHAFT_GRIP, number));
    // The tip lies above the shaft.
    shaft.collect::<Vec<_>>().into_iter().fold(take(tip, GRIP, 0), |all, part| all | part)
}

fn draw_arrow(painter: &Painter, from: Pos2, tip: Pos2, letter: &str, colour: Color32) {
    let along = (tip - from).normalized();
    let across = vec2(-along.y, along.x);
    painter.line_segment([from, tip], Stroke::new(4.0, Color32::from_black_alpha(140)));
    painter.line_segment([from, tip], Stroke::new(2.0, colour));
    let head = vec![tip + 8.0 * along, tip + 5.0 * across - 4.0 * along, tip - 5.0 * across - 4.0 * along];
    painter.add(egui::Shape::convex_polygon(head, colour, Stroke::new(1.0, Color32::from_black_alpha(160))));
    let at = tip + 16.0 * along;
    painter.text(at + vec2(1.0, 1.0), Align2::CENTER_CENTER, letter, FontId::proportional(12.0), Color32::BLACK);
    painter.text(at, Align2::CENTER_CENTER, letter, FontId::proportional(12.0), colour);
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Truth: a ray that meets the line meets it there; one beside it is nearest at the foot of the
    /// perpendicular.
    #[test]
    fn a_ray_takes_hold_where_it_is_nearest() {
        let ray = |origin: Vec3, to: Vec3| Ray { origin, direction: 3.0 * (to - origin) };
        let point = Vec3::new(1.0, 2.0, 0.0);
        let meeting = ray(Vec3::new(0.0, 2.0, 5.0), Vec3::new(4.0, 2.0, 0.0));
        assert!((nearest_along(point, Vec3::X, &meeting).expect("they cross") - 3.0).abs() < 1e-5);
        let above = ray(Vec3::new(4.0, 7.0, 5.0), Vec3::new(4.0, 3.0, 0.0));
        assert!((nearest_along(point, Vec3::X, &above).expect("they pass") - 3.0).abs() < 1e-5);
        assert_eq!(nearest_along(point, Vec3::X, &Ray { origin: Vec3::ZERO, direction: Vec3::X }), None);
    }
}
