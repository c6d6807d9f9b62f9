//! The inspector, and links over the view.

use egui::accesskit::Role;
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT, Queryable};
use selflink::app::{App, words};
use selflink::hierarchy::{ElementId, Shape};
use selflink::read::names::of_polygon;
use selflink::solve::SolverParams;
use selflink::transport::SolutionView;

use crate::support::{click, coarse, cornell, finish, keep, link_choice, picture, share_of_different_pixels, until};

/// A finished Cornell box with the inspector open on what lies in the middle of the view.
fn inspected() -> Harness<'static, App> {
    let mut window = cornell(coarse());
    finish(&mut window);
    // All columns of its table have room then.
    click(&mut window, words::SETTINGS);
    click(&mut window, words::INSPECTOR);
    pick_the_middle(&mut window);
    window
}

fn pick_the_middle(window: &mut Harness<'static, App>) {
    window.run_steps(2);
    let centre = window.state().view_rect().center();
    window.drag_at(centre);
    window.drop_at(centre);
    until(window, "its links", |window| window.query_by_label_contains("links bring").is_some());
}

fn solution_view(window: &Harness<'static, App>) -> std::sync::Arc<SolutionView> {
    window.state().snapshot().and_then(|snapshot| snapshot.solution_view.clone()).expect("the inspector asked for it")
}

fn element(window: &Harness<'static, App>) -> ElementId {
    window.state().picked_element().expect("something is picked")
}

/// The text of the one label that contains this.
fn text(window: &Harness<'static, App>, part: &str) -> String {
    let node = window.get_by_label_contains(part);
    node.accesskit_node().label().or_else(|| node.accesskit_node().value()).expect("a text")
}

fn number_before(text: &str, unit: &str) -> f32 {
    let before = text.split(unit).next().expect("a number stands before its unit");
    let digits = before.split_whitespace().last().expect("a number");
    digits.replace(',', "").parse().expect("a number")
}

/// Names of the table's rows from above to below.
fn rows(window: &Harness<'static, App>) -> Vec<(f32, String)> {
    let rows = window.query_all_by_label_contains("Link from: ");
    let mut rows: Vec<(f32, String)> =
        rows.map(|row| (row.rect().top(), row.accesskit_node().label().expect("a name"))).collect();
    rows.sort_by(|a, b| a.0.total_cmp(&b.0));
    rows.dedup_by(|a, b| a.0 == b.0);
    rows
}

/// Truth: E of the element, which its links add up to.
#[test]
fn what_links_bring_adds_up_to_the_irradiance() {
    let mut window = inspected();
    for climb in 0..3 {
        let said = number_before(&text(&window, "links bring"), " W/m²");
        let irradiance = solution_view(&window).irradiance(element(&window)).max_element();
        assert!((said / irradiance - 1.0).abs() < 0.02, "{climb} levels up: {said} of {irradiance} W/m²");
        click(&mut window, words::UP);
    }
}

/// Truth: the hierarchy's own path.
#[test]
fn the_breadcrumb_climbs_to_the_root_and_back() {
    let mut window = inspected();
    assert!(window.query_by_label(words::SELECTED_ELEMENT).is_none(), "the inspector tells more than the card");
    let first = element(&window);
    let path = solution_view(&window).path(first);
    assert!(path.len() >= 3, "{path:?}");
    click(&mut window, words::UP);
    assert_eq!(element(&window), path[path.len() - 2]);
    click(&mut window, "scene");
    assert_eq!(element(&window), path[0]);
    assert!(window.query_by_label("the whole scene").is_some());
    assert!(window.get_by_label(words::UP).accesskit_node().is_disabled());
    click(&mut window, words::BACK);
    click(&mut window, words::BACK);
    assert_eq!(element(&window), first);
    click(&mut window, words::CLOSE_TOOL);
    click(&mut window, words::DETAILS);
    window.run_steps(2);
    assert!(window.query_by_label(words::SELECTED_ELEMENT).is_some(), "the card is there on request");
    click(&mut window, words::INSPECT);
    assert!(window.query_by_label(words::BACK).is_some());
}

/// Truth: the order of the names, and the strongest source.
#[test]
fn rows_are_sorted_by_what_is_clicked() {
    let mut window = inspected();
    let by_light = rows(&window);
    assert!(by_light.len() > 5, "{by_light:?}");
    click(&mut window, "Sort by name");
    let names: Vec<String> = rows(&window).into_iter().map(|(_, name)| name).collect();
    assert!(names.is_sorted(), "{names:?}");
    click(&mut window, "Sort by name");
    let names: Vec<String> = rows(&window).into_iter().map(|(_, name)| name).collect();
    assert!(names.is_sorted_by(|a, b| a >= b), "{names:?}");
    for column in ["level", "form factor", "visibility", "rays", "power", "share of ε", "error estimate"] {
        click(&mut window, &format!("Sort by {column}"));
        assert_eq!(rows(&window).len(), by_light.len(), "by {column}");
    }
    click(&mut window, "Sort by what it brings");
    assert_eq!(rows(&window), by_light);
}

/// Truth: pixels, and the solution_view: a row's source is what a click walks to.
#[test]
fn a_row_marks_its_link_and_leads_to_its_source() {
    let mut window = inspected();
    let plain = picture(&mut window);
    let strongest = rows(&window).swap_remove(0);
    let rect = window.query_all_by_label(&strongest.1).next().expect("the row").rect();
    let before = element(&window);
    window.hover_at(rect.center());
    window.run_steps(3);
    let view = window.state().view_rect();
    let whole = window.render().expect("a frame can be drawn");
    let [x, y, width, height] = [view.min.x, view.min.y, view.width(), view.height()].map(|points| points as u32);
    let marked = image::imageops::crop_imm(&whole, x, y, width, height).to_image();
    let share = share_of_different_pixels(&plain, &marked);
    assert!((0.0005..0.3).contains(&share), "{share} of the view is marked");

    let links = solution_view(&window).all_incoming(before);
    let strongest = links.iter().max_by(|a, b| a.irradiance.max_element().total_cmp(&b.irradiance.max_element()));
    window.drag_at(rect.center());
    window.drop_at(rect.center());
    window.run_steps(3);
    assert_eq!(Some(element(&window)), strongest.map(|link| link.source));
    click(&mut window, words::BACK);
    assert_eq!(element(&window), before);
}

/// Truth: a lamp sends, and its receivers get, what the other direction says of them.
#[test]
fn both_directions_are_told() {
    let mut window = inspected();
    let brought = text(&window, "links bring");
    click(&mut window, words::WHAT_THIS_LIGHTS);
    assert!(window.query_by_label_contains("links bring").is_none());
    let carried = number_before(&text(&window, "links carry"), " W");
    let (solution_view, id) = (solution_view(&window), element(&window));
    let sum: glam::Vec3 = solution_view
        .all_outgoing(id)
        .iter()
        .map(|link| link.irradiance * solution_view.hierarchy().element(link.receiver).area)
        .sum();
    assert!((carried / sum.element_sum() - 1.0).abs() < 0.02, "{carried} of {sum} W in all channels");
    assert!(window.query_all_by_label_contains("Link to: ").next().is_some());
    click(&mut window, words::WHAT_LIGHTS_THIS);
    assert_eq!(text(&window, "links bring"), brought);
}

/// Truth: the words against the solution_view's own counts, and pixels.
#[test]
fn links_over_the_view_are_filtered_and_the_rest_is_said() {
    let mut window = cornell(coarse());
    finish(&mut window);
    let plain = picture(&mut window);
    click(&mut window, &link_choice(words::LINKS_AT_LEVEL));
    until(&mut window, "links of a level", |window| window.query_by_label_contains("drawn").is_some());
    window.get_by_role_and_label(Role::Slider, words::RECEIVERS_AT_LEVEL).set_value_accesskit(3.0);
    window.run_steps(3);
    let count = solution_view(&window).links_at_depth(3).count();
    assert!(count > 20, "{count} links");
    let all = picture(&mut window);
    assert!(share_of_different_pixels(&plain, &all) > 0.01);
    window.get_by_role_and_label(Role::Slider, words::STRONGEST_LINKS).set_value_accesskit(10.0);
    window.run_steps(3);
    let said = text(&window, " drawn");
    assert!(said.starts_with(&format!("10 of {count} links drawn, ")) && said.contains("% of the power"), "{said}");
    assert!(share_of_different_pixels(&plain, &picture(&mut window)) < share_of_different_pixels(&plain, &all));
    click(&mut window, words::PATCH_PATCH);
    assert!(text(&window, " drawn").contains("filtered out"));
    click(&mut window, "Link colour: visibility");
    assert!(window.query_by_label_contains("drawn").is_some());
    click(&mut window, &link_choice(words::LINKS_NONE));
    assert!(window.query_by_label_contains("drawn").is_none());
    assert_eq!(share_of_different_pixels(&plain, &picture(&mut window)), 0.0, "without links it is as before");
}

/// Truth: the solution view: one name and one level of an element, and E by the final gather beside
/// that by links.
#[test]
fn an_element_is_told_alike_in_tag_card_inspector_and_tree() {
    let mut window = cornell(SolverParams { error: Some(0.1), ..SolverParams::usual() });
    finish(&mut window);
    click(&mut window, words::SETTINGS);
    window.run_steps(2);
    let centre = window.state().view_rect().center() - egui::vec2(0.0, 100.0);
    window.drag_at(centre);
    window.drop_at(centre);
    until(&mut window, "the tag", |window| window.query_by_label(words::DETAILS).is_some());
    let shown = |window: &Harness<'static, App>| {
        let names = window.query_all_by_label_contains(" (").filter_map(|node| {
            let node = node.accesskit_node();
            node.label().or_else(|| node.value()).filter(|name| name.ends_with(')'))
        });
        names.collect::<Vec<_>>()
    };
    let scene = window.state().scene_info().expect("a scene").scene.clone();
    let element = element(&window);
    click(&mut window, words::DETAILS);
    until(&mut window, "its links", |window| window.query_by_label_contains(words::TOP_SOURCES).is_some());
    let view = solution_view(&window);
    let Shape::Patch(patch) = &view.hierarchy().element(element).shape else { panic!("a patch was clicked") };
    let name = of_polygon(&scene, patch.polygon);
    let level = format!("{} of {}", view.depth(element), view.deepest());
    for place in ["card", "inspector"] {
        assert!(shown(&window).contains(&name), "{place}: {name} is not among {:?}", shown(&window));
        for label in [words::LEVEL, &level, words::E_BY_GATHER, words::E_BY_LINKS] {
            assert!(window.query_all_by_label(label).next().is_some(), "{place}: {label}");
        }
        keep(&mut window, place);
        if place == "card" {
            click(&mut window, words::INSPECT);
            window.run_steps(3);
        }
    }
    click(&mut window, words::CLUSTERS);
    until(&mut window, "its row", |window| window.query_all_by_label(&name).next().is_some());
    keep(&mut window, "tree");
}
