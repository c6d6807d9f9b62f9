//! The tool for clusters: colours and levels in the view, the tree, and groups arranged by hand.

use egui::accesskit::Role;
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT, Queryable};
use selflink::app::{App, words};
use selflink::scene::GroupMember;
use selflink::solve::{ClusteringMode, SolverParams};

use super::support::{click, coarse, cornell, finish, picture, share_of_different_pixels, until};

fn by_groups() -> SolverParams {
    SolverParams { clustering: ClusteringMode::Groups, ..coarse() }
}

fn open_tool(params: SolverParams) -> Harness<'static, App> {
    let mut window = cornell(params);
    finish(&mut window);
    click(&mut window, words::CLUSTERS);
    until(&mut window, "the solution view", |window| {
        window.state().snapshot().is_some_and(|snapshot| snapshot.solution_view.is_some())
    });
    window
}

fn regrouping(window: &Harness<'static, App>) -> Vec<GroupMember> {
    window.state().scene_info().map(|info| info.scene.regrouping.clone()).unwrap_or_default()
}

fn group(name: &str, objects: &[&str]) -> GroupMember {
    let objects = objects.iter().map(|path| GroupMember::Object((*path).to_owned()));
    GroupMember::Group(name.to_owned(), objects.collect())
}

#[test]
fn surfaces_show_their_clusters_and_come_apart() {
    let mut window = open_tool(by_groups());
    let plain = picture(&mut window);
    click(&mut window, words::COLOUR_BY_CLUSTER);
    window.get_by_role_and_label(Role::Slider, words::LEVEL).set_value_accesskit(1.0);
    window.run_steps(3);
    let coloured = picture(&mut window);
    assert!(share_of_different_pixels(&plain, &coloured) > 0.2, "no colours are to be seen");
    window.get_by_role_and_label(Role::Slider, words::EXPLODE).set_value_accesskit(60.0);
    window.run_steps(3);
    assert!(share_of_different_pixels(&coloured, &picture(&mut window)) > 0.1, "nothing came apart");
    window.get_by_role_and_label(Role::Slider, words::EXPLODE).set_value_accesskit(0.0);
    click(&mut window, words::COLOUR_BY_CLUSTER);
    assert_eq!(share_of_different_pixels(&plain, &picture(&mut window)), 0.0, "it is the plain picture again");
}

/// Truth: the names of the scene's groups, which are the clusters here.
#[test]
fn the_tree_unfolds_picks_and_follows_what_is_picked() {
    let mut window = open_tool(by_groups());
    until(&mut window, "the rows", |window| window.query_by_label("short_block").is_some());
    assert!(window.query_by_label("short_block (white)").is_none(), "polygons are folded away");
    click(&mut window, "Unfold short_block");
    assert!(window.get_all_by_label("short_block (white)").count() >= 5, "its polygons have rows");
    click(&mut window, "Fold short_block");
    assert!(window.query_by_label("short_block (white)").is_none());
    click(&mut window, "short_block");
    until(&mut window, "the tag", |window| window.query_by_label(words::DETAILS).is_some());
    // A click on the back wall unfolds the tree to one of its polygons.
    let above_the_block = window.state().view_rect().center() - egui::vec2(0.0, 100.0);
    let before = window.query_all_by_label_contains("walls (").count();
    window.drag_at(above_the_block);
    window.drop_at(above_the_block);
    until(&mut window, "the wall's row", |window| window.query_all_by_label_contains("walls (").count() > before);
}

#[test]
fn groups_are_made_renamed_dissolved_and_taken_back() {
    let mut window = open_tool(by_groups());
    let generation = window.state().snapshot().expect("a picture").generation;
    click(&mut window, words::MANUAL_GROUPS);
    assert!(window.query_by_label_contains("takes these groups").is_some());
    click(&mut window, "short_block");
    click(&mut window, "New group");
    until(&mut window, "the group", |window| regrouping(window) == [group("group 1", &["short_block"])]);
    let field = window.get_by_role_and_label(Role::TextInput, "Name");
    assert_eq!(field.accesskit_node().value().as_deref(), Some("group 1"));
    field.focus();
    window.step();
    window.key_press_modifiers(egui::Modifiers::COMMAND, egui::Key::A);
    window.get_by_role_and_label(Role::TextInput, "Name").type_text("small things");
    window.step();
    click(&mut window, "Rename");
    until(&mut window, "the name", |window| regrouping(window) == [group("small things", &["short_block"])]);

    // Another block is dragged into it.
    let at = |window: &Harness<'static, App>, label: &str| window.get_by_label(label).rect().center();
    let (from, to) = (at(&window, "tall_block"), at(&window, "small things"));
    window.drag_at(from);
    window.step();
    window.hover_at(from.lerp(to, 0.5));
    window.step();
    window.hover_at(to);
    window.step();
    window.drop_at(to);
    let both = [group("small things", &["short_block", "tall_block"])];
    until(&mut window, "both in it", |window| regrouping(window) == both);
    until(&mut window, "other clusters", |window| {
        window.state().snapshot().is_some_and(|snapshot| snapshot.generation > generation)
    });

    click(&mut window, "small things");
    click(&mut window, "Dissolve");
    until(&mut window, "the file's groups", |window| regrouping(window).is_empty());
    click(&mut window, "Undo grouping");
    until(&mut window, "the group again", |window| regrouping(window) == both);
    click(&mut window, words::REVERT_TO_FILE);
    until(&mut window, "the file's groups", |window| regrouping(window).is_empty());
}

#[test]
fn clustering_by_groups_is_one_click_away() {
    let mut window = open_tool(coarse());
    click(&mut window, words::MANUAL_GROUPS);
    assert!(window.query_by_label_contains("Clustering is adaptive").is_some());
    click(&mut window, "Cluster by groups");
    until(&mut window, "groups", |window| window.state().status().params.clustering == ClusteringMode::Groups);
}
