//! glTF and GLB: nodes, materials, lights and buffers.

use std::f32::consts::PI;

use glam::Vec3;
use selflink::scene::load_file;

use crate::support::{Folder, square_bytes, square_json};
use crate::{close, load_square_glb, total_area};

#[test]
fn gltf_nodes_are_groups_and_instances_are_copies() {
    let scene = load_square_glb(
        r#""scenes": [{"nodes": [0]}],
        "nodes": [{"name": "room", "children": [1, 2], "translation": [10, 0, 0]},
                  {"mesh": 0, "scale": [2, 3, 1]},
                  {"name": "mirrored", "mesh": 0, "scale": [-1, 1, 1], "children": [3]},
                  {"name": "turned", "mesh": 0, "rotation": [0, 0.70710678, 0, 0.70710678]}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1, "material": 0}]}],
        "materials": [{"name": "paint", "doubleSided": true, "pbrMetallicRoughness": {"baseColorFactor": [1, 0.5, 0.25, 1]}}]"#,
    );
    let paths: Vec<String> = scene.polygons.iter().map(|polygon| scene.group_path(polygon.group)).collect();
    let expected = ["room/node_1", "room/mirrored", "room/mirrored/turned"];
    assert_eq!(paths, expected.map(|path| [path; 2]).concat());
    assert!((total_area(&scene) - (6.0 + 1.0 + 1.0)).abs() < 1e-5);
    let normals: Vec<Vec3> = scene.polygons.iter().map(|polygon| scene.normal(polygon)).collect();
    assert!(close(normals[0], Vec3::Z) && close(normals[2], Vec3::Z), "a mirrored square still faces +z");
    assert!(close(normals[4], -Vec3::X), "turned to +x, then mirrored: {}", normals[4]);
    assert_eq!(scene.bounds().1.x, 12.0);
    assert_eq!(scene.materials[0].reflectance, Vec3::new(0.95, 0.5, 0.25));
    assert_eq!(scene.skipped.clamped_materials, 1);
    assert_eq!(scene.vertices.len(), 3 * 4 - 2 - 1, "the last two squares share an edge, all three a corner");
}

/// Truth: B_e = π · emissiveFactor · strength; panes and lights that are no surfaces are counted.
#[test]
fn gltf_materials_and_lights() {
    let primitive = |material: usize| {
        format!(r#"{{"primitives": [{{"attributes": {{"POSITION": 0}}, "indices": 1, "material": {material}}}]}}"#)
    };
    let meshes = [0, 1, 2].map(primitive).join(", ");
    let scene = load_square_glb(&format!(
        r#""extensionsUsed": ["KHR_lights_punctual"],
        "extensions": {{"KHR_lights_punctual": {{"lights": [{{"type": "point", "name": "Lamp"}}, {{"type": "directional"}}]}}}},
        "scenes": [{{"nodes": [0, 1, 2, 3, 4]}}],
        "nodes": [{{"mesh": 0}}, {{"mesh": 1, "translation": [0, 0, 1]}}, {{"mesh": 2, "translation": [0, 0, 2]}},
                  {{"extensions": {{"KHR_lights_punctual": {{"light": 0}}}}}},
                  {{"name": "Moon", "extensions": {{"KHR_lights_punctual": {{"light": 1}}}}}}],
        "meshes": [{meshes}, {{"primitives": [{{"attributes": {{"POSITION": 0}}, "indices": 1}}]}}],
        "materials": [
            {{"emissiveFactor": [1, 0.5, 0], "extensions": {{"KHR_materials_emissive_strength": {{"emissiveStrength": 20}}}}}},
            {{"name": "pane", "alphaMode": "BLEND", "pbrMetallicRoughness": {{"baseColorFactor": [1, 1, 1, 0.2]}}}},
            {{"name": "glass", "extensions": {{"KHR_materials_transmission": {{"transmissionFactor": 1}}}}}}]"#
    ));
    assert_eq!(scene.materials[0].name, "material_0");
    assert!(close(scene.materials[0].emission, 20.0 * PI * Vec3::new(1.0, 0.5, 0.0)));
    assert_eq!((scene.skipped.transparent_faces, scene.skipped.ignored_lights), (4, 1));
    assert!(
        scene
            .skipped
            .notes
            .join(" ")
            .contains("Directional lights are left out, for they shine from below or not at all: Moon"),
        "{:?}",
        scene.skipped.notes
    );
    assert_eq!(scene.lights.iter().map(|light| light.name.as_str()).collect::<Vec<_>>(), ["Lamp"]);
}

#[test]
fn a_gltf_file_reads_buffers_beside_it_or_embedded() {
    let folder = Folder::new();
    folder.write("the data.bin", square_bytes());
    let rest = r#""scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}], "meshes": [{"primitives": [
        {"attributes": {"POSITION": 0}, "indices": 1, "mode": 6}, {"attributes": {"POSITION": 0}, "mode": 0}]}]"#;
    let beside = square_json(rest).replace(r#""byteLength": 60"#, r#""byteLength": 60, "uri": "the%20data.bin""#);
    let scene = load_file(&folder.write("a.gltf", beside)).expect("a sound scene");
    assert_eq!(scene.materials[0].reflectance, Vec3::splat(0.5));
    assert_eq!(scene.skipped.faces_without_material, scene.polygons.len());
    assert_eq!(scene.skipped.lines_and_points, 1);

    let triangle = "AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA";
    let embedded = format!(
        r#"{{"asset": {{"version": "2.0"}}, "nodes": [{{"mesh": 0}}],
        "buffers": [{{"byteLength": 36, "uri": "data:application/octet-stream;base64,{triangle}"}}],
        "bufferViews": [{{"buffer": 0, "byteLength": 36}}],
        "accessors": [{{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 0]}}],
        "meshes": [{{"primitives": [{{"attributes": {{"POSITION": 0}}}}]}}]}}"#
    );
    let scene = load_file(&folder.write("b.gltf", embedded)).expect("a sound scene");
    assert!((total_area(&scene) - 0.5).abs() < 1e-6);
}
