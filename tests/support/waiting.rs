//! Waiting for a thread that has its own pace.

use std::time::{Duration, Instant};

/// Waits until `found` gives something; panics with `what` when it does not within `patience`.
pub fn wait_within<T>(patience: Duration, what: &str, mut found: impl FnMut() -> Option<T>) -> T {
    let begun = Instant::now();
    while begun.elapsed() < patience {
        if let Some(value) = found() {
            return value;
        }
        std::thread::sleep(Duration::from_millis(1));
    }
    panic!("{what} did not happen within {patience:?}");
}
