//! The gallery: each feature of the window once, as pictures in `screenshots/`.
//!
//! `./dev shots` runs these. They are driven by accessible names like the tests beside them, so
//! that a moved button moves in the pictures as well, and a feature that cannot be reached any
//! longer makes no picture.

use std::path::Path;

use egui::accesskit::Role;
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use selflink::app::{App, words};
use selflink::scene::Source;
use selflink::scene::builtin::BuiltinScene;
use selflink::solve::{Epsilon, ParameterId, SolverParams};

use crate::support::{choose, click, finish, link_choice, until, window_of_size};

const SIZE: [f32; 2] = [1600.0, 1000.0];

fn by_threshold(epsilon: f64) -> SolverParams {
    SolverParams { epsilon: Epsilon::Relative(epsilon), ..SolverParams::default() }
}

/// A window with one of our own scenes, solved to the end.
fn solved(scene: BuiltinScene, params: SolverParams) -> Harness<'static, App> {
    let mut window = window_of_size(SIZE, Some(Source::Builtin(scene)), params);
    until(&mut window, "the first picture", |window| window.state().snapshot().is_some());
    finish(&mut window);
    window
}

/// Clicks into the view, at shares of its width and height.
fn click_view(window: &mut Harness<'static, App>, x: f32, y: f32) {
    let rect = window.state().view_rect();
    let at = rect.min + egui::vec2(x * rect.width(), y * rect.height());
    window.drag_at(at);
    window.drop_at(at);
    window.run_steps(4);
}

/// Waits until what is in view carries elements and links.
fn solution_view(window: &mut Harness<'static, App>) {
    until(window, "its links", |window| window.state().snapshot().is_some_and(|shown| shown.solution_view.is_some()));
    window.run_steps(4);
}

/// Waits until a gathered picture has settled; a large one takes minutes in software.
fn settle(window: &mut Harness<'static, App>) {
    window.remove_cursor();
    while window.state().is_gathered() != (true, true) {
        window.step();
        std::thread::sleep(std::time::Duration::from_millis(20));
    }
}

fn save(window: &mut Harness<'static, App>, name: &str) {
    window.remove_cursor();
    window.run_steps(4);
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("screenshots").join(name).with_extension("png");
    window.render().expect("a frame can be drawn").save(&path).expect("the folder can be written");
}

#[test]
#[ignore = "writes screenshots/, see ./dev shots"]
fn office() {
    let mut window = solved(BuiltinScene::Office, SolverParams::usual());
    settle(&mut window);
    save(&mut window, "window");
    // A step of the first waves, by the timeline, with the links that there were.
    click(&mut window, words::LINK_MATRIX);
    until(&mut window, "its numbers", |window| window.query_by_label_contains("% empty").is_some());
    let track = window.get_by_label(words::STEP_OF_THE_SOLVE).rect();
    let at = track.left_center() + egui::vec2(0.2 * track.width(), 0.0);
    window.drag_at(at);
    window.drop_at(at);
    until(&mut window, "the step", |window| window.state().snapshot().is_some_and(|shown| shown.former_step.is_some()));
    solution_view(&mut window);
    // The raster comes from a thread of its own.
    std::thread::sleep(std::time::Duration::from_millis(500));
    save(&mut window, "window-timeline");
}

#[test]
#[ignore = "writes screenshots/, see ./dev shots"]
fn readings() {
    let mut window = solved(BuiltinScene::Office, SolverParams::usual());
    choose(&mut window, words::DISPLAY, words::ILLUMINANCE);
    click(&mut window, words::ISOLUX_LINES);
    settle(&mut window);
    save(&mut window, "window-illuminance");
    click(&mut window, words::ISOLUX_LINES);
    choose(&mut window, words::DISPLAY, words::LIT);
    click(&mut window, words::MEASURE);
    click(&mut window, words::PLACE_PROBES);
    click_view(&mut window, 0.35, 0.75);
    click_view(&mut window, 0.75, 0.55);
    click(&mut window, words::MEASURE_PLANE);
    until(&mut window, "the plane", |window| window.query_by_label(words::UNIFORMITY).is_some());
    settle(&mut window);
    save(&mut window, "window-measure");
}

#[test]
#[ignore = "writes screenshots/, see ./dev shots"]
fn inspector() {
    let mut window = solved(BuiltinScene::Office, by_threshold(1e-3));
    click(&mut window, words::INSPECTOR);
    window.run_steps(4);
    click_view(&mut window, 0.5, 0.8);
    solution_view(&mut window);
    save(&mut window, "window-inspector");
    click(&mut window, &link_choice(words::LINKS_AT_LEVEL));
    click(&mut window, words::CLOSE_TOOL);
    click(&mut window, "Link colour: visibility");
    click(&mut window, words::OUTLINES_OF_ENDS);
    window.get_by_role_and_label(Role::Slider, words::STRONGEST_LINKS).set_value_accesskit(60.0);
    window.key_press(egui::Key::Escape);
    window.run_steps(2);
    solution_view(&mut window);
    save(&mut window, "window-level-links");
}

#[test]
#[ignore = "writes screenshots/, see ./dev shots"]
fn link_matrix() {
    let mut window = solved(BuiltinScene::Office, by_threshold(1e-3));
    click(&mut window, words::LINK_MATRIX);
    solution_view(&mut window);
    until(&mut window, "its numbers", |window| window.query_by_label_contains("% empty").is_some());
    let square = window.get_by_label("Matrix of links").rect();
    window.hover_at(square.min + egui::vec2(0.2, 0.74) * square.size());
    until(&mut window, "a link", |window| window.query_by_label(words::FORM_FACTOR).is_some());
    // Not saved by `save`, which takes the mouse away.
    window.run_steps(4);
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("screenshots/window-matrix.png");
    window.render().expect("a frame can be drawn").save(&path).expect("the folder can be written");
}

#[test]
#[ignore = "writes screenshots/, see ./dev shots"]
fn clusters() {
    let mut window = solved(BuiltinScene::Office, by_threshold(1e-3));
    click(&mut window, words::CLUSTERS);
    solution_view(&mut window);
    click(&mut window, words::COLOUR_BY_CLUSTER);
    window.get_by_role_and_label(Role::Slider, words::LEVEL).set_value_accesskit(5.0);
    window.get_by_role_and_label(Role::Slider, words::EXPLODE).set_value_accesskit(35.0);
    save(&mut window, "window-clusters");
}

#[test]
#[ignore = "writes screenshots/, see ./dev shots"]
fn compare() {
    let mut window = solved(BuiltinScene::Office, by_threshold(1e-2));
    click(&mut window, words::COMPARE);
    click(&mut window, words::KEEP_AS_A);
    window.get_by_role_and_label(Role::Slider, words::parameter(ParameterId::Epsilon)).set_value_accesskit(5e-4);
    until(&mut window, "the finer threshold", |window| {
        window.state().status().params.epsilon == Epsilon::Relative(5e-4)
    });
    finish(&mut window);
    save(&mut window, "window-compare");
}

#[test]
#[ignore = "writes screenshots/, see ./dev shots"]
fn accuracy() {
    let mut window = solved(BuiltinScene::Cornell, by_threshold(1e-2));
    click(&mut window, words::ACCURACY);
    click(&mut window, words::COMPARE_WITH_REFERENCE);
    until(&mut window, "an error", |window| window.query_by_label("Error (RMS)").is_some());
    let curves = |window: &Harness<'static, App>| window.query_all_by_label_contains("Φ, adaptive, immediate").count();
    for (count, epsilon) in [(2, 2e-3), (3, 3e-4)] {
        window.get_by_role_and_label(Role::Slider, words::parameter(ParameterId::Epsilon)).set_value_accesskit(epsilon);
        until(&mut window, "one more curve", |window| curves(window) == count);
        finish(&mut window);
    }
    click(&mut window, "error");
    save(&mut window, "window-error");
}

#[test]
#[ignore = "writes screenshots/, see ./dev shots"]
fn lamps_and_materials() {
    let mut window = solved(BuiltinScene::Seminar { polygons: BuiltinScene::SEMINAR_POLYGONS }, by_threshold(1e-3));
    click(&mut window, words::APPEARANCE);
    click(&mut window, words::LIGHT_THEME);
    click(&mut window, words::LIGHT);
    save(&mut window, "window-light");
}
