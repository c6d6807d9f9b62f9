//! Content that the window asks of snapshots, and the walk through the steps of a solve.

use std::time::Duration;

use crate::solve::Snapshot;
use crate::worker::{Command, SnapshotRequest};

/// Each step stays in view for this long while they are played, unless its picture takes longer.
const STEP_TIME: Duration = Duration::from_millis(450);
/// Time for which each step is shown to somebody who studies them.
const STUDY_TIME: Duration = Duration::from_millis(1500);

/// The step in view, and what was last asked for.
#[derive(Default)]
pub struct Playback {
    asked: SnapshotRequest,
    /// The step that a person looks at; `None` for the present.
    pub step: Option<usize>,
    /// When the present step came into view while steps are being played, by the window's clock,
    /// seconds.
    playing_since: Option<f64>,
    /// Whether steps are played slowly.
    is_slow: bool,
    generation: u64,
}

impl Playback {
    /// Whether steps are being played.
    pub fn is_playing(&self) -> bool {
        self.playing_since.is_some()
    }

    /// Plays the steps, from the first one where the present is in view, or stops playing.
    pub fn play_or_stop(&mut self, now: f64) {
        if self.playing_since.take().is_none() {
            (self.playing_since, self.is_slow) = (Some(now), false);
            self.step = Some(self.step.unwrap_or(0));
        }
    }

    /// Plays the steps slowly, from the first one.
    pub fn study(&mut self, now: f64) {
        (self.playing_since, self.is_slow, self.step) = (Some(now), true, Some(0));
    }

    fn step_time(&self) -> Duration {
        if self.is_slow { STUDY_TIME } else { STEP_TIME }
    }

    /// Shows a step, or the present; nothing is played any longer.
    pub fn show(&mut self, step: Option<usize>) {
        self.step = step;
        self.playing_since = None;
    }

    /// Takes the next step when its time has come; how long until the one after, while steps are
    /// played.
    pub fn play(&mut self, now: f64, shown: Option<&Snapshot>, steps: usize) -> Option<Duration> {
        let since = self.playing_since?;
        if shown.is_none_or(|snapshot| snapshot.former_step != self.step) {
            // Its picture is still being made.
            self.playing_since = Some(now);
            return Some(self.step_time());
        }
        let left = self.step_time().as_secs_f64() - (now - since);
        if left > 0.0 {
            return Some(Duration::from_secs_f64(left));
        }
        let next = self.step.map_or(0, |step| step + 1);
        if next < steps {
            (self.step, self.playing_since) = (Some(next), Some(now));
            return Some(self.step_time());
        }
        self.show(None);
        None
    }

    /// Another solve has other steps.
    pub fn follow(&mut self, snapshot: &Snapshot) {
        if snapshot.generation != self.generation {
            self.generation = snapshot.generation;
            self.asked.former_step = None;
            self.show(None);
        }
    }

    /// Command that asks for another content than was asked for last, where it differs.
    pub fn command(&mut self, wants_solution_view: bool) -> Option<Command> {
        let request = SnapshotRequest { solution_view: wants_solution_view, former_step: self.step };
        (request != self.asked).then(|| {
            self.asked = request;
            Command::Show(request)
        })
    }
}
