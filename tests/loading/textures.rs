//! How textures are laid on, in what formats they come, and what of opacity they say.

use glam::Vec3;
use image::ImageFormat;
use selflink::scene::{Polygon, Scene, load_file};

use crate::builder::{Gltf, one_mesh};
use crate::support::Folder;
use crate::{CUBE, load, load_obj, notes, picture};

/// Four texels: black, red, green, blue.
fn palette() -> Vec<u8> {
    let texels = [[0, 0, 0, 255], [255, 0, 0, 255], [0, 255, 0, 255], [0, 0, 255, 255]];
    picture([4, 1], ImageFormat::Png, |x, _| texels[x as usize])
}

/// A square with these texture coordinates of two sets and the palette as texture 0, laid on as
/// `info` and `sampler` say; half of it is reflected, and `more` belongs to the material too.
fn painted(uvs: [[f32; 2]; 2], [info, sampler, more]: [&str; 3]) -> Scene {
    let mut file = Gltf::square();
    let sets = uvs.map(|uv| file.floats::<2>(&[uv; 4]));
    let view = file.view(&palette());
    let mesh = one_mesh(
        &format!(r#", "TEXCOORD_0": {}, "TEXCOORD_1": {}"#, sets[0], sets[1]),
        &format!(
            r#", "pbrMetallicRoughness": {{"baseColorFactor": [0.5, 0.5, 0.5, 1], "baseColorTexture": {{"index": 0{info}}}}}{more}"#
        ),
        &format!(
            r#", "images": [{{"bufferView": {view}, "mimeType": "image/png"}}], "samplers": [{{{sampler}}}],
            "textures": [{{"source": 0, "sampler": 0}}]"#
        ),
    );
    load(&[("a.glb", &file.file(&mesh))], "a.glb")
}

/// Colour of such a square.
fn shown(uvs: [[f32; 2]; 2], info: &str, sampler: &str) -> Vec3 {
    let scene = painted(uvs, [info, sampler, ""]);
    scene.surface(&scene.polygons[0]).reflectance
}

const RED: Vec3 = Vec3::new(0.5, 0.0, 0.0);
const GREEN: Vec3 = Vec3::new(0.0, 0.5, 0.0);
const BLUE: Vec3 = Vec3::new(0.0, 0.0, 0.5);

/// Truth: KHR_texture_transform by hand: scale, then rotation (u′ = u cos + v sin), then offset;
/// `texCoord` names another set.
#[test]
fn textures_are_scaled_turned_and_laid_on_by_another_set() {
    let transform = |said: &str| format!(r#", "extensions": {{"KHR_texture_transform": {{{said}}}}}"#);
    let at = |u: f32, v: f32, said: &str| shown([[u, v], [0.9, 0.5]], &transform(said), "");
    let cases = [
        (at(0.9, 0.5, ""), BLUE, "nothing"),
        (at(0.9, 0.5, r#""scale": [0.5, 1]"#), RED, "0.45"),
        // A quarter turn: u′ = v.
        (at(0.9, 0.6, r#""rotation": 1.5707963"#), GREEN, "0.6"),
        (at(0.9, 0.6, r#""rotation": 1.5707963, "scale": [1, 0.5], "offset": [0.5, 0]"#), BLUE, "0.8"),
        (at(0.1, 0.5, r#""texCoord": 1"#), BLUE, "the second set"),
        (shown([[0.1, 0.5], [0.6, 0.5]], r#", "texCoord": 1"#, ""), GREEN, "the second set"),
    ];
    for (found, truth, what) in cases {
        assert!(found.distance(truth) < 1e-3, "{what}: {found} is not {truth}");
    }
}

/// Truth: glTF 2.0, section 3.8.4.5: at u = 1.375 a texture is again at 0.375, at its rim, or at
/// 0.625.
#[test]
fn textures_go_on_as_samplers_say() {
    for (sampler, truth) in [
        ("", RED),
        (r#""wrapS": 10497"#, RED),
        (r#""wrapS": 33071"#, BLUE),
        (r#""wrapS": 33648"#, GREEN),
        (r#""wrapT": 33648"#, RED),
    ] {
        let found = shown([[1.375, 0.5], [0.0, 0.0]], "", sampler);
        assert!(found.distance(truth) < 1e-3, "{sampler}: {found} is not {truth}");
    }
}

/// Truth: the colour looks at the red texel by the first set, the emission at the green one by the
/// second.
#[test]
fn emission_may_have_its_own_set() {
    let glows = r#", "emissiveFactor": [1, 1, 1], "emissiveTexture": {"index": 0, "texCoord": 1}"#;
    let scene = painted([[0.4, 0.5], [0.6, 0.5]], ["", "", glows]);
    let polygon = &scene.polygons[0];
    let surface = scene.surface(polygon);
    let glow = std::f32::consts::PI * Vec3::Y;
    assert!(surface.reflectance.distance(RED) < 1e-3 && surface.emission.distance(glow) < 1e-3, "{surface:?}");
    let shown = scene.surface_at(polygon, Vec3::new(0.5, 0.2, 0.0), surface, 1e-3).expect("no hole");
    assert!(shown.emission.distance(glow) < 1e-3, "in pictures too: {shown:?}");
}

/// Truth: the factor times the texture of the diffuse part; what stands beside it is for readers
/// that do not know the extension.
#[test]
fn specular_glossiness_has_a_diffuse_part() {
    let mut file = Gltf::square();
    let view = file.view(&picture([1, 1], ImageFormat::Png, |_, _| [255, 255, 0, 255]));
    let scene = load(
        &[(
            "a.glb",
            &file.file(&one_mesh(
                "",
                r#", "pbrMetallicRoughness": {"baseColorFactor": [0, 0, 0, 1]}, "extensions": {"KHR_materials_pbrSpecularGlossiness":
                    {"diffuseFactor": [0.2, 0.4, 0.6, 1], "diffuseTexture": {"index": 0}}}"#,
                &format!(
                    r#", "images": [{{"bufferView": {view}, "mimeType": "image/png"}}], "textures": [{{"source": 0}}],
                    "extensionsRequired": ["KHR_materials_pbrSpecularGlossiness"]"#
                ),
            )),
        )],
        "a.glb",
    );
    let found = scene.surface(&scene.polygons[0]).reflectance;
    assert!(found.distance(Vec3::new(0.2, 0.4, 0.0)) < 1e-4, "{found}");
    assert!(!notes(&scene).contains("not read"), "{}", notes(&scene));
}

/// A picture of 4 × 4 pixels in one red block (DXT1).
fn dds() -> Vec<u8> {
    let mut words = [0_u32; 32];
    words[0] = u32::from_le_bytes(*b"DDS ");
    // Size, flags, height, width, and bytes of the block.
    (words[1], words[2], words[3], words[4], words[5]) = (124, 0x8_1007, 4, 4, 8);
    (words[19], words[20], words[21], words[27]) = (32, 4, u32::from_le_bytes(*b"DXT1"), 0x1000);
    let head: Vec<u8> = words.iter().flat_map(|word| word.to_le_bytes()).collect();
    [&head[..], &[0x00, 0xf8, 0x00, 0xf8, 0, 0, 0, 0]].concat()
}

/// Truth: red, from a block of a DDS file, beside an OBJ file or in a glTF file; a JPEG of one
/// colour is at most two steps off.
#[test]
fn dds_and_jpeg() {
    let red = |scene: &Scene| {
        let found = scene.surface(&scene.polygons[0]).reflectance;
        assert!(found.distance(RED) < 1e-3, "{found}: {}", notes(scene));
    };
    let obj = format!("mtllib a.mtl\nusemtl red\n{CUBE}");
    let mtl = "newmtl red\nKd 0.5 0.5 0.5\nmap_Kd red.dds\n";
    red(&load(&[("a.obj", obj.as_bytes()), ("a.mtl", mtl.as_bytes()), ("red.dds", &dds())], "a.obj"));
    let mut file = Gltf::square();
    let view = file.view(&dds());
    let file = file.file(&one_mesh(
        "",
        r#", "pbrMetallicRoughness": {"baseColorFactor": [0.5, 0.5, 0.5, 1], "baseColorTexture": {"index": 0}}"#,
        &format!(
            r#", "extensionsUsed": ["MSFT_texture_dds"], "images": [{{"bufferView": {view}, "mimeType": "image/vnd-ms.dds"}}],
            "textures": [{{"extensions": {{"MSFT_texture_dds": {{"source": 0}}}}}}]"#
        ),
    ));
    red(&load(&[("a.glb", &file)], "a.glb"));

    let jpeg = picture([8, 8], ImageFormat::Jpeg, |_, _| [188, 188, 188, 255]);
    let mtl = "newmtl grey\nmap_Kd a.jpg\n";
    let obj = format!("mtllib a.mtl\nusemtl grey\n{CUBE}");
    let scene = load(&[("a.obj", obj.as_bytes()), ("a.mtl", mtl.as_bytes()), ("a.jpg", &jpeg)], "a.obj");
    let found = scene.surface(&scene.polygons[0]).reflectance;
    assert!((found - 0.5029).abs().max_element() < 0.012, "{found}");
}

/// Two squares; one looks at the left half of a texture, the other at the right half.
const HALVES: &str = "mtllib a.mtl\nusemtl leaf\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\n\
    vt 0.1 0\nvt 0.4 0\nvt 0.4 1\nvt 0.1 1\nvt 0.6 0\nvt 0.9 0\nvt 0.9 1\nvt 0.6 1\n\
    f 1/1 2/2 3/3 4/4\nf 5/5 6/6 7/7 8/8\n";

/// Truth: the left half of the picture hides everything, the right half nothing; its values are its
/// brightness, or its alpha where it has any. The colour's own alpha does not count.
#[test]
fn opacity_has_a_texture_of_its_own() {
    let half =
        |left: [u8; 4], right: [u8; 4]| picture([8, 1], ImageFormat::Png, move |x, _| if x < 4 { left } else { right });
    let colour = half([255, 0, 0, 0], [255, 0, 0, 0]);
    for mask in [half([255; 4], [0, 0, 0, 255]), half([0, 0, 0, 255], [0, 0, 0, 0])] {
        let mtl = "newmtl leaf\nKd 0.5 0.5 0.5\nmap_Kd colour.png\nmap_d mask.png\n";
        let files =
            [("a.obj", HALVES.as_bytes()), ("a.mtl", mtl.as_bytes()), ("colour.png", &colour), ("mask.png", &mask)];
        let scene = load(&files, "a.obj");
        assert_eq!((scene.polygons.len(), scene.skipped.transparent_faces), (1, 1), "{}", notes(&scene));
        assert_eq!(scene.bounds().1.z, 0.0, "the left one stays");
        let found = scene.surface(&scene.polygons[0]).reflectance;
        assert!(found.distance(RED) < 1e-3, "{found}");
        let plain = mtl.replace("map_Kd colour.png\n", "");
        let files = [("a.obj", HALVES.as_bytes()), ("a.mtl", plain.as_bytes()), ("mask.png", &mask)];
        assert_eq!(load(&files, "a.obj").skipped.transparent_faces, 1);
    }
    let gone = load_obj(HALVES, "newmtl leaf\nmap_d mask.png\n");
    assert_eq!(gone.polygons.len(), 2);
    assert!(
        notes(&gone).contains("The opacity texture `mask.png` is not used: there is no such file"),
        "{}",
        notes(&gone)
    );
}

/// What a point of the square between (0, 0) and (1, 1) shows; `None` in a hole.
fn at(scene: &Scene, x: f32, y: f32) -> Option<Vec3> {
    let point = Vec3::new(x, y, 0.0);
    // Of two triangles the one that holds the point.
    let holds = |polygon: &&Polygon| {
        let (corners, count) = scene.corner_positions(polygon);
        let middle = corners[..count].iter().sum::<Vec3>() / count as f32;
        count == 4 || (middle.y > middle.x) == (y > x)
    };
    let polygon = scene.polygons.iter().find(holds).expect("a square");
    scene.surface_at(polygon, point, scene.surface(polygon), 1e-3).map(|surface| surface.reflectance)
}

/// Truth: by hand. The left half of the mask is white, of the rest one half is black; there is a
/// hole, whatever the colour's own alpha says, and the factor `d` counts with it. A word of a
/// person closes it.
#[test]
fn pictures_have_holes_where_the_opacity_texture_has() {
    let square = "mtllib a.mtl\nusemtl leaf\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n\
        f 1/1 2/2 3/3 4/4\n";
    let level = |x: u32| [255, 255, 255, 255, 160, 160, 0, 0][x as usize];
    let mask = picture([8, 1], ImageFormat::Png, |x, _| [level(x), level(x), level(x), 255]);
    let colour = picture([1, 1], ImageFormat::Png, |_, _| [255, 0, 0, 0]);
    for (map, truth) in [("map_Kd colour.png\n", RED), ("", Vec3::splat(0.5))] {
        let shown = |dissolve: &str, said: &str| {
            let mtl = format!("newmtl leaf\nKd 0.5 0.5 0.5\n{dissolve}{map}map_d mask.png\n");
            let files = [("a.obj", square.as_bytes()), ("a.mtl", mtl.as_bytes()), ("mask.png", &mask)];
            let beside = [("colour.png", &colour[..]), ("a.selflink.json", said.as_bytes())];
            let scene = load(&[&files[..], &beside].concat(), "a.obj");
            [0.25, 0.69, 0.9].map(|x| at(&scene, x, 0.5))
        };
        let is = |found: Option<Vec3>| found.is_some_and(|found| found.distance(truth) < 1e-3);
        assert_eq!(shown("", "{}").map(is), [true, true, false], "{map}");
        assert_eq!(shown("", "{}")[2], None, "{map}");
        assert_eq!(shown("d 0.78\n", "{}").map(is), [true, false, false], "0.78 × 160 / 255 < ½ {map}");
        let opaque = r#"{"materials": {"leaf": {"opaque": true}}}"#;
        assert_eq!(shown("", opaque).map(is), [true; 3], "{map}");
    }
}

/// Truth: glTF 2.0, sections 3.7.2.1 and 3.9.4: alpha of the corners, from 1 on the left to ¼ on
/// the right, times that of the factor, 0.8, times that of the texture, 1 below and ½ above; the
/// cutoff is 0.3. Neither counts where alpha has no meaning.
#[test]
fn masks_of_pictures_heed_corners_factor_and_texture() {
    let scene = |mode: &str, textured: bool| {
        let mut file = Gltf::square();
        let colours = [1.0, 0.25, 0.25, 1.0].map(|alpha| [1.0, 1.0, 1.0, alpha]);
        let colours = file.floats::<4>(&colours);
        let uvs = file.floats::<2>(&[[0.0, 1.0], [1.0, 1.0], [1.0, 0.0], [0.0, 0.0]]);
        let alpha = |y: u32| if y < 2 { 128 } else { 255 };
        let view = file.view(&picture([1, 4], ImageFormat::Png, |_, y| [255, 255, 255, alpha(y)]));
        let map = if textured { r#", "baseColorTexture": {"index": 0}"# } else { "" };
        let material = format!(
            r#", "alphaMode": "{mode}", "alphaCutoff": 0.3, "pbrMetallicRoughness": {{"baseColorFactor": [0.5, 0.5, 0.5, 0.8]{map}}}"#
        );
        let image = format!(
            r#", "images": [{{"bufferView": {view}, "mimeType": "image/png"}}], "textures": [{{"source": 0}}]"#
        );
        let rest = one_mesh(&format!(r#", "COLOR_0": {colours}, "TEXCOORD_0": {uvs}"#), &material, &image);
        load(&[("a.glb", &file.file(&rest))], "a.glb")
    };
    // Alpha is 1 − ¾ x: the mask ends at x = 5/6, and where the texture halves it at x = ⅓.
    let places = [(0.3, 0.25), (0.8, 0.25), (0.9, 0.25), (0.3, 0.75), (0.4, 0.75), (0.9, 0.75)];
    let is_there = |mode: &str, textured: bool| {
        let scene = scene(mode, textured);
        places.map(|(x, y)| at(&scene, x, y).is_some())
    };
    assert_eq!(is_there("MASK", true), [true, true, false, true, false, false]);
    assert_eq!(is_there("MASK", false), [true, true, false, true, true, false]);
    assert_eq!(is_there("OPAQUE", true), [true; 6]);
    assert_eq!(is_there("OPAQUE", false), [true; 6]);
}

/// Truth: by the words of the settings file as people write them.
#[test]
fn a_word_in_the_settings_file_makes_opaque() {
    let folder = Folder::new();
    folder.write("a.mtl", "newmtl leaf\nd 0.1\n");
    let path = folder.write("a.obj", HALVES);
    folder.write("a.selflink.json", r#"{"materials": {"leaf": {"opaque": true}}}"#);
    assert_eq!(load_file(&path).expect("a sound scene").polygons.len(), 2);
    folder.write("a.selflink.json", r#"{"materials": {"leaf": {"opaque": false}}}"#);
    assert!(load_file(&path).is_err(), "nothing is left");
}

/// Truth: most materials say 1 − `Tr` = `d`; of the one that does not `d` counts.
#[test]
fn d_counts_where_tr_says_something_else() {
    let mtl = "newmtl leaf\nd 1\nTr 0.9\nnewmtl other\nd 0.25\nTr 0.75\n";
    let scene = load_obj(HALVES, mtl);
    assert_eq!(scene.polygons.len(), 2);
    assert!(notes(&scene).contains("`d` counts where `Tr` says something else (1 "), "{}", notes(&scene));
}
