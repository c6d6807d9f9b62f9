//! Results that a solver comes back with: steps, pictures, changes.

use std::sync::Arc;
use std::time::Instant;

use super::super::task::{Change, Outcome, TaskResult};
use super::super::{ErrorOfMesh, Event};
use super::{Drive, Session};
use crate::base::threads::lock;
use crate::solve::{Snapshot, Step};

impl Session {
    /// Takes up what a solver comes back with.
    pub(super) fn take_result(&mut self, result: TaskResult) {
        if self.in_flight.as_ref().is_none_or(|in_flight| in_flight.ticket != result.ticket) {
            return self.discard(result.solver);
        }
        self.in_flight = None;
        self.solver = result.solver;
        match result.outcome {
            Outcome::Step(step) => self.note_step(step),
            Outcome::Picture(snapshot, begun, ended) => {
                self.pacing.taken(begun, ended);
                self.publish_picture(snapshot);
            }
            Outcome::Measured(found) => {
                self.was_measured = true;
                self.mesh_error = found.map_or(ErrorOfMesh::Unknown, ErrorOfMesh::Measured);
                self.publish_status();
            }
            Outcome::NotMeasured => {
                self.mesh_error = ErrorOfMesh::Unknown;
                self.tell_status_soon();
            }
            Outcome::Change(Ok(Change::InPlace)) => self.refine_again(),
            Outcome::Change(Ok(Change::Replaced)) => {
                if let Some(solver) = self.solver.take() {
                    self.install(solver);
                }
            }
            Outcome::Change(Err(sentence)) => {
                if let Some(solver) = &self.solver {
                    self.params = *solver.params();
                } else {
                    self.wants_solver = false;
                }
                self.publish_status();
                self.take_back_announcement();
                self.emit(Event::SolveFailed(sentence));
            }
            Outcome::Broke(sentence) => self.give_up(&sentence),
        }
    }

    fn note_step(&mut self, step: Step) {
        self.tell_steps();
        let hurries = std::mem::take(&mut self.hurries);
        if hurries && step != Step::Gathered {
            self.pacing.hurry();
        }
        match step {
            Step::Interrupted => {}
            Step::Finished => {
                self.is_finishing = true;
                self.picture_owed = true;
            }
            Step::Refined { wave_ended: false } | Step::Reconstructed { pass_ended: false } => self.want_picture(),
            Step::Refined { wave_ended: true } | Step::Gathered | Step::Reconstructed { pass_ended: true } => {
                match self.drive {
                    Drive::Waves(count) if count > 1 => {
                        self.drive = Drive::Waves(count - 1);
                        self.want_picture();
                    }
                    Drive::Waves(_) => {
                        self.drive = Drive::Pause;
                        self.picture_owed = true;
                        self.tell_status_soon();
                    }
                    Drive::Run | Drive::Pause => self.want_picture(),
                }
            }
        }
        if hurries && step == Step::Gathered {
            // Links were judged, which shows nothing yet; the step behind it will.
            self.pacing.hurry();
        }
    }

    /// A picture comes next, if it is due.
    fn want_picture(&mut self) {
        self.picture_is_wanted = self.pacing.is_due(Instant::now());
    }

    fn publish_picture(&mut self, snapshot: Arc<Snapshot>) {
        let former = lock(&self.ends.shared.latest).replace(snapshot);
        self.discard(former);
        self.hurries |= std::mem::take(&mut self.picture_was_owed) && !self.is_finishing;
        (self.ends.wake)();
        if self.is_finishing {
            (self.finished, self.is_finishing) = (true, false);
            self.publish_status();
            self.emit(Event::Finished);
        } else if !self.picture_owed {
            self.publish_due_status();
        }
    }

    /// Lets the status know of steps that it has not heard of.
    pub(super) fn tell_steps(&mut self) {
        let Some(solver) = &self.solver else { return };
        if solver.kept_steps_state() != self.reported {
            self.reported = solver.kept_steps_state();
            self.steps = solver.kept_steps().cloned().collect();
            lock(&self.ends.shared.status).steps = self.steps.clone();
        }
    }

    /// Lets go of a solver that broke; its last picture stays.
    fn give_up(&mut self, sentence: &str) {
        (self.solver, self.wants_solver) = (None, false);
        self.publish_status();
        self.take_back_announcement();
        self.emit(Event::SolveFailed(format!("The solver broke ({sentence}); the last picture stays, restart it.")));
    }

    /// A solver that was announced has not come: the one that there is shows the scene.
    fn take_back_announcement(&mut self) {
        if self.announced > self.generation {
            self.announce_scene(false, self.generation);
        }
    }
}
