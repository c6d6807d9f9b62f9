//! A reference as good as asked for: from the cache as far as that goes, then pass by pass.

use std::io;
use std::time::{Duration, Instant};

use super::cache::Cache;
use super::run::{Reference, ReferenceRun};
use crate::base::cancel::CancelToken;

/// The fewest passes after which an error is believed: fewer know no error of their own.
pub const LEAST_PASSES: u32 = 8;
/// The reference is put into the cache so often, so that little is lost with the process.
pub const SAVE_EVERY: Duration = Duration::from_secs(5);

/// When a reference is good enough.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Target {
    /// Noise that suffices, relative RMS of the radiosities ([`Reference::noise`]).
    pub noise: f64,
    /// How long it may take.
    pub limit: Option<Duration>,
}

/// A reference that is asked for.
pub struct Wish {
    /// Random points.
    pub points: usize,
    /// When it is good enough.
    pub target: Target,
    /// Where it is kept.
    pub cache: Option<Cache>,
}

/// How far a reference came.
#[derive(Debug)]
pub struct Outcome {
    /// The reference.
    pub reference: Reference,
    /// Noise of the reference, relative RMS.
    pub noise: f64,
    /// Whether that is as little as was asked for.
    pub reached: bool,
    /// Passes that were in the cache already.
    pub cached_passes: u32,
    /// Passes in all.
    pub passes: u32,
    /// Time spent here, s.
    pub seconds: f64,
    /// Why it could not be put into the cache, if so.
    pub cache_error: Option<io::Error>,
}

/// Makes passes until the noise is low enough, the time over or `cancel` cancelled; `progress`
/// hears of each pass.
pub fn compute(
    run: &mut ReferenceRun,
    cache: Option<&Cache>,
    target: Target,
    cancel: &CancelToken,
    mut progress: impl FnMut(&ReferenceRun, f64),
) -> Outcome {
    let begun = Instant::now();
    if let Some(cache) = cache {
        cache.load(run);
    }
    let cached_passes = run.passes();
    let mut saved = (Instant::now(), cached_passes);
    let mut cache_error = None;
    let mut save = |run: &ReferenceRun, saved: &mut (Instant, u32)| {
        if let Some(cache) = cache
            && run.passes() > saved.1
        {
            cache_error = cache.store(run).err();
            *saved = (Instant::now(), run.passes());
        }
    };
    let mut noise = run.reference().noise();
    let is_over = || target.limit.is_some_and(|limit| begun.elapsed() >= limit);
    let reached = |run: &ReferenceRun, noise: f64| run.passes() >= LEAST_PASSES && noise <= target.noise;
    while !reached(run, noise) && !is_over() && run.pass(cancel) {
        noise = run.reference().noise();
        progress(run, noise);
        if saved.0.elapsed() >= SAVE_EVERY {
            save(run, &mut saved);
        }
    }
    save(run, &mut saved);
    Outcome {
        reference: run.reference(),
        noise,
        reached: reached(run, noise),
        cached_passes,
        passes: run.passes(),
        seconds: begun.elapsed().as_secs_f64(),
        cache_error,
    }
}
