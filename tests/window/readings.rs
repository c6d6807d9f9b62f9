//! Reading the light in the window, driven headless by accessible names: false colours, isolux lines, the pointer, probes, a work plane.
//!
//! Truth: the snapshot in view, and pictures that differ, or do not, where they must.

use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT, Queryable};
use selflink::app::{App, words};

use crate::support::{choose, click, coarse, finish, picture, until};

type Window = Harness<'static, App>;

/// The Cornell box, solved coarsely.
fn cornell() -> Window {
    let mut window = crate::support::cornell(coarse());
    finish(&mut window);
    window
}

/// Share of the pixels that differ, the lower left corner with its legend aside.
fn difference(one: &image::RgbaImage, other: &image::RgbaImage) -> f64 {
    assert_eq!(one.dimensions(), other.dimensions());
    let (width, height) = one.dimensions();
    let counts = |x: u32, y: u32| !(x < 340 && y > height - 110);
    let differ =
        |(one, other): &((u32, u32, &image::Rgba<u8>), &image::Rgba<u8>)| counts(one.0, one.1) && one.2 != *other;
    let different = one.enumerate_pixels().zip(other.pixels()).filter(differ).count();
    different as f64 / f64::from(width * height)
}

#[test]
fn false_colours_have_a_legend_and_a_range_that_can_be_locked() {
    let mut window = cornell();
    let lit = picture(&mut window);
    choose(&mut window, words::DISPLAY, words::IRRADIANCE);
    assert!(window.query_by_label("illuminance E, lx").is_some(), "a legend says what is shown");
    let coloured = picture(&mut window);
    assert!(difference(&lit, &coloured) > 0.3);
    let is_red = |pixel: &&image::Rgba<u8>| pixel[0] > 120 && pixel[1] < pixel[0] / 2 && pixel[2] < pixel[0] / 2;
    assert_eq!(coloured.pixels().filter(is_red).count(), 0, "the red wall is coloured by what it receives");

    // Locked, the range is the same light in whichever unit.
    click(&mut window, words::LOCK_RANGE);
    let locked = picture(&mut window);
    assert_eq!(difference(&coloured, &locked), 0.0, "locking keeps what is shown");
    choose(&mut window, words::UNIT, "W/m²");
    assert!(window.query_by_label("irradiance E, W/m²").is_some());
    assert_eq!(difference(&locked, &picture(&mut window)), 0.0);
    choose(&mut window, words::SCALE, "logarithmic");
    assert!(difference(&locked, &picture(&mut window)) > 0.3);

    choose(&mut window, words::DISPLAY, words::LIT);
    assert!(window.query_by_label("irradiance E, W/m²").is_none());
    assert_eq!(difference(&lit, &picture(&mut window)), 0.0, "without readings it is as before");
}

#[test]
fn isolux_lines_lie_where_a_person_asks_for_them() {
    let mut window = cornell();
    let lit = picture(&mut window);
    click(&mut window, words::ISOLUX_LINES);
    let lined = picture(&mut window);
    assert!((0.001..0.2).contains(&difference(&lit, &lined)), "{}", difference(&lit, &lined));
    let field = window.get_by_label(words::LINES_AT);
    field.focus();
    field.type_text("60, 123");
    window.run_steps(3);
    assert!(window.query_by_label("60").is_some() && window.query_by_label("123").is_some(), "the legend has both");
    assert!(difference(&lined, &picture(&mut window)) > 0.001);
    click(&mut window, words::ISOLUX_LINES);
    assert_eq!(difference(&lit, &picture(&mut window)), 0.0);
}

#[test]
fn a_line_tells_what_lies_under_the_pointer() {
    let mut window = cornell();
    assert!(window.query_by_label_contains(" lx, ").is_none());
    let rect = window.state().view_rect();
    window.hover_at(rect.center());
    until(&mut window, "a reading", |window| window.query_by_label_contains(" lx, ").is_some());
    window.hover_at(rect.left_top() - egui::vec2(200.0, 0.0));
    until(&mut window, "its end", |window| window.query_by_label_contains(" lx, ").is_none());
}

#[test]
fn probes_are_placed_by_click_and_read() {
    let mut window = cornell();
    click(&mut window, words::MEASURE);
    click(&mut window, words::PLACE_PROBES);
    let centre = window.state().view_rect().center();
    window.drag_at(centre);
    window.drop_at(centre);
    until(&mut window, "a probe", |window| window.query_by_label("Name of probe 1").is_some());
    assert!(window.query_by_label(words::SELECTED_ELEMENT).is_none(), "a click that places a probe picks nothing");
    // The name and the value beside the mark are painted; the table has both.
    assert_eq!(window.get_by_label("Name of probe 1").accesskit_node().value().as_deref(), Some("P1"));
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("probes.csv");
    click(&mut window, "Probes as CSV…");
    save_as(&mut window, &path);
    let text = std::fs::read_to_string(&path).expect("it was written");
    let rows: Vec<&str> = text.lines().collect();
    assert_eq!(rows[0], "name,x,y,z,nx,ny,nz,E_r,E_g,E_b,B_r,B_g,B_b,E_lx,se_r,se_g,se_b");
    let values: Vec<f64> = rows[1]
        .split(',')
        .skip(1)
        .filter(|value| !value.is_empty())
        .map(|value| value.parse().expect("a number"))
        .collect();
    // Truth: the convention.
    let lux = 179.0 * (0.2126 * values[6] + 0.7152 * values[7] + 0.0722 * values[8]);
    assert!(rows[1].starts_with("\"P1\",") && (values[12] / lux - 1.0).abs() < 1e-4 && lux > 1.0, "{text}");
    click(&mut window, "Remove probe 1");
    until(&mut window, "its end", |window| window.query_by_label("Name of probe 1").is_none());
}

#[test]
fn a_work_plane_is_measured_shown_and_written() {
    let mut window = cornell();
    let before = picture(&mut window);
    click(&mut window, words::MEASURE);
    click(&mut window, words::MEASURE_PLANE);
    until(&mut window, "the plane", |window| window.query_by_label(words::UNIFORMITY).is_some());
    assert!(window.query_by_label("illuminance E, lx").is_some(), "the legend tells its colours");
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("plane.csv");
    click(&mut window, "Work plane as CSV…");
    save_as(&mut window, &path);
    let text = std::fs::read_to_string(&path).expect("it was written");
    assert!(text.starts_with("x,y,z,E_r,E_g,E_b,E_lx,se_r,se_g,se_b\n") && text.lines().count() > 20, "{text}");
    click(&mut window, words::CLEAR);
    until(&mut window, "its end", |window| window.query_by_label(words::UNIFORMITY).is_none());
    window.get_by_label(words::CLOSE_TOOL).click();
    window.run_steps(3);
    // Notes take room from the view.
    while window.query_all_by_label(words::DISMISS).next().is_some() {
        window.get_all_by_label(words::DISMISS).next().expect("just seen").click();
        window.run_steps(2);
    }
    assert_eq!(difference(&before, &picture(&mut window)), 0.0);
}

/// Types a path and writes; without a dialog the field is the way.
fn save_as(window: &mut Window, path: &std::path::Path) {
    // The dialog that is not there says so first.
    until(window, "the answer", |window| window.query_by_label_contains("No file dialog answers").is_some());
    let field = window.get_by_label("CSV file");
    field.focus();
    window.key_press_modifiers(egui::Modifiers::COMMAND, egui::Key::A);
    window.get_by_label("CSV file").type_text(&path.display().to_string());
    window.run_steps(2);
    click(window, "Write");
    until(window, "the note", |window| window.query_by_label_contains("Wrote ").is_some());
}
