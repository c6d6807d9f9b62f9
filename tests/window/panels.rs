//! The panels at the left, the view and its messages.

use egui::accesskit::Role;
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT, Queryable};
use glam::Vec3;
use selflink::app::{App, words};
use selflink::prepare::added_light::{AddedLight, CeilingLight};
use selflink::scene::builtin::BuiltinScene;
use selflink::scene::{Reading, Source};
use selflink::solve::{ClusteringMode, Epsilon, ParameterId, SolverParams};
use selflink::worker::RunState;

use crate::support::{
    choose, click, coarse, cornell, finish, picture, share_of_different_pixels, until, window, window_with,
};

#[test]
fn a_scene_is_opened_by_its_panel_and_lit() {
    let mut window = window(None, coarse());
    window.step();
    assert!(window.query_by_label(words::OPEN_A_ROOM).is_some(), "the empty window says what to do");
    window.get_all_by_label("cornell").next().expect("sample scenes are offered").click();
    finish(&mut window);
    assert_eq!(window.state().scene_info().expect("a scene").scene.name, "cornell");
    assert!(window.query_by_label(words::OPEN_A_ROOM).is_none());
    let lit = picture(&mut window);
    let red = lit.pixels().filter(|pixel| pixel[0] > 120 && pixel[1] < pixel[0] / 2 && pixel[2] < pixel[0] / 2).count();
    assert!(red > 1000, "the left wall is red: {red} pixels");
}

#[test]
fn changed_parameters_reach_the_solver() {
    let mut window = cornell(coarse());
    finish(&mut window);
    let patches = window.state().snapshot().expect("a picture").stats.patches;

    window.get_by_role_and_label(Role::Slider, words::parameter(ParameterId::Epsilon)).set_value_accesskit(2e-3);
    until(&mut window, "a finer ε", |window| window.state().status().params.epsilon == Epsilon::Relative(2e-3));
    until(&mut window, "more patches", |window| {
        window.state().snapshot().is_some_and(|snapshot| snapshot.stats.patches > patches)
    });

    let generation = window.state().snapshot().expect("a picture").generation;
    choose(&mut window, words::parameter(ParameterId::Clustering), "octree");
    until(&mut window, "octree", |window| window.state().status().params.clustering == ClusteringMode::Octree);
    window.get_by_role_and_label(Role::Slider, words::parameter(ParameterId::OctreeDepth)).set_value_accesskit(3.0);
    until(&mut window, "depth 3", |window| window.state().status().params.octree_depth == 3);
    until(&mut window, "a new hierarchy", |window| {
        window.state().snapshot().is_some_and(|snapshot| snapshot.generation > generation)
    });
}

#[test]
fn a_solve_is_paused_stepped_and_resumed() {
    // Fine enough that it is not finished before the pause, however slow the window.
    let params = SolverParams { epsilon: Epsilon::Relative(1e-4), ..SolverParams::default() };
    let mut window = window(Some(Source::Builtin(BuiltinScene::from_name("seminar").expect("ours"))), params);
    until(&mut window, "the first picture", |window| window.state().snapshot().is_some());
    click(&mut window, words::PAUSE);
    until(&mut window, "the pause", |window| window.state().status().run == RunState::Paused);
    let now = |window: &Harness<'static, App>| {
        let snapshot = window.state().snapshot().expect("a picture");
        (snapshot.serial, snapshot.stats.pairs_judged)
    };
    let before = now(&window).1;
    // The step after a round's last wave gathers and judges nothing; the one behind it does.
    for _ in 0..2 {
        let serial = now(&window).0;
        click(&mut window, words::STEP_ONE_WAVE);
        until(&mut window, "one more step", |window| {
            now(window).0 > serial && window.state().status().run == RunState::Paused
        });
    }
    assert!(now(&window).1 > before, "no wave was judged");
    click(&mut window, words::RUN);
    until(&mut window, "going on", |window| window.state().status().run != RunState::Paused);
}

#[test]
fn overlays_and_a_picked_element_are_shown() {
    let mut window = cornell(coarse());
    finish(&mut window);
    let plain = picture(&mut window);
    click(&mut window, words::ELEMENT_OUTLINES);
    let outlined = picture(&mut window);
    let share = share_of_different_pixels(&plain, &outlined);
    assert!((0.001..0.5).contains(&share), "outlines cover {share} of the view");
    click(&mut window, words::ELEMENT_OUTLINES);
    assert_eq!(share_of_different_pixels(&plain, &picture(&mut window)), 0.0, "without overlays it is as before");
    click(&mut window, words::CLUSTER_BOXES);
    assert!(share_of_different_pixels(&plain, &picture(&mut window)) > 0.0005);
    click(&mut window, words::CLUSTER_BOXES);

    let centre = window.state().view_rect().center();
    window.drag_at(centre);
    window.drop_at(centre);
    until(&mut window, "the tag", |window| window.query_by_label(words::DETAILS).is_some());
    assert!(window.query_by_label(words::SELECTED_ELEMENT).is_none(), "the card is there on request");
    click(&mut window, words::DETAILS);
    until(&mut window, "its links", |window| window.query_by_label_contains(words::TOP_SOURCES).is_some());
    assert!(window.query_by_label(words::SELECTED_ELEMENT).is_some());
    assert!(window.query_by_label_contains(words::TOP_SOURCES).is_some());
    click(&mut window, words::CLOSE);
    until(&mut window, "letting go", |window| window.query_by_label(words::SELECTED_ELEMENT).is_none());
}

#[test]
fn dragging_turns_the_view_and_home_brings_it_back() {
    let mut window = cornell(coarse());
    finish(&mut window);
    let start = picture(&mut window);
    let centre = window.state().view_rect().center();
    window.drag_at(centre);
    window.step();
    window.hover_at(centre + egui::vec2(120.0, 40.0));
    window.step();
    window.drop_at(centre + egui::vec2(120.0, 40.0));
    window.step();
    assert!(share_of_different_pixels(&start, &picture(&mut window)) > 0.2, "the picture did not turn");
    window.hover_at(centre);
    window.step();
    window.key_press(egui::Key::Home);
    window.step();
    assert_eq!(share_of_different_pixels(&start, &picture(&mut window)), 0.0, "Home is where it started");
}

#[test]
fn a_bad_path_is_said_and_the_scene_stays() {
    let mut window = cornell(coarse());
    finish(&mut window);
    let before = picture(&mut window);
    let field = window.get_by_label(words::SCENE_PATH);
    field.focus();
    field.type_text("no/such/room.obj");
    window.step();
    click(&mut window, words::OPEN);
    until(&mut window, "the message", |window| window.query_by_label_contains("room.obj: no such file").is_some());
    assert_eq!(window.state().scene_info().expect("the scene stays").scene.name, "cornell");
    assert!(window.state().view_rect().height() > 650.0, "the message must leave room for the picture");
    click(&mut window, words::DISMISS);
    until(&mut window, "its end", |window| window.query_by_label(words::DISMISS).is_none());
    assert_eq!(share_of_different_pixels(&before, &picture(&mut window)), 0.0);
}

/// Truth: the field's own text. Its end is what is shown, and the whole path is what is opened.
#[test]
fn a_long_path_shows_its_end() {
    let mut window = window(None, coarse());
    window.step();
    let field = window.get_by_label(words::SCENE_PATH);
    field.focus();
    let path = format!("{}/room.obj", "no/such/folder".repeat(9));
    field.type_text(&path);
    window.run_steps(2);
    window.key_press(egui::Key::Tab);
    window.run_steps(2);
    let shown = window.get_by_label(words::SCENE_PATH).accesskit_node().value().expect("a text");
    assert!(
        shown.starts_with('…') && shown.ends_with("/room.obj") && path.ends_with(&shown['…'.len_utf8()..]),
        "{shown}"
    );
    click(&mut window, words::OPEN);
    until(&mut window, "the message", |window| window.query_by_label_contains("room.obj: no such file").is_some());
}

/// Truth: what was asked for last. Neither failure nor advice outlives it.
#[test]
fn messages_about_opening_do_not_pile_up() {
    let mut window = cornell(coarse());
    finish(&mut window);
    let open = |window: &mut Harness<'static, App>, path: &str| {
        window.get_by_label(words::SCENE_PATH).focus();
        window.key_press_modifiers(egui::Modifiers::COMMAND, egui::Key::A);
        window.get_by_label(words::SCENE_PATH).type_text(path);
        window.run_steps(2);
        click(window, words::OPEN);
    };
    let dismissals = |window: &Harness<'static, App>| window.query_all_by_label(words::DISMISS).count();
    open(&mut window, "no/such/room.obj");
    until(&mut window, "the message", |window| window.query_by_label_contains("room.obj: no such file").is_some());
    open(&mut window, "no/such/house.obj");
    until(&mut window, "another", |window| window.query_by_label_contains("house.obj: no such file").is_some());
    assert_eq!(dismissals(&window), 1, "the later failure takes the place of the former");
    window.get_all_by_label("seminar").next().expect("sample scenes are offered").click();
    until(&mut window, "the scene", |window| {
        window.state().scene_info().is_some_and(|info| info.scene.name == "seminar") && dismissals(window) == 0
    });
}

/// Truth: the bibliography.
#[test]
fn the_method_names_the_paper_whose_sections_it_cites() {
    let mut window = cornell(coarse());
    finish(&mut window);
    if window.query_by_label(words::PAPER).is_none() {
        click(&mut window, words::METHOD);
    }
    assert!(window.query_by_label(words::PAPER).is_some());
    assert!(words::PAPER.contains("Isotropic Clustering for Hierarchical Radiosity"));
}

#[test]
fn a_scene_that_opens_takes_old_errors_away() {
    let mut window = window(Some(Source::File("no/such/room.obj".into())), coarse());
    until(&mut window, "the message", |window| window.query_by_label_contains("room.obj: no such file").is_some());
    window.get_all_by_label("cornell").next().expect("sample scenes are offered").click();
    finish(&mut window);
    assert!(window.query_by_label(words::DISMISS).is_none(), "the scene is there, the error of another one is not");
}

/// Three walls without a lamp.
const DARK_ROOM: &str = "o room/walls
v 0 0 0\nv 2 0 0\nv 2 0 2\nv 0 0 2\nv 0 2 0\nv 2 2 0\nv 2 2 2\nv 0 2 2
f 4 3 2 1\nf 1 2 6 5\nf 1 5 8 4\n";

const TOO_LARGE: &str =
    "The square light, with sides of 8, is larger than the scene, which measures 2 by 2: choose a smaller one.";

#[test]
fn a_scene_without_a_lamp_says_so_and_can_be_given_one() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("dark.obj");
    std::fs::write(&path, DARK_ROOM).expect("the room is written");
    let mut window = window(Some(Source::File(path)), coarse());
    until(&mut window, "the room", |window| window.state().scene_info().is_some());
    assert!(!window.state().scene_info().expect("a scene").has_light);
    assert!(window.query_by_label_contains("Nothing in this scene emits light").is_some());
    finish(&mut window);
    assert!(
        window.query_by_label(words::NOTHING_EMITS).is_some()
            && window.query_by_label_contains(words::LINKS_SETTLED).is_none()
    );
    assert!(window.query_by_label(words::NO_LIGHT_YET).is_some(), "over the view");
    // Its walls are of reflectance ½ and above: in their own colours they are bright, and turned
    // differently they differ.
    let own = picture(&mut window);
    let brightness = |picture: &image::RgbaImage| {
        let [width, height] = [picture.width(), picture.height()];
        [[5, 5], [1, 9], [9, 9]].map(|[x, y]| picture.get_pixel(x * width / 10, y * height / 10).0[1])
    };
    assert!(brightness(&own).iter().any(|green| *green > 60), "{:?}", brightness(&own));
    click(&mut window, words::ADD_SQUARE_LIGHT);
    until(&mut window, "light", |window| window.state().scene_info().is_some_and(|info| info.has_light));
    window.get_by_role_and_label(Role::SpinButton, words::SIDE_LENGTH).set_value_accesskit(8.0);
    until(&mut window, "the large one", |window| {
        window.state().scene_info().is_some_and(|info| info.scene.luminaires()[0].form.size == 8.0)
    });
    finish(&mut window);
    let snapshot = window.state().snapshot().expect("a picture");
    let lit = snapshot.leaf_irradiance.iter().filter(|rgb| rgb[0] > 0.0).count();
    assert!(lit > 0, "the lamp lights the walls");
    assert!(window.query_by_label_contains(words::LINKS_SETTLED).is_some());
    // Over the view, and among the scene's remarks.
    let said = window.query_all_by_role_and_label(Role::Label, TOO_LARGE).count();
    assert_eq!(said, 2);
    assert!(window.query_by_label_contains("Nothing in this scene emits light").is_none());
    assert!(window.query_by_label(words::NO_LIGHT_YET).is_none());
}

/// Truth: a click on a button over the dark view lights the room by a luminaire that can be taken
/// away again, and the view stays on the room.
#[test]
fn a_lamp_is_hung_up_from_the_view() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("dark.obj");
    std::fs::write(&path, DARK_ROOM).expect("the room is written");
    let mut window = window(Some(Source::File(path)), coarse());
    until(&mut window, "the room", |window| window.query_by_label(words::HANG_UP_A_LAMP).is_some());
    until(&mut window, "a camera", |window| window.state().camera_pose().is_some());
    let eye_and_target =
        |window: &Harness<'static, App>| window.state().camera_pose().map(|pose| (pose.eye, pose.target));
    let before = eye_and_target(&window);
    click(&mut window, words::HANG_UP_A_LAMP);
    until(&mut window, "light", |window| window.state().scene_info().is_some_and(|info| info.has_light));
    assert_eq!(window.state().scene_info().expect("a scene").scene.luminaires().len(), 1);
    until(&mut window, "the view", |window| window.query_by_label(words::HANG_UP_A_LAMP).is_none());
    assert_eq!(eye_and_target(&window), before);
    click(&mut window, words::UNDO);
    until(&mut window, "darkness", |window| window.state().scene_info().is_some_and(|info| !info.has_light));
}

/// Truth: the slider's value; stops belong to the scene they were chosen for.
#[test]
fn another_scene_is_shown_as_it_is() {
    let mut window = cornell(coarse());
    finish(&mut window);
    let plain = picture(&mut window);
    window.get_by_role_and_label(Role::Slider, words::EXPOSURE).set_value_accesskit(-6.0);
    until(&mut window, "a darker picture", |window| exposure(window) == -6.0);
    assert!(share_of_different_pixels(&plain, &picture(&mut window)) > 0.3);
    window.get_all_by_label("cornell").find(is_button).expect("sample scenes are offered").click();
    until(&mut window, "the scene again", |window| {
        window.state().snapshot().is_some_and(|snapshot| snapshot.generation > 1 && snapshot.stats.converged)
    });
    assert_eq!(exposure(&window), 0.0);
    finish(&mut window);
    // The light meter may still be at work.
    let is_as_before = |_| {
        window.run_steps(5);
        share_of_different_pixels(&plain, &picture(&mut window)) == 0.0
    };
    assert!((0..100).any(is_as_before), "another picture than at first");
}

fn exposure(window: &Harness<'static, App>) -> f64 {
    window.get_by_role_and_label(Role::Slider, words::EXPOSURE).accesskit_node().numeric_value().expect("a number")
}

fn is_button(node: &egui_kittest::Node<'_>) -> bool {
    node.accesskit_node().role() == Role::Button
}

/// Truth: the slider's value. A lamp follows it without a button; what does not emit waits for the
/// button.
#[test]
fn a_lamp_follows_its_slider_at_once() {
    let mut window = cornell(coarse());
    finish(&mut window);
    click(&mut window, words::LIGHT);
    let strongest = |window: &Harness<'static, App>| {
        let info = window.state().scene_info().expect("a scene");
        info.scene.materials.iter().map(|material| material.emission.max_element()).fold(0.0, f32::max)
    };
    let before = strongest(&window);
    let strength = 2.0 * f64::from(before).round();
    choose(&mut window, words::LAMP_UNIT, &format!("{}, W/m²", words::EXITANCE));
    window.get_by_role_and_label(Role::Slider, words::EXITANCE).set_value_accesskit(strength);
    until(&mut window, "a brighter lamp", |window| (f64::from(strongest(window)) - strength).abs() < 0.1);
    click(&mut window, words::SWITCH_OFF);
    until(&mut window, "darkness", |window| strongest(window) == 0.0);
    window.get_by_role_and_label(Role::Slider, words::EXITANCE).set_value_accesskit(7.0);
    window.run_steps(10);
    finish(&mut window);
    assert_eq!(strongest(&window), 0.0, "what does not emit waits for the button");
    click(&mut window, words::SWITCH_ON);
    until(&mut window, "light", |window| (strongest(window) - 7.0).abs() < 0.1);
}

/// Truth: the file. A click writes where nothing is; where a sidecar is, only a second one does.
#[test]
fn an_existing_sidecar_is_overwritten_only_when_confirmed() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("dark.obj");
    std::fs::write(&path, DARK_ROOM).expect("the room is written");
    let sidecar = folder.path().join("dark.selflink.json");
    let mut window = window(Some(Source::File(path)), coarse());
    until(&mut window, "the room", |window| window.state().scene_info().is_some());
    click(&mut window, words::SAVE_SCENE_SETTINGS);
    until(&mut window, "the file", |window| window.query_by_label_contains("Saved").is_some());
    assert!(sidecar.exists() && window.query_by_label_contains(words::OVERWRITE).is_none());

    let by_hand = "{\n  \"sides\": \"front\"}";
    std::fs::write(&sidecar, by_hand).expect("the sidecar is written");
    for answer in [words::CANCEL, words::OVERWRITE] {
        click(&mut window, words::SAVE_SCENE_SETTINGS);
        until(&mut window, "the question", |window| window.query_by_label("Overwrite dark.selflink.json?").is_some());
        assert_eq!(std::fs::read_to_string(&sidecar).expect("the sidecar"), by_hand);
        click(&mut window, answer);
        until(&mut window, "the end of the question", |window| window.query_by_label(words::CANCEL).is_none());
    }
    until(&mut window, "the new file", |_| std::fs::read_to_string(&sidecar).is_ok_and(|text| text.contains("camera")));
}

#[test]
fn light_asked_for_at_the_start_is_there_at_once() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("dark.obj");
    std::fs::write(&path, DARK_ROOM).expect("the room is written");
    let light = AddedLight { ceiling: Some(CeilingLight { size: None, exitance: 100.0 }), ..AddedLight::default() };
    let mut window = window_with(Some((Source::File(path.clone()), Reading::default(), light)), coarse());
    until(&mut window, "the room", |window| window.state().scene_info().is_some());
    assert!(window.state().scene_info().expect("a scene").has_light);
    assert!(window.query_by_label_contains("Nothing in this scene emits light").is_none());
    // What cannot be added is said, and no scene is shown in its place.
    let light = AddedLight { emitting: vec![("roof".into(), Vec3::ONE)], ..AddedLight::default() };
    let mut window = window_with(Some((Source::File(path), Reading::default(), light)), coarse());
    until(&mut window, "the message", |window| window.query_by_label_contains("no material `roof`").is_some());
    assert!(window.state().scene_info().is_none());
}

/// A comparison with a reference: the section tells the error and its noise, the chart holds a
/// curve for each run, and the surfaces take the colours of their errors and give them back. The
/// usual way to use it: the window asks for an error, says which one it reached, and does more when
/// asked for less.
#[test]
fn an_error_is_asked_for_with_a_slider() {
    let mut window = cornell(SolverParams::usual());
    finish(&mut window);
    let vertices = |window: &Harness<'static, App>| window.state().snapshot().map_or(0, |lit| lit.mesh.positions.len());
    let usual = vertices(&window);
    let estimate = |window: &Harness<'static, App>| window.state().snapshot().and_then(|lit| lit.stats.error_estimate);
    assert!(estimate(&window).is_some_and(|error| error <= 0.05), "{:?}", estimate(&window));
    click(&mut window, words::STATISTICS);
    for row in ["9 of 10 surfaces within", "Local error p50, p90, p95", "…of the bare mesh"] {
        assert!(window.query_by_label(row).is_some(), "{row}");
    }
    window.get_by_role_and_label(Role::Slider, words::parameter(ParameterId::Error)).set_value_accesskit(0.02);
    until(&mut window, "a finer solution", |window| {
        window.state().status().run == RunState::Finished && estimate(window).is_some_and(|error| error <= 0.02)
    });
    assert!(vertices(&window) > usual);
    assert!(window.query_by_label_contains(words::TARGET_REACHED).is_some());
    click(&mut window, words::METHOD);
    click(&mut window, words::STOP_AT_THRESHOLD);
    until(&mut window, "a solution by ε", |window| {
        window.state().status().run == RunState::Finished && estimate(window).is_none()
    });
    // The links are there; what they are worth is measured, and shown with its standard error.
    until(&mut window, "its error", |window| {
        let said = window.query_by_label_contains(words::LINKS_SETTLED).map(|node| format!("{node:?}"));
        said.is_some_and(|said| said.contains(words::SURFACES_WITHIN) && said.contains('±'))
    });
    click(&mut window, words::DRAFT);
    until(&mut window, "a draft", |window| {
        window.state().status().params.error == Some(0.2) && window.state().status().run == RunState::Finished
    });
}

#[test]
fn the_picture_is_compared_with_a_reference() {
    let mut window = cornell(coarse());
    finish(&mut window);
    let lit = picture(&mut window);
    click(&mut window, words::ACCURACY);
    click(&mut window, words::COMPARE_WITH_REFERENCE);
    until(&mut window, "an error", |window| window.query_by_label("Error (RMS)").is_some());
    for row in ["Local error, 9 of 10", "…p50, p95"] {
        assert!(window.query_by_label(row).is_some(), "{row}");
    }
    assert!(window.query_all_by_label_contains("noise").next().is_some());
    click(&mut window, "difference");
    let differences = picture(&mut window);
    assert!(share_of_different_pixels(&lit, &differences) > 0.2, "the walls show their errors");
    click(&mut window, "error");
    let errors = picture(&mut window);
    assert!(share_of_different_pixels(&differences, &errors) > 0.2);
    // A finer ε is a run of its own.
    let curves = |window: &Harness<'static, App>| window.query_all_by_label_contains("Φ, adaptive, immediate").count();
    assert_eq!(curves(&window), 1);
    window.get_by_role_and_label(Role::Slider, words::parameter(ParameterId::Epsilon)).set_value_accesskit(2e-3);
    until(&mut window, "a second curve", |window| curves(window) == 2);
    click(&mut window, "light");
    assert_eq!(window.query_all_by_label_contains("grey: unknown").count(), 0);
    click(&mut window, words::STOP_COMPARING);
    until(&mut window, "the offer", |window| window.query_by_label(words::COMPARE_WITH_REFERENCE).is_some());
    assert!(share_of_different_pixels(&picture(&mut window), &lit) < 0.5, "the light is back");
    if let Some(folder) = std::env::var_os("SELFLINK_KEEP_PICTURES") {
        errors.save(std::path::Path::new(&folder).join("errors.png")).expect("a picture is kept");
        differences.save(std::path::Path::new(&folder).join("differences.png")).expect("a picture is kept");
        window.render().expect("a frame").save(std::path::Path::new(&folder).join("frame.png")).expect("kept");
    }
}
