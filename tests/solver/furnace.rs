//! Furnaces: a closed room of one reflectance ρ and one emission B_e glows with B = B_e / (1 − ρ)
//! everywhere.
//!
//! Truth: conservation. Every row of form factors sums to 1, whatever stands in the room.

use selflink::hierarchy::ClusteringMode;
use selflink::solve::{Solver, SolverParams};
use selflink::transport::{Push, audit};

use super::support::{MODES, deviation, empty_room, furnished_room, is_sound, params, solve};

/// B is kept below B_e / (1 − ρ), so that form factors that are too large do not show in it: their
/// own mean tells.
fn rows_sum_to_one(solved: &Solver, tolerance: f64, what: &str) {
    let found = audit(solved.link_solution());
    let (_, mean) = found.largest_and_mean(&found.rows);
    println!("{what}: rows sum to {mean:.4} in the mean");
    assert!((mean - 1.0).abs() < tolerance, "{what}: rows of F·V sum to {mean} in the mean");
}

/// 1 % on the mean, as the issue asks, with furniture in the room so that clusters and occlusion
/// count.
fn furnished_furnace_glows_evenly(mode: ClusteringMode) {
    let solved = solve(&furnished_room(0.5, 1.0), params(mode, 1e-4));
    let (mean, rms, worst) = deviation(&solved, 2.0);
    let stats = solved.stats();
    println!(
        "{mode:?}: mean {mean:.4} ({:+.2} %), RMS {:.2} %, worst {:.1} %; {} links, {} patches, {} limited leaves",
        50.0 * (mean - 2.0),
        100.0 * rms,
        100.0 * worst,
        stats.links,
        stats.patches,
        stats.clamped_leaves
    );
    assert!((mean / 2.0 - 1.0).abs() < 0.01, "{mode:?}: B = {mean} instead of 2");
    rows_sum_to_one(&solved, 0.01, &format!("{mode:?}"));
}

#[test]
fn furnished_furnace_glows_evenly_without_clusters() {
    furnished_furnace_glows_evenly(ClusteringMode::None);
}

#[test]
fn furnished_furnace_glows_evenly_with_an_octree() {
    furnished_furnace_glows_evenly(ClusteringMode::Octree);
}

#[test]
fn furnished_furnace_glows_evenly_with_groups() {
    furnished_furnace_glows_evenly(ClusteringMode::Groups);
}

#[test]
fn furnished_furnace_glows_evenly_with_adaptive_clusters() {
    furnished_furnace_glows_evenly(ClusteringMode::Adaptive);
}

/// With ε so coarse that whole walls are the leaves, every leaf and not only the mean glows as it
/// should: the form factors of touching walls are within 1 %, and so is B at ρ/(1−ρ) = 1.
#[test]
fn empty_furnace_of_whole_walls_glows_evenly() {
    let solved = solve(&empty_room(0.5, 1.0), params(ClusteringMode::None, 1.0));
    assert_eq!(solved.stats().patches, 6);
    let (mean, _, worst) = deviation(&solved, 2.0);
    assert!(worst < 0.01, "mean {mean}, worst {:.2} % off", 100.0 * worst);
}

/// Walls that are split: a leaf's irradiance is in part its ancestors', so single leaves could be
/// off; with any ε not by more than 0.2 %, RMS and mean alike, for so good are form factors far and
/// near.
#[test]
fn empty_furnace_glows_evenly_with_any_threshold() {
    for mode in MODES {
        let of = |epsilon: f64| {
            let solved = solve(&empty_room(0.5, 1.0), params(mode, epsilon));
            rows_sum_to_one(&solved, 0.002, &format!("{mode:?} at {epsilon:e}"));
            deviation(&solved, 2.0)
        };
        let (coarse, fine) = (of(1e-2), of(1e-4));
        println!("{mode:?}: mean {:.4} and {:.4}, RMS {:.4} and {:.4}", coarse.0, fine.0, coarse.1, fine.1);
        for (mean, rms, _) in [coarse, fine] {
            assert!(rms < 0.002, "{mode:?}: RMS {rms}");
            assert!((mean / 2.0 - 1.0).abs() < 0.002, "{mode:?}: B = {mean} instead of 2");
        }
    }
}

/// An error of 0.2 % in the sum of a row of form factors becomes 0.2 % · ρ/(1−ρ) = 3.8 % of B at ρ
/// = 0.95. A gather that counted sweeps instead of looking at the change would end low.
#[test]
fn bright_furnace_converges() {
    for push in [Push::Immediate, Push::Deferred] {
        for mode in MODES {
            let solved = solve(&empty_room(0.95, 1.0), SolverParams { push, ..params(mode, 1e-3) });
            let (mean, rms, worst) = deviation(&solved, 20.0);
            let limited = solved.stats().clamped_leaves;
            println!("{mode:?}, {push:?}: mean {mean:.2}, RMS {rms:.3}, worst {worst:.2}, {limited} leaves limited");
            assert!(is_sound(&solved));
            assert!((mean / 20.0 - 1.0).abs() < 0.038, "{mode:?}, {push:?}: B = {mean} instead of 20");
            rows_sum_to_one(&solved, 0.002, &format!("{mode:?}, {push:?}"));
        }
    }
}

/// The furnished room at ρ = 0.95, at the ε that is right to 1 % at ρ = 0.5: 1 % of a row's sum is
/// 19 % of B; what must not happen is that light grows without bound.
#[test]
fn bright_furnished_furnace_stays_finite() {
    for mode in MODES {
        let solved = solve(&furnished_room(0.95, 1.0), params(mode, 1e-4));
        let (mean, rms, worst) = deviation(&solved, 20.0);
        println!("{mode:?}, ρ = 0.95 with furniture: mean {mean:.2}, RMS {rms:.3}, worst {worst:.2}");
        assert!(is_sound(&solved));
        assert!((mean / 20.0 - 1.0).abs() < 0.19, "{mode:?}: B = {mean} instead of 20");
        rows_sum_to_one(&solved, 0.01, &format!("{mode:?}"));
    }
}

/// Truth: what is emitted is also B where nothing is reflected; exact, for nothing is added to it.
#[test]
fn a_black_furnace_only_emits() {
    for mode in MODES {
        let solved = solve(&furnished_room(0.0, 1.0), params(mode, 1e-3));
        assert_eq!(deviation(&solved, 1.0).2, 0.0, "{mode:?}");
    }
}
