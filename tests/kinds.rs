//! The kinds of files that real exporters write: each is built here, small, with what must come of it.
//!
//! A "furnace" is a unit cube seen from inside, ρ = ½ and B_e = 1 W/m² on every face, so that B = 2 everywhere.

mod support;

use std::f32::consts::PI;
use std::io::Cursor;

use glam::Vec3;
use image::{ImageFormat, Rgba, RgbaImage};
use meshoptimizer_rs::Workspace;
use meshoptimizer_rs::codec::{VertexEncoding, encode_vertex_buffer};
use selflink::added_light::AddedLight;
use selflink::prepare::prepare;
use selflink::scene::{Reading, Scene, Sidecar, Sides, Source, Unit, UpAxis, load_file, load_with};
use selflink::solver::point_to_polygon;
use support::{Folder, glb, square_bytes, square_json};

/// Faces of a unit cube, seen from inside.
const CUBE: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\n\
    f 1 2 3 4\nf 6 5 8 7\nf 5 1 4 8\nf 2 6 7 3\nf 5 6 2 1\nf 4 3 7 8\n";

/// A radiance of 1/π makes an exitance of 1.
const GLOW: &str = "Ke 0.31830987 0.31830987 0.31830987\n";

fn load(files: &[(&str, &[u8])], name: &str) -> Scene {
    let folder = Folder::new();
    for (name, content) in files {
        folder.write(name, content);
    }
    load_file(&folder.path(name)).expect("a sound scene")
}

fn load_obj(obj: &str, mtl: &str) -> Scene {
    load(&[("a.obj", obj.as_bytes()), ("a.mtl", mtl.as_bytes())], "a.obj")
}

fn assert_furnace(scene: &Scene, what: &str) {
    assert!(scene.polygons.len() >= 6, "{what}: {} polygons", scene.polygons.len());
    for polygon in &scene.polygons {
        let surface = scene.surface(polygon);
        // A half is between two steps of sRGB.
        assert!(surface.reflectance.distance(Vec3::splat(0.5)) < 6e-3, "{what}: {surface:?}");
        assert!(surface.emission.distance(Vec3::ONE) < 1e-5, "{what}: {surface:?}");
    }
}

fn picture(size: [u32; 2], format: ImageFormat, texel: impl Fn(u32, u32) -> [u8; 4]) -> Vec<u8> {
    let image = RgbaImage::from_fn(size[0], size[1], |x, y| Rgba(texel(x, y)));
    let mut encoded = Cursor::new(Vec::new());
    let image = image::DynamicImage::ImageRgba8(image);
    let image = if format == ImageFormat::Tga { image.into_rgb8().into() } else { image };
    image.write_to(&mut encoded, format).expect("it can be encoded");
    encoded.into_inner()
}

/// sRGB 188 is linear 0.5029.
const HALF: [u8; 4] = [188, 188, 188, 255];

fn notes(scene: &Scene) -> String {
    scene.skipped.sentences().join(" ")
}

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

#[test]
fn opaque_though_it_says_otherwise() {
    let obj = format!("mtllib a.mtl\nusemtl glow\n{CUBE}");
    let by_tr = load_obj(&obj, &format!("newmtl glow\nKd 0.5 0.5 0.5\n{GLOW}Tr 1.0\n"));
    assert_furnace(&by_tr, "Tr 1");
    assert!(notes(&by_tr).contains("taken for opacity"), "{}", notes(&by_tr));

    let blend = |alpha: f32, mode: &str| {
        let rest = format!(
            r#""scenes": [{{"nodes": [0]}}], "nodes": [{{"mesh": 0}}, {{"mesh": 0}}],
            "meshes": [{{"primitives": [{{"attributes": {{"POSITION": 0}}, "indices": 1, "material": 0}},
                {{"attributes": {{"POSITION": 0}}, "indices": 1, "mode": 5}}]}}],
            "materials": [{{"name": "pane", "alphaMode": "{mode}", "pbrMetallicRoughness": {{"baseColorFactor": [1, 1, 1, {alpha}]}}}}]"#
        );
        load(&[("a.glb", &glb(&square_json(&rest), &square_bytes()))], "a.glb").skipped.transparent_faces
    };
    assert_eq!([blend(1.0, "BLEND"), blend(0.5, "BLEND"), blend(0.49, "BLEND")], [0, 0, 2]);
    assert_eq!([blend(0.5, "MASK"), blend(0.49, "MASK"), blend(0.1, "OPAQUE")], [0, 2, 0]);
}

/// Truth: the file says 0.1; a person's word counts more, and comes back by the sidecar.
#[test]
fn a_material_that_was_left_out_comes_back() {
    let folder = Folder::new();
    folder.write("a.mtl", "newmtl pane\nKd 0.5 0.5 0.5\nd 0.1\nnewmtl wall\nKd 0.5 0.5 0.5\n");
    let path = folder.write(
        "a.obj",
        CUBE.replace("v 0 0 0\n", "mtllib a.mtl\nusemtl pane\nv 0 0 0\n").replace("f 6 5", "usemtl wall\nf 6 5"),
    );
    let scene = load_file(&path).expect("a sound scene");
    assert_eq!((scene.polygons.len(), scene.skipped.transparent_faces, scene.materials[0].left_out), (5, 1, 1));
    assert!(notes(&scene).contains("Transparent: `pane`"), "{}", notes(&scene));
    let reading = Reading { opaque: vec!["pane".into()], ..Reading::default() };
    let whole = load_with(&Source::File(path.clone()), &reading).expect("a sound scene");
    assert_eq!((whole.polygons.len(), whole.skipped.transparent_faces), (6, 0));
    Sidecar::of(&whole).write(&Sidecar::path_for(&path)).expect("a writable folder");
    assert_eq!(load_file(&path).expect("a sound scene").polygons.len(), 6);
}

#[test]
fn colours_of_vertices_count() {
    let coloured = CUBE.replace(" 0\nv", " 0 0.5 0.5 0.5\nv").replace(" 1\nv", " 1 0.5 0.5 0.5\nv");
    let coloured = coloured.replace("v 0 1 1\n", "v 0 1 1 0.5 0.5 0.5\n");
    let mtl = format!("newmtl glow\nKd 1 1 1\n{GLOW}");
    assert_furnace(&load_obj(&format!("usemtl glow\nmtllib a.mtl\n{coloured}"), &mtl), "v x y z r g b");
    let to_255 = coloured.replace("0.5 0.5 0.5", "127.5 127.5 127.5");
    assert_furnace(&load_obj(&format!("usemtl glow\nmtllib a.mtl\n{to_255}"), &mtl), "to 255");
    let scene = load_obj(&coloured, "");
    assert!(scene.materials[0].reflectance.distance(Vec3::splat(0.5)) < 1e-4, "without a material they are the colour");
}

/// A GLB of two squares, the second one metre above the first, with texture coordinates that all lie at one point each.
fn palette(points: [[f32; 2]; 2], png: &[u8], material: &str) -> Vec<u8> {
    let mut binary = square_bytes();
    for point in points {
        binary.extend((0..4).flat_map(|_| point).flat_map(f32::to_le_bytes));
    }
    let picture_at = binary.len();
    binary.extend(png);
    let json = format!(
        r#"{{"asset": {{"version": "2.0"}}, "buffers": [{{"byteLength": {}}}],
        "bufferViews": [{{"buffer": 0, "byteLength": 48}}, {{"buffer": 0, "byteOffset": 48, "byteLength": 12}},
            {{"buffer": 0, "byteOffset": 60, "byteLength": 32}}, {{"buffer": 0, "byteOffset": 92, "byteLength": 32}},
            {{"buffer": 0, "byteOffset": {picture_at}, "byteLength": {}}}],
        "accessors": [{{"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3"}},
            {{"bufferView": 1, "componentType": 5123, "count": 6, "type": "SCALAR"}},
            {{"bufferView": 2, "componentType": 5126, "count": 4, "type": "VEC2"}},
            {{"bufferView": 3, "componentType": 5126, "count": 4, "type": "VEC2"}}],
        "images": [{{"bufferView": 4, "mimeType": "image/png"}}], "textures": [{{"source": 0}}],
        "materials": [{{"name": "palette", {material}}}],
        "meshes": [{{"primitives": [{{"attributes": {{"POSITION": 0, "TEXCOORD_0": 2}}, "indices": 1, "material": 0}}]}},
            {{"primitives": [{{"attributes": {{"POSITION": 0, "TEXCOORD_0": 3}}, "indices": 1, "material": 0}}]}}],
        "nodes": [{{"mesh": 0}}, {{"mesh": 1, "translation": [0, 0, 1]}}], "scenes": [{{"nodes": [0, 1]}}]}}"#,
        binary.len(),
        png.len()
    );
    glb(&json, &binary)
}

/// Truth: four texels of a palette; each face shows one of them, and the material their mean by area.
#[test]
fn faces_have_the_colour_of_their_own_part_of_a_texture() {
    let png = picture([4, 1], ImageFormat::Png, |x, _| [[0, 0, 0, 255], HALF, [255; 4], [255, 0, 0, 255]][x as usize]);
    let red = |scene: &Scene, polygon: usize| scene.surface(&scene.polygons[polygon]).reflectance;
    let material =
        r#""pbrMetallicRoughness": {"baseColorTexture": {"index": 0}, "baseColorFactor": [0.5, 0.5, 0.5, 1]}"#;
    let scene = load(&[("a.glb", &palette([[0.375, 0.5], [0.875, 0.5]], &png, material))], "a.glb");
    assert!(red(&scene, 0).distance(Vec3::splat(0.2514)) < 1e-3, "{}", red(&scene, 0));
    assert!(red(&scene, 2).distance(Vec3::new(0.5, 0.0, 0.0)) < 1e-3, "{}", red(&scene, 2));
    assert!(scene.materials[0].reflectance.distance(Vec3::new(0.3757, 0.1257, 0.1257)) < 1e-3);

    // Moved by two texels (KHR_texture_transform) the first face shows the fourth texel.
    let moved = material
        .replace(r#""index": 0"#, r#""index": 0, "extensions": {"KHR_texture_transform": {"offset": [0.5, 0]}}"#);
    let scene = load(&[("a.glb", &palette([[0.375, 0.5], [0.125, 0.5]], &png, &moved))], "a.glb");
    assert!(red(&scene, 0).distance(Vec3::new(0.5, 0.0, 0.0)) < 1e-3, "{}", red(&scene, 0));

    // An edit of the material changes all of its faces alike, and a picture reads the texture.
    let mut edited = scene.clone();
    edited.materials[0].reflectance *= 0.5;
    assert!(red(&edited, 0).distance(0.5 * red(&scene, 0)) < 1e-6);
    let uv = scene.texture_coordinates(&scene.polygons[0], Vec3::new(0.3, 0.2, 0.0)).expect("coordinates");
    let map = scene.materials[0].textures.as_ref().and_then(|it| it.reflectance.as_ref()).expect("a texture");
    assert!(map.sample(uv).truncate().distance(Vec3::X) < 1e-3, "{uv}");
}

/// Truth: of two faces of one material the one that looks at the bright texel is a lamp, the other is none.
#[test]
fn emission_counts_by_face() {
    let png = picture([2, 1], ImageFormat::Png, |x, _| [[0, 0, 0, 255], [255; 4]][x as usize]);
    let material = r#""emissiveFactor": [1, 0.5, 0], "emissiveTexture": {"index": 0}, "extensions": {"KHR_materials_emissive_strength": {"emissiveStrength": 2}}"#;
    let scene = load(&[("a.glb", &palette([[0.25, 0.5], [0.75, 0.5]], &png, material))], "a.glb");
    assert!(!scene.emits(&scene.polygons[0]) && scene.emits(&scene.polygons[2]));
    let glow = 2.0 * PI * Vec3::new(1.0, 0.5, 0.0);
    assert!(scene.surface(&scene.polygons[2]).emission.distance(glow) < 1e-4);
    assert!(scene.emitted_power().distance(glow) < 1e-4, "one square metre of it");

    let mtl = "newmtl glow\nKd 0.5 0.5 0.5\nmap_Ke half.png\n";
    let half = picture([1, 1], ImageFormat::Png, |_, _| HALF);
    let obj = format!("mtllib a.mtl\nusemtl glow\n{CUBE}");
    let scene = load(&[("a.obj", obj.as_bytes()), ("a.mtl", mtl.as_bytes()), ("half.png", &half)], "a.obj");
    assert!(scene.surface(&scene.polygons[0]).emission.distance(Vec3::splat(0.5029 * PI)) < 1e-3);
    let scene = load(&[("a.obj", obj.as_bytes()), ("a.mtl", mtl.as_bytes())], "a.obj");
    assert!(!scene.has_light() && notes(&scene).contains("`half.png` is not used"), "{}", notes(&scene));
}

#[test]
fn textures_of_all_kinds_and_places() {
    let obj = format!("mtllib a.mtl\nusemtl glow\n{CUBE}");
    let formats =
        [ImageFormat::Png, ImageFormat::Tga, ImageFormat::Bmp, ImageFormat::Gif, ImageFormat::Tiff, ImageFormat::WebP];
    for format in formats {
        let extension = format.extensions_str()[0];
        let half = picture([2, 2], format, |_, _| HALF);
        for (stored, line) in [
            ("half", format!("half.{extension}")),
            ("half", format!("half.{extension} -s 2 2 2")),
            ("maps/Half", format!("C:\\Users\\me\\half.{}", extension.to_uppercase())),
        ] {
            let mtl = format!("newmtl glow\nKd 1 1 1\n{GLOW}map_Kd {line}\n");
            let stored = format!("{stored}.{extension}");
            let scene = load(&[("a.obj", obj.as_bytes()), ("a.mtl", mtl.as_bytes()), (&stored, &half)], "a.obj");
            assert_furnace(&scene, &line);
            assert_eq!(notes(&scene), "", "{line}");
        }
    }
    let mtl = format!("newmtl glow\nKd 1 1 1\n{GLOW}map_Kd plaster.dds\n");
    let scene = load_obj(&obj, &mtl);
    assert_furnace(&scene, "a texture that is not there is grey");
    assert!(notes(&scene).contains("`plaster.dds` is not used"), "{}", notes(&scene));
}

/// Truth: an extension that holds a picture costs at most the picture.
#[test]
fn required_extensions_of_textures() {
    let with = |extension: &str, content: &[u8]| {
        let mut binary = square_bytes();
        binary.extend(content);
        let rest = format!(
            r#""extensionsRequired": ["{extension}"], "extensionsUsed": ["{extension}", "ACME_shine"],
            "images": [{{"bufferView": 2}}], "textures": [{{"extensions": {{"{extension}": {{"source": 0}}}}}}],
            "materials": [{{"pbrMetallicRoughness": {{"baseColorTexture": {{"index": 0}}}}}}],
            "scenes": [{{"nodes": [0]}}], "nodes": [{{"mesh": 0}}],
            "meshes": [{{"primitives": [{{"attributes": {{"POSITION": 0}}, "indices": 1, "material": 0}}]}}]"#
        );
        let length = binary.len();
        let json = square_json(&rest).replace(r#""byteLength": 60"#, &format!(r#""byteLength": {length}"#)).replace(
            r#""byteOffset": 48, "byteLength": 12}"#,
            &format!(
                r#""byteOffset": 48, "byteLength": 12}}, {{"buffer": 0, "byteOffset": 60, "byteLength": {}}}"#,
                content.len()
            ),
        );
        load(&[("a.glb", &glb(&json, &binary))], "a.glb")
    };
    let webp = with("EXT_texture_webp", &picture([2, 2], ImageFormat::WebP, |_, _| HALF));
    assert!(webp.materials[0].reflectance.distance(Vec3::splat(0.5029)) < 2e-3, "{}", webp.materials[0].reflectance);
    assert!(notes(&webp).contains("not read: `ACME_shine`"), "{}", notes(&webp));
    let basis = with("KHR_texture_basisu", b"\xabKTX 20\xbb\r\n\x1a\n and so on");
    assert_eq!(basis.materials[0].reflectance, Vec3::splat(0.5));
    assert!(notes(&basis).contains("KTX2 is not read"), "{}", notes(&basis));
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

/// Truth: E = I cos³θ/h² at a floor, by 179 lm/W; within 1 % at 1 to 10 m, straight below and aslant, for a point and inside of a spot's
/// inner cone; nothing outside of its outer cone.
#[test]
fn punctual_lights_keep_their_candelas_and_cones() {
    let light = |kind: &str| {
        let rest = format!(
            r#""extensionsUsed": ["KHR_lights_punctual"],
            "extensions": {{"KHR_lights_punctual": {{"lights": [{{"name": "Bulb", "intensity": 179, "color": [1, 0.5, 0.25], "range": 7, {kind}}}]}}}},
            "scenes": [{{"nodes": [0, 1]}}], "meshes": [{{"primitives": [{{"attributes": {{"POSITION": 0}}, "indices": 1}}]}}],
            "nodes": [{{"mesh": 0, "translation": [50, 0, 0]}},
                {{"rotation": [-0.70710678, 0, 0, 0.70710678], "extensions": {{"KHR_lights_punctual": {{"light": 0}}}}}}]"#
        );
        load(&[("a.glb", &glb(&square_json(&rest), &square_bytes()))], "a.glb")
    };
    let irradiance = |scene: &Scene, occluders: &selflink::geometry::Occluders, point: Vec3| -> Vec3 {
        let lamps = scene.polygons.iter().filter(|polygon| scene.emits(polygon));
        let of_lamp = |polygon: &selflink::scene::Polygon| {
            let (corners, count) = scene.corner_positions(polygon);
            let middle = corners[..count].iter().sum::<Vec3>() / count as f32;
            // The sphere does not hide its own front.
            let outside = middle + 1e-4 * scene.normal(polygon);
            let is_seen = scene.normal(polygon).dot(point - middle) > 0.0 && !occluders.occluded(outside, point);
            if is_seen {
                point_to_polygon(point, Vec3::Y, &corners[..count]) * scene.surface(polygon).emission
            } else {
                Vec3::ZERO
            }
        };
        lamps.map(of_lamp).sum()
    };
    let truth = |h: f32, angle: f32| angle.cos().powi(3) / (h * h);
    let point = light(r#""type": "point""#);
    let spot = light(r#""type": "spot", "spot": {"innerConeAngle": 0.5, "outerConeAngle": 0.7}"#);
    for (scene, widest) in [(&point, 1.2_f32), (&spot, 0.48)] {
        assert_eq!((scene.lights[0].name.as_str(), scene.lights[0].range), ("Bulb", Some(7.0)));
        assert_eq!(scene.materials[scene.lights[0].material.0 as usize].name, "Bulb");
        let occluders = selflink::geometry::Occluders::new(scene);
        for h in [1.0, 3.0, 10.0] {
            for (angle, turn) in [(0.0, 0.0), (0.2, 1.0), (0.5 * widest, 2.0), (widest, 4.0_f32)] {
                let aside = h * angle.tan();
                let at = Vec3::new(aside * turn.cos(), -h, aside * turn.sin());
                let found = irradiance(scene, &occluders, at);
                let expected = truth(h, angle) * Vec3::new(1.0, 0.5, 0.25);
                assert!(
                    found.distance(expected) < 0.01 * expected.length(),
                    "{h} m, {angle}: {found} is not {expected}"
                );
            }
        }
    }
    let occluders = selflink::geometry::Occluders::new(&spot);
    for angle in [0.72_f32, 0.9, 1.3] {
        assert_eq!(irradiance(&spot, &occluders, Vec3::new(2.0 * angle.tan(), -2.0, 0.0)), Vec3::ZERO, "{angle}");
    }
    let half = irradiance(&spot, &occluders, Vec3::new(2.0 * 0.6_f32.tan(), -2.0, 0.0)) / truth(2.0, 0.6);
    assert!((0.3..0.7).contains(&half.x), "between the cones: {half}");
}

/// Truth: a camera of the file opens the scene: 1.6 m high, hfov = 2·atan(1.5·tan ½).
#[test]
fn cameras_of_the_file_are_kept() {
    let scene = load(
        &[(
            "a.glb",
            &glb(
                &square_json(
                    r#""cameras": [{"name": "door", "type": "perspective", "perspective": {"yfov": 1.0, "znear": 0.01, "aspectRatio": 1.5}},
                    {"type": "orthographic", "orthographic": {"xmag": 1, "ymag": 1, "zfar": 9, "znear": 0.1}}],
                    "nodes": [{"mesh": 0}, {"camera": 0, "translation": [0.3, 1.6, 3.7]}, {"camera": 1}], "scenes": [{"nodes": [0, 1, 2]}],
                    "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}]"#,
                ),
                &square_bytes(),
            ),
        )],
        "a.glb",
    );
    assert_eq!((scene.cameras.len(), scene.cameras[0].name.as_str(), scene.skipped.ignored_cameras), (1, "door", 1));
    let pose = scene.camera.expect("the file's own");
    assert_eq!(pose.eye, Vec3::new(0.3, 1.6, 3.7));
    assert!((pose.target - pose.eye).normalize().distance(-Vec3::Z) < 1e-6);
    assert!((pose.hfov_deg - (2.0 * (1.5 * 0.5_f32.tan()).atan()).to_degrees()).abs() < 1e-3);
}

/// A room of 5 × 4 m and 3 m height with a table and a lamp, the axes given by `order`, scaled.
fn room(order: fn(f32, f32, f32) -> [f32; 3], scale: f32, outwards: bool) -> String {
    let mut text = String::from("mtllib a.mtl\n");
    let mut corners = Vec::new();
    for (x, up, z) in
        [(0., 0., 0.), (5., 0., 0.), (5., 3., 0.), (0., 3., 0.), (0., 0., 4.), (5., 0., 4.), (5., 3., 4.), (0., 3., 4.)]
    {
        corners.push((x, up, z));
    }
    corners.extend([(2.0, 0.75, 1.6), (3.2, 0.75, 1.6), (3.2, 0.75, 2.4), (2.0, 0.75, 2.4)]);
    corners.extend([(2.0, 2.9, 1.5), (3.0, 2.9, 1.5), (3.0, 2.9, 2.5), (2.0, 2.9, 2.5)]);
    for (x, up, z) in corners {
        let [x, y, z] = order(x, up, z).map(|value| scale * value);
        text += &format!("v {x} {y} {z}\n");
    }
    text += "usemtl wall\n";
    for [a, b, c, d] in [[1, 2, 3, 4], [6, 5, 8, 7], [5, 1, 4, 8], [2, 6, 7, 3], [5, 6, 2, 1], [4, 3, 7, 8]] {
        text += &if outwards { format!("f {d} {c} {b} {a}\n") } else { format!("f {a} {b} {c} {d}\n") };
    }
    text + "usemtl table\nf 12 11 10 9\nf 9 10 11 12\nusemtl lamp\nf 13 14 15 16\n"
}

const ROOM: &str = "newmtl wall\nKd .7 .7 .7\nnewmtl table\nKd .4 .25 .1\nnewmtl lamp\nKd 0 0 0\nKe 30 30 30\n";

fn y_up(x: f32, up: f32, z: f32) -> [f32; 3] {
    [x, up, z]
}

fn z_up(x: f32, up: f32, z: f32) -> [f32; 3] {
    [x, -z, up]
}

#[test]
fn up_is_seen_by_how_a_room_looks() {
    for (order, up) in [(y_up as fn(f32, f32, f32) -> [f32; 3], UpAxis::Y), (z_up, UpAxis::Z)] {
        let folder = Folder::new();
        folder.write("a.mtl", ROOM);
        let path = folder.write("a.obj", room(order, 1.0, false));
        let ready =
            prepare(&Source::File(path.clone()), &Reading::default(), &AddedLight::default(), None).expect("a room");
        let scene = &ready.scene;
        assert_eq!(scene.frame.up, Some(up));
        assert_eq!(notes(scene).contains("z is taken for up"), up == UpAxis::Z);
        let view = scene.camera.expect("a place to stand");
        assert_eq!((view.up, selflink::ceiling::up_axis(scene)), (up.vector(), up.vector()));
        assert!((view.eye.dot(up.vector()) - 1.6).abs() < 1e-3, "{view:?}");
        let other = if up == UpAxis::Y { UpAxis::Z } else { UpAxis::Y };
        let reading = Reading { up: Some(other), ..Reading::default() };
        assert_eq!(load_with(&Source::File(path), &reading).expect("a room").frame.up, Some(other));
    }
}

/// Truth: a room of 5 × 3 × 4 m in other units is as large.
#[test]
fn lengths_become_metres() {
    for (unit, told) in [(Unit::Centimetre, false), (Unit::Millimetre, false), (Unit::Inch, false), (Unit::Foot, true)]
    {
        let folder = Folder::new();
        folder.write("a.mtl", ROOM);
        let path = folder.write("a.obj", room(y_up, (1.0 / unit.metres()) as f32, false));
        let reading = Reading { unit: told.then_some(unit), ..Reading::default() };
        let scene = load_with(&Source::File(path), &reading).expect("a room");
        assert_eq!(scene.frame.unit, unit);
        assert!(scene.bounds().1.distance(Vec3::new(5.0, 3.0, 4.0)) < 1e-4, "{unit:?}: {}", scene.bounds().1);
        assert_eq!(notes(&scene).contains(unit.name()), !told, "{}", notes(&scene));
        let saved = Sidecar::of(&scene);
        assert_eq!(saved.unit, Some(unit), "what is saved in metres stays in metres");
    }
    let scene = load(
        &[("a.obj", room(y_up, 1000.0, false).replace("mtllib", "# File units = meters\nmtllib").as_bytes())],
        "a.obj",
    );
    assert_eq!((scene.frame.unit, scene.bounds().1.x), (Unit::Metre, 5000.0));
}

#[test]
fn a_room_wound_outwards_opens_lit() {
    let folder = Folder::new();
    folder.write("a.mtl", ROOM);
    let source = Source::File(folder.write("a.obj", room(y_up, 1.0, true)));
    let sides = |asked: Option<Sides>| {
        let ready = prepare(&source, &Reading::default(), &AddedLight::default(), asked).expect("a room");
        (ready.scene.sides, ready.scene.skipped.turned_faces, notes(&ready.scene))
    };
    let (auto, turned, said) = sides(None);
    assert_eq!((auto, turned), (Sides::Auto, 6));
    assert!(said.contains("turn their backs to the inside"), "{said}");
    assert_eq!(
        (sides(Some(Sides::Front)).0, sides(Some(Sides::Front)).1),
        (Sides::Front, 0),
        "unless somebody asks for it"
    );
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

    // Names in Latin-1 that differ in one byte; several material files; the first of two materials of one name.
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
