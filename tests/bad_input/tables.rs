//! Tables of hand-made bad files: each gives one clear sentence: what, where, what to do; never a
//! panic.

use selflink::scene::{LoadError, Sidecar, load_file};

use crate::strict::sentence;
use crate::support::{Folder, glb, square_bytes, square_json};

#[test]
fn bad_obj_files() {
    let corners = "v 0 0 0\nv 1 0 0\nv 1 1 0\n";
    let cases: Vec<(&str, String, &[&str])> = vec![
        ("empty.obj", String::new(), &["the file is empty"]),
        ("blank.obj", " \n\t\n".into(), &["the file is empty"]),
        ("image.obj", "\u{0}".into(), &["a binary file", "OBJ, glTF, GLB, PLY and STL"]),
        ("notes.txt", "hello".into(), &["a .txt file, not a scene", "OBJ, glTF, GLB, PLY and STL"]),
        ("words.obj", "hello\nworld\n".into(), &["no polygons"]),
        ("corners.obj", corners.into(), &["no polygons"]),
        ("lines.obj", format!("{corners}l 1 2 3\n"), &["no polygons", "1 line or point"]),
        ("thin.obj", format!("{corners}f 1 2 2\n"), &["no polygons", "1 degenerate face skipped"]),
        ("nan.obj", format!("{corners}v 0 NaN 0\nf 1 2 4\n"), &["line 4", "vertex 4", "not finite"]),
        ("inf.obj", format!("v 0 0 -inf\n{corners}f 1 2 3\n"), &["line 1", "vertex 1"]),
        ("huge.obj", format!("v 1e39 0 0\n{corners}f 1 2 3\n"), &["line 1", "vertex 1"]),
        ("far.obj", format!("v 2e9 0 0\n{corners}f 1 2 3\n"), &["line 1", "vertex 1", "beyond 1e9"]),
        ("tiny.obj", "v 0 0 0\nv 1e-20 0 0\nv 0 1e-20 0\nf 1 2 3\n".into(), &["no polygons", "degenerate"]),
        ("short.obj", "v 0 0\n".into(), &["line 1", "three coordinates"]),
        ("letters.obj", "v 0 x 0\n".into(), &["line 1", "`x` is not a coordinate"]),
        ("past.obj", format!("{corners}f 1 2 3\nf 1 2 4\n"), &["line 5", "vertex 4", "there are 3"]),
        ("zero.obj", format!("{corners}f 0 1 2\n"), &["line 4", "vertex 0"]),
        ("before.obj", format!("{corners}f -4 -2 -1\n"), &["line 4", "vertex -4"]),
        ("lowest.obj", format!("{corners}f {} 1 2\n", i64::MIN), &["line 4"]),
        ("overflow.obj", format!("{corners}f 1 2 99999999999999999999\n"), &["line 4", "not a face corner"]),
        ("large.obj", format!("{corners}f 1 2 {}\n", i64::MAX), &["line 4", "there are 3"]),
        ("words in face.obj", format!("{corners}f a b c\n"), &["line 4", "`a` is not a face corner"]),
        ("no corners.obj", format!("{corners}f\n"), &["line 4", "three corners"]),
        ("many.obj", format!("{corners}f {}\n", "1 2 3 ".repeat(30_000)), &["line 4", "90000 corners"]),
        ("escape.obj", "v 0 0 \u{1b}[31m\u{7}\n".into(), &["line 1", "`\u{fffd}[31m\u{fffd}` is not a coordinate"]),
        ("separator.obj", "v 0 0 a\u{0}b\n".into(), &["a binary file"]),
        ("pane.obj", format!("mtllib pane.mtl\n{corners}usemtl pane\nf 1 2 3\n"), &["no polygons", "transparent"]),
    ];
    let folder = Folder::new();
    folder.write("pane.mtl", "newmtl pane\nd 0\n");
    for (name, content, parts) in cases {
        let said = sentence(&folder.write(name, content));
        for part in parts {
            assert!(said.contains(part), "{name}: `{part}` is not in: {said}");
        }
    }
}

#[test]
fn files_that_are_no_scenes() {
    let folder = Folder::new();
    assert!(sentence(&folder.path("gone.obj")).contains("no such file"));
    std::fs::create_dir(folder.path("folder.obj")).expect("a writable folder");
    assert!(sentence(&folder.path("folder.obj")).contains("cannot be read"));
    let png = b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR";
    for name in ["picture.png", "renamed.obj", "renamed.glb", "no_extension"] {
        let said = sentence(&folder.write(name, png));
        assert!(said.contains("an image (PNG), not a scene; Selflink reads OBJ, glTF, GLB, PLY and STL"), "{said}");
    }
    assert!(sentence(&folder.write("photo.jpg", b"\xff\xd8\xff\xe0\0\x10JFIF")).contains("an image (JPG)"));
    assert!(sentence(&folder.write("a.blend", b"BLENDER-v300")).contains("a Blender file"));
    assert!(sentence(&folder.write("a.ply", b"ply\nformat ascii 1.0\n")).contains("missing 'end_header'"));
    assert!(sentence(&folder.write("a.glb", b"not at all")).contains("without the header"));
}

/// A sound GLB whose JSON text is changed in one place.
fn broken(from: &str, to: &str) -> Vec<u8> {
    let rest = r#""scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0, "children": [1]}, {"name": "n"}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}]"#;
    let json = square_json(rest);
    assert!(json.contains(from), "{from}");
    glb(&json.replacen(from, to, 1), &square_bytes())
}

#[test]
fn bad_glb_files() {
    let cases: [(&str, &str, &str); 27] = [
        (r#""POSITION": 0"#, r#""POSITION": 9"#, "accessor 9, which is not there"),
        (r#""count": 4,"#, r#""count": 5,"#, "reaches past its data"),
        (r#""count": 4,"#, r#""count": 18446744073709551615,"#, "reaches past its data"),
        (r#""count": 4,"#, r#""count": 0,"#, "a face refers to vertex 0"),
        (r#""count": 4,"#, r#""count": -1,"#, "not understood"),
        (r#""count": 4,"#, r#""count": 3,"#, "a face refers to vertex 3, but there are 3"),
        (r#""bufferView": 0,"#, r#""bufferView": 9,"#, "not valid"),
        (r#""bufferView": 0,"#, r#""bufferView": 0, "byteOffset": 18446744073709551615,"#, "reaches past"),
        (r#""byteLength": 48"#, r#""byteLength": 4800"#, "reaches past its buffer"),
        (r#""byteLength": 48"#, r#""byteLength": 48, "byteOffset": 18446744073709551615"#, "reaches past its buffer"),
        (r#""byteLength": 48"#, r#""byteLength": 48, "byteStride": 4"#, "reaches past"),
        (r#""byteLength": 60"#, r#""byteLength": 6000000"#, "should hold 6000000 bytes"),
        (r#""byteLength": 60"#, r#""byteLength": 60, "uri": "../x.bin""#, "outside the scene's folder"),
        (r#""byteLength": 60"#, r#""byteLength": 60, "uri": "/etc/hostname""#, "outside the scene's folder"),
        (r#""byteLength": 60"#, r#""byteLength": 60, "uri": "file:///etc/hostname""#, "cannot be read"),
        (r#""byteLength": 60"#, r#""byteLength": 60, "uri": "%ff%fe""#, "no such file"),
        (r#""byteLength": 60"#, r#""byteLength": 60, "uri": "a\n\u001b[2J""#, "`a\u{fffd}\u{fffd}[2J` cannot be read"),
        (r#""byteLength": 60"#, r#""byteLength": 60, "uri": ".""#, "`.` cannot be read (it is not a plain file)"),
        (r#""byteLength": 60"#, r#""byteLength": 60, "uri": "data:;base64,!!""#, "cannot be decoded"),
        (r#""VEC3""#, r#""VEC2""#, "does not hold 3 numbers"),
        (r#""componentType": 5123"#, r#""componentType": 5126"#, "no vertex indices"),
        (r#""children": [1]"#, r#""children": [0]"#, "its own ancestor"),
        (r#""children": [1]"#, r#""children": [7]"#, "not valid"),
        (r#""mesh": 0"#, r#""mesh": 0, "translation": [3e38, 0, 0], "scale": [3e38, 1e38, 1]"#, "not finite"),
        (
            r#""indices": 1"#,
            r#""indices": 1, "extensions": {"KHR_draco_mesh_compression": {"bufferView": 0, "attributes": {"POSITION": 0}}}"#,
            "compressed data is damaged",
        ),
        (
            r#""byteLength": 48"#,
            r#""byteLength": 48, "extensions": {"EXT_meshopt_compression": {"buffer": 0, "byteLength": 48, "byteStride": 12, "count": 4, "mode": "ATTRIBUTES"}}"#,
            "compressed data is damaged",
        ),
        (
            r#""byteLength": 48"#,
            r#""byteLength": 48, "extensions": {"EXT_meshopt_compression": {"buffer": 0, "byteLength": 48, "byteStride": 12, "count": 4000000000, "mode": "ATTRIBUTES"}}"#,
            "more than 1024 MiB",
        ),
    ];
    let folder = Folder::new();
    assert!(load_file(&folder.write("sound.glb", broken("2.0", "2.0"))).is_ok());
    let unknown = broken(r#""asset": {"#, r#""extensionsRequired": ["a\nb"], "asset": {"#);
    let scene = load_file(&folder.write("unknown.glb", unknown)).expect("it is tried");
    let said = scene.skipped.sentences().join(" ");
    assert!(
        said.contains("needs extensions that are not read") && said.contains("export it without `a\u{fffd}b`"),
        "{said}"
    );
    for (from, to, part) in cases {
        let said = sentence(&folder.write("broken.glb", broken(from, to)));
        assert!(said.contains(part), "{to}: `{part}` is not in: {said}");
    }
}

/// Truth: every shorter file lacks data that the header claims.
#[test]
fn every_truncation_of_a_glb_file_is_an_error() {
    let folder = Folder::new();
    let sound = broken("2.0", "2.0");
    for length in 0..sound.len() {
        sentence(&folder.write("cut.glb", &sound[..length]));
        // The same with a header that tells the shortened length.
        if length >= 12 {
            let mut patched = sound[..length].to_vec();
            patched[8..12].copy_from_slice(&(length as u32).to_le_bytes());
            sentence(&folder.write("patched.glb", patched));
        }
    }
}

/// Any byte of a sound file may be damaged: an error or a scene, never a panic.
#[test]
fn damaged_bytes_never_panic() {
    let folder = Folder::new();
    let glb = broken("2.0", "2.0");
    let obj = b"mtllib a.mtl\no a/b\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nusemtl m\nf 1/1 2//2 3 -1\n".to_vec();
    for (name, sound) in [("damaged.glb", glb), ("damaged.obj", obj)] {
        for place in 0..sound.len() {
            for value in [[0, b'9'], [b'-', 0xff], [b'"', b'1']][place % 3] {
                let mut damaged = sound.clone();
                damaged[place] = value;
                let _ = load_file(&folder.write(name, damaged));
            }
        }
    }
}

#[test]
fn bad_sidecars() {
    let camera = |eye: &str, up: &str, hfov: &str| {
        format!(r#"{{"camera": {{"eye": {eye}, "target": [0, 0, 0], "up": {up}, "hfov_deg": {hfov}}}}}"#)
    };
    let light = |centre: &str, up: &str, size: &str| {
        format!(r#"{{"ceiling_lights": [{{"centre": {centre}, "up": {up}, "size": {size}, "exitance": [1, 1, 1]}}]}}"#)
    };
    let cases: Vec<(String, &str)> = vec![
        ("{".into(), "line 1 column 1"),
        ("".into(), "line 1 column 0"),
        (r#"{"material": {}}"#.into(), "unknown field `material`"),
        (r#"{"materials": {"a": {"reflektance": [0, 0, 0]}}}"#.into(), "unknown field `reflektance`"),
        (r#"{"materials": {"a": {"reflectance": [0, 0]}}}"#.into(), "invalid length"),
        (r#"{"materials": {"a": {"reflectance": [0, 1, 0]}}}"#.into(), "material `a` must lie between 0 and 0.99"),
        (r#"{"materials": {"a": {"reflectance": [0, -0.1, 0]}}}"#.into(), "material `a` must lie between 0 and 0.99"),
        (r#"{"materials": {"a": {"emission": [0, -1, 0]}}}"#.into(), "emission [0, -1, 0] of material `a`"),
        (r#"{"materials": {"a": {"emission": [0, 1e39, 0]}}}"#.into(), "must lie between 0 and 1e9 W/m²"),
        (r#"{"materials": {"a": {"emission": [NaN, 0, 0]}}}"#.into(), "not a valid settings file"),
        (r#"{"sides": "inside"}"#.into(), "unknown variant `inside`"),
        (r#"{"a\nb\u001b": 1}"#.into(), "unknown field `a\u{fffd}b\u{fffd}`"),
        (light("[3e38, 0, 0]", "[0, 1, 0]", "1"), "not finite or beyond 1e15"),
        (light("[0, 2e9, 0]", "[0, 1, 0]", "1"), "beyond 1e9 from the middle of the scene"),
        (camera("[2e9, 0, 0]", "[0, 1, 0]", "50"), "beyond 1e9 from the middle of the scene"),
        (light("[0, 0, 0]", "[0, 1, 0]", "3e38"), "at most 1e9"),
        (light("[0, 0, 0]", "[0, 3e38, 0]", "1"), "no direction"),
        (camera("[3e38, 0, 0]", "[0, 1, 0]", "50"), "not finite or beyond 1e15"),
        (camera("[0, 0, 1e-40]", "[0, 1, 0]", "50"), "looks at the point where its eye is"),
        (camera("[0, 0, 1]", "[0, 1e-40, 0]", "50"), "no up direction"),
        (camera("[0, 0, 0]", "[0, 1, 0]", "50"), "looks at the point where its eye is"),
        (camera("[0, 0, 1]", "[0, 0, 0]", "50"), "no up direction"),
        (camera("[0, 2, 0]", "[0, 1, 0]", "50"), "along its up direction"),
        (camera("[0, 0, 1]", "[0, 1, 0]", "180"), "between 0 and 180"),
        (camera("[0, 0, 1]", "[0, 1, 0]", "180").replace("{\"camera\": {", "{\"bookmarks\": [{").replace("}}", "}]}"), "between 0 and 180"),
        (r#"{"task_area": {"corners": [[0, 0, 0], [1, 0, 1e16]], "height": 1, "average_lux": 1, "uniformity": 1}}"#.into(), "the task area needs"),
        (r#"{"task_area": {"corners": [[0, 0, 0], [1, 0, 1]], "height": 1, "average_lux": -1, "uniformity": 1}}"#.into(), "the task area needs"),
        (r#"{"luminaires": [{"name": "l", "shape": "ring", "centre": [0, 0, 0], "direction": [0, -1, 0], "size": 1, "exitance": [1, 1, 1]}]}"#.into(), "unknown variant `ring`"),
    ];
    let folder = Folder::new();
    let scene = folder.write("room.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nf 1 2 3\n");
    for (text, part) in cases {
        folder.write("room.selflink.json", &text);
        let said = sentence(&scene);
        assert!(said.contains(part) && said.contains("room.selflink.json"), "{text}: `{part}` is not in: {said}");
        assert!(matches!(load_file(&scene), Err(LoadError::Sidecar(_))));
    }
    let unwritable = folder.path("no such folder/room.selflink.json");
    assert!(Sidecar::default().write(&unwritable).expect_err("no folder").to_string().contains("cannot be written"));
}
