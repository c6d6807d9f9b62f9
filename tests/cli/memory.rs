//! The memory budget on the command line.
//!
//! Truth: the budget that was given, and what the system says that the process held at most.

use serde_json::Value;

use crate::support::{Folder, name, refused, succeed};

/// As quick as links can be made: a ray each.
const QUICK: [&str; 6] = ["--rays-min", "1", "--rays-max", "1", "--visibility-factor", "0.1"];
/// What the program takes without a solution to speak of, bytes: code, stacks of the threads, and
/// the allocator's reserves.
const BASELINE: u64 = 48 << 20;

fn solve(scene: &str, args: &[&str]) -> (String, Value) {
    let folder = Folder::new();
    let path = folder.path("stats.json");
    let (summary, _) = succeed(&[&["solve", scene, "--stats", name(&path)], &QUICK[..], args].concat());
    let text = std::fs::read_to_string(path).expect("statistics");
    (summary, serde_json::from_str(&text).expect("statistics are JSON"))
}

#[test]
fn a_solve_that_stops_at_the_budget_says_so() {
    let (summary, stats) = solve("cornell", &["--epsilon", "1e-7", "--memory", "4MiB"]);
    let sentence = "stopped    at the memory budget of 4.0 MiB: links are coarser than was asked for; give more with --memory or ask for a larger --epsilon";
    assert!(summary.contains(sentence), "{summary}");
    assert!(summary.lines().next().is_some_and(|line| line.ends_with("stopped")), "{summary}");
    assert_eq!((&stats["memory_stop"], &stats["converged"]), (&"links".into(), &false.into()));
    assert_eq!(
        (&stats["bytes"]["budget"], &stats["settings"]["solver"]["memory"]),
        (&(4 << 20).into(), &"4MiB".into())
    );
    assert!(stats["bytes"]["counted"].as_u64().is_some_and(|bytes| bytes <= 4 << 20), "{}", stats["bytes"]);
    assert!(stats["absorbed_watts"].as_f64().is_some_and(|watts| watts > 0.0));
    // Where nobody asks, there is enough, and nothing is said.
    let (summary, stats) = solve("cornell", &["--epsilon", "1e-2"]);
    assert!(!summary.contains("stopped    at") && summary.contains("of a budget of"), "{summary}");
    assert_eq!((&stats["memory_stop"], &stats["settings"]["solver"]["memory"]), (&Value::Null, &"60%".into()));
}

#[test]
fn budgets_that_cannot_be_used_are_refused() {
    for wrong in ["0%", "120%", "1KiB", "much", "-4GiB"] {
        let sentence = refused(&["solve", "cornell", "--memory", wrong]);
        assert!(sentence.contains("--memory") && sentence.contains("1MiB") || sentence.contains("4GiB"), "{sentence}");
    }
    let sentence = refused(&["solve", "seminar", "--clustering", "none", "--memory", "64MiB"]);
    assert!(sentence.contains("memory budget of 64 MiB") && sentence.contains("--memory"), "{sentence}");
}

/// Truth: the process's peak, which holds what is not counted too.
#[test]
#[ignore = "slow: fills some hundred MiB"]
#[cfg(target_os = "linux")]
fn slow_the_process_stays_within_budget_and_baseline() {
    for (scene, epsilon, mebibytes) in [("cornell", "1e-9", 100), ("office", "1e-7", 160)] {
        let budget = mebibytes << 20;
        let (_, stats) = solve(scene, &["--epsilon", epsilon, "--memory", &format!("{mebibytes}MiB")]);
        let peak = stats["peak_rss_bytes"].as_u64().expect("the system tells");
        let counted = stats["bytes"]["counted"].as_u64().expect("a number");
        println!("{scene}: peak {} MiB, counted {} MiB of {mebibytes} MiB", peak >> 20, counted >> 20);
        assert_eq!(stats["memory_stop"], "links");
        assert!(counted <= budget, "{scene}: {counted} bytes counted of {budget}");
        assert!(peak < budget + BASELINE, "{scene}: the process held {} MiB of {mebibytes} MiB", peak >> 20);
    }
}
