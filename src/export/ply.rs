//! The lit mesh as PLY.

use std::io::{self, Write};

use glam::{DVec3, Vec3};

use super::LitMesh;
use crate::read::tone::shown_colour;

/// Writes the mesh as binary little-endian PLY. Its vertices carry the radiosity B per colour,
/// W/m², linear RGB, as `radiosity_r`, `radiosity_g` and `radiosity_b`, and the colour that a
/// picture shows of it (exposed, tone-mapped, gamma-encoded) as `red`, `green` and `blue`, which is
/// what viewers look for; its faces run anticlockwise around the bright side.
///
/// # Errors
/// Whatever the writer says.
pub fn write(writer: &mut impl Write, lit: &LitMesh<'_>) -> io::Result<()> {
    let mesh = lit.mesh;
    // What lies far off in its file needs more digits than f32 has.
    let is_far = lit.origin != DVec3::ZERO;
    let coordinate = if is_far { "double" } else { "float" };
    write!(
        writer,
        "ply\nformat binary_little_endian 1.0\n\
         comment Selflink: radiosity B in W/m2, linear RGB; red, green, blue as shown with an exposure of {} m2/W\n\
         element vertex {}\n\
         property {coordinate} x\nproperty {coordinate} y\nproperty {coordinate} z\n\
         property float radiosity_r\nproperty float radiosity_g\nproperty float radiosity_b\n\
         property uchar red\nproperty uchar green\nproperty uchar blue\n\
         element face {}\n\
         property list uchar int vertex_indices\n\
         end_header\n",
        lit.exposure,
        mesh.positions.len(),
        mesh.triangles.len()
    )?;
    for (position, radiosity) in mesh.positions.iter().zip(lit.radiosity) {
        if is_far {
            let far = (lit.origin + Vec3::from(*position).as_dvec3()).to_array();
            writer.write_all(bytemuck::cast_slice(&far))?;
        } else {
            writer.write_all(bytemuck::cast_slice(position))?;
        }
        writer.write_all(bytemuck::cast_slice(radiosity))?;
        writer.write_all(&shown_colour(*radiosity, lit.exposure))?;
    }
    write_triangles(writer, &mesh.triangles)
}

/// Writes triangles as binary lists of their vertices.
///
/// # Errors
/// Whatever the writer says.
pub(super) fn write_triangles(writer: &mut impl Write, triangles: &[[u32; 3]]) -> io::Result<()> {
    triangles.iter().try_for_each(|triangle| {
        writer.write_all(&[3])?;
        writer.write_all(bytemuck::cast_slice(triangle))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::read::tone::{encode_gamma, tone_curve};
    use crate::solve::Mesh;

    /// Truth: the format's definition, byte for byte, for one triangle.
    #[test]
    fn one_triangle() {
        let mesh = Mesh {
            positions: vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
            triangles: vec![[0, 1, 2]],
            ..Mesh::default()
        };
        let lit = LitMesh {
            mesh: &mesh,
            origin: DVec3::ZERO,
            radiosity: &[[2.0, 3.0, 4.0]; 3],
            exposure: 0.1,
            materials: &[],
        };
        let mut file = Vec::new();
        write(&mut file, &lit).expect("a Vec takes any bytes");
        let marker = b"end_header\n";
        let end = file.windows(marker.len()).position(|window| window == marker).expect("a header") + marker.len();
        let header = String::from_utf8(file[..end].to_vec()).expect("an ASCII header");
        assert!(header.starts_with("ply\nformat binary_little_endian 1.0\n"), "{header}");
        assert!(header.contains("element vertex 3\n") && header.contains("element face 1\n"), "{header}");
        let body = &file[end..];
        assert_eq!(body.len(), 3 * (6 * 4 + 3) + 1 + 3 * 4);
        let second: Vec<f32> = body[27..51].as_chunks::<4>().0.iter().map(|bytes| f32::from_le_bytes(*bytes)).collect();
        assert_eq!(second, [1.0, 0.0, 0.0, 2.0, 3.0, 4.0]);
        let shown = [0.2, 0.3, 0.4].map(|exposed| (255.0 * encode_gamma(tone_curve(exposed))).round() as u8);
        assert_eq!(body[51..54], shown);
        assert_eq!(body[81..], [3, 0, 0, 0, 0, 1, 0, 0, 0, 2, 0, 0, 0]);
    }
}
