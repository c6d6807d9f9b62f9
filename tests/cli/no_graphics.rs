//! No display, no graphics driver: what a person reads, and what works all the same.
//!
//! Truth: exit codes and sentences. Drivers are hidden from the program by the variables that the
//! loaders of Vulkan and EGL look at.
#![cfg(all(feature = "gui", target_os = "linux"))]

use std::process::{Command, Output};

use crate::support::{COARSE, Folder, name, text};

/// Runs the program where neither a display nor a graphics driver is to be found.
fn without_graphics(args: &[&str], folder: &Folder) -> Output {
    let missing = folder.path("no-driver.json");
    Command::new(env!("CARGO_BIN_EXE_selflink"))
        .args(args)
        .current_dir(folder.path(""))
        .env_remove("DISPLAY")
        .env_remove("WAYLAND_DISPLAY")
        .envs(["VK_ICD_FILENAMES", "VK_DRIVER_FILES", "__EGL_VENDOR_LIBRARY_FILENAMES"].map(|name| (name, &missing)))
        .output()
        .expect("the program runs")
}

#[test]
fn without_a_driver_pictures_are_refused_and_solutions_are_not() {
    let folder = Folder::new();
    let picture = folder.path("picture.png");
    let output = without_graphics(&[&["render", "cornell", "--out", name(&picture)], &COARSE[..]].concat(), &folder);
    let stderr = text(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{stderr}");
    assert!(stderr.contains("mesa-vulkan-drivers") && stderr.contains("selflink solve"), "{stderr}");
    assert!(!stderr.contains("panicked") && !picture.exists(), "{stderr}");

    let mesh = folder.path("lit.ply");
    let output = without_graphics(&[&["solve", "cornell", "--out", name(&mesh)], &COARSE[..]].concat(), &folder);
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    assert!(mesh.exists() && text(&output.stdout).contains("links settled"));
}

#[test]
fn without_a_display_the_window_says_why_and_the_scene_is_solved() {
    let folder = Folder::new();
    let output = without_graphics(&[&["cornell"], &COARSE[..]].concat(), &folder);
    let (stdout, stderr) = (text(&output.stdout), text(&output.stderr));
    assert!(stderr.contains("no window can be opened, no display answers"), "{stderr}");
    assert!(stderr.contains("`selflink solve` and `selflink render`"), "{stderr}");
    assert!(stderr.contains("no picture was drawn") && stderr.contains("mesa-vulkan-drivers"), "{stderr}");
    assert!(!stderr.contains("panicked"), "{stderr}");
    assert!(stdout.contains("links settled"), "{stdout}");
}
