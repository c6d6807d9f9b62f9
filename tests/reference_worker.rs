//! The reference's thread: it measures what the error meter finds, and never keeps anybody waiting.

#[path = "support/waiting.rs"]
mod waiting;

use std::sync::Arc;
use std::time::Duration;

use selflink::base::cancel::CancelToken;
use selflink::measure::accuracy::ErrorMeter;
use selflink::measure::reference::{Cache, LEAST_PASSES, ReferenceRun, random_points};
use selflink::measure::reference_worker::{GOAL, Measurement, ReferenceWorker};
use selflink::scene::builtin::BuiltinScene;
use selflink::scene::{Scene, Sides};
use selflink::solve::{Epsilon, Snapshot, Solver, SolverParams};
use waiting::wait_for;

fn solved(scene: BuiltinScene, epsilon: f64) -> (Arc<Scene>, Arc<Snapshot>) {
    let (scene, occluders) = selflink::geometry::orient::apply(scene.build(), Sides::Front);
    let scene = Arc::new(scene);
    let params = SolverParams { epsilon: Epsilon::Relative(epsilon), ..SolverParams::default() };
    let mut solver = Solver::new(scene.clone(), Arc::new(occluders), params, 1).expect("usable parameters");
    solver.run(&CancelToken::new());
    let snapshot = Arc::new(solver.snapshot());
    (scene, snapshot)
}

fn reference_worker() -> ReferenceWorker {
    ReferenceWorker::spawn(Box::new(|| {})).expect("a thread")
}

/// Truth: the meter itself with the reference that the cache holds in the end. Lamps are known, so
/// nothing is said about them.
#[test]
fn it_measures_what_the_meter_finds() {
    let (scene, snapshot) = solved(BuiltinScene::Cornell, 1e-2);
    let folder = tempfile::tempdir().expect("a folder");
    let reference_worker = reference_worker();
    reference_worker.begin(scene.clone(), 250, Some(Cache::new(folder.path())));
    reference_worker.measure(snapshot.clone());
    let is_last =
        |measured: &Arc<Measurement>| measured.error.reference_noise <= selflink::measure::reference_worker::GOAL;
    let measured = wait_for("the last measurement", || reference_worker.report().measured.filter(is_last));
    assert!(Arc::ptr_eq(&measured.snapshot, &snapshot));
    assert_eq!(measured.differences.len(), snapshot.mesh.positions.len());
    let known = measured.differences.iter().filter(|difference| difference.is_finite()).count();
    assert!(known > 0 && known < measured.differences.len(), "{known} vertices but the lamp's are known");
    reference_worker.forget();
    wait_for("forgetting", || (!reference_worker.report().is_active).then_some(()));

    let points: Arc<[_]> = random_points(&scene, 250, 1).into();
    let mut run = ReferenceRun::new(&scene, points, 1);
    assert!(Cache::new(folder.path()).load(&mut run), "the reference is kept on disk");
    let expected = ErrorMeter::new(Arc::new(run.reference())).measure(&snapshot);
    assert_eq!(measured.error, expected);
    assert!(
        (0.05..0.6).contains(&expected.displayed.rms),
        "a coarse solution is some tens of percent off: {expected:?}"
    );
}

/// Truth: the passes that were made in the end. Early on the estimate is within a factor of two,
/// and later, when the paths go where they are needed, closer.
#[test]
fn it_knows_how_many_passes_are_left() {
    let (scene, _) = solved(BuiltinScene::Cornell, 1e-1);
    let points: Arc<[_]> = random_points(&scene, 250, 1).into();
    let mut run = ReferenceRun::new(&scene, points, 1);
    let mut told = Vec::new();
    loop {
        assert!(run.pass(&CancelToken::new()));
        let noise = run.reference().noise();
        if run.passes() >= LEAST_PASSES && noise <= GOAL {
            break;
        }
        if run.passes() >= LEAST_PASSES {
            told.push((run.passes(), run.passes_left(noise, GOAL)));
        }
    }
    let all = f64::from(run.passes());
    for (passes, left) in told {
        let ratio = (f64::from(passes) + left) / all;
        assert!((0.4..2.5).contains(&ratio), "{passes} of {all} passes: {left} left");
    }
}

/// A pass over many points takes long; a person who stops it, or opens another scene, does not wait
/// for its end. How often a pass looks at its token is counted in `tests/accuracy/reference.rs`.
#[test]
fn it_stops_in_the_middle_of_a_pass() {
    let (scene, snapshot) = solved(BuiltinScene::Seminar { polygons: 2008 }, 1e-1);
    let reference_worker = reference_worker();
    reference_worker.begin(scene, 16_000, None);
    reference_worker.measure(snapshot);
    wait_for("the first pass", || reference_worker.report().is_active.then_some(()));
    std::thread::sleep(Duration::from_millis(100));
    reference_worker.forget();
    wait_for("stopping", || (!reference_worker.report().is_active).then_some(()));
    assert!(reference_worker.report().measured.is_none());
}
