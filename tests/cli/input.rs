//! Bad input, help, and our own scenes as files.

use selflink::scene::load_file;

use crate::support::*;

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
        (vec!["solve", good, "--sky", "cloudy"], "KIND:AMOUNT"),
        (vec!["solve", good, "--sky", "clear"], "--sun"),
        (vec!["solve", good, "--sky", "gone.hdr"], "gone.hdr"),
        (vec!["solve", good, "--sun", "az:1"], "az:DEGREES"),
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
        (vec!["scene", "tower", "--polygons", "5000", "--out", name(&nowhere)], "between 10000 and"),
        (vec!["scene", "office"], "--out"),
        (vec!["scene", "cornell", "--out", good], "cannot be written"),
    ];
    #[cfg(feature = "gui")]
    let cases = [
        cases,
        vec![
            (vec!["chart", "cornell", "--out", name(&gone), "--picture", "--errors", "0.1,much"], "--errors must be"),
            (vec!["chart", "cornell", "--out", name(&gone), "--picture", "--samples", "100"], "a power of two"),
            (vec!["chart", "cornell", "--out", name(&gone), "--picture", "--size", "0x9"], "--size must be"),
            (vec!["chart", "cornell", "--out", name(&gone), "--picture", "--epsilons", "1e-2"], "--epsilons"),
            (vec!["chart", "cornell", "--out", name(&gone), "--errors", "0.1"], "--picture"),
        ],
    ]
    .concat();
    for (args, part) in cases {
        let said = refused(&args);
        assert!(said.contains(part), "{args:?}: `{part}` is not in: {said}");
        assert!(!said.contains("os error") && !said.contains("literal"), "{args:?}: {said}");
    }
    assert!(!mesh_as_obj.exists());
    assert_eq!(std::fs::read_to_string(good).expect("the scene is still there"), SQUARE, "nothing was overwritten");
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
    let (stdout, _) = succeed(&["scene", "tower", "--polygons", "10000", "--out", name(&dir)]);
    assert!(stdout.contains("tower.obj") && stdout.contains("8,076 polygons"), "two whole offices: {stdout}");
}

#[test]
fn help_states_every_default() {
    let (help, _) = succeed(&["solve", "--help"]);
    for parameter in &selflink::solve::PARAMETERS {
        assert!(help.contains(&format!("--{}", parameter.flag)), "{}: {help}", parameter.flag);
    }
    assert!(help.matches("[default:").count() >= selflink::solve::PARAMETERS.len(), "{help}");
    assert!(help.contains("[default: 1e-4]") && help.contains("[default: adaptive]"), "{help}");
    let (version, _) = succeed(&["--version"]);
    assert_eq!(version.trim(), concat!("selflink ", env!("CARGO_PKG_VERSION")));
}

/// Truth: what the files hold, counted by hand; stderr says it in sentences, the statistics as
/// numbers.
#[test]
fn what_is_left_out_is_counted_for_programs_and_said_to_people() {
    let folder = Folder::new();
    let surfaces = folder.write("a.obj", format!("{SQUARE}curv 0 1 1 2 3\nsurf 0 1 0 1 1 2 4 3\n"));
    let (stdout, stderr) = succeed(&[&["solve", name(&surfaces), "--stats", "-"], &COARSE[..]].concat());
    assert!(stderr.contains("note: 2 curves and curved surfaces left out"), "{stderr}");
    let stats: serde_json::Value = serde_json::from_str(&stdout).expect("stdout is pure JSON");
    assert_eq!(stats["skipped"]["curves_and_surfaces"], 2);

    let corners = [[0.0_f32, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0]];
    folder.write("b.bin", corners.as_flattened().iter().flat_map(|value| value.to_le_bytes()).collect::<Vec<u8>>());
    let gltf = folder.write(
        "b.gltf",
        r#"{"asset": {"version": "2.0"}, "extensionsUsed": ["ACME_shine", "KHR_lights_punctual"],
        "extensions": {"KHR_lights_punctual": {"lights": [{"name": "Bulb", "type": "spot", "intensity": 10, "range": 5,
            "spot": {"innerConeAngle": 0.25, "outerConeAngle": 0.5}}]}},
        "buffers": [{"byteLength": 36, "uri": "b.bin"}], "bufferViews": [{"buffer": 0, "byteLength": 36}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}, {"attributes": {"POSITION": 0}, "mode": 1}]}],
        "cameras": [{"type": "orthographic", "orthographic": {"xmag": 1, "ymag": 1, "zfar": 9, "znear": 0.1}}],
        "animations": [{"channels": [], "samplers": []}],
        "nodes": [{"mesh": 0}, {"camera": 0, "translation": [0, 0, 2]},
            {"translation": [0.5, 0.2, 1], "extensions": {"KHR_lights_punctual": {"light": 0}}}], "scenes": [{"nodes": [0, 1, 2]}]}"#,
    );
    let (stdout, stderr) = succeed(&[&["solve", name(&gltf), "--stats", "-"], &COARSE[..]].concat());
    for part in ["1 animation left out", "1 camera without perspective", "1 line or point", "not read: `ACME_shine`"] {
        assert_eq!(stderr.matches(part).count(), 1, "{part}: {stderr}");
    }
    let stats: serde_json::Value = serde_json::from_str(&stdout).expect("stdout is pure JSON");
    let skipped = &stats["skipped"];
    let counts = ["animations", "ignored_cameras", "lines_and_points"].map(|key| skipped[key].as_u64());
    assert_eq!(counts, [Some(1); 3]);
    assert_eq!(skipped["unread_extensions"][0]["name"], "ACME_shine");
    let light = &stats["lights"][0];
    assert_eq!((&light["name"], &light["range"], &light["cone"][1]), (&"Bulb".into(), &5.0.into(), &0.5.into()));
}

/// Truth: a roof of one square metre, or a square centimetre, emits 1 W/m² in each of three
/// colours; a clear one is left out until it is to be opaque; along z the floor lies at 0 and the
/// plane at 0.4.
#[test]
fn files_are_read_as_a_person_says() {
    let folder = Folder::new();
    folder.write("a.mtl", "newmtl floor\nKd 0.5 0.5 0.5\nnewmtl roof\nd 0.1\n");
    let path = folder.write("a.obj", format!("mtllib a.mtl\n{SQUARE}"));
    let scene = name(&path);
    let opaque = ["--opaque", "roof", "--emit", "roof=1,1,1"];
    let clear = stats(scene, &[]);
    assert_eq!((&clear["skipped"]["transparent_faces"], &clear["initial_patches"]), (&1.into(), &1.into()));
    for (unit, area) in [("m", 1.0), ("cm", 1e-4), ("ft", 0.3048 * 0.3048)] {
        let found = stats(scene, &[&opaque[..], &["--unit", unit]].concat());
        let watts = found["emitted_watts"].as_f64().expect("a number");
        assert!((watts / (3.0 * area) - 1.0).abs() < 1e-5, "{unit}: {watts} W");
        assert_eq!(found["skipped"]["transparent_faces"], 0);
    }
    let out = folder.path("plane.csv");
    let plane = ["--up", "z", "--work-plane", "0.4", "--spacing", "0.25", "--margin", "0.1", "--out", name(&out)];
    succeed(&[&["probe", scene], &opaque[..], &plane[..], &COARSE[..]].concat());
    let text = std::fs::read_to_string(&out).expect("written");
    let levels: Vec<f64> =
        text.lines().skip(1).map(|row| row.split(',').nth(2).and_then(|z| z.parse().ok()).expect("z")).collect();
    assert!(!levels.is_empty() && levels.iter().all(|z| (z - 0.4).abs() < 1e-6), "{text}");
}
