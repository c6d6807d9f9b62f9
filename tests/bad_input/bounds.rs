//! Small files that ask for endless memory or time.
//!
//! Truth: an answer at all, and where memory is the question a program that may not take more
//! address space than is said. What each would need without bounds is said beside it: days, or more
//! memory than there is.

use std::fmt::Write as _;

use selflink::scene::Sidecar;

use crate::strict::{ends, scene, sentence, with_a_hole};
use crate::support::{Folder, glb, square_bytes, square_json};

const SQUARE: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nusemtl m\nf 1 2 3 4\n";

fn repeated(count: usize, each: impl Fn(usize) -> String) -> String {
    (0..count).map(each).collect::<Vec<_>>().join(",")
}

#[test]
fn files_of_a_terabyte() {
    let folder = Folder::new();
    let said = sentence(&with_a_hole(&folder.path("a.obj"), SQUARE.as_bytes(), 1 << 40));
    assert!(said.contains("longer than 2048 MiB, the most that can be loaded"), "{said}");
    with_a_hole(&folder.path("a.mtl"), b"newmtl m\n", 1 << 40);
    let room = scene(&folder.write("b.obj", format!("mtllib a.mtl\n{SQUARE}")));
    assert!(room.skipped.notes[0].contains("it is longer than 64 MiB"), "{:?}", room.skipped.notes);
    with_a_hole(&folder.path("a.bin"), &square_bytes(), 1 << 40);
    let json = square_json(r#""scenes": [{"nodes": []}]"#).replace("60", r#"60, "uri": "a.bin""#);
    assert!(sentence(&folder.write("c.gltf", json)).contains("it is longer than 2048 MiB"));
    with_a_hole(&folder.path("d.selflink.json"), b"{}", 1 << 40);
    assert!(
        sentence(&folder.write("d.obj", SQUARE)).contains("d.selflink.json: cannot be read (it is longer than 64 MiB)")
    );
}

/// Up to 2⁶⁰ bytes.
#[cfg(target_os = "linux")]
#[test]
fn lengths_and_counts_beyond_the_file() {
    use crate::strict::sentence_in_little_memory;

    let folder = Folder::new();
    let node = r#""nodes": [{"mesh": 0}], "scenes": [{"nodes": [0]}]"#;
    let primitive = r#"{"attributes": {"POSITION": 0}, "indices": 1}"#;
    let json = square_json(&format!(r#""meshes": [{{"primitives": [{primitive}]}}], {node}"#));
    let with = |from: &str, to: &str| {
        assert!(json.contains(from), "{from}");
        glb(&json.replacen(from, to, 1), &square_bytes())
    };
    let mut long_header = glb(&json, &square_bytes());
    long_header[8..12].copy_from_slice(&u32::MAX.to_le_bytes());
    let mut long_chunk = glb(&json, &square_bytes());
    long_chunk[12..16].copy_from_slice(&0xffff_fff0_u32.to_le_bytes());
    let zeros = |count: u64| {
        format!(
            r#"{{"componentType": 5126, "count": {count}, "type": "VEC3", "sparse": {{"count": 1,
            "indices": {{"bufferView": 1, "componentType": 5121}}, "values": {{"bufferView": 0}}}}}}"#
        )
    };
    let first = r#"{"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3"}"#;
    // 65,536 vertices in each of 3,000 primitives: 2.4 GB.
    let shared = json.replacen(first, &zeros(65_536), 1).replacen(primitive, &repeated(3000, |_| primitive.into()), 1);
    let cases = [
        ("header", long_header, "the file is cut off"),
        ("chunk", long_chunk, "the file is damaged or cut off"),
        (
            "buffer",
            with(r#""byteLength": 60"#, r#""byteLength": 1152921504606846976"#),
            "should hold 1152921504606846976",
        ),
        ("accessor", with(r#""count": 4,"#, r#""count": 1152921504606846976,"#), "reaches past its data"),
        ("stride", with(r#""byteLength": 48"#, r#""byteLength": 48, "byteStride": 0"#), "byteStride: Invalid value"),
        ("sparse", with(first, &zeros(1 << 60)), "reaches past its data"),
        ("sparse", with(first, &zeros(30_000_000)), "has no data"),
        ("shared", glb(&shared, &square_bytes()), "more than the 32000000 that can be loaded"),
    ];
    for (name, content, part) in cases {
        let said = sentence_in_little_memory(2500, &folder.write(&format!("{name}.glb"), content));
        assert!(said.contains(part), "{name}: `{part}` is not in: {said}");
    }
}

/// 40 gigabytes if each buffer were read by itself.
#[test]
fn one_file_as_many_buffers() {
    let folder = Folder::new();
    let mut bytes = square_bytes();
    bytes.resize(4 << 20, 0);
    folder.write("a.bin", bytes);
    let buffers = repeated(10_000, |_| r#"{"byteLength": 60, "uri": "a.bin"}"#.into());
    let json = square_json(
        r#""nodes": [{"mesh": 0}], "scenes": [{"nodes": [0]}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}]"#,
    );
    let json = json.replace(r#"{"byteLength": 60}"#, &buffers);
    assert_eq!(scene(&folder.write("a.gltf", json)).polygons.len(), 2);
}

/// 48 million triangles, of 90 kB of indices in a hundred primitives and 16 nodes.
#[test]
#[ignore = "slow: as many as can be loaded are made first"]
fn slow_instances_of_instances() {
    let folder = Folder::new();
    let mut bytes = square_bytes();
    bytes.extend([0, 1, 2].repeat(30_000));
    let json = square_json(&format!(
        r#""nodes": [{}], "scenes": [{{"nodes": [{}]}}], "meshes": [{{"primitives": [{}]}}]"#,
        repeated(16, |_| r#"{"mesh": 0}"#.into()),
        repeated(16, |node| node.to_string()),
        repeated(100, |_| r#"{"attributes": {"POSITION": 0}, "indices": 1}"#.into())
    ));
    let json = json.replace(r#""byteLength": 60"#, r#""byteLength": 90060"#);
    let json = json.replace(r#""byteOffset": 48, "byteLength": 12"#, r#""byteOffset": 60, "byteLength": 90000"#);
    let json = json.replace(r#"5123, "count": 6"#, r#"5121, "count": 90000"#);
    assert!(sentence(&folder.write("a.glb", glb(&json, &bytes))).contains("more than the 32000000"));
}

#[test]
fn nodes_without_end() {
    let folder = Folder::new();
    let json = |nodes: String| {
        let mesh = r#""meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}]"#;
        glb(&square_json(&format!(r#""nodes": [{nodes}], "scenes": [{{"nodes": [0]}}], {mesh}"#)), &square_bytes())
    };
    let cyclic = repeated(3, |node| format!(r#"{{"mesh": 0, "children": [{}]}}"#, (node + 1) % 3));
    assert!(sentence(&folder.write("cyclic.glb", json(cyclic))).contains("two parents or is its own ancestor"));
    // 2⁵⁰ instances.
    let doubled = repeated(50, |node| match node {
        49 => r#"{"mesh": 0}"#.to_owned(),
        _ => format!(r#"{{"children": [{}, {}]}}"#, node + 1, node + 1),
    });
    assert!(sentence(&folder.write("doubled.glb", json(doubled))).contains("two parents or is its own ancestor"));
    // Its paths are 40 gigabytes together.
    let chain = repeated(200_000, |node| match node {
        199_999 => r#"{"mesh": 0}"#.to_owned(),
        _ => format!(r#"{{"children": [{}]}}"#, node + 1),
    });
    let room = scene(&folder.write("chain.glb", json(chain)));
    assert!(room.groups.len() < 100 && room.polygons.len() == 2);
    assert!(room.skipped.notes.join(" ").contains("Groups nested too deeply"), "{:?}", room.skipped.notes);
    // The addresses of its groups are 40 gigabytes together.
    let children = (1..40_000).map(|node| node.to_string()).collect::<Vec<_>>().join(",");
    let below_a_long_name = repeated(40_000, |node| match node {
        0 => format!(r#"{{"mesh": 0, "name": "{}", "children": [{children}]}}"#, "a".repeat(1 << 20)),
        _ => r#"{"name": "b"}"#.to_owned(),
    });
    let room = scene(&folder.write("names.glb", json(below_a_long_name)));
    assert!(room.group_tree().addresses().iter().all(|address| address.len() < 1100));
}

#[test]
fn brackets_without_end() {
    let folder = Folder::new();
    let deep = "[".repeat(1_000_000);
    let said =
        sentence(&folder.write("a.glb", glb(&format!(r#"{{"asset": {{"version": "2.0", "extras": {deep}"#), b"")));
    assert!(said.contains("not understood"), "{said}");
    assert!(sentence(&folder.write("b.gltf", format!(r#"{{"nodes": {deep}"#))).contains("not understood"));
    let room = folder.write("c.obj", SQUARE);
    for text in [format!(r#"{{"groups": {deep}"#), format!(r#"{{"groups": [{}"#, r#"{"a": ["#.repeat(500_000))] {
        folder.write("c.selflink.json", text);
        assert!(sentence(&room).contains("not a valid settings file"));
    }
}

/// Levels whose paths are 40 gigabytes together.
#[test]
fn groups_without_end() {
    let folder = Folder::new();
    let path = "a/".repeat(200_000);
    let room =
        scene(&folder.write("deep.obj", format!("v 0 0 0\nv 1 0 0\nv 1 1 0\ng {path}\nf 1 2 3\ng {path}b\nf 1 3 2\n")));
    assert!(room.groups.len() < 100 && room.polygons.len() == 2);
    let mut text = String::from(SQUARE);
    for number in 0..30_000 {
        // Writing to a string cannot fail.
        let _ = write!(text, "g {number}\nusemtl {number}\n");
    }
    assert_eq!(scene(&folder.write("empty.obj", text)).polygons.len(), 1);
}

/// One group in nothing but its name may hold all the others; the notes are as many.
#[test]
fn sidecars_without_end() {
    let folder = Folder::new();
    let room = folder.write("a.obj", SQUARE);
    let light = r#"{"centre": [0, 1, 0], "up": [0, 1, 0], "size": 0.5, "exitance": [1, 1, 1]}"#;
    folder.write("a.selflink.json", format!(r#"{{"ceiling_lights": [{}]}}"#, repeated(100_000, |_| light.into())));
    assert!(sentence(&room).contains("100000 luminaires are more than the 1000 there may be"));
    folder.write("a.selflink.json", format!(r#"{{"ceiling_lights": [{}]}}"#, repeated(1000, |_| light.into())));
    assert_eq!(scene(&room).placed_luminaires.len(), 1000);
    let long = "a".repeat(1 << 20);
    let members = repeated(40_000, |_| r#"{"b": []}"#.into());
    let materials = repeated(40_000, |number| format!(r#""{number}": {{}}"#));
    let text = format!(r#"{{"groups": [{{"{long}": [{members}]}}], "materials": {{"{long}": {{}}, {materials}}}}}"#);
    folder.write("a.selflink.json", text);
    let room = scene(&room);
    assert!(room.group_tree().addresses().iter().all(|address| address.len() < 1100));
    assert!(room.skipped.further_notes > 39_000, "{}", room.skipped.further_notes);
    assert!(serde_json::to_vec(&Sidecar::of(&room)).is_ok());
}

/// Positions chosen so that a hash without a secret puts all into one slot: 10¹⁰ comparisons.
#[test]
fn positions_that_hash_alike() {
    // The two halves of the constant that rustc-hash begins with: their product with whatever
    // follows is zero.
    let (x, y) = (f32::from_bits(0x85a3_08d3), f32::from_bits(0x243f_6a88));
    let mut text = String::new();
    for number in 0..150_000_u32 {
        let z = f32::from_bits(1_f32.to_bits() + 32 * number);
        let _ = writeln!(text, "v {x:e} {y:e} {z}");
    }
    text.push_str("v 1 0 0\n");
    for number in 1..150_000 {
        let _ = writeln!(text, "f {number} {} 150001", number + 1);
    }
    assert_eq!(scene(&Folder::new().write("a.obj", text)).polygons.len(), 149_999);
}

/// An arc bent inwards blocks every ear but its ends: n² comparisons for n corners, again for each
/// of many faces. (A hundred such faces would take the effort that a scene may cost; a unit test
/// shows that it ends there.)
#[test]
fn outlines_that_are_slow_to_cut() {
    let mut text = String::from("v 0 0 0\n");
    for step in 0..4094 {
        let angle = step as f32 / 4096.0 * 1.5;
        let _ = writeln!(text, "v {} {} 0", 10.0 - 9.0 * angle.cos(), 10.0 - 9.0 * angle.sin());
    }
    for face in 0..5 {
        text.push('f');
        for corner in (0..4095).filter(|corner| *corner != 100 + face) {
            let _ = write!(text, " {}", corner + 1);
        }
        text.push('\n');
    }
    let room = scene(&Folder::new().write("a.obj", text));
    assert_eq!((room.skipped.triangulated_polygons, room.polygons.len()), (5, 5 * 4092));
}

/// One material file under many names, and many that are not there: 10¹⁰ comparisons of names.
#[test]
fn material_files_without_end() {
    let folder = Folder::new();
    folder.write("a.mtl", "newmtl m\nKd 0.1 0.1 0.1\n".repeat(40_000));
    let spellings: String = (0..1000).map(|dots| format!("mtllib {}a.mtl\n", "./".repeat(dots))).collect();
    let room = scene(&folder.write("a.obj", format!("{spellings}mtllib a.obj\n{SQUARE}")));
    assert!(room.materials[0].reflectance.abs_diff_eq(glam::Vec3::splat(0.1), 1e-6));
    let missing: String = (0..100_000).map(|number| format!("mtllib {number}.mtl\n")).collect();
    let room = scene(&folder.write("b.obj", missing + SQUARE));
    assert_eq!(room.skipped.notes.len(), 50);
    assert!(room.skipped.further_notes > 900);
}

#[test]
fn lines_without_end() {
    let folder = Folder::new();
    let long = "x".repeat(4 << 20);
    let said = sentence(&folder.write("a.obj", format!("v 0 0 {long}\n")));
    assert!(said.contains("line 1") && said.ends_with("…` is not a coordinate"), "{said}");
    let room = scene(&folder.write("b.obj", format!("{SQUARE}usemtl {long}\nmtllib {long}\nf 3 2 1\n{long}")));
    assert!(room.materials.iter().all(|material| material.name.chars().count() <= 200));
    let joined = format!("{}1 2 3\n", "\\\n".repeat(400_000));
    assert_eq!(scene(&folder.write("c.obj", format!("{SQUARE}f {joined}"))).polygons.len(), 2);
    let answer = ends("words", move || selflink::scene::load_file(&folder.write("d.txt", long)).map(|_| ()));
    assert!(answer.is_err());
}
