//! `selflink solve`: options, statistics, and what it writes.

use std::path::Path;

use selflink::scene::load_file;
use serde_json::Value;

use crate::support::*;

#[test]
fn the_statistics_have_every_key_and_hang_together() {
    let stats = stats("cornell", &[]);
    for key in [
        "scene",
        "clustering",
        "octree_depth",
        "epsilon_relative",
        "epsilon_watts",
        "initial_patches",
        "clusters",
        "patches",
        "links",
        "pairs_judged",
        "rays",
        "iterations",
        "converged",
        "threads",
        "seconds",
        "bytes",
        "peak_rss_bytes",
        "emitted_watts",
        "absorbed_watts",
        "stopped_by_backs_watts",
        "escaped_watts",
        "balance_gap",
        "skipped",
    ] {
        assert!(stats.get(key).is_some(), "{key} is missing: {stats}");
    }
    for key in
        ["load", "hierarchy", "refine", "gather", "first_snapshot", "total", "since_process_start_first_snapshot"]
    {
        assert!(stats["seconds"][key].as_f64().is_some_and(|seconds| seconds >= 0.0), "{key}: {stats}");
    }
    assert_eq!((&stats["scene"], &stats["clustering"]), (&"cornell".into(), &"adaptive".into()));
    assert_eq!(stats["converged"], true);
    let number = |value: &Value| value.as_f64().expect("a number");
    assert!(number(&stats["bytes"]["links"]) <= 16.0 * number(&stats["links"]), "16 bytes a link at most: {stats}");
    assert!((number(&stats["epsilon_relative"]) - 1e-2).abs() < 1e-9);
    // Truth: nothing absorbs more than is emitted.
    assert!(
        number(&stats["absorbed_watts"]) > 0.0 && number(&stats["absorbed_watts"]) < number(&stats["emitted_watts"])
    );
    if cfg!(target_os = "linux") {
        assert!(number(&stats["peak_rss_bytes"]) > 1e6);
    }
}

#[test]
fn each_option_reaches_the_solver() {
    let stats = stats(
        "cornell",
        &[
            "--clustering",
            "octree",
            "--octree-depth",
            "3",
            "--threads",
            "2",
            "--push",
            "deferred",
            "--sides",
            "both",
            "--seed",
            "5",
        ],
    );
    let expected = [("clustering", "octree"), ("push", "deferred"), ("sides", "both")];
    for (key, value) in expected {
        assert_eq!(stats[key], value);
    }
    assert_eq!((&stats["octree_depth"], &stats["threads"], &stats["seed"]), (&3.into(), &2.into(), &5.into()));
    assert_eq!(stats["initial_patches"], 2 * load_builtin_polygons("cornell"));
}

fn load_builtin_polygons(name: &str) -> usize {
    selflink::scene::builtin::BuiltinScene::from_name(name).expect("one of our own scenes").build().polygons.len()
}

/// Truth: the bits of the first solve. Its statistics are settings; what is given beside them
/// counts more.
#[test]
fn statistics_are_settings_that_run_again() {
    let folder = Folder::new();
    let (first, again) = (folder.path("first.ply"), folder.path("again.ply"));
    let dark = folder.write("dark.obj", SQUARE);
    let stats_path = folder.path("stats.json");
    let args = ["--emit", "roof=10,20,30", "--clustering", "octree", "--octree-depth", "3", "--seed", "7"];
    let all =
        [&["solve", name(&dark), "--out", name(&first), "--stats", name(&stats_path)], &COARSE[..], &args].concat();
    let (summary, _) = succeed(&all);
    assert!(summary.starts_with("dark: 2 polygons, clustering octree"), "{summary}");
    succeed(&["solve", "--settings", name(&stats_path), "--out", name(&again)]);
    let read = |path: &Path| std::fs::read(path).expect("a mesh");
    assert!(read(&first).starts_with(b"ply\n"), "a mesh is a PLY file");
    assert!(read(&first) == read(&again), "the settings give another solution");
    let (stdout, _) =
        succeed(&["solve", "--settings", name(&stats_path), "--seed", "8", "--error", "0.2", "--stats", "-"]);
    let other: Value = serde_json::from_str(&stdout).expect("stdout is pure JSON");
    assert_eq!(
        (&other["seed"], &other["error_asked"], &other["clustering"]),
        (&8.into(), &0.2.into(), &"octree".into())
    );
    // Another scene takes the parameters, not the light.
    let (stdout, _) = succeed(&["solve", "cornell", "--settings", name(&stats_path), "--stats", "-"]);
    let other: Value = serde_json::from_str(&stdout).expect("stdout is pure JSON");
    assert_eq!((&other["scene"], &other["settings"]["light"]), (&"cornell".into(), &Value::Null));
    assert!(refused(&["solve", "--settings", name(&stats_path), "--stats", name(&stats_path)]).contains("overwrite"));
    let empty = folder.write("empty.json", r#"{"settings": {}}"#);
    assert!(refused(&["solve", "--settings", name(&empty)]).contains("name no scene"));
    assert!(refused(&["solve", "--settings", name(&dark)]).contains("not valid settings"));
}

/// Truth: the same links as without the option, and one sentence about it.
#[test]
fn a_former_criterion_of_refinement_is_read_and_reported() {
    let folder = Folder::new();
    let settings = folder.write("old.json", r#"{"settings": {"scene": "cornell", "solver": {"oracle": "error"}}}"#);
    let solve = |args: &[&str]| {
        let (stdout, stderr) = succeed(&[&["solve", "--stats", "-"], &COARSE[..], args].concat());
        let stats: Value = serde_json::from_str(&stdout).expect("stdout is pure JSON");
        (stats["links"].clone(), stderr)
    };
    let (links, plain) = solve(&["cornell"]);
    assert!(!plain.contains("gone"), "{plain}");
    for args in [["cornell", "--refine-by", "link-error"], ["cornell", "--oracle", "error"]] {
        let (found, said) = solve(&args);
        assert!(found == links && said.contains("--refine-by is gone"), "{said}");
    }
    let (found, said) = solve(&["--settings", name(&settings)]);
    assert!(found == links && said.contains("refinement by link error is gone"), "{said}");
}

/// Truth: the counts of the statistics, and powers that add up to what the links bring.
#[test]
fn links_and_meshes_are_written_for_other_programs() {
    let folder = Folder::new();
    let (links, mesh) = (folder.path("links.csv"), folder.path("lit.glb"));
    let stats = stats("cornell", &["--links", name(&links), "--out", name(&mesh)]);
    let text = std::fs::read_to_string(&links).expect("links");
    let mut lines = text.lines();
    let columns = lines.next().expect("a header").split(',').count();
    let rows: Vec<Vec<&str>> = lines.map(|line| line.split(',').collect()).collect();
    assert_eq!(rows.len() as u64, stats["links"].as_u64().expect("a number"));
    assert!(rows.iter().all(|row| row.len() == columns));
    let power: f64 = rows.iter().filter_map(|row| row.last()?.parse::<f64>().ok()).sum();
    let emitted = stats["emitted_watts"].as_f64().expect("a number");
    assert!(power > 0.1 * emitted && power < 3.0 * emitted, "{power} W over links, {emitted} W emitted");
    let scene = load_file(&mesh).expect("our own loader opens it");
    assert!(scene.polygons.len() > 100);
}

#[test]
fn a_solve_that_is_stopped_is_a_solution_of_what_is_there() {
    let stats = stats("cornell", &["--seconds", "0"]);
    assert_eq!((&stats["converged"], &stats["rays"]), (&false.into(), &0.into()));
    assert_eq!(stats["escaped_watts"], Value::Null);
    assert!(stats["absorbed_watts"].as_f64().is_some_and(|watts| watts > 0.0), "the first picture has light: {stats}");
}

#[test]
fn a_scene_without_light_is_a_warning_and_light_can_be_added() {
    let folder = Folder::new();
    let path = folder.write("dark.obj", SQUARE);
    let args = ["solve", name(&path), "--stats", "-"];
    let (stdout, stderr) = succeed(&args);
    assert!(stderr.contains("--emit MATERIAL=r,g,b") && stderr.contains("--ceiling-light"), "{stderr}");
    let dark: Value = serde_json::from_str(&stdout).expect("stdout is pure JSON");
    assert_eq!((&dark["links"], &dark["rays"], &dark["converged"]), (&1.into(), &0.into(), &true.into()));
    for light in [&["--emit", "roof=10,20,30"][..], &["--ceiling-light"], &["--ceiling-light", "0.25:40"]] {
        let (stdout, stderr) = succeed(&[&args[..], light].concat());
        assert!(!stderr.contains("--emit"), "{stderr}");
        let lit: Value = serde_json::from_str(&stdout).expect("stdout is pure JSON");
        assert!(lit["absorbed_watts"].as_f64().is_some_and(|watts| watts > 0.0), "{light:?}: {lit}");
    }
    // Truth: area times exitance, colours summed.
    let (stdout, _) = succeed(&[&args[..], &["--emit", "roof=10,20,30"]].concat());
    let lit: Value = serde_json::from_str(&stdout).expect("stdout is pure JSON");
    assert!((lit["emitted_watts"].as_f64().expect("a number") - 60.0).abs() < 1e-3);
}

#[test]
fn what_loading_skipped_is_said_once() {
    let folder = Folder::new();
    let path = folder.write("thin.obj", format!("{SQUARE}f 1 2 2\n"));
    let (stdout, stderr) = succeed(&["solve", name(&path), "--emit", "roof=1,1,1", "--stats", "-"]);
    assert_eq!(stderr.matches("1 degenerate face skipped.").count(), 1, "{stderr}");
    let stats: Value = serde_json::from_str(&stdout).expect("stdout is pure JSON");
    assert_eq!(stats["skipped"]["degenerate_faces"], 1);
}
