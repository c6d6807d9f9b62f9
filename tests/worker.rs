//! The solver's thread, driven as a window drives it.
//!
//! Truth: the protocol itself (what is sent is taken up, nothing is lost, generations never run
//! backwards).

#[path = "support/waiting.rs"]
mod waiting;

use std::collections::BTreeSet;

use selflink::scene::builtin::BuiltinScene;
use selflink::scene::{
    CameraPose, Kept, Luminaire, LuminaireForm, LuminaireShape, MaterialId, Sidecar, Sides, Source, TaskArea,
};
use selflink::solve::{ClusteringMode, Epsilon, SolverParams};
use selflink::worker::{Command, ErrorOfMesh, Event, RunState, SnapshotRequest, SolverThread};
use waiting::wait_for;

fn coarse() -> SolverParams {
    SolverParams { epsilon: Epsilon::Relative(1e-2), ..SolverParams::default() }
}

fn spawn(params: SolverParams) -> SolverThread {
    SolverThread::spawn(params, Box::new(|| {})).expect("a thread is left")
}

fn wait_for_event(worker: &SolverThread, what: &str, wanted: impl Fn(&Event) -> bool) -> Event {
    wait_for(what, || worker.try_event().filter(&wanted))
}

fn load(worker: &SolverThread, scene: BuiltinScene) {
    worker.send(Command::load(Source::Builtin(scene)));
    wait_for_event(worker, "loading", |event| matches!(event, Event::SceneLoaded(_)));
}

fn wait_until_finished(worker: &SolverThread) {
    wait_for("finishing", || (worker.status().run == RunState::Finished).then_some(()));
}

#[test]
fn a_scene_is_loaded_shown_and_finished() {
    let worker = spawn(coarse());
    load(&worker, BuiltinScene::Cornell);
    wait_for_event(&worker, "the end of the solve", |event| matches!(event, Event::Finished));
    let snapshot = worker.latest().expect("a finished solve shows its picture");
    assert_eq!(snapshot.generation, 1);
    assert!(!snapshot.mesh.triangles.is_empty());
    assert_eq!(snapshot.vertex_radiosity.len(), snapshot.mesh.positions.len());
}

#[test]
fn a_pause_holds_and_a_step_moves_one_wave() {
    let worker = spawn(coarse());
    worker.send(Command::load(Source::Builtin(BuiltinScene::Cornell)));
    worker.send(Command::Pause);
    let first = wait_for("the first picture", || worker.latest());
    assert_eq!(worker.status().run, RunState::Paused);
    // Each of these is answered by a picture, before which a solve that goes on would take a step.
    let mut still = first.clone();
    for solution_view in [true, false, true] {
        worker.send(Command::Show(SnapshotRequest { solution_view, former_step: None }));
        still = wait_for("the picture that was asked for", || {
            worker.latest().filter(|snapshot| snapshot.serial > still.serial)
        });
    }
    assert_eq!(still.stats.pairs_judged, first.stats.pairs_judged, "a paused solve went on");

    let mut judged = first.stats.pairs_judged;
    for _ in 0..3 {
        let before = worker.latest().expect("a picture is there").serial;
        worker.send(Command::StepWave);
        let next = wait_for("the picture of a step", || {
            worker.latest().filter(|snapshot| snapshot.serial > before && worker.status().run == RunState::Paused)
        });
        assert!(next.stats.pairs_judged >= judged);
        judged = next.stats.pairs_judged;
    }
    worker.send(Command::Resume);
    wait_until_finished(&worker);
}

/// Truth: a pause is for the scene that was paused.
#[test]
fn a_newly_opened_scene_runs() {
    let worker = spawn(coarse());
    worker.send(Command::load(Source::Builtin(BuiltinScene::Cornell)));
    worker.send(Command::Pause);
    wait_for("the pause", || (worker.latest().is_some() && worker.status().run == RunState::Paused).then_some(()));
    worker.send(Command::load(Source::File("no/such/room.obj".into())));
    wait_for_event(&worker, "the failure", |event| matches!(event, Event::LoadFailed(_)));
    assert_eq!(worker.status().run, RunState::Paused, "a scene that stays stays paused");
    load(&worker, BuiltinScene::Cornell);
    wait_until_finished(&worker);
}

#[test]
fn a_failing_load_keeps_the_scene_that_is_there() {
    let worker = spawn(coarse());
    load(&worker, BuiltinScene::Cornell);
    wait_until_finished(&worker);
    let before = worker.latest().expect("a picture");
    worker.send(Command::load(Source::File("no/such/room.obj".into())));
    let failure = wait_for_event(&worker, "the failure", |event| matches!(event, Event::LoadFailed(_)));
    let Event::LoadFailed(sentence) = failure else { panic!("{failure:?}") };
    assert!(sentence.contains("room.obj"), "{sentence}");
    assert_eq!(worker.latest().expect("the picture stays").generation, before.generation);
    wait_for("the end of the load", || worker.status().loading.is_none().then_some(()));

    // The scene that stayed can still be worked on.
    worker.send(Command::SetEmission { material: MaterialId(0), emission: glam::Vec3::splat(3.0) });
    let after = wait_for_event(&worker, "the edit", |event| matches!(event, Event::SceneEdited(_)));
    let Event::SceneEdited(info) = after else { panic!("{after:?}") };
    assert_eq!(info.scene.materials[0].emission, glam::Vec3::splat(3.0));
}

/// Truth: counts of tested links. A scene that another one is about to replace leaves it the cores
/// (it sends no more than the picture that is owed at the command), and goes on where that fails.
#[test]
fn the_old_scene_rests_while_another_is_opened() {
    let worker = spawn(SolverParams { epsilon: Epsilon::Relative(1e-5), ..SolverParams::default() });
    load(&worker, BuiltinScene::Seminar { polygons: BuiltinScene::SEMINAR_POLYGONS });
    let old = wait_for("some links", || worker.latest().filter(|snapshot| snapshot.stats.pairs_judged > 1000));
    // Large enough that the old scene would send many pictures while it is made.
    worker.send(Command::load(Source::Builtin(BuiltinScene::Seminar { polygons: 300_000 })));
    wait_for("the load", || worker.status().loading.is_some().then_some(()));
    let judged = || worker.latest().map(|snapshot| (snapshot.generation, snapshot.stats.pairs_judged));
    let mut counts = BTreeSet::from([judged()]);
    wait_for("the other scene", || {
        let now = judged().filter(|&(generation, _)| generation == old.generation);
        counts.insert(now);
        now.is_none().then_some(())
    });
    counts.remove(&None);
    assert!(counts.len() <= 2, "{counts:?}");

    worker.send(Command::load(Source::File("no/such/room.obj".into())));
    wait_for_event(&worker, "the failure", |event| matches!(event, Event::LoadFailed(_)));
    let before = judged();
    wait_for("going on", || (judged() > before || worker.status().run == RunState::Finished).then_some(()));
}

/// Truth: the solution at hand. A solve by ε tells its error after its links have settled; a change
/// takes that back.
#[test]
fn a_solve_by_threshold_tells_its_error() {
    let worker = spawn(coarse());
    load(&worker, BuiltinScene::Cornell);
    wait_until_finished(&worker);
    let measured = |worker: &SolverThread| match worker.status().mesh_error {
        ErrorOfMesh::Measured(found) => Some(found),
        ErrorOfMesh::Unknown | ErrorOfMesh::Measuring => None,
    };
    let found = wait_for("its error", || measured(&worker));
    assert!(found.p90 > 0.05 && found.standard_error > 0.0 && found.points >= 60, "{found:?}");
    worker.send(Command::SetParams(SolverParams { epsilon: Epsilon::Relative(1e-4), ..coarse() }));
    wait_for("the change", || measured(&worker).is_none().then_some(()));
    let finer = wait_for("its error", || measured(&worker));
    assert!(finer.p90 < found.p90, "{finer:?} {found:?}");
}

#[test]
fn parameters_are_taken_over_or_refused_with_a_sentence() {
    let worker = spawn(coarse());
    load(&worker, BuiltinScene::Cornell);
    let octree = SolverParams { clustering: ClusteringMode::Octree, octree_depth: 3, ..coarse() };
    worker.send(Command::SetParams(octree));
    wait_for("the new generation", || worker.latest().filter(|snapshot| snapshot.generation >= 2));
    assert_eq!(worker.status().params, octree);

    worker.send(Command::SetParams(SolverParams { rays_min: 9, rays_max: 3, ..octree }));
    wait_for_event(&worker, "the refusal", |event| matches!(event, Event::SolveFailed(_)));
    assert_eq!(worker.status().params, octree, "refused parameters must not stay");
    wait_until_finished(&worker);
}

fn square(size: f32, exitance: f32) -> Luminaire {
    let centre = glam::Vec3::new(0.2, 0.3, 0.2);
    let form = LuminaireForm { shape: LuminaireShape::Square, centre, direction: -glam::Vec3::Y, turn_deg: 0.0, size };
    Luminaire { name: "square light".into(), form, exitance: glam::Vec3::splat(exitance) }
}

#[test]
fn light_can_be_brought_into_a_scene() {
    let worker = spawn(coarse());
    load(&worker, BuiltinScene::Cornell);
    wait_until_finished(&worker);
    let before = worker.latest().expect("a picture").mesh.leaves.iter().map(|leaf| leaf.area).sum::<f32>();
    worker.send(Command::SetLuminaires(vec![square(0.2, 10.0)]));
    let event = wait_for_event(&worker, "the lamp", |event| matches!(event, Event::SceneEdited(_)));
    let Event::SceneEdited(info) = event else { panic!("{event:?}") };
    assert!(info.has_light);
    let snapshot =
        wait_for("its picture", || worker.latest().filter(|snapshot| snapshot.generation >= info.generation));
    let after = snapshot.mesh.leaves.iter().map(|leaf| leaf.area).sum::<f32>();
    assert!(after > before, "the lamp has an area: {before} m² before, {after} m² after");
    // Another exitance alone keeps the solution; another place makes the scene anew, and none takes
    // the lamp away.
    worker.send(Command::SetLuminaires(vec![square(0.2, 20.0)]));
    let dimmed = wait_for_event(&worker, "the brighter lamp", |event| matches!(event, Event::SceneEdited(_)));
    let Event::SceneEdited(dimmed) = dimmed else { panic!("{dimmed:?}") };
    assert_eq!(dimmed.generation, info.generation, "nothing is solved from scratch");
    assert_eq!(dimmed.scene.luminaires(), [square(0.2, 20.0)]);
    worker.send(Command::SetLuminaires(Vec::new()));
    let bare = wait_for_event(&worker, "the scene without it", |event| matches!(event, Event::SceneEdited(_)));
    let Event::SceneEdited(bare) = bare else { panic!("{bare:?}") };
    assert!(bare.generation > info.generation && bare.scene.placed_luminaires.is_empty());
    // What cannot be used is refused, and changes nothing.
    worker.send(Command::SetLuminaires(vec![square(0.0, 1.0)]));
    wait_for_event(&worker, "the refusal", |event| matches!(event, Event::SolveFailed(_)));
}

/// Truth: every face has a second side then, and the room's area doubles (f32 sums of some 20
/// faces: 1e-4).
#[test]
fn changed_sides_remake_the_scene() {
    let worker = spawn(coarse());
    load(&worker, BuiltinScene::Cornell);
    let area = |snapshot: &selflink::solve::Snapshot| snapshot.mesh.leaves.iter().map(|leaf| leaf.area).sum::<f32>();
    let once = area(&wait_for("the first picture", || worker.latest()));
    worker.send(Command::SetParams(SolverParams { sides: Some(Sides::Both), ..coarse() }));
    wait_for_event(&worker, "the doubled faces", |event| matches!(event, Event::SceneEdited(_)));
    let twice = area(&wait_for("their picture", || worker.latest().filter(|snapshot| snapshot.generation == 2)));
    assert!((twice / once - 2.0).abs() < 1e-4, "{once} m² became {twice} m²");
}

/// Truth: what was changed is there again when the file is opened anew, and so is what an earlier
/// sidecar ignored.
#[test]
fn a_saved_sidecar_brings_the_changes_back() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("corner.obj");
    let walls = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\n\
        usemtl wall\nf 1 2 3 4\nusemtl floor\nf 1 5 6 2\nusemtl pane\nf 5 6 3\n";
    std::fs::write(&path, walls).expect("the room is written");
    let ignoring = r#"{"materials": {"floor": {"reflectance": [0.2, 0.3, 0.4]}, "pane": {"ignore": true}}}"#;
    std::fs::write(path.with_extension("selflink.json"), ignoring).expect("the sidecar is written");

    let worker = spawn(coarse());
    let open = || {
        worker.send(Command::load(Source::File(path.clone())));
        match wait_for_event(&worker, "loading", |event| matches!(event, Event::SceneLoaded(_))) {
            Event::SceneLoaded(info) => info,
            event => panic!("{event:?}"),
        }
    };
    let info = open();
    assert_eq!(info.scene.polygons.len(), 2, "the pane is ignored");
    let wall = info.scene.material_named("wall").expect("a wall");
    worker.send(Command::SetEmission { material: wall, emission: glam::Vec3::new(1.0, 2.0, 3.0) });
    let eye = glam::Vec3::new(0.5, 0.5, 3.0);
    let camera = CameraPose { eye, target: glam::Vec3::ZERO, up: glam::Vec3::Y, hfov_deg: 50.0 };
    worker.send(Command::SetLuminaires(vec![square(0.2, 10.0)]));
    let has_panel =
        |event: &Event| matches!(event, Event::SceneEdited(info) if !info.scene.placed_luminaires.is_empty());
    wait_for_event(&worker, "the lamp", has_panel);
    let corners = [glam::Vec3::new(0.2, 0.7, 0.1), glam::Vec3::new(0.8, 0.7, 0.6)];
    let task_area = TaskArea { corners, height: 0.7, average_lux: 300.0, uniformity: 0.6 };
    let kept = Kept { camera: Some(camera), bookmarks: vec![camera, camera], task_area: Some(task_area) };
    worker.send(Command::SaveSidecar(kept));
    wait_for_event(&worker, "saving", |event| matches!(event, Event::Saved(_)));
    let written = Sidecar::read(&Sidecar::path_for(&path)).expect("what was saved");
    assert_eq!(written.materials.keys().collect::<Vec<_>>(), ["floor", "pane", "wall"], "{written:?}");
    assert_eq!(written.materials["wall"].reflectance, None, "it is as the file says");

    let again = open();
    let wall = again.scene.material_named("wall").expect("a wall");
    assert_eq!(again.scene.materials[wall.0 as usize].emission, glam::Vec3::new(1.0, 2.0, 3.0));
    assert_eq!(again.scene.camera, Some(camera));
    assert_eq!((&again.scene.bookmarks, again.scene.task_area), (&vec![camera, camera], Some(task_area)));
    assert_eq!(again.scene.polygons.len(), 3, "the pane is still ignored, and the lamp is there");
    assert_eq!((again.scene.placed_luminaires.len(), &again.skipped), (1, &info.skipped));
    let floor = again.scene.material_named("floor").expect("a floor");
    assert_eq!(again.scene.materials[floor.0 as usize].reflectance, glam::Vec3::new(0.2, 0.3, 0.4));
}
