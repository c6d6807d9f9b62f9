//! Loading OBJ, glTF, GLB, PLY and STL scenes with their sidecars: the kinds of files that real
//! exporters write. Each is built here, small, with what must come of it; one program, so that it
//! is linked once.
//!
//! A "furnace" is a unit cube seen from inside, ρ = ½ and B_e = 1 W/m² on every face, so that B = 2
//! everywhere.

mod basis;
mod builder;
mod compressed;
mod far_off;
mod formats;
mod gltf;
#[path = "../support/left_out.rs"]
mod left_out;
mod lights;
mod obj;
mod paint;
mod real_scenes;
mod reports;
mod rooms;
mod sidecars;
mod solved;
mod structure;
#[path = "../support/mod.rs"]
mod support;
mod textures;
mod vertices;

use std::io::Cursor;

use glam::Vec3;
use image::{ImageFormat, Rgba, RgbaImage};
use selflink::scene::{Scene, load_file};
use support::{Folder, glb, square_bytes, square_json};

/// Faces of a unit cube, seen from inside.
const CUBE: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\n\
    f 1 2 3 4\nf 6 5 8 7\nf 5 1 4 8\nf 2 6 7 3\nf 5 6 2 1\nf 4 3 7 8\n";

/// A radiance of 1/π makes an exitance of 1.
const GLOW: &str = "Ke 0.31830987 0.31830987 0.31830987\n";

fn load(files: &[(&str, &[u8])], name: &str) -> Scene {
    let folder = Folder::new();
    for (name, content) in files {
        folder.write(name, content);
    }
    load_file(&folder.path(name)).expect("a sound scene")
}

fn load_obj(obj: &str, mtl: &str) -> Scene {
    load(&[("a.obj", obj.as_bytes()), ("a.mtl", mtl.as_bytes())], "a.obj")
}

fn load_square_glb(rest: &str) -> Scene {
    load(&[("scene.glb", &glb(&square_json(rest), &square_bytes()))], "scene.glb")
}

const SQUARE: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

fn total_area(scene: &Scene) -> f32 {
    scene.polygons.iter().map(|polygon| scene.area(polygon)).sum()
}

fn close(a: Vec3, b: Vec3) -> bool {
    a.distance(b) <= 1e-5 * b.length().max(1.0)
}

fn assert_furnace(scene: &Scene, what: &str) {
    assert!(scene.polygons.len() >= 6, "{what}: {} polygons", scene.polygons.len());
    for polygon in &scene.polygons {
        let surface = scene.surface(polygon);
        // A half is between two steps of sRGB.
        assert!(surface.reflectance.distance(Vec3::splat(0.5)) < 6e-3, "{what}: {surface:?}");
        assert!(surface.emission.distance(Vec3::ONE) < 1e-5, "{what}: {surface:?}");
    }
}

fn picture(size: [u32; 2], format: ImageFormat, texel: impl Fn(u32, u32) -> [u8; 4]) -> Vec<u8> {
    let image = RgbaImage::from_fn(size[0], size[1], |x, y| Rgba(texel(x, y)));
    let mut encoded = Cursor::new(Vec::new());
    let image = image::DynamicImage::ImageRgba8(image);
    let image = if matches!(format, ImageFormat::Tga | ImageFormat::Jpeg) { image.into_rgb8().into() } else { image };
    image.write_to(&mut encoded, format).expect("it can be encoded");
    encoded.into_inner()
}

/// sRGB 188 is linear 0.5029.
const HALF: [u8; 4] = [188, 188, 188, 255];

fn notes(scene: &Scene) -> String {
    scene.skipped.sentences().join(" ")
}
