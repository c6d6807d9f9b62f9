//! Windows from small to large: the view keeps at least half of the width, and every tool stays
//! within reach.
//!
//! Truth: rectangles of widgets, by accessible names.

use egui::accesskit::Role;
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT, Queryable};
use selflink::app::{App, words};
use selflink::scene::Source;
use selflink::scene::builtin::BuiltinScene;

use crate::support::{choose, click, coarse, finish, keep, link_choice, until, window_of_size};

const TOOLS: [&str; 6] =
    [words::INSPECTOR, words::LINK_MATRIX, words::CLUSTERS, words::MEASURE, words::COMPARE, words::EXPORT];

/// A window of so many pixels at a UI scale.
fn opened([width, height]: [f32; 2], scale: f32) -> Harness<'static, App> {
    let size = [width / scale, height / scale];
    let mut window = window_of_size(size, Some(Source::Builtin(BuiltinScene::Cornell)), coarse());
    until(&mut window, "the first picture", |window| window.state().snapshot().is_some());
    finish(&mut window);
    window
}

/// Opens a tool by its switch, in the menu where there is one.
fn open(window: &mut Harness<'static, App>, tool: &str) {
    if window.query_by_role_and_label(Role::Button, tool).is_none() {
        window.get_by_label(words::TOOLS).click();
        window.run_steps(3);
    }
    window.get_by_role_and_label(Role::Button, tool).click();
    window.run_steps(6);
}

fn check_sizes(size: [f32; 2], scale: f32) {
    let mut window = opened(size, scale);
    let all = egui::Rect::from_min_size(egui::Pos2::ZERO, egui::vec2(size[0] / scale, size[1] / scale));
    for tool in TOOLS {
        open(&mut window, tool);
        let view = window.state().view_rect();
        let said = format!("{tool} in {size:?} at {scale}");
        assert!(view.width() >= 0.5 * all.width() - 1.0, "{said}: the view has {} of {}", view.width(), all.width());
        assert!(view.height() >= 0.5 * all.height(), "{said}: the view is {} high", view.height());
        let close = window.get_by_label(words::CLOSE_TOOL).rect();
        assert!(all.contains_rect(close) && !view.intersects(close), "{said}: {close:?}");
        // What can be used lies beside the view; what lies over it is not of a panel.
        for role in [Role::Button, Role::CheckBox, Role::Slider, Role::ComboBox, Role::TextInput, Role::SpinButton] {
            for node in window.query_all_by_role(role) {
                let rect = node.rect();
                let is_beside = rect.left() >= view.right() - 1.0 || rect.right() <= view.left() + 1.0;
                let is_in_bars = rect.bottom() <= view.top() + 1.0 || rect.top() >= view.bottom() - 1.0;
                let name = node.accesskit_node().label();
                assert!(is_beside || is_in_bars, "{said}: {name:?} at {rect:?} lies over the view {view:?}");
                let is_whole = rect.left() >= -1.0 && rect.right() <= all.right() + 1.0;
                assert!(is_whole, "{said}: {name:?} at {rect:?} leaves the window");
            }
        }
        window.get_by_label(words::CLOSE_TOOL).click();
        window.run_steps(3);
    }
    // The settings are one click away, whatever was open.
    if window.query_by_label(words::QUALITY).is_none() {
        window.get_by_label(words::SETTINGS).click();
        window.run_steps(3);
    }
    assert!(window.query_by_label(words::QUALITY).is_some());
}

#[test]
fn every_tool_fits_into_a_small_window() {
    check_sizes([1024.0, 700.0], 1.0);
}

#[test]
fn every_tool_fits_at_one_and_a_half() {
    check_sizes([1024.0, 700.0], 1.5);
}

#[test]
fn every_tool_fits_into_a_large_window() {
    check_sizes([3840.0, 2160.0], 1.0);
}

/// Buttons of the bar above the view lie side by side.
#[test]
fn nothing_in_the_bar_lies_over_another() {
    for (size, scale) in [([800.0, 600.0], 1.0), ([1024.0, 700.0], 1.5), ([1024.0, 700.0], 1.0), ([1280.0, 800.0], 1.0)]
    {
        let window = opened(size, scale);
        let view = window.state().view_rect();
        let in_bar =
            |node: &egui_kittest::Node<'_>| node.rect().bottom() <= view.top() && node.rect().right() > view.left();
        let buttons: Vec<_> = window.query_all_by_role(Role::Button).filter(in_bar).collect();
        assert!(buttons.len() >= 6, "{} buttons", buttons.len());
        for (index, one) in buttons.iter().enumerate() {
            for other in &buttons[index + 1..] {
                let names = [one, other].map(|node| node.accesskit_node().label());
                let apart = !one.rect().shrink(0.5).intersects(other.rect());
                assert!(apart, "{names:?} in {size:?} at {scale}: {:?} {:?}", one.rect(), other.rect());
            }
        }
    }
}

/// What lies over the view lies side by side, with a selection, a measured plane, false colours and
/// links.
fn check_overlays(size: [f32; 2], scale: f32) {
    let mut window = opened(size, scale);
    choose(&mut window, words::DISPLAY, words::ILLUMINANCE);
    click(&mut window, &link_choice(words::LINKS_AT_LEVEL));
    open(&mut window, words::MEASURE);
    click(&mut window, words::MEASURE_PLANE);
    until(&mut window, "the plane", |window| window.query_by_label(words::UNIFORMITY).is_some());
    let view = window.state().view_rect();
    // The room lies in the middle of every view.
    for share in [egui::vec2(0.5, 0.3), egui::vec2(0.42, 0.55), egui::vec2(0.56, 0.4)] {
        let at = view.min + share * view.size();
        window.drag_at(at);
        window.drop_at(at);
        until(&mut window, "the tag", |window| window.query_by_label(words::DETAILS).is_some());
        window.hover_at(at + egui::vec2(-3.0, -3.0));
        wait_for_readout(&mut window, size);
        check_apart(&window, &format!("tag in {size:?} at {scale}"));
    }
    window.get_by_label(words::DETAILS).click();
    until(&mut window, "the card", |window| window.query_by_label(words::SELECTED_ELEMENT).is_some());
    window.hover_at(view.left_center() + egui::vec2(20.0, 0.0));
    wait_for_readout(&mut window, size);
    check_apart(&window, &format!("card in {size:?} at {scale}"));
    keep(&mut window, &format!("overlays-{}-{scale}", size[0]));
}

/// Waits for the readout under the pointer, which is left out where a small view has no room for
/// it.
fn wait_for_readout(window: &mut Harness<'static, App>, [width, _]: [f32; 2]) {
    if width > 1500.0 {
        until(window, "the readout", |window| window.state().overlays().iter().any(|(name, _)| *name == "readout"));
    }
    window.run_steps(12);
}

fn check_apart(window: &Harness<'static, App>, said: &str) {
    let (view, all) = (window.state().view_rect(), window.state().overlays());
    assert!(all.len() >= 2, "{said}: {all:?}");
    for (index, (name, rect)) in all.iter().enumerate() {
        assert!(view.expand(1.0).contains_rect(*rect), "{said}: {name} at {rect:?} leaves the view {view:?}");
        for (other, beside) in &all[index + 1..] {
            assert!(
                !rect.shrink(1.0).intersects(*beside),
                "{said}: {name} at {rect:?} lies over {other} at {beside:?}"
            );
        }
    }
}

#[test]
fn overlays_lie_side_by_side_in_a_small_window() {
    check_overlays([1024.0, 700.0], 1.0);
}

#[test]
fn overlays_lie_side_by_side_at_one_and_a_half() {
    check_overlays([1024.0, 700.0], 1.5);
}

#[test]
fn overlays_lie_side_by_side_in_a_usual_window() {
    check_overlays([1920.0, 1080.0], 1.0);
}

/// Truth: where the pointer took hold of the border, and where it let go.
#[test]
fn panels_are_resized_by_their_borders() {
    let mut window = opened([1600.0, 900.0], 1.0);
    let drag = |window: &mut Harness<'static, App>, from: egui::Pos2, by: f32| {
        window.hover_at(from);
        window.run_steps(2);
        window.drag_at(from);
        window.run_steps(2);
        window.hover_at(from + egui::vec2(by, 0.0));
        window.run_steps(2);
        window.drop_at(from + egui::vec2(by, 0.0));
        window.run_steps(3);
    };
    let before = window.state().view_rect();
    drag(&mut window, before.left_center() - egui::vec2(2.0, 0.0), 60.0);
    let wider = window.state().view_rect();
    assert!((wider.left() - before.left() - 60.0).abs() < 3.0, "{before:?} {wider:?}");
    open(&mut window, words::MEASURE);
    // The view keeps its half: the tool can but be made narrower.
    let before = window.state().view_rect();
    drag(&mut window, before.right_center() + egui::vec2(2.0, 0.0), 15.0);
    let after = window.state().view_rect();
    assert!((after.right() - before.right() - 15.0).abs() < 3.0, "{before:?} {after:?}");
}
