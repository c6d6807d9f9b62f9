//! Keys, themes and sizes.

use egui::Key;
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use selflink::app::{App, words};
use selflink::scene::Source;
use selflink::scene::builtin::BuiltinScene;
use selflink::solve::{Epsilon, SolverParams};
use selflink::worker::RunState;

use crate::support::{click, coarse, cornell, finish, until, window};

fn press(window: &mut Harness<'static, App>, key: Key) {
    window.key_press(key);
    window.run_steps(2);
}

#[test]
fn the_list_of_keys_opens_and_closes() {
    let mut window = cornell(coarse());
    press(&mut window, Key::Questionmark);
    assert!(window.query_by_label("keep the solution as A").is_some());
    press(&mut window, Key::Escape);
    assert!(window.query_by_label("keep the solution as A").is_none());
    window.get_by_label(words::KEYS).click();
    window.run_steps(2);
    assert!(window.query_by_label("keep the solution as A").is_some());
}

#[test]
fn keys_drive_the_solver_and_the_tools() {
    let params = SolverParams { epsilon: Epsilon::Relative(1e-4), ..SolverParams::default() };
    let mut window = window(Some(Source::Builtin(BuiltinScene::from_name("seminar").expect("ours"))), params);
    until(&mut window, "the first picture", |window| window.state().snapshot().is_some());
    press(&mut window, Key::Space);
    until(&mut window, "the pause", |window| window.state().status().run == RunState::Paused);
    let serial = window.state().snapshot().expect("a picture").serial;
    press(&mut window, Key::Period);
    until(&mut window, "a step", |window| window.state().snapshot().is_some_and(|shown| shown.serial > serial));
    until(&mut window, "its end", |window| window.state().status().run == RunState::Paused);
    press(&mut window, Key::Space);
    until(&mut window, "going on", |window| window.state().status().run != RunState::Paused);
    press(&mut window, Key::Num6);
    assert!(window.query_by_label("Mesh (GLB)").is_some());
    press(&mut window, Key::X);
    assert!(window.query_by_label(words::DISCARD_A).is_some());
    press(&mut window, Key::Num5);
    assert!(window.query_by_label(words::DISCARD_A).is_none(), "the same key closes the tool");
    // Keys that are typed into a field are text.
    window.get_by_label(words::SCENE_PATH).focus();
    window.run_steps(1);
    press(&mut window, Key::Num6);
    assert!(window.query_by_label("Mesh (GLB)").is_none());
}

#[test]
fn the_full_picture_hides_all_panels_and_gives_them_back() {
    let mut window = cornell(coarse());
    let narrow = window.state().view_rect();
    press(&mut window, Key::F11);
    assert_eq!(window.state().view_rect().size(), egui::vec2(1280.0, 800.0));
    assert!(window.query_by_label(words::SHOW_PANELS).is_none(), "the picture is alone");
    window.hover_at(egui::pos2(300.0, 20.0));
    window.run_steps(2);
    click(&mut window, words::SHOW_PANELS);
    assert_eq!(window.state().view_rect(), narrow);
}

/// Truth: the window's own commands to the system, and the pixels of the view: nothing lies over
/// them.
#[test]
fn f11_takes_the_whole_screen_and_escape_gives_it_back() {
    let mut window = cornell(coarse());
    finish(&mut window);
    let centre = window.state().view_rect().center();
    window.drag_at(centre);
    window.drop_at(centre);
    until(&mut window, "the tag", |window| window.query_by_label(words::DETAILS).is_some());
    let asked = |window: &Harness<'static, App>, is_full: bool| {
        let viewports = window.output().viewport_output.values();
        let mut commands = viewports.flat_map(|viewport| viewport.commands.iter());
        commands.any(|command| *command == egui::ViewportCommand::Fullscreen(is_full))
    };
    // Alone, so that the frame behind it is the last one.
    let key = |key, pressed| egui::Event::Key {
        key,
        physical_key: None,
        pressed,
        repeat: false,
        modifiers: egui::Modifiers::NONE,
    };
    window.event(key(Key::F11, true));
    window.step();
    assert!(asked(&window, true));
    window.event(key(Key::F11, false));
    window.step();
    for hidden in [words::DETAILS, words::SETTINGS, words::STEP_OF_THE_SOLVE] {
        assert!(window.query_by_label(hidden).is_none(), "{hidden}");
    }
    window.event(key(Key::Escape, true));
    window.step();
    assert!(asked(&window, false));
    window.event(key(Key::Escape, false));
    window.step();
    assert!(window.query_by_label(words::DETAILS).is_some(), "the selection is as it was");
    press(&mut window, Key::Escape);
    assert!(window.query_by_label(words::DETAILS).is_none() && window.state().picked_element().is_none());
}

/// Truth: the pixels of the left panel.
#[test]
fn the_theme_and_the_size_are_a_persons_choice() {
    let mut window = cornell(coarse());
    finish(&mut window);
    let corner = |window: &mut Harness<'static, App>| {
        window.step();
        let frame = window.render().expect("a frame");
        frame.get_pixel(3, frame.height() / 2).0[..3].iter().map(|channel| u32::from(*channel)).sum::<u32>()
    };
    let dark = corner(&mut window);
    click(&mut window, words::APPEARANCE);
    click(&mut window, words::LIGHT_THEME);
    assert!(dark < 150 && corner(&mut window) > 600, "{dark}");
    click(&mut window, words::DARK_THEME);
    assert_eq!(corner(&mut window), dark);
    let before = window.state().view_rect().width();
    window.get_by_label(words::UI_SCALE).scroll_to_me();
    window.run_steps(6);
    window.get_by_role_and_label(egui::accesskit::Role::ComboBox, words::UI_SCALE).click();
    window.run_steps(2);
    click(&mut window, "125 %");
    window.run_steps(2);
    assert!(window.state().view_rect().width() < before, "fewer points fit");
}
