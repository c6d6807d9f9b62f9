//! Where the sun stands: dragged on a plan of the sky, or by date and place.

use egui::{Color32, ComboBox, DragValue, Pos2, Rect, Sense, Slider, Stroke, Ui, Vec2};

use crate::app::widgets::{rows, theme};
use crate::app::{format, words};
use crate::scene::outside::{Moment, SunPlace, SunSpec};

/// Side of the plan, points.
const SIDE: f32 = 132.0;
/// Width of a number of the date, points.
const DATE_WIDTH: f32 = 44.0;

/// Draws the choice, the plan of the sky and the fields.
pub fn show(ui: &mut Ui, sun: &mut SunSpec) {
    show_plan(ui, sun);
    let is_by_date = matches!(sun.place, SunPlace::Almanac { .. });
    let names = ["direction", words::SUN_BY_DATE];
    rows::row(ui, words::SUN_PLACE, |ui| {
        let list = ComboBox::from_id_salt(words::SUN_PLACE).selected_text(names[usize::from(is_by_date)]);
        let choices = |ui: &mut Ui| {
            if ui.selectable_label(!is_by_date, names[0]).clicked() && is_by_date {
                let [azimuth, elevation] = sun.angles().map(|angle| (10.0 * angle).round() as f32 / 10.0);
                sun.place = SunPlace::Direction { azimuth, elevation };
            }
            if ui.selectable_label(is_by_date, names[1]).clicked() && !is_by_date {
                sun.place = usual();
            }
        };
        list.show_ui(ui, choices).response
    })
    .on_hover_text("By its direction in the scene, or by the calendar, the clock and a place on earth");
    if let SunPlace::Almanac { moment, latitude, longitude, north } = &mut sun.place {
        show_moment(ui, moment);
        let angles = [
            ("Latitude", latitude, -90.0..=90.0, "North of the equator; south counts below 0"),
            ("Longitude", longitude, -180.0..=180.0, "East of Greenwich; west counts below 0"),
            (
                "North turned by",
                north,
                -180.0..=180.0,
                "Where the scene's north points to: degrees from true north towards east",
            ),
        ];
        for (label, angle, range, hint) in angles {
            let field = DragValue::new(angle).speed(0.1).range(range).max_decimals(3).suffix("°");
            rows::widget(ui, label, field, hint);
        }
    }
    if sun.angles()[1] <= 0.0 {
        ui.label(theme::notice(ui, words::SUN_IS_DOWN));
    }
}

/// Noon of a midsummer's day in Munich.
fn usual() -> SunPlace {
    let moment = Moment { date: [2026, 6, 21], hours: 12.0, zone: 2.0 };
    SunPlace::Almanac { moment, latitude: 48.1, longitude: 11.6, north: 0.0 }
}

fn show_moment(ui: &mut Ui, moment: &mut Moment) {
    let days = Moment::days_of(moment.date[0], moment.date[1]);
    ui.horizontal(|ui| {
        rows::row_label(ui, "Date");
        let parts = [("Year", 1..=9999), ("Month", 1..=12), ("Day", 1..=days)];
        for (number, (name, range)) in moment.date.iter_mut().zip(parts) {
            let field = DragValue::new(number).speed(0.05).range(range);
            let _ = ui.add_sized([DATE_WIDTH, 20.0], field).accessible_name(name).on_hover_text(name);
        }
    });
    // Another month may be shorter.
    moment.date[2] = moment.date[2].min(Moment::days_of(moment.date[0], moment.date[1]));
    let slider = Slider::new(&mut moment.hours, 0.0..=LAST_MINUTE).step_by(1.0 / 60.0);
    let slider = slider.custom_formatter(|hours, _| clock(hours)).custom_parser(read_clock);
    rows::widget(ui, words::TIME, slider, "By the clock of the zone below");
    let field = DragValue::new(&mut moment.zone).speed(0.05).range(-14.0..=14.0).max_decimals(2);
    let field = field.custom_formatter(|hours, _| zone(hours));
    let field = field.custom_parser(|text| read_clock(text.trim_start_matches("UTC")));
    rows::widget(ui, "Time zone", field, "Hours by which the clock is ahead of UTC, summer time included");
}

/// The last minute of a day, hours.
const LAST_MINUTE: f64 = 24.0 - 1.0 / 60.0;

fn clock(hours: f64) -> String {
    let minutes = (60.0 * hours).round() as i64;
    format!("{}:{:02}", minutes / 60, minutes % 60)
}

/// A zone by its name: UTC+2:00.
fn zone(hours: f64) -> String {
    format!("UTC{}{}", if hours < 0.0 { '−' } else { '+' }, clock(hours.abs()))
}

fn read_clock(text: &str) -> Option<f64> {
    let text = text.trim();
    let below = text.strip_prefix(['-', '−']);
    let text = below.unwrap_or(text).trim_start_matches('+');
    let (hours, minutes) = text.split_once(':').unwrap_or((text, "0"));
    let (hours, minutes): (f64, f64) = (hours.parse().ok()?, minutes.parse().ok()?);
    let value = hours + minutes / 60.0;
    Some(if below.is_some() { -value } else { value })
}

/// The dome of the sky, on which the sun is dragged. As seen from below it would be mirrored; it is
/// drawn as a plan: north up, east to the right, the zenith in its middle.
fn show_plan(ui: &mut Ui, sun: &mut SunSpec) {
    let [azimuth, elevation] = sun.angles().map(|angle| angle as f32);
    ui.horizontal(|ui| {
        let (rect, response) = ui.allocate_exact_size(Vec2::splat(SIDE), Sense::click_and_drag());
        let (centre, radius) = (rect.center(), 0.5 * SIDE - 12.0);
        draw_plan(ui, rect, radius, place(centre, radius, azimuth, elevation));
        if let Some(pointer) = response.interact_pointer_pos() {
            let away = (pointer - centre) / radius;
            let azimuth = away.x.atan2(-away.y).to_degrees().rem_euclid(360.0).round();
            let elevation = (90.0 * (1.0 - away.length())).clamp(1.0, 90.0).round();
            sun.place = SunPlace::Direction { azimuth, elevation };
        }
        let name = || egui::WidgetInfo::labeled(egui::accesskit::Role::Canvas, true, words::SKY_PLAN);
        response.widget_info(name);
        response.on_hover_text("Plan of the sky: drag the sun; north is −z of the scene, or y where z points up");
        ui.vertical(|ui| {
            ui.label(theme::value(format!("{}° from north", format::number(f64::from(azimuth.round())))));
            ui.label(theme::value(format!("{}° high", format::number(f64::from(elevation.round())))));
        });
    });
}

/// Where the sun is drawn.
fn place(centre: Pos2, radius: f32, azimuth: f32, elevation: f32) -> Pos2 {
    let (sine, cosine) = azimuth.to_radians().sin_cos();
    centre + radius * (1.0 - elevation.clamp(0.0, 90.0) / 90.0) * Vec2::new(sine, -cosine)
}

fn draw_plan(ui: &Ui, rect: Rect, radius: f32, sun: Pos2) {
    let (painter, line) = (ui.painter(), Stroke::new(1.0, ui.visuals().weak_text_color()));
    let centre = rect.center();
    painter.circle(centre, radius, ui.visuals().extreme_bg_color, line);
    for share in [1.0 / 3.0, 2.0 / 3.0] {
        painter.circle_stroke(centre, share * radius, Stroke::new(0.5, ui.visuals().weak_text_color()));
    }
    let font = egui::TextStyle::Small.resolve(ui.style());
    for (letter, side) in [("N", Vec2::UP), ("E", Vec2::RIGHT), ("S", Vec2::DOWN), ("W", Vec2::LEFT)] {
        let colour = ui.visuals().weak_text_color();
        painter.text(centre + (radius + 7.0) * side, egui::Align2::CENTER_CENTER, letter, font.clone(), colour);
    }
    painter.circle(sun, 6.0, Color32::from_rgb(255, 200, 60), Stroke::new(1.0, Color32::from_rgb(120, 80, 0)));
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Truth: the plan's convention: the zenith in the middle, north up, east to the right, the
    /// horizon at the rim.
    #[test]
    fn the_sun_is_drawn_where_it_stands() {
        let at = |azimuth, elevation| place(Pos2::ZERO, 90.0, azimuth, elevation);
        assert!(at(10.0, 90.0).distance(Pos2::ZERO) < 1e-4);
        assert!(at(0.0, 0.0).distance(Pos2::new(0.0, -90.0)) < 1e-3);
        assert!(at(90.0, 45.0).distance(Pos2::new(45.0, 0.0)) < 1e-3);
    }

    /// Truth: a clock read back.
    #[test]
    fn times_are_read_as_they_are_shown() {
        assert_eq!((clock(9.0 + 5.0 / 60.0), read_clock("9:05")), ("9:05".to_owned(), Some(9.0 + 5.0 / 60.0)));
        assert_eq!((read_clock("7"), read_clock("noon")), (Some(7.0), None));
        assert_eq!((zone(-3.5), read_clock("−3:30"), zone(2.0)), ("UTC−3:30".into(), Some(-3.5), "UTC+2:00".into()));
    }
}
