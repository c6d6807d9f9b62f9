//! The rows of `selflink selftest`, each with its own truth (`src/measure/stability`).

use selflink::measure::stability::{Verdict, rows};

/// Runs a row; a limit that is known and listed is no failure, anything beyond it is.
fn holds(name: &str) {
    let row = rows().into_iter().find(|row| row.name == name).expect("a row of this name");
    let finding = row.run().expect("usable parameters");
    let bad: Vec<String> = finding
        .checks
        .iter()
        .filter(|check| check.verdict() == Verdict::Fail)
        .map(|check| format!("{}: {} instead of {} ({:?})", check.what, check.ours, check.truth, check.relation))
        .collect();
    assert!(bad.is_empty(), "{name}: {}\n{}", row.asked, bad.join("\n"));
    let is_limited = finding.verdict == Verdict::KnownLimit;
    assert_eq!(is_limited, row.limit.is_some(), "{name}: a limit is reported where there is one, and only there");
}

/// One test for each row, by its name.
macro_rules! row_tests {
    ($($(#[$attribute:meta])* $test:ident $name:literal)*) => {
        $($(#[$attribute])* #[test] fn $test() { holds($name); })*
        /// Every row has its test.
        #[test]
        fn every_row_is_tested() {
            let tested = [$($name),*];
            let names: Vec<&str> = rows().iter().map(|row| row.name).collect();
            assert_eq!(names, tested);
        }
    };
}

row_tests! {
    touching "touching"
    row_sums "row-sums"
    weighted_visibility "weighted-visibility"
    light_leak "light-leak"
    shadow_leak "shadow-leak"
    small_blocker "small-blocker"
    hanging_vertices "hanging-vertices"
    lit_backs "lit-backs"
    dense_cluster "dense-cluster"
    extinction "extinction"
    wall_in_a_cluster "wall-in-a-cluster"
    #[ignore = "slow: some 10 s in a test build; selflink selftest runs it"]
    slow_moved_scene "moved-scene"
    overlapping_boxes "overlapping-boxes"
    #[ignore = "slow: some 10 s in a test build; selflink selftest runs it"]
    slow_units "units"
    small_lamps "small-lamps"
    many_patches "many-patches"
    #[ignore = "slow: some 20 s in a test build; selflink selftest runs it"]
    slow_white_rooms "white-rooms"
    #[ignore = "slow: some 20 s in a test build; selflink selftest runs it"]
    slow_divergence "divergence"
    #[ignore = "slow: some 10 s in a test build; selflink selftest runs it"]
    slow_reciprocity "reciprocity"
    #[ignore = "slow: some 15 s in a test build; selflink selftest runs it"]
    slow_sibling_noise "sibling-noise"
    slits "slits"
    duplicates "duplicates"
    slivers "slivers"
    #[ignore = "slow: some 10 s in a test build; selflink selftest runs it"]
    slow_frozen_links "frozen-links"
    colours "colours"
}

/// Truth: `docs/limits.md` has a line for each row that does not reach its requirement, named
/// by the row, and for no other.
#[test]
fn limits_are_listed() {
    let text = std::fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/docs/limits.md")).expect("docs/limits.md");
    for row in rows() {
        let heading = format!("`{}`", row.name);
        let is_listed = text.lines().any(|line| line.starts_with("| ") && line.contains(&heading));
        assert_eq!(is_listed, row.limit.is_some(), "{}: docs/limits.md", row.name);
    }
}
