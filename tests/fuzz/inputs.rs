//! What the fuzzers make of their bytes, and what must hold of every scene that loads and of every error; `tests/bad_input` replays
//! their finds through the same functions.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use selflink::scene::{GroupTree, LoadError, MAX_EMISSION, MAX_SIDECAR_REFLECTANCE, Scene, Sidecar, load_bytes};

/// Stands between the parts of an input, on a line of its own.
const BETWEEN: &[u8] = b"\n%%\n";

/// The scene that the sidecars belong to: materials and nested groups.
const ROOM: &[u8] = b"mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nusemtl wall\nf 1 2 3 4\n\
    g desk/lamp\nusemtl lamp\nf 1 2 5\ng desk\nf 2 3 5\ng shelf/board/book\nf 3 4 5\ng shelf/board\nf 4 1 5\n";

/// Materials of [`ROOM`].
const MATERIALS: &[u8] = b"newmtl wall\nKd 0.5 0.5 0.5\nnewmtl lamp\nKe 1 2 3\nmap_Kd a.png\n";

/// A picture of one pixel.
const PNG: &[u8] = b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR\0\0\0\x01\0\0\0\x01\x08\0\0\0\0:~\x9bU\0\0\0\nIDATx\x9cch\0\0\0\x82\0\x81w\xcdr\xb6\
    \0\0\0\0IEND\xaeB`\x82";

/// An OBJ file, and behind `%%` the material file `a.mtl`.
pub fn obj(data: &[u8]) {
    let (scene, materials) = halves(data);
    check("a.obj", scene.to_vec(), files(&[("a.mtl", materials), ("a.png", PNG)]));
}

/// A GLB file, or the text of one and behind `%%` its binary chunk, which is also the file `a.bin`.
pub fn glb(data: &[u8]) {
    if data.starts_with(b"glTF") {
        check("a.glb", data.to_vec(), files(&[("a.png", PNG)]));
        return;
    }
    let (json, binary) = halves(data);
    let chunk = |kind: &[u8; 4], content: &[u8]| [&(content.len() as u32).to_le_bytes()[..], kind, content].concat();
    let chunks = [chunk(b"JSON", json), chunk(b"BIN\0", binary)].concat();
    let length = 12 + chunks.len() as u32;
    let glb = [b"glTF", &2_u32.to_le_bytes()[..], &length.to_le_bytes()[..], &chunks].concat();
    check("a.glb", glb, files(&[("a.bin", binary), ("a.png", PNG)]));
}

/// A sidecar of a small room.
pub fn sidecar(data: &[u8]) {
    check("a.obj", ROOM.to_vec(), files(&[("a.mtl", MATERIALS), ("a.png", PNG), ("a.selflink.json", data)]));
}

fn halves(data: &[u8]) -> (&[u8], &[u8]) {
    match data.windows(BETWEEN.len()).position(|window| window == BETWEEN) {
        Some(at) => (&data[..at], &data[at + BETWEEN.len()..]),
        None => (data, b""),
    }
}

fn files(named: &[(&str, &[u8])]) -> BTreeMap<PathBuf, Vec<u8>> {
    named.iter().map(|(name, content)| (PathBuf::from(name), content.to_vec())).collect()
}

/// Loads, and checks what comes of it.
fn check(name: &str, bytes: Vec<u8>, files: BTreeMap<PathBuf, Vec<u8>>) {
    match load_bytes(Path::new(name), bytes, &files) {
        Ok(scene) => check_scene(&scene),
        Err(error) => check_error(&error),
    }
}

/// One sentence that names the file and fits on a screen.
fn check_error(error: &LoadError) {
    let said = error.to_string();
    assert!(said.starts_with("a.") && said.len() > 10, "names the file: {said:?}");
    assert!(said.chars().count() < 3000, "{} characters", said.chars().count());
    assert!(!said.chars().any(char::is_control), "one line: {said:?}");
}

/// What every later layer takes for granted.
fn check_scene(scene: &Scene) {
    assert!(!scene.polygons.is_empty());
    for polygon in &scene.polygons {
        assert!(polygon.corners().iter().all(|&corner| (corner as usize) < scene.vertices.len()));
        assert!(
            (polygon.material.0 as usize) < scene.materials.len() && (polygon.group.0 as usize) < scene.groups.len()
        );
        assert!(scene.area(polygon).is_finite() && scene.normal(polygon).is_finite());
    }
    // A light may reach half its size beyond the largest coordinate.
    assert!(scene.vertices.iter().all(|vertex| vertex.is_finite() && vertex.abs().max_element() <= 2.1e9));
    for material in scene.materials.iter().chain(&scene.filed_materials) {
        let (reflectance, emission) = (material.reflectance, material.emission);
        assert!(
            reflectance.min_element() >= 0.0 && reflectance.max_element() <= MAX_SIDECAR_REFLECTANCE,
            "{material:?}"
        );
        assert!(emission.min_element() >= 0.0 && emission.max_element() <= MAX_EMISSION, "{material:?}");
        assert!(reflectance.is_finite() && emission.is_finite(), "{material:?}");
        check_name(&material.name);
    }
    for (index, group) in scene.groups.iter().enumerate() {
        assert_eq!(group.parent.is_none(), index == 0);
        assert!(group.parent.is_none_or(|parent| (parent.0 as usize) < index), "parents come first");
        check_name(&group.name);
    }
    if let Some(camera) = &scene.camera {
        let forward = (camera.target - camera.eye).normalize();
        assert!(forward.cross(camera.up.normalize()).length() > 0.0, "{camera:?}");
    }
    for said in scene.skipped.sentences() {
        assert!(!said.is_empty() && !said.chars().any(char::is_control), "{said:?}");
    }
    check_groups(scene);
    check_saved(scene);
}

fn check_name(name: &str) {
    assert!(name.chars().count() <= 200 && !name.chars().any(char::is_control), "{name:?}");
}

/// Groups made by hand can be told, and told they are the same.
fn check_groups(scene: &Scene) {
    let tree = scene.group_tree();
    assert!(tree.addresses().iter().all(|address| address.len() <= 1100));
    let (again, remarks) = GroupTree::arranged(&scene.groups, &tree.members(&scene.groups));
    assert!(again == tree && remarks.is_empty(), "{tree:?}\n{again:?}\n{remarks:?}");
}

/// What is saved beside a scene can be read again.
fn check_saved(scene: &Scene) {
    let saved = Sidecar::of(scene);
    let text = serde_json::to_vec(&saved).expect("a sidecar is JSON");
    let again = Sidecar::from_bytes(Path::new("a.selflink.json"), &text).expect("what was saved can be read");
    assert_eq!(again.groups, saved.groups);
    assert_eq!(again.materials.len(), saved.materials.len());
}
