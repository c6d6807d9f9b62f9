//! Loading OBJ, glTF, GLB, PLY and STL scenes with their sidecars: what comes in, what is left out,
//! and that both are said.

#[path = "support/left_out.rs"]
mod left_out;
mod support;

use std::f32::consts::PI;
use std::path::PathBuf;

use glam::{DVec3, Vec3};
use selflink::scene::{CameraPose, MaterialId, Scene, Sidecar, Sides, load_file, write_obj};
use support::{Folder, glb, square_bytes, square_json};

/// Loads one OBJ text, with an MTL text where that is not empty.
fn load_obj(obj: &str, mtl: &str) -> Scene {
    let folder = Folder::new();
    if !mtl.is_empty() {
        folder.write("scene.mtl", mtl);
    }
    load_file(&folder.write("scene.obj", obj)).expect("a sound scene")
}

fn load_square_glb(rest: &str) -> Scene {
    let folder = Folder::new();
    load_file(&folder.write("scene.glb", glb(&square_json(rest), &square_bytes()))).expect("a sound scene")
}

fn total_area(scene: &Scene) -> f32 {
    scene.polygons.iter().map(|polygon| scene.area(polygon)).sum()
}

fn close(a: Vec3, b: Vec3) -> bool {
    a.distance(b) <= 1e-5 * b.length().max(1.0)
}

const SQUARE: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

#[test]
fn quads_stay_quads_and_larger_polygons_become_triangles() {
    // A quad, a concave L of area 3, a slightly warped pentagon and a strongly warped quad.
    let scene = load_obj(
        "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n\
         v 0 0 1\nv 2 0 1\nv 2 1 1\nv 1 1 1\nv 1 2 1\nv 0 2 1\nf 5 6 7 8 9 10\n\
         v 0 0 2\nv 2 0 2\nv 3 1 2.01\nv 1 2 2\nv 0 1 2\nf -5 -4 -3 -2 -1\n\
         v 0 0 3\nv 1 0 3\nv 1 1 3\nv 0 1 3.5\nf -4 -3 -2 -1\n",
        "",
    );
    assert_eq!(scene.polygons.iter().filter(|polygon| polygon.is_quad()).count(), 1);
    assert_eq!(scene.polygons.len(), 1 + 4 + 3 + 2);
    assert_eq!(scene.skipped.triangulated_polygons, 3);
    let of_the_l: f32 = scene.polygons[1..5].iter().map(|polygon| scene.area(polygon)).sum();
    assert!((of_the_l - 3.0).abs() < 1e-6, "shoelace area of the L: {of_the_l}");
    assert!(scene.polygons.iter().all(|polygon| scene.normal(polygon).z > 0.8), "windings are kept");
}

#[test]
fn names_are_paths_and_faces_of_one_name_belong_together() {
    let scene = load_obj(
        &format!(
            "{SQUARE}v 0 0 1\nv 0 0 2\nv 0 1 2\n\
             f 1 2 3\no office/desk_2/lamp\nf 1 3 4\ng office/desk\nusemtl a\nf 5 6 7\n  o office//desk_2/lamp\nusemtl b\nf 1 2 5\n\
             g office/desk_2\nf 2 3 6\n"
        ),
        "",
    );
    let paths: Vec<String> = scene.polygons.iter().map(|polygon| scene.group_path(polygon.group)).collect();
    assert_eq!(paths, ["", "office/desk_2/lamp", "office/desk", "office/desk_2/lamp", "office/desk_2"]);
    assert_eq!(scene.polygons[1].group, scene.polygons[3].group);
    assert_eq!(scene.groups.len(), 5, "root, office, desk_2, lamp and desk");
    for (index, group) in scene.groups.iter().enumerate() {
        assert_eq!(group.parent.is_none(), index == 0);
        assert!(group.parent.is_none_or(|parent| (parent.0 as usize) < index), "parents precede children");
    }
}

/// Truth: the conventions Kd = ρ and B_e = π·Ke.
#[test]
fn materials_follow_the_mtl_file() {
    let scene = load_obj(
        &format!(
            "mtllib scene.mtl\r\n{}usemtl room:wall paint\r\nf 1 2 3\r\nusemtl lamp\r\nf 1 3 4 # the lamp\r\n\
             usemtl mirror\r\nf 1 2 4\r\nusemtl glass\r\nf 2 3 4\r\nusemtl pane\r\nf 4 3 2\r\n\tusemtl   ghost\r\nf 4 3 1\r\n",
            SQUARE.replace('\n', "\r\n")
        ),
        "\r\nnewmtl room:wall paint\r\n\tKd 0.1 0.2 0.3 # blue\r\nNs 10\r\nnewmtl lamp\r\nKd 0 0 0\r\nKe 17 12 4\r\nnewmtl mirror\r\nKd 1 1 -0.5\r\n\
         newmtl glass\r\nKd 1 1 1\r\nd 0.4\r\nnewmtl pane\r\nTr 0.9\r\nnewmtl unused\r\nKd 0 0\r\n",
    );
    let [wall, lamp, mirror] = ["room:wall paint", "lamp", "mirror"].map(|name| {
        let MaterialId(index) = scene.material_named(name).expect("a material of the file");
        &scene.materials[index as usize]
    });
    assert!(close(wall.reflectance, Vec3::new(0.1, 0.2, 0.3)) && wall.emission == Vec3::ZERO);
    assert!(close(lamp.emission, PI * Vec3::new(17.0, 12.0, 4.0)));
    assert_eq!(mirror.reflectance, Vec3::new(0.95, 0.95, 0.0));
    let ghost = &scene.materials[scene.polygons[3].material.0 as usize];
    assert_eq!((ghost.name.as_str(), ghost.reflectance), ("ghost", Vec3::splat(0.5)));
    assert_eq!(scene.skipped.clamped_materials, 1);
    assert_eq!(scene.skipped.transparent_faces, 2);
    assert_eq!(scene.skipped.faces_without_material, 1);
    let said = scene.skipped.sentences().join(" ");
    assert!(
        said.contains("`ghost`") && said.contains("Line 16 of the material file `scene.mtl` is not understood"),
        "{said}"
    );
}

#[test]
fn a_missing_material_file_gives_grey_and_says_so() {
    let scene = load_obj(&format!("mtllib gone.mtl\nmtllib ../secret.mtl\n{SQUARE}usemtl red\nf 1 2 3 4\n"), "");
    assert_eq!(scene.materials[0].reflectance, Vec3::splat(0.5));
    assert_eq!(scene.materials[0].name, "red");
    assert_eq!(scene.skipped.faces_without_material, 1);
    let said = scene.skipped.sentences().join(" ");
    for part in ["gone.mtl", "../secret.mtl` lies outside", "`red`"] {
        assert!(said.contains(part), "{part}: {said}");
    }
}

/// Truth: sRGB 188 is linear 0.5029, times Kd 0.5.
#[test]
fn textures_count_as_their_mean_colour() {
    let folder = Folder::new();
    let path = folder.path("maps/grey wall.png");
    std::fs::create_dir_all(folder.path("maps")).expect("a writable folder");
    image::RgbImage::from_pixel(3, 2, image::Rgb([188; 3])).save(path).expect("a written image");
    folder.write(
        "room.mtl",
        "newmtl a\nKd 0.5 0.5 0.5\nmap_Kd -s 2 2 2 maps\\grey wall.png\nnewmtl b\nKd 0.5 0.5 0.5\nmap_Kd gone.png\n\
         newmtl c\nmap_Kd ../../out.png\n",
    );
    let obj = format!("mtllib room.mtl\n{SQUARE}usemtl a\nf 1 2 3\nusemtl b\nf 1 3 4\nusemtl c\nf 1 2 4\n");
    let scene = load_file(&folder.write("room.obj", obj)).expect("a sound scene");
    assert!((scene.materials[0].reflectance.x - 0.2514).abs() < 1e-3, "{}", scene.materials[0].reflectance);
    assert_eq!(scene.materials[1].reflectance, Vec3::splat(0.25), "a grey of one half stands for it");
    let notes = scene.skipped.sentences().join(" ");
    assert!(notes.contains("`gone.png` is not used") && notes.contains("`../../out.png` is not used"), "{notes}");
}

#[test]
fn faces_without_area_and_repeated_faces_are_left_out_but_not_backs() {
    let scene = load_obj(
        &format!(
            "{SQUARE}v 0.5 0 0\nv 0 0 0\nf 1 2 3 4\nf 3 4 1 2\nf 4 3 2 1\nf 6 2 3 4\nf 1 2 2\nf 1 5 2\nf 1 6 2\nf 1 2 3 3\nf 2 3 1\n\
             l 1 2 3\np 1\nf 1 2\n"
        ),
        "",
    );
    assert_eq!(scene.skipped.degenerate_faces, 3);
    assert_eq!(scene.skipped.duplicate_faces, 3, "rotated, by an equal vertex, and a triangle");
    let corner_counts: Vec<usize> = scene.polygons.iter().map(|polygon| polygon.corners().len()).collect();
    assert_eq!(corner_counts, [4, 4, 3], "a quad, its back, and the triangle that a doubled corner leaves");
    assert_eq!(scene.vertices.len(), 5, "equal positions are one vertex");
    assert_eq!(scene.skipped.lines_and_points, 3);
}

#[test]
fn lines_that_trip_parsers_are_read() {
    let scene = load_obj(
        "\u{feff}# Latin-1 and more\n  v 0 0 0 1.0\nv\t1 0 0 0.1 0.2 0.3\nv 1 1 \\\n 0\nvt 0 0\nvn 0 0 1\nf 1/1/1 2//1 \\\n3/99999999999/1 4\nv 0 1 0\n\
         s off\nweird words\n",
        "",
    );
    assert_eq!(scene.polygons.len(), 1);
    assert!((total_area(&scene) - 1.0).abs() < 1e-6, "weights and colours are not coordinates");
    let folder = Folder::new();
    let latin = [b"o caf\xe9\n", SQUARE.as_bytes(), b"f 1 2 3 4\n"].concat();
    assert!(load_file(&folder.write("latin.obj", latin)).is_ok());
}

#[test]
fn the_sidecar_decides_over_the_file() {
    let folder = Folder::new();
    folder.write(
        "room.mtl",
        "newmtl wall\nKd 1 1 1\nnewmtl lamp\nKe 1 1 1\nnewmtl pane\nKd 0.5 0.5 0.5\nnewmtl spare\nKd 0 0 0\n",
    );
    let obj = format!(
        "mtllib room.mtl\n{SQUARE}usemtl wall\nf 1 2 3\nusemtl lamp\nf 1 3 4\nusemtl pane\nf 1 2 4\nusemtl new\nf 4 2 1\n"
    );
    let path = folder.write("room.obj", obj);
    folder.write(
        "room.selflink.json",
        r#"{"materials": {"wall": {"reflectance": [0.99, 0, 0.5]}, "lamp": {"emission": [1, 2, 3]}, "pane": {"ignore": true},
            "new": {"reflectance": [0.1, 0.1, 0.1]}, "spare": {}, "typo": {}},
            "sides": "auto", "camera": {"eye": [0, 0, 5], "target": [0, 0, 0], "up": [0, 1, 0], "hfov_deg": 50}}"#,
    );
    let scene = load_file(&path).expect("a sound scene");
    assert_eq!(scene.materials[0].reflectance, Vec3::new(0.99, 0.0, 0.5));
    assert_eq!(scene.materials[1].emission, Vec3::new(1.0, 2.0, 3.0));
    assert_eq!((scene.skipped.ignored_faces, scene.skipped.clamped_materials), (1, 0));
    assert_eq!(scene.skipped.faces_without_material, 0, "the sidecar defines it");
    assert_eq!(scene.sides, Sides::Auto);
    assert_eq!(scene.camera.map(|camera| camera.hfov_deg), Some(50.0));
    let notes = scene.skipped.notes.join(" ");
    assert!(notes.contains("`typo`") && !notes.contains("spare"), "{notes}");
}

/// Truth: what is written is read back equal.
#[test]
fn a_sidecar_written_is_read_back() {
    let folder = Folder::new();
    let path = folder.write("room.obj", format!("{SQUARE}usemtl a\nf 1 2 3\nusemtl b:1\nf 1 3 4\n"));
    let mut scene = load_file(&path).expect("a sound scene");
    scene.set_emission("b:1", Vec3::new(1.0, 0.3, 7.7)).expect("a known material");
    scene.sides = Sides::Both;
    scene.camera = Some(CameraPose { eye: Vec3::Z, target: Vec3::ZERO, up: Vec3::Y, hfov_deg: 47.5 });
    let mut sidecar = Sidecar::of(&scene);
    sidecar.materials.entry("pane".to_owned()).or_default().ignore = true;
    sidecar.update(&scene);
    assert!(sidecar.materials["pane"].ignore, "what the scene cannot know is kept");
    sidecar.write(&Sidecar::path_for(&path)).expect("a writable folder");
    assert_eq!(Sidecar::read(&Sidecar::path_for(&path)).expect("what was written"), sidecar);
    let again = load_file(&path).expect("a sound scene");
    assert_eq!((again.materials, again.sides, again.camera), (scene.materials, scene.sides, scene.camera));
}

/// Truth: a person's own file. What a scene has as its file states it needs no sidecar, and what a
/// sidecar says stays.
#[test]
fn a_sidecar_holds_only_what_was_changed_and_keeps_what_it_said() {
    let folder = Folder::new();
    folder.write("room.mtl", "newmtl a\nKd 0.5 0.4 0.3\nnewmtl b\nKd 1 1 1\nnewmtl c\nKd 0.1 0.1 0.1\n");
    let faces = "usemtl a\nf 1 2 3\nusemtl b\nf 1 3 4\nusemtl c\nf 1 2 4\n";
    let path = folder.write("room.obj", format!("mtllib room.mtl\n{SQUARE}{faces}"));
    let mut scene = load_file(&path).expect("a sound scene");
    assert_eq!(Sidecar::of(&scene), Sidecar::default(), "nothing was changed, clamped values included");
    scene.set_emission("a", Vec3::ONE).expect("a known material");
    let sidecar = Sidecar::of(&scene);
    assert_eq!(sidecar.materials.keys().collect::<Vec<_>>(), ["a"]);
    assert_eq!((sidecar.materials["a"].reflectance, sidecar.sides), (None, None));

    let by_hand =
        r#"{"materials": {"c": {"reflectance": [0.1, 0.1, 0.1]}, "pane": {"ignore": true}}, "sides": "front"}"#;
    let sidecar_path = folder.write("room.selflink.json", by_hand);
    let mut merged = Sidecar::read(&sidecar_path).expect("a good sidecar");
    let before = merged.clone();
    merged.update(&load_file(&path).expect("a sound scene"));
    assert_eq!(merged, before);

    let mut permissions = std::fs::metadata(&sidecar_path).expect("it is there").permissions();
    permissions.set_readonly(true);
    std::fs::set_permissions(&sidecar_path, permissions).expect("our own file");
    let sentence = sidecar.write(&sidecar_path).expect_err("a protected file").to_string();
    assert!(sentence.contains("room.selflink.json: is read-only"), "{sentence}");
    assert_eq!(std::fs::read_to_string(&sidecar_path).expect("it is still there"), by_hand);
}

/// Truth: a light that was added is in no scene file, so the sidecar alone brings it back, with
/// what was changed of it.
#[test]
fn ceiling_lights_come_back_by_the_sidecar() {
    let folder = Folder::new();
    let path = folder.write("room.obj", format!("{SQUARE}usemtl a\nf 1 2 3\n"));
    let mut scene = load_file(&path).expect("a sound scene");
    for (height, exitance) in [(0.9, 50.0), (0.8, 20.0)] {
        let centre = Vec3::new(0.3, height, 0.1);
        scene.add_ceiling_light(centre, Vec3::Y, 0.2, Vec3::splat(exitance)).expect("a good light");
    }
    scene.set_emission("ceiling light 2", Vec3::new(1.0, 2.0, 3.0)).expect("the second light's own name");
    let sidecar_path = Sidecar::path_for(&path);
    Sidecar::of(&scene).write(&sidecar_path).expect("a writable folder");
    let again = load_file(&path).expect("a sound scene");
    assert!(again.has_light());
    assert_eq!(again.skipped, scene.skipped, "the sidecar speaks of nothing that is not there");
    assert_eq!((&again.materials, &again.placed_luminaires), (&scene.materials, &scene.placed_luminaires));
    assert_eq!(again.emitted_power(), scene.emitted_power());
    assert_eq!(Sidecar::of(&again), Sidecar::of(&scene), "saving again changes nothing");

    // As it was written before there were other luminaires.
    folder.write(
        "room.selflink.json",
        r#"{"ceiling_lights": [{"centre": [0.3, 0.9, 0.1], "up": [0, 1, 0], "size": 0.2, "exitance": [50, 50, 50]},
            {"centre": [0.3, 0.8, 0.1], "up": [0, 1, 0], "size": 0.2, "exitance": [1, 2, 3]}]}"#,
    );
    let old = load_file(&path).expect("a sound scene");
    assert_eq!((&old.materials, &old.placed_luminaires), (&scene.materials, &scene.placed_luminaires));

    let bad = [
        (r#""centre": [0, 0, 0], "up": [0, 0, 0], "size": 1, "exitance": [1, 1, 1]"#, "no direction"),
        (r#""centre": [0, 0, 0], "up": [0, 1, 0], "size": -1, "exitance": [1, 1, 1]"#, "size greater than 0"),
        (r#""centre": [0, 0, 0], "up": [0, 1, 0], "size": 1, "exitance": [1, -1, 1]"#, "exitance"),
        (r#""centre": [0, 0, 0], "up": [0, 1, 0], "size": 1"#, "exitance"),
    ];
    for (light, part) in bad {
        folder.write("room.selflink.json", format!(r#"{{"ceiling_lights": [{{{light}}}]}}"#));
        let sentence = load_file(&path).expect_err("a bad light").to_string();
        assert!(sentence.contains(part) && sentence.contains("room.selflink.json"), "{sentence}");
    }
}

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

/// The folder of larger scenes.
fn scenes() -> Option<PathBuf> {
    let folder = std::env::var_os("SELFLINK_SCENES").map(PathBuf::from);
    if folder.is_none() {
        left_out::left_out("real scenes; set SELFLINK_SCENES to their folder");
    }
    folder
}

/// Truth: the counts in the descriptions beside the scenes, made by another program.
#[test]
fn real_scenes_have_the_counts_that_their_descriptions_give() {
    let Some(folder) = scenes() else { return };
    // File, faces, quads that stay, degenerate, listed twice.
    let known = [
        ("cornell-box/CornellBox-Original.obj", 16, 16, 0, 0),
        ("cornell-box/CornellBox-Sphere.obj", 2188, 0, 0, 0),
        ("cornell-box/CornellBox-bevy.glb", 36, 0, 0, 0),
        ("veach-ajar/veach-ajar.obj", 130_593, 1, 62, 13),
        ("fireplace-room/fireplace-room.obj", 143_169, 4, 190, 0),
        ("classroom/classroom.glb", 583_937, 0, 98, 0),
    ];
    for (file, faces, quads, degenerate, duplicate) in known {
        let scene = load_file(&folder.join(file)).expect("a sound scene");
        let skipped = &scene.skipped;
        assert_eq!((skipped.degenerate_faces, skipped.duplicate_faces), (degenerate, duplicate), "{file}");
        assert_eq!(scene.polygons.len() + degenerate + duplicate + skipped.ignored_faces, faces, "{file}");
        assert_eq!(scene.polygons.iter().filter(|polygon| polygon.is_quad()).count(), quads, "{file}");
        assert!(scene.has_light() && scene.camera.is_some(), "{file}");
        assert_eq!(skipped.notes, Vec::<String>::new(), "{file}");
    }
}

/// Truth: the descriptions beside the scenes, made by another program: all that is seen from inside
/// faces the viewer.
#[test]
fn well_wound_real_scenes_have_no_face_seen_from_behind() {
    let Some(folder) = scenes() else { return };
    for file in ["CornellBox-Original.obj", "CornellBox-Sphere.obj", "CornellBox-bevy.glb"] {
        let scene = load_file(&folder.join("cornell-box").join(file)).expect("a sound scene");
        let (front, _) = selflink::geometry::orient::apply(scene.clone(), Sides::Front);
        assert_eq!(front.skipped.faces_seen_from_behind, 0, "{file}");
        let (turned, _) = selflink::geometry::orient::apply(scene, Sides::Auto);
        assert_eq!(turned.polygons, front.polygons, "{file}");
    }
}

/// A room of 5 × 3 × 4 m with a lamp and no corner on a round number, moved by so much in x and z.
fn room_at(far: f64) -> String {
    let corner = |x: f64, y: f64, z: f64| format!("v {} {} {}\n", x + 0.3 + far, y, z + 0.1 + far);
    let box_corners = [0, 1, 2, 3].map(|index| {
        let (x, y) = ([0.0, 5.0, 5.0, 0.0][index], [0.0, 0.0, 3.0, 3.0][index]);
        [corner(x, y, 0.0), corner(x, y, 4.0)]
    });
    let corners: String = [0, 1].iter().flat_map(|side| box_corners.iter().map(|pair| pair[*side].clone())).collect();
    let lamp = [[2.0, 1.5], [3.0, 1.5], [3.0, 2.5], [2.0, 2.5]].map(|[x, z]| corner(x, 2.9, z)).concat();
    format!(
        "mtllib r.mtl\n{corners}{lamp}usemtl wall\nf 1 2 3 4\nf 6 5 8 7\nf 5 1 4 8\nf 2 6 7 3\nf 5 6 2 1\nf 4 3 7 8\n\
         usemtl lamp\nf 9 10 11 12\n"
    )
}

/// Truth: the same room at the origin. f64 tells 10⁻⁷ at a distance of 10⁹; f32 would tell 0.06 m
/// at 1,000 km.
#[test]
fn rooms_far_off_keep_their_shape() {
    let folder = Folder::new();
    folder.write("r.mtl", "newmtl wall\nKd .7 .7 .7\nnewmtl lamp\nKd 0 0 0\nKe 30 30 30\n");
    let load = |far: f64| load_file(&folder.write("room.obj", room_at(far))).expect("a sound scene");
    let near = load(0.0);
    assert_eq!(near.origin, DVec3::ZERO);
    for far in [16_000.0, 262_144.0, 1e6, 1e9] {
        let scene = load(far);
        assert_eq!(scene.origin, DVec3::new(far, 0.0, far));
        for (vertex, truth) in scene.vertices.iter().zip(&near.vertices) {
            assert!(vertex.distance(*truth) < 1e-6, "at {far}: {vertex} instead of {truth}");
        }
        assert!(scene.skipped.sentences().is_empty(), "{:?}", scene.skipped.sentences());
    }
}

/// Truth: what a scene says of places is in its file's coordinates: as a sidecar says it, and as it
/// is written.
#[test]
fn cameras_and_lights_speak_the_files_coordinates() {
    let folder = Folder::new();
    folder.write("r.mtl", "newmtl wall\nKd .7 .7 .7\nnewmtl lamp\nKd 0 0 0\nKe 30 30 30\n");
    folder.write(
        "room.selflink.json",
        r#"{"camera": {"eye": [1000001.25, 1.5, 1000003.1], "target": [1000002, 1, 1000001], "up": [0, 1, 0], "hfov_deg": 50},
            "ceiling_lights": [{"centre": [1000002.8, 2.5, 1000002.1], "up": [0, 1, 0], "size": 0.5, "exitance": [9, 9, 9]}]}"#,
    );
    let path = folder.write("room.obj", room_at(1e6));
    let scene = load_file(&path).expect("a sound scene");
    let camera = scene.camera.expect("a camera");
    assert!(close(camera.eye, Vec3::new(1.25, 1.5, 3.1)) && close(camera.target, Vec3::new(2.0, 1.0, 1.0)));
    assert!(close(scene.placed_luminaires[0].form.centre, Vec3::new(2.8, 2.5, 2.1)), "{:?}", scene.placed_luminaires);
    let said = Sidecar::of(&scene);
    let eye = said.camera.expect("a camera").eye;
    assert!(eye.distance(DVec3::new(1_000_001.25, 1.5, 1_000_003.1)) < 1e-6, "{eye}");
    assert!(said.luminaires[0].centre.distance(DVec3::new(1_000_002.8, 2.5, 1_000_002.1)) < 1e-6);
    let again = load_file(&write_obj(&scene, folder.path("again").as_path()).expect("a writable folder"));
    let again = again.expect("a sound scene");
    assert_eq!((again.origin, again.camera), (scene.origin, scene.camera));
    let lost = scene.vertices.iter().zip(&again.vertices).map(|(one, other)| one.distance(*other)).fold(0.0, f32::max);
    assert!(lost < 1e-6, "{lost}");
}

/// Truth: a node's translation is f64, so a mesh near its own zero keeps its shape wherever it is
/// put; positions of f32 that lie far off are rounded, which is said.
#[test]
fn glb_keeps_its_shape_far_off_or_says_that_the_file_has_not() {
    let node = r#""scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0, "translation": [1000000.3, 0, 262144.1]}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}]"#;
    let scene = load_square_glb(node);
    assert!((total_area(&scene) - 1.0).abs() < 1e-6, "{} m²", total_area(&scene));
    let (lower, _) = scene.bounds();
    let corner = scene.to_file(lower);
    assert!(corner.distance(DVec3::new(1_000_000.3, 0.0, 262_144.1)) < 1e-5, "{corner}");
    let said = |shift: f32| {
        let folder = Folder::new();
        let mut bytes = square_bytes();
        for corner in 0..4 {
            let place = 12 * corner..12 * corner + 4;
            let x = f32::from_le_bytes([0, 1, 2, 3].map(|byte| bytes[place.start + byte]));
            bytes[place].copy_from_slice(&(0.3 * x + shift).to_le_bytes());
        }
        let json = square_json(
            r#""scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
            "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}]"#,
        );
        let scene = load_file(&folder.write("scene.glb", glb(&json, &bytes))).expect("a sound scene");
        scene.skipped.notes.iter().filter(|note| note.contains("lost the shape")).count()
    };
    assert_eq!((said(0.1), said(1000.1), said(262_144.1)), (0, 0, 1));
}
