//! The loop of the solver's thread: take up commands, do one step, show what is there.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, Sender};
use std::time::Instant;

use glam::Vec3;
use rayon::{ThreadPool, ThreadPoolBuilder};

use super::loader::{self, Job, Prepared, panic_message};
use super::merge::merge;
use super::pacing::Pacing;
use super::{Command, Event, Message, RunState, SceneInfo, Shared, Status, lock};
use crate::cancel::CancelToken;
use crate::hierarchy::ElementId;
use crate::scene::{CameraPose, MaterialId, Scene, Source, edit};
use crate::solver::{Snapshot, Solver, SolverParams, Step};

/// The thread's ends of its channels.
pub(super) struct Ends {
    pub messages: Receiver<Message>,
    pub loopback: Sender<Message>,
    pub events: Sender<Event>,
    pub shared: Arc<Shared>,
    pub cancel: CancelToken,
    pub wake: Box<dyn Fn() + Send>,
}

/// Whether a person wants the solver to go on.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Drive {
    Run,
    Pause,
    /// So many waves to go before it pauses.
    Waves(u32),
}

/// A loader whose result is awaited.
struct Pending {
    ticket: u64,
    name: String,
    is_new: bool,
}

/// Everything the thread owns.
pub(super) struct Session {
    ends: Ends,
    /// As a person last set them; the solver's may differ in their sides while faces are being turned.
    params: SolverParams,
    pool: Option<ThreadPool>,
    prepared: Option<Box<Prepared>>,
    solver: Option<Solver>,
    generation: u64,
    drive: Drive,
    finished: bool,
    inspected: Option<ElementId>,
    pending: Option<Pending>,
    tickets: u64,
    pacing: Pacing,
    /// A picture is owed whatever the pacing says.
    picture_owed: bool,
}

impl Session {
    pub(super) fn new(ends: Ends, params: SolverParams) -> Self {
        Self {
            ends,
            params,
            pool: pool_of(params.threads),
            prepared: None,
            solver: None,
            generation: 0,
            drive: Drive::Run,
            finished: false,
            inspected: None,
            pending: None,
            tickets: 0,
            pacing: Pacing::default(),
            picture_owed: false,
        }
    }

    /// Takes up commands, does one step, shows what is there, until it is told to end.
    pub(super) fn run(mut self) {
        loop {
            let messages = self.receive();
            let any = !messages.is_empty();
            for message in messages {
                match message {
                    Message::Command(Command::Shutdown) => return,
                    Message::Command(command) => self.obey(command),
                    Message::Prepared(ticket, result) => self.take_prepared(ticket, result),
                }
            }
            if any {
                self.publish_status();
            }
            if self.picture_owed {
                self.publish_picture();
            }
            if self.has_work() {
                self.advance();
            }
        }
    }

    fn has_work(&self) -> bool {
        self.solver.is_some() && !self.finished && self.drive != Drive::Pause
    }

    /// All messages that wait, bursts merged; sleeps where there is nothing to do but wait for one.
    fn receive(&self) -> Vec<Message> {
        let mut first = None;
        if !self.has_work() {
            // The session holds a sender itself, so the channel never closes before a Shutdown arrives.
            first = self.ends.messages.recv().ok();
        }
        // Before the channel is emptied: who sends later cancels later.
        self.ends.cancel.reset();
        let mut commands = Vec::new();
        let mut others = Vec::new();
        for message in first.into_iter().chain(self.ends.messages.try_iter()) {
            match message {
                Message::Command(command) => commands.push(command),
                other => others.push(other),
            }
        }
        others.extend(merge(commands).into_iter().map(Message::Command));
        others
    }

    fn obey(&mut self, command: Command) {
        match command {
            Command::Load(source) => {
                let name = name_of(&source);
                self.start_job(Job::Load(source), name);
            }
            Command::CancelLoad => self.pending = self.pending.take().filter(|pending| !pending.is_new),
            Command::SetParams(params) => self.set_params(params),
            Command::Pause => {
                self.drive = Drive::Pause;
                self.picture_owed = self.solver.is_some();
            }
            Command::Resume => self.drive = Drive::Run,
            Command::StepWave => {
                self.drive = match self.drive {
                    Drive::Waves(count) => Drive::Waves(count + 1),
                    Drive::Run | Drive::Pause => Drive::Waves(1),
                };
                if self.finished {
                    self.drive = Drive::Pause;
                }
            }
            Command::Restart => {
                if let Err(sentence) = self.start_solver() {
                    self.emit(Event::SolveFailed(sentence));
                }
            }
            Command::Inspect(element) => self.inspect(element),
            Command::SetEmission { material, emission } => self.set_emission(material, emission),
            Command::AddCeilingLight { size, exitance } => self.add_ceiling_light(size, exitance),
            Command::SaveSidecar { camera } => self.save_sidecar(camera),
            Command::Shutdown => {}
        }
    }

    // Parameters.

    fn set_params(&mut self, params: SolverParams) {
        if params == self.params {
            return;
        }
        if let Err(error) = params.validate() {
            return self.emit(Event::SolveFailed(error.to_string()));
        }
        let former = std::mem::replace(&mut self.params, params);
        if former.threads != params.threads {
            self.pool = pool_of(params.threads);
        }
        let Some(prepared) = &self.prepared else { return };
        if prepared.sides != params.sides {
            // The rest of the parameters comes into force with the turned scene.
            let job = Job::Remake { raw: prepared.raw.clone(), path: prepared.path.clone() };
            return self.start_job(job, "turned faces".into());
        }
        self.pending = self.pending.take().filter(|pending| pending.is_new);
        let in_place = match self.solver.as_mut() {
            Some(solver) => guarded(self.pool.as_ref(), || solver.set_params(params).map_err(|error| error.to_string())),
            None => Ok(false),
        };
        let outcome = match in_place {
            Ok(true) => {
                self.finished = false;
                Ok(())
            }
            Ok(false) => self.start_solver(),
            Err(sentence) => Err(sentence),
        };
        if let Err(sentence) = outcome {
            self.params = former;
            self.emit(Event::SolveFailed(sentence));
        }
    }

    /// A new solver of the present scene with a higher generation; the one that is there stays if that fails.
    fn start_solver(&mut self) -> Result<(), String> {
        let Some(prepared) = &self.prepared else { return Ok(()) };
        let (scene, occluders) = (prepared.scene.clone(), prepared.occluders.clone());
        let solver = self.build_solver(scene, occluders)?;
        self.install(solver);
        Ok(())
    }

    fn build_solver(&self, scene: Arc<Scene>, occluders: Arc<crate::visibility::Occluders>) -> Result<Solver, String> {
        let (params, generation) = (self.params, self.generation + 1);
        guarded(self.pool.as_ref(), move || {
            Solver::new(scene, occluders, params, generation).map_err(|error| error.to_string())
        })
    }

    fn install(&mut self, solver: Solver) {
        self.generation += 1;
        self.solver = Some(solver);
        self.finished = false;
        self.inspected = None;
        self.picture_owed = true;
    }

    // Scenes.

    fn start_job(&mut self, job: Job, name: String) {
        self.tickets += 1;
        let is_new = matches!(job, Job::Load(_));
        let ends = &self.ends;
        let started =
            loader::start(job, self.params.sides, self.tickets, ends.loopback.clone(), ends.cancel.clone());
        match started {
            Ok(()) => self.pending = Some(Pending { ticket: self.tickets, name, is_new }),
            Err(error) => self.emit(Event::LoadFailed(format!("{name} cannot be loaded: no thread is left ({error})."))),
        }
    }

    fn take_prepared(&mut self, ticket: u64, result: Result<Box<Prepared>, String>) {
        let Some(pending) = self.pending.take_if(|pending| pending.ticket == ticket) else { return };
        let adopted = result.and_then(|prepared| {
            let solver = self.build_solver(prepared.scene.clone(), prepared.occluders.clone())?;
            Ok((prepared, solver))
        });
        match adopted {
            Ok((prepared, solver)) => {
                let sides = prepared.sides;
                self.prepared = Some(prepared);
                self.install(solver);
                self.emit_scene(pending.is_new);
                if sides != self.params.sides
                    && let Some(prepared) = &self.prepared
                {
                    let job = Job::Remake { raw: prepared.raw.clone(), path: prepared.path.clone() };
                    self.start_job(job, "turned faces".into());
                }
            }
            Err(sentence) if pending.is_new => self.emit(Event::LoadFailed(sentence)),
            Err(sentence) => {
                if let Some(solver) = &self.solver {
                    self.params = *solver.params();
                }
                self.emit(Event::SolveFailed(sentence));
            }
        }
    }

    fn emit_scene(&self, is_new: bool) {
        let Some(prepared) = &self.prepared else { return };
        let info = Arc::new(SceneInfo {
            scene: prepared.scene.clone(),
            path: prepared.path.clone(),
            generation: self.generation,
            has_light: prepared.scene.emitted_power().max_element() > 0.0,
            skipped: prepared.scene.skipped.sentences(),
            load_seconds: prepared.seconds,
        });
        self.emit(if is_new { Event::SceneLoaded(info) } else { Event::SceneEdited(info) });
    }

    fn inspect(&mut self, element: Option<ElementId>) {
        if let Some(solver) = self.solver.as_mut() {
            solver.inspect(element);
            self.inspected = element;
            self.picture_owed = true;
        }
    }

    fn set_emission(&mut self, material: MaterialId, emission: Vec3) {
        let Some(prepared) = self.prepared.as_mut() else { return };
        let index = material.0 as usize;
        if index >= prepared.scene.materials.len() || !(emission.is_finite() && emission.min_element() >= 0.0) {
            let sentence = "The emission must be a number of W/m² that is not negative, of a material of this scene.";
            return self.emit(Event::SolveFailed(sentence.into()));
        }
        let was_dark = prepared.scene.emitted_power().max_element() <= 0.0;
        Arc::make_mut(&mut prepared.scene).materials[index].emission = emission;
        Arc::make_mut(&mut prepared.raw).materials[index].emission = emission;
        let remake = self.pending.as_ref().is_some_and(|pending| !pending.is_new);
        let job = Job::Remake { raw: prepared.raw.clone(), path: prepared.path.clone() };
        match self.solver.as_mut() {
            // ε relative to a dark scene is 0 W, which cannot stay: the first lamp starts a solve of its own.
            Some(solver) if !was_dark => {
                solver.set_emission(material, emission);
                self.finished = false;
                self.picture_owed = true;
            }
            _ => {
                if let Err(sentence) = self.start_solver() {
                    self.emit(Event::SolveFailed(sentence));
                }
            }
        }
        self.emit_scene(false);
        if remake {
            self.start_job(job, "turned faces".into());
        }
    }

    fn add_ceiling_light(&mut self, size: f32, exitance: Vec3) {
        let Some(prepared) = self.prepared.as_mut() else { return };
        let raw = Arc::make_mut(&mut prepared.raw);
        match edit::add_ceiling_light(raw, size, exitance) {
            Ok(()) => {
                let job = Job::Remake { raw: prepared.raw.clone(), path: prepared.path.clone() };
                self.start_job(job, "the ceiling light".into());
            }
            Err(error) => self.emit(Event::SolveFailed(error.to_string())),
        }
    }

    fn save_sidecar(&mut self, camera: Option<CameraPose>) {
        let Some(prepared) = &self.prepared else { return };
        let _ = (prepared, camera);
    }

    // Work.

    fn advance(&mut self) {
        let Some(solver) = self.solver.as_mut() else { return };
        let cancel = &self.ends.cancel;
        let step = match guarded(self.pool.as_ref(), || Ok(solver.step(cancel))) {
            Ok(step) => step,
            Err(sentence) => return self.fail(sentence),
        };
        match step {
            Step::Refined { wave_ended: false } => {}
            Step::Refined { wave_ended: true } | Step::Gathered => {
                if let Drive::Waves(count) = self.drive {
                    self.drive = if count > 1 { Drive::Waves(count - 1) } else { Drive::Pause };
                    self.picture_owed = true;
                    self.publish_status();
                }
            }
            Step::Finished => {
                self.finished = true;
                self.picture_owed = false;
                self.publish_picture();
                self.publish_status();
                return self.emit(Event::Finished);
            }
            Step::Interrupted => return,
        }
        if self.picture_owed || self.pacing.is_due(Instant::now()) {
            self.publish_picture();
        }
    }

    fn publish_picture(&mut self) {
        self.picture_owed = false;
        let Some(solver) = self.solver.as_mut() else { return };
        let begun = Instant::now();
        let snapshot: Snapshot = match guarded(self.pool.as_ref(), || Ok(solver.snapshot())) {
            Ok(snapshot) => snapshot,
            Err(sentence) => return self.fail(sentence),
        };
        self.pacing.taken(begun, Instant::now());
        let former = lock(&self.ends.shared.latest).replace(Arc::new(snapshot));
        // Freed after the lock: a large mesh takes its time.
        drop(former);
        (self.ends.wake)();
    }

    /// Gives up a solver that broke; its last picture stays.
    fn fail(&mut self, sentence: String) {
        self.solver = None;
        self.publish_status();
        self.emit(Event::SolveFailed(format!("The solver broke ({sentence}): the last picture stays; restart it.")));
    }

    fn emit(&self, event: Event) {
        // A window that is gone wants no events.
        let _ = self.ends.events.send(event);
        (self.ends.wake)();
    }

    fn publish_status(&self) {
        let run = match (&self.solver, self.finished, self.drive) {
            (None, ..) => RunState::Idle,
            (_, true, _) => RunState::Finished,
            (_, _, Drive::Pause) => RunState::Paused,
            _ => RunState::Running,
        };
        let loading = self.pending.as_ref().map(|pending| pending.name.clone());
        *lock(&self.ends.shared.status) = Status { run, params: self.params, loading };
        (self.ends.wake)();
    }
}

/// Runs work on the pool; a panic becomes a sentence.
fn guarded<T: Send>(pool: Option<&ThreadPool>, work: impl FnOnce() -> Result<T, String> + Send) -> Result<T, String> {
    let result = catch_unwind(AssertUnwindSafe(|| match pool {
        Some(pool) => pool.install(work),
        None => work(),
    }));
    result.unwrap_or_else(|panic| Err(panic_message(&*panic).to_owned()))
}

/// A pool of so many threads, 0 for every core; without one, rayon's own serves.
fn pool_of(threads: u32) -> Option<ThreadPool> {
    ThreadPoolBuilder::new().num_threads(threads as usize).thread_name(|index| format!("solver-{index}")).build().ok()
}

fn name_of(source: &Source) -> String {
    match source {
        Source::File(path) => path.file_name().unwrap_or(path.as_os_str()).to_string_lossy().into_owned(),
        Source::Builtin(scene) => scene.name().to_owned(),
    }
}
