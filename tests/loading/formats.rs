//! PLY and STL: one material, as text and binary, as scanners, modellers and CAD programs write
//! them.

use glam::Vec3;
use selflink::scene::{Scene, Unit, load_file};

use crate::support::Folder;
use crate::{load, notes};

/// Corners of a room of 5 × 4 × 3 m with z up, and its quads, seen from inside.
const CORNERS: [[f32; 3]; 8] =
    [[0., 0., 0.], [5., 0., 0.], [5., 4., 0.], [0., 4., 0.], [0., 0., 3.], [5., 0., 3.], [5., 4., 3.], [0., 4., 3.]];
const QUADS: [[u8; 4]; 6] = [[0, 1, 2, 3], [5, 4, 7, 6], [4, 0, 3, 7], [1, 5, 6, 2], [4, 5, 1, 0], [3, 2, 6, 7]];

fn triangles() -> impl Iterator<Item = [[f32; 3]; 3]> {
    let halves = |[a, b, c, d]: [u8; 4]| [[a, b, c], [a, c, d]];
    QUADS.into_iter().flat_map(halves).map(|corners| corners.map(|corner| CORNERS[usize::from(corner)]))
}

fn binary_stl(head: &str) -> Vec<u8> {
    let mut bytes = format!("{head:80}").into_bytes();
    bytes.extend(12_u32.to_le_bytes());
    for corners in triangles() {
        let numbers = [[0.0; 3]].into_iter().chain(corners).flatten();
        bytes.extend(numbers.flat_map(f32::to_le_bytes).chain([0, 0]));
    }
    bytes
}

fn text_stl(names: [&str; 2], scale: f32) -> String {
    let mut text = String::new();
    for (index, [a, b, c]) in triangles().enumerate() {
        if index % 6 == 0 {
            text += &format!("solid {}\n", names[index / 6]);
        }
        let vertex = |corner: [f32; 3]| corner.map(|value| (scale * value).to_string()).join(" ");
        let [a, b, c] = [a, b, c].map(vertex);
        text += &format!("  facet normal 0 0 0\n    outer loop\n      vertex {a}\n      vertex {b}\n");
        text += &format!("      vertex {c}\n    endloop\n  endfacet\n");
        if index % 6 == 5 {
            text += "endsolid\n";
        }
    }
    text
}

/// Truth: floor and ceiling 40 m², walls 54 m²; all of it seen from inside, in the grey of what has
/// no material.
fn assert_room(scene: &Scene, what: &str) {
    let area: f32 = scene.polygons.iter().map(|polygon| scene.area(polygon)).sum();
    assert!((area - 94.0).abs() < 1e-4, "{what}: {area} m²");
    for polygon in &scene.polygons {
        let (corners, count) = scene.corner_positions(polygon);
        let middle = corners[..count].iter().sum::<Vec3>() / count as f32;
        assert!(scene.normal(polygon).dot(Vec3::new(2.5, 2.0, 1.5) - middle) > 0.0, "{what}: {polygon:?}");
    }
    assert_eq!(scene.surface(&scene.polygons[0]).reflectance, Vec3::splat(0.5), "{what}");
    assert!(notes(scene).contains("without a material shown grey"), "{what}: {}", notes(scene));
}

/// Binary files may begin with `solid`, and text files with a solid that has no name, or hold
/// several.
#[test]
fn stl_as_text_and_binary() {
    for head in ["", "solid made by a CAD program", "exported in colour"] {
        assert_room(&load(&[("a.stl", &binary_stl(head))], "a.stl"), head);
    }
    let mut ends_with_a_line_break = binary_stl("");
    ends_with_a_line_break.extend(b"\r\n");
    assert_room(&load(&[("a.stl", &ends_with_a_line_break)], "a.stl"), "a line break");
    for names in [["walls", "floor, left"], ["", ""]] {
        let text = text_stl(names, 1.0);
        let scene = load(&[("a.stl", text.as_bytes())], "a.stl");
        assert_room(&scene, names[0]);
        let groups: Vec<&str> = scene.groups.iter().skip(1).map(|group| group.name.as_str()).collect();
        assert_eq!(groups, names.into_iter().filter(|name| !name.is_empty()).collect::<Vec<_>>());
        let loud = text.to_uppercase().replace('\n', "\r\n");
        assert_room(&load(&[("A.STL", loud.as_bytes())], "A.STL"), "capitals");
    }
}

#[test]
fn stl_in_millimetres_with_colours_and_wrong_normals() {
    let scene = load(&[("a.stl", text_stl(["a", "b"], 1000.0).as_bytes())], "a.stl");
    assert_eq!(scene.frame.unit, Unit::Millimetre);
    assert_room(&scene, "millimetres");
    let mut bytes = binary_stl("");
    // The first facet's normal points down through the floor, and it has a colour.
    bytes[84 + 8..84 + 12].copy_from_slice(&(-1.0_f32).to_le_bytes());
    bytes[84 + 48] = 31;
    let scene = load(&[("a.stl", &bytes)], "a.stl");
    assert_room(&scene, "the order of corners counts");
    assert!(notes(&scene).contains("against their facet's corners: 1;"), "{}", notes(&scene));
    assert!(notes(&scene).contains("Colours of facets are not read (1 "), "{}", notes(&scene));
}

fn ply_head(format: &str, of_vertices: &str) -> String {
    format!(
        "ply\nformat {format} 1.0\ncomment made for a test\nelement vertex 8\nproperty float x\nproperty float y\n\
        property double z\n{of_vertices}element face 6\nproperty list uchar int vertex_indices\nproperty uchar flags\n\
        element edge 1\nproperty int vertex1\nproperty int vertex2\nend_header\n"
    )
}

fn binary_ply(big: bool) -> Vec<u8> {
    let order = if big { "binary_big_endian" } else { "binary_little_endian" };
    let mut bytes = ply_head(order, "").into_bytes();
    let mut add = |little: &[u8]| {
        let mut value = little.to_vec();
        if big {
            value.reverse();
        }
        bytes.extend(value);
    };
    for [x, y, z] in CORNERS {
        add(&x.to_le_bytes());
        add(&y.to_le_bytes());
        add(&f64::from(z).to_le_bytes());
    }
    for quad in QUADS {
        add(&[4]);
        quad.iter().for_each(|&corner| add(&i32::from(corner).to_le_bytes()));
        add(&[9]);
    }
    add(&0_i32.to_le_bytes());
    add(&1_i32.to_le_bytes());
    bytes
}

fn text_ply(of_vertices: &str, values: &str) -> String {
    let mut text = ply_head("ascii", of_vertices);
    for [x, y, z] in CORNERS {
        text += &format!("{x} {y} {z}{values}\n");
    }
    for [a, b, c, d] in QUADS {
        text += &format!("4 {a} {b} {c} {d} 9\n");
    }
    text + "0 1\n"
}

#[test]
fn ply_as_text_and_binary() {
    let text = text_ply("", "");
    let crlf = text.replace('\n', "\r\n");
    let all = [text.into_bytes(), crlf.into_bytes(), binary_ply(false), binary_ply(true)];
    for (number, bytes) in all.iter().enumerate() {
        let scene = load(&[("a.ply", bytes)], "a.ply");
        assert_room(&scene, &format!("number {number}"));
        assert_eq!((scene.polygons.len(), scene.skipped.lines_and_points), (6, 1));
    }
}

/// Truth: step 188 of sRGB is 0.5029; whole numbers of 8 bits are such steps, others linear.
#[test]
fn ply_with_colours_and_a_texture() {
    let colours = |kind: &str| ["red", "green", "blue"].map(|name| format!("property {kind} {name}\n")).concat();
    let steps = text_ply(&colours("uchar"), " 188 188 0");
    let scene = load(&[("a.ply", steps.as_bytes())], "a.ply");
    for polygon in &scene.polygons {
        assert!(scene.surface(polygon).reflectance.distance(Vec3::new(0.5029, 0.5029, 0.0)) < 1e-4);
    }
    let linear = text_ply(&colours("float"), " 0.25 0.5 0");
    let textured = linear.replace("comment made for a test", "comment TextureFile walls.png");
    let scene = load(&[("a.ply", textured.as_bytes())], "a.ply");
    assert!(scene.surface(&scene.polygons[0]).reflectance.distance(Vec3::new(0.25, 0.5, 0.0)) < 1e-4);
    assert!(notes(&scene).contains("The texture `walls.png` is not read"), "{}", notes(&scene));
}

#[test]
fn bad_ply_and_stl_files() {
    let ply = text_ply("", "");
    let stl = text_stl(["a", "b"], 1.0);
    let cut = |bytes: Vec<u8>| bytes[..bytes.len() - 5].to_vec();
    let cases: Vec<(&str, Vec<u8>, &str)> = vec![
        ("head.ply", b"ply\nformat ascii 1.0\n".to_vec(), "missing 'end_header'"),
        ("kind.ply", ply.replace("ascii", "gzip").into_bytes(), "not understood"),
        ("many.ply", ply.replace("face 6", "face 900000000").into_bytes(), "more than the"),
        ("more.ply", ply.replace("vertex 8", "vertex 90000000").into_bytes(), "cut off"),
        ("nothing.ply", ply.replace("edge 1", "edge 99999999999").into_bytes(), "more than the"),
        (
            "past.ply",
            ply.replace("4 0 1 2 3", "4 0 1 2 8").into_bytes(),
            "face 1: a face refers to vertex 8, but there are 8",
        ),
        ("negative.ply", ply.replace("4 0 1 2 3", "4 0 1 2 -3").into_bytes(), "face 1: a face refers to vertex -1"),
        ("short.ply", ply.replace("4 0 1 2 3 9", "4 0 1").into_bytes(), "not understood"),
        ("letters.ply", ply.replace("5 0 0", "5 x 0").into_bytes(), "not understood"),
        ("far.ply", ply.replace("5 0 0", "5e30 0 0").into_bytes(), "vertex 2 has a coordinate"),
        ("cut.ply", cut(binary_ply(false)), "cut off"),
        (
            "points.ply",
            ply.replace("face 6", "face 0").replace("edge 1", "edge 0").into_bytes(),
            "8 points and no faces",
        ),
        ("list.ply", ply.replace("uchar int", "uchar float").into_bytes(), "not understood"),
        ("cut.stl", cut(binary_stl("")), "tells of 12 triangles but there are 11"),
        ("empty.stl", b"solid\nendsolid\n".to_vec(), "no polygons"),
        ("short.stl", vec![1; 50], "cut off"),
        ("half.stl", stl.trim_end_matches("  endfacet\nendsolid\n").into(), "at its end"),
        ("word.stl", stl.replacen("outer", "inner", 1).into_bytes(), "line 3: `inner loop` is not a line"),
        ("two.stl", stl.replacen("vertex 5 0 0\n", "", 1).into_bytes(), "line 6: a facet has 2 corners"),
        ("nan.stl", stl.replacen("vertex 5 0 0", "vertex NaN 0 0", 1).into_bytes(), "corner 2 has a coordinate"),
        ("number.stl", stl.replacen("vertex 5 0 0", "vertex 5 0", 1).into_bytes(), "is no vertex x y z"),
    ];
    let folder = Folder::new();
    for (name, bytes, part) in cases {
        let said = load_file(&folder.write(name, bytes)).expect_err(name).to_string();
        assert!(said.contains(part) && !said.contains(['\n', '\t']), "{name}: `{part}` is not in: {said}");
    }
}
