//! The program as a person runs it: commands, files written, and one sentence for what cannot be done.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use selflink::scene::load_file;
use serde_json::Value;
use tempfile::TempDir;

/// A folder that goes away with the test.
struct Folder(TempDir);

impl Folder {
    fn new() -> Self {
        Self(TempDir::new().expect("a temporary folder"))
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn write(&self, name: &str, content: impl AsRef<[u8]>) -> PathBuf {
        let path = self.path(name);
        std::fs::write(&path, content).expect("a writable folder");
        path
    }
}

/// Coarse, so that the development profile solves it in a moment.
const COARSE: [&str; 2] = ["--epsilon", "1e-2"];

fn selflink(args: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_selflink")).args(args).output().expect("the program runs")
}

/// Runs a command that must succeed; returns what it printed.
fn succeed(args: &[&str]) -> (String, String) {
    let output = selflink(args);
    let (stdout, stderr) = (text(&output.stdout), text(&output.stderr));
    assert_eq!(output.status.code(), Some(0), "{args:?}: {stderr}");
    (stdout, stderr)
}

/// Runs a command that must be refused with one sentence and exit code 2; returns the sentence.
fn refused(args: &[&str]) -> String {
    let output = selflink(args);
    let stderr = text(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{args:?}: {stderr}");
    assert_eq!(stderr.trim_end().lines().count(), 1, "{args:?}: {stderr}");
    assert!(output.stdout.is_empty(), "{args:?}: {}", text(&output.stdout));
    assert!(!stderr.contains("panicked"), "{args:?}: {stderr}");
    stderr
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

fn name(path: &Path) -> &str {
    path.to_str().expect("temporary folders have plain names")
}

/// The statistics of a coarse solve.
fn stats(scene: &str, args: &[&str]) -> Value {
    let (stdout, _) = succeed(&[&["solve", scene, "--stats", "-"], &COARSE[..], args].concat());
    serde_json::from_str(&stdout).expect("stdout is pure JSON")
}

const SQUARE: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\n\
                      usemtl floor\nf 1 2 3 4\nusemtl roof\nf 8 7 6 5\n";

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

/// Truth: a fresh solve is the same bit for bit for any number of threads.
#[test]
fn the_lit_mesh_does_not_depend_on_the_threads() {
    let folder = Folder::new();
    let meshes = ["1", "2"].map(|threads| {
        let path = folder.path(&format!("{threads}.ply"));
        let (summary, _) =
            succeed(&[&["solve", "cornell", "--threads", threads, "--out", name(&path)], &COARSE[..]].concat());
        assert!(summary.starts_with("cornell: 20 polygons, clustering adaptive"), "{summary}");
        std::fs::read(path).expect("the mesh was written")
    });
    assert!(meshes[0].starts_with(b"ply\n") && meshes[0].len() > 1000);
    assert!(meshes[0] == meshes[1], "one thread and two give different meshes");
}

/// Truth: the bits of the first solve. Its statistics are settings; what is given beside them counts more.
#[test]
fn statistics_are_settings_that_run_again() {
    let folder = Folder::new();
    let (first, again) = (folder.path("first.ply"), folder.path("again.ply"));
    let dark = folder.write("dark.obj", SQUARE);
    let stats_path = folder.path("stats.json");
    let args = ["--emit", "roof=10,20,30", "--clustering", "octree", "--octree-depth", "3", "--seed", "7"];
    let all =
        [&["solve", name(&dark), "--out", name(&first), "--stats", name(&stats_path)], &COARSE[..], &args].concat();
    succeed(&all);
    succeed(&["solve", "--settings", name(&stats_path), "--out", name(&again)]);
    let read = |path: &Path| std::fs::read(path).expect("a mesh");
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

#[test]
fn bad_input_is_one_sentence_and_exit_code_2() {
    let folder = Folder::new();
    let good = folder.write("good.obj", SQUARE);
    let good = name(&good);
    let named_ply = folder.write("good.ply", SQUARE);
    let mesh_as_obj = folder.path("mesh.obj");
    let points = folder.write("points.csv", "0.5,0.5,0,0,0,1\n");
    let bad_points = folder.write("bad.csv", "x,y,z,nx,ny,nz\n0.5,0.5,0,0,0,1\n0.5,0.5,zero,0,0,1\n");
    let empty = folder.write("empty.obj", "");
    let image = folder.write("image.obj", b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR");
    let nan = folder.write("nan.obj", "v 0 0 0\nv 1 0 0\nv 0 NaN 0\nf 1 2 3\n");
    let past = folder.write("past.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n");
    let gone = folder.path("gone.obj");
    let nowhere = folder.path("no/such/folder/out.ply");
    let cases: Vec<(Vec<&str>, &str)> = vec![
        (vec!["solve", name(&gone)], "no such file"),
        (vec!["solve", name(&empty)], "empty"),
        (vec!["solve", name(&image)], "an image"),
        (vec!["solve", name(&nan)], "not finite"),
        (vec!["solve", name(&past)], "vertex 9"),
        (vec!["solve", "ofice"], "cornell, seminar, office"),
        (vec!["ofice"], "cornell, seminar, office"),
        (vec!["solve"], "<SCENE>"),
        (vec!["solve", good, "--epsilon", "0"], "--epsilon must be greater than 0"),
        (vec!["solve", good, "--epsilon", "-1e-3"], "--epsilon must be greater than 0"),
        (vec!["solve", good, "--epsilon-watts", "0"], "greater than 0"),
        (
            vec!["solve", good, "--epsilon", "few"],
            "--epsilon <NUMBER>': it must be a number (see selflink solve --help)",
        ),
        (vec!["solve", good, "--rays-max", "1.5"], "it must be a whole number, 0 or more"),
        (vec!["solve", good, "--rays-max", "99999999999"], "it is too large"),
        (vec!["--epsilom", "1"], "(see selflink --help)"),
        (vec!["solve", good, "--epsilon", "1e-3", "--epsilon-watts", "1"], "one of them"),
        (vec!["solve", good, "--rays-min", "9", "--rays-max", "3"], "--rays-max (3)"),
        (vec!["solve", good, "--clustering", "kmeans"], "none, octree, groups, adaptive"),
        (vec!["solve", good, "--threads", "100000"], "--threads"),
        (vec!["solve", good, "--epsilom", "1"], "(see selflink solve --help)"),
        (vec!["solve", good, "--seconds", "-1"], "--seconds"),
        (vec!["solve", good, "--out", name(&nowhere)], "cannot be written"),
        (vec!["solve", good, "--stats", name(&nowhere)], "cannot be written"),
        (vec!["solve", name(&named_ply), "--out", name(&named_ply)], "overwrite"),
        (vec!["solve", good, "--out", name(&mesh_as_obj)], "mesh.obj: meshes are written as PLY"),
        (vec!["solve", good, "--emit", "lamp=1,1,1"], "floor, roof"),
        (vec!["solve", good, "--emit", "roof=1,1"], "r,g,b"),
        (vec!["solve", good, "--emit", "roof=1,1,-1"], "emission"),
        (vec!["solve", good, "--ceiling-light", "0:1"], "greater than 0"),
        (vec!["solve", good, "--ceiling-light", "big"], "SIZE:W_PER_M2"),
        (vec!["probe", good, "--points", name(&bad_points), "--out", name(&nowhere)], "line 3"),
        (vec!["probe", good, "--points", name(&gone), "--out", name(&nowhere)], "cannot be read"),
        (vec!["probe", good, "--points", name(&points), "--out", name(&nowhere)], "cannot be written"),
        (vec!["probe", good, "--points", name(&points), "--out", name(&points)], "overwrite"),
        (vec!["reference", "ofice"], "cornell, seminar, office"),
        (vec!["reference", name(&gone)], "no such file"),
        (vec!["reference", good, "--points", "0"], "--points must lie between"),
        (vec!["reference", good, "--points", "-5"], "--points"),
        (vec!["reference", good, "--noise", "0"], "--noise must lie between"),
        (vec!["reference", good, "--noise", "NaN"], "--noise must lie between"),
        (vec!["reference", good, "--seconds", "-1"], "--seconds"),
        (vec!["reference", good, "--out", name(&nowhere)], "cannot be written"),
        (vec!["reference", good, "--out", good], "overwrite"),
        (vec!["reference", good, "--cache", "somewhere", "--no-cache"], "--no-cache"),
        (vec!["chart", "cornell"], "--out"),
        (vec!["chart", "ofice", "--out", name(&gone)], "cornell, seminar, office"),
        (vec!["chart", "cornell", "--out", good], "cannot be made"),
        (vec!["chart", "cornell", "--out", name(&gone), "--epsilons", "1e-2,few"], "--epsilons must be"),
        (vec!["chart", "cornell", "--out", name(&gone), "--epsilons", "0"], "--epsilons must be"),
        (vec!["chart", "cornell", "--out", name(&gone), "--settings", "kmeans"], "adaptive, immediate"),
        (vec!["chart", "cornell", "--out", name(&gone), "--seconds", "0"], "--seconds must be greater than 0"),
        (vec!["accuracy", "--out", good], "cannot be made"),
        (vec!["scene", "attic", "--out", name(&nowhere)], "cornell, seminar, office"),
        (vec!["scene", "seminar", "--polygons", "5", "--out", name(&nowhere)], "between 1000 and"),
        (vec!["scene", "office", "--polygons", "5000", "--out", name(&nowhere)], "seminar"),
        (vec!["scene", "office"], "--out"),
        (vec!["scene", "cornell", "--out", good], "cannot write"),
    ];
    for (args, part) in cases {
        let said = refused(&args);
        assert!(said.contains(part), "{args:?}: `{part}` is not in: {said}");
        assert!(!said.contains("os error") && !said.contains("literal"), "{args:?}: {said}");
    }
    assert!(!mesh_as_obj.exists());
    assert_eq!(std::fs::read_to_string(good).expect("the scene is still there"), SQUARE, "nothing was overwritten");
}

#[cfg(feature = "gui")]
#[test]
fn bad_pictures_are_refused() {
    let folder = Folder::new();
    let (picture, nowhere, jpeg) = (folder.path("out.png"), folder.path("no/out.png"), folder.path("out.jpg"));
    let picture = name(&picture);
    let cases: Vec<(Vec<&str>, &str)> = vec![
        (vec!["--out", name(&nowhere)], "cannot be written"),
        (vec!["--out", name(&jpeg)], ".png"),
        (vec!["--out", picture, "--size", "0x10"], "--size"),
        (vec!["--out", picture, "--size", "big"], "--size"),
        (vec!["--out", picture, "--size", "100000x100000"], "--size"),
        (vec!["--out", picture, "--camera", "1,2,3"], "--camera"),
        (vec!["--out", picture, "--camera", "1,2,3:1,2,3"], "--camera"),
        (vec!["--out", picture, "--exposure", "bright"], "--exposure"),
        (vec!["--out", picture, "--overlay", "boxes"], "--overlay"),
        (vec!["--out", picture, "--overlay", "links:9999,1"], "outside the picture"),
    ];
    for (args, part) in cases {
        let said = refused(&[&["render", "cornell"], &args[..]].concat());
        assert!(said.contains(part), "{args:?}: `{part}` is not in: {said}");
    }
    assert!(!Path::new(picture).exists(), "no picture is left behind");
}

#[cfg(feature = "gui")]
#[test]
fn a_picture_has_the_size_asked_for_and_shows_the_overlays() {
    if let Err(error) = selflink::render::Offscreen::new() {
        return eprintln!("SKIPPED: pictures are not tested, {error}");
    }
    let folder = Folder::new();
    let draw = |file: &str, args: &[&str]| {
        let path = folder.path(file);
        succeed(&[&["render", "cornell", "--size", "96x64", "--out", name(&path)], &COARSE[..], args].concat());
        image::open(path).expect("a PNG").to_rgba8()
    };
    let plain = draw("plain.png", &[]);
    assert_eq!(plain.dimensions(), (96, 64));
    let colours: std::collections::HashSet<_> = plain.pixels().collect();
    assert!(colours.len() > 50, "a lit room has many shades, not {}", colours.len());
    for (file, overlay) in [
        ("elements.png", "elements"),
        ("clusters.png", "clusters:0"),
        ("links.png", "links:48,50"),
        ("level.png", "level-links:2"),
    ] {
        assert!(draw(file, &["--overlay", overlay]) != plain, "{overlay} is not to be seen");
    }
    let deep = folder.path("deep.png");
    let (_, said) =
        succeed(&["render", "cornell", "--out", name(&deep), "--overlay", "clusters:99", "--epsilon", "1e-2"]);
    assert!(said.contains("note: there are no clusters of level 99"), "{said}");
    assert!(draw("camera.png", &["--camera", "0.1,0.2,0.7:0.3,0.3,0"]) != plain, "the camera has not moved");
    // Truth: the background, which no light reaches, is all that stays.
    let brightest = |picture: &image::RgbaImage| picture.pixels().map(|pixel| pixel.0[0]).max();
    assert!(brightest(&draw("dim.png", &["--exposure", "-20"])) < brightest(&plain), "by hand it is dark");
}

/// Truth: at first there is the root's self-link alone, one colour from corner to corner; later there are many, and what is no picture
/// is refused.
#[test]
fn a_link_matrix_starts_as_one_square() {
    let folder = Folder::new();
    let colours = |file: &str, args: &[&str]| {
        let path = folder.path(file);
        succeed(&[&["matrix", "cornell", "--size", "200", "--out", name(&path)], &COARSE[..], args].concat());
        let picture = image::open(path).expect("a PNG").to_rgb8();
        // The square, which lies at the right and has the legend below.
        let (left, top) = (picture.width() - 230, picture.height() - 296);
        let square = image::imageops::crop_imm(&picture, left, top, 200, 200).to_image();
        square.pixels().copied().collect::<std::collections::HashSet<_>>().len()
    };
    for colour in ["power", "visibility", "level", "rays"] {
        assert_eq!(colours("first.png", &["--waves", "0", "--colour", colour]), 1, "{colour}");
        assert!(colours("last.png", &["--room", "leaves", "--colour", colour]) > 3, "{colour}");
    }
    let (picture, jpeg) = (folder.path("out.png"), folder.path("out.jpg"));
    for (args, part) in [
        (["--out", name(&jpeg), "--size", "200"], ".png"),
        (["--out", name(&picture), "--size", "9"], "--size"),
        (["--out", name(&picture), "--room", "kitchen"], "--room"),
        (["--out", name(&picture), "--waves", "-1"], "--waves"),
    ] {
        let said = refused(&[&["matrix", "cornell"], &args[..]].concat());
        assert!(said.contains(part), "{args:?}: `{part}` is not in: {said}");
    }
}

/// Truth: a scene whose exact values are known. The floor's radiosity is that of its irradiance, B = ρE (grey ρ = 0.5 of
/// faces without an MTL), at every point, since both are interpolated by the same weights.
#[test]
fn probed_points_come_back_with_irradiance_and_radiosity() {
    let folder = Folder::new();
    let scene = folder.write("box.obj", SQUARE);
    let points = folder.write(
        "points.csv",
        "x,y,z,nx,ny,nz\n0.5,0.5,0,0,0,1\n0.5,0.5,0.5,0,0,1\n0.5,0.5,0,0,0,-1\n0.25,0.75,1,0,0,-3\n",
    );
    let out = folder.path("out.csv");
    let args = ["probe", name(&scene), "--emit", "roof=10,20,40", "--points", name(&points), "--out", name(&out)];
    let (_, stderr) = succeed(&[&args[..], &["--epsilon", "1e-3"]].concat());
    assert!(stderr.contains("2 rows lie on no surface"), "{stderr}");
    let written = std::fs::read_to_string(out).expect("the table was written");
    let rows: Vec<Vec<&str>> = written.lines().map(|line| line.split(',').collect()).collect();
    assert_eq!(rows[0].join(","), "x,y,z,nx,ny,nz,E_r,E_g,E_b,B_r,B_g,B_b");
    assert_eq!(rows.len(), 5);
    assert!(rows.iter().all(|row| row.len() == 12), "{written}");
    assert_eq!(rows[1][..6], ["0.5", "0.5", "0", "0", "0", "1"]);
    for row in [&rows[2], &rows[3]] {
        assert!(row[6..].iter().all(|field| field.is_empty()), "{written}");
    }
    let number = |field: &str| field.parse::<f64>().expect("a number");
    let reflectance = f64::from(load_file(&scene).expect("the scene loads").materials[0].reflectance.x);
    for colour in 0..3 {
        let (e, b) = (number(rows[1][6 + colour]), number(rows[1][9 + colour]));
        assert!(e > 0.0 && (b / (reflectance * e) - 1.0).abs() < 1e-4, "{written}");
        // The roof emits and reflects.
        let (e, b) = (number(rows[4][6 + colour]), number(rows[4][9 + colour]));
        let emission = [10.0, 20.0, 40.0][colour];
        assert!((b / (emission + reflectance * e) - 1.0).abs() < 1e-4, "{written}");
    }
}

/// Truth: a second run reads what the first one kept, and says so; rows hold their errors beside their values.
#[test]
fn a_reference_is_written_and_kept_for_the_next_time() {
    let folder = Folder::new();
    let (out, cache) = (folder.path("points.csv"), folder.path("cache"));
    let args =
        ["reference", "cornell", "--points", "50", "--noise", "0.1", "--out", name(&out), "--cache", name(&cache)];
    let (first, _) = succeed(&args);
    assert!(first.starts_with("cornell: 50 points, ") && !first.contains("cache"), "{first}");
    let written = std::fs::read_to_string(&out).expect("the table was written");
    let (second, _) = succeed(&args);
    assert!(second.contains("all from the cache"), "{second}");
    assert_eq!(std::fs::read_to_string(&out).expect("the table was written"), written);
    let rows: Vec<Vec<f64>> = written
        .lines()
        .skip(1)
        .map(|row| row.split(',').map(|cell| cell.parse().expect("a number")).collect())
        .collect();
    assert!(written.starts_with("x,y,z,nx,ny,nz,polygon,rho_r,"), "{written}");
    assert!(rows.len() == 50 && rows.iter().all(|row| row.len() == 16), "{written}");
    assert!(rows.iter().any(|row| row[10] > 0.0 && row[13] > 0.0 && row[13] < row[10]), "{written}");
    let (finer, _) = succeed(&[&args[..4], &["--noise", "0.01"], &args[6..]].concat());
    assert!(finer.contains(" % from the cache"), "{finer}");
}

#[test]
fn a_reference_that_runs_out_of_time_says_so() {
    let (stdout, stderr) = succeed(&["reference", "cornell", "--noise", "1e-6", "--seconds", "0.2", "--no-cache"]);
    assert!(stderr.contains("the time was over") && stdout.contains("1,000 points"), "{stdout}{stderr}");
}

/// Truth: a row for each run with every parameter; pictures of the size asked for that show something.
#[test]
fn a_chart_is_tables_and_pictures() {
    let folder = Folder::new();
    let (out, cache) = (folder.path("made/charts"), folder.path("cache"));
    let (table, _) = succeed(&[
        "chart",
        "cornell",
        "--out",
        name(&out),
        "--epsilons",
        "1e-3,1e-2",
        "--settings",
        "adaptive,none",
        "--points",
        "100",
        "--noise",
        "0.05",
        "--seconds",
        "2",
        "--cache",
        name(&cache),
        "--rays-min",
        "3",
    ]);
    assert!(table.contains("| adaptive, immediate |") && table.contains("| none |"), "{table}");
    let read = |file: &str| std::fs::read_to_string(out.join(file)).expect("it was written");
    let csv = read("cornell.csv");
    let solved: Vec<&str> = csv.lines().filter(|row| !row.contains("path tracer")).collect();
    assert_eq!(solved.len(), 1 + 3 * 2, "{csv}");
    let columns = |row: &str| row.replace(", ", "; ").split(',').count();
    assert!(csv.lines().all(|row| columns(row) == columns(solved[0])), "{csv}");
    assert!(csv.contains("path tracer"), "{csv}");
    let chart: Value = serde_json::from_str(&read("cornell.json")).expect("JSON");
    let runs = chart["runs"].as_array().expect("runs");
    assert!(runs.iter().all(|run| run["params"]["rays_min"] == 3 && run["converged"] == true), "{chart}");
    let error = |index: usize| runs[index]["error"]["displayed"]["rms"].as_f64().expect("an error");
    assert!(error(1) < error(0), "a finer threshold is more accurate: {chart}");
    assert!(runs.iter().any(|run| run["pareto"] == true), "{chart}");
    for name in ["seconds", "links", "rays", "median"] {
        let picture = image::open(out.join(format!("cornell-{name}.png"))).expect("a PNG").to_rgb8();
        let colours: std::collections::HashSet<_> = picture.pixels().collect();
        assert!(picture.dimensions() == (1200, 800) && colours.len() > 50, "{name}: {} colours", colours.len());
        let drawn = read(&format!("cornell-{name}.svg"));
        assert!(drawn.contains("Pareto front") && drawn.contains("±1 standard error"));
    }
    assert!(read("cornell-median.svg").contains("median local error"));
    assert!(table.contains(" ± "), "{table}");
    for (file, error, noise) in
        [("cornell-seconds.svg", "rms", "rms_noise"), ("cornell-median.svg", "local_median", "local_median_noise")]
    {
        let of = |name: &str, run: &Value| run["error"]["displayed"][name].as_f64().expect("a number");
        let errors: Vec<_> = runs.iter().map(|run| (of(error, run), of(noise, run))).collect();
        assert!(errors.iter().all(|(error, noise)| *noise > 0.0 && noise < error), "{errors:?}");
        bars_are_standard_errors(&read(file), &errors);
    }
}

/// Truth: on a logarithmic axis a bar from e − s to e + s is as long as the logarithm of their ratio, and the tops of two bars are
/// as far apart as that of theirs, in the same number of pixels each; two pixels are rounding. Bars are the vertical lines of
/// one pixel in a curve's colour.
fn bars_are_standard_errors(svg: &str, errors: &[(f64, f64)]) {
    let is_bar = |line: &&str| {
        ["#0072B2", "#009E73"].iter().any(|colour| line.contains(&format!("stroke=\"{colour}\" stroke-width=\"1\"")))
    };
    let ends = |line: &str| {
        let points = line.split("points=\"").nth(1)?.split('"').next()?;
        let numbers: Vec<f64> = points.split([',', ' ']).filter_map(|number| number.parse().ok()).collect();
        (numbers.len() == 4 && numbers[0] == numbers[2]).then(|| (numbers[1], numbers[3]))
    };
    let bars: Vec<(f64, f64)> = svg.lines().filter(is_bar).filter_map(ends).collect();
    assert_eq!(bars.len(), errors.len(), "a bar for each run: {bars:?}");
    // From the coarse run to the fine one.
    let pixels = (bars[1].1 - bars[0].1) / ((errors[0].0 + errors[0].1) / (errors[1].0 + errors[1].1)).ln();
    for ((low, high), (error, noise)) in bars.iter().zip(errors) {
        let length = pixels * ((error + noise) / (error - noise)).ln();
        assert!((low - high - length).abs() <= 2.0, "{length} pixels: {bars:?} for {errors:?}");
    }
}

#[test]
fn our_own_scenes_are_written_and_load_again() {
    let folder = Folder::new();
    let dir = folder.path("made/for/this");
    let (stdout, _) = succeed(&["scene", "seminar", "--polygons", "3000", "--out", name(&dir)]);
    assert!(stdout.contains("seminar.obj") && stdout.contains("3,000 polygons"), "{stdout}");
    let scene = load_file(&dir.join("seminar.obj")).expect("it loads again");
    assert_eq!(scene.polygons.len(), 3000);
    assert!(scene.has_light() && scene.camera.is_some());
    assert!(dir.join("seminar.mtl").exists() && dir.join("seminar.selflink.json").exists());
}

#[test]
fn help_states_every_default() {
    let (help, _) = succeed(&["solve", "--help"]);
    for parameter in &selflink::solver::PARAMETERS {
        assert!(help.contains(&format!("--{}", parameter.flag)), "{}: {help}", parameter.flag);
    }
    assert!(help.matches("[default:").count() >= selflink::solver::PARAMETERS.len(), "{help}");
    assert!(help.contains("[default: 1e-4]") && help.contains("[default: adaptive]"), "{help}");
    let (version, _) = succeed(&["--version"]);
    assert_eq!(version.trim(), concat!("selflink ", env!("CARGO_PKG_VERSION")));
}

/// Without a display the main job is done all the same.
#[test]
fn without_a_display_the_scene_is_solved_into_a_picture() {
    let folder = Folder::new();
    let output = Command::new(env!("CARGO_BIN_EXE_selflink"))
        .args([&["cornell"], &COARSE[..]].concat())
        .env_remove("DISPLAY")
        .env_remove("WAYLAND_DISPLAY")
        .env_remove("WAYLAND_SOCKET")
        .current_dir(folder.path(""))
        .output()
        .expect("the program runs");
    let (stdout, stderr) = (text(&output.stdout), text(&output.stderr));
    assert_eq!(output.status.code(), Some(0), "{stderr}");
    assert!(stderr.contains("no window can be opened"), "{stderr}");
    assert!(stdout.starts_with("cornell: 20 polygons"), "{stdout}");
    let picture = folder.path("selflink-cornell.png");
    assert!(
        picture.exists() || stderr.contains("no picture was drawn") || cfg!(not(feature = "gui")),
        "{stdout}{stderr}"
    );
}
