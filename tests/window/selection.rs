//! The selected element: its outline in the view, and its card.
//!
//! Truth: pixels of the picture, and the element's own facts.

use egui_kittest::kittest::{NodeT, Queryable};
use selflink::app::words;

use crate::support::{click, coarse, cornell, finish, picture, until};

/// No links are asked for.
#[test]
fn what_is_clicked_is_outlined_at_once_and_quietly() {
    let mut window = cornell(coarse());
    finish(&mut window);
    let before = picture(&mut window);
    let view = window.state().view_rect();
    let at = view.center();
    window.drag_at(at);
    window.drop_at(at);
    until(&mut window, "the tag", |window| window.query_by_label(words::DETAILS).is_some());
    let after = picture(&mut window);
    let overlays: Vec<egui::Rect> = window.state().overlays().iter().map(|(_, rect)| rect.expand(12.0)).collect();
    let is_free = |x: u32, y: u32| {
        let at = view.min + egui::vec2(x as f32, y as f32);
        !overlays.iter().any(|rect| rect.contains(at))
    };
    let changed =
        before.enumerate_pixels().zip(after.pixels()).filter(|((x, y, one), other)| is_free(*x, *y) && one != other);
    let count = changed.count();
    assert!(count > 60, "{count} pixels of an outline");
    assert!(count < 20_000, "{count} pixels: a line and no more");
    assert!(
        window.state().snapshot().is_some_and(|snapshot| snapshot.solution_view.is_none()),
        "no links were asked for"
    );
}

#[test]
fn the_card_tells_the_mean_illuminance() {
    let mut window = cornell(coarse());
    finish(&mut window);
    let at = window.state().view_rect().center();
    window.drag_at(at);
    window.drop_at(at);
    until(&mut window, "the tag", |window| window.query_by_label(words::DETAILS).is_some());
    click(&mut window, words::DETAILS);
    until(&mut window, "the card", |window| window.query_by_label(words::MEAN_ILLUMINANCE).is_some());
    let row = window.get_by_label(words::MEAN_ILLUMINANCE).rect().center().y;
    let is_beside = |node: &egui_kittest::Node<'_>| (node.rect().center().y - row).abs() < 4.0;
    let mut values = window.query_all_by_label_contains(" lx").filter(is_beside);
    let value = values.next().and_then(|node| node.accesskit_node().value().or(node.accesskit_node().label()));
    assert!(value.is_some_and(|value| value.ends_with(" lx")));
}
