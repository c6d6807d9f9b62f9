//! When the next picture may be taken: at most 30 a second, and never for more than a quarter of
//! the thread's time.

use std::time::{Duration, Instant};

/// Shortest time between two pictures.
const INTERVAL: Duration = Duration::from_millis(33);

/// Time to work for each second spent on a picture; 3 leaves a quarter for pictures.
const WORK_PER_PICTURE: u32 = 3;

/// Remembers when the next picture is due.
#[derive(Debug, Default)]
pub(super) struct Pacing {
    next: Option<Instant>,
}

impl Pacing {
    /// Whether a picture may be taken at `now`.
    pub(super) fn is_due(&self, now: Instant) -> bool {
        self.next.is_none_or(|next| now >= next)
    }

    /// Lets the next picture be taken at once: a person waits for it.
    pub(super) fn hurry(&mut self) {
        self.next = None;
    }

    /// Notes a picture that was begun and ended at these times.
    pub(super) fn taken(&mut self, begun: Instant, ended: Instant) {
        let rest = WORK_PER_PICTURE * ended.saturating_duration_since(begun);
        self.next = Some((begun + INTERVAL).max(ended + rest));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn share_of_pictures(cost: Duration, step: Duration) -> (f64, u32) {
        let begun = Instant::now();
        let (mut now, mut spent, mut count) = (begun, Duration::ZERO, 0);
        let mut pacing = Pacing::default();
        while now < begun + Duration::from_secs(10) {
            if pacing.is_due(now) {
                pacing.taken(now, now + cost);
                now += cost;
                spent += cost;
                count += 1;
            }
            now += step;
        }
        (spent.as_secs_f64() / (now - begun).as_secs_f64(), count)
    }

    /// Cheap pictures are bounded by their rate, dear ones by their share of the time.
    #[test]
    fn pictures_stay_within_rate_and_share() {
        let step = Duration::from_millis(1);
        let (_, count) = share_of_pictures(Duration::from_micros(100), step);
        assert!((250..=304).contains(&count), "{count} cheap pictures in 10 s");
        let (share, count) = share_of_pictures(Duration::from_millis(100), step);
        assert!(share <= 0.26 && count >= 20, "{count} dear pictures took {share}");
        let (mut pacing, now) = (Pacing::default(), Instant::now());
        pacing.taken(now, now);
        assert!(!pacing.is_due(now));
        pacing.hurry();
        assert!(pacing.is_due(now));
    }
}
