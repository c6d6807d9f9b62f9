//! A coarser threshold on a finer solution: links and patches are merged back.
//!
//! Truth: counting (every pair is still accounted for once), the power that passes over the links, and a fresh solve by the coarse
//! threshold.

use selflink::cancel::CancelToken;
use selflink::hierarchy::ClusteringMode;
use selflink::scene::Scene;
use selflink::scene::builtin::BuiltinScene;
use selflink::solver::{OracleKind, Solver, SolverParams, Step};

use super::hierarchy::{check_coverage, check_tree};
use super::support::{
    MODES, difference, furnished_room, is_sound, lamp_room, links, params, radiosity_bits, solve, with_threads,
};

/// Power that leaves absorb, W (all colours).
fn absorbed(solver: &Solver) -> f64 {
    solver.stats().absorbed_watts
}

fn change(solver: &mut Solver, params: SolverParams) {
    assert!(solver.set_params(params).expect("usable parameters"), "the hierarchy stays");
    assert!(solver.run(&CancelToken::new()));
    assert!(is_sound(solver));
}

#[test]
fn probe() {
    for scene in [lamp_room(), BuiltinScene::Cornell.build(), BuiltinScene::Office.build()] {
        for mode in MODES {
            if mode == ClusteringMode::None && scene.polygons.len() > 1000 { continue; }
            for oracle in [OracleKind::Energy, OracleKind::Error] {
                let with = |epsilon| SolverParams { oracle, ..params(mode, epsilon) };
                let begun = std::time::Instant::now();
                let coarse = solve(&scene, with(3e-3));
                let took_fresh = begun.elapsed();
                let mut solver = solve(&scene, with(3e-4));
                let (before, power) = (solver.stats(), absorbed(&solver));
                let begun = std::time::Instant::now();
                change(&mut solver, with(3e-3));
                let took = begun.elapsed();
                let (after, fresh) = (solver.stats(), coarse.stats());
                println!(
                    "{} {mode:?} {oracle:?}: links {} -> {} fresh {}, patches {} -> {} fresh {}, power {power:.3} -> {:.3} fresh {:.3}, differs {:.4}, rays {}, took {took:?} fresh {took_fresh:?}",
                    scene.name, before.links, after.links, fresh.links, before.patches, after.patches, fresh.patches,
                    absorbed(&solver), absorbed(&coarse), difference(&solver, &coarse), after.rays - before.rays
                );
                if scene.polygons.len() < 100 {
                check_tree(&scene, solver.hierarchy());
                check_coverage(&solver, &format!("{mode:?} {oracle:?}")); }
            }
        }
    }
}
