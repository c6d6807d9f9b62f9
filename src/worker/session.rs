//! The loop of the session's thread: take up commands at once, and send the solver on one task
//! after the other.

mod result;

use std::sync::Arc;
use std::sync::mpsc::{Receiver, Sender};
use std::time::{Duration, Instant};

use rayon::ThreadPool;

use super::guard::pool_of;
use super::loader::{Awaited, Loaders, Prepared};
use super::merge::merge;
use super::pacing::Pacing;
use super::stage::MaterialEdit;
use super::task::{Change, Changed, InFlight, Task};
use super::{Command, ErrorOfMesh, Event, Message, RunState, Shared, SnapshotRequest, Status};
use crate::base::threads::lock;
use crate::solve::{Solver, SolverParams, TimelineStep};

/// The thread's ends of its channels.
pub(super) struct Ends {
    pub messages: Receiver<Message>,
    /// For loaders, which answer on the channel that commands come by.
    pub loopback: Sender<Message>,
    pub events: Sender<Event>,
    pub shared: Arc<Shared>,
    pub wake: Box<dyn Fn() + Send>,
}

/// A status waits so long for the picture that goes with it: a person who asked for something sees
/// both at once, or soon one.
const STATUS_PATIENCE: Duration = Duration::from_millis(25);

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
    pub(super) pool: Option<Arc<ThreadPool>>,
    pub(super) prepared: Option<Box<Prepared>>,
    /// The solver, while it is not at a task.
    pub(super) solver: Option<Solver>,
    in_flight: Option<InFlight>,
    /// Whether a scene without a solver is to get one: not again where that failed.
    pub(super) wants_solver: bool,
    /// Commands that wait for the solver.
    pub(super) deferred: Vec<Command>,
    pub(super) generation: u64,
    pub(super) drive: Drive,
    /// Whether the scene that is being loaded starts running: it does, unless somebody paused after
    /// asking for it.
    pub(super) runs_when_loaded: bool,
    finished: bool,
    /// Nothing is left to do but the last picture.
    is_finishing: bool,
    /// Error of the present solution as far as it is known, and whether it was measured.
    mesh_error: ErrorOfMesh,
    was_measured: bool,
    /// A status is due by then at the latest: better with the picture that goes with it.
    status_due: Option<Instant>,
    /// Loaders whose result is awaited: of a new scene, and of the present one made anew.
    pub(super) loading: Option<Awaited>,
    pub(super) remaking: Option<Awaited>,
    pub(super) tickets: u64,
    pub(super) loaders: Loaders,
    pacing: Pacing,
    /// A picture is owed whatever the pacing says.
    picture_owed: bool,
    /// A picture is due.
    picture_is_wanted: bool,
    /// Whether the picture that is being taken was owed.
    picture_was_owed: bool,
    /// The generation of the last event of a scene.
    pub(super) announced: u64,
    request: SnapshotRequest,
    /// Steps that were reported.
    steps: Arc<[TimelineStep]>,
    /// Generation and number of changes that they stand for.
    reported: (u64, u64),
    /// A person waits for what comes of the first step.
    hurries: bool,
}

impl Session {
    pub(super) fn new(ends: Ends, params: SolverParams) -> Self {
        Self {
            ends,
            params,
            pool: pool_of(params.threads).map(Arc::new),
            prepared: None,
            solver: None,
            in_flight: None,
            wants_solver: false,
            deferred: Vec::new(),
            generation: 0,
            drive: Drive::Run,
            runs_when_loaded: true,
            finished: false,
            is_finishing: false,
            mesh_error: ErrorOfMesh::default(),
            was_measured: false,
            status_due: None,
            loading: None,
            remaking: None,
            tickets: 0,
            loaders: Loaders::default(),
            pacing: Pacing::default(),
            picture_owed: false,
            picture_is_wanted: false,
            picture_was_owed: false,
            announced: 0,
            request: SnapshotRequest::default(),
            steps: Arc::default(),
            reported: (0, 0),
            hurries: false,
        }
    }

    /// Takes up commands and sends the solver to its tasks, until it is asked to end. It never
    /// waits for one of them.
    pub(super) fn run(mut self) {
        loop {
            for message in self.receive() {
                match message {
                    Message::Command(command) if matches!(*command, Command::Shutdown) => {
                        self.orphan();
                        return;
                    }
                    Message::Command(command) => self.take_up(*command),
                    Message::Prepared(ticket, result) => self.take_prepared(ticket, result),
                    Message::TaskResult(result) => self.take_result(*result),
                }
            }
            self.go_on();
            if self.in_flight.is_none() || self.status_due.is_some_and(|due| Instant::now() >= due) {
                self.publish_due_status();
            }
        }
    }

    /// The messages that come next, bursts merged; sleeps until there is one, or a status is due.
    fn receive(&mut self) -> Vec<Message> {
        let first = match self.status_due {
            None => self.ends.messages.recv().ok(),
            Some(due) => self.ends.messages.recv_timeout(due.saturating_duration_since(Instant::now())).ok(),
        };
        let mut commands = Vec::new();
        let mut others = Vec::new();
        for message in first.into_iter().chain(self.ends.messages.try_iter()) {
            match message {
                Message::Command(command) => commands.push(*command),
                other => others.push(other),
            }
        }
        others.extend(merge(commands).into_iter().map(|command| Message::Command(Box::new(command))));
        others
    }

    fn has_work(&self) -> bool {
        // A scene that another one is about to replace leaves the cores to that one.
        let is_wanted = self.loading.is_none() && self.drive != Drive::Pause;
        self.solver.is_some() && !self.finished && !self.is_finishing && is_wanted
    }

    /// Whether the error of a finished solution is to be found out.
    fn can_measure(&self) -> bool {
        let is_idle = self.finished && !self.was_measured && self.loading.is_none();
        is_idle && self.solver.as_ref().is_some_and(Solver::has_unknown_error)
    }

    /// Obeys at once what needs no solver; the rest waits until it is back from its task, which is
    /// cancelled.
    fn take_up(&mut self, command: Command) {
        if let Some(in_flight) = &self.in_flight {
            in_flight.call();
        }
        tracing::debug!("command {:.200}", format!("{command:?}"));
        self.tell_status_soon();
        match command {
            Command::Load(..) => self.runs_when_loaded = true,
            Command::Pause | Command::StepWave => self.runs_when_loaded = false,
            _ => {}
        }
        match command {
            Command::Load(source, reading, light) => self.load(source, reading, light),
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
            Command::Show(request) => {
                self.request = request;
                self.picture_owed = true;
            }
            Command::SaveSidecar(kept) => self.save_sidecar(kept),
            Command::Restart
            | Command::SetEmission { .. }
            | Command::SetReflectance { .. }
            | Command::AnchorEpsilon
            | Command::SetDaylight(_)
            | Command::SetLuminaires(_)
            | Command::SetGroups(_) => {
                self.deferred.push(command);
                self.deferred = merge(std::mem::take(&mut self.deferred));
            }
            // Seen by `run`.
            Command::Shutdown => {}
        }
    }

    /// Obeys a command for which the solver must be back from its task.
    fn obey(&mut self, command: Command) {
        match command {
            Command::Restart => self.start_solver(),
            Command::SetEmission { material, emission } => {
                self.edit_material(material, MaterialEdit::Emission(emission));
            }
            Command::SetReflectance { material, reflectance } => {
                self.edit_material(material, MaterialEdit::Reflectance(reflectance));
            }
            Command::AnchorEpsilon => self.anchor_epsilon(),
            Command::SetDaylight(spec) => self.set_daylight(&spec),
            Command::SetLuminaires(luminaires) => self.set_luminaires(luminaires),
            Command::SetGroups(members) => self.set_groups(members),
            _ => {}
        }
    }

    /// Takes over new parameters; refused ones change nothing.
    fn set_params(&mut self, params: SolverParams) {
        if params == self.params {
            return;
        }
        if let Err(error) = params.validate() {
            return self.emit(Event::SolveFailed(error.to_string()));
        }
        let former = std::mem::replace(&mut self.params, params);
        // Other parameters may do where the last ones did not.
        self.wants_solver = true;
        if former.threads != params.threads {
            self.pool = pool_of(params.threads).map(Arc::new);
        }
        let Some(prepared) = &self.prepared else { return };
        if prepared.sides != params.sides {
            // The other parameters come into force with the turned scene.
            return self.remake(None);
        }
        if self.remaking.as_ref().is_some_and(|awaited| awaited.luminaires.is_none()) {
            // The sides were set back before the turned scene came.
            self.remaking = None;
        }
    }

    /// Sends the solver, if it is not at a task, to do what is wanted next: new parameters, other
    /// changes, a picture, a step.
    fn go_on(&mut self) {
        if self.in_flight.is_none() {
            self.follow_params();
        }
        while self.in_flight.is_none() && !self.deferred.is_empty() {
            let command = self.deferred.remove(0);
            self.obey(command);
        }
        if self.in_flight.is_some() || self.solver.is_none() {
            return;
        }
        if self.picture_owed || self.picture_is_wanted {
            // What is owed from here on is another one.
            self.picture_was_owed = std::mem::take(&mut self.picture_owed);
            self.picture_is_wanted = false;
            self.send_solver(Task::Picture(self.request));
        } else if self.has_work() {
            self.send_solver(Task::Step);
        } else if self.can_measure() {
            self.mesh_error = ErrorOfMesh::Measuring;
            self.send_solver(Task::Measure);
            self.publish_status();
        }
    }

    /// The least work that takes the present solution to the parameters that are wanted.
    fn follow_params(&mut self) {
        let Some(prepared) = &self.prepared else { return };
        if prepared.sides != self.params.sides {
            return;
        }
        let Some(solver) = &self.solver else {
            if self.wants_solver {
                self.start_solver();
            }
            return;
        };
        if *solver.params() == self.params {
            return;
        }
        let (params, generation) = (self.params, self.generation + 1);
        self.send_solver(Task::Change(Box::new(move |solver| {
            let Some(mut solver) = solver else { return Changed { solver, outcome: Ok(Change::InPlace) } };
            match solver.set_params(params) {
                Ok(cost) if !cost.is_rebuilt() => Changed { solver: Some(solver), outcome: Ok(Change::InPlace) },
                Ok(_) => match solver.rebuilt(params, generation) {
                    Ok(rebuilt) => Changed { solver: Some(rebuilt), outcome: Ok(Change::Replaced) },
                    Err(error) => Changed { solver: Some(solver), outcome: Err(error.to_string()) },
                },
                Err(error) => Changed { solver: Some(solver), outcome: Err(error.to_string()) },
            }
        })));
    }

    /// Sends the solver off with a task.
    pub(super) fn send_solver(&mut self, task: Task) {
        self.tickets += 1;
        let (solver, inbox) = (self.solver.take(), self.ends.loopback.clone());
        self.in_flight = Some(InFlight::send(self.tickets, solver, task, self.pool.as_deref(), inbox));
    }

    /// Lets go of a solver that works elsewhere.
    fn orphan(&mut self) {
        if let Some(in_flight) = self.in_flight.take() {
            in_flight.orphan();
        }
    }

    /// A solver takes over that has just been made.
    pub(super) fn install(&mut self, mut solver: Solver) {
        self.orphan();
        self.generation += 1;
        self.request.former_step = None;
        solver.set_generation(self.generation);
        solver.keep_timeline();
        let former = self.solver.replace(solver);
        self.discard(former);
        self.refine_again();
    }

    /// Frees something large elsewhere: it takes its time.
    pub(super) fn discard<T: Send + 'static>(&self, large: T) {
        match self.pool.as_deref() {
            Some(pool) => pool.spawn(move || drop(large)),
            None => drop(large),
        }
    }

    /// The present solver has something to do again.
    fn refine_again(&mut self) {
        (self.finished, self.is_finishing) = (false, false);
        (self.mesh_error, self.was_measured) = (ErrorOfMesh::Unknown, false);
        self.picture_owed = true;
    }

    pub(super) fn emit(&self, event: Event) {
        match &event {
            Event::LoadFailed(reason) | Event::SolveFailed(reason) | Event::SaveFailed(reason) => {
                tracing::warn!("{reason}");
            }
            Event::SceneLoaded(info) | Event::SceneEdited(info) => {
                tracing::info!(scene = info.scene.name, generation = info.generation, "scene in view");
            }
            Event::Finished => tracing::info!("solve finished"),
            Event::Saved(path) => tracing::info!(file = %path.display(), "written"),
        }
        // A window that is gone wants no events.
        let _ = self.ends.events.send(event);
        (self.ends.wake)();
    }

    /// Tells the status with the next picture, or soon.
    pub(super) fn tell_status_soon(&mut self) {
        self.status_due.get_or_insert_with(|| Instant::now() + STATUS_PATIENCE);
    }

    /// Tells the status that was put off, if one was.
    fn publish_due_status(&mut self) {
        if self.status_due.take().is_some() {
            self.publish_status();
        }
    }

    fn publish_status(&mut self) {
        self.status_due = None;
        self.tell_steps();
        let has_solver = self.solver.is_some() || self.in_flight.is_some();
        let run = match (has_solver, self.finished, self.drive) {
            (false, ..) => RunState::Idle,
            (_, true, _) => RunState::Finished,
            (_, _, Drive::Pause) => RunState::Paused,
            _ => RunState::Running,
        };
        let awaited = self.loading.as_ref().or(self.remaking.as_ref());
        let loading = awaited.map(|awaited| awaited.name.clone());
        *lock(&self.ends.shared.status) =
            Status { run, params: self.params, loading, mesh_error: self.mesh_error, steps: self.steps.clone() };
        (self.ends.wake)();
    }
}
