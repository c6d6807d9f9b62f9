//! Asking for an error on the command line, as a person does it.

use std::process::{Command, Output};

fn selflink(args: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_selflink")).args(args).output().expect("the program runs")
}

fn stats(args: &[&str]) -> serde_json::Value {
    let output = selflink(&[&["solve", "cornell", "--stats", "-"], args].concat());
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).expect("JSON")
}

/// Who says nothing asks for 5 %, and gets it; who asks for less gets less work.
#[test]
fn an_error_is_what_one_asks_for() {
    let (usual, coarse) = (stats(&[]), stats(&["--error", "0.2"]));
    for (stats, asked) in [(&usual, 0.05), (&coarse, 0.2)] {
        assert_eq!(stats["error_asked"].as_f64(), Some(asked));
        assert_eq!(stats["reconstruct"], "gather");
        assert!(stats["error_estimate"].as_f64().is_some_and(|error| error > 0.0 && error <= asked), "{stats}");
    }
    let rays = |stats: &serde_json::Value| stats["rays"].as_u64().expect("a count");
    assert!(rays(&coarse) < rays(&usual), "{} and {} rays", rays(&coarse), rays(&usual));
    // By ε no error is asked for.
    let by_threshold = self::stats(&["--epsilon", "1e-2"]);
    assert!(by_threshold["error_asked"].is_null() && by_threshold["reconstruct"] == "vertex");
}

/// Truth: the statistics file of the same solve.
#[test]
fn the_summary_has_quantiles_of_the_local_error() {
    let file = tempfile::NamedTempFile::new().expect("a file");
    let path = file.path().to_str().expect("a plain path");
    let output = selflink(&["solve", "cornell", "--error", "0.2", "--stats", path]);
    let (said, stats) = (String::from_utf8_lossy(&output.stdout), std::fs::read(path).expect("statistics"));
    let stats: serde_json::Value = serde_json::from_slice(&stats).expect("JSON");
    let line = said.lines().find_map(|line| line.strip_prefix("local      ")).expect("a row of local errors");
    let of = |what: &str, key: &str| 100.0 * stats["error"][what][key].as_f64().expect("a number");
    let (read, mesh) = line.split_once("; ").expect("readings and mesh");
    for (text, what, name) in [(read, "read", "readings: "), (mesh, "mesh", "bare mesh: ")] {
        let values = text.strip_prefix(name).expect("its name").split(", ");
        for (value, key) in values.zip(["p50", "p90", "p95"]) {
            let value =
                value.strip_prefix(key).and_then(|value| value.trim().strip_suffix(" %")).expect("a percentage");
            let value: f64 = value.parse().expect("a number");
            // Three digits are written.
            assert!((value - of(what, key)).abs() <= 0.01 * of(what, key), "{what} {key}: {value} of {line}");
        }
    }
}

#[test]
fn what_contradicts_itself_is_refused_in_a_sentence() {
    for (args, said) in [
        (["--error", "0.1", "--epsilon", "1e-3"], "--error chooses what --epsilon would say"),
        (["--error", "0.1", "--reconstruct", "constant"], "--error chooses what --reconstruct would say"),
        (["--error", "2", "--threads", "1"], "--error must be greater than 0 and less than 1"),
    ] {
        let output = selflink(&[&["solve", "cornell"], &args[..]].concat());
        let stderr = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{args:?}: {stderr}");
        assert!(stderr.contains(said) && stderr.lines().count() == 1, "{args:?}: {stderr}");
    }
}
