//! The memory budget: what is counted stays within it, and what stops there is a picture all the
//! same.
//!
//! Truth: the budget; the bits of one thread; the largest radiosity that anything in a scene can
//! have.

use std::sync::Arc;

use rayon::ThreadPoolBuilder;
use selflink::base::cancel::CancelToken;
use selflink::base::memory::MemoryBudget;
use selflink::geometry::Occluders;
use selflink::scene::builtin::BuiltinScene;
use selflink::solve::{ChangeCost, ClusteringMode, Epsilon, MemoryStop, Snapshot, Solver, SolverParams};

fn solver(scene: BuiltinScene, params: SolverParams) -> Solver {
    let scene = Arc::new(scene.build());
    let occluders = Arc::new(Occluders::new(&scene));
    Solver::new(scene, occluders, params, 1).expect("the parameters are valid")
}

fn mebibytes(count: u64) -> MemoryBudget {
    MemoryBudget::Bytes(count << 20)
}

/// Every value is finite, not negative, and no greater than max B_e/(1−ρ_max).
fn assert_bounded(solver: &Solver, snapshot: &Snapshot) {
    let (mut emission, mut reflectance) = (0.0_f32, 0.0_f32);
    for material in &solver.scene().materials {
        emission = emission.max(material.emission.max_element());
        reflectance = reflectance.max(material.reflectance.max_element());
    }
    let most = 1.001 * emission / (1.0 - reflectance);
    let values = snapshot.vertex_radiosity.iter().chain(&snapshot.leaf_radiosity).flatten();
    let (mut brightest, mut count) = (0.0_f32, 0);
    for value in values {
        assert!(value.is_finite() && *value >= 0.0 && *value <= most, "{value} of at most {most} W/m²");
        brightest = brightest.max(*value);
        count += 1;
    }
    assert!(count > 0 && brightest > 0.0, "there is light to be seen");
}

#[test]
fn refinement_stops_at_the_budget_with_a_picture_for_any_number_of_threads() {
    let fine = SolverParams { epsilon: Epsilon::Relative(1e-6), memory: mebibytes(4), ..SolverParams::default() };
    let grouped = SolverParams { clustering: ClusteringMode::Groups, ..fine };
    let (cornell, seminar) = (BuiltinScene::Cornell, BuiltinScene::Seminar { polygons: 400 });
    for (scene, params) in [(cornell, fine), (seminar, grouped)] {
        let solved = [1, 3].map(|threads| {
            let pool = ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
            pool.install(|| {
                let mut solver = solver(scene, params);
                assert!(solver.run(&CancelToken::new()));
                let snapshot = solver.snapshot();
                (solver, snapshot)
            })
        });
        let stats = solved.each_ref().map(|(_, snapshot)| snapshot.stats.clone());
        assert_eq!(stats[0].memory_stop, Some(MemoryStop::Links));
        assert!(!stats[0].converged);
        assert!(stats[0].bytes.counted <= 4 << 20, "{} bytes counted", stats[0].bytes.counted);
        assert!(stats[0].bytes.counted > 3 << 19, "the budget is used: {} bytes", stats[0].bytes.counted);
        assert_bounded(&solved[0].0, &solved[0].1);
        let counts = stats.map(|stats| (stats.links, stats.patches, stats.rays, stats.bytes.counted));
        assert_eq!(counts[0], counts[1]);
        assert!(solved[0].1.vertex_radiosity == solved[1].1.vertex_radiosity, "one thread and three differ");
    }
}

/// Truth: the power that the lamp sends and the walls absorb, which a picture that stopped early
/// has nearly as well.
#[test]
fn more_memory_goes_on_where_less_stopped() {
    let params = SolverParams { epsilon: Epsilon::Relative(1e-4), memory: mebibytes(3), ..SolverParams::default() };
    let mut solver = solver(BuiltinScene::Cornell, params);
    solver.run(&CancelToken::new());
    let stopped = solver.stats();
    assert_eq!(stopped.memory_stop, Some(MemoryStop::Links));
    let more = SolverParams { memory: mebibytes(500), ..params };
    assert_eq!(solver.set_params(more).ok(), Some(ChangeCost::Verdicts));
    solver.run(&CancelToken::new());
    let finished = solver.stats();
    assert_eq!((finished.memory_stop, finished.converged), (None, true));
    assert!(finished.links > 2 * stopped.links, "{} and {} links", stopped.links, finished.links);
    let ratio = stopped.absorbed_watts / finished.absorbed_watts;
    assert!((ratio - 1.0).abs() < 0.1, "{ratio} of the absorbed power");
    // More than enough is no reason to judge anything again.
    let rays = solver.stats().rays;
    assert_eq!(solver.set_params(SolverParams { memory: mebibytes(600), ..params }).ok(), Some(ChangeCost::Nothing));
    solver.run(&CancelToken::new());
    assert_eq!(solver.stats().rays, rays);
}

#[test]
fn a_final_gather_keeps_to_the_budget() {
    let asked = |memory| SolverParams { error: Some(0.01), memory, ..SolverParams::default() };
    let small = MemoryBudget::Bytes(3 << 19);
    // Whichever of leaves and rays comes first.
    let stops = [MemoryStop::Rays, MemoryStop::Vertices];
    for params in [asked(mebibytes(6)), asked(small)] {
        let mut solver = solver(BuiltinScene::Cornell, params);
        solver.run(&CancelToken::new());
        let snapshot = solver.snapshot();
        assert!(
            snapshot.stats.memory_stop.is_some_and(|stop| stops.contains(&stop)),
            "{:?}",
            snapshot.stats.memory_stop
        );
        assert!(snapshot.stats.bytes.counted <= snapshot.stats.bytes.budget, "{:?}", snapshot.stats.bytes);
        assert_bounded(&solver, &snapshot);
    }
}

#[test]
fn a_scene_beyond_the_budget_is_lit_by_its_self_link() {
    let params = SolverParams { memory: mebibytes(1), ..SolverParams::default() };
    let mut solver = solver(BuiltinScene::Office, params);
    solver.run(&CancelToken::new());
    let snapshot = solver.snapshot();
    assert_eq!((snapshot.stats.memory_stop, snapshot.stats.links), (Some(MemoryStop::Scene), 1));
    assert_bounded(&solver, &snapshot);
}
