//! Vertices as glTF files hold them: skins, morphs, colours, quantised numbers, instances, sides.

use glam::Vec3;
use selflink::scene::{Scene, load_file};

use crate::builder::{Gltf, I8, I16, U8, U16, one_mesh};
use crate::support::Folder;
use crate::{load, notes};

fn load_glb(file: &[u8]) -> Scene {
    load(&[("a.glb", file)], "a.glb")
}

fn bytes_of_i16(values: &[i16]) -> Vec<u8> {
    values.iter().flat_map(|value| value.to_le_bytes()).collect()
}

/// Truth: joint matrices by hand. The second joint stands at z = 3 and was at z = 1 when the skin
/// was made: its vertices move by 2; half of each moves by half. The node of the mesh does not
/// count (glTF 2.0, section 3.7.3.3).
#[test]
fn skins_are_shown_at_rest() {
    let mut file = Gltf::square();
    let joints = file.accessor(&[0, 1, 0, 0].repeat(4), U8, 4, "VEC4", "");
    let shares = [[1.0, 0.0, 0.0, 0.0], [1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.5, 0.5, 0.0, 0.0]];
    let shares = file.floats::<4>(&shares);
    let mut inverse = [[0.0; 16]; 2];
    for matrix in &mut inverse {
        for place in [0, 5, 10, 15] {
            matrix[place] = 1.0;
        }
    }
    inverse[1][14] = -1.0;
    let inverse = file.floats::<16>(&inverse);
    let scene = load_glb(&file.file(&format!(
        r#""meshes": [{{"primitives": [{{"attributes": {{"POSITION": 0, "JOINTS_0": {joints}, "WEIGHTS_0": {shares}}}, "indices": 1}}]}}],
        "skins": [{{"joints": [1, 2], "inverseBindMatrices": {inverse}}}],
        "nodes": [{{"mesh": 0, "skin": 0, "translation": [50, 0, 0]}}, {{}}, {{"translation": [0, 0, 3]}}],
        "scenes": [{{"nodes": [0, 1, 2]}}]"#
    )));
    let mut found: Vec<Vec3> = scene.vertices.clone();
    found.sort_by(|a, b| a.z.total_cmp(&b.z).then(a.x.total_cmp(&b.x)));
    assert_eq!(found, [Vec3::ZERO, Vec3::X, Vec3::new(0.0, 1.0, 1.0), Vec3::new(1.0, 1.0, 2.0)]);
}

/// Truth: a node's weights count more than its mesh's, 0.
#[test]
fn weights_of_a_node_count() {
    let mut file = Gltf::square();
    let moves = file.floats::<3>(&[[0.0, 0.0, 4.0]; 4]);
    let scene = load_glb(&file.file(&format!(
        r#""meshes": [{{"weights": [0], "primitives": [{{"attributes": {{"POSITION": 0}}, "indices": 1, "targets": [{{"POSITION": {moves}}}]}}]}}],
        "nodes": [{{"mesh": 0}}, {{"mesh": 0, "weights": [0.25], "translation": [2, 0, 0]}}], "scenes": [{{"nodes": [0, 1]}}]"#
    )));
    assert_eq!(scene.bounds(), (Vec3::ZERO, Vec3::new(3.0, 1.0, 1.0)));
    assert!(scene.vertices.iter().all(|vertex| (vertex.z == 1.0) == (vertex.x >= 2.0)), "{:?}", scene.vertices);
}

/// Truth: the colours are linear and multiply the factor; alpha counts in BLEND, in MASK before the
/// cutoff, and not in OPAQUE (glTF 2.0, sections 3.7.2.1 and 3.9.4).
#[test]
fn colours_of_vertices_and_their_alpha() {
    let blend = |mode: &str, alpha: f32, texture: bool| {
        let mut file = Gltf::square();
        let colours = file.floats::<4>(&[[0.5, 0.25, 1.0, alpha]; 4]);
        let view = file.view(&crate::picture([1, 1], image::ImageFormat::Png, |_, _| [255; 4]));
        let map = if texture { r#", "baseColorTexture": {"index": 0}"# } else { "" };
        let material = format!(
            r#", "alphaMode": "{mode}", "pbrMetallicRoughness": {{"baseColorFactor": [0.5, 0.5, 0.5, 0.8]{map}}}"#
        );
        let image = format!(
            r#", "images": [{{"bufferView": {view}, "mimeType": "image/png"}}], "textures": [{{"source": 0}}]"#
        );
        let rest = one_mesh(&format!(r#", "COLOR_0": {colours}"#), &material, &image);
        // Beside it a face that stays whatever the other's alpha.
        let beside = r#""material": 0}, {"attributes": {"POSITION": 0}, "indices": 1, "mode": 5}]"#;
        load_glb(&file.file(&rest.replacen(r#""material": 0}]"#, beside, 1)))
    };
    let opaque = blend("OPAQUE", 0.1, false);
    let reflectance = opaque.surface(&opaque.polygons[0]).reflectance;
    assert!(reflectance.distance(Vec3::new(0.25, 0.125, 0.5)) < 1e-4, "{reflectance}");
    for texture in [false, true] {
        let left_out = |mode, alpha| blend(mode, alpha, texture).skipped.transparent_faces;
        assert_eq!([left_out("OPAQUE", 0.1), left_out("BLEND", 0.7), left_out("BLEND", 0.6)], [0, 0, 2], "{texture}");
        // 0.8 × 0.65 is above the cutoff of ½; above it a mask is whole.
        assert_eq!([left_out("MASK", 0.65), left_out("MASK", 0.6)], [0, 2], "{texture}");
        let whole = blend("MASK", 0.65, texture);
        assert!(whole.surface(&whole.polygons[0]).reflectance.distance(Vec3::new(0.25, 0.125, 0.5)) < 1e-4);
    }

    let mut file = Gltf::square();
    let colours = file.accessor(&[255, 0, 51].repeat(4), U8, 4, "VEC3", r#", "normalized": true"#);
    let scene = load_glb(&file.file(&one_mesh(&format!(r#", "COLOR_0": {colours}"#), "", "")));
    let reflectance = scene.surface(&scene.polygons[0]).reflectance;
    assert!(reflectance.distance(Vec3::new(0.95, 0.0, 0.2)) < 1e-4, "RGB of 8 bits: {reflectance}");
}

/// Truth: a normalised 16-bit integer is a 32,767th, an unsigned one a 65,535th, and plain ones are
/// what they are (KHR_mesh_quantization); texture coordinates of 8 bits pick one of two texels.
#[test]
fn quantised_numbers_are_read() {
    let square = |largest: i16| -> Vec<i16> {
        [[0, 0], [1, 0], [1, 1], [0, 1]].into_iter().flat_map(|[x, y]| [x * largest, y * largest, 0]).collect()
    };
    for (largest, component, normalized, scale, side) in [
        (i16::MAX, I16, true, 3.0, 3.0),
        (-1, U16, true, 2.0, 2.0),
        (500, U16, false, 0.01, 5.0),
        (500, I16, false, 0.01, 5.0),
    ] {
        let mut file = Gltf::square();
        let more = format!(r#", "normalized": {normalized}"#);
        let positions = file.accessor(&bytes_of_i16(&square(largest)), component, 4, "VEC3", &more);
        let scene = load_glb(&file.file(&format!(
            r#""extensionsUsed": ["KHR_mesh_quantization"], "extensionsRequired": ["KHR_mesh_quantization"],
            "meshes": [{{"primitives": [{{"attributes": {{"POSITION": {positions}}}, "indices": 1}}]}}],
            "nodes": [{{"mesh": 0, "scale": [{scale}, {scale}, {scale}]}}], "scenes": [{{"nodes": [0]}}]"#
        )));
        let area: f32 = scene.polygons.iter().map(|polygon| scene.area(polygon)).sum();
        assert!((area.sqrt() / side - 1.0).abs() < 1e-5, "{component}, {normalized}: {area} m²");
        assert!(!notes(&scene).contains("not read"), "{}", notes(&scene));
    }

    let mut file = Gltf::square();
    let uvs = file.accessor(&[64, 127].repeat(4), I8, 4, "VEC2", r#", "normalized": true"#);
    let normals = file.accessor(&[0, 0, 127].repeat(4), I8, 4, "VEC3", r#", "normalized": true"#);
    let png = crate::picture([2, 1], image::ImageFormat::Png, |x, _| [[255, 0, 0, 255], [0, 0, 255, 255]][x as usize]);
    let view = file.view(&png);
    let scene = load_glb(&file.file(&one_mesh(
        &format!(r#", "TEXCOORD_0": {uvs}, "NORMAL": {normals}"#),
        r#", "pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}"#,
        &format!(r#", "images": [{{"bufferView": {view}, "mimeType": "image/png"}}], "textures": [{{"source": 0}}]"#),
    )));
    // 64 of 127 is just behind the middle.
    assert!(scene.surface(&scene.polygons[0]).reflectance.distance(Vec3::new(0.0, 0.0, 0.95)) < 1e-4);
    assert!(scene.smooth_normal(&scene.polygons[0], Vec3::new(0.5, 0.2, 0.0)).distance(Vec3::Z) < 1e-4);
}

/// Truth: by hand. One instance is turned by 90° about z and twice as large, the other is as it is,
/// two metres aside.
#[test]
fn gpu_instances_are_turned_and_scaled() {
    let mut file = Gltf::square();
    let translation = file.floats::<3>(&[[0.0, 0.0, 0.0], [2.0, 0.0, 0.0]]);
    let half = 0.5_f32.sqrt();
    let rotation = file.floats::<4>(&[[0.0, 0.0, half, half], [0.0, 0.0, 0.0, 1.0]]);
    let scale = file.floats::<3>(&[[2.0, 2.0, 2.0], [1.0, 1.0, 1.0]]);
    let scene = load_glb(&file.file(&format!(
        r#""extensionsUsed": ["EXT_mesh_gpu_instancing"], "meshes": [{{"primitives": [{{"attributes": {{"POSITION": 0}}, "indices": 1}}]}}],
        "nodes": [{{"mesh": 0, "extensions": {{"EXT_mesh_gpu_instancing": {{"attributes": {{"TRANSLATION": {translation}, "ROTATION": {rotation},
            "SCALE": {scale}}}}}}}}}], "scenes": [{{"nodes": [0]}}]"#
    )));
    let (lower, upper) = scene.bounds();
    assert!(lower.distance(Vec3::new(-2.0, 0.0, 0.0)) < 1e-5 && upper.distance(Vec3::new(3.0, 2.0, 0.0)) < 1e-5);
    let areas: Vec<f32> = scene.polygons.iter().map(|polygon| scene.area(polygon)).collect();
    assert!(areas.iter().zip([2.0, 2.0, 0.5, 0.5]).all(|(area, truth)| (area - truth).abs() < 1e-5), "{areas:?}");
}

#[test]
fn sides_and_unused_vertices() {
    for two_sided in [true, false] {
        let material = format!(r#", "doubleSided": {two_sided}"#);
        let scene = load_glb(&Gltf::square().file(&one_mesh("", &material, "")));
        assert_eq!(scene.materials[0].is_two_sided, two_sided);
    }
    // A vertex that is no number, and that no face uses, does no harm; one that a face uses does.
    let corner =
        |unused: bool| {
            let mut file = Gltf::square();
            let corners = [[f32::NAN; 3], [0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0]];
            let positions = file.floats::<3>(&corners);
            let indices = if unused { [1_u8, 2, 3] } else { [0, 2, 3] };
            let indices = file.accessor(&indices, U8, 3, "SCALAR", "");
            let folder = Folder::new();
            load_file(&folder.write("a.glb", file.file(&format!(
            r#""meshes": [{{"primitives": [{{"attributes": {{"POSITION": {positions}}}, "indices": {indices}}}]}}],
            "nodes": [{{"mesh": 0}}], "scenes": [{{"nodes": [0]}}]"#
        ))))
        };
    assert_eq!(corner(true).expect("nothing uses it").polygons.len(), 1);
    assert!(corner(false).expect_err("a corner").to_string().contains("not finite"));
}
