//! Windows from small to large: the view keeps at least half of the width, and every tool stays within reach.
//!
//! Truth: rectangles of widgets, by accessible names.

use egui::accesskit::Role;
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT, Queryable};
use selflink::app::{App, words};
use selflink::scene::Source;
use selflink::scene::builtin::BuiltinScene;

use crate::support::{coarse, finish, until, window_of_size};

const TOOLS: [&str; 6] =
    [words::INSPECTOR, words::LINK_MATRIX, words::CLUSTERS, words::MEASURE, words::COMPARE, words::EXPORT];

/// A window of so many pixels at an interface scale.
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
