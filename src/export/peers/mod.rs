//! A scene as other programs read it, so that anyone can check its light: Mitsuba 3 and Radiance.
//!
//! Geometry, reflectances, emissions, sky and sun, and the camera are written; faces are bright on
//! one side, as they are here.

mod mitsuba;
mod outside;
mod radiance;

use std::path::{Path, PathBuf};

use glam::Vec3;
use rustc_hash::FxHashMap;

use crate::scene::{CameraPose, Scene, Surface as Finish, WriteError};

/// Second sides of faces ([`crate::scene::Sides::Both`]) lie this share of the scene's diagonal
/// behind the first ones: other programs meet one of two faces at the same place by chance.
const BEHIND: f32 = 1e-5;
/// Picture of the view, pixels.
const SIZE: [u32; 2] = [640, 400];

/// A program that lights scenes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Peer {
    /// Mitsuba 3: XML and PLY.
    Mitsuba,
    /// Radiance: RAD and a view.
    Radiance,
}

impl Peer {
    /// All of them.
    pub const ALL: [Self; 2] = [Self::Mitsuba, Self::Radiance];

    /// Name of the program on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Mitsuba => "mitsuba",
            Self::Radiance => "radiance",
        }
    }

    /// The one of this name.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|peer| peer.name() == name)
    }

    /// Writes the files of a scene into a folder, which is made where it is missing; returns the
    /// one to open.
    ///
    /// # Errors
    /// The folder or a file cannot be written.
    pub fn write(self, scene: &Scene, folder: &Path) -> Result<PathBuf, WriteError> {
        match self {
            Self::Mitsuba => mitsuba::write(scene, folder),
            Self::Radiance => radiance::write(scene, folder),
        }
    }
}

/// The faces of one material that reflect and emit alike.
struct Surface {
    /// Number and name of the material without special characters, such as `3-white_paint`; others
    /// of the material are counted behind it.
    name: String,
    /// Reflectance and emission of the faces.
    finish: Finish,
    /// Corners, three or four each, anticlockwise as seen from the bright side.
    faces: Vec<Vec<Vec3>>,
}

/// The faces of a scene by material, and by what they reflect and emit where faces of a material
/// differ.
fn surfaces(scene: &Scene) -> Vec<Surface> {
    let (lower, upper) = scene.bounds();
    let behind = BEHIND * lower.distance(upper);
    let mut surfaces: Vec<Vec<Surface>> = scene.materials.iter().map(|_| Vec::new()).collect();
    let mut known = FxHashMap::default();
    for polygon in &scene.polygons {
        let (corners, count) = scene.corner_positions(polygon);
        let offset = if polygon.is_back { behind * scene.normal(polygon) } else { Vec3::ZERO };
        let corners = corners[..count].iter().map(|corner| corner + offset).collect();
        let (material, finish) = (polygon.material.0 as usize, scene.surface(polygon));
        let of_material = &mut surfaces[material];
        let bits = [finish.reflectance, finish.emission].map(|value| value.to_array().map(f32::to_bits));
        let place = *known.entry((material, bits)).or_insert_with(|| {
            let name = name(material, &scene.materials[material].name, of_material.len());
            of_material.push(Surface { name, finish, faces: Vec::new() });
            of_material.len() - 1
        });
        of_material[place].faces.push(corners);
    }
    surfaces.into_iter().flatten().collect()
}

fn name(material: usize, name: &str, place: usize) -> String {
    let plain = |c: char| if c.is_ascii_alphanumeric() { c } else { '_' };
    let name: String = name.chars().map(plain).collect();
    if place == 0 { format!("{material}-{name}") } else { format!("{material}-{name}-{}", place + 1) }
}

/// The scene's camera, or else one that sees the whole scene from above its corner.
fn camera(scene: &Scene) -> CameraPose {
    scene.camera.unwrap_or_else(|| {
        let (lower, upper) = scene.bounds();
        let (target, size) = (0.5 * (lower + upper), lower.distance(upper).max(f32::MIN_POSITIVE));
        CameraPose { eye: target + size * Vec3::new(0.6, 0.5, 0.8), target, up: Vec3::Y, hfov_deg: 60.0 }
    })
}

/// Three numbers with spaces between them, to their last bit.
fn spaced(vector: Vec3) -> String {
    format!("{} {} {}", vector.x, vector.y, vector.z)
}
