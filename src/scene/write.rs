//! Writing a scene as OBJ, MTL and the sidecar that carries what these cannot say (camera, sides).
//!
//! Positions, reflectances and emissions keep every bit of their f32 when read again. Quads stay
//! quads, group paths become `g a/b/c`; groups without faces of their own live on in the paths of
//! those below them, or not at all.

use std::fmt::Write as _;
use std::fs::{self, File};
use std::io::{self, BufWriter, Write as _};
use std::path::{Path, PathBuf};

use glam::Vec3;

use super::assemble::MAX_FILE_REFLECTANCE;
use super::sidecar::{Sidecar, SidecarMaterial};
use super::{GroupId, Material, Polygon, Scene, Sides, group_names};
use crate::base::file;

/// A file that cannot be written.
#[derive(Debug, thiserror::Error)]
#[error("{}: cannot be written ({source}); choose a folder that you may write to", path.display())]
pub struct WriteError {
    path: PathBuf,
    source: io::Error,
}

/// Makes a folder where it is missing.
///
/// # Errors
/// It cannot be made.
pub(crate) fn make_folder(folder: &Path) -> Result<(), WriteError> {
    fs::create_dir_all(folder).map_err(|source| WriteError { path: folder.to_owned(), source })
}

/// Writes a file of a folder; returns its path.
///
/// # Errors
/// It cannot be written.
pub(crate) fn write_file(
    folder: &Path,
    name: &str,
    content: impl FnOnce(&mut BufWriter<File>) -> io::Result<()>,
) -> Result<PathBuf, WriteError> {
    let path = folder.join(name);
    match file::write(&path, content) {
        Ok(()) => Ok(path),
        Err(source) => Err(WriteError { path, source }),
    }
}

/// Writes `NAME.obj`, `NAME.mtl` and `NAME.selflink.json` into `dir`, which is made where it is
/// missing, and returns the path of the OBJ.
///
/// # Errors
/// When the folder or one of the files cannot be written.
pub fn write_obj(scene: &Scene, dir: &Path) -> Result<PathBuf, WriteError> {
    let stem = scene.name.replace(['/', '\\'], "_");
    let write = |extension: &str, text: String| {
        write_file(dir, &format!("{stem}.{extension}"), |writer| writer.write_all(text.as_bytes()))
    };
    make_folder(dir)?;
    let names = material_names(&scene.materials);
    write("mtl", mtl_text(&scene.materials, &names))?;
    write("selflink.json", sidecar_text(scene, &names))?;
    write("obj", obj_text(scene, &names, &stem))
}

fn obj_text(scene: &Scene, materials: &[String], stem: &str) -> String {
    let mut text = format!("# {}: {} polygons, lengths in metres, y up\n", scene.name, scene.polygons.len());
    line(&mut text, format_args!("mtllib {stem}.mtl"));
    for vertex in &scene.vertices {
        let vertex = scene.to_file(*vertex);
        line(&mut text, format_args!("v {} {} {}", vertex.x, vertex.y, vertex.z));
    }
    // Faces of the root have no `g`, so they have to come before the first one.
    let (of_root, of_groups): (Vec<&Polygon>, Vec<&Polygon>) =
        scene.polygons.iter().filter(|polygon| !polygon.is_back).partition(|polygon| polygon.group.0 == 0);
    let mut group = GroupId(0);
    let mut material = None;
    for polygon in of_root.into_iter().chain(of_groups) {
        if polygon.group != group {
            group = polygon.group;
            line(&mut text, format_args!("g {}", group_name(scene, group)));
        }
        if material != Some(polygon.material) {
            material = Some(polygon.material);
            line(&mut text, format_args!("usemtl {}", materials[polygon.material.0 as usize]));
        }
        text.push('f');
        for corner in polygon.corners() {
            text.push(' ');
            text.push_str(&(corner + 1).to_string());
        }
        text.push('\n');
    }
    text
}

fn mtl_text(materials: &[Material], names: &[String]) -> String {
    let mut text = String::from("# Kd is the reflectance, Ke the radiance in W/m2sr (exitance / pi)\n");
    for (material, name) in materials.iter().zip(names) {
        let rho = material.reflectance;
        line(&mut text, format_args!("newmtl {name}"));
        line(&mut text, format_args!("Kd {} {} {}", rho.x, rho.y, rho.z));
        if material.emission != Vec3::ZERO {
            let [r, g, b] = material.emission.to_array().map(radiance);
            line(&mut text, format_args!("Ke {r} {g} {b}"));
        }
    }
    text
}

fn sidecar_text(scene: &Scene, names: &[String]) -> String {
    // Faces that were made into two opposite patches have been written once.
    let sides = if scene.polygons.iter().any(|polygon| polygon.is_back) { Sides::Both } else { scene.sides };
    // Loading clamps what a scene file says; a sidecar may say more.
    let bright = (scene.materials.iter().zip(names))
        .filter(|(material, _)| material.reflectance.max_element() > MAX_FILE_REFLECTANCE)
        .map(|(material, name)| {
            (name.clone(), SidecarMaterial { reflectance: Some(material.reflectance), ..Default::default() })
        });
    let mut sidecar = Sidecar::default();
    sidecar.materials = bright.collect();
    sidecar.sides = Some(sides);
    sidecar.camera = scene.camera.map(|camera| camera.in_file(scene));
    serde_json::to_string_pretty(&sidecar).expect("numbers, and text as keys") + "\n"
}

fn line(text: &mut String, arguments: std::fmt::Arguments<'_>) {
    text.write_fmt(arguments).expect("a String takes any text");
    text.push('\n');
}

/// The radiance that a loader turns back into `exitance` by multiplying with π: of the neighbours
/// that do so the one with the fewest digits, else (not every f32 is a multiple) the nearest.
fn radiance(exitance: f32) -> f32 {
    let nearest = (f64::from(exitance) / std::f64::consts::PI) as f32;
    [nearest, nearest.next_down(), nearest.next_up()]
        .into_iter()
        .filter(|candidate| candidate * std::f32::consts::PI == exitance)
        .min_by_key(|candidate| candidate.to_string().len())
        .unwrap_or(nearest)
}

/// A name as one word of an OBJ line.
fn word(name: &str) -> String {
    let word: String = name.trim().chars().map(|c| if c.is_whitespace() { '_' } else { c }).collect();
    if word.is_empty() { "unnamed".to_owned() } else { word }
}

/// One word for each material, all different.
fn material_names(materials: &[Material]) -> Vec<String> {
    let mut taken = rustc_hash::FxHashSet::default();
    let unique = |material: &Material| {
        let name = word(&material.name);
        let mut candidate = name.clone();
        let mut number = 2;
        while !taken.insert(candidate.clone()) {
            candidate = format!("{name}_{number}");
            number += 1;
        }
        candidate
    };
    materials.iter().map(unique).collect()
}

/// The group's path, a slash inside a name turned into an underscore.
fn group_name(scene: &Scene, group: GroupId) -> String {
    let names = group_names(&scene.groups, group).into_iter().map(|name| word(name).replace('/', "_"));
    names.collect::<Vec<_>>().join("/")
}

#[cfg(test)]
mod tests {
    use glam::{Vec3, vec3};
    use serde_json::json;

    use super::*;
    use crate::scene::CameraPose;

    /// A scene with everything that OBJ words cannot hold as it is.
    fn odd_scene() -> Scene {
        let mut scene = Scene::new("odd");
        let plain = scene.add_material("old oak", Vec3::splat(0.5), Vec3::ZERO);
        let bright = scene.add_material("old oak", Vec3::splat(0.97), vec3(1.0, 2.0, 1e-3));
        let shelf = scene.add_group("left / right", GroupId(0));
        let board = scene.add_group("board", shelf);
        let corners = [Vec3::ZERO, Vec3::X, vec3(1.0, 1.0, 0.1), Vec3::Y];
        scene.add_quad(corners, plain, board);
        scene.add_triangle([corners[0], corners[1], corners[2]], bright, GroupId(0));
        scene
    }

    #[test]
    fn names_become_single_words_and_stay_different() {
        let scene = odd_scene();
        let names = material_names(&scene.materials);
        assert_eq!(names, ["old_oak", "old_oak_2"]);
        let text = obj_text(&scene, &names, "odd");
        let faces = text.find("mtllib odd.mtl\n").map(|start| &text[start..]);
        assert!(faces.is_some_and(|text| text.contains("g left___right/board\nusemtl old_oak\nf 1 2 3 4\n")), "{text}");
    }

    #[test]
    fn faces_of_the_root_precede_every_group() {
        let scene = odd_scene();
        let text = obj_text(&scene, &material_names(&scene.materials), "odd");
        let [root, group] = ["f 5 6 7\n", "g left"].map(|part| text.find(part).expect("both are written"));
        assert!(root < group, "{text}");
    }

    #[test]
    fn the_sidecar_says_what_obj_cannot() {
        let mut scene = odd_scene();
        let turned = Polygon { is_back: true, ..scene.polygons[0].flipped() };
        scene.polygons.push(turned);
        scene.camera = Some(CameraPose { eye: vec3(0.1, 0.2, 3.0), target: Vec3::ZERO, up: Vec3::Y, hfov_deg: 39.3 });
        let names = material_names(&scene.materials);
        let sidecar: serde_json::Value = serde_json::from_str(&sidecar_text(&scene, &names)).expect("it is JSON");
        let expected = json!({
            "sides": "both",
            "materials": { "old_oak_2": { "reflectance": [0.97, 0.97, 0.97] } },
            "camera": { "eye": [0.1, 0.2, 3.0], "target": [0.0, 0.0, 0.0], "up": [0.0, 1.0, 0.0], "hfov_deg": 39.3 },
        });
        assert_eq!(sidecar, expected);
        assert_eq!(obj_text(&scene, &names, "odd").matches("\nf ").count(), 2, "opposite patches are one face");
    }

    #[test]
    fn a_radiance_times_pi_is_the_exitance() {
        for radiance_written in [17.0_f32, 12.0, 4.0, 0.1, 620.0] {
            assert_eq!(radiance(radiance_written * std::f32::consts::PI), radiance_written);
        }
        // Not every f32 is a multiple of π; the nearest is within one unit in the last place.
        for exitance in [1.0_f32, 0.3, 315.421] {
            let back = radiance(exitance) * std::f32::consts::PI;
            assert!((back - exitance).abs() <= exitance * f32::EPSILON, "{exitance} became {back}");
        }
    }
}
