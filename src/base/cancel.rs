//! One cheap, cloneable token that asks long work to stop.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

/// Shared between the one who asks and the work that looks; looked at inside every long loop.
#[derive(Clone, Debug, Default)]
pub struct CancelToken(Arc<State>);

#[derive(Debug, Default)]
struct State {
    is_cancelled: AtomicBool,
    /// At which look it cancels itself, where looks are counted.
    last_look: Option<u64>,
    looks: AtomicU64,
}

impl CancelToken {
    /// A token that nobody has cancelled.
    pub fn new() -> Self {
        Self::default()
    }

    /// A token that cancels itself at a look of this number: tells without a clock how often work
    /// looks, and how it ends.
    pub fn at_look(number: u64) -> Self {
        Self(Arc::new(State { last_look: Some(number), ..State::default() }))
    }

    /// Asks the work that holds this token to stop.
    pub fn cancel(&self) {
        self.0.is_cancelled.store(true, Ordering::Relaxed);
    }

    /// Lets work start again under the same token.
    pub fn reset(&self) {
        self.0.is_cancelled.store(false, Ordering::Relaxed);
    }

    /// Whether the work should stop.
    pub fn is_cancelled(&self) -> bool {
        if self.0.last_look.is_some_and(|last| self.0.looks.fetch_add(1, Ordering::Relaxed) + 1 >= last) {
            self.cancel();
        }
        self.0.is_cancelled.load(Ordering::Relaxed)
    }

    /// How often work looked at a token of [`CancelToken::at_look`].
    pub fn looks(&self) -> u64 {
        self.0.looks.load(Ordering::Relaxed)
    }
}
