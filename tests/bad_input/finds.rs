//! What the fuzzers found worth keeping: inputs that once broke, hung or took a way of their own through the loaders.

use std::fs;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use crate::inputs;

/// The inputs for one fuzzer.
fn of(fuzzer: &str) -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/bad_input/finds").join(fuzzer);
    let entries = fs::read_dir(&folder).unwrap_or_else(|error| panic!("{}: {error}", folder.display()));
    let mut paths: Vec<PathBuf> = entries.map(|entry| entry.expect("a readable folder").path()).collect();
    paths.sort();
    assert!(!paths.is_empty(), "{} is empty", folder.display());
    paths
}

/// Truth: what `inputs` asserts of every scene and every error.
fn replay(fuzzer: &str, try_it: fn(&[u8])) {
    for path in of(fuzzer) {
        let data = fs::read(&path).expect("a readable file");
        let begun = Instant::now();
        let outcome = std::panic::catch_unwind(|| try_it(&data));
        assert!(outcome.is_ok(), "{} breaks it", path.display());
        assert!(begun.elapsed() < Duration::from_secs(5), "{} takes {:?}", path.display(), begun.elapsed());
    }
}

#[test]
fn obj() {
    replay("obj", inputs::obj);
}

#[test]
fn glb() {
    replay("glb", inputs::glb);
}

#[test]
fn sidecar() {
    replay("sidecar", inputs::sidecar);
}
