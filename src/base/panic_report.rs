//! A file that tells of a panic: where, why, and with which settings.

use std::backtrace::Backtrace;
use std::fmt::Write as _;
use std::fs::OpenOptions;
use std::io::{self, Write as _};
use std::panic::PanicHookInfo;
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};
use std::thread;

use super::threads::lock;

/// Reports of one process, at most: one panic may lead to many others.
const MOST: u32 = 8;

/// Text of the settings in force, as [`note_settings`] last got it.
static SETTINGS: Mutex<String> = Mutex::new(String::new());
/// Whether panics are expected and need no report.
static IS_EXPECTED: AtomicBool = AtomicBool::new(false);

/// Writes a report of each panic from now on, whichever thread panics and whoever catches it, to a
/// file of this process in `folder`; one sentence on stderr says where.
pub fn install(folder: PathBuf) {
    let path = folder.join(format!("selflink-panic-{}.txt", std::process::id()));
    let written = AtomicU32::new(0);
    std::panic::set_hook(Box::new(move |info| {
        if IS_EXPECTED.load(Ordering::Relaxed) || written.fetch_add(1, Ordering::Relaxed) >= MOST {
            return;
        }
        // Whoever started the program may have closed stderr.
        let _ = writeln!(io::stderr(), "{}", tell(info, &path));
    }));
}

/// Keeps the settings in force, as text, for a report.
pub fn note_settings(text: String) {
    *lock(&SETTINGS) = text;
}

/// Whether panics are expected from now on, such as those of a window system that is not there.
pub fn expect(is_expected: bool) {
    IS_EXPECTED.store(is_expected, Ordering::Relaxed);
}

/// Writes the report; the sentence that tells of it.
fn tell(info: &PanicHookInfo<'_>, path: &Path) -> String {
    let cause = cause(info);
    let report = report(&cause, &Backtrace::force_capture());
    let written =
        OpenOptions::new().append(true).create(true).open(path).and_then(|mut file| file.write_all(report.as_bytes()));
    match written {
        Ok(()) => format!(
            "selflink: the program broke ({cause}); {} says more, please send it with a bug report",
            path.display()
        ),
        Err(error) => {
            format!("selflink: the program broke ({cause}); no report is written, {} ({error})", path.display())
        }
    }
}

/// Message and place of a panic, in one line.
fn cause(info: &PanicHookInfo<'_>) -> String {
    let message = info.payload_as_str().unwrap_or("it gave no reason").replace('\n', " ");
    let place = info.location().map(|place| format!(", {}:{}", place.file(), place.line())).unwrap_or_default();
    format!("{message}{place}")
}

fn report(cause: &str, backtrace: &Backtrace) -> String {
    let mut text = String::new();
    let arguments: Vec<String> = std::env::args().collect();
    let version = env!("CARGO_PKG_VERSION");
    let system = (std::env::consts::OS, std::env::consts::ARCH);
    let thread = thread::current().name().unwrap_or("without a name").to_owned();
    // Writing to a string cannot fail.
    let _ = writeln!(text, "Selflink {version} on {} {}\narguments: {}", system.0, system.1, arguments.join(" "));
    let _ = writeln!(text, "thread: {thread}\ncause: {cause}\nsettings:\n{}", lock(&SETTINGS).trim_end());
    let _ = writeln!(text, "backtrace:\n{backtrace}");
    text
}
