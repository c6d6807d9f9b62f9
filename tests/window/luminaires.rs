//! Luminaires, a task area and bookmarks: set in the window, undone, and kept beside the scene.

use egui::accesskit::Role;
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use selflink::app::{App, words};
use selflink::scene::{Luminaire, LuminaireShape, Sidecar, Source};

use super::support::{choose, click, coarse, cornell, finish, until, window};

/// A room of 4 × 2.5 × 4 m without a lamp.
const ROOM: &str = "o room
v 0 0 0\nv 4 0 0\nv 4 0 4\nv 0 0 4\nv 0 2.5 0\nv 4 2.5 0\nv 4 2.5 4\nv 0 2.5 4
f 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";

type Window = Harness<'static, App>;

fn luminaires(window: &Window) -> Vec<Luminaire> {
    window.state().scene_info().map(|info| info.scene.luminaires()).unwrap_or_default()
}

fn set(window: &mut Window, role: Role, label: &str, value: f64) {
    window.get_by_role_and_label(role, label).scroll_to_me();
    window.run_steps(6);
    window.get_by_role_and_label(role, label).set_value_accesskit(value);
    window.run_steps(2);
}

fn room() -> (tempfile::TempDir, std::path::PathBuf) {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("room.obj");
    std::fs::write(&path, ROOM).expect("the room is written");
    (folder, path)
}

/// Truth: the numbers that were typed, the scene that the worker tells of, and the file beside the
/// scene.
#[test]
fn luminaires_are_added_moved_removed_undone_and_saved() {
    let (_folder, path) = room();
    let mut window = window(Some(Source::File(path.clone())), coarse());
    until(&mut window, "the room", |window| window.state().scene_info().is_some());
    click(&mut window, words::ADD_DISC_LIGHT);
    until(&mut window, "a disc", |window| luminaires(window).len() == 1);
    let disc = luminaires(&window).remove(0);
    assert_eq!((disc.form.shape, disc.form.direction), (LuminaireShape::Disc, -glam::Vec3::Y));
    assert!(disc.form.centre.y > 2.4 && disc.form.centre.y < 2.5, "under the ceiling: {}", disc.form.centre);
    click(&mut window, words::ADD_LINE_LIGHT);
    until(&mut window, "a line", |window| luminaires(window).len() == 2);

    // The line is at hand.
    set(&mut window, Role::SpinButton, words::LUMINAIRE_Y, 1.5);
    set(&mut window, Role::SpinButton, words::LENGTH, 1.25);
    until(&mut window, "its place", |window| {
        luminaires(window).get(1).is_some_and(|line| (line.form.centre.y, line.form.size) == (1.5, 1.25))
    });
    let generation = window.state().scene_info().expect("a scene").generation;
    let line = luminaires(&window).remove(1);
    set(&mut window, Role::Slider, "Dimmer of line light", 50.0);
    until(&mut window, "half its light", |window| {
        let now = luminaires(window).remove(1).exitance;
        (now / line.exitance - 0.5).abs().max_element() < 1e-4
    });
    assert_eq!(window.state().scene_info().expect("a scene").generation, generation, "dimming solves nothing anew");

    click(&mut window, &format!("{} line light", words::REMOVE_LUMINAIRE));
    until(&mut window, "the disc alone", |window| luminaires(window) == [disc.clone()]);
    click(&mut window, words::UNDO);
    until(&mut window, "the line again", |window| {
        luminaires(window).get(1).is_some_and(|back| back.form == line.form && back.exitance.x < 0.51 * line.exitance.x)
    });
    click(&mut window, words::REDO);
    until(&mut window, "the disc alone again", |window| luminaires(window) == [disc.clone()]);
    click(&mut window, words::UNDO);
    until(&mut window, "the line once more", |window| luminaires(window).len() == 2);

    click(&mut window, words::CAMERA);
    click(&mut window, words::ADD_BOOKMARK);
    window.key_press(egui::Key::Escape);
    window.run_steps(3);
    click(&mut window, words::SAVE_SCENE_SETTINGS);
    until(&mut window, "the file", |window| window.query_by_label_contains("Saved").is_some());
    let said = Sidecar::read(&Sidecar::path_for(&path)).expect("what was saved");
    let names: Vec<&str> = said.luminaires.iter().map(|luminaire| luminaire.name.as_str()).collect();
    assert_eq!((names, said.bookmarks.len()), (vec!["disc light", "line light"], 1));
    let wanted = luminaires(&window);
    let mut again = super::support::window(Some(Source::File(path)), coarse());
    until(&mut again, "the room again", |window| luminaires(window) == wanted);
    finish(&mut again);
    click(&mut again, words::CAMERA);
    assert!(again.query_by_label(&format!("{} 1", words::BOOKMARK)).is_some(), "the bookmark is there again");
}

/// Truth: the closed forms of the units: P = M·A in each channel, Φ_v = 179 lm/W of what the eye
/// weighs; and the axes of the file.
#[test]
fn a_luminaire_is_set_in_watts_lumens_and_kelvin() {
    let (_folder, path) = room();
    let mut window = window(Some(Source::File(path)), coarse());
    until(&mut window, "the room", |window| window.state().scene_info().is_some());
    click(&mut window, words::ADD_SQUARE_LIGHT);
    until(&mut window, "the luminaire", |window| luminaires(window).len() == 1);
    let at_hand = |window: &Window| luminaires(window).remove(0);
    let lumens = |of: &Luminaire| 179.0 * of.form.area() * of.exitance.dot(glam::Vec3::new(0.2126, 0.7152, 0.0722));
    // The material above has a list of its own by that name.
    let unit = |window: &mut Window, what: &str| {
        let place = |window: &Window| {
            let lists = window.query_all_by_role_and_label(Role::ComboBox, words::LAMP_UNIT);
            lists.map(|list| list.rect().center().y).fold(0.0, f32::max)
        };
        let lowest = place(window);
        let lists = window.query_all_by_role_and_label(Role::ComboBox, words::LAMP_UNIT);
        lists.last().filter(|list| list.rect().center().y == lowest).expect("a list").scroll_to_me();
        window.run_steps(6);
        window.query_all_by_role_and_label(Role::ComboBox, words::LAMP_UNIT).last().expect("a list").click();
        window.run_steps(2);
        window.get_by_label_contains(what).click();
        window.run_steps(3);
    };
    let slide = |window: &mut Window, what: &str, value: f64| {
        let slider = |window: &Window| window.query_all_by_role_and_label(Role::Slider, what).count();
        assert!(slider(window) > 0, "{what}");
        window.query_all_by_role_and_label(Role::Slider, what).last().expect("a slider").set_value_accesskit(value);
        window.run_steps(2);
    };
    unit(&mut window, &format!("{}, W", words::POWER));
    slide(&mut window, words::POWER, 60.0);
    until(&mut window, "60 W in all channels", |window| {
        let of = at_hand(window);
        (of.form.area() * of.exitance.element_sum() - 60.0).abs() < 0.1
    });
    unit(&mut window, &format!("{}, lm", words::FLUX));
    slide(&mut window, words::FLUX, 3000.0);
    until(&mut window, "3000 lm", |window| (lumens(&at_hand(window)) - 3000.0).abs() < 5.0);
    slide(&mut window, words::COLOUR_TEMPERATURE, 2700.0);
    until(&mut window, "warm white", |window| at_hand(window).exitance.x > 1.5 * at_hand(window).exitance.z);
    slide(&mut window, words::COLOUR_TEMPERATURE, 9000.0);
    until(&mut window, "cold white", |window| at_hand(window).exitance.z > at_hand(window).exitance.x);

    choose(&mut window, words::SHAPE, "disc");
    until(&mut window, "a disc", |window| at_hand(window).form.shape == LuminaireShape::Disc);
    choose(&mut window, words::SHINES, "up");
    until(&mut window, "upwards", |window| at_hand(window).form.direction == glam::Vec3::Y);
    set(&mut window, Role::SpinButton, words::TURN, 30.0);
    until(&mut window, "its turn", |window| at_hand(window).form.turn_deg == 30.0);
}

/// Truth: what is dragged along an axis moves along that axis alone, and the scene is made anew
/// when it is let go.
#[test]
fn a_handle_moves_a_luminaire_along_its_axis() {
    let (_folder, path) = room();
    let mut window = window(Some(Source::File(path)), coarse());
    until(&mut window, "the room", |window| window.state().scene_info().is_some());
    click(&mut window, words::ADD_SQUARE_LIGHT);
    until(&mut window, "the luminaire", |window| luminaires(window).len() == 1);
    set(&mut window, Role::SpinButton, words::LUMINAIRE_Y, 1.5);
    until(&mut window, "its place", |window| luminaires(window)[0].form.centre.y == 1.5);
    finish(&mut window);
    let before = luminaires(&window).remove(0).form.centre;
    // Below the tip, on the shaft.
    let grip = window.get_by_label(words::MOVE_ALONG_Y).rect().center() + egui::vec2(0.0, 24.0);
    window.hover_at(grip);
    window.step();
    window.drag_at(grip);
    window.step();
    for step in 1..=5 {
        window.hover_at(grip - egui::vec2(0.0, 8.0 * step as f32));
        window.step();
        assert_eq!(luminaires(&window)[0].form.centre, before, "nothing is solved anew while it is dragged");
    }
    window.drop_at(grip - egui::vec2(0.0, 40.0));
    until(&mut window, "another place", |window| luminaires(window)[0].form.centre != before);
    let moved = luminaires(&window).remove(0).form.centre - before;
    assert!(moved.y > 0.05 && moved.x == 0.0 && moved.z == 0.0, "{moved}");
    window.key_press(egui::Key::Escape);
    window.run_steps(3);
    assert!(window.query_by_label(words::MOVE_ALONG_Y).is_none(), "Esc lets it go");
    click(&mut window, words::UNDO);
    until(&mut window, "its former place", |window| luminaires(window)[0].form.centre == before);
}

/// Truth: what a click does afterwards: it selects.
#[test]
fn esc_ends_placing_probes_and_drawing_an_area() {
    let mut window = cornell(coarse());
    finish(&mut window);
    click(&mut window, words::MEASURE);
    let centre = window.state().view_rect().center();
    for tool in [words::PLACE_PROBES, words::DRAW_TASK_AREA] {
        click(&mut window, tool);
        window.key_press(egui::Key::Escape);
        window.run_steps(3);
        window.drag_at(centre);
        window.drop_at(centre);
        until(&mut window, "a selection", |window| window.state().picked_element().is_some());
        assert!(window.query_by_label("Name of probe 1").is_none(), "{tool}");
        window.key_press(egui::Key::Escape);
        window.run_steps(3);
        assert!(window.state().picked_element().is_none(), "Esc deselects once nothing else is to be ended");
    }
}

/// Truth: the target's numbers decide what is said; a drag in the view draws the area, and turns
/// nothing meanwhile.
#[test]
fn a_task_area_is_drawn_and_judged() {
    let mut window = cornell(coarse());
    finish(&mut window);
    click(&mut window, words::MEASURE);
    click(&mut window, words::DRAW_TASK_AREA);
    let pose = window.state().camera_pose().expect("a view");
    let view = window.state().view_rect();
    let at = |x: f32, y: f32| view.min + egui::vec2(x, y) * view.size();
    window.hover_at(at(0.42, 0.72));
    window.step();
    window.drag_at(at(0.42, 0.72));
    window.step();
    for step in 1..=4 {
        window.hover_at(at(0.42 + 0.04 * step as f32, 0.72 + 0.02 * step as f32));
        window.step();
    }
    window.drop_at(at(0.58, 0.8));
    until(&mut window, "its numbers", |window| window.query_by_label(words::TARGET_UNIFORMITY).is_some());
    assert_eq!(window.state().camera_pose().expect("a view"), pose, "the view stays");
    assert!(
        window.query_by_label(&words::task_area("x", "from")).is_some()
            && window.query_by_label(&words::task_area("z", "to")).is_some()
    );
    set(&mut window, Role::SpinButton, words::TARGET_AVERAGE, 1.0);
    set(&mut window, Role::SpinButton, words::TARGET_UNIFORMITY, 1.0);
    let says = |window: &Window, verdict: &str, what: &str| {
        window.query_by_label_contains(&format!("{verdict}: {what}")).is_some()
    };
    assert!(says(&window, words::PASSED, words::AVERAGE) && says(&window, words::FAILED, words::UNIFORMITY));
    set(&mut window, Role::SpinButton, words::TARGET_AVERAGE, 1e5);
    set(&mut window, Role::SpinButton, words::TARGET_UNIFORMITY, 0.01);
    assert!(says(&window, words::FAILED, words::AVERAGE) && says(&window, words::PASSED, words::UNIFORMITY));
    click(&mut window, words::WHOLE_PLANE);
    assert!(window.query_by_label(&words::task_area("x", "from")).is_none());
    click(&mut window, words::UNDO);
    assert!(window.query_by_label(&words::task_area("x", "from")).is_some(), "the area is back");
    click(&mut window, words::REDO);
    assert!(window.query_by_label(&words::task_area("x", "from")).is_none());
}
