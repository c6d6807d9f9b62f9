//! What exporters make of a file: comments, instances, skins, curves, compression.

use std::f32::consts::PI;

use glam::Vec3;
use meshoptimizer_rs::Workspace;
use meshoptimizer_rs::codec::{VertexEncoding, encode_vertex_buffer};
use selflink::scene::load_file;

use crate::support::{Folder, glb, square_bytes, square_json};
use crate::{CUBE, GLOW, assert_furnace, load, load_obj, notes};

#[test]
fn comments_that_end_in_a_backslash() {
    let mtl = format!("newmtl glow\nKd 0.5 0.5 0.5\n{GLOW}");
    for comment in ["# exported to D:\\work\\", "# head\\", "usemtl glow\n# scene\\room\\"] {
        let scene = load_obj(&format!("{comment}\nmtllib a.mtl\nusemtl glow\n{CUBE}"), &mtl);
        assert_furnace(&scene, comment);
        let scene = load_obj(&format!("mtllib a.mtl\nusemtl glow\n{comment}\n{CUBE}"), &mtl);
        assert_furnace(&scene, comment);
    }
    // Data goes on all the same.
    let joined = CUBE.replace("v 0 0 0\n", "v 0 \\\n0 0\n").replace("f 1 2 3 4\n", "f 1 2 \\\n3 4 # here \\\n");
    assert_furnace(&load_obj(&format!("mtllib a.mtl\nusemtl glow\n{joined}"), &mtl), "joined");
}

/// Truth: one square, three places.
#[test]
fn gpu_instances_are_copies() {
    let mut binary = square_bytes();
    for (x, y, z) in [(0.0_f32, 0.0_f32, 0.0_f32), (2.0, 0.0, 0.0), (0.0, 5.0, 0.0)] {
        binary.extend([x, y, z].iter().flat_map(|value| value.to_le_bytes()));
    }
    let json = square_json(
        r#""extensionsUsed": ["EXT_mesh_gpu_instancing"], "scenes": [{"nodes": [0]}],
        "nodes": [{"name": "chair", "mesh": 0, "extensions": {"EXT_mesh_gpu_instancing": {"attributes": {"TRANSLATION": 2}}}}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}]"#,
    );
    let json = json.replace(r#"{"byteLength": 60}"#, r#"{"byteLength": 96}"#);
    let json = json.replace(
        r#""byteOffset": 48, "byteLength": 12}"#,
        r#""byteOffset": 48, "byteLength": 12}, {"buffer": 0, "byteOffset": 60, "byteLength": 36}"#,
    );
    let json = json.replace(
        r#""type": "SCALAR"}"#,
        r#""type": "SCALAR"}, {"bufferView": 2, "componentType": 5126, "count": 3, "type": "VEC3"}"#,
    );
    let scene = load(&[("a.glb", &glb(&json, &binary))], "a.glb");
    assert_eq!((scene.polygons.len(), scene.bounds()), (6, (Vec3::ZERO, Vec3::new(3.0, 6.0, 0.0))));
    assert_eq!(scene.group_path(scene.polygons[5].group), "chair/3");
}

#[test]
fn structure_that_exporters_write() {
    // A BOM, a name with a percent sign, several scenes, animations.
    let folder = Folder::new();
    folder.write("50%.bin", square_bytes());
    let json = square_json(
        r#""scenes": [{"name": "shown", "nodes": [0]}, {"nodes": []}], "nodes": [{"mesh": 0}],
        "meshes": [{"weights": [0.5], "primitives": [{"attributes": {"POSITION": 0}, "indices": 1, "targets": [{"POSITION": 0}]}]}]"#,
    );
    let json = json.replace(r#""byteLength": 60"#, r#""byteLength": 60, "uri": "50%.bin""#);
    let scene = load_file(&folder.write("a.gltf", format!("\u{feff}{json}"))).expect("a sound scene");
    assert_eq!(scene.bounds().1, Vec3::new(1.5, 1.5, 0.0), "half of the morph target is added");
    assert!(notes(&scene).contains("Of 2 scenes in the file `shown` is shown"), "{}", notes(&scene));

    // Names in Latin-1 that differ in one byte; several material files; the first of two materials
    // of one name.
    let obj = [
        b"mtllib my room.mtl b.mtl\nusemtl a\xe4\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3\nusemtl a\xf6\nf 1 3 4\n"
            .as_slice(),
        b"v nan 0 0\n",
    ]
    .concat();
    let first = b"newmtl a\xe4\nKd 0.1 0.1 0.1\n".as_slice();
    let second = b"newmtl a\xf6\nKd 0.2 0.2 0.2\nnewmtl a\xe4\nKd 0.9 0.9 0.9\n".as_slice();
    let scene = load(&[("a.obj", &obj), ("my room.mtl", first), ("b.mtl", second)], "a.obj");
    let colours: Vec<f32> = scene.polygons.iter().map(|polygon| scene.surface(polygon).reflectance.x).collect();
    assert_eq!(colours, [0.1, 0.2]);
    assert!(notes(&scene).contains("defined twice"), "{}", notes(&scene));

    // A polygon of some thousand corners.
    let mut outline = String::new();
    for step in 0..6000 {
        let angle = step as f32 / 6000.0 * std::f32::consts::TAU;
        outline += &format!("v {} {} 0\n", angle.cos(), angle.sin());
    }
    outline += "f";
    (1..=6000).for_each(|corner| outline += &format!(" {corner}"));
    let scene = load_obj(&outline, "");
    let area: f32 = scene.polygons.iter().map(|polygon| scene.area(polygon)).sum();
    assert!((area - PI).abs() < 1e-3, "{area}");
}

#[test]
fn free_form_surfaces_are_said_once() {
    let obj = format!("{CUBE}cstype bspline\ndeg 1 1\nsurf 0 1 0 1 1 2 4 3\nparm u 0 0 1 1\nparm v 0 0 1 1\nend\n");
    let scene = load_obj(&obj, "");
    assert_eq!(scene.skipped.curves_and_surfaces, 1);
    assert!(notes(&scene).contains("1 curve or curved surface left out"), "{}", notes(&scene));
}

/// The square of [`square_bytes`] with its positions compressed by meshopt, or all of it by Draco.
fn compressed(by_draco: bool) -> Vec<u8> {
    let square = square_bytes();
    let (data, view, primitive) = if by_draco {
        let mut mesh = draco_core::Mesh::new();
        mesh.set_num_points(4);
        let mut positions = draco_core::PointAttribute::new();
        let kind = draco_core::GeometryAttributeType::Position;
        positions.init(kind, 3, draco_core::DataType::Float32, false, 4);
        positions.buffer_mut().write(0, &square[..48]);
        mesh.add_attribute(positions);
        mesh.set_num_faces(2);
        mesh.set_faces_from_flat_indices(&[0, 1, 2, 0, 2, 3]);
        let mut encoder = draco_core::MeshEncoder::new();
        encoder.set_mesh(mesh);
        let mut buffer = draco_core::EncoderBuffer::new();
        encoder.encode(&draco_core::EncoderOptions::new(), &mut buffer).expect("a square can be encoded");
        let primitive =
            r#", "extensions": {"KHR_draco_mesh_compression": {"bufferView": 2, "attributes": {"POSITION": 0}}}"#;
        (buffer.data().to_vec(), String::new(), primitive)
    } else {
        let data = encode_vertex_buffer(
            &square[..48],
            4,
            12,
            VertexEncoding::new(0, 0).expect("version 0"),
            &mut Workspace::default(),
        );
        let data = data.expect("a square can be encoded");
        let view = format!(
            r#", "extensions": {{"EXT_meshopt_compression": {{"buffer": 0, "byteOffset": 60, "byteLength": {}, "byteStride": 12, "count": 4, "mode": "ATTRIBUTES"}}}}"#,
            data.len()
        );
        (data, view, "")
    };
    let rest = format!(
        r#""scenes": [{{"nodes": [0]}}], "nodes": [{{"mesh": 0}}],
        "meshes": [{{"primitives": [{{"attributes": {{"POSITION": 0}}, "indices": 1{primitive}}}]}}]"#
    );
    // Nothing but what is compressed is there.
    let mut binary = square;
    binary[..48].fill(255);
    binary.extend(&data);
    let json = square_json(&rest).replace(r#""byteLength": 60"#, &format!(r#""byteLength": {}"#, binary.len()));
    let json = json.replace(r#""byteLength": 48}"#, &format!(r#""byteLength": 48{view}}}"#));
    let last = format!(
        r#""byteOffset": 48, "byteLength": 12}}, {{"buffer": 0, "byteOffset": 60, "byteLength": {}}}"#,
        data.len()
    );
    glb(&json.replace(r#""byteOffset": 48, "byteLength": 12}"#, &last), &binary)
}

/// Truth: what was encoded, a unit square; Draco keeps 11 bits of a coordinate by default.
#[test]
fn compressed_geometry_is_read() {
    for by_draco in [false, true] {
        let scene = load(&[("a.glb", &compressed(by_draco))], "a.glb");
        let area: f32 = scene.polygons.iter().map(|polygon| scene.area(polygon)).sum();
        assert!((area - 1.0).abs() < 2e-3 && scene.polygons.len() == 2, "Draco {by_draco}: {area}");
        assert!(scene.polygons.iter().all(|polygon| scene.normal(polygon).z > 0.999), "Draco {by_draco}");
    }
}
