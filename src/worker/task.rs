//! Tasks of the solver, away from the thread that takes commands.
//!
//! A solver is sent to the pool for each piece of work and comes back with what came of it. Steps
//! stop when they are cancelled; what cannot be interrupted (a picture of a million patches,
//! clusters being built) does not keep the session from answering, and is orphaned when another
//! solver has taken its place: its result is then dropped where it is.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::Sender;
use std::time::Instant;

use rayon::ThreadPool;

use super::loader::panic_message;
use super::{Message, SnapshotRequest};
use crate::base::cancel::CancelToken;
use crate::solve::{MeshError, Snapshot, Solver, Step};

/// Task that a solver is sent to do.
pub(super) enum Task {
    /// One step.
    Step,
    /// A picture.
    Picture(SnapshotRequest),
    /// The error of what is shown.
    Measure,
    /// A change that leaves the solver as it is but for what is asked of it, or puts another one in
    /// its place.
    Change(Box<dyn FnOnce(Option<Solver>) -> Changed + Send>),
}

/// A solver after a change.
pub(super) struct Changed {
    /// The solver, or another one in its place.
    pub solver: Option<Solver>,
    /// Change of the solver, or why there was none.
    pub outcome: Result<Change, String>,
}

/// Kind of a change of solver.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Change {
    /// It has something to do again.
    InPlace,
    /// Another one took over.
    Replaced,
}

/// Result of a task.
pub(super) struct TaskResult {
    /// The number of the task.
    pub ticket: u64,
    /// None where there was none, or where it broke.
    pub solver: Option<Solver>,
    /// Outcome of the task.
    pub outcome: Outcome,
}

/// Outcome of a task.
pub(super) enum Outcome {
    /// A step was made, or not.
    Step(Step),
    /// A picture was taken, begun and ended at these times.
    Picture(Arc<Snapshot>, Instant, Instant),
    /// The error was measured, or cannot be.
    Measured(Option<MeshError>),
    /// Measuring the error was cancelled.
    NotMeasured,
    /// A change was made, or not, for this reason.
    Change(Result<Change, String>),
    /// The solver broke; the panic's sentence.
    Broke(String),
}

/// A solver that works elsewhere.
pub(super) struct InFlight {
    pub ticket: u64,
    cancel: CancelToken,
    is_orphaned: Arc<AtomicBool>,
}

impl InFlight {
    /// Sends a solver to the pool; it comes back as [`Message::TaskResult`].
    pub(super) fn send(
        ticket: u64,
        solver: Option<Solver>,
        task: Task,
        pool: Option<&ThreadPool>,
        inbox: Sender<Message>,
    ) -> Self {
        let in_flight = Self { ticket, cancel: CancelToken::new(), is_orphaned: Arc::default() };
        let (cancel, is_orphaned) = (in_flight.cancel.clone(), in_flight.is_orphaned.clone());
        let task = move || {
            let (solver, outcome) = catch_unwind(AssertUnwindSafe(|| task.work(solver, &cancel)))
                .unwrap_or_else(|panic| (None, Outcome::Broke(panic_message(&*panic).to_owned())));
            if !is_orphaned.load(Ordering::Relaxed) {
                // The session may have ended meanwhile; then nobody waits.
                let _ = inbox.send(Message::TaskResult(Box::new(TaskResult { ticket, solver, outcome })));
            }
        };
        match pool {
            Some(pool) => pool.spawn(task),
            None => rayon::spawn(task),
        }
        in_flight
    }

    /// Asks it to come back as soon as it can.
    pub(super) fn call(&self) {
        self.cancel.cancel();
    }

    /// Nobody waits for it any more.
    pub(super) fn orphan(self) {
        self.is_orphaned.store(true, Ordering::Relaxed);
        self.cancel.cancel();
    }
}

impl Task {
    fn work(self, solver: Option<Solver>, cancel: &CancelToken) -> (Option<Solver>, Outcome) {
        match (self, solver) {
            (Self::Change(change), solver) => {
                let Changed { solver, outcome } = change(solver);
                (solver, Outcome::Change(outcome))
            }
            (Self::Step, Some(mut solver)) => {
                let step = solver.step(cancel);
                (Some(solver), Outcome::Step(step))
            }
            (Self::Picture(request), Some(mut solver)) => {
                let begun = Instant::now();
                solver.show_solution_view(request.solution_view);
                let former = request.former_step.and_then(|step| solver.snapshot_of(step));
                let snapshot = former.unwrap_or_else(|| solver.snapshot());
                (Some(solver), Outcome::Picture(Arc::new(snapshot), begun, Instant::now()))
            }
            (Self::Measure, Some(mut solver)) => {
                let measured = solver.measure_mesh(cancel);
                let is_cancelled = measured.is_none() && cancel.is_cancelled();
                (Some(solver), if is_cancelled { Outcome::NotMeasured } else { Outcome::Measured(measured) })
            }
            (Self::Step | Self::Picture(_) | Self::Measure, None) => (None, Outcome::Step(Step::Finished)),
        }
    }
}
