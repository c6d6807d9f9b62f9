//! A progress bar on stderr, where that is a terminal.

use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressFinish, ProgressStyle};
use selflink::base::format;
use selflink::solve::{Phase, Solver};
use tracing::level_filters::LevelFilter;

/// Counting what is there looks at every element, so the bar moves only so often.
const INTERVAL: Duration = Duration::from_millis(100);
/// Steps of the bar.
const STEPS: u64 = 1000;

/// The bar; dropping it takes it away.
pub struct Progress {
    bar: ProgressBar,
    shown: Instant,
}

impl Progress {
    /// A bar if stderr is a terminal that no log is written to.
    pub fn start() -> Self {
        let is_logged = LevelFilter::current() != LevelFilter::OFF;
        let target = if is_logged { ProgressDrawTarget::hidden() } else { ProgressDrawTarget::stderr() };
        let style = ProgressStyle::with_template("{elapsed:>4} {bar:24} {msg}");
        let bar = ProgressBar::with_draw_target(Some(STEPS), target)
            .with_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()))
            .with_finish(ProgressFinish::AndClear);
        Self { bar, shown: Instant::now() }
    }

    /// Shows how far the solver is.
    pub fn show(&mut self, solver: &Solver) {
        let bar = &self.bar;
        if bar.is_hidden() || self.shown.elapsed() < INTERVAL {
            return;
        }
        self.shown = Instant::now();
        let stats = solver.stats();
        // Another pass or attempt than was reckoned with does not take the bar back.
        bar.set_position(bar.position().max((f64::from(stats.progress) * STEPS as f64) as u64));
        let phase = match stats.phase {
            Phase::Hierarchy => "building clusters".to_owned(),
            Phase::Refine => format!("pass {}, wave {}", stats.iterations + 1, stats.wave),
            Phase::Reconstruct => "final gather".to_owned(),
            Phase::Gather | Phase::Done => format!("pass {}, gathering", stats.iterations + 1),
        };
        let [links, patches, rays] = [stats.links as u64, stats.patches as u64, stats.rays].map(format::count);
        bar.set_message(format!("{phase}: {links} links, {patches} patches, {rays} rays"));
    }
}

/// A bar for work whose length is not known, where stderr is a terminal; dropping it takes it away.
pub fn spinner() -> ProgressBar {
    let style = ProgressStyle::with_template("{elapsed:>4} {spinner} {msg}");
    ProgressBar::new_spinner()
        .with_style(style.unwrap_or_else(|_| ProgressStyle::default_spinner()))
        .with_finish(ProgressFinish::AndClear)
}
