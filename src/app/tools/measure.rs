//! The measure tool: probes on surfaces, and a work plane in the air.

use std::path::Path;

use egui::{Button, DragValue, Grid, ProgressBar, RichText, TextEdit, Ui};
use glam::{DVec3, Vec3};

use crate::app::state::measuring::{Measuring, Table, lux_in_words};
use crate::app::state::messages::{Messages, Topic};
use crate::app::widgets::dialog::DialogAnswer;
use crate::app::widgets::{rows, theme};
use crate::app::{Shown, Wake, format, words};
use crate::base::photometry::CONVENTION;
use crate::read::daylight_factor::NoDaylightFactor;
use crate::read::survey::{PlaneReading, Probed, WorkPlane};

/// Lengths that a field offers, in the scene's unit.
const LENGTHS: std::ops::RangeInclusive<f32> = 0.0..=100.0;
/// Advice where there is no dialog.
const NO_DIALOG: &str = "No file dialog answers on this system: type a path into the field CSV file and use Write.";

/// Draws the tool.
pub fn show(ui: &mut Ui, shown: &Shown, measuring: &mut Measuring, messages: &mut Messages, wake: &Wake) {
    rows::heading(ui, "Probes");
    show_probes(ui, shown, measuring);
    ui.separator();
    rows::heading(ui, "Work plane");
    show_plane_setup(ui, shown, measuring, wake);
    if let Some(plane) = measuring.plane_reading().cloned() {
        show_summary(ui, &plane, measuring.plane_is_stale());
        show_target(ui, &plane, measuring);
        ui.checkbox(&mut measuring.shows_points, "Points in the view");
        ui.add_enabled_ui(measuring.shows_points, |ui| ui.checkbox(&mut measuring.writes_values, "Their values in lx"));
    }
    ui.separator();
    show_files(ui, shown, measuring, messages);
    ui.add_space(4.0);
    rows::sentence(ui, theme::weak(CONVENTION).small());
}

fn show_probes(ui: &mut Ui, shown: &Shown, measuring: &mut Measuring) {
    ui.horizontal(|ui| {
        let toggle = ui.add(Button::new(words::PLACE_PROBES).selected(measuring.places_probes));
        if toggle.on_hover_text("While this is on, a click into the view places a probe on the surface there").clicked()
        {
            measuring.places_probes = !measuring.places_probes;
        }
        let has_any = measuring.probes().next().is_some();
        if ui.add_enabled(has_any, Button::new("Remove all probes")).clicked() {
            measuring.remove_all();
        }
    });
    let in_file = |point: Vec3| shown.info.as_ref().map_or(point.as_dvec3(), |info| info.scene.to_file(point));
    let rows: Vec<(String, Option<Probed>)> =
        measuring.probes().map(|(probe, found)| (place(in_file(probe.point)), found.copied())).collect();
    if rows.is_empty() {
        let hint = if measuring.places_probes { "Click a surface in the view." } else { "None yet." };
        ui.label(theme::weak(hint));
        return;
    }
    let (mut removed, is_stale) = (None, measuring.is_stale());
    if is_stale {
        ui.label(theme::weak(format!("Of an {}.", words::EARLIER_PICTURE)));
    }
    Grid::new("probes").num_columns(5).spacing([10.0, 4.0]).striped(true).show(ui, |ui| {
        for title in ["Name", "E ± standard error", "E  W/m²", "B  W/m²", ""] {
            ui.label(theme::weak(title));
        }
        ui.end_row();
        for (index, (place, found)) in rows.iter().enumerate() {
            let name = measuring.name_mut(index);
            let label = format!("Name of probe {}", index + 1);
            let field = TextEdit::singleline(name).desired_width(64.0);
            ui.add(field).on_hover_text(place).accessible_name(label);
            let reading = found.and_then(|found| found.reading);
            let of = |value: Option<f32>| {
                let text = value.map_or("–".into(), |value| format!("{:>7}", format::number(value.into())));
                aged(theme::value(text), is_stale)
            };
            let text = reading.map_or("–".into(), |reading| lux_in_words(&reading));
            ui.label(aged(theme::value(text), is_stale)).on_hover_text(CONVENTION);
            for colours in [reading.map(|reading| reading.irradiance), reading.map(|reading| reading.radiosity)] {
                let by_colour = colours.map(|colours| colours.to_array().map(|value| format::number(value.into())));
                let response =
                    ui.label(of(colours.map(|colours| crate::base::photometry::weighted(colours.to_array()))));
                if let Some([r, g, b]) = by_colour {
                    response
                        .on_hover_text(format!("R {r}, G {g}, B {b} W/m²; shown is their mean as the eye weighs them"));
                }
            }
            let remove = ui.small_button("×").on_hover_text("Take this probe away");
            if remove.accessible_name(format!("Remove probe {}", index + 1)).clicked() {
                removed = Some(index);
            }
            ui.end_row();
        }
    });
    if let Some(index) = removed {
        measuring.remove(index);
    }
}

/// The text of a reading, weak where it is of light that is gone.
fn aged(text: RichText, is_stale: bool) -> RichText {
    if is_stale { text.weak() } else { text }
}

fn place(point: DVec3) -> String {
    let [x, y, z] = point.to_array().map(|value| format!("{value:.3}"));
    format!("at {x}, {y}, {z}")
}

fn show_plane_setup(ui: &mut Ui, shown: &Shown, measuring: &mut Measuring, wake: &Wake) {
    let (before, plane) = (measuring.plane, &mut measuring.plane);
    let fields = [
        (
            words::PLANE_HEIGHT,
            &mut plane.height,
            "Above the floor, the lowest large level surface, in the scene's length unit (metres)",
        ),
        (
            "Spacing",
            &mut plane.spacing,
            "Distance between the points, at first that of EN 12464-1: 0.2·5^log₁₀ d of the extent d; cells fill the plane evenly",
        ),
        ("Margin to walls", &mut plane.margin, "Strip along the rim of the floor that is left out (EN 12464-1: 0.5 m)"),
    ];
    for (label, length, hint) in fields {
        let field = DragValue::new(length).speed(0.01).range(LENGTHS).max_decimals(3).suffix(" m");
        rows::widget(ui, label, field, hint);
    }
    show_area(ui, shown, measuring);
    if measuring.plane != before {
        // A plane that is shown is measured again in the next frame.
        ui.ctx().request_repaint();
    }
    let lit = shown.info.as_ref().zip(shown.in_view.as_ref());
    ui.horizontal(|ui| {
        let button = ui.add_enabled(lit.is_some(), Button::new(words::MEASURE_PLANE));
        let hint =
            "Light that reaches a level area at each point: rays look from it for lamps and for what surfaces send";
        if button.on_hover_text(hint).clicked()
            && let Some((info, snapshot)) = lit
        {
            measuring.measure_plane(&info.scene, snapshot, wake);
        }
        let is_there = measuring.plane_reading().is_some() || measuring.progress().is_some();
        if ui.add_enabled(is_there, Button::new(words::CLEAR)).clicked() {
            measuring.forget_plane();
        }
    });
    if let Some(share) = measuring.progress() {
        let bar = ProgressBar::new(share).desired_width(200.0).desired_height(6.0).fill(theme::ACCENT);
        ui.add(bar).on_hover_text(format!("{:.0} % of the points are measured", 100.0 * share));
    }
    if let Some(failure) = measuring.failure() {
        rows::failure(ui, failure);
    }
}

fn show_summary(ui: &mut Ui, plane: &PlaneReading, is_stale: bool) {
    let summary = plane.summary();
    if summary.points == 0 {
        let sentence = "Every point lies inside of something or outside of the room: choose another height.";
        rows::failure(ui, sentence);
        return;
    }
    let lux = |value: f32| format!("{:>7} lx", format::number(value.into()));
    let mut rows = vec![
        (words::AVERAGE, lux(summary.average), "Mean illuminance of the points"),
        ("Minimum", lux(summary.minimum), "Smallest illuminance"),
        ("Maximum", lux(summary.maximum), "Largest illuminance"),
        (words::UNIFORMITY, format!("{:>7.2}   ", summary.uniformity), "Minimum over average (EN 12464-1)"),
    ];
    if let Some([mean, least]) = summary.daylight_factor {
        let percent = |share: f32| format!("{:>7} % ", format::number((100.0 * share).into()));
        let hint = "Illuminance over that of open ground under the same sky (EN 17037)";
        rows.push(("Daylight factor", percent(mean), hint));
        rows.push(("…at least", percent(least), hint));
    }
    Grid::new("work plane").num_columns(2).spacing([12.0, 3.0]).show(ui, |ui| {
        for (name, value, hint) in rows {
            ui.label(name);
            ui.label(theme::value(value)).on_hover_text(hint);
            ui.end_row();
        }
    });
    if let Err(missing @ (NoDaylightFactor::Sun | NoDaylightFactor::Lamps)) = plane.open_ground {
        let text = format!("There is {missing}.");
        rows::sentence(ui, theme::weak(text));
    }
    let [columns, rows] = plane.grid.counts.map(format::count);
    let [across, along] = plane.grid.steps.map(|step| format::short(step.into()));
    let left_out = match summary.left_out {
        0 => String::new(),
        points => format!("; {} left out, inside of things or outside of the room", format::count(points)),
    };
    let text = format!("{columns} × {rows} points, {across} × {along} m apart{left_out}");
    rows::sentence(ui, theme::weak(text));
    if is_stale {
        rows::sentence(ui, theme::weak(format!("{}.", words::EARLIER_PLANE)));
    }
}

/// The part of the plane that counts: all of it, or a task area.
fn show_area(ui: &mut Ui, shown: &Shown, measuring: &mut Measuring) {
    let Some(info) = &shown.info else { return };
    ui.horizontal(|ui| {
        let draw = ui.add(Button::new(words::DRAW_TASK_AREA).selected(measuring.draws_area));
        let hint = "Then drag a rectangle over the work plane in the view: only that part is measured and judged";
        if draw.on_hover_text(hint).clicked() {
            measuring.draws_area = !measuring.draws_area;
        }
        if ui.add_enabled(measuring.plane.area.is_some(), Button::new(words::WHOLE_PLANE)).clicked() {
            measuring.forget_plane();
            measuring.plane = WorkPlane { height: measuring.plane.height, ..WorkPlane::for_scene(&info.scene) };
        }
    });
    if measuring.draws_area {
        ui.label(theme::weak("Drag a rectangle in the view."));
    }
    let up = info.scene.up_axis();
    let axes = ["x", "y", "z"].into_iter().enumerate().filter(|(axis, _)| up[*axis] == 0.0);
    let Some(corners) = measuring.plane.area else { return };
    let mut filed = corners.map(|corner| info.scene.to_file(corner));
    let before = filed;
    for (axis, letter) in axes {
        ui.horizontal(|ui| {
            rows::row_label(ui, &format!("{}, {letter}", words::TASK_AREA));
            for (corner, name) in ["from", "to"].into_iter().enumerate() {
                let field = DragValue::new(&mut filed[corner][axis]).speed(0.01).max_decimals(3).suffix(" m");
                let _ = ui.add(field).accessible_name(words::task_area(letter, name));
            }
        });
    }
    if filed != before {
        measuring.plane.set_area(filed.map(|corner| info.scene.from_file(corner)), up);
    }
}

/// The average and the uniformity that the plane is to have, and whether it has.
fn show_target(ui: &mut Ui, plane: &PlaneReading, measuring: &mut Measuring) {
    let field = DragValue::new(&mut measuring.target).speed(5.0).range(1.0..=1e5).max_decimals(0).suffix(" lx");
    let hint = "Illuminance that the task asks for, such as 500 lx for writing and reading (EN 12464-1)";
    rows::widget(ui, words::TARGET_AVERAGE, field, hint);
    let field = DragValue::new(&mut measuring.least_uniformity).speed(0.01).range(0.0..=1.0).max_decimals(2);
    let hint = "Minimum over average that the task asks for, such as 0.6 (EN 12464-1)";
    rows::widget(ui, words::TARGET_UNIFORMITY, field, hint);
    let (summary, is_stale) = (plane.summary(), measuring.plane_is_stale());
    if summary.points == 0 {
        return;
    }
    let share = summary.average / measuring.target;
    let verdicts = [
        (words::AVERAGE, share >= 1.0, format!("{:.0} % of the target", 100.0 * share)),
        (
            words::UNIFORMITY,
            summary.uniformity >= measuring.least_uniformity,
            format!("{:.2} of {:.2}", summary.uniformity, measuring.least_uniformity),
        ),
    ];
    for (what, is_met, figures) in verdicts {
        let verdict = if is_met { words::PASSED } else { words::FAILED };
        let text = format!("{verdict}: {what}, {figures}");
        ui.label(if is_met || is_stale { aged(RichText::new(text), is_stale) } else { theme::notice(ui, text) });
    }
}

fn show_files(ui: &mut Ui, shown: &Shown, measuring: &mut Measuring, messages: &mut Messages) {
    let tables = [
        (Table::Probes, "Probes as CSV…", "probes.csv", measuring.probes().next().is_some()),
        (Table::Plane, "Work plane as CSV…", "work-plane.csv", measuring.plane_reading().is_some()),
    ];
    ui.horizontal_wrapped(|ui| {
        for (table, label, name, is_there) in tables {
            let button = ui.add_enabled(is_there && !measuring.save.dialog.is_open(), Button::new(label));
            if button.on_hover_text("Choose where this table is written").clicked() {
                measuring.saves = table;
                measuring.save.text = name.to_owned();
                let dialog = rfd::FileDialog::new().set_title("Write a table").set_file_name(name);
                measuring.save.dialog.open(ui.ctx(), || dialog.save_file());
            }
        }
    });
    let is_there = tables.iter().any(|(table, .., is_there)| *is_there && *table == measuring.saves);
    let mut is_clicked = false;
    rows::row(ui, "CSV file", |ui| {
        let field = TextEdit::singleline(&mut measuring.save.text)
            .hint_text("path.csv")
            .desired_width((ui.available_width() - 72.0).max(60.0));
        let field = ui.add(field);
        let can_write = is_there && measuring.save.typed().is_some();
        is_clicked = ui.add_enabled(can_write, Button::new("Write")).clicked();
        field.on_hover_text("Path for systems without a file dialog; Write stores the table that was chosen last")
    });
    if let Some(path) = measuring.save.typed().filter(|_| is_clicked) {
        write(shown, measuring, &path, messages);
    }
    match measuring.save.dialog.poll() {
        Some(DialogAnswer::Chosen(path)) => write(shown, measuring, &path, messages),
        Some(DialogAnswer::NoDialog) => messages.note(Topic::Writing, NO_DIALOG.into()),
        None => {}
    }
}

fn write(shown: &Shown, measuring: &Measuring, path: &Path, messages: &mut Messages) {
    let Some(info) = &shown.info else { return };
    let written = measuring.csv(measuring.saves, &info.scene).and_then(|text| std::fs::write(path, text));
    match written {
        Ok(()) => messages.note(Topic::Writing, format!("Wrote {}.", path.display())),
        Err(error) => {
            let failure = format!("{}: cannot be written ({error}); choose another place", path.display());
            messages.error(Topic::Writing, failure);
        }
    }
}
