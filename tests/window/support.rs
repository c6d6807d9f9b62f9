//! What the tests of the window share: opening one, waiting, clicking, looking.

use egui::accesskit::Role;
use egui_kittest::kittest::{NodeT, Queryable};
use egui_kittest::{Harness, Node};
use selflink::app::{App, words};
use selflink::prepare::added_light::AddedLight;
use selflink::scene::builtin::BuiltinScene;
use selflink::scene::{Reading, Source};
use selflink::solve::{Epsilon, SolverParams};
use selflink::worker::RunState;

use crate::waiting::wait_for;

pub fn coarse() -> SolverParams {
    SolverParams { epsilon: Epsilon::Relative(1e-2), ..SolverParams::default() }
}

pub fn window(source: Option<Source>, params: SolverParams) -> Harness<'static, App> {
    window_with(source.map(|source| (source, Reading::default(), AddedLight::default())), params)
}

pub fn window_with(opening: Option<(Source, Reading, AddedLight)>, params: SolverParams) -> Harness<'static, App> {
    open([1280.0, 800.0], opening, params)
}

pub fn window_of_size(size: [f32; 2], source: Option<Source>, params: SolverParams) -> Harness<'static, App> {
    open(size, source.map(|source| (source, Reading::default(), AddedLight::default())), params)
}

fn open(size: [f32; 2], opening: Option<(Source, Reading, AddedLight)>, params: SolverParams) -> Harness<'static, App> {
    Harness::builder()
        .with_size(size)
        .wgpu()
        .build_eframe(|cc| App::new(cc, opening, params).expect("a wgpu device and a thread are there"))
}

pub fn cornell(params: SolverParams) -> Harness<'static, App> {
    let mut window = window(Some(Source::Builtin(BuiltinScene::Cornell)), params);
    until(&mut window, "the first picture", |window| window.state().snapshot().is_some());
    window
}

/// Lets frames pass until the condition holds; the worker has its own pace.
pub fn until(window: &mut Harness<'static, App>, what: &str, mut holds: impl FnMut(&Harness<'static, App>) -> bool) {
    wait_for(what, || {
        window.step();
        holds(window).then_some(())
    });
    // Whatever was clicked last has been laid out.
    window.step();
}

/// The one widget of a name that can be clicked; texts may say the same word.
fn clickable<'w>(window: &'w Harness<'static, App>, label: &'w str) -> Node<'w> {
    let found: Vec<Node<'w>> = window.query_all_by_label(label).collect();
    let is_widget = |node: &Node<'w>| node.accesskit_node().role() != Role::Label;
    match found.len() {
        0 | 1 => window.get_by_label(label),
        _ => {
            let mut widgets = found.into_iter().filter(is_widget);
            let first = widgets.next().unwrap_or_else(|| panic!("{label} cannot be clicked"));
            assert!(widgets.next().is_none(), "there are several widgets {label}");
            first
        }
    }
}

/// Scrolls a widget into sight and clicks it.
pub fn click(window: &mut Harness<'static, App>, label: &str) {
    clickable(window, label).scroll_to_me();
    // Scrolling is animated.
    window.run_steps(6);
    clickable(window, label).click();
    window.run_steps(2);
}

/// Chooses from a list by its label.
pub fn choose(window: &mut Harness<'static, App>, list: &str, what: &str) {
    window.get_by_role_and_label(Role::ComboBox, list).scroll_to_me();
    window.run_steps(6);
    window.get_by_role_and_label(Role::ComboBox, list).click();
    window.run_steps(2);
    window.get_by_label(what).click();
    window.run_steps(3);
}

/// The accessible name of a choice whose links are drawn.
pub fn link_choice(name: &str) -> String {
    format!("{}: {name}", words::SHOW_LINKS)
}

pub fn finish(window: &mut Harness<'static, App>) {
    until(window, "finishing", |window| window.state().status().run == RunState::Finished);
}

/// Keeps the frame as a picture, where a folder for such is named, to be looked at.
pub fn keep(window: &mut Harness<'static, App>, name: &str) {
    if let Some(folder) = std::env::var_os("SELFLINK_KEEP_PICTURES") {
        let path = std::path::Path::new(&folder).join(format!("{name}.png"));
        window.render().expect("a frame").save(path).expect("kept");
    }
}

/// The pixels of the view.
pub fn picture(window: &mut Harness<'static, App>) -> image::RgbaImage {
    window.remove_cursor();
    window.step();
    let rect = window.state().view_rect();
    let whole = window.render().expect("a frame can be drawn");
    let [x, y, width, height] = [rect.min.x, rect.min.y, rect.width(), rect.height()].map(|points| points as u32);
    image::imageops::crop_imm(&whole, x, y, width, height).to_image()
}

pub fn share_of_different_pixels(one: &image::RgbaImage, other: &image::RgbaImage) -> f64 {
    assert_eq!(one.dimensions(), other.dimensions());
    let different = one.pixels().zip(other.pixels()).filter(|(one, other)| one != other).count();
    different as f64 / f64::from(one.width() * one.height())
}
