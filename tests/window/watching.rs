//! Scene files that change or vanish while the window shows them.
//!
//! Truth: what was written to the disk, and the scene, camera and parameters that the window had
//! before.

use std::path::{Path, PathBuf};

use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use selflink::app::{App, words};
use selflink::scene::Source;

use crate::support::{click, coarse, until, window};

/// A floor and a roof that shines; more faces make another scene of it.
fn room(more: &str) -> String {
    let vertices = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\n";
    format!("mtllib room.mtl\n{vertices}usemtl floor\nf 1 2 3 4\nusemtl roof\nf 8 7 6 5\n{more}")
}

const MATERIALS: &str = "newmtl floor\nKd 0.5 0.5 0.5\nnewmtl roof\nKd 0.5 0.5 0.5\nKe 30 30 30\n";

fn write(path: &Path, text: &str) {
    std::fs::write(path, text).expect("a writable folder");
}

fn polygons(window: &Harness<'static, App>) -> usize {
    window.state().scene_info().map_or(0, |info| info.scene.polygons.len())
}

fn says(window: &Harness<'static, App>, text: &str) -> bool {
    window.query_all_by_label_contains(text).next().is_some()
}

#[derive(Debug)]
struct Dropped(PathBuf);

impl egui::DroppedFile for Dropped {
    fn path(&self) -> &Path {
        &self.0
    }

    fn bytes(&self) -> Result<Vec<u8>, String> {
        std::fs::read(&self.0).map_err(|error| error.to_string())
    }
}

/// A scene is opened whichever file of those dropped comes first, and others are not passed over in
/// silence.
#[test]
fn of_files_dropped_together_the_scene_is_opened() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = |name: &str| folder.path().join(name);
    write(&path("room.mtl"), MATERIALS);
    write(&path("room.obj"), &room(""));
    write(&path("other.obj"), &room("f 1 2 6 5\n"));
    let mut window = crate::support::cornell(coarse());
    for name in ["room.mtl", "room.obj", "other.obj"] {
        window.input_mut().dropped_files.push(std::sync::Arc::new(Dropped(path(name))));
    }
    until(&mut window, "the dropped scene", |window| polygons(window) == 2);
    assert!(says(&window, "Only room.obj is opened"));
    crate::support::keep(&mut window, "dropped");
}

#[test]
fn a_changed_file_is_offered_and_a_vanished_one_is_said_once() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path: PathBuf = folder.path().join("room.obj");
    write(&path, &room(""));
    write(&path.with_extension("mtl"), MATERIALS);
    let mut window = window(Some(Source::File(path.clone())), coarse());
    until(&mut window, "the scene", |window| polygons(window) == 2);
    let centre = window.state().view_rect().center();
    window.drag_at(centre);
    window.hover_at(centre + egui::vec2(60.0, 10.0));
    window.drop_at(centre + egui::vec2(60.0, 10.0));
    window.run_steps(3);
    let camera = window.state().camera_pose().expect("a view");

    // Another face: kept out at first, then taken in, with camera and parameters as they were.
    write(&path, &room("f 1 2 6 5\n"));
    until(&mut window, "the offer", |window| says(window, "room.obj has changed on disk."));
    click(&mut window, "Keep");
    assert!(!says(&window, "has changed on disk.") && polygons(&window) == 2);
    write(&path, &room("f 1 2 6 5\nf 2 3 7 6\n"));
    until(&mut window, "the second offer", |window| says(window, "room.obj has changed on disk."));
    click(&mut window, "Reload");
    until(&mut window, "the new scene", |window| polygons(window) == 4);
    window.run_steps(2);
    assert_eq!(window.state().camera_pose(), Some(camera), "the view stays");
    assert_eq!(window.state().status().params, coarse());

    // Materials beside it count as well; what is half written is reported, and nothing is lost by
    // it.
    write(&path.with_extension("mtl"), "newmtl floor\nKd 0.1 0.1 0.1\n");
    until(&mut window, "the offer of the materials", |window| says(window, "room.mtl has changed on disk."));
    write(&path, "v 0 0 0\nv 1 0");
    click(&mut window, "Reload");
    until(&mut window, "the loader's sentence", |window| says(window, "room.obj") && says(window, words::DISMISS));
    assert_eq!(polygons(&window), 4, "the scene in view stays");

    // Written whole it is offered again.
    write(&path, &room("f 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\n"));
    until(&mut window, "the third offer", |window| says(window, "room.obj has changed on disk."));
    std::fs::remove_file(&path).expect("it is there");
    until(&mut window, "the farewell", |window| says(window, "The file room.obj is gone from the disk"));
    assert!(!says(&window, "has changed on disk."), "there is nothing to read again");
    assert_eq!(polygons(&window), 4);
}
