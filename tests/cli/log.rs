//! What a run says of itself: `--log`, and the report of a panic.

use std::process::Command;

use crate::support::{COARSE, Folder, name, refused, succeed, text};

/// Truth: the stages that every solve goes through, each in a line of its own on stderr; stdout
/// stays what it was.
#[test]
fn a_log_tells_the_stages_on_stderr() {
    let folder = Folder::new();
    let mesh = folder.path("cornell.glb");
    let solve = [&["solve", "cornell", "--out", name(&mesh)], &COARSE[..]].concat();
    let (quiet_out, quiet) = succeed(&solve);
    assert!(quiet.is_empty(), "{quiet}");
    let (stdout, stderr) = succeed(&[&solve[..], &["--log", "info"]].concat());
    assert_eq!(stdout.lines().count(), quiet_out.lines().count());
    let stages = ["scene read", "scene prepared", "clusters built", "links settled", "written"];
    let lines: Vec<&str> = stderr.lines().collect();
    for stage in stages {
        let reported = lines.iter().filter(|line| line.contains(stage) && line.contains("INFO")).count();
        assert_eq!(reported, 1, "{stage}: {stderr}");
    }
    assert!(!stderr.contains("DEBUG"), "{stderr}");
}

/// Truth: the certificate of the statistics is the last one of the log.
#[test]
fn a_log_tells_of_certificates() {
    let args = ["solve", "cornell", "--error", "0.2", "--stats", "-", "--log", "info"];
    let (stdout, stderr) = succeed(&args);
    let stats: serde_json::Value = serde_json::from_str(&stdout).expect("stdout is pure JSON");
    let last = stderr.lines().rfind(|line| line.contains("certificate")).expect("a certificate");
    let bound = last.split("bound=").nth(1).and_then(|rest| rest.split(' ').next()).expect("a bound");
    let [logged, reported] =
        [bound.parse::<f64>().ok(), stats["error"]["bound"].as_f64()].map(|it| it.expect("a number"));
    // The JSON reader of this test may be off by the last digit.
    assert!((logged - reported).abs() <= f64::EPSILON * reported, "{reported}: {last}");
}

/// Truth: RUST_LOG chooses modules; the option counts more.
#[test]
fn rust_log_chooses_modules() {
    let solve = [&["solve", "cornell"], &COARSE[..]].concat();
    let logged = |more: &[&str]| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_selflink"));
        let output = command.args([&solve[..], more].concat()).env("RUST_LOG", "selflink::solve=debug").output();
        text(&output.expect("the program runs").stderr)
    };
    let by_variable = logged(&[]);
    assert!(by_variable.contains("wave refined") && !by_variable.contains("scene read"), "{by_variable}");
    let by_option = logged(&["--log", "info"]);
    assert!(by_option.contains("scene read") && !by_option.contains("wave refined"), "{by_option}");
}

#[test]
fn what_is_no_level_is_refused() {
    let sentence = refused(&["solve", "cornell", "--log", "loud"]);
    assert!(sentence.contains("error, warn, info or debug"), "{sentence}");
}

/// Truth: a report holds what makes the fault come again: settings, place, thread, and the calls
/// that led there.
#[test]
fn a_panic_leaves_a_report() {
    let folder = Folder::new();
    let program = Command::new(env!("CARGO_BIN_EXE_selflink"))
        .args(["panic", "cornell", "--epsilon", "0.0125", "--seed", "77"])
        .env("TMPDIR", folder.path(""))
        .output()
        .expect("the program runs");
    let stderr = text(&program.stderr);
    assert_eq!(program.status.code(), Some(101), "{stderr}");
    assert_eq!(stderr.lines().count(), 1, "{stderr}");
    let reports: Vec<_> = std::fs::read_dir(folder.path("")).expect("a folder").collect();
    let [Ok(report)] = &reports[..] else { panic!("{reports:?}") };
    assert!(stderr.contains(&report.path().display().to_string()), "{stderr}");
    let reported = std::fs::read_to_string(report.path()).expect("a report");
    let version = format!("Selflink {}", env!("CARGO_PKG_VERSION"));
    let place = "broken on purpose, src/cli/panic.rs:";
    for part in [&version, place, "thread: main", "\"scene\": \"cornell\"", "0.0125", "\"seed\": 77", "backtrace:\n"] {
        assert!(reported.contains(part), "{part}: {reported}");
    }
}
