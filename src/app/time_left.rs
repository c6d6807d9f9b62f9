//! Times between snapshots: how long the present round may still refine, from how its progress went so far, and how long
//! the solver has been working since it last told.

use std::time::{Duration, Instant};

use crate::solver::{Phase, Stats};
use crate::worker::RunState;

/// Progress must have gone so far before it is extrapolated.
const LEAST_PROGRESS: f32 = 0.03;

/// Remembers where the present round began to tell.
#[derive(Default)]
pub(super) struct TimeLeft {
    begun: Option<Begun>,
    seconds: Option<f64>,
}

struct Begun {
    phase: Phase,
    iterations: u32,
    at: Instant,
    progress: f32,
}

impl TimeLeft {
    /// Seconds to the end of the present round's refinement, where that can be told.
    pub(super) fn seconds(&self) -> Option<f64> {
        self.seconds
    }

    /// Takes up new statistics.
    pub(super) fn note(&mut self, stats: &Stats) {
        self.note_at(stats, Instant::now());
    }

    fn note_at(&mut self, stats: &Stats, now: Instant) {
        self.seconds = None;
        let Some(progress) = stats.progress.filter(|_| stats.phase != Phase::Done) else {
            self.begun = None;
            return;
        };
        let same = |begun: &Begun| {
            (begun.phase, begun.iterations) == (stats.phase, stats.iterations) && progress >= begun.progress
        };
        match self.begun.as_ref().filter(|begun| same(begun)) {
            Some(begun) => {
                let gone = progress - begun.progress;
                if gone >= LEAST_PROGRESS {
                    let speed = f64::from(gone) / now.saturating_duration_since(begun.at).as_secs_f64().max(1e-6);
                    self.seconds = Some(f64::from(1.0 - progress) / speed);
                }
            }
            None => {
                let (phase, iterations) = (stats.phase, stats.iterations);
                self.begun = Some(Begun { phase, iterations, at: now, progress });
            }
        }
    }
}

/// Time between two looks at the clock; a step of a large scene may take seconds.
pub(super) const TICK: Duration = Duration::from_millis(250);

/// Lets the time that the statistics tell go on while the solver works.
#[derive(Default)]
pub(super) struct Clock {
    working_since: Option<Instant>,
}

impl Clock {
    /// Takes up what the solver is about, and whether its statistics are new.
    pub(super) fn note(&mut self, run: RunState, is_newer: bool) {
        self.note_at(run, is_newer, Instant::now());
    }

    fn note_at(&mut self, run: RunState, is_newer: bool, now: Instant) {
        self.working_since = match self.working_since {
            _ if run != RunState::Running => None,
            Some(since) if !is_newer => Some(since),
            _ => Some(now),
        };
    }

    /// Seconds of work that the statistics do not hold yet; `None` while nothing is done.
    pub(super) fn seconds(&self) -> Option<f64> {
        self.seconds_at(Instant::now())
    }

    fn seconds_at(&self, now: Instant) -> Option<f64> {
        self.working_since.map(|since| now.saturating_duration_since(since).as_secs_f64())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The clock goes on from the last statistics, and only while there is work.
    #[test]
    fn the_clock_runs_between_snapshots_and_stands_in_a_pause() {
        let start = Instant::now();
        let at = |seconds| start + Duration::from_secs(seconds);
        let mut clock = Clock::default();
        clock.note_at(RunState::Running, true, start);
        clock.note_at(RunState::Running, false, at(2));
        assert_eq!(clock.seconds_at(at(3)), Some(3.0));
        clock.note_at(RunState::Running, true, at(4));
        assert_eq!(clock.seconds_at(at(5)), Some(1.0));
        clock.note_at(RunState::Paused, false, at(6));
        assert_eq!(clock.seconds_at(at(7)), None);
        clock.note_at(RunState::Running, false, at(9));
        assert_eq!(clock.seconds_at(at(10)), Some(1.0), "the pause does not count");
        clock.note_at(RunState::Finished, true, at(11));
        assert_eq!(clock.seconds_at(at(12)), None);
    }

    /// A quarter in two seconds leaves six seconds for the other three; a new round starts anew.
    #[test]
    fn progress_is_extrapolated_within_a_round() {
        let now = Instant::now();
        let stats = |iterations, progress| Stats {
            phase: Phase::Refine,
            iterations,
            progress: Some(progress),
            ..Stats::default()
        };
        let mut left = TimeLeft::default();
        left.note_at(&stats(1, 0.0), now);
        assert_eq!(left.seconds(), None);
        left.note_at(&stats(1, 0.25), now + Duration::from_secs(2));
        assert!((left.seconds().expect("a quarter is enough") - 6.0).abs() < 1e-6);
        left.note_at(&stats(2, 0.5), now + Duration::from_secs(3));
        assert_eq!(left.seconds(), None);
    }
}
