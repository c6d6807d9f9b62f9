//! How long the present round may still refine, from how its progress went so far.

use std::time::Instant;

use crate::solver::{Phase, Stats};

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

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use super::*;

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
