//! Colours, textures, opacity and emission of each face.

use std::f32::consts::PI;

use glam::Vec3;
use image::ImageFormat;
use selflink::scene::builtin::BuiltinScene;
use selflink::scene::{Reading, Scene, Sidecar, Source, load_file, load_with};

use crate::support::{Folder, glb, square_bytes, square_json};
use crate::{CUBE, GLOW, HALF, assert_furnace, load, load_obj, notes};
use crate::{basis, picture};

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

/// Truth: of a cube one face is a pane; what is left out by a person stays out by the sidecar, and
/// a name that is none is reported.
#[test]
fn a_material_is_left_out_where_daylight_is_to_pass() {
    let folder = Folder::new();
    folder.write("a.mtl", "newmtl pane\nKd 0.5 0.5 0.5\nnewmtl wall\nKd 0.5 0.5 0.5\n");
    let path = folder.write(
        "a.obj",
        CUBE.replace("v 0 0 0\n", "mtllib a.mtl\nusemtl pane\nv 0 0 0\n").replace("f 6 5", "usemtl wall\nf 6 5"),
    );
    let reading = Reading { ignored: vec!["pane".into(), "door".into()], ..Reading::default() };
    let open = load_with(&Source::File(path.clone()), &reading).expect("a sound scene");
    assert_eq!(open.polygons.len(), 5);
    assert!(notes(&open).contains("no material `door` to be left out"), "{}", notes(&open));
    Sidecar::of(&open).write(&Sidecar::path_for(&path)).expect("a writable folder");
    assert_eq!(load_file(&path).expect("a sound scene").polygons.len(), 5);
    let reading = Reading { ignored: vec!["daylight".into()], ..Reading::default() };
    let [closed, open] = [Reading::default(), reading]
        .map(|reading| load_with(&Source::Builtin(BuiltinScene::Office), &reading).expect("our own").polygons.len());
    assert!(open < closed, "the panes of the office: {open} of {closed}");
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

/// A GLB of two squares, the second one metre above the first, with texture coordinates that all
/// lie at one point each.
fn palette(points: [[f32; 2]; 2], png: &[u8], material: &str) -> Vec<u8> {
    squares(points.map(|point| [point; 4]), png, material)
}

/// A GLB of two squares, the second one metre above the first, with texture coordinates at the
/// corners of each.
fn squares(corners: [[[f32; 2]; 4]; 2], png: &[u8], material: &str) -> Vec<u8> {
    let mut binary = square_bytes();
    binary.extend(corners.into_iter().flatten().flatten().flat_map(f32::to_le_bytes));
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

/// Truth: four texels of a palette; each face shows one of them, and the material their mean by
/// area.
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
    assert!(map.sample(uv, 1.0).truncate().distance(Vec3::X) < 1e-3, "{uv}");
}

/// Truth: the texels themselves. Faces count as their mean, points show what lies there, what is
/// clear is a hole, and a change of the material changes both alike.
#[test]
fn points_of_faces_show_their_own_texels() {
    let texels = [[255, 0, 0, 255], [0, 255, 0, 255], [0, 0, 255, 255], [255, 255, 255, 0]];
    let png = picture([2, 2], ImageFormat::Png, |x, y| texels[(2 * y + x) as usize]);
    let material = r#""alphaMode": "MASK", "alphaCutoff": 0.6, "pbrMetallicRoughness": {"baseColorTexture": {"index": 0},
        "baseColorFactor": [0.5, 0.25, 0.5, 1]}"#;
    let whole = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
    let mut scene = load(&[("a.glb", &squares([whole; 2], &png, material))], "a.glb");
    let at = |scene: &Scene, x: f32, y: f32| {
        // The triangle below the diagonal, or that above.
        let polygon = &scene.polygons[usize::from(y > x)];
        scene.surface_at(polygon, Vec3::new(x, y, 0.0), scene.surface(polygon), 1e-3).map(|it| it.reflectance)
    };
    let is_near = |found: Option<Vec3>, truth: Vec3| found.is_some_and(|found| found.distance(truth) < 1e-4);
    assert!(is_near(at(&scene, 0.25, 0.25), Vec3::new(0.5, 0.0, 0.0)), "{:?}", at(&scene, 0.25, 0.25));
    assert!(is_near(at(&scene, 0.75, 0.25), Vec3::new(0.0, 0.25, 0.0)), "{:?}", at(&scene, 0.75, 0.25));
    assert!(is_near(at(&scene, 0.25, 0.75), Vec3::new(0.0, 0.0, 0.5)), "{:?}", at(&scene, 0.25, 0.75));
    assert_eq!(at(&scene, 0.76, 0.75), None, "a hole");
    scene.materials[0].reflectance *= 0.5;
    assert!(is_near(at(&scene, 0.25, 0.25), Vec3::new(0.25, 0.0, 0.0)), "{:?}", at(&scene, 0.25, 0.25));
}

/// Truth: from far away a chequerboard of many fields is as grey as its mean.
#[test]
fn textures_are_as_coarse_as_they_are_seen() {
    let png = picture([64, 64], ImageFormat::Png, |x, y| if (x + y) % 2 == 0 { [255; 4] } else { [0, 0, 0, 255] });
    let whole = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
    let material = r#""pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}"#;
    let scene = load(&[("a.glb", &squares([whole; 2], &png, material))], "a.glb");
    let polygon = &scene.polygons[0];
    let red = |footprint: f32| {
        let point = Vec3::new(32.5 / 64.0, 32.5 / 64.0, 0.0);
        scene.surface_at(polygon, point, scene.surface(polygon), footprint).expect("no hole").reflectance.x
    };
    // White is below 1 by the largest reflectance allowed; a mean of white and black is within a
    // step of sRGB.
    assert!(red(1e-3) > 0.9 && (red(0.1) - 0.5).abs() < 0.01, "{} {}", red(1e-3), red(0.1));
}

/// Truth: of two faces of one material the one that looks at the bright texel is a lamp, the other
/// is none.
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
    // Half of the texture is (0.503, 0.503, 0.503), half (0.503, 0, 0); what block compression may
    // add is below 2 %.
    for encoded in [basis::ETC1S, basis::UASTC] {
        let scene = with("KHR_texture_basisu", &basis::bytes(encoded));
        let colour = scene.materials[0].reflectance;
        assert!(colour.distance(Vec3::new(0.5029, 0.2514, 0.2514)) < 0.01, "{colour}: {}", notes(&scene));
        assert!(!notes(&scene).contains("not used"), "{}", notes(&scene));
    }
    let whole = basis::bytes(basis::ETC1S);
    for cut in [14, 30, 100, whole.len() - 1] {
        let broken = with("KHR_texture_basisu", &whole[..cut]);
        assert_eq!(broken.materials[0].reflectance, Vec3::splat(0.5), "{cut} bytes");
        assert!(notes(&broken).contains("is not used"), "{}", notes(&broken));
    }
}
