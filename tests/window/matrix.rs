//! The link matrix.

use egui::Key;
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT, Queryable};
use selflink::app::{App, words};
use selflink::solve::{Epsilon, SolverParams};

use crate::support::{click, cornell, finish, until};

/// The matrix of a coarse Cornell box, all of it in view.
fn opened() -> Harness<'static, App> {
    let mut window = cornell(SolverParams { epsilon: Epsilon::Relative(1e-2), ..SolverParams::default() });
    finish(&mut window);
    click(&mut window, words::LINK_MATRIX);
    let links = window.state().snapshot().expect("a picture").stats.links;
    until(&mut window, "its numbers", |window| says(window, &format!("{links} links")));
    window
}

fn says(window: &Harness<'static, App>, text: &str) -> bool {
    window.query_all_by_label(text).next().is_some()
}

/// A point of the square, from 0 to 1 each way.
fn place(window: &Harness<'static, App>, column: f32, row: f32) -> egui::Pos2 {
    let square = window.get_by_label("Matrix of links").rect();
    square.min + egui::vec2(column, row) * square.size()
}

/// Truth: the first step is the root's self-link, which fills the square and is what lies under the
/// mouse wherever it points.
#[test]
fn the_first_step_is_one_full_square() {
    let mut window = opened();
    let track = window.get_by_label(words::STEP_OF_THE_SOLVE).rect();
    let first = track.left_center() + egui::vec2(8.0, 0.0);
    window.drag_at(first);
    window.drop_at(first);
    until(&mut window, "one link", |window| says(window, "1 link") && says(window, "0 % empty"));
    let at = place(&window, 0.8, 0.3);
    window.hover_at(at);
    until(&mut window, "what it is", |window| says(window, "Light that it exchanges within itself."));
    assert_eq!(window.query_all_by_label("the whole scene").count(), 2, "it is its own source");
    click(&mut window, words::LATEST);
    until(&mut window, "more links", |window| !says(window, "1 link"));
}

/// Truth: a wall neither lights itself nor is without light of others; the receiver of what was
/// clicked is picked.
#[test]
fn blocks_are_hovered_and_clicked() {
    let mut window = opened();
    let solution_view =
        window.state().snapshot().expect("a picture").solution_view.clone().expect("the tool asked for it");
    let (order, hierarchy) = (solution_view.order(selflink::hierarchy::Room::Area), solution_view.hierarchy());
    let middle = |id| order.span(id).into_iter().sum::<f64>() as f32 * 0.5;
    let width = |id| order.span(id)[1] - order.span(id)[0];
    let patches = hierarchy.initial_patches().iter().copied();
    let wall = patches.max_by(|&one, &other| width(one).total_cmp(&width(other))).expect("there are walls");
    let at = place(&window, middle(wall), middle(wall));
    window.hover_at(at);
    until(&mut window, "no link", |window| window.query_by_label_contains("No link:").is_some());

    let room = |link: &selflink::transport::LinkView| width(link.receiver) * width(link.source);
    let largest = solution_view.all_links().max_by(|one, other| room(one).total_cmp(&room(other))).expect("links");
    let at = place(&window, middle(largest.source), middle(largest.receiver));
    window.hover_at(at);
    until(&mut window, "a link", |window| says(window, words::FORM_FACTOR) && says(window, words::STRONGEST_CHANNEL));
    window.drag_at(at);
    window.drop_at(at);
    until(&mut window, "its receiver", |window| says(window, words::DETAILS));
}

/// Truth: the wheel magnifies, and all is in view again where that was asked for; every colouring
/// has a legend of its own.
#[test]
fn the_matrix_is_magnified_and_coloured() {
    let mut window = opened();
    let at = place(&window, 0.5, 0.5);
    window.hover_at(at);
    window.step();
    let is_magnified = |window: &Harness<'static, App>| window.query_by_label_contains("Show all").is_some();
    assert!(!is_magnified(&window));
    window.key_press(Key::Plus);
    until(&mut window, "a part of it", is_magnified);
    window.key_press(Key::Home);
    until(&mut window, "all of it", |window| !is_magnified(window));
    window.event(egui::Event::MouseWheel {
        unit: egui::MouseWheelUnit::Point,
        delta: egui::vec2(0.0, 120.0),
        phase: egui::TouchPhase::Move,
        source: egui::MouseWheelSource::Unknown,
        modifiers: egui::Modifiers::NONE,
    });
    until(&mut window, "a part of it", is_magnified);
    let button = window.get_by_label_contains("Show all").rect().center();
    window.drag_at(button);
    window.drop_at(button);
    until(&mut window, "all of it", |window| !is_magnified(window));
    for (colouring, legend) in [
        ("visibility", "visibility V"),
        ("level", "refinements on the way from the root's self-link"),
        ("rays", "rays that the visibility is known by"),
        ("power", "power per area of both ends, 1 = Φ spread evenly"),
    ] {
        // The status bar has some of these words too.
        let switch = |node: &egui_kittest::Node<'_>| node.accesskit_node().role() == egui::accesskit::Role::Button;
        window.get_all_by_label(colouring).find(switch).expect("a switch").click();
        until(&mut window, legend, |window| says(window, legend));
    }
}
