//! What the tests of the command line share: running it, folders, what it said.

use std::path::Path;
use std::process::{Command, Output};

use serde_json::Value;

pub use crate::folder::Folder;

/// Coarse, so that the development profile solves it in a moment.
pub const COARSE: [&str; 2] = ["--epsilon", "1e-2"];

pub fn selflink(args: &[&str]) -> Output {
    // Whoever runs the tests may log.
    Command::new(env!("CARGO_BIN_EXE_selflink")).args(args).env_remove("RUST_LOG").output().expect("the program runs")
}

/// Runs a command that must succeed; returns what it printed.
pub fn succeed(args: &[&str]) -> (String, String) {
    let output = selflink(args);
    let (stdout, stderr) = (text(&output.stdout), text(&output.stderr));
    assert_eq!(output.status.code(), Some(0), "{args:?}: {stderr}");
    (stdout, stderr)
}

/// Runs a command that must be refused with one sentence and exit code 2; returns the sentence.
pub fn refused(args: &[&str]) -> String {
    let output = selflink(args);
    let stderr = text(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{args:?}: {stderr}");
    assert_eq!(stderr.trim_end().lines().count(), 1, "{args:?}: {stderr}");
    assert!(output.stdout.is_empty(), "{args:?}: {}", text(&output.stdout));
    assert!(!stderr.contains("panicked"), "{args:?}: {stderr}");
    stderr
}

pub fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

pub fn name(path: &Path) -> &str {
    path.to_str().expect("temporary folders have plain names")
}

/// The statistics of a coarse solve.
pub fn stats(scene: &str, args: &[&str]) -> Value {
    let (stdout, _) = succeed(&[&["solve", scene, "--stats", "-"], &COARSE[..], args].concat());
    serde_json::from_str(&stdout).expect("stdout is pure JSON")
}

pub const SQUARE: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\n\
                      usemtl floor\nf 1 2 3 4\nusemtl roof\nf 8 7 6 5\n";
