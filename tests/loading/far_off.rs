//! Scenes far from their zero, as plans by national coordinates are.

use glam::{DVec3, Vec3};
use selflink::scene::{Sidecar, load_file, write_obj};

use crate::support::{Folder, glb, square_bytes, square_json};
use crate::{close, load_square_glb, total_area};

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
