//! `selflink selftest` as a person runs it; what its rows find is the business of
//! `tests/stability`.

use std::process::{Command, Output};

use serde_json::Value;

fn selftest(args: &[&str]) -> (Output, String, String) {
    let output = Command::new(env!("CARGO_BIN_EXE_selflink")).arg("selftest").args(args).output();
    let output = output.expect("the program runs");
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    let (stdout, stderr) = (text(&output.stdout), text(&output.stderr));
    (output, stdout, stderr)
}

/// Two rows, one by its name and one by its number: a line each with the verdict, and every check
/// as JSON.
#[test]
fn rows_are_told_and_written() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let file = folder.path().join("selftest.json");
    let (output, stdout, stderr) = selftest(&["--only", "small-lamps,6", "--json", &file.to_string_lossy()]);
    assert_eq!(output.status.code(), Some(0), "a known limit is no failure: {stderr}");
    for words in ["small-lamps         pass", "small-blocker       known limit", "worst of", "truth", "ours", "why:"] {
        assert!(stdout.contains(words), "{words}: {stdout}");
    }
    assert!(stdout.contains("2 rows in") && stdout.contains("1 pass, 1 known limits"), "{stdout}");
    let report: Value =
        serde_json::from_slice(&std::fs::read(&file).expect("it was written")).expect("the file is JSON");
    assert_eq!((&report["passed"], &report["known_limits"], &report["failed"]), (&1.into(), &1.into(), &0.into()));
    let checks = report["rows"][1]["checks"].as_array().expect("every check of the row");
    assert_eq!(report["rows"][1]["name"], "small-lamps");
    assert!(checks.len() > 10 && checks.iter().all(|check| check["ours"].is_number() && check["what"].is_string()));
}

#[test]
fn an_unknown_row_is_refused_in_one_sentence() {
    let (output, stdout, stderr) = selftest(&["--only", "everything"]);
    assert_eq!((output.status.code(), stdout.as_str()), (Some(2), ""));
    assert!(stderr.lines().count() == 1 && stderr.contains("choose from touching, row-sums"), "{stderr}");
}
