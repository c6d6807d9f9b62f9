//! Pipes and devices in place of files: they would never end, or never begin.

#![cfg(unix)]

use std::path::Path;
use std::process::Command;

use selflink::scene::Sidecar;

use crate::strict::{ends, scene, sentence};
use crate::support::{Folder, square_json};

const SQUARE: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nusemtl m\nf 1 2 3 4\n";

fn make_pipe(path: &Path) {
    let made = Command::new("mkfifo").arg(path).status().expect("there is mkfifo");
    assert!(made.success());
}

#[test]
fn a_pipe_as_the_scene_or_its_sidecar() {
    let folder = Folder::new();
    make_pipe(&folder.path("pipe.obj"));
    assert!(sentence(&folder.path("pipe.obj")).contains("cannot be read (it is not a plain file)"));
    let room = folder.write("room.obj", SQUARE);
    let sidecar = Sidecar::path_for(&room);
    make_pipe(&sidecar);
    assert!(sentence(&room).contains("room.selflink.json: cannot be read (it is not a plain file)"));
    let written = ends("writing", move || Sidecar::default().write(&sidecar));
    assert!(written.expect_err("it is a pipe").to_string().contains("it is not a plain file"));
}

#[test]
fn a_pipe_or_a_device_beside_the_scene() {
    let folder = Folder::new();
    make_pipe(&folder.path("pipe"));
    std::os::unix::fs::symlink("/dev/zero", folder.path("zero")).expect("a writable folder");
    for name in ["pipe", "zero", "/dev/zero", "/dev/stdin", "."] {
        let expected =
            if name == "pipe" || name == "." { "it is not a plain file" } else { "outside the scene's folder" };
        let room = scene(&folder.write("room.obj", format!("mtllib {name}\n{SQUARE}")));
        assert!(room.skipped.sentences().join(" ").contains(expected), "{name}: {:?}", room.skipped.sentences());
        folder.write("wood.mtl", format!("newmtl m\nmap_Kd {name}\n"));
        let room = scene(&folder.write("room.obj", format!("mtllib wood.mtl\n{SQUARE}")));
        assert!(room.skipped.sentences().join(" ").contains(expected), "{name}: {:?}", room.skipped.sentences());
        let json = square_json(r#""scenes": [{"nodes": []}]"#).replace("60", &format!(r#"60, "uri": "{name}""#));
        let said = sentence(&folder.write("room.gltf", json));
        assert!(said.contains(expected), "{name}: {said}");
    }
}

/// Devices that give bytes without end, or wait for a person.
#[test]
fn a_device_as_the_scene() {
    for device in ["/dev/zero", "/dev/stdin", "/dev/tty"] {
        let path = Path::new(device);
        let refused = ends(device, move || selflink::scene::load_file(path).is_err());
        assert!(refused || !path.exists(), "{device}");
    }
}
