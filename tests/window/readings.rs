//! Reading the light in the window, driven headless by accessible names: false colours, isolux
//! lines, the pointer, probes, a work plane.
//!
//! Truth: the snapshot in view, and pictures that differ, or do not, where they must.

use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT, Queryable};
use selflink::app::{App, words};
use selflink::solve::{ParameterId, SolverParams};
use selflink::worker::RunState;

use crate::support::{choose, click, coarse, finish, keep, picture, until};

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
    choose(&mut window, words::DISPLAY, words::ILLUMINANCE);
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

/// A place in the view that shows a face of the short block which faces the eye.
fn on_the_block(window: &mut Window) -> egui::Pos2 {
    let (view, pose) = (window.state().view_rect(), window.state().camera_pose().expect("a view"));
    let scene = window.state().scene_info().expect("a scene").scene.clone();
    for step in 0..30 {
        let at = view.min + egui::vec2(0.2 + 0.02 * step as f32, 0.72) * view.size();
        window.drag_at(at);
        window.drop_at(at);
        window.run_steps(2);
        let Some(element) = window.state().picked_element() else { continue };
        let leaves = &window.state().snapshot().expect("a picture").mesh.leaves;
        let leaf = leaves.iter().find(|leaf| leaf.element == element).expect("a leaf was clicked");
        let polygon = &scene.polygons[leaf.polygon as usize];
        let faces = scene.normal(polygon).dot((pose.eye - pose.target).normalize()) > 0.5;
        if faces && scene.group_path(polygon.group) == "short_block" {
            return at;
        }
    }
    panic!("the block is not in view");
}

/// Truth: the block that a probe on its front lies behind, seen from the back; and the standard
/// error of the gather.
#[test]
fn probes_say_their_error_where_they_are_seen_and_their_age_when_light_has_changed() {
    let mut window = crate::support::cornell(SolverParams { error: Some(0.1), ..SolverParams::usual() });
    finish(&mut window);
    click(&mut window, words::MEASURE);
    let at = on_the_block(&mut window);
    let tag =
        |window: &Window| window.state().overlays().iter().find(|(name, _)| *name == "tag").map(|(_, rect)| *rect);
    until(&mut window, "the tag", |window| tag(window).is_some_and(|rect| rect.min.distance(at) < 40.0));
    click(&mut window, words::PLACE_PROBES);
    let view = window.state().view_rect();
    window.drag_at(at);
    window.drop_at(at);
    let label = |window: &Window| {
        let node = window.query_all_by_label_contains("P1").find(|node| view.contains(node.rect().center()));
        node.and_then(|node| node.accesskit_node().label().or_else(|| node.accesskit_node().value()))
    };
    let is_measured = |text: String| text.contains(" ± ") && text.ends_with(" lx");
    until(&mut window, "its value", |window| label(window).is_some_and(is_measured));
    let said = label(&window).expect("a label");
    let in_table = said.trim_start_matches("P1").trim();
    assert!(window.query_by_label(in_table).is_some(), "{in_table} stands in the table too");

    // Seen from the other side, the block stands before it.
    for _ in 0..2 {
        let (from, by) = (view.center(), egui::vec2(0.5 * view.height(), 0.0));
        window.drag_at(from);
        window.step();
        window.hover_at(from + by);
        window.step();
        window.drop_at(from + by);
        window.run_steps(2);
    }
    window.run_steps(4);
    assert_eq!(label(&window), None, "numbers never show through furniture");
    let aside = tag(&window).expect("the selection still has its tag");
    assert!(aside.right() > view.right() - 20.0 && aside.top() < view.top() + 80.0, "in the corner: {aside:?}");
    let middle = view.center();
    window.hover_at(middle);
    window.step();
    window.key_press(egui::Key::Home);
    window.run_steps(3);
    // It settles while one looks, so that its digits may be better by now.
    assert!(label(&window).is_some_and(is_measured), "the number is back: {:?}", label(&window));

    // Readings are of the picture in view, which stays until a better one is there, and say so.
    error_of(&mut window, 0.02);
    let is_aged = |text: String| text.contains(words::EARLIER_PICTURE);
    until(&mut window, "its age", |window| label(window).is_some_and(is_aged));
    keep(&mut window, "stale-probe");
    finish(&mut window);
    until(&mut window, "the new value", |window| label(window).is_some_and(|text| text.ends_with(" lx")));
}

fn error_of(window: &mut Window, error: f64) {
    let label = words::parameter(ParameterId::Error);
    window.get_by_role_and_label(egui::accesskit::Role::Slider, label).set_value_accesskit(error);
    window.run_steps(2);
}

/// Truth: the age of the light that was read.
#[test]
fn the_plane_the_tag_and_the_readout_say_when_they_are_of_an_earlier_picture() {
    let mut window = crate::support::cornell(SolverParams { error: Some(0.1), ..SolverParams::usual() });
    finish(&mut window);
    let centre = window.state().view_rect().center();
    window.drag_at(centre);
    window.drop_at(centre);
    click(&mut window, words::MEASURE);
    click(&mut window, words::MEASURE_PLANE);
    until(&mut window, "the plane", |window| window.query_by_label(words::UNIFORMITY).is_some());
    let counts = |window: &Window| window.query_all_by_label_contains(words::EARLIER_PICTURE).count();
    until(&mut window, "fresh readings", |window| counts(window) == 0);
    error_of(&mut window, 0.02);
    let centre = window.state().view_rect().center();
    until(&mut window, "another solve", |window| window.state().status().run == RunState::Running);
    window.hover_at(centre + egui::vec2(0.0, 60.0));
    until(&mut window, "the tag", |window| {
        window.query_all_by_label_contains("E ").any(|node| {
            let node = node.accesskit_node();
            let text = node.label().or_else(|| node.value()).unwrap_or_default();
            text.starts_with("E ") && text.ends_with(&format!("({})", words::EARLIER_PICTURE))
        })
    });
    until(&mut window, "the plane's note", |window| window.query_by_label(words::EARLIER_PLANE).is_some());
    until(&mut window, "the readout", |window| {
        window.query_by_label_contains(&format!("{}:  E", words::EARLIER_PICTURE)).is_some()
    });
    keep(&mut window, "stale-plane");
    finish(&mut window);
    until(&mut window, "fresh readings again", |window| {
        counts(window) == 0 && window.query_by_label(words::EARLIER_PLANE).is_none()
    });
}

/// Truth: a level plane under the lamp of a closed box gets more light the nearer it is; until it
/// is measured there, its figures are marked as of before.
#[test]
fn another_height_of_the_work_plane_is_measured_again() {
    let mut window = cornell();
    click(&mut window, words::MEASURE);
    click(&mut window, words::MEASURE_PLANE);
    let summary = |window: &Window| {
        let texts = window.query_all_by_label_contains(" lx").filter_map(|node| node.accesskit_node().value());
        texts.filter(|text| text.ends_with(" lx") && text.starts_with(' ')).collect::<Vec<_>>()
    };
    until(&mut window, "the plane", |window| summary(window).len() == 3);
    let before = summary(&window);
    let height = window.get_by_role_and_label(egui::accesskit::Role::SpinButton, words::PLANE_HEIGHT);
    height.set_value_accesskit(0.5 * 0.75);
    window.step();
    assert!(window.query_by_label_contains(words::EARLIER_PLANE).is_some(), "the figures are of another height");
    until(&mut window, "the new height's figures", |window| {
        window.query_all_by_label_contains(words::EARLIER_PLANE).next().is_none()
    });
    assert_ne!(summary(&window), before);
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
