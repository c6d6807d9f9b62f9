//! Scenes of other people, below `SELFLINK_SCENES`.

use std::path::PathBuf;

use selflink::scene::{Sides, load_file};

use crate::left_out;

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
