//! No file makes the program read outside the scene's folder, by whatever name or link, nor write
//! there.
//!
//! Truth: a secret beside the folder, with colours and shapes that would show.

use std::fs;
use std::path::Path;

use glam::Vec3;
use selflink::scene::{Scene, Sidecar};

use crate::strict::{scene, sentence};
use crate::support::{Folder, glb, square_bytes, square_json};

const SQUARE: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nusemtl m\nf 1 2 3 4\n";
const GREY: Vec3 = Vec3::splat(0.5);

/// Ways to name `secret.EXTENSION` in the folder above the scene's, by name alone and through
/// links.
fn escapes(outer: &Folder, extension: &str) -> Vec<String> {
    let secret = outer.path(&format!("secret.{extension}")).display().to_string();
    let mut ways = vec![
        format!("../secret.{extension}"),
        format!("./../secret.{extension}"),
        format!("inner/../../secret.{extension}"),
        format!("..\\secret.{extension}"),
        format!("inner\\..\\..\\secret.{extension}"),
        format!("C:\\secret.{extension}"),
        format!("\\\\server\\secret.{extension}"),
        format!("file://{secret}"),
        format!("file:{secret}"),
        format!("//{secret}"),
        format!("\\{secret}"),
        format!("~/secret.{extension}"),
        secret,
    ];
    if link(Path::new(&format!("../secret.{extension}")), &outer.path(&format!("scene/link.{extension}"))) {
        link(Path::new(".."), &outer.path("scene/up"));
        link(Path::new("up"), &outer.path("scene/up2"));
        ways.extend(["link", "up/secret", "up2/secret"].map(|name| format!("{name}.{extension}")));
    }
    ways
}

/// Makes a link, where the system has them.
fn link(target: &Path, link: &Path) -> bool {
    #[cfg(unix)]
    let made = std::os::unix::fs::symlink(target, link).is_ok() || link.is_symlink();
    #[cfg(not(unix))]
    let made = false;
    if !made {
        crate::left_out::left_out("symbolic links; none can be made here");
    }
    made
}

/// A folder with the folder `scene` in it, and in that the folder `inner`.
fn nested() -> Folder {
    let outer = Folder::new();
    fs::create_dir_all(outer.path("scene/inner")).expect("a writable folder");
    outer
}

fn assert_grey(scene: &Scene, way: &str) {
    let notes = scene.skipped.sentences().join(" ");
    let reflectance = scene.materials[0].reflectance;
    assert!(reflectance == GREY || reflectance == 0.5 * GREY, "{way}: {notes}");
    assert!(notes.contains("outside the scene's folder") || notes.contains("no such file"), "{way}: {notes}");
}

#[test]
fn material_files() {
    let outer = nested();
    outer.write("secret.mtl", "newmtl m\nKd 0.1 0.2 0.3\n");
    for way in escapes(&outer, "mtl") {
        assert_grey(&scene(&outer.write("scene/room.obj", format!("mtllib {way}\n{SQUARE}"))), &way);
    }
}

#[test]
fn textures_of_material_files() {
    let outer = nested();
    outer.write("secret.png", crate::pictures::one_pixel());
    for way in escapes(&outer, "png") {
        outer.write("scene/room.mtl", format!("newmtl m\nKd 0.5 0.5 0.5\nmap_Kd {way}\n"));
        assert_grey(&scene(&outer.write("scene/room.obj", format!("mtllib room.mtl\n{SQUARE}"))), &way);
    }
}

/// How a URI may hide a name: as it is, and with percent signs in place of letters that matter.
fn disguises(way: &str) -> Vec<String> {
    let escaped = way.replace('\\', "\\\\");
    let hidden = |from: &str, to: &str| escaped.replace(from, to);
    vec![
        escaped.clone(),
        hidden("..", "%2e%2e"),
        hidden("..", "%2E."),
        hidden("/", "%2f"),
        hidden("\\\\", "%5c"),
        hidden("..", "%252e%252e"),
    ]
}

const NODES: &str = r#""nodes": [{"mesh": 0}], "scenes": [{"nodes": [0]}],
    "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1, "material": 0}]}]"#;

#[test]
fn buffers() {
    let outer = nested();
    outer.write("secret.bin", square_bytes());
    let json = square_json(&format!(r#""materials": [{{}}], {NODES}"#));
    for way in escapes(&outer, "bin").iter().flat_map(|way| disguises(way)) {
        let json = json.replace(r#""byteLength": 60"#, &format!(r#""byteLength": 60, "uri": "{way}""#));
        let said = sentence(&outer.write("scene/room.gltf", json));
        assert!(said.contains("outside the scene's folder") || said.contains("no such file"), "{way}: {said}");
    }
    outer.write("scene/inner/own.bin", square_bytes());
    let json = json.replace(r#""byteLength": 60"#, r#""byteLength": 60, "uri": "inner%2fown%2Ebin""#);
    assert_eq!(scene(&outer.write("scene/room.gltf", json)).polygons.len(), 2, "its own files are read");
}

#[test]
fn images() {
    let outer = nested();
    outer.write("secret.png", crate::pictures::one_pixel());
    for way in escapes(&outer, "png").iter().flat_map(|way| disguises(way)) {
        let material =
            r#"{"pbrMetallicRoughness": {"baseColorFactor": [0.5, 0.5, 0.5, 1], "baseColorTexture": {"index": 0}}}"#;
        let json = format!(
            r#""materials": [{material}], "textures": [{{"source": 0}}], "images": [{{"uri": "{way}"}}], {NODES}"#
        );
        assert_grey(&scene(&outer.write("scene/room.glb", glb(&square_json(&json), &square_bytes()))), &way);
    }
}

#[test]
fn links_that_stay_in_the_folder_are_followed() {
    let outer = nested();
    outer.write("scene/inner/own.mtl", "newmtl m\nKd 0.1 0.2 0.3\n");
    if link(Path::new("inner/own.mtl"), &outer.path("scene/link.mtl")) {
        let scene = scene(&outer.write("scene/room.obj", format!("mtllib link.mtl\n{SQUARE}")));
        assert_eq!(scene.materials[0].reflectance, Vec3::new(0.1, 0.2, 0.3));
    }
}

/// Truth: the bytes of the file that the link leads to.
#[test]
fn sidecars_are_neither_read_nor_written_through_links() {
    let outer = nested();
    let secret = outer.write("secret.json", r#"{"sides": "both"}"#);
    let room = outer.write("scene/room.obj", SQUARE);
    let sidecar = Sidecar::path_for(&room);
    if !link(Path::new("../secret.json"), &sidecar) {
        return;
    }
    assert!(sentence(&room).contains("room.selflink.json: cannot be read (it lies outside the scene's folder)"));
    let said = Sidecar::default().write(&sidecar).expect_err("it leads out").to_string();
    assert!(said.contains("is not written, for it lies outside the scene's folder; move it away"), "{said}");
    assert_eq!(fs::read_to_string(secret).expect("it is there"), r#"{"sides": "both"}"#);
    fs::remove_file(&sidecar).expect("a writable folder");
    link(Path::new("../not yet there"), &sidecar);
    assert!(Sidecar::default().write(&sidecar).is_err());
    assert!(!outer.path("not yet there").exists(), "nothing was made out there");
}
