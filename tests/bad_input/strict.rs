//! What the tests of hostile files share: loading that must not hang, the one sentence, a program
//! that has little memory.

use std::path::{Path, PathBuf};
use std::sync::mpsc::{self, RecvTimeoutError};
use std::thread;
use std::time::Duration;

use selflink::scene::{LoadError, Scene, load_file};

/// A guard against waiting for ever, and no measure of speed: most takes a hundredth of a second,
/// and pictures of 16 megapixels some seconds without optimisation.
const HANG: Duration = Duration::from_secs(120);

/// Loads a file; a loader that does not come back fails the test instead of holding it up.
pub fn load_that_ends(path: &Path) -> Result<Scene, LoadError> {
    let path = path.to_owned();
    ends(&path.display().to_string(), move || load_file(&path))
}

/// Does something that must neither hang nor break.
pub fn ends<T: Send + 'static>(what: &str, work: impl FnOnce() -> T + Send + 'static) -> T {
    let (sender, receiver) = mpsc::channel();
    // Orphaned when it hangs: the test fails, and the process ends with the others.
    thread::spawn(move || sender.send(work()));
    receiver.recv_timeout(HANG).unwrap_or_else(|error| match error {
        RecvTimeoutError::Timeout => panic!("{what} hangs"),
        RecvTimeoutError::Disconnected => panic!("{what} breaks it"),
    })
}

/// The scene of a file that is odd but loads.
pub fn scene(path: &Path) -> Scene {
    let scene = load_that_ends(path).unwrap_or_else(|error| panic!("it should load: {error}"));
    for said in scene.skipped.sentences() {
        assert!(!said.chars().any(char::is_control) && said.chars().count() < 700, "one sentence: {said:?}");
    }
    assert!(scene.skipped.sentences().len() < 80, "as much as a person can read");
    scene
}

/// The one sentence that a file gives.
pub fn sentence(path: &Path) -> String {
    let error = load_that_ends(path).err().unwrap_or_else(|| panic!("{} should not load", path.display()));
    let error = error.to_string();
    assert!(!error.chars().any(char::is_control), "one sentence: {error:?}");
    assert!(error.chars().count() < 1000, "a sentence of {} characters", error.chars().count());
    assert!(error.contains(&*path.parent().expect("a folder").to_string_lossy()), "names the file: {error}");
    error
}

/// What the program says of a file that it refuses, when it may have `mebibytes` of address space,
/// programs and libraries included.
#[cfg(target_os = "linux")]
pub fn sentence_in_little_memory(mebibytes: u64, path: &Path) -> String {
    use std::process::Command;

    let mut command = Command::new("sh");
    command.arg("-c").arg(format!("ulimit -v {}; exec \"$0\" solve \"$1\" --epsilon 1", mebibytes << 10));
    command.arg(env!("CARGO_BIN_EXE_selflink")).arg(path).env("RAYON_NUM_THREADS", "2");
    let output = ends(&path.display().to_string(), move || command.output().expect("there is a shell"));
    let said = String::from_utf8_lossy(&output.stderr).trim().to_owned();
    assert_eq!(output.status.code(), Some(2), "{said}");
    assert!(!said.contains('\n'), "one sentence: {said}");
    said
}

/// A file of so many bytes that takes no room: it ends in a hole.
pub fn with_a_hole(path: &Path, begin: &[u8], length: u64) -> PathBuf {
    std::fs::write(path, begin).expect("a writable folder");
    let file = std::fs::OpenOptions::new().write(true).open(path).expect("it was just written");
    file.set_len(length).expect("a file system that knows holes");
    path.to_owned()
}
