//! Marks over the view: probes, and the points of a work plane coloured by what they receive.

use egui::{Align2, Color32, FontId, Painter, Pos2, Rect, Shape, Stroke, pos2, vec2};
use glam::{Mat4, Vec3};

use crate::app::format;
use crate::app::state::measuring::Measuring;
use crate::app::widgets::theme;
use crate::base::photometry::{ShownIn, lux, weighted};
use crate::geometry::Occluders;
use crate::render::{Camera, Reading};

/// Radii of a point of the plane where it is nearest to and farthest from the eye, points; its size in the room in between.
const RADII: (f32, f32) = (2.0, 15.0);
/// Share of a cell that a point's disc fills, from its middle.
const CELL_SHARE: f32 = 0.22;
/// Corners of a disc.
const CORNERS: usize = 24;
/// Points of at least this radius have room for their value.
const LEAST_LABELLED: f32 = 5.0;
/// More values than this are not written: nobody could read them.
const MOST_VALUES: usize = 400;
const PROBE_RADIUS: f32 = 5.0;
/// Surfaces nearer than this share of the distance hide a point.
const NEARLY: f32 = 0.995;

/// Draws what was measured over the view.
pub(in crate::app) fn show(
    painter: &Painter,
    view: Rect,
    camera: &Camera,
    measuring: &Measuring,
    reading: Option<&Reading>,
    occluders: &Occluders,
) {
    let eye = Eye::new(view, camera, occluders);
    if measuring.shows_points
        && let Some(scale) = measuring.plane_scale(reading)
    {
        show_plane(painter, &eye, measuring, &scale);
    }
    for (probe, found) in measuring.probes() {
        let Some((at, _)) = eye.project(probe.point) else { continue };
        painter.circle(at, PROBE_RADIUS, theme::ACCENT.gamma_multiply(0.9), Stroke::new(1.5, Color32::BLACK));
        let reading = found.and_then(|found| found.reading);
        let value =
            reading.map(|reading| format!("  {} lx", format::number(lux(reading.irradiance.to_array()).into())));
        let text = format!("{}{}", probe.name, value.unwrap_or_default());
        label(painter, at + vec2(PROBE_RADIUS + 5.0, 0.0), Align2::LEFT_CENTER, &text, 12.0);
    }
}

fn show_plane(painter: &Painter, eye: &Eye<'_>, measuring: &Measuring, scale: &Reading) {
    let Some(plane) = measuring.plane_reading() else { return };
    let grid = &plane.grid;
    let (across, along) = grid.up.any_orthonormal_pair();
    let mut seen: Vec<(Pos2, f32, Vec3, Vec3)> = Vec::new();
    for (point, value) in grid.points.iter().zip(&plane.values) {
        if let (Some(value), Some((at, points_per_length))) = (value, eye.project(*point))
            && eye.sees(*point)
        {
            seen.push((at, points_per_length, *point, *value));
        }
    }
    // Nearer ones over farther ones.
    seen.sort_by(|a, b| a.1.total_cmp(&b.1));
    let radius_of = |points_per_length: f32| {
        (CELL_SHARE * grid.steps[0].min(grid.steps[1]) * points_per_length).clamp(RADII.0, RADII.1)
    };
    for (_, points_per_length, point, value) in &seen {
        let [r, g, b] = scale.scale.colour(weighted(value.to_array()));
        let radius = radius_of(*points_per_length) / points_per_length;
        let corner = |index: usize| {
            let (sine, cosine) = (std::f32::consts::TAU * index as f32 / CORNERS as f32).sin_cos();
            eye.project(*point + radius * (cosine * across + sine * along)).map(|(at, _)| at)
        };
        let disc: Vec<Pos2> = (0..CORNERS).filter_map(corner).collect();
        let edge = Stroke::new(1.0, Color32::from_black_alpha(170));
        painter.add(Shape::convex_polygon(disc, Color32::from_rgba_unmultiplied(r, g, b, 230), edge));
    }
    if measuring.writes_values {
        let shown = |value: &Vec3| match scale.shown_in {
            ShownIn::Unit(_) => lux(value.to_array()),
            daylight_factor @ ShownIn::DaylightFactor { .. } => daylight_factor.per_watt() * weighted(value.to_array()),
        };
        write_values(painter, seen.iter().rev().map(|(at, scale, _, value)| (*at, radius_of(*scale), shown(value))));
    }
}

/// Writes values beside points, nearer ones first, where nothing is written yet.
fn write_values(painter: &Painter, points: impl Iterator<Item = (Pos2, f32, f32)>) {
    let mut taken: Vec<Rect> = Vec::new();
    for (at, _, value) in points.take_while(|(_, radius, _)| *radius >= LEAST_LABELLED) {
        let text = format::number(value.into());
        let room = Rect::from_center_size(at, vec2(7.0 * text.len() as f32, 13.0));
        if taken.len() < MOST_VALUES && !taken.iter().any(|other| other.intersects(room)) {
            label(painter, at, Align2::CENTER_CENTER, &text, 11.0);
            taken.push(room);
        }
    }
}

/// Draws the rim of the task area.
pub(in crate::app) fn show_area(painter: &Painter, corners: [Option<Pos2>; 4]) {
    for (index, corner) in corners.iter().enumerate() {
        if let (Some(from), Some(to)) = (corner, corners[(index + 1) % corners.len()]) {
            painter.line_segment([*from, to], Stroke::new(3.5, Color32::from_black_alpha(170)));
            painter.line_segment([*from, to], Stroke::new(2.0, theme::ACCENT));
        }
    }
}

/// Text that can be read on any picture.
fn label(painter: &Painter, at: Pos2, align: Align2, text: &str, size: f32) {
    let font = FontId::proportional(size);
    for offset in [vec2(-1.0, 0.0), vec2(1.0, 0.0), vec2(0.0, -1.0), vec2(0.0, 1.0)] {
        painter.text(at + offset, align, text, font.clone(), Color32::from_black_alpha(200));
    }
    painter.text(at, align, text, font, Color32::WHITE);
}

/// Where points of the room lie in the view.
struct Eye<'a> {
    place: Vec3,
    occluders: &'a Occluders,
    clip_from_world: Mat4,
    near: f32,
    view: Rect,
    /// Points of the view for a length of 1 at a distance of 1.
    focal: f32,
}

impl<'a> Eye<'a> {
    fn new(view: Rect, camera: &Camera, occluders: &'a Occluders) -> Self {
        let aspect = view.width() / view.height().max(1.0);
        let focal = 0.5 * view.height() / (0.5 * camera.vfov()).tan();
        let place = camera.eye();
        Self { place, occluders, clip_from_world: camera.clip_from_world(aspect), near: camera.near(), view, focal }
    }

    /// Whether nothing that is drawn stands before a point.
    fn sees(&self, point: Vec3) -> bool {
        let away = point - self.place;
        let Some(direction) = away.try_normalize() else { return true };
        let first = self.occluders.first_front(self.place, direction);
        first.is_none_or(|hit| hit.distance > NEARLY * away.length())
    }

    /// Where a point lies, and how many points of the view a length of 1 takes there; `None` outside.
    fn project(&self, point: Vec3) -> Option<(Pos2, f32)> {
        let clip = self.clip_from_world * point.extend(1.0);
        if clip.w <= self.near {
            return None;
        }
        let share = vec2(0.5 + 0.5 * clip.x / clip.w, 0.5 - 0.5 * clip.y / clip.w);
        let at = pos2(self.view.left() + share.x * self.view.width(), self.view.top() + share.y * self.view.height());
        self.view.expand(RADII.1).contains(at).then_some((at, self.focal / clip.w))
    }
}
