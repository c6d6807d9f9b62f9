//! The gathered picture of the view: it comes when the camera stands still, goes when anything
//! moves, and can be switched off.
//!
//! Truth: what the window says that it shows, and pictures that differ, or do not, where they must.

use egui::Key;
use egui::accesskit::Role;
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT, Queryable};
use selflink::app::{App, words};
use selflink::scene::Source;
use selflink::scene::builtin::BuiltinScene;
use selflink::solve::{Phase, SolverParams};

use crate::support::{choose, click, cornell, finish, picture, share_of_different_pixels, until, window_of_size};

#[test]
fn a_picture_is_gathered_while_the_camera_stands_still() {
    let mut window = cornell(SolverParams { error: Some(0.1), ..SolverParams::default() });
    finish(&mut window);
    until(&mut window, "a settled picture", |window| window.state().is_gathered() == (true, true));
    let gathered = picture(&mut window);

    // Nothing that moves may show what was gathered for another view.
    let begun = window.state().camera_pose();
    window.remove_cursor();
    let middle = window.state().view_rect().center();
    window.hover_at(middle);
    window.step();
    window.key_press(Key::F);
    window.step();
    window.step();
    assert!(window.state().camera_pose() != begun, "the key moves the camera");
    until(&mut window, "another picture", |window| window.state().is_gathered() == (true, true));
    window.key_press(Key::Home);
    window.step();
    window.step();
    until(&mut window, "the first view again", |window| window.state().is_gathered() == (true, true));
    assert_eq!(share_of_different_pixels(&gathered, &picture(&mut window)), 0.0, "the same view has the same picture");

    choose(&mut window, words::PICTURE, words::MESH);
    assert_eq!(window.state().is_gathered(), (false, false));
    let mesh = picture(&mut window);
    assert!(share_of_different_pixels(&gathered, &mesh) > 0.1);
    let mean = |picture: &image::RgbaImage| {
        picture.as_raw().iter().map(|channel| f64::from(*channel)).sum::<f64>() / picture.as_raw().len() as f64
    };
    assert!((mean(&gathered) - mean(&mesh)).abs() < 3.0, "nothing jumps: {} {}", mean(&gathered), mean(&mesh));
    choose(&mut window, words::PICTURE, words::GATHERED);
    until(&mut window, "the gathered picture", |window| window.state().is_gathered() == (true, true));
    assert_eq!(share_of_different_pixels(&gathered, &picture(&mut window)), 0.0);
}

const SIZE: [f32; 2] = [700.0, 460.0];

/// A small window on the Cornell box, with its picture in the making.
fn in_mid_pass() -> Harness<'static, App> {
    let mut window = small(SIZE);
    until(&mut window, "a first pass", |window| window.state().is_gathered().0);
    window
}

fn small(size: [f32; 2]) -> Harness<'static, App> {
    let params = SolverParams { error: Some(0.1), ..SolverParams::default() };
    let mut window = window_of_size(size, Some(Source::Builtin(BuiltinScene::Cornell)), params);
    until(&mut window, "the first picture", |window| window.state().snapshot().is_some());
    finish(&mut window);
    window
}

fn settled(window: &mut Harness<'static, App>) -> image::RgbaImage {
    // Of the last step of the solve: a slow machine may settle one before it.
    until(window, "a settled picture", |window| {
        let is_last = window.state().snapshot().is_some_and(|snapshot| snapshot.stats.phase == Phase::Done);
        is_last && window.state().is_gathered() == (true, true)
    });
    picture(window)
}

/// Truth: the picture of a window that had the size from the start.
#[test]
fn a_resize_in_mid_pass_ends_in_the_picture_of_that_size() {
    let mut window = in_mid_pass();
    window.set_size(egui::vec2(640.0, 430.0));
    window.run_steps(2);
    // The camera keeps its lens; the one of the start suits the new shape.
    let middle = window.state().view_rect().center();
    window.hover_at(middle);
    window.step();
    window.key_press(Key::Home);
    window.run_steps(2);
    let resized = settled(&mut window);
    let fresh = settled(&mut small([640.0, 430.0]));
    assert_eq!(share_of_different_pixels(&resized, &fresh), 0.0);
}

/// Truth: light is proportional to the lamps; with a locked exposure the darker picture stays
/// darker.
#[test]
fn a_changed_lamp_in_mid_pass_ends_in_its_own_light() {
    let mut window = in_mid_pass();
    click(&mut window, words::LOCK_EXPOSURE);
    let full = settled(&mut window);
    click(&mut window, words::LIGHT);
    let dimmer = window.get_by_label_contains("Dimmer of ").accesskit_node().label().expect("a name");
    window.get_by_role_and_label(Role::Slider, &dimmer).set_value_accesskit(50.0);
    window.run_steps(1);
    until(&mut window, "the change", |window| window.state().is_gathered() != (true, true));
    finish(&mut window);
    let half = settled(&mut window);
    let mean = |picture: &image::RgbaImage| {
        picture.pixels().map(|pixel| f64::from(pixel[1])).sum::<f64>() / f64::from(picture.width() * picture.height())
    };
    assert!(mean(&half) < 0.9 * mean(&full), "{} of {}", mean(&half), mean(&full));
    window.get_by_role_and_label(Role::Slider, &dimmer).set_value_accesskit(100.0);
    until(&mut window, "the change", |window| window.state().is_gathered() != (true, true));
    finish(&mut window);
    assert_eq!(share_of_different_pixels(&settled(&mut window), &full), 0.0, "the light is as it was");
}

/// Truth: the picture of the scene where nothing disturbed it.
#[test]
fn another_scene_in_mid_pass_ends_in_its_own_picture() {
    let undisturbed = settled(&mut small(SIZE));
    let mut window = in_mid_pass();
    let is_button = |node: &egui_kittest::Node<'_>| node.accesskit_node().role() == Role::Button;
    window.get_all_by_label("cornell").find(is_button).expect("sample scenes are offered").click();
    until(&mut window, "the scene again", |window| {
        window.state().snapshot().is_some_and(|snapshot| snapshot.generation > 1)
    });
    finish(&mut window);
    assert_eq!(share_of_different_pixels(&settled(&mut window), &undisturbed), 0.0);
}

/// Truth: the legend's own values, by the names of the written ones.
#[test]
fn lines_of_a_gathered_picture_carry_their_values() {
    let mut window = small(SIZE);
    click(&mut window, words::ISOLUX_LINES);
    window.run_steps(3);
    settled(&mut window);
    until(&mut window, "a value", |window| window.query_all_by_label_contains("Line at ").next().is_some());
    let places: Vec<egui::Pos2> =
        window.query_all_by_label_contains("Line at ").map(|label| label.rect().center()).collect();
    for label in window.query_all_by_label_contains("Line at ") {
        let node = label.accesskit_node();
        let name = node.label().or_else(|| node.value()).expect("a name");
        let value = name.trim_start_matches("Line at ");
        assert!(window.query_all_by_label(value).next().is_some(), "the legend has {value}");
    }
    let view = window.state().view_rect();
    assert!(places.iter().all(|place| view.contains(*place)), "{places:?}");
    choose(&mut window, words::PICTURE, words::MESH);
    assert!(window.query_all_by_label_contains("Line at ").next().is_none());
}
