//! What the fuzzers make of their bytes, and what must hold of every scene that loads and of every
//! error; `tests/bad_input` replays their finds through the same functions.

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
    check("a.glb", container(json, binary), files(&[("a.bin", binary), ("a.png", PNG)]));
}

fn container(json: &[u8], binary: &[u8]) -> Vec<u8> {
    let chunk = |kind: &[u8; 4], content: &[u8]| [&(content.len() as u32).to_le_bytes()[..], kind, content].concat();
    let chunks = [chunk(b"JSON", json), chunk(b"BIN\0", binary)].concat();
    let length = 12 + chunks.len() as u32;
    [b"glTF", &2_u32.to_le_bytes()[..], &length.to_le_bytes()[..], &chunks].concat()
}

/// A sidecar of a small room.
pub fn sidecar(data: &[u8]) {
    check("a.obj", ROOM.to_vec(), files(&[("a.mtl", MATERIALS), ("a.png", PNG), ("a.selflink.json", data)]));
}

/// A PLY file.
pub fn ply(data: &[u8]) {
    check("a.ply", data.to_vec(), files(&[]));
}

/// An STL file.
pub fn stl(data: &[u8]) {
    check("a.stl", data.to_vec(), files(&[]));
}

/// A picture, laid on a room under names of formats with and without a mark of their own.
pub fn texture(data: &[u8]) {
    let materials =
        b"newmtl wall\nKd 0.5 0.5 0.5\nmap_Kd a.png\nmap_d a.tga\nnewmtl lamp\nmap_Kd a.tga\nmap_Ke a.dds\n";
    let room = String::from_utf8_lossy(ROOM).replace("usemtl wall", "vt 0 0\nvt 1 0\nvt 0 1\nusemtl wall");
    let room = room.replace("f 1 2 5", "f 1/1 2/2 5/3").replace("f 1 2 3 4", "f 1/1 2/2 3/3 4/1");
    let named = [("a.mtl", &materials[..]), ("a.png", data), ("a.tga", data), ("a.dds", data)];
    check("a.obj", room.into_bytes(), files(&named));
}

/// Compressed geometry: a byte each for what is compressed and how (see below), two for a count,
/// and behind them the compressed bytes.
pub fn compressed(data: &[u8]) {
    let &[what, filter, stride, low, high, ref payload @ ..] = data else { return };
    let count = usize::from(u16::from_le_bytes([low, high]));
    let (stride, length) = (usize::from(stride), payload.len());
    let mode = ["ATTRIBUTES", "TRIANGLES", "INDICES"][usize::from(what % 3)];
    let filter = ["NONE", "OCTAHEDRAL", "QUATERNION", "EXPONENTIAL", "COLOR"][usize::from(filter % 5)];
    let by_draco = what >= 128;
    let (positions, indices) = match (by_draco, what % 3) {
        (true, _) => (String::new(), String::new()),
        (_, 0) => (r#""bufferView": 2,"#.to_owned(), r#""bufferView": 1,"#.to_owned()),
        _ => (r#""bufferView": 0,"#.to_owned(), r#""bufferView": 2,"#.to_owned()),
    };
    let [corners, indices_there] = if what % 3 == 0 && !by_draco { [count, 6] } else { [4, count] };
    let of_indices = if stride == 2 || what % 3 == 0 { 5123 } else { 5125 };
    let decoded = count * stride;
    let view = if by_draco {
        format!(r#"{{"buffer": 0, "byteOffset": 60, "byteLength": {length}}}"#)
    } else {
        format!(
            r#"{{"buffer": 1, "byteLength": {decoded}, "byteStride": {stride}, "extensions": {{"EXT_meshopt_compression":
            {{"buffer": 0, "byteOffset": 60, "byteLength": {length}, "byteStride": {stride}, "count": {count}, "mode": "{mode}", "filter": "{filter}"}}}}}}"#
        )
    };
    let draco = r#", "extensions": {"KHR_draco_mesh_compression": {"bufferView": 2, "attributes": {"POSITION": 0, "NORMAL": 1, "TEXCOORD_0": 2, "COLOR_0": 3}}}"#;
    let json = format!(
        r#"{{"asset": {{"version": "2.0"}}, "buffers": [{{"byteLength": {}}}, {{"byteLength": {decoded}}}],
        "bufferViews": [{{"buffer": 0, "byteLength": 48}}, {{"buffer": 0, "byteOffset": 48, "byteLength": 12}}, {view}],
        "accessors": [{{{positions} "componentType": 5126, "count": {corners}, "type": "VEC3"}},
            {{{indices} "componentType": {of_indices}, "count": {indices_there}, "type": "SCALAR"}}],
        "meshes": [{{"primitives": [{{"attributes": {{"POSITION": 0}}, "indices": 1{}}}]}}],
        "nodes": [{{"mesh": 0}}], "scenes": [{{"nodes": [0]}}]}}"#,
        60 + length,
        if by_draco { draco } else { "" }
    );
    let corners = [0.0_f32, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 1.0, 0.0].map(f32::to_le_bytes);
    let indices = [0_u16, 1, 2, 0, 2, 3].map(u16::to_le_bytes);
    let binary = [corners.as_flattened(), indices.as_flattened(), payload].concat();
    check("a.glb", container(json.as_bytes(), &binary), files(&[]));
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

/// Checks everything that later layers take for granted.
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

/// Groups made by hand can be written as a list, and read from it they are the same.
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
