//! Whatever is left out is reported once, with what to do.

use glam::Vec3;
use selflink::scene::{Sidecar, UnreadExtension, load_file};

use crate::builder::{Gltf, one_mesh};
use crate::support::Folder;
use crate::{CUBE, load, load_obj, notes};

/// Truth: each extension is in one sentence, whether the file needs it or uses it, and none that
/// changes nothing here is in any.
#[test]
fn extensions_that_are_not_read_are_said_once() {
    let used = r#", "extensionsRequired": ["ACME_shine", "KHR_materials_clearcoat"],
        "extensionsUsed": ["ACME_shine", "ACME_words", "KHR_materials_variants", "EXT_lights_image_based", "KHR_materials_clearcoat",
            "KHR_materials_ior", "KHR_xmp_json_ld", "KHR_materials_unlit"]"#;
    let scene = load(&[("a.glb", &Gltf::square().file(&one_mesh("", "", used)))], "a.glb");
    let said = notes(&scene);
    for (name, advice) in [
        ("ACME_shine", "export it without `ACME_shine`"),
        ("ACME_words", "not read: `ACME_words`."),
        ("KHR_materials_variants", "the default is shown"),
        ("EXT_lights_image_based", "`--sky PICTURE`"),
        ("KHR_materials_unlit", "lit as others are"),
    ] {
        assert!(said.matches(name).count() == 1 && said.contains(advice), "{name}: {said}");
    }
    assert!(!said.contains("clearcoat") && !said.contains("ior") && !said.contains("xmp"), "{said}");
    let unread = &scene.skipped.unread_extensions;
    let names: Vec<(&str, bool)> =
        unread.iter().map(|UnreadExtension { name, is_required, .. }| (name.as_str(), *is_required)).collect();
    assert_eq!(
        names,
        [
            ("ACME_shine", true),
            ("ACME_words", false),
            ("KHR_materials_variants", false),
            ("EXT_lights_image_based", false),
            ("KHR_materials_unlit", false)
        ]
    );
}

#[test]
fn numbers_of_64_bits_are_refused_in_a_sentence() {
    let mut file = Gltf::square();
    let positions = file.accessor(&[0; 96], 5130, 4, "VEC3", "");
    let folder = Folder::new();
    let path = folder.write(
        "a.glb",
        file.file(&format!(
            r#""extensionsUsed": ["KHR_accessor_float64"], "meshes": [{{"primitives": [{{"attributes": {{"POSITION": {positions}}}}}]}}],
            "nodes": [{{"mesh": 0}}], "scenes": [{{"nodes": [0]}}]"#
        )),
    );
    let said = load_file(&path).expect_err("64 bits").to_string();
    assert!(said.contains("64 bits (KHR_accessor_float64)") && said.contains("export it with 32 bits"), "{said}");
}

#[test]
fn geometry_that_obj_files_bring_in_other_ways_is_counted() {
    let scene = load_obj(&format!("{CUBE}bzp 1 2 3 4 5 6 7 8 1 2 3 4 5 6 7 8\ncdc 1 2 3 4\ncall chair.obj\n"), "");
    assert_eq!(scene.skipped.curves_and_surfaces, 2);
    assert!(notes(&scene).contains("not read (`call`, 1); export it as one file"), "{}", notes(&scene));
}

/// Truth: of two lights of one name, and two materials, each is dimmed and painted by itself, and
/// comes back so by the settings file; a light's range is in metres.
#[test]
fn what_has_one_name_is_told_apart() {
    let folder = Folder::new();
    let file = Gltf::square().file(
        r#""extensionsUsed": ["KHR_lights_punctual"],
        "extensions": {"KHR_lights_punctual": {"lights": [{"name": "Light", "type": "point", "intensity": 10, "range": 500},
            {"name": "Light", "type": "point", "intensity": 20}]}},
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1, "material": 0},
            {"attributes": {"POSITION": 0}, "indices": 1, "material": 1, "mode": 4}]},
            {"primitives": [{"attributes": {"POSITION": 0}, "indices": 1, "material": 1}]}],
        "materials": [{"name": "wall"}, {"name": "wall"}],
        "nodes": [{"mesh": 0, "scale": [400, 400, 400]}, {"mesh": 1, "translation": [0, 0, 300], "scale": [400, 400, 400]},
            {"translation": [100, 100, 100], "extensions": {"KHR_lights_punctual": {"light": 0}}},
            {"translation": [200, 200, 200], "extensions": {"KHR_lights_punctual": {"light": 1}}}],
        "scenes": [{"nodes": [0, 1, 2, 3]}]"#,
    );
    let path = folder.write("a.glb", file);
    let mut scene = load_file(&path).expect("a sound scene");
    let names: Vec<&str> = scene.materials.iter().map(|material| material.name.as_str()).collect();
    assert_eq!(names, ["wall", "wall (2)", "Light", "Light (2)"]);
    assert_eq!([&scene.lights[0].name, &scene.lights[1].name], ["Light", "Light (2)"]);
    let metres = scene.frame.unit.metres() as f32;
    assert!(metres < 1.0 && (scene.lights[0].range.expect("a range") - 500.0 * metres).abs() < 1e-4, "{metres}");

    for (index, value) in [0.1, 0.2, 3.0, 4.0].into_iter().enumerate() {
        let material = &mut scene.materials[index];
        if index < 2 { material.reflectance = Vec3::splat(value) } else { material.emission = Vec3::splat(value) }
    }
    Sidecar::of(&scene).write(&Sidecar::path_for(&path)).expect("a writable folder");
    let again = load_file(&path).expect("a sound scene");
    let values: Vec<f32> = (0..4)
        .map(|index| if index < 2 { again.materials[index].reflectance.x } else { again.materials[index].emission.x })
        .collect();
    assert_eq!(values, [0.1, 0.2, 3.0, 4.0]);
}
