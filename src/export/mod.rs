//! Results as files for other programs, one module a format.
//!
//! Lit meshes as [`ply`] and [`glb`], a view in W/m² as [`exr`], links as CSV ([`links`]), settings
//! as JSON ([`settings`]), scenes for other programs that light them ([`peers`]). Writers write
//! into whatever takes bytes, those of [`peers`] into a folder; none knows of windows.

pub mod exr;
pub mod glb;
pub mod links;
pub mod peers;
pub mod ply;
pub mod settings;

use std::io::{self, Write};
use std::path::{Path, PathBuf};

use glam::DVec3;

use crate::read::tone;
use crate::scene::{Material, Scene};
use crate::solve::{Mesh, Snapshot};

/// A scene's name as a file can have it.
pub fn file_name(scene: &str) -> String {
    scene.chars().map(|c| if c.is_alphanumeric() || "-_.".contains(c) { c } else { '_' }).collect()
}

/// A file name whose extension says no format.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{}: {what}", path.display())]
pub struct UnknownFormat {
    path: PathBuf,
    what: &'static str,
}

/// Formats of a lit mesh.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MeshFormat {
    /// Polygon File Format, binary.
    Ply,
    /// glTF 2.0, one binary file.
    Glb,
}

impl MeshFormat {
    /// The format that a name's extension says.
    ///
    /// # Errors
    /// Any other extension.
    pub fn of(path: &Path) -> Result<Self, UnknownFormat> {
        match extension(path).as_str() {
            "ply" => Ok(Self::Ply),
            "glb" => Ok(Self::Glb),
            _ => Err(UnknownFormat {
                path: path.to_owned(),
                what: "meshes are written as PLY or GLB; choose a name that ends in .ply or .glb",
            }),
        }
    }

    /// Writes a mesh in this format.
    ///
    /// # Errors
    /// Whatever the writer says, and a mesh beyond 4 GiB for GLB.
    pub fn write(self, writer: &mut impl Write, lit: &LitMesh<'_>) -> io::Result<()> {
        match self {
            Self::Ply => ply::write(writer, lit),
            Self::Glb => glb::write(writer, lit),
        }
    }
}

/// Formats of a view.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PictureFormat {
    /// Exposed and tone-mapped, 8 bits a channel.
    Png,
    /// Radiosity in W/m², 32-bit floats.
    Exr,
}

impl PictureFormat {
    /// The format that a name's extension says.
    ///
    /// # Errors
    /// Any other extension.
    pub fn of(path: &Path) -> Result<Self, UnknownFormat> {
        match extension(path).as_str() {
            "png" => Ok(Self::Png),
            "exr" => Ok(Self::Exr),
            _ => Err(UnknownFormat {
                path: path.to_owned(),
                what: "pictures are written as PNG or EXR; choose a name that ends in .png or .exr",
            }),
        }
    }
}

fn extension(path: &Path) -> String {
    path.extension().unwrap_or_default().to_string_lossy().to_lowercase()
}

/// A mesh with its light, as the mesh writers take it.
#[derive(Clone, Copy, Debug)]
pub struct LitMesh<'a> {
    /// Triangles.
    pub mesh: &'a Mesh,
    /// Zero of the mesh's coordinates in those of the scene's file.
    pub origin: DVec3,
    /// Radiosity B of each vertex, W/m², linear RGB.
    pub radiosity: &'a [[f32; 3]],
    /// Factor on radiosities for the tone-mapped colours, m²/W.
    pub exposure: f32,
    /// The scene's materials, which the leaves name by number.
    pub materials: &'a [Material],
}

impl<'a> LitMesh<'a> {
    /// The mesh of a snapshot, exposed as the picture of it is without anybody's correction.
    pub fn of(snapshot: &'a Snapshot, scene: &'a Scene) -> Self {
        Self {
            mesh: &snapshot.mesh,
            origin: scene.origin,
            radiosity: &snapshot.vertex_radiosity,
            exposure: tone::auto_exposure(snapshot),
            materials: &scene.materials,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn extensions_name_formats() {
        assert_eq!(MeshFormat::of(Path::new("a/room.GLB")), Ok(MeshFormat::Glb));
        assert_eq!(PictureFormat::of(Path::new("room.exr")), Ok(PictureFormat::Exr));
        for path in ["room", "room.obj", "room.exr"] {
            let said = MeshFormat::of(Path::new(path)).expect_err("no mesh").to_string();
            assert!(said.starts_with(path) && said.contains(".glb"), "{said}");
        }
        assert!(PictureFormat::of(Path::new("room.jpg")).is_err());
    }
}
