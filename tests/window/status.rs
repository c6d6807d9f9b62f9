//! What the bar below says of a solve, while it goes on and when it has ended.
//!
//! Truth: the solver's own state, and scenes that reach one kind of end for sure.

use egui::Key;
use egui::accesskit::Role;
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT, Queryable};
use selflink::app::{App, words};
use selflink::base::memory::MemoryBudget;
use selflink::scene::Source;
use selflink::scene::builtin::BuiltinScene;
use selflink::solve::{Epsilon, SolverParams};
use selflink::worker::RunState;

use crate::support::{click, cornell, finish, until, window};

type Window = Harness<'static, App>;

fn says(window: &Window, text: &str) -> bool {
    window.query_all_by_label_contains(text).next().is_some()
}

#[test]
fn a_solve_that_runs_out_of_memory_says_that_it_stopped_and_what_is_not_known() {
    let params = SolverParams {
        epsilon: Epsilon::Relative(1e-7),
        memory: MemoryBudget::Bytes(24 << 20),
        ..SolverParams::default()
    };
    let mut window = cornell(params);
    finish(&mut window);
    until(&mut window, "its end", |window| says(window, words::STOPPED));
    assert!(says(&window, words::ERROR_NOT_MEASURED) && !says(&window, words::LINKS_SETTLED));
}

#[test]
fn progress_has_a_name_while_a_solve_waits() {
    let params = SolverParams { epsilon: Epsilon::Relative(1e-4), ..SolverParams::default() };
    let mut window = window(Some(Source::Builtin(BuiltinScene::from_name("seminar").expect("ours"))), params);
    until(&mut window, "the first picture", |window| window.state().snapshot().is_some());
    click(&mut window, words::PAUSE);
    until(&mut window, "the pause", |window| window.state().status().run == RunState::Paused);
    let bars: Vec<String> = window
        .query_all_by_role(Role::ProgressIndicator)
        .filter_map(|node| node.accesskit_node().label())
        .filter(|name| name.starts_with(words::PROGRESS))
        .collect();
    assert_eq!(bars.len(), 1, "{bars:?}");
}

/// Truth: the steps of the timeline, whose kinds the solver tells.
#[test]
fn former_steps_say_what_was_being_done() {
    let mut window = cornell(SolverParams { error: Some(0.1), ..SolverParams::usual() });
    finish(&mut window);
    let steps = window.state().status().steps.len();
    let track = window.get_by_label(words::STEP_OF_THE_SOLVE).rect();
    let first = track.left_center() + egui::vec2(8.0, 0.0);
    window.drag_at(first);
    window.drop_at(first);
    until(&mut window, "the first step", |window| {
        says(window, words::TESTING_LINKS) && says(window, words::FORMER_STEP)
    });
    // Links, in the bar as in the timeline: the one that waits.
    assert!(says(&window, &format!("1/{steps} self-link · 1 link")));
    let counted = window.query_all_by_label("1").any(|node| node.rect().top() > window.state().view_rect().bottom());
    assert!(counted, "the bar counts the same link");
    // The last of them is the present.
    for next in 1..steps - 1 {
        window.key_press(Key::ArrowRight);
        let is_shown = |window: &Window| window.state().snapshot().is_some_and(|shown| shown.former_step == Some(next));
        until(&mut window, "the next step", is_shown);
        if says(&window, &format!("{}: {}", words::FORMER_STEP, words::FINAL_GATHER)) {
            return;
        }
    }
    panic!("no step of the final gather");
}

/// A room of 4 × 2.5 × 4 m without a lamp, and one in a closed box beside it.
const BESIDE_A_LAMP: &str = "mtllib beside.mtl\no room\nusemtl wall
v 0 0 0\nv 4 0 0\nv 4 0 4\nv 0 0 4\nv 0 2.5 0\nv 4 2.5 0\nv 4 2.5 4\nv 0 2.5 4
f 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8
o box
v 6 0 0\nv 7 0 0\nv 7 0 1\nv 6 0 1\nv 6 1 0\nv 7 1 0\nv 7 1 1\nv 6 1 1
f 12 11 10 9\nf 13 14 15 16\nf 9 10 14 13\nf 10 11 15 14\nf 11 12 16 15\nf 12 9 13 16
o lamp\nusemtl lamp\nv 6.3 0.9 0.3\nv 6.7 0.9 0.3\nv 6.7 0.9 0.7\nv 6.3 0.9 0.7\nf 17 18 19 20\n";

/// Truth: walls that no light passes.
#[test]
fn a_target_that_is_reached_out_of_sight_is_not_all_that_is_said() {
    let folder = tempfile::tempdir().expect("a folder");
    let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).expect("a writable folder");
    write("beside.obj", BESIDE_A_LAMP);
    write("beside.mtl", "newmtl wall\nKd 0.5 0.5 0.5\nnewmtl lamp\nKd 0.5 0.5 0.5\nKe 30 30 30\n");
    write(
        "beside.selflink.json",
        r#"{"sides": "both", "camera": {"eye": [2, 1.2, 3.8], "target": [2, 1.2, 0], "up": [0, 1, 0], "hfov_deg": 60}}"#,
    );
    let params = SolverParams { error: Some(0.1), ..SolverParams::usual() };
    let mut window = window(Some(Source::File(folder.path().join("beside.obj"))), params);
    until(&mut window, "the first picture", |window| window.state().snapshot().is_some());
    finish(&mut window);
    until(&mut window, "the words", |window| says(window, words::NO_LIGHT_HERE));
    until(&mut window, "the bar", |window| says(window, words::NOTHING_SEEN_IS_LIT));
    assert!(says(&window, words::HANG_UP_A_LAMP));
}
