//! The lit mesh as a file for other programs: PLY.

use std::io::{self, Write};

use crate::solver::Mesh;

/// Writes the mesh as binary little-endian PLY. Its vertices carry the radiosity B per colour, W/m², linear RGB, as
/// `radiosity_r`, `radiosity_g` and `radiosity_b`; its faces run anticlockwise around the bright side.
///
/// # Errors
/// Whatever the writer says.
pub fn write_ply(writer: &mut impl Write, mesh: &Mesh, vertex_radiosity: &[[f32; 3]]) -> io::Result<()> {
    write!(
        writer,
        "ply\nformat binary_little_endian 1.0\n\
         comment Selflink: radiosity B in W/m2, linear RGB\n\
         element vertex {}\n\
         property float x\nproperty float y\nproperty float z\n\
         property float radiosity_r\nproperty float radiosity_g\nproperty float radiosity_b\n\
         element face {}\n\
         property list uchar int vertex_indices\n\
         end_header\n",
        mesh.positions.len(),
        mesh.triangles.len()
    )?;
    for (position, radiosity) in mesh.positions.iter().zip(vertex_radiosity) {
        for value in position.iter().chain(radiosity) {
            writer.write_all(&value.to_le_bytes())?;
        }
    }
    for triangle in &mesh.triangles {
        writer.write_all(&[3])?;
        for vertex in triangle {
            writer.write_all(&vertex.to_le_bytes())?;
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Truth: the format's definition, byte for byte, for one triangle.
    #[test]
    fn one_triangle() {
        let mesh = Mesh {
            positions: vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
            triangles: vec![[0, 1, 2]],
            ..Mesh::default()
        };
        let mut file = Vec::new();
        write_ply(&mut file, &mesh, &[[2.0, 3.0, 4.0]; 3]).expect("a Vec takes any bytes");
        let marker = b"end_header\n";
        let end = file.windows(marker.len()).position(|window| window == marker).expect("a header") + marker.len();
        let header = String::from_utf8(file[..end].to_vec()).expect("an ASCII header");
        assert!(header.starts_with("ply\nformat binary_little_endian 1.0\n"), "{header}");
        assert!(header.contains("element vertex 3\n") && header.contains("element face 1\n"), "{header}");
        let body = &file[end..];
        assert_eq!(body.len(), 3 * 6 * 4 + 1 + 3 * 4);
        let floats: Vec<f32> = body[..72].as_chunks::<4>().0.iter().map(|bytes| f32::from_le_bytes(*bytes)).collect();
        assert_eq!(floats[6..12], [1.0, 0.0, 0.0, 2.0, 3.0, 4.0]);
        assert_eq!(body[72..], [3, 0, 0, 0, 0, 1, 0, 0, 0, 2, 0, 0, 0]);
    }
}
