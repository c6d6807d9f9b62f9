//! Whole runs of the program, from the command to its statistics: times and memory as a person has
//! them.

use std::path::PathBuf;
use std::process::Command;
use std::time::Instant;

use serde_json::Value;

use super::{Goal, Table};

/// Seconds allowed for what takes many times as long.
const SECONDS: f64 = 2.0;

/// Statistics of a run; `None` if it failed.
fn run(args: &[&str]) -> Option<Value> {
    let program = env!("CARGO_BIN_EXE_selflink");
    let output = Command::new(program).arg("solve").args(args).args(["--stats", "-"]).output().ok()?;
    serde_json::from_slice(&output.stdout).ok()
}

/// A scene of other people beside ours, where `SELFLINK_SCENES` says.
fn file(name: &str) -> Option<String> {
    let folder = PathBuf::from(std::env::var_os("SELFLINK_SCENES")?);
    let path = folder.join(name);
    path.is_file().then(|| path.to_string_lossy().into_owned())
}

/// Goals of whole scenes.
pub fn scenes(table: &mut Table) {
    for (scene, error, most) in [("cornell", "0.05", 0.2), ("seminar", "0.05", 1.2), ("office", "0.05", 1.5)] {
        solve(table, (scene, scene), error, most);
    }
    let begun = Instant::now();
    if run(&["office", "--error", "0.005", "--seconds", &SECONDS.to_string()]).is_some() {
        let taken = begun.elapsed().as_secs_f64() / SECONDS;
        table.line("office, 2 s allowed: time taken", taken, "×", Goal::AtMost(1.1), "asked for 0.5 %");
    }
    for (name, path, error, most) in [
        ("fireplace room", "fireplace-room/fireplace-room.obj", "0.1", 4.0),
        ("Veach's room", "veach-ajar/veach-ajar.obj", "0.1", 2.0),
        ("classroom", "classroom/classroom.glb", "0.1", 40.0),
    ] {
        match file(path) {
            Some(path) => solve(table, (name, &path), error, most),
            None => eprintln!("{name} is left out: SELFLINK_SCENES has no {path}"),
        }
    }
    if let Some(path) = file("classroom/classroom.glb")
        && let Some(stats) = run(&[&path, "--epsilon", "1e-3"])
    {
        let number = |place: &str| stats.pointer(place).and_then(Value::as_f64).unwrap_or(f64::NAN);
        table.line("classroom: loading", number("/seconds/load"), "s", Goal::AtMost(3.0), "");
        let what = "after loading";
        table.line("classroom: first picture", number("/seconds/first_snapshot"), "s", Goal::AtMost(1.5), what);
        let bytes = number("/peak_rss_bytes") / number("/initial_patches");
        table.line("classroom: memory", bytes, "B", Goal::AtMost(600.0), "a polygon, the process at ε = 1e-3");
    }
}

fn solve(table: &mut Table, (name, scene): (&str, &str), error: &str, most: f64) {
    let Some(stats) = run(&[scene, "--error", error]) else {
        eprintln!("{name} is left out: the run failed");
        return;
    };
    let number = |place: &str| stats.pointer(place).and_then(Value::as_f64).unwrap_or(f64::NAN);
    let what = format!("{:.2} M rays, certified {:.1} %", 1e-6 * number("/rays"), 100.0 * number("/error/bound"));
    table.line(&format!("{name} to {error}"), number("/seconds/total"), "s", Goal::AtMost(most), &what);
}
