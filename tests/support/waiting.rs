//! Waiting for a thread that has its own pace.

use std::time::{Duration, Instant};

/// A guard against waiting for ever, and no measure of speed: what has not happened by then does
/// not happen, on a machine however busy.
const HANG: Duration = Duration::from_secs(120);

/// Waits until `found` gives something; panics with `what` when it hangs.
pub fn wait_for<T>(what: &str, mut found: impl FnMut() -> Option<T>) -> T {
    let begun = Instant::now();
    while begun.elapsed() < HANG {
        if let Some(value) = found() {
            return value;
        }
        std::thread::sleep(Duration::from_millis(1));
    }
    panic!("{what} did not happen within {HANG:?}");
}
