//! Two solutions side by side.

use egui::accesskit::Role;
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT, Queryable};
use image::RgbaImage;
use selflink::app::{App, words};
use selflink::scene::builtin::BuiltinScene;
use selflink::solve::{Epsilon, ParameterId};

use crate::support::{click, coarse, cornell, finish, keep, picture, share_of_different_pixels, until};

/// The part of a picture between two shares of its width, without what is written along its upper
/// rim.
fn part(picture: &RgbaImage, from: f32, to: f32) -> RgbaImage {
    let [left, right] = [from, to].map(|share| (share * picture.width() as f32) as u32);
    image::imageops::crop_imm(picture, left, 60, right - left, picture.height() - 130).to_image()
}

/// Rounding of the exposure may change a shade.
fn are_alike(one: &RgbaImage, other: &RgbaImage) -> bool {
    one.dimensions() == other.dimensions()
        && one
            .pixels()
            .zip(other.pixels())
            .all(|(one, other)| one.0.iter().zip(other.0).all(|(a, b)| a.abs_diff(b) <= 1))
}

fn finer(window: &mut Harness<'static, App>) {
    window.get_by_role_and_label(Role::Slider, words::parameter(ParameterId::Epsilon)).set_value_accesskit(1e-3);
    until(window, "a finer ε", |window| window.state().status().params.epsilon == Epsilon::Relative(1e-3));
    finish(window);
}

/// Truth: the picture of A before it was pinned, and that of B alone.
#[test]
fn a_is_at_the_left_of_the_divider_and_b_at_its_right() {
    let mut window = cornell(coarse());
    finish(&mut window);
    click(&mut window, words::COMPARE);
    let a = picture(&mut window);
    click(&mut window, words::KEEP_AS_A);
    finer(&mut window);
    let split = picture(&mut window);
    click(&mut window, words::B_ALONE);
    let b = picture(&mut window);
    click(&mut window, words::A_ALONE);
    assert!(are_alike(&part(&a, 0.0, 1.0), &part(&picture(&mut window), 0.0, 1.0)), "A alone is as it was");
    assert!(share_of_different_pixels(&part(&a, 0.0, 1.0), &part(&b, 0.0, 1.0)) > 0.1, "ε matters");
    assert!(are_alike(&part(&split, 0.0, 0.47), &part(&a, 0.0, 0.47)));
    assert!(are_alike(&part(&split, 0.53, 1.0), &part(&b, 0.53, 1.0)));

    // The divider follows the mouse.
    click(&mut window, words::A_BESIDE_B);
    let view = window.state().view_rect();
    let at = |share: f32| egui::pos2(view.left() + share * view.width(), view.center().y + 100.0);
    window.drag_at(at(0.5));
    window.step();
    window.hover_at(at(0.8));
    window.step();
    window.drop_at(at(0.8));
    window.step();
    let moved = picture(&mut window);
    assert!(are_alike(&part(&moved, 0.0, 0.77), &part(&a, 0.0, 0.77)));
    assert!(are_alike(&part(&moved, 0.83, 1.0), &part(&b, 0.83, 1.0)));
    keep(&mut window, "split");
}

/// Truth: the solver's own numbers, and a difference that is there where settings differ.
#[test]
fn the_table_tells_what_differs_and_the_view_shows_where() {
    let mut window = cornell(coarse());
    finish(&mut window);
    click(&mut window, words::COMPARE);
    click(&mut window, words::KEEP_AS_A);
    assert!(window.query_by_label_contains("None yet").is_some());
    let links = |window: &Harness<'static, App>| window.state().snapshot().expect("a picture").stats.links;
    let of_a = links(&window);
    finer(&mut window);
    let grouped = |count: usize| selflink::base::format::count(count as u64);
    for text in ["0.00100 Φ".to_owned(), grouped(of_a), grouped(links(&window))] {
        assert!(window.query_all_by_label(&text).next().is_some(), "{text}");
    }
    until(&mut window, "the difference", |window| {
        window.query_by_label("RMS of B − A").is_some() && window.query_all_by_label_contains(" %").next().is_some()
    });
    let lit = picture(&mut window);
    click(&mut window, words::DIFFERENCE);
    let differences = picture(&mut window);
    assert!(share_of_different_pixels(&lit, &differences) > 0.2);

    click(&mut window, words::DISCARD_A);
    assert!(window.query_by_label(words::KEEP_AS_A).is_some());
    // Another scene has no A.
    click(&mut window, words::KEEP_AS_A);
    let ours = BuiltinScene::from_name("seminar").expect("ours").name();
    window.get_all_by_label(ours).find(|node| node.accesskit_node().role() == Role::Button).expect("offered").click();
    until(&mut window, "another scene", |window| window.query_by_label(words::KEEP_AS_A).is_some());
}
