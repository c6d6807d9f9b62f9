//! The loop of the solver's thread: take up commands, do one step, show what is there.

use std::sync::Arc;
use std::sync::mpsc::{Receiver, Sender};
use std::time::Instant;

use rayon::ThreadPool;

use super::guard::{guarded, pool_of};
use super::loader::{Awaited, Loaders, Prepared};
use super::merge::merge;
use super::pacing::Pacing;
use super::stage::MaterialEdit;
use super::{Command, Event, Look, Message, RunState, Shared, Status};
use crate::cancel::CancelToken;
use crate::solver::{MomentInfo, Solver, SolverParams, Step};
use crate::threads::lock;

/// The thread's ends of its channels.
pub(super) struct Ends {
    pub messages: Receiver<Message>,
    /// For loaders, which answer on the channel that commands come by.
    pub loopback: Sender<Message>,
    pub events: Sender<Event>,
    pub shared: Arc<Shared>,
    pub cancel: CancelToken,
    pub wake: Box<dyn Fn() + Send>,
}

/// Whether a person wants the solver to go on.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Drive {
    Run,
    Pause,
    /// So many waves to go before it pauses.
    Waves(u32),
}

/// Everything the thread owns; scenes and their loaders are handled in [`super::stage`].
pub(super) struct Session {
    pub(super) ends: Ends,
    /// As a person last set them; the solver's differ while faces are being turned.
    pub(super) params: SolverParams,
    pub(super) pool: Option<ThreadPool>,
    pub(super) prepared: Option<Box<Prepared>>,
    pub(super) solver: Option<Solver>,
    pub(super) generation: u64,
    pub(super) drive: Drive,
    /// Whether the scene that is being loaded starts running: it does, unless somebody paused after asking for it.
    pub(super) runs_when_loaded: bool,
    finished: bool,
    /// Loaders whose result is awaited: of a new scene, and of the present one made anew.
    pub(super) loading: Option<Awaited>,
    pub(super) remaking: Option<Awaited>,
    pub(super) tickets: u64,
    pub(super) loaders: Loaders,
    pacing: Pacing,
    /// A picture is owed whatever the pacing says.
    picture_owed: bool,
    look: Look,
    /// Steps that were told of.
    moments: Arc<[MomentInfo]>,
    /// Generation and number of changes that they stand for.
    told: (u64, u64),
    /// A person waits for what comes of the first step.
    hurries: bool,
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
            runs_when_loaded: true,
            finished: false,
            loading: None,
            remaking: None,
            tickets: 0,
            loaders: Loaders::default(),
            pacing: Pacing::default(),
            picture_owed: false,
            look: Look::default(),
            moments: Arc::default(),
            told: (0, 0),
            hurries: false,
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
            if self.picture_owed {
                self.publish_picture();
                self.hurries = true;
            }
            if any {
                self.publish_status();
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
        // The session holds a sender itself, so the channel never closes before a Shutdown arrives.
        let first = if self.has_work() { None } else { self.ends.messages.recv().ok() };
        // Before the channel is emptied: whoever sends after that cancels after that.
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
            Command::Load(..) => self.runs_when_loaded = true,
            Command::Pause | Command::StepWave => self.runs_when_loaded = false,
            _ => {}
        }
        match command {
            Command::Load(source, light) => self.load(source, light),
            Command::CancelLoad => self.loading = None,
            Command::SetParams(params) => self.set_params(params),
            Command::Pause => {
                self.drive = Drive::Pause;
                self.picture_owed = true;
            }
            Command::Resume => self.drive = Drive::Run,
            Command::StepWave if self.finished => self.drive = Drive::Pause,
            Command::StepWave => {
                self.drive = match self.drive {
                    Drive::Waves(count) => Drive::Waves(count + 1),
                    Drive::Run | Drive::Pause => Drive::Waves(1),
                };
            }
            Command::Restart => {
                if let Err(sentence) = self.start_solver() {
                    self.emit(Event::SolveFailed(sentence));
                }
            }
            Command::Look(look) => {
                self.look = look;
                self.picture_owed = true;
            }
            Command::SetEmission { material, emission } => {
                self.edit_material(material, MaterialEdit::Emission(emission));
            }
            Command::SetReflectance { material, reflectance } => {
                self.edit_material(material, MaterialEdit::Reflectance(reflectance));
            }
            Command::AnchorEpsilon => self.anchor_epsilon(),
            Command::AddCeilingLight { size, exitance } => self.add_ceiling_light(size, exitance),
            Command::SetGroups(members) => self.set_groups(members),
            Command::SaveSidecar { camera } => self.save_sidecar(camera),
            // Seen by `run`.
            Command::Shutdown => {}
        }
    }

    /// The least work that takes the present solution to new parameters; refused ones change nothing.
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
            // The other parameters come into force with the turned scene.
            return self.remake(None);
        }
        if self.remaking.as_ref().is_some_and(|awaited| awaited.lights.is_empty()) {
            // The sides were set back before the turned scene came.
            self.remaking = None;
        }
        let in_place = match self.solver.as_mut() {
            Some(solver) => {
                guarded(self.pool.as_ref(), || solver.set_params(params).map_err(|error| error.to_string()))
            }
            None => Ok(false),
        };
        let outcome = match in_place {
            Ok(true) => {
                self.refine_again();
                Ok(())
            }
            Ok(false) => self.rebuild_solver(),
            Err(sentence) => Err(sentence),
        };
        if let Err(sentence) = outcome {
            self.params = former;
            if let Some(solver) = self.solver.as_mut() {
                // The solver that stays goes by the parameters that stay, which it has had before.
                let _ = guarded(self.pool.as_ref(), || solver.set_params(former).map_err(|error| error.to_string()));
            }
            self.emit(Event::SolveFailed(sentence));
        }
    }

    /// A new solver takes over.
    pub(super) fn install(&mut self, mut solver: Solver) {
        self.generation += 1;
        self.look.moment = None;
        solver.keep_history();
        self.solver = Some(solver);
        self.finished = false;
        self.picture_owed = true;
    }

    /// The present solver has something to do again.
    pub(super) fn refine_again(&mut self) {
        self.finished = false;
        self.picture_owed = true;
    }

    fn advance(&mut self) {
        let Some(solver) = self.solver.as_mut() else { return };
        let cancel = &self.ends.cancel;
        let step = match guarded(self.pool.as_ref(), || Ok(solver.step(cancel))) {
            Ok(step) => step,
            Err(sentence) => return self.give_up(&sentence),
        };
        self.tell_moments();
        let hurries = std::mem::take(&mut self.hurries);
        if hurries && step != Step::Gathered {
            self.pacing.hurry();
        }
        match step {
            Step::Interrupted => {}
            Step::Finished => {
                self.finished = true;
                self.publish_picture();
                self.publish_status();
                self.emit(Event::Finished);
            }
            Step::Refined { wave_ended: false } | Step::Reconstructed { pass_ended: false } => {
                self.publish_picture_when_due()
            }
            Step::Refined { wave_ended: true } | Step::Gathered | Step::Reconstructed { pass_ended: true } => {
                match self.drive {
                    Drive::Waves(count) if count > 1 => {
                        self.drive = Drive::Waves(count - 1);
                        self.publish_picture_when_due();
                    }
                    Drive::Waves(_) => {
                        self.drive = Drive::Pause;
                        self.publish_picture();
                        self.publish_status();
                    }
                    Drive::Run | Drive::Pause => self.publish_picture_when_due(),
                }
            }
        }
        if hurries && step == Step::Gathered {
            // Links were judged, which shows nothing yet; the step behind it will.
            self.pacing.hurry();
        }
    }

    fn publish_picture_when_due(&mut self) {
        if self.pacing.is_due(Instant::now()) {
            self.publish_picture();
        }
    }

    fn publish_picture(&mut self) {
        self.picture_owed = false;
        let Some(solver) = self.solver.as_mut() else { return };
        let begun = Instant::now();
        let look = self.look;
        solver.show_anatomy(look.anatomy);
        let former = |solver: &mut Solver| look.moment.and_then(|moment| solver.snapshot_of(moment));
        let taken = guarded(self.pool.as_ref(), || Ok(former(solver).unwrap_or_else(|| solver.snapshot())));
        let snapshot = match taken {
            Ok(snapshot) => Arc::new(snapshot),
            Err(sentence) => return self.give_up(&sentence),
        };
        self.pacing.taken(begun, Instant::now());
        let former = lock(&self.ends.shared.latest).replace(snapshot);
        // Freed after the lock: a large mesh takes its time.
        drop(former);
        (self.ends.wake)();
    }

    /// Lets the status know of steps that it has not heard of.
    fn tell_moments(&mut self) {
        let Some(solver) = &self.solver else { return };
        if solver.moments_told() != self.told {
            self.told = solver.moments_told();
            self.moments = solver.moments().cloned().collect();
            lock(&self.ends.shared.status).moments = self.moments.clone();
        }
    }

    /// Lets go of a solver that broke; its last picture stays.
    fn give_up(&mut self, sentence: &str) {
        self.solver = None;
        self.publish_status();
        self.emit(Event::SolveFailed(format!("The solver broke ({sentence}); the last picture stays, restart it.")));
    }

    pub(super) fn emit(&self, event: Event) {
        // A window that is gone wants no events.
        let _ = self.ends.events.send(event);
        (self.ends.wake)();
    }

    fn publish_status(&mut self) {
        self.tell_moments();
        let run = match (&self.solver, self.finished, self.drive) {
            (None, ..) => RunState::Idle,
            (_, true, _) => RunState::Finished,
            (_, _, Drive::Pause) => RunState::Paused,
            _ => RunState::Running,
        };
        let awaited = self.loading.as_ref().or(self.remaking.as_ref());
        let loading = awaited.map(|awaited| awaited.name.clone());
        *lock(&self.ends.shared.status) = Status { run, params: self.params, loading, moments: self.moments.clone() };
        (self.ends.wake)();
    }
}
