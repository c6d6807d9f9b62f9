//! What a test leaves out where something is missing.

use std::io::Write;

/// Says beside the test's result that something was left out; fails where all must be there: where
/// the variable `CI` is set.
pub fn left_out(what: &str) {
    assert!(std::env::var_os("CI").is_none_or(|value| value.is_empty()), "left out, though CI is set: {what}");
    // The handle itself: what macros print is not shown of tests that pass.
    let _ = writeln!(std::io::stderr(), "LEFT OUT: {what}");
}
