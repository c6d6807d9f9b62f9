//! Sidecars: what a person sets beside a file, and what is kept of it.

use glam::Vec3;
use selflink::scene::{CameraPose, Sidecar, Sides, load_file};

use crate::SQUARE;
use crate::support::Folder;

#[test]
fn the_sidecar_decides_over_the_file() {
    let folder = Folder::new();
    folder.write(
        "room.mtl",
        "newmtl wall\nKd 1 1 1\nnewmtl lamp\nKe 1 1 1\nnewmtl pane\nKd 0.5 0.5 0.5\nnewmtl spare\nKd 0 0 0\n",
    );
    let obj = format!(
        "mtllib room.mtl\n{SQUARE}usemtl wall\nf 1 2 3\nusemtl lamp\nf 1 3 4\nusemtl pane\nf 1 2 4\nusemtl new\nf 4 2 1\n"
    );
    let path = folder.write("room.obj", obj);
    folder.write(
        "room.selflink.json",
        r#"{"materials": {"wall": {"reflectance": [0.99, 0, 0.5]}, "lamp": {"emission": [1, 2, 3]}, "pane": {"ignore": true},
            "new": {"reflectance": [0.1, 0.1, 0.1]}, "spare": {}, "typo": {}},
            "sides": "auto", "camera": {"eye": [0, 0, 5], "target": [0, 0, 0], "up": [0, 1, 0], "hfov_deg": 50}}"#,
    );
    let scene = load_file(&path).expect("a sound scene");
    assert_eq!(scene.materials[0].reflectance, Vec3::new(0.99, 0.0, 0.5));
    assert_eq!(scene.materials[1].emission, Vec3::new(1.0, 2.0, 3.0));
    assert_eq!((scene.skipped.ignored_faces, scene.skipped.clamped_materials), (1, 0));
    assert_eq!(scene.skipped.faces_without_material, 0, "the sidecar defines it");
    assert_eq!(scene.sides, Sides::Auto);
    assert_eq!(scene.camera.map(|camera| camera.hfov_deg), Some(50.0));
    let notes = scene.skipped.notes.join(" ");
    assert!(notes.contains("`typo`") && !notes.contains("spare"), "{notes}");
}

/// Truth: what is written is read back equal.
#[test]
fn a_sidecar_written_is_read_back() {
    let folder = Folder::new();
    let path = folder.write("room.obj", format!("{SQUARE}usemtl a\nf 1 2 3\nusemtl b:1\nf 1 3 4\n"));
    let mut scene = load_file(&path).expect("a sound scene");
    scene.set_emission("b:1", Vec3::new(1.0, 0.3, 7.7)).expect("a known material");
    scene.sides = Sides::Both;
    scene.camera = Some(CameraPose { eye: Vec3::Z, target: Vec3::ZERO, up: Vec3::Y, hfov_deg: 47.5 });
    let mut sidecar = Sidecar::of(&scene);
    sidecar.materials.entry("pane".to_owned()).or_default().ignore = true;
    sidecar.update(&scene);
    assert!(sidecar.materials["pane"].ignore, "what the scene cannot know is kept");
    sidecar.write(&Sidecar::path_for(&path)).expect("a writable folder");
    assert_eq!(Sidecar::read(&Sidecar::path_for(&path)).expect("what was written"), sidecar);
    let again = load_file(&path).expect("a sound scene");
    assert_eq!((again.materials, again.sides, again.camera), (scene.materials, scene.sides, scene.camera));
}

/// Truth: a person's own file. What a scene has as its file states it needs no sidecar, and what a
/// sidecar says stays.
#[test]
fn a_sidecar_holds_only_what_was_changed_and_keeps_what_it_said() {
    let folder = Folder::new();
    folder.write("room.mtl", "newmtl a\nKd 0.5 0.4 0.3\nnewmtl b\nKd 1 1 1\nnewmtl c\nKd 0.1 0.1 0.1\n");
    let faces = "usemtl a\nf 1 2 3\nusemtl b\nf 1 3 4\nusemtl c\nf 1 2 4\n";
    let path = folder.write("room.obj", format!("mtllib room.mtl\n{SQUARE}{faces}"));
    let mut scene = load_file(&path).expect("a sound scene");
    assert_eq!(Sidecar::of(&scene), Sidecar::default(), "nothing was changed, clamped values included");
    scene.set_emission("a", Vec3::ONE).expect("a known material");
    let sidecar = Sidecar::of(&scene);
    assert_eq!(sidecar.materials.keys().collect::<Vec<_>>(), ["a"]);
    assert_eq!((sidecar.materials["a"].reflectance, sidecar.sides), (None, None));

    let by_hand =
        r#"{"materials": {"c": {"reflectance": [0.1, 0.1, 0.1]}, "pane": {"ignore": true}}, "sides": "front"}"#;
    let sidecar_path = folder.write("room.selflink.json", by_hand);
    let mut merged = Sidecar::read(&sidecar_path).expect("a good sidecar");
    let before = merged.clone();
    merged.update(&load_file(&path).expect("a sound scene"));
    assert_eq!(merged, before);

    let mut permissions = std::fs::metadata(&sidecar_path).expect("it is there").permissions();
    permissions.set_readonly(true);
    std::fs::set_permissions(&sidecar_path, permissions).expect("our own file");
    let sentence = sidecar.write(&sidecar_path).expect_err("a protected file").to_string();
    assert!(sentence.contains("room.selflink.json: is read-only"), "{sentence}");
    assert_eq!(std::fs::read_to_string(&sidecar_path).expect("it is still there"), by_hand);
}

/// Truth: a light that was added is in no scene file, so the sidecar alone brings it back, with
/// what was changed of it.
#[test]
fn ceiling_lights_come_back_by_the_sidecar() {
    let folder = Folder::new();
    let path = folder.write("room.obj", format!("{SQUARE}usemtl a\nf 1 2 3\n"));
    let mut scene = load_file(&path).expect("a sound scene");
    for (height, exitance) in [(0.9, 50.0), (0.8, 20.0)] {
        let centre = Vec3::new(0.3, height, 0.1);
        scene.add_ceiling_light(centre, Vec3::Y, 0.2, Vec3::splat(exitance)).expect("a good light");
    }
    scene.set_emission("ceiling light 2", Vec3::new(1.0, 2.0, 3.0)).expect("the second light's own name");
    let sidecar_path = Sidecar::path_for(&path);
    Sidecar::of(&scene).write(&sidecar_path).expect("a writable folder");
    let again = load_file(&path).expect("a sound scene");
    assert!(again.has_light());
    assert_eq!(again.skipped, scene.skipped, "the sidecar speaks of nothing that is not there");
    assert_eq!((&again.materials, &again.placed_luminaires), (&scene.materials, &scene.placed_luminaires));
    assert_eq!(again.emitted_power(), scene.emitted_power());
    assert_eq!(Sidecar::of(&again), Sidecar::of(&scene), "saving again changes nothing");

    // As it was written before there were other luminaires.
    folder.write(
        "room.selflink.json",
        r#"{"ceiling_lights": [{"centre": [0.3, 0.9, 0.1], "up": [0, 1, 0], "size": 0.2, "exitance": [50, 50, 50]},
            {"centre": [0.3, 0.8, 0.1], "up": [0, 1, 0], "size": 0.2, "exitance": [1, 2, 3]}]}"#,
    );
    let old = load_file(&path).expect("a sound scene");
    assert_eq!((&old.materials, &old.placed_luminaires), (&scene.materials, &scene.placed_luminaires));

    let bad = [
        (r#""centre": [0, 0, 0], "up": [0, 0, 0], "size": 1, "exitance": [1, 1, 1]"#, "no direction"),
        (r#""centre": [0, 0, 0], "up": [0, 1, 0], "size": -1, "exitance": [1, 1, 1]"#, "size greater than 0"),
        (r#""centre": [0, 0, 0], "up": [0, 1, 0], "size": 1, "exitance": [1, -1, 1]"#, "exitance"),
        (r#""centre": [0, 0, 0], "up": [0, 1, 0], "size": 1"#, "exitance"),
    ];
    for (light, part) in bad {
        folder.write("room.selflink.json", format!(r#"{{"ceiling_lights": [{{{light}}}]}}"#));
        let sentence = load_file(&path).expect_err("a bad light").to_string();
        assert!(sentence.contains(part) && sentence.contains("room.selflink.json"), "{sentence}");
    }
}
