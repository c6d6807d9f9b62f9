//! How far a solve is: one share, from the root's self-link to the certificate.
//!
//! Nobody knows beforehand how many passes over the links, or attempts of a final gather, a target
//! asks for. So each pass and each attempt takes a part of what is left, as large as they usually
//! are; whoever draws a bar keeps it from going back.

use super::Solver;
use super::job::Job;

/// Share of a solve's time that goes into links where a final gather follows.
const LINKS_SHARE: f32 = 0.15;
/// Share of what is left that a pass over the links takes.
const OF_PASS: f32 = 0.5;
/// Share of what is left that an attempt of the final gather takes: most keep their target.
const OF_ATTEMPT: f32 = 0.8;

impl Solver {
    /// Share of the solve that is done.
    pub(super) fn progress(&self) -> f32 {
        let links = if self.is_to_gather() { LINKS_SHARE } else { 1.0 };
        let iterations = self.links.iterations();
        match self.job {
            Job::Refine { .. } => {
                links * nested(iterations, self.links.refinement().progress().unwrap_or(0.0), OF_PASS)
            }
            Job::MergeBack | Job::Recheck | Job::Converge { .. } => links * nested(iterations, 1.0, OF_PASS),
            Job::Gather => {
                let (attempt, share) = self.gather.as_ref().map_or((0, 0.0), crate::gather::Gather::progress);
                links + (1.0 - links) * nested(attempt, share, OF_ATTEMPT)
            }
            Job::Done => 1.0,
        }
    }
}

/// The share done of a whole whose parts each take a share of what is left before them.
fn nested(parts: u32, share_of_next: f32, of_rest: f32) -> f32 {
    let rest = (1.0 - of_rest).powi(parts.min(30) as i32);
    1.0 - rest + rest * of_rest * share_of_next.clamp(0.0, 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Truth: the definition; a part that ends is where the next one begins.
    #[test]
    fn parts_follow_each_other() {
        assert_eq!((nested(0, 0.0, 0.5), nested(0, 1.0, 0.5), nested(1, 0.0, 0.5)), (0.0, 0.5, 0.5));
        assert!((nested(2, 0.5, 0.5) - 0.8125).abs() < 1e-6);
        assert!(nested(100, 1.0, 0.8) <= 1.0);
    }
}
