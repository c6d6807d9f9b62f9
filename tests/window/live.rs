//! Lamps, materials and undo in the window, driven headless by accessible names as a person drives
//! them.
//!
//! Truth: what the worker says that it took up.

use egui::accesskit::Role;
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT, Queryable};
use selflink::app::{App, words};
use selflink::scene::Material;
use selflink::solve::{Epsilon, ParameterId};
use selflink::transport::Push;
use selflink::worker::RunState;

use crate::support::{choose, coarse, finish, until};

fn cornell() -> Harness<'static, App> {
    let mut window = crate::support::cornell(coarse());
    finish(&mut window);
    window
}

/// Scrolls a button into sight and clicks it.
fn click(window: &mut Harness<'static, App>, role: Role, label: &str) {
    window.get_by_role_and_label(role, label).scroll_to_me();
    // Scrolling is animated.
    window.run_steps(6);
    window.get_by_role_and_label(role, label).click();
    window.run_steps(2);
}

fn open_light(window: &mut Harness<'static, App>) {
    window.get_by_label(words::LIGHT).click();
    window.run_steps(4);
}

/// The first lamp of the scene, or the first material that once was one.
fn material(window: &Harness<'static, App>, name: &str) -> Material {
    let info = window.state().scene_info().expect("a scene");
    let id = info.scene.material_named(name).expect("a material of that name");
    info.scene.materials[id.0 as usize].clone()
}

fn lamp_name(window: &Harness<'static, App>) -> String {
    let info = window.state().scene_info().expect("a scene");
    let lamp = info.scene.materials.iter().find(|material| material.emission.max_element() > 0.0);
    lamp.expect("the Cornell box has a lamp").name.clone()
}

fn press(window: &mut Harness<'static, App>, modifiers: egui::Modifiers, key: egui::Key) {
    window.key_press_modifiers(modifiers, key);
    window.run_steps(2);
}

/// Truth: the scene's emission. A dimmer scales it, the switch takes it away and brings it back to
/// the bit, and so does undo.
#[test]
fn a_lamp_is_dimmed_switched_and_brought_back() {
    let mut window = cornell();
    open_light(&mut window);
    let lamp = lamp_name(&window);
    assert!(window.query_by_label_contains(", as when ε was set").is_some());
    let full = material(&window, &lamp).emission;
    let is = |window: &Harness<'static, App>, emission: glam::Vec3| material(window, &lamp).emission == emission;

    // A drag, in the midst of which the worker answers, is one step.
    let dimmer = window.get_by_role_and_label(Role::Slider, &format!("Dimmer of {lamp}")).rect();
    window.drag_at(dimmer.left_center() + egui::vec2(48.0, 0.0));
    window.step();
    for left in [60.0, 70.0, 80.0] {
        window.hover_at(dimmer.left_center() + egui::vec2(left, 0.0));
        until(&mut window, "a brighter lamp", |window| !is(window, full));
    }
    window.drop_at(dimmer.left_center() + egui::vec2(80.0, 0.0));
    window.run_steps(2);
    click(&mut window, Role::Button, words::UNDO);
    until(&mut window, "the light before the drag", |window| is(window, full));

    window.get_by_role_and_label(Role::Slider, &format!("Dimmer of {lamp}")).set_value_accesskit(50.0);
    until(&mut window, "half the light", |window| is(window, 0.5 * full));
    let is_offered = |window: &Harness<'static, App>| {
        let button = window.get_by_role_and_label(Role::Button, words::RESCALE_EPSILON);
        !button.accesskit_node().is_disabled()
    };
    until(&mut window, "the offer", is_offered);
    let stats = |window: &Harness<'static, App>| window.state().snapshot().expect("a picture").stats.clone();
    let watts = stats(&window).epsilon_watts;
    click(&mut window, Role::Button, words::RESCALE_EPSILON);
    until(&mut window, "half the ε", |window| (stats(window).epsilon_watts / watts - 0.5).abs() < 1e-6);
    assert!(!is_offered(&window));

    click(&mut window, Role::CheckBox, &lamp);
    until(&mut window, "darkness", |window| is(window, glam::Vec3::ZERO));
    click(&mut window, Role::CheckBox, &lamp);
    until(&mut window, "light again", |window| is(window, 0.5 * full));
    for expected in [glam::Vec3::ZERO, 0.5 * full, full] {
        click(&mut window, Role::Button, words::UNDO);
        until(&mut window, "the former light", |window| is(window, expected));
    }
}

/// Truth: the scene's reflectance and the light that the box then absorbs; no wall may give back
/// all that it gets.
#[test]
fn a_wall_takes_another_reflectance() {
    let mut window = cornell();
    open_light(&mut window);
    let lamp = lamp_name(&window);
    let before = material(&window, &lamp).reflectance;
    let slider = |window: &Harness<'static, App>| {
        window
            .get_by_role_and_label(Role::Slider, words::REFLECTANCE)
            .accesskit_node()
            .numeric_value()
            .expect("a number")
    };
    assert!((slider(&window) - f64::from(before.max_element())).abs() < 1e-6);
    window.get_by_role_and_label(Role::Slider, words::REFLECTANCE).set_value_accesskit(1.5);
    until(&mut window, "a bright surface", |window| material(window, &lamp).reflectance.max_element() > 0.9);
    assert!(material(&window, &lamp).reflectance.max_element() <= 0.99, "a mirror of all light would never settle");
    until(&mut window, "finishing", |window| window.state().status().run == RunState::Finished);
}

/// Truth: the parameters that the worker has. Keys and buttons walk back and forth, and a drag is
/// one step.
#[test]
fn settings_are_undone_and_redone() {
    let mut window = cornell();
    let epsilon = |window: &Harness<'static, App>| window.state().status().params.epsilon;
    let disabled = |window: &Harness<'static, App>, name: &str| {
        window.get_by_role_and_label(Role::Button, name).accesskit_node().is_disabled()
    };
    assert!(disabled(&window, words::UNDO) && disabled(&window, words::REDO), "nothing was set yet");

    window.get_by_role_and_label(Role::Slider, words::parameter(ParameterId::Epsilon)).set_value_accesskit(5e-3);
    until(&mut window, "a finer ε", |window| epsilon(window) == Epsilon::Relative(5e-3));
    choose(&mut window, words::parameter(ParameterId::Push), "deferred");
    until(&mut window, "another push", |window| window.state().status().params.push == Push::Deferred);
    click(&mut window, Role::CheckBox, words::ELEMENT_OUTLINES);

    press(&mut window, egui::Modifiers::COMMAND, egui::Key::Z);
    assert_eq!(window.state().status().params.push, Push::Deferred, "the outlines came last");
    press(&mut window, egui::Modifiers::COMMAND, egui::Key::Z);
    until(&mut window, "the former push", |window| window.state().status().params.push == Push::Immediate);
    click(&mut window, Role::Button, words::UNDO);
    until(&mut window, "the former ε", |window| epsilon(window) == Epsilon::Relative(1e-2));
    assert!(disabled(&window, words::UNDO));
    press(&mut window, egui::Modifiers::COMMAND | egui::Modifiers::SHIFT, egui::Key::Z);
    until(&mut window, "ε again", |window| epsilon(window) == Epsilon::Relative(5e-3));
    click(&mut window, Role::Button, words::REDO);
    until(&mut window, "push again", |window| window.state().status().params.push == Push::Deferred);

    // One drag over many values.
    window.get_by_role_and_label(Role::Slider, words::parameter(ParameterId::PartialFactor)).scroll_to_me();
    window.run_steps(6);
    let rect = window.get_by_role_and_label(Role::Slider, words::parameter(ParameterId::PartialFactor)).rect();
    window.drag_at(rect.left_center() + egui::vec2(8.0, 0.0));
    window.step();
    for step in 0..10 {
        window.hover_at(rect.left_center() + egui::vec2(8.0 + 5.0 * step as f32, 0.0));
        window.step();
    }
    window.drop_at(rect.left_center() + egui::vec2(58.0, 0.0));
    window.run_steps(2);
    until(&mut window, "a dragged factor", |window| window.state().status().params.partial_factor != 0.1);
    click(&mut window, Role::Button, words::UNDO);
    until(&mut window, "the whole drag", |window| window.state().status().params.partial_factor == 0.1);
}

/// Truth: the table of costs.
#[test]
fn a_tooltip_says_what_a_change_costs() {
    let mut window = cornell();
    window.get_by_role_and_label(Role::Slider, words::parameter(ParameterId::Epsilon)).scroll_to_me();
    window.run_steps(6);
    window.get_by_role_and_label(Role::Slider, words::parameter(ParameterId::Epsilon)).hover();
    until(&mut window, "the tooltip", |window| {
        window.query_by_label_contains("Lower tests links again; higher merges links back.").is_some()
    });
}

/// Truth: pixels. While a dimmer is dragged the exposure holds, so that less light is seen as less.
#[test]
fn a_lamp_is_seen_dimmer_while_it_is_dragged() {
    let mut window = cornell();
    open_light(&mut window);
    let lamp = lamp_name(&window);
    let name = format!("Dimmer of {lamp}");
    let dimmer = window.get_by_role_and_label(Role::Slider, &name).rect();
    let power = window.state().snapshot().expect("a picture").stats.power_watts;
    let brightness = |window: &mut Harness<'static, App>| {
        let view = window.state().view_rect();
        let frame = window.render().expect("a frame can be drawn");
        let [left, top, right, bottom] = [view.left(), view.top() + 60.0, view.right(), view.bottom() - 60.0];
        let mut sum = 0.0;
        for y in (top as u32..bottom as u32).step_by(4) {
            for x in (left as u32..right as u32).step_by(4) {
                sum += f64::from(frame.get_pixel(x, y)[1]);
            }
        }
        sum
    };
    let before = brightness(&mut window);
    window.drag_at(dimmer.left_center() + egui::vec2(40.0, 0.0));
    window.step();
    window.hover_at(dimmer.left_center() + egui::vec2(12.0, 0.0));
    until(&mut window, "a dim lamp", |window| {
        let stats = window.state().snapshot().map(|shown| (shown.stats.power_watts, shown.stats.converged));
        stats.is_some_and(|(now, is_done)| is_done && now > 0.0 && now < 0.4 * power)
    });
    window.run_steps(3);
    let held = brightness(&mut window);
    assert!(held < 0.8 * before, "{held} of {before}");
    window.drop_at(dimmer.left_center() + egui::vec2(12.0, 0.0));
    finish(&mut window);
    window.run_steps(4);
    let metered = brightness(&mut window);
    assert!(metered > held, "the exposure follows again: {metered} after {held}");
}
