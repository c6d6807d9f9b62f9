//! Compressed attributes as the encoders make them that exporters use: draco3dgltf 1.5 by way of
//! glTF-Transform 4, and meshoptimizer's own.

use glam::{Vec2, Vec3};
use image::ImageFormat;

use crate::basis::bytes;
use crate::builder::{F32, Gltf, I8, I16, one_mesh};
use crate::{load, notes, picture};

/// A grid of 2 × 2 squares in two halves that meet in a seam at x = 1, in the order that packs
/// best.
const EDGEBREAKER: &str = "\
    445241434f02020101000000090802080200037fda07ff0111c003809685c00380968503ff00000001000101000100090300000201030902\
    00010201020903000202010101000f03ad2a2f5515032a624cffffff0f00fcff0000000000fcff0000000000000000ff3f00000000000000\
    00000000000000000000400e010101000d035515230110ad1a05d7e2e74e81000880ff070000fe0f00fc3f01f8ffff012000020000f87f00\
    00000000ff0f000000000000000000000000803f0c010101010280028d339103ffffffebc901c9015505077e8ca8eec7c59400000000ff00\
    00000000003f000000000000003f0000003f08";

/// The grid with its triangles one after the other.
const SEQUENTIAL: &str = "\
    445241434f020201000000080c0100010300030202030502050406070906090808090b080b0a010300090300000309020001020903000202\
    0202000101000f03550555052b59350481a8a080f8ff010000e0ffffff0180ff1f000000fe7fff1f00f8ff01000000f1ff010000a0ffffff\
    0100ff1f000000fa7fff1f00f0ff0100000000000000ff3f0000000101000d035505230110ad2a044d5ed095002000fc1f00022000fc1f00\
    02200004e0ffff1f00000880ff07000002e0ff010000000000ff0f0000000101010280025135c901c901ffffffeb910391030764a91f1b46\
    ad8100000000ff000000000000000000000000000000000000400e00000000000000000000803f0c0000003f000000000000003f0000003f\
    08";

/// Four normals in 8 bits: (0.6, 0, 0.8), (−0.6, 0, 0.8), (0, 0.28, 0.96), (0, −0.8, −0.6).
const OCTAHEDRAL_8: &str = "\
    a0013f000000d76c6c010f0000003ac800000000000000000000000000000000000000000000000000000000000036007f00";

/// The normals in 12 of 16 bits.
const OCTAHEDRAL_16: &str = "\
    a0013f0000004cdada013f0000000d0806010f0000006366010b000000110000000000000000000000000000000000000000000000000000\
    00006d030000ff070000";

/// Three rotations: none, by 90° about z, by −120° about (1, 1, 1).
const QUATERNION: &str = "\
    a0011c000000af013c0000000e03010c000000b1010c0000000a010c000000b2010c0000000b011c00000003000000000000000000000000\
    00000000000000000000000000000000000000ff07";

/// Four positions: (0, 0, 0), (2.5, 0, 0), (2.5, −30, 0.125), (0, −30, 0.125).
const EXPONENTIAL: &str = "\
    a0000133000000504f000000010c0000007701040000000000010c0000004000000000000000000000000000000000000000000000000000\
    f4000000f7000000f0";

/// Truth: the grid as it was encoded, by hand; its texture coordinates jump at the seam, and its
/// colours too. Draco keeps 12 bits of the former and 8 of the latter.
#[test]
fn draco_keeps_texture_coordinates_and_colours() {
    for (order, data) in [("edgebreaker", EDGEBREAKER), ("sequential", SEQUENTIAL)] {
        let mut file = Gltf::square();
        let picture = file.view(&picture([1, 1], ImageFormat::Png, |_, _| [255; 4]));
        let data = file.view(&bytes(data));
        let rest = one_mesh(
            "",
            r#", "pbrMetallicRoughness": {"baseColorFactor": [0.5, 0.5, 0.5, 1], "baseColorTexture": {"index": 0}}"#,
            &format!(
                r#", "extensionsRequired": ["KHR_draco_mesh_compression"], "textures": [{{"source": 0}}],
                "images": [{{"bufferView": {picture}, "mimeType": "image/png"}}]"#
            ),
        );
        let compressed = format!(
            r#""extensions": {{"KHR_draco_mesh_compression": {{"bufferView": {data},
            "attributes": {{"POSITION": 0, "TEXCOORD_0": 1, "COLOR_0": 2}}}}}}, "material": 0"#
        );
        let scene = load(&[("a.glb", &file.file(&rest.replacen(r#""material": 0"#, &compressed, 1)))], "a.glb");
        assert_eq!(scene.polygons.len(), 8, "{order}: {}", notes(&scene));
        for polygon in &scene.polygons {
            let (corners, count) = scene.corner_positions(polygon);
            let middle = corners[..count].iter().sum::<Vec3>() / count as f32;
            let is_left = middle.x < 1.0;
            for at in corners[..count].iter().map(|corner| corner.lerp(middle, 0.1)) {
                let uv = scene.texture_coordinates(polygon, at).expect("coordinates");
                let u = if is_left { 0.25 * at.x } else { 1.25 - 0.25 * at.x };
                assert!(uv.distance(Vec2::new(u, 0.25 * at.y)) < 1e-3, "{order}: {uv} at {at}");
                let surface = scene.surface_at(polygon, at, scene.surface(polygon), 1e-3).expect("no hole");
                let colour = 0.5 * Vec3::new(if is_left { 0.5 } else { 1.0 }, 0.25 * at.y, 0.5);
                assert!(surface.reflectance.distance(colour) < 4e-3, "{order}: {} at {at}", surface.reflectance);
            }
        }
    }
}

/// Truth: the normals that were encoded, turned to the side that the face shows.
#[test]
fn octahedral_normals() {
    for (data, component, stride, tolerance) in [(OCTAHEDRAL_8, I8, 4, 0.02), (OCTAHEDRAL_16, I16, 8, 1e-3)] {
        let mut file = Gltf::square();
        let normals = file.meshopt(&bytes(data), "OCTAHEDRAL", [4, stride], component, "VEC3");
        let rest = one_mesh(&format!(r#", "NORMAL": {normals}"#), "", "");
        let scene = load(&[("a.glb", &file.file(&rest))], "a.glb");
        let truth = [
            (Vec3::ZERO, Vec3::new(0.6, 0.0, 0.8)),
            (Vec3::X, Vec3::new(-0.6, 0.0, 0.8)),
            (Vec3::new(1.0, 1.0, 0.0), Vec3::new(0.0, 0.28, 0.96)),
            (Vec3::Y, Vec3::new(0.0, 0.8, 0.6)),
        ];
        for (corner, truth) in truth {
            let polygon = scene.polygons.iter().find(|polygon| {
                let (corners, count) = scene.corner_positions(polygon);
                corners[..count].contains(&corner)
            });
            let normal = scene.smooth_normal(polygon.expect("a corner"), corner);
            assert!(normal.distance(truth) < tolerance, "{normal} is not {truth}");
        }
    }
}

/// Truth: the square turned by hand; q = (½, ½, ½, −½) takes x to z, y to x and z to y.
#[test]
fn quaternions_of_instances() {
    let mut file = Gltf::square();
    let rotations = file.meshopt(&bytes(QUATERNION), "QUATERNION", [3, 8], I16, "VEC4");
    let translations = file.floats::<3>(&[[0.0, 0.0, 0.0], [5.0, 0.0, 0.0], [10.0, 0.0, 0.0]]);
    let scene = load(
        &[(
            "a.glb",
            &file.file(&format!(
                r#""extensionsUsed": ["EXT_mesh_gpu_instancing"], "scenes": [{{"nodes": [0]}}],
                "meshes": [{{"primitives": [{{"attributes": {{"POSITION": 0}}, "indices": 1}}]}}],
                "nodes": [{{"mesh": 0, "extensions": {{"EXT_mesh_gpu_instancing": {{"attributes":
                    {{"TRANSLATION": {translations}, "ROTATION": {rotations}}}}}}}}}]"#
            )),
        )],
        "a.glb",
    );
    let truth = [
        (Vec3::ZERO, Vec3::new(1.0, 1.0, 0.0), Vec3::Z),
        (Vec3::new(4.0, 0.0, 0.0), Vec3::new(5.0, 1.0, 0.0), Vec3::Z),
        (Vec3::new(10.0, 0.0, 0.0), Vec3::new(11.0, 0.0, 1.0), Vec3::Y),
    ];
    assert_eq!(scene.polygons.len(), 6, "{}", notes(&scene));
    for (polygons, (lower, upper, normal)) in scene.polygons.chunks(2).zip(truth) {
        let corners = polygons.iter().flat_map(|polygon| scene.corner_positions(polygon).0.into_iter().take(3));
        let none = (Vec3::INFINITY, Vec3::NEG_INFINITY);
        let found = corners.fold(none, |(lower, upper), corner| (lower.min(corner), upper.max(corner)));
        assert!(
            found.0.distance(lower) < 2e-3 && found.1.distance(upper) < 2e-3,
            "{found:?} is not {lower} to {upper}"
        );
        assert!(polygons.iter().all(|polygon| scene.normal(polygon).distance(normal) < 2e-3), "{normal}");
    }
}

/// Truth: the positions that were encoded, in 15 bits.
#[test]
fn exponential_positions() {
    let mut file = Gltf::square();
    let positions = file.meshopt(&bytes(EXPONENTIAL), "EXPONENTIAL", [4, 12], F32, "VEC3");
    let rest = one_mesh("", "", "").replacen(r#""POSITION": 0"#, &format!(r#""POSITION": {positions}"#), 1);
    let scene = load(&[("a.glb", &file.file(&rest))], "a.glb");
    let (lower, upper) = scene.bounds();
    let found = (lower.distance(Vec3::new(0.0, -30.0, 0.0)), upper.distance(Vec3::new(2.5, 0.0, 0.125)));
    assert!(found.0 < 1e-3 && found.1 < 1e-5, "{lower} to {upper}");
}
