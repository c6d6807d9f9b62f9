//! Marks over the view: probes, and the points of a work plane coloured by what they receive.

use egui::{Align2, Color32, FontId, Painter, Pos2, Rect, Sense, Shape, Stroke, Ui, vec2};
use glam::Vec3;

use crate::app::format;
use crate::app::state::measuring::{Measuring, Probe, lux_in_words};
use crate::app::view::eye::Eye;
use crate::app::widgets::theme;
use crate::app::words;
use crate::base::photometry::{ShownIn, lux, weighted};
use crate::read::survey::SurfaceReading;
use crate::render::Reading;

/// Radii of a point of the plane where it is nearest to and farthest from the eye, points; its size
/// in the room in between.
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
/// Colour of a value that is none of the light in view any more.
const STALE: Color32 = Color32::from_gray(165);

/// Draws what was measured over the view: points and probes that the eye sees.
pub fn show(ui: &Ui, view: Rect, eye: &Eye<'_>, measuring: &Measuring, reading: Option<&Reading>) {
    let painter = ui.painter_at(view);
    if measuring.shows_points
        && let Some(scale) = measuring.plane_scale(reading)
    {
        show_plane(&painter, eye, measuring, &scale);
    }
    for (index, (probe, found)) in measuring.probes().enumerate() {
        let Some((at, _)) = eye.project(probe.point).filter(|_| eye.sees(probe.point)) else { continue };
        let (fill, ink) = match measuring.is_stale() {
            false => (theme::ACCENT.gamma_multiply(0.9), Color32::WHITE),
            true => (Color32::TRANSPARENT, STALE),
        };
        painter.circle(
            at,
            PROBE_RADIUS,
            fill,
            Stroke::new(1.5, if measuring.is_stale() { STALE } else { Color32::BLACK }),
        );
        let text = of_probe(probe, found.and_then(|found| found.reading).as_ref(), measuring.is_stale());
        let rect = label(&painter, at + vec2(PROBE_RADIUS + 5.0, 0.0), Align2::LEFT_CENTER, &text, 12.0, ink);
        let response = ui.interact(rect, ui.scope_id().with(("probe", index)), Sense::hover());
        response.widget_info(|| egui::WidgetInfo::labeled(egui::accesskit::Role::Label, true, &text));
    }
}

/// The name of a probe and its reading, where it is known: *P1  312 ± 4 lx*.
fn of_probe(probe: &Probe, reading: Option<&SurfaceReading>, is_stale: bool) -> String {
    let value = reading.map_or_else(String::new, |reading| format!("  {}", lux_in_words(reading)));
    let age = if is_stale { format!(" ({})", words::EARLIER_PICTURE) } else { String::new() };
    format!("{}{value}{age}", probe.name)
}

fn show_plane(painter: &Painter, eye: &Eye<'_>, measuring: &Measuring, scale: &Reading) {
    let Some(plane) = measuring.plane_reading() else { return };
    let (grid, plane_is_stale) = (&plane.grid, measuring.plane_is_stale());
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
        let fill = Color32::from_rgba_unmultiplied(r, g, b, if plane_is_stale { 90 } else { 230 });
        let radius = radius_of(*points_per_length) / points_per_length;
        let corner = |index: usize| {
            let (sine, cosine) = (std::f32::consts::TAU * index as f32 / CORNERS as f32).sin_cos();
            eye.project(*point + radius * (cosine * across + sine * along)).map(|(at, _)| at)
        };
        let disc: Vec<Pos2> = (0..CORNERS).filter_map(corner).collect();
        let edge = Stroke::new(1.0, Color32::from_black_alpha(170));
        painter.add(Shape::convex_polygon(disc, fill, edge));
    }
    if measuring.writes_values {
        let shown = |value: &Vec3| match scale.shown_in {
            ShownIn::Unit(_) => lux(value.to_array()),
            daylight_factor @ ShownIn::DaylightFactor { .. } => daylight_factor.per_watt() * weighted(value.to_array()),
        };
        let ink = if plane_is_stale { STALE } else { Color32::WHITE };
        write_values(
            painter,
            ink,
            seen.iter().rev().map(|(at, scale, _, value)| (*at, radius_of(*scale), shown(value))),
        );
    }
}

/// Writes values beside points, nearer ones first, where nothing is written yet.
fn write_values(painter: &Painter, ink: Color32, points: impl Iterator<Item = (Pos2, f32, f32)>) {
    let mut taken: Vec<Rect> = Vec::new();
    for (at, _, value) in points.take_while(|(_, radius, _)| *radius >= LEAST_LABELLED) {
        let text = format::number(value.into());
        let room = Rect::from_center_size(at, vec2(7.0 * text.len() as f32, 13.0));
        if taken.len() < MOST_VALUES && !taken.iter().any(|other| other.intersects(room)) {
            label(painter, at, Align2::CENTER_CENTER, &text, 11.0, ink);
            taken.push(room);
        }
    }
}

/// Draws the rim of the task area.
pub fn show_area(painter: &Painter, corners: [Option<Pos2>; 4]) {
    show_rim(painter, &corners, Stroke::new(2.0, theme::ACCENT));
}

/// Draws the rim of an area so that it is seen on any picture; a corner may lie behind the eye.
pub fn show_rim(painter: &Painter, corners: &[Option<Pos2>], stroke: Stroke) {
    for (index, corner) in corners.iter().enumerate() {
        if let (Some(from), Some(to)) = (corner, corners[(index + 1) % corners.len()]) {
            painter.line_segment([*from, to], Stroke::new(stroke.width + 1.5, Color32::from_black_alpha(170)));
            painter.line_segment([*from, to], stroke);
        }
    }
}

/// Text that can be read on any picture, and where it lies.
fn label(painter: &Painter, at: Pos2, align: Align2, text: &str, size: f32, ink: Color32) -> Rect {
    let font = FontId::proportional(size);
    for offset in [vec2(-1.0, 0.0), vec2(1.0, 0.0), vec2(0.0, -1.0), vec2(0.0, 1.0)] {
        painter.text(at + offset, align, text, font.clone(), Color32::from_black_alpha(200));
    }
    painter.text(at, align, text, font, ink)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::solve::Leaf;

    /// Truth: the convention, 179 lm/W, by hand.
    #[test]
    fn a_probe_says_its_value_its_error_and_its_age() {
        let probe = Probe { name: "desk".into(), point: Vec3::ZERO, normal: Vec3::Y };
        let leaf = Leaf::square_metre(1, 0);
        let irradiance = Vec3::splat(2.0);
        let mut reading = SurfaceReading {
            point: Vec3::ZERO,
            normal: Vec3::Y,
            leaf,
            irradiance,
            standard_error: Some(0.02 * irradiance),
            radiosity: Vec3::ONE,
        };
        assert_eq!(of_probe(&probe, Some(&reading), false), "desk  358.0 ± 7.2 lx");
        reading.standard_error = None;
        assert_eq!(of_probe(&probe, Some(&reading), true), "desk  358 lx (earlier picture)");
        assert_eq!(of_probe(&probe, None, false), "desk");
    }
}
