//! A coarser threshold on a finer solution: links and patches are merged back.
//!
//! Truth: counting (every pair is still accounted for once), the power that passes over the links,
//! and a fresh solve by the coarse threshold.

use proptest::prelude::*;
use proptest::test_runner::{Config, RngAlgorithm, TestRng, TestRunner};
use selflink::base::cancel::CancelToken;
use selflink::hierarchy::ClusteringMode;
use selflink::solve::{Solver, SolverParams, Step};

use super::coverage::check_coverage;
use super::hierarchy::{check_tree, soup};
use super::support::{MODES, difference, is_sound, lamp_room, links, params, radiosity_bits, solve, with_threads};

const COARSE: f64 = 1e-2;
const FINE: f64 = 1e-3;

/// Two solutions of the coarse threshold: each is within several per cent of the truth.
const SAME: f64 = 0.06;
/// Links may be this many times a fresh solve's: what is known to be seen in part from near may
/// look clear from afar.
const MOST_LINKS: f64 = 1.5;
/// Power that merging may lose or gain: B is not the same all over a source.
const SAME_POWER: f64 = 0.03;

fn change(solver: &mut Solver, params: SolverParams) {
    assert!(!solver.set_params(params).expect("usable parameters").is_rebuilt(), "the hierarchy stays");
    assert!(solver.run(&CancelToken::new()));
    assert!(is_sound(solver));
}

/// Every pair is covered once, as little light is lost as by a fresh solve,
/// and hardly a ray is cast.
#[test]
fn a_raised_threshold_merges_links_and_patches_back() {
    let scene = lamp_room();
    for mode in MODES {
        let fresh = solve(&scene, params(mode, COARSE));
        let finer = solve(&scene, params(mode, FINE));
        let mut solver = solve(&scene, params(mode, FINE));
        let before = solver.stats();
        change(&mut solver, params(mode, COARSE));
        let [error, error_afresh] = [&solver, &fresh].map(|coarse| difference(coarse, &finer));
        assert!(error < 1.25 * error_afresh, "{mode:?}: off by {error}, afresh by {error_afresh}");
        let (after, wanted) = (solver.stats(), fresh.stats());
        check_tree(&scene, solver.hierarchy());
        check_coverage(&solver, &format!("{mode:?}"));
        let off = difference(&solver, &fresh);
        let power = after.absorbed_watts / before.absorbed_watts - 1.0;
        println!(
            "{mode:?}: {} links of {}, afresh {}; {} patches of {}, afresh {}; power {power:+.4}, error {error:.4}, afresh {error_afresh:.4}, B differs by {off:.4}",
            after.links, before.links, wanted.links, after.patches, before.patches, wanted.patches
        );
        assert!((after.links as f64) < MOST_LINKS * wanted.links as f64, "{mode:?}: {} links", after.links);
        assert!((after.patches as f64) < 1.2 * wanted.patches as f64, "{mode:?}: {} patches", after.patches);
        assert!(power.abs() < SAME_POWER, "{mode:?}: {power:+.4} of the power");
        assert!(off < SAME, "{mode:?}: B differs by {off}");
        let rays = after.rays - before.rays;
        assert!(10 * rays < wanted.rays, "{mode:?}: {rays} rays, afresh {}", wanted.rays);
    }
}

/// There and back: the coarse solution has the light of the first, and refined again it has that of
/// the fine one.
#[test]
fn thresholds_go_to_and_fro() {
    let scene = lamp_room();
    let with = |epsilon| params(ClusteringMode::Adaptive, epsilon);
    let mut solver = solve(&scene, with(COARSE));
    let coarse = (solver.stats(), solver.radiosity().to_vec());
    for _ in 0..2 {
        change(&mut solver, with(FINE));
        let off = difference(&solver, &solve(&scene, with(FINE)));
        assert!(off < 0.03, "fine: B differs by {off}");
        change(&mut solver, with(COARSE));
        let after = solver.stats();
        assert!((after.links as f64) < MOST_LINKS * coarse.0.links as f64, "{} links", after.links);
        let off = difference(&solver, &solve(&scene, with(COARSE)));
        assert!(off < SAME, "coarse: B differs by {off}");
        check_coverage(&solver, "to and fro");
    }
    assert_eq!(solver.radiosity().len(), solver.hierarchy().elements().len());
    assert!(!coarse.1.is_empty());
}

#[test]
fn every_pair_stays_covered_once_in_random_scenes() {
    let cases = Config { cases: 12, failure_persistence: None, max_shrink_iters: 50, ..Config::default() };
    let random = TestRng::from_seed(RngAlgorithm::ChaCha, b"selflink: merged pairs just once");
    let checked = TestRunner::new_with_rng(cases, random).run(&soup(), |scene| {
        for mode in [ClusteringMode::Groups, ClusteringMode::Adaptive] {
            let mut solver = solve(&scene, params(mode, FINE));
            for epsilon in [5e-3, 5e-2] {
                prop_assert!(!solver.set_params(params(mode, epsilon)).expect("usable parameters").is_rebuilt());
                prop_assert!(solver.run(&CancelToken::new()) && is_sound(&solver));
                check_tree(&scene, solver.hierarchy());
                check_coverage(&solver, &format!("{mode:?} at {epsilon}"));
            }
        }
        Ok(())
    });
    checked.expect("every random scene stays covered");
}

/// Truth: the same bits. Merging asks nobody how many threads there are, and a cancelled step
/// changes nothing.
#[test]
fn merging_is_the_same_for_any_number_of_threads_and_interruptions() {
    let merged = |threads: usize, is_interrupted: bool| {
        with_threads(threads, || {
            let mut solver = solve(&lamp_room(), params(ClusteringMode::Adaptive, FINE));
            assert!(
                !solver.set_params(params(ClusteringMode::Adaptive, COARSE)).expect("usable parameters").is_rebuilt()
            );
            if is_interrupted {
                let cancelled = CancelToken::new();
                cancelled.cancel();
                assert_eq!(solver.step(&cancelled), Step::Interrupted);
            }
            assert!(solver.run(&CancelToken::new()));
            (radiosity_bits(&solver), links(&solver))
        })
    };
    let one = merged(1, false);
    assert!(one == merged(3, false), "threads matter");
    assert!(one == merged(2, true), "interruptions matter");
}

/// A threshold raised in the midst of a solve: what waits is judged by it, the rest is merged back.
#[test]
fn a_threshold_is_raised_in_the_midst_of_a_solve() {
    let scene = lamp_room();
    let mut solver = super::support::solver(&scene, params(ClusteringMode::Adaptive, 3e-4));
    for _ in 0..12 {
        solver.step(&CancelToken::new());
    }
    change(&mut solver, params(ClusteringMode::Adaptive, COARSE));
    check_coverage(&solver, "in the midst");
    let fresh = solve(&scene, params(ClusteringMode::Adaptive, COARSE));
    assert!((solver.stats().links as f64) < MOST_LINKS * fresh.stats().links as f64);
    assert!(difference(&solver, &fresh) < SAME);
}

/// Truth: an element's key, by which a view finds it again under its new number, belongs to the
/// same place as before.
#[test]
fn elements_keep_their_keys() {
    let mut solver = solve(&lamp_room(), params(ClusteringMode::Adaptive, FINE));
    let places = |solver: &Solver| -> std::collections::BTreeMap<u64, [u32; 3]> {
        let elements = solver.hierarchy().elements().iter();
        elements.map(|element| (element.key, element.centre.to_array().map(f32::to_bits))).collect()
    };
    let before = places(&solver);
    change(&mut solver, params(ClusteringMode::Adaptive, COARSE));
    let after = places(&solver);
    assert!(after.len() < before.len());
    assert!(after.iter().all(|(key, place)| before.get(key) == Some(place)));
}
