//! The timeline below the view.

use egui::Key;
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use selflink::app::{App, words};
use selflink::solve::{Epsilon, ParameterId, SolverParams};

use crate::support::{click, cornell, finish, picture, share_of_different_pixels, until};

fn step(window: &Harness<'static, App>) -> Option<usize> {
    window.state().snapshot().and_then(|snapshot| snapshot.former_step)
}

/// Truth: the first step is the root's self-link on unsplit patches, and the present comes back as
/// it was, pixel for pixel.
#[test]
fn a_former_step_is_looked_at_and_the_present_comes_back() {
    let mut window = cornell(SolverParams { epsilon: Epsilon::Relative(1e-3), ..SolverParams::default() });
    finish(&mut window);
    let present = picture(&mut window);
    let steps = window.state().status().steps.len();
    assert!(steps > 5, "{steps} steps");

    // The left end of the track is the first step, and the right one the present.
    let track = window.get_by_label(words::STEP_OF_THE_SOLVE).rect();
    for (share, expected) in [(0.0, Some(0)), (0.5, Some((steps - 1).div_ceil(2))), (1.0, None)] {
        let at = track.shrink2(egui::vec2(8.0, 0.0)).left_center() + egui::vec2(share * (track.width() - 16.0), 0.0);
        window.drag_at(at);
        window.drop_at(at);
        let near = |step: Option<usize>| match (step, expected) {
            (Some(step), Some(expected)) => step.abs_diff(expected) <= 1,
            (step, expected) => step == expected,
        };
        until(&mut window, "the step", |window| near(step(window)));
        let says = |words: &str| window.query_by_label_contains(words).is_some();
        assert_eq!((says(words::FORMER_STEP), says(words::LINKS_SETTLED)), (share < 1.0, share == 1.0));
    }
    assert_eq!(share_of_different_pixels(&present, &picture(&mut window)), 0.0, "the present comes back");

    // By keys: one step back, to the last but one.
    window.key_press(Key::ArrowLeft);
    until(&mut window, "the last step but one", |window| step(window) == Some(steps - 2));
    click(&mut window, words::LATEST);
    until(&mut window, "the present", |window| step(window).is_none());
}

/// Truth: the steps' own numbers. A click that is over within a frame counts, and arrows belong to
/// the timeline for as long as it is used.
#[test]
fn short_clicks_and_arrows_step_through_the_solve() {
    let mut window = cornell(SolverParams { epsilon: Epsilon::Relative(1e-3), ..SolverParams::default() });
    finish(&mut window);
    let track = window.get_by_label(words::STEP_OF_THE_SOLVE).rect();
    let at = track.shrink2(egui::vec2(8.0, 0.0)).left_center();
    window.hover_at(at);
    window.run_steps(2);
    for pressed in [true, false] {
        let (button, modifiers) = (egui::PointerButton::Primary, egui::Modifiers::NONE);
        window.input_mut().events.push(egui::Event::PointerButton { pos: at, button, pressed, modifiers });
    }
    until(&mut window, "the first step", |window| step(window) == Some(0));
    for expected in 1..=4 {
        window.key_press(Key::ArrowRight);
        until(&mut window, "the next step", |window| step(window) == Some(expected));
    }
    for expected in (1..=3).rev() {
        window.key_press(Key::ArrowLeft);
        until(&mut window, "the step before", |window| step(window) == Some(expected));
    }
}

/// Truth: playing goes through the steps in order, from one self-link to the present.
#[test]
fn steps_are_played_from_the_first_to_the_present() {
    let mut window = cornell(SolverParams { epsilon: Epsilon::Relative(1e-2), ..SolverParams::default() });
    finish(&mut window);
    let steps = window.state().status().steps.len();
    let links_at_the_end = window.state().snapshot().expect("a picture").stats.links;
    click(&mut window, words::PLAY);
    let first = |window: &Harness<'static, App>| {
        let stats =
            window.state().snapshot().filter(|snapshot| snapshot.former_step == Some(0)).map(|first| &first.stats);
        stats.map(|stats| (stats.links, stats.candidates_left))
    };
    // One self-link waits, and nothing else is there.
    until(&mut window, "the first step", |window| first(window) == Some((0, 1)));
    let mut seen = vec![0];
    until(&mut window, "the present", |window| {
        seen.extend(step(window).filter(|now| seen.last() != Some(now)));
        step(window).is_none()
    });
    assert_eq!(seen, (0..steps).collect::<Vec<_>>());
    assert_eq!(window.state().snapshot().expect("a picture").stats.links, links_at_the_end);
}

/// Truth: the solve's own first step, and what can then be read by name.
#[test]
fn a_study_opens_the_method_and_replays_the_solve() {
    let mut window = cornell(SolverParams::usual());
    finish(&mut window);
    let threshold = words::parameter(ParameterId::Epsilon);
    assert!(window.query_by_label(threshold).is_none(), "the method is folded away");
    click(&mut window, words::STUDY);
    until(&mut window, "the first step", |window| step(window) == Some(0));
    assert!(window.query_all_by_label(threshold).next().is_some());
    let why = window.query_all_by_label_contains("used with the choice Stop at").next();
    assert!(why.is_some(), "what has no effect says why");
    until(&mut window, "words on it", |window| window.query_by_label(words::STEP_SELF_LINK).is_some());
    until(&mut window, "its links", |window| window.query_by_label_contains("drawn").is_some());
    click(&mut window, words::LATEST);
    until(&mut window, "the present", |window| step(window).is_none());
    until(&mut window, "no links, as before", |window| window.query_by_label_contains("drawn").is_none());
    assert!(window.query_by_label(words::STEP_SELF_LINK).is_none());
}
