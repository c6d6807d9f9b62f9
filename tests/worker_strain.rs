//! The solver's thread under strain: thousands of random commands while it solves.
//!
//! Truth: the protocol. Nobody panics or waits for ever, pictures never run backwards and in the
//! end show what was asked for last, and memory does not grow with the number of commands.
//! `cargo test` sends some of them; `SELFLINK_COMMANDS=10000` all.

#[path = "support/dice.rs"]
mod dice;
#[path = "support/left_out.rs"]
mod left_out;
#[path = "support/waiting.rs"]
mod waiting;

use std::time::Duration;

use dice::Dice;
use glam::Vec3;
use selflink::scene::builtin::BuiltinScene;
use selflink::scene::{Luminaire, LuminaireForm, LuminaireShape, MaterialId, Sides, Source};
use selflink::solve::{ClusteringMode, Epsilon, Reconstruct, SolverParams};
use selflink::transport::{ClusterModel, Push};
use selflink::worker::{Command, Event, RunState, SnapshotRequest, SolverThread};
use waiting::wait_for;

/// Commands where nobody asks for more.
const USUAL_COMMANDS: usize = 2_000;
/// Memory that may be held at the end beyond what was held after a fifth of the commands, bytes:
/// four loaders that nobody waits for any more hold a scene and its occluders each.
const MOST_GROWTH: usize = 256 << 20;

impl Dice {
    fn pick<T: Copy>(&mut self, from: &[T]) -> T {
        from[self.roll(from.len() as u64) as usize]
    }

    fn params(&mut self) -> SolverParams {
        let modes = [ClusteringMode::Adaptive, ClusteringMode::Octree, ClusteringMode::Groups, ClusteringMode::None];
        SolverParams {
            // None of the usual ones, a target error, and errors and thresholds that cannot be
            // used.
            error: self.pick(&[None, None, None, Some(0.2), Some(0.05), Some(7.0)]),
            epsilon: self.pick(&[1e-1, 1e-2, 3e-3, 0.0, f64::NAN].map(Epsilon::Relative)),
            reconstruct: self.pick(&[Reconstruct::Constant, Reconstruct::Vertex, Reconstruct::Gather]),
            clustering: self.pick(&modes),
            octree_depth: 1 + self.roll(6) as u32,
            cluster_model: self.pick(&[ClusterModel::Oriented, ClusterModel::Isotropic]),
            push: self.pick(&[Push::Immediate, Push::Deferred]),
            sides: self.pick(&[None, Some(Sides::Front), Some(Sides::Both), Some(Sides::Auto)]),
            threads: self.roll(4) as u32,
            seed: self.roll(3),
            ..SolverParams::default()
        }
    }

    fn command(&mut self) -> Command {
        let small = BuiltinScene::Seminar { polygons: 300 };
        match self.roll(18) {
            0 => Command::load(Source::Builtin(self.pick(&[BuiltinScene::Cornell, small]))),
            1 => Command::load(Source::File("no/such/room.obj".into())),
            2 | 3 => Command::Pause,
            4 => Command::StepWave,
            5 => Command::Restart,
            6 => Command::Show(SnapshotRequest {
                solution_view: self.roll(2) == 0,
                former_step: (self.roll(3) == 0).then(|| self.roll(20) as usize),
            }),
            7 => {
                let strength = self.pick(&[0.0, 1.0, 1e4, -1.0, f32::NAN]);
                Command::SetEmission { material: MaterialId(self.roll(9) as u32), emission: Vec3::splat(strength) }
            }
            8 => Command::CancelLoad,
            9 => {
                let size = self.pick(&[0.1, 0.0, 1e6]);
                let form = LuminaireForm {
                    shape: LuminaireShape::Disc,
                    centre: Vec3::splat(0.2),
                    direction: Vec3::NEG_Y,
                    turn_deg: 0.0,
                    size,
                };
                let name = "disc light".to_owned();
                Command::SetLuminaires(vec![Luminaire { name, form, exitance: Vec3::ONE }])
            }
            10..=12 => Command::SetParams(self.params()),
            13 => {
                let reflectance = Vec3::splat(self.pick(&[0.0, 0.5, 0.99, 1.0, -1.0, f32::NAN]));
                Command::SetReflectance { material: MaterialId(self.roll(9) as u32), reflectance }
            }
            14 => Command::AnchorEpsilon,
            _ => Command::Resume,
        }
    }
}

/// Memory that the process holds, bytes, where the system tells.
fn resident() -> Option<usize> {
    let text = std::fs::read_to_string("/proc/self/statm").ok()?;
    text.split_whitespace().nth(1)?.parse::<usize>().ok().map(|pages| pages * 4096)
}

#[test]
fn thousands_of_random_commands_leave_it_alive_current_and_small() {
    let commands = std::env::var("SELFLINK_COMMANDS").ok().and_then(|text| text.parse().ok()).unwrap_or(USUAL_COMMANDS);
    let coarse = SolverParams { epsilon: Epsilon::Relative(1e-2), ..SolverParams::default() };
    let worker = SolverThread::spawn(coarse, Box::new(|| {})).expect("a thread is left");
    worker.send(Command::load(Source::Builtin(BuiltinScene::Cornell)));
    let mut dice = Dice(0x5e1f_11a4_2026);
    let (mut newest, mut early, mut pictures) = ((0, 0), None, 0);
    for sent in 0..commands {
        worker.send(dice.command());
        // Mostly in bursts; now and then a solve gets far enough to show something.
        let pause = if dice.roll(20) == 0 { 30_000 } else { 1_000 };
        std::thread::sleep(Duration::from_micros(dice.roll(pause)));
        worker.status();
        if let Some(snapshot) = worker.latest() {
            let this = (snapshot.generation, snapshot.serial);
            assert!(this >= newest, "{this:?} came after {newest:?}");
            pictures += usize::from(this > newest);
            newest = this;
            let shown = snapshot.vertex_radiosity.iter().flatten();
            assert!(shown.into_iter().all(|value| value.is_finite() && *value >= 0.0), "no light at command {sent}");
        }
        while let Some(event) = worker.try_event() {
            if let Event::SolveFailed(sentence) = event {
                assert!(!sentence.contains("broke"), "command {sent}: {sentence}");
            }
        }
        assert!(!worker.has_ended(), "command {sent} ended it");
        if sent == commands / 5 {
            early = resident();
        }
    }
    // What is asked for last is what is shown: none of the scenes and settings before it.
    worker.send(Command::CancelLoad);
    worker.send(Command::SetParams(coarse));
    let last = Source::Builtin(BuiltinScene::Seminar { polygons: 400 });
    worker.send(Command::load(last));
    let polygons = BuiltinScene::Seminar { polygons: 400 }.build().polygons.len();
    let info = wait_for("the last scene", || match worker.try_event() {
        Some(Event::SceneLoaded(info)) if info.scene.polygons.len() == polygons => Some(info),
        _ => None,
    });
    // The event may be there a moment before the status is that of the new scene.
    let snapshot = wait_for("its solution", || {
        let snapshot = worker.latest().filter(|snapshot| snapshot.generation >= info.generation)?;
        (worker.status().run == RunState::Finished && snapshot.stats.converged).then_some(snapshot)
    });
    assert_eq!(snapshot.stats.initial_patches, polygons);
    println!("{commands} commands, {pictures} pictures, {:?} → {:?} MiB", early.map(mib), resident().map(mib));
    match (early, resident()) {
        (Some(early), Some(late)) => {
            assert!(late < early + MOST_GROWTH, "memory grew from {} to {} MiB", mib(early), mib(late));
        }
        _ => left_out::left_out("memory over time; this system does not tell it"),
    }
    // It ends in the midst of work as well.
    worker.send(Command::Restart);
    worker.send(Command::Shutdown);
    wait_for("the end of the thread", || worker.has_ended().then_some(()));
}

fn mib(bytes: usize) -> usize {
    bytes >> 20
}
