//! The lit mesh as binary glTF 2.0.
//!
//! `COLOR_0` is defined as linear and within 0..1, so it holds what a picture shows: exposed and
//! bent by the tone curve, without gamma, which every viewer adds. With KHR_materials_unlit other
//! programs show just that. The light itself lies beside it in the attribute `_RADIOSITY`, W/m²,
//! and `extras` say so. One primitive a material; all share their vertices.

use std::collections::BTreeMap;
use std::io::{self, Write};

use glam::DVec3;
use serde_json::{Value, json};

use super::LitMesh;
use crate::read::tone::tone_curve;

const FLOAT: u32 = 5126;
const UNSIGNED_SHORT: u32 = 5123;
const UNSIGNED_INT: u32 = 5125;
const ARRAY_BUFFER: u32 = 34_962;
const ELEMENT_ARRAY_BUFFER: u32 = 34_963;

/// Writes the mesh as GLB.
///
/// # Errors
/// Whatever the writer says; a mesh without triangles, or one beyond the 4 GiB that the format
/// holds.
pub fn write(writer: &mut impl Write, lit: &LitMesh<'_>) -> io::Result<()> {
    let by_material = triangles_by_material(lit);
    if by_material.is_empty() {
        return Err(io::Error::new(io::ErrorKind::InvalidInput, "the mesh has no triangles"));
    }
    let lengths = Lengths::of(lit);
    let mut json = serde_json::to_vec(&document(lit, &by_material, lengths))?;
    json.resize(json.len().next_multiple_of(4), b' ');
    let binary = lengths.total();
    // Header, and the head of each chunk.
    let whole = 12 + 8 + json.len() + 8 + binary;
    let word = |length: usize| -> io::Result<[u8; 4]> {
        let too_large = |_| io::Error::new(io::ErrorKind::InvalidInput, "GLB holds no more than 4 GiB; write PLY");
        u32::try_from(length).map(u32::to_le_bytes).map_err(too_large)
    };
    writer.write_all(b"glTF")?;
    writer.write_all(&2_u32.to_le_bytes())?;
    writer.write_all(&word(whole)?)?;
    writer.write_all(&word(json.len())?)?;
    writer.write_all(b"JSON")?;
    writer.write_all(&json)?;
    writer.write_all(&word(binary)?)?;
    writer.write_all(b"BIN\0")?;
    write_binary(writer, lit, &by_material)
}

/// Numbers of triangles, by the material of their leaves.
fn triangles_by_material(lit: &LitMesh<'_>) -> BTreeMap<u32, Vec<u32>> {
    let mesh = lit.mesh;
    let mut by_material: BTreeMap<u32, Vec<u32>> = BTreeMap::new();
    for triangle in 0..mesh.triangles.len() as u32 {
        let leaf = mesh.triangle_leaf.get(triangle as usize).and_then(|leaf| mesh.leaves.get(*leaf as usize));
        by_material.entry(leaf.map_or(0, |leaf| leaf.material.0)).or_default().push(triangle);
    }
    by_material
}

/// Bytes of each part of the binary chunk, in its order.
#[derive(Clone, Copy)]
struct Lengths {
    positions: usize,
    colours: usize,
    radiosities: usize,
    indices: usize,
}

impl Lengths {
    fn of(lit: &LitMesh<'_>) -> Self {
        let (vertices, triangles) = (lit.mesh.positions.len(), lit.mesh.triangles.len());
        Self {
            positions: vertices * size_of::<[f32; 3]>(),
            colours: vertices * size_of::<[u16; 4]>(),
            radiosities: vertices * size_of::<[f32; 3]>(),
            indices: triangles * size_of::<[u32; 3]>(),
        }
    }

    fn total(self) -> usize {
        self.positions + self.colours + self.radiosities + self.indices
    }
}

fn document(lit: &LitMesh<'_>, by_material: &BTreeMap<u32, Vec<u32>>, lengths: Lengths) -> Value {
    let count = lit.mesh.positions.len();
    let (lower, upper) = bounds(&lit.mesh.positions);
    let mut accessors = vec![
        json!({"bufferView": 0, "componentType": FLOAT, "count": count, "type": "VEC3", "min": lower, "max": upper}),
        json!({"bufferView": 1, "componentType": UNSIGNED_SHORT, "normalized": true, "count": count, "type": "VEC4"}),
        json!({"bufferView": 2, "componentType": FLOAT, "count": count, "type": "VEC3"}),
    ];
    let (mut primitives, mut materials, mut offset) = (Vec::new(), Vec::new(), 0);
    for (material, triangles) in by_material {
        primitives.push(json!({
            "attributes": {"POSITION": 0, "COLOR_0": 1, "_RADIOSITY": 2},
            "indices": accessors.len(),
            "material": materials.len(),
        }));
        materials.push(material_of(lit, *material));
        let (indices, bytes) = (3 * triangles.len(), triangles.len() * size_of::<[u32; 3]>());
        accessors.push(json!({
            "bufferView": 3, "byteOffset": offset, "componentType": UNSIGNED_INT, "count": indices, "type": "SCALAR",
        }));
        offset += bytes;
    }
    let mut begin = 0;
    let mut view = |length: usize, target: u32| {
        let view = json!({"buffer": 0, "byteOffset": begin, "byteLength": length, "target": target});
        begin += length;
        view
    };
    let views = [
        view(lengths.positions, ARRAY_BUFFER),
        view(lengths.colours, ARRAY_BUFFER),
        view(lengths.radiosities, ARRAY_BUFFER),
        view(lengths.indices, ELEMENT_ARRAY_BUFFER),
    ];
    let mut node = json!({"name": "lit mesh", "mesh": 0});
    if lit.origin != DVec3::ZERO {
        node["translation"] = json!(lit.origin);
    }
    json!({
        "asset": {"version": "2.0", "generator": concat!("Selflink ", env!("CARGO_PKG_VERSION"))},
        "extensionsUsed": ["KHR_materials_unlit"],
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [node],
        "meshes": [{"name": "lit mesh", "primitives": primitives, "extras": {
            "_RADIOSITY": "radiosity B, W/m², linear RGB",
            "COLOR_0": "B exposed and bent by the tone curve, linear, 0..1",
            "exposure_m2_per_w": lit.exposure,
        }}],
        "materials": materials,
        "accessors": accessors,
        "bufferViews": views,
        "buffers": [{"byteLength": lengths.total()}],
    })
}

/// White, so that nothing is multiplied with what the vertices say; what the surface is stands
/// beside it.
fn material_of(lit: &LitMesh<'_>, material: u32) -> Value {
    let white = json!({"baseColorFactor": [1, 1, 1, 1], "metallicFactor": 0, "roughnessFactor": 1});
    let mut written = json!({"pbrMetallicRoughness": white, "extensions": {"KHR_materials_unlit": {}}});
    if let Some(material) = lit.materials.get(material as usize) {
        written["name"] = json!(material.name);
        written["extras"] = json!({
            "reflectance": material.reflectance.to_array(),
            "emission_w_per_m2": material.emission.to_array(),
        });
    }
    written
}

fn bounds(positions: &[[f32; 3]]) -> ([f32; 3], [f32; 3]) {
    let none = ([f32::INFINITY; 3], [f32::NEG_INFINITY; 3]);
    positions.iter().fold(none, |(lower, upper), at| {
        let each =
            |pick: fn(f32, f32) -> f32, so_far: [f32; 3]| std::array::from_fn(|axis| pick(so_far[axis], at[axis]));
        (each(f32::min, lower), each(f32::max, upper))
    })
}

fn write_binary(writer: &mut impl Write, lit: &LitMesh<'_>, by_material: &BTreeMap<u32, Vec<u32>>) -> io::Result<()> {
    writer.write_all(bytemuck::cast_slice(&lit.mesh.positions))?;
    for radiosity in lit.radiosity {
        let [r, g, b] = radiosity.map(|channel| (65_535.0 * tone_curve(lit.exposure * channel)).round() as u16);
        writer.write_all(bytemuck::cast_slice(&[r, g, b, u16::MAX]))?;
    }
    writer.write_all(bytemuck::cast_slice(lit.radiosity))?;
    for &triangle in by_material.values().flatten() {
        writer.write_all(bytemuck::cast_slice(&lit.mesh.triangles[triangle as usize]))?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;
    use crate::scene::{Material, MaterialId, load_file};
    use crate::solve::{Leaf, Mesh};

    fn square() -> Mesh {
        let leaf = |material| Leaf { material: MaterialId(material), ..Leaf::square_metre(1, 0) };
        Mesh {
            positions: vec![[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, -2.0]],
            triangles: vec![[0, 1, 2], [0, 2, 3]],
            triangle_leaf: vec![0, 1],
            leaves: vec![leaf(1), leaf(0)],
            ..Mesh::default()
        }
    }

    fn materials() -> [Material; 2] {
        let reflectance = Vec3::splat(0.25);
        ["wall", "lamp"].map(|name| Material { name: name.into(), reflectance, ..Material::default() })
    }

    /// Truth: the `gltf` crate's validation and readers, and what was put in.
    #[test]
    fn another_reader_gets_positions_colours_and_watts() {
        let (mesh, materials) = (square(), materials());
        let radiosity = [[0.0, 1.0, 2.0], [3.0, 4.0, 5.0], [600.0, 7.0, 8.0], [9.0, 10.0, 0.25]];
        let lit =
            LitMesh { mesh: &mesh, origin: DVec3::ZERO, radiosity: &radiosity, exposure: 0.1, materials: &materials };
        let mut file = Vec::new();
        write(&mut file, &lit).expect("a Vec takes any bytes");
        let (document, buffers, _) = gltf::import_slice(&file).expect("a valid file");
        let names: Vec<_> =
            document.materials().map(|material| material.name().unwrap_or_default().to_owned()).collect();
        assert_eq!(names, ["wall", "lamp"]);
        let primitives: Vec<_> = document.meshes().next().expect("a mesh").primitives().collect();
        let indices: Vec<Vec<u32>> = primitives
            .iter()
            .map(|primitive| {
                let reader = primitive.reader(|buffer| Some(&buffers[buffer.index()].0));
                reader.read_indices().expect("indices").into_u32().collect()
            })
            .collect();
        assert_eq!(indices, [[0, 2, 3], [0, 1, 2]], "by material");
        let reader = primitives[0].reader(|buffer| Some(&buffers[buffer.index()].0));
        assert_eq!(reader.read_positions().expect("positions").collect::<Vec<_>>(), mesh.positions);
        let colours = reader.read_colors(0).expect("colours").into_rgb_f32();
        for (colour, radiosity) in colours.zip(radiosity) {
            for (shown, radiosity) in colour.into_iter().zip(radiosity) {
                assert!((shown - tone_curve(0.1 * radiosity)).abs() < 1.0 / 65_535.0);
            }
        }
        let (_, watts) = primitives[0]
            .attributes()
            .find(|(semantic, _)| *semantic == gltf::Semantic::Extras("RADIOSITY".into()))
            .expect("the light");
        let view = watts.view().expect("a view");
        let bytes = &buffers[0].0[view.offset()..view.offset() + view.length()];
        assert_eq!(bytes, bytemuck::cast_slice::<[f32; 3], u8>(&radiosity));
    }

    /// Truth: the triangles that went in.
    #[test]
    fn our_own_loader_opens_it() {
        let (mesh, materials) = (square(), materials());
        let lit = LitMesh {
            mesh: &mesh,
            origin: DVec3::ZERO,
            radiosity: &[[1.0; 3]; 4],
            exposure: 1.0,
            materials: &materials,
        };
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("lit.glb");
        let mut file = Vec::new();
        write(&mut file, &lit).expect("a Vec takes any bytes");
        std::fs::write(&path, file).expect("a writable folder");
        let scene = load_file(&path).expect("a good scene");
        let area: f32 = scene.polygons.iter().map(|polygon| scene.area(polygon)).sum();
        let expected: f32 = mesh
            .triangles
            .iter()
            .map(|corners| {
                let [a, b, c] = mesh.corners(*corners);
                0.5 * (b - a).cross(c - a).length()
            })
            .sum();
        assert!(scene.polygons.len() == 2 && (area - expected).abs() < 1e-6);
    }

    #[test]
    fn nothing_is_no_file() {
        let lit =
            LitMesh { mesh: &Mesh::default(), origin: DVec3::ZERO, radiosity: &[], exposure: 1.0, materials: &[] };
        assert!(write(&mut Vec::new(), &lit).is_err());
    }
}
