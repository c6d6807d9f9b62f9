//! Materials and ε edited while the solver's thread works, and what is kept of it.
//!
//! Truth: the protocol itself.

#[path = "support/waiting.rs"]
mod waiting;

use glam::Vec3;
use selflink::scene::builtin::BuiltinScene;
use selflink::scene::{Kept, Sidecar, Source};
use selflink::solve::{Epsilon, SolverParams};
use selflink::worker::{Command, Event, RunState, SolverThread};
use waiting::wait_for;

fn by(epsilon: f64) -> SolverParams {
    SolverParams { epsilon: Epsilon::Relative(epsilon), ..SolverParams::default() }
}

fn solved(source: Source, params: SolverParams) -> SolverThread {
    let worker = SolverThread::spawn(params, Box::new(|| {})).expect("a thread is left");
    worker.send(Command::load(source));
    wait_for("loading", || worker.try_event().filter(|event| matches!(event, Event::SceneLoaded(_))));
    finish(&worker);
    worker
}

fn finish(worker: &SolverThread) {
    wait_for("finishing", || (worker.status().run == RunState::Finished).then_some(()));
}

fn edited(worker: &SolverThread) -> std::sync::Arc<selflink::worker::SceneInfo> {
    wait_for("the edit", || match worker.try_event()? {
        Event::SceneEdited(info) => Some(info),
        _ => None,
    })
}

/// Truth: what was set is in the sidecar and there again when the file is opened anew; a dark
/// scene's lamp is one that is on.
#[test]
fn reflectances_and_dimmed_lamps_are_saved() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("corner.obj");
    let walls =
        "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nusemtl wall\nf 1 2 3 4\nusemtl floor\nf 1 5 6 2\n";
    std::fs::write(&path, walls).expect("the room is written");
    let worker = solved(Source::File(path.clone()), by(1e-2));
    let scene = worker.latest().expect("a picture");
    assert!(scene.vertex_radiosity.iter().flatten().all(|value| *value == 0.0), "nothing emits");
    let [wall, floor] = [0, 1].map(selflink::scene::MaterialId);

    worker.send(Command::SetEmission { material: wall, emission: Vec3::new(8.0, 6.0, 4.0) });
    edited(&worker);
    worker.send(Command::SetEmission { material: wall, emission: Vec3::new(4.0, 3.0, 2.0) });
    edited(&worker);
    worker.send(Command::SetReflectance { material: floor, reflectance: Vec3::new(0.2, 0.4, 0.97) });
    let info = edited(&worker);
    assert_eq!(info.scene.materials[1].reflectance, Vec3::new(0.2, 0.4, 0.97));
    finish(&worker);
    for wrong in [Vec3::splat(1.0), Vec3::splat(-0.1), Vec3::splat(f32::NAN)] {
        worker.send(Command::SetReflectance { material: floor, reflectance: wrong });
        wait_for("the refusal", || match worker.try_event()? {
            Event::SolveFailed(sentence) => sentence.contains("between 0 and 0.99").then_some(()),
            _ => None,
        });
    }
    worker.send(Command::SaveSidecar(Kept::default()));
    wait_for("saving", || worker.try_event().filter(|event| matches!(event, Event::Saved(_))));
    let written = Sidecar::read(&Sidecar::path_for(&path)).expect("what was saved");
    assert_eq!(written.materials["floor"].reflectance, Some(Vec3::new(0.2, 0.4, 0.97)));
    assert_eq!(written.materials["floor"].emission, None);
    assert_eq!(written.materials["wall"].emission, Some(Vec3::new(4.0, 3.0, 2.0)));

    worker.send(Command::load(Source::File(path)));
    let again = wait_for("loading", || match worker.try_event()? {
        Event::SceneLoaded(info) => Some(info),
        _ => None,
    });
    assert_eq!(again.scene.materials[1].reflectance, Vec3::new(0.2, 0.4, 0.97));
}

/// Truth: ε's own numbers. A dimmed lamp leaves ε in watts where it was; anchored anew it is the
/// same share of less.
#[test]
fn epsilon_stays_in_watts_until_it_is_anchored_anew() {
    let worker = solved(Source::Builtin(BuiltinScene::Cornell), by(1e-2));
    let before = worker.latest().expect("a picture").stats.clone();
    assert_eq!(before.power_watts, before.anchor_watts);
    worker.send(Command::load(Source::Builtin(BuiltinScene::Cornell)));
    let info = wait_for("loading", || match worker.try_event()? {
        Event::SceneLoaded(info) => Some(info),
        _ => None,
    });
    let lamp = info.scene.materials.iter().position(|material| material.emission != Vec3::ZERO).expect("a lamp");
    let emission = 0.5 * info.scene.materials[lamp].emission;
    worker.send(Command::SetEmission { material: selflink::scene::MaterialId(lamp as u32), emission });
    edited(&worker);
    finish(&worker);
    let dimmed = worker.latest().expect("a picture").stats.clone();
    assert_eq!((dimmed.epsilon_watts, dimmed.anchor_watts), (before.epsilon_watts, before.anchor_watts));
    assert!((dimmed.power_watts / before.power_watts - 0.5).abs() < 1e-6);
    worker.send(Command::AnchorEpsilon);
    let anchored = wait_for("the new ε", || {
        let stats = &worker.latest()?.stats;
        (stats.epsilon_watts < 0.9 * before.epsilon_watts).then(|| stats.clone())
    });
    assert_eq!(anchored.anchor_watts, anchored.power_watts);
    assert!((anchored.epsilon_watts / before.epsilon_watts - 0.5).abs() < 1e-6);
    finish(&worker);
}
