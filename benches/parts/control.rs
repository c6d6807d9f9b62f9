//! How soon control comes back: commands in the middle of the longest steps there are, and the
//! first pictures after a change.
//!
//! The classroom, half a million triangles, is loaded, clustered, refined, gathered, drawn and
//! looked into, and at random moments somebody pauses, cancels, asks for another scene or for other
//! settings; the time until the solver's thread has taken that up is the time that a person waits.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::time::{Duration, Instant};

use selflink::base::random::hash64;
use selflink::scene::Source;
use selflink::scene::builtin::BuiltinScene;
use selflink::solve::{ClusteringMode, Epsilon, Phase, Reconstruct, Snapshot, SolverParams};
use selflink::worker::{Command, Event, RunState, SnapshotRequest, SolverThread, Status};

use super::{Goal, Table};

/// Each phase is disturbed for so long at most.
const PHASE: Duration = Duration::from_secs(2);
/// A person waits no longer than this for control to come back, ms.
const MOST_WAIT: f64 = 50.0;
/// On a machine that others use as well a thread that is ready may wait for a core: the slowest
/// answer may take so many times as long, half of the answers may not.
const CROWDED: f64 = 6.0;

fn wait_for<T>(mut found: impl FnMut() -> Option<T>) -> T {
    loop {
        if let Some(value) = found() {
            return value;
        }
        std::thread::sleep(Duration::from_micros(200));
    }
}

fn by(epsilon: f64) -> SolverParams {
    SolverParams { epsilon: Epsilon::Relative(epsilon), ..SolverParams::default() }
}

fn load(worker: &SolverThread, source: Source) {
    worker.send(Command::load(source));
    wait_for(|| worker.try_event().filter(|event| matches!(event, Event::SceneLoaded(_))));
}

/// Pictures after a change in the office: the first, and the first that shows the change.
pub fn changes(table: &mut Table) {
    let worker = SolverThread::spawn(by(1e-3), Box::new(|| {})).expect("a thread is left");
    load(&worker, Source::Builtin(BuiltinScene::Office));
    let rebuilt = SolverParams { clustering: ClusteringMode::Groups, ..by(3e-3) };
    let changes = [("ε / 3", by(3e-4)), ("ε × 3", by(1e-3)), ("ε × 9", by(3e-3)), ("other clusters", rebuilt)];
    for (name, params) in changes {
        wait_for(|| (worker.status().run == RunState::Finished).then_some(()));
        let before = worker.latest().expect("a finished solve has a picture");
        let begun = Instant::now();
        worker.send(Command::SetParams(params));
        let order = |of: &Snapshot| (of.generation, of.serial);
        let newer = || worker.latest().filter(|latest| order(latest) > order(&before));
        wait_for(newer);
        let first = begun.elapsed();
        let is_changed =
            |latest: &Snapshot| latest.generation > before.generation || latest.stats.patches != before.stats.patches;
        wait_for(|| newer().filter(|latest| is_changed(latest)));
        for (picture, time) in [("a picture", first), ("the change in view", begun.elapsed())] {
            table.line(&format!("office, {name}: {picture}"), milliseconds(time), "ms", Goal::AtMost(MOST_WAIT), "");
        }
    }
}

/// Times until the thread had taken up a command, ms, by the work that it interrupted.
struct Waits {
    times: BTreeMap<&'static str, Vec<f64>>,
    /// Random moments drawn.
    moments: u64,
}

impl Waits {
    /// Sends a command and waits until the status shows that it was taken up.
    fn ask(&mut self, worker: &SolverThread, about: &'static str, command: Command, shows: impl Fn(&Status) -> bool) {
        let asked = Instant::now();
        worker.send(command);
        wait_for(|| shows(&worker.status()).then_some(()));
        self.times.entry(about).or_default().push(milliseconds(asked.elapsed()));
    }

    /// Waits for a random time of up to so many milliseconds.
    fn pause(&mut self, most: u64) {
        self.moments += 1;
        std::thread::sleep(Duration::from_millis(hash64(0x5e1f, self.moments) % most));
    }

    /// Lets commands fall upon the thread until something holds, or the time of a phase is over:
    /// pauses, since whoever pauses sees that it was heard.
    fn disturb(&mut self, worker: &SolverThread, about: &'static str, until: impl Fn(&SolverThread) -> bool) {
        let begun = Instant::now();
        while !until(worker) && begun.elapsed() < PHASE {
            self.pause(150);
            if worker.status().run == RunState::Running {
                self.ask(worker, about, Command::Pause, |status| status.run != RunState::Running);
                self.ask(worker, about, Command::Resume, |status| status.run != RunState::Paused);
            }
        }
    }
}

/// Commands to a large scene in each phase of its solve.
pub fn commands(table: &mut Table) {
    let folder = std::env::var_os("SELFLINK_SCENES").map(PathBuf::from).unwrap_or_default();
    let path = folder.join("classroom/classroom.glb");
    if !path.is_file() {
        eprintln!("commands to a large scene are left out: SELFLINK_SCENES has no classroom/classroom.glb");
        return;
    }
    let params = by(1e-2);
    let worker = SolverThread::spawn(params, Box::new(|| {})).expect("a thread is left");
    let mut waits = Waits { times: BTreeMap::new(), moments: 0 };
    let classroom = Source::File(path);

    // While the file is read, its occluders and its clusters are built: twice given up, each by a
    // loader of its own.
    for _ in 0..2 {
        waits.ask(&worker, "a load", Command::load(classroom.clone()), |status| status.loading.is_some());
        waits.pause(1500);
        waits.ask(&worker, "a load given up", Command::CancelLoad, |status| status.loading.is_none());
    }
    load(&worker, classroom);
    let is_phase = |phase: Phase| {
        move |worker: &SolverThread| worker.latest().is_some_and(|snapshot| snapshot.stats.phase == phase)
    };
    waits.disturb(&worker, "the first picture", |worker| worker.latest().is_some());
    waits.disturb(&worker, "refinement", is_phase(Phase::Gather));
    waits.disturb(&worker, "gathering", is_phase(Phase::Done));
    worker.send(Command::Show(SnapshotRequest { solution_view: true, former_step: None }));
    worker.send(Command::SetParams(by(5e-3)));
    waits.disturb(&worker, "the solution's view", is_phase(Phase::Done));
    worker.send(Command::Show(SnapshotRequest::default()));
    worker.send(Command::SetParams(SolverParams { reconstruct: Reconstruct::Gather, ..params }));
    waits.disturb(&worker, "the final gather", is_phase(Phase::Done));
    // Other clusters, given up for a small scene.
    for clustering in [ClusteringMode::Octree, ClusteringMode::Adaptive] {
        let params = SolverParams { clustering, ..params };
        waits.ask(&worker, "other clusters", Command::SetParams(params), |status| status.params == params);
        waits.pause(800);
    }
    let small = Command::load(Source::Builtin(BuiltinScene::Cornell));
    waits.ask(&worker, "another scene", small, |status| status.loading.is_some());

    for (about, mut times) in waits.times {
        times.sort_by(f64::total_cmp);
        let what = format!("{} commands; median", times.len());
        // One answer alone is no median: the bound for the slowest of them holds for it.
        let goal = if times.len() == 1 { Goal::None } else { Goal::AtMost(MOST_WAIT) };
        table.line(&format!("classroom, control during {about}"), times[times.len() / 2], "ms", goal, &what);
        let slow = times[times.len() * 99 / 100];
        let goal = Goal::AtMost(CROWDED * MOST_WAIT);
        table.line(&format!("classroom, control during {about}, at worst"), slow, "ms", goal, "99 of 100");
    }
}

fn milliseconds(time: Duration) -> f64 {
    1e3 * time.as_secs_f64()
}
