//! The camera menu, bookmarks, walking, and how far the wheel leads.
//!
//! Truth: the pose of the eye, and the scene's own box.

use egui::accesskit::Role;
use egui::{Event, Key, MouseWheelUnit, vec2};
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT, Queryable};
use glam::Vec3;
use selflink::app::{App, words};
use selflink::scene::CameraPose;

use crate::support::{click, coarse, cornell, finish};

type Window = Harness<'static, App>;

fn opened() -> Window {
    let mut window = cornell(coarse());
    finish(&mut window);
    window.run_steps(2);
    window
}

fn pose(window: &Window) -> CameraPose {
    window.state().camera_pose().expect("a view")
}

fn sight(window: &Window) -> Vec3 {
    let pose = pose(window);
    (pose.target - pose.eye).normalize()
}

/// Chooses from the camera menu, which closes by itself or by Esc.
fn choose(window: &mut Window, name: &str) {
    click(window, words::CAMERA);
    click(window, name);
    window.run_steps(3);
}

#[test]
fn views_from_outside_see_the_whole_scene_along_the_axes() {
    let mut window = opened();
    let (lower, upper) = window.state().scene_info().expect("a scene").scene.bounds();
    let (start, middle) = (pose(&window), 0.5 * (lower + upper));
    for (name, along) in [(words::TOP, -Vec3::Y), (words::FRONT, -Vec3::Z), (words::SIDE, Vec3::X)] {
        choose(&mut window, name);
        let (eye, seen) = (pose(&window).eye, sight(&window));
        assert!(seen.dot(along).abs() > 0.999, "{name}: {seen}");
        assert!(eye.cmplt(lower).any() || eye.cmpgt(upper).any(), "{name}: {eye} lies outside");
        assert!((middle - eye).normalize().dot(seen) > 0.99, "{name}: the scene lies in the middle");
    }
    choose(&mut window, words::RESET_CAMERA);
    let back = pose(&window);
    assert!(back.eye == start.eye && back.target == start.target, "{back:?}");
}

#[test]
fn the_field_of_view_and_bookmarks_are_set_in_the_menu() {
    let mut window = opened();
    let start = pose(&window);
    click(&mut window, words::CAMERA);
    window.get_by_role_and_label(Role::Slider, words::FIELD_OF_VIEW).set_value_accesskit(90.0);
    window.run_steps(3);
    let wide = pose(&window);
    assert!((wide.hfov_deg - 90.0).abs() < 0.1 && wide.eye.abs_diff_eq(start.eye, 1e-4), "{wide:?}");
    click(&mut window, words::ADD_BOOKMARK);
    assert!(window.query_by_label(&format!("{} 1", words::BOOKMARK)).is_some(), "it is seen at once");
    window.key_press(Key::Escape);
    window.run_steps(3);
    choose(&mut window, words::TOP);
    assert!(!pose(&window).eye.abs_diff_eq(wide.eye, 1e-2));
    let bookmark = format!("{} 1", words::BOOKMARK);
    choose(&mut window, &bookmark);
    let back = pose(&window);
    assert!(back.eye.abs_diff_eq(wide.eye, 1e-4) && (back.hfov_deg - 90.0).abs() < 0.1, "{back:?}");
    choose(&mut window, "Remove bookmark 1");
    assert!(window.query_by_label(&bookmark).is_none());
}

#[test]
fn whoever_walks_stays_in_the_room_at_eye_height() {
    let mut window = opened();
    let (lower, upper) = window.state().scene_info().expect("a scene").scene.bounds();
    let fly = |window: &mut Window| {
        let middle = window.state().view_rect().center();
        window.hover_at(middle);
        window.step();
        window.key_down(Key::W);
        window.run_steps(60);
        window.key_up(Key::W);
        window.run_steps(2);
    };
    assert!(window.query_by_label(words::WALKING).is_none());
    choose(&mut window, words::WALK);
    window.key_press(Key::Escape);
    window.run_steps(3);
    assert!(window.query_by_label(words::WALKING).is_some(), "it is said that keys walk");
    let before = pose(&window).eye;
    for _ in 0..6 {
        fly(&mut window);
    }
    let walked = pose(&window).eye;
    assert!(walked != before && walked.z > lower.z && walked.y > lower.y && walked.y < upper.y, "{walked}");
}

/// Truth: the pose at the start, whatever is open beside the view.
#[test]
fn home_is_the_same_whatever_is_open() {
    let mut window = opened();
    let start = pose(&window);
    click(&mut window, words::LINK_MATRIX);
    for _ in 0..2 {
        let middle = window.state().view_rect().center();
        window.drag_at(middle);
        window.step();
        window.hover_at(middle + vec2(90.0, 30.0));
        window.step();
        window.drop_at(middle + vec2(90.0, 30.0));
        window.run_steps(2);
        assert_ne!(pose(&window).eye, start.eye);
        window.key_press(Key::Home);
        window.run_steps(2);
        let home = pose(&window);
        assert!(home.eye.abs_diff_eq(start.eye, 1e-4) && home.target.abs_diff_eq(start.target, 1e-4), "{home:?}");
        if window.query_by_label(words::CLOSE_TOOL).is_some() {
            click(&mut window, words::CLOSE_TOOL);
        }
    }
}

#[test]
fn the_wheel_leads_no_farther_than_the_scene_can_be_seen() {
    let mut window = opened();
    let (lower, upper) = window.state().scene_info().expect("a scene").scene.bounds();
    let middle = window.state().view_rect().center();
    window.hover_at(middle);
    window.step();
    let mut distances = Vec::new();
    for _ in 0..2 {
        for _ in 0..60 {
            window.event(Event::MouseWheel {
                unit: MouseWheelUnit::Point,
                delta: vec2(0.0, -2000.0),
                phase: egui::TouchPhase::Move,
                source: egui::MouseWheelSource::Wheel,
                modifiers: egui::Modifiers::NONE,
            });
            window.step();
        }
        window.run_steps(30);
        distances.push(pose(&window).eye.distance(0.5 * (lower + upper)));
    }
    let size = (upper - lower).length();
    assert!(distances[0] > 1.5 * size, "{distances:?}: it went away");
    assert!(
        (distances[1] / distances[0] - 1.0).abs() < 1e-3 && distances[1] < 100.0 * size,
        "{distances:?}: and stopped"
    );
    // What looks at the room from behind its walls says so.
    choose(&mut window, words::SIDE);
    window.run_steps(2);
    assert!(window.query_by_label(words::THROUGH_WALLS).is_some());
    assert_eq!(window.get_by_label(words::THROUGH_WALLS).accesskit_node().role(), Role::Label);
}
