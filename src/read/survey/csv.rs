//! Readings as CSV: a row for each point; lengths in the scene's unit and its file's coordinates,
//! light in W/m² per colour and in lx.

use std::io::{self, Write};

use glam::{DVec3, Vec3};

use super::lit_mesh::SurfaceReading;
use super::plane::PlaneReading;
use crate::base::photometry::lux;
use crate::scene::to_file;

/// A probe's name, place and what is there, if anything.
pub struct NamedReading<'a> {
    /// Name of the probe.
    pub name: &'a str,
    /// Where it was placed, in the coordinates of the scene's file.
    pub point: DVec3,
    /// Normal of the surface there.
    pub normal: Vec3,
    /// Reading of the probe, where it lies on a surface.
    pub reading: Option<SurfaceReading>,
}

/// Writes the points of a work plane; values of points that were left out stay empty.
///
/// # Errors
/// Error of the writer.
pub fn write_plane(writer: &mut impl Write, plane: &PlaneReading) -> io::Result<()> {
    writeln!(writer, "x,y,z,E_r,E_g,E_b,E_lx,se_r,se_g,se_b")?;
    let errors = &plane.standard_errors;
    for ((point, value), error) in plane.grid.points.iter().zip(&plane.values).zip(errors) {
        let DVec3 { x, y, z } = to_file(plane.origin, *point);
        match value {
            Some(e) => write!(writer, "{x},{y},{z},{},{},{},{}", e.x, e.y, e.z, lux(e.to_array()))?,
            None => write!(writer, "{x},{y},{z},,,,")?,
        }
        write_error(writer, *error)?;
    }
    Ok(())
}

/// The last three columns of a row; empty where there is no standard error.
fn write_error(writer: &mut impl Write, error: Option<Vec3>) -> io::Result<()> {
    match error {
        Some(error) => writeln!(writer, ",{},{},{}", error.x, error.y, error.z),
        None => writeln!(writer, ",,,"),
    }
}

/// Writes probes on surfaces; values of those that are on none any more stay empty.
///
/// # Errors
/// Error of the writer.
pub fn write_probes<'a>(writer: &mut impl Write, probes: impl IntoIterator<Item = NamedReading<'a>>) -> io::Result<()> {
    writeln!(writer, "name,x,y,z,nx,ny,nz,E_r,E_g,E_b,B_r,B_g,B_b,E_lx,se_r,se_g,se_b")?;
    for NamedReading { name, point, normal, reading } in probes {
        // Names hold whatever a person typed.
        let name = name.replace('"', "\"\"");
        write!(writer, "\"{name}\",{},{},{},{},{},{}", point.x, point.y, point.z, normal.x, normal.y, normal.z)?;
        match reading {
            Some(SurfaceReading { irradiance: e, radiosity: b, standard_error, .. }) => {
                write!(writer, ",{},{},{},{},{},{},{}", e.x, e.y, e.z, b.x, b.y, b.z, lux(e.to_array()))?;
                write_error(writer, standard_error)?;
            }
            None => writeln!(writer, ",,,,,,,,,,")?,
        }
    }
    Ok(())
}
