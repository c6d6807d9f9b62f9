//! How far a solve is, as a bar shows it, how long it may still take, and how long the solver has
//! been working since it last reported.

use std::time::{Duration, Instant};

use crate::solve::{Phase, Snapshot, SolverParams, Stats};
use crate::worker::RunState;

/// Progress must have gone so far before it is extrapolated.
const LEAST_PROGRESS: f32 = 0.03;
/// Share of the time so far by which the present pace is judged: the last rays of a solve come
/// slower than its first links.
const RECENT: f64 = 1.0 / 3.0;

/// How far the solve is, and how long it has been working.
#[derive(Default)]
pub struct Progress {
    /// The share that is done.
    pub course: Course,
    /// Time since the worker last reported.
    pub clock: Clock,
}

/// The course of a solve: a share that never goes back while the same is asked for.
#[derive(Default)]
pub struct Course {
    of: Option<Solve>,
    share: f32,
    /// Time of the solve when it last reported, s.
    total: f64,
    /// Times of the solve, s, at which the share grew, and how large it was then.
    grown: Vec<(f64, f32)>,
}

/// The present solve, and where the bar began.
struct Solve {
    generation: u64,
    params: SolverParams,
    /// Emitted power Φ, W.
    power: f64,
    is_done: bool,
    /// Time of the solve, s, and share done.
    begun: (f64, f32),
}

impl Course {
    /// The share of the solve that is done, 0..1.
    pub fn share(&self) -> f32 {
        self.share
    }

    /// Seconds that the solve may still take, this long after it last reported. `None` where that
    /// cannot be known: at the beginning, and while nothing is known to go on.
    pub fn seconds(&self, after: f64) -> Option<f64> {
        let of = self.of.as_ref().filter(|of| !of.is_done)?;
        let (now, (since, from)) = (self.total + after, of.begun);
        let (gone, took) = (self.share - from, now - since);
        if gone < LEAST_PROGRESS || took <= 0.0 {
            return None;
        }
        let recently = now - RECENT * took;
        let (then, share) = *self.grown.iter().rev().find(|(at, _)| *at <= recently).unwrap_or(&of.begun);
        let lately = self.share - share;
        let pace = |took: f64, gone: f32| took / f64::from(gone);
        (lately > 0.0).then(|| f64::from(1.0 - self.share) * pace(took, gone).max(pace(now - then, lately)))
    }

    /// Takes up a new picture of a solve with these parameters; one of an earlier step tells
    /// nothing of it.
    pub fn note(&mut self, snapshot: &Snapshot, params: &SolverParams) {
        if snapshot.former_step.is_none() {
            self.note_stats(snapshot.generation, &snapshot.stats, params);
        }
    }

    fn note_stats(&mut self, generation: u64, stats: &Stats, params: &SolverParams) {
        let is_done = stats.phase == Phase::Done;
        let goes_on = |of: &&Solve| {
            let same = of.generation == generation && of.params == *params && of.power == stats.power_watts;
            same && (is_done || !of.is_done)
        };
        if self.of.as_ref().filter(goes_on).is_none() {
            let begun = (stats.seconds.total, stats.progress);
            self.of = Some(Solve { generation, params: *params, power: stats.power_watts, is_done, begun });
            self.share = 0.0;
            self.grown.clear();
        }
        let Some(of) = &mut self.of else { return };
        of.is_done = is_done;
        self.total = stats.seconds.total;
        if stats.progress > self.share {
            self.share = stats.progress;
            self.grown.push((self.total, self.share));
        }
    }
}

/// Time between two looks at the clock; a step of a large scene may take seconds.
pub const TICK: Duration = Duration::from_millis(250);

/// Lets the time that the statistics tell go on while the solver works.
#[derive(Default)]
pub struct Clock {
    working_since: Option<Instant>,
}

impl Clock {
    /// Takes up what the solver is about, and whether its statistics are new.
    pub fn note(&mut self, run: RunState, is_newer: bool) {
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
    pub fn seconds(&self) -> Option<f64> {
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

    /// Truth: a quarter in two seconds leaves six seconds for the other three; the bar does not go
    /// back within a solve, and begins again with another one.
    #[test]
    fn the_bar_never_goes_back_and_tells_what_is_left() {
        let params = SolverParams::usual();
        let stats = |progress, total| {
            let seconds = crate::solve::Seconds { total, ..Default::default() };
            Stats { phase: Phase::Refine, progress, seconds, ..Stats::default() }
        };
        let mut course = Course::default();
        course.note_stats(1, &stats(0.0, 0.0), &params);
        assert_eq!((course.share(), course.seconds(0.0)), (0.0, None));
        course.note_stats(1, &stats(0.25, 2.0), &params);
        assert!((course.seconds(0.0).expect("a quarter is enough") - 6.0).abs() < 1e-6);
        course.note_stats(1, &stats(0.1, 3.0), &params);
        assert_eq!(course.share(), 0.25);
        let finer = SolverParams { error: Some(0.02), ..params };
        course.note_stats(1, &stats(0.1, 4.0), &finer);
        assert_eq!((course.share(), course.seconds(0.0)), (0.1, None));
        course.note_stats(1, &Stats { phase: Phase::Done, ..stats(1.0, 9.0) }, &finer);
        assert_eq!((course.share(), course.seconds(0.0)), (1.0, None));
        course.note_stats(1, &stats(0.0, 9.0), &finer);
        assert_eq!(course.share(), 0.0, "a lamp was changed");
    }

    /// Truth: by hand. Half in 5 s and a twentieth in the next 5 s leave nine times that, not
    /// another 8 s; and while nothing has been heard for long, nothing is said.
    #[test]
    fn a_solve_that_slows_down_is_not_about_to_end() {
        let params = SolverParams::usual();
        let stats = |progress, total| {
            let seconds = crate::solve::Seconds { total, ..Default::default() };
            Stats { phase: Phase::Reconstruct, progress, seconds, ..Stats::default() }
        };
        let mut course = Course::default();
        for (progress, total) in [(0.0, 0.0), (0.5, 5.0), (0.55, 10.0)] {
            course.note_stats(1, &stats(progress, total), &params);
        }
        assert!((course.seconds(0.0).expect("it goes on") - 45.0).abs() < 1e-3);
        assert!(course.seconds(4.0).is_some_and(|left| left > 60.0));
        assert_eq!(course.seconds(6.0), None, "nothing has come of the last third");
    }
}
