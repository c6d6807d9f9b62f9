//! Meshes: primitives in the space of their mesh, with what pictures need of their vertices.

use glam::{DMat4, DVec3, Vec2, Vec3, Vec4};
use gltf::json::mesh::{Mesh, Mode, Primitive, Semantic};
use gltf::json::validation::Checked;
use gltf::json::{Index, accessor::Accessor};

use super::buffers::{GltfData, Problem};
use super::compression::DracoMesh;
use super::materials::UvSets;
use crate::scene::face::{packed_colour, packed_normal};

/// A primitive in the space of its mesh.
pub(super) struct Part {
    pub positions: Vec<Vec3>,
    pub uvs: Option<Vec<Vec2>>,
    pub emission_uvs: Option<Vec<Vec2>>,
    pub normals: Option<Vec<Vec3>>,
    pub colours: Option<Vec<[u16; 4]>>,
    /// Numbers of a skin's joints and how much each moves a vertex.
    pub joints: Option<[Vec<[f64; 4]>; 2]>,
    pub triangles: Vec<[u32; 3]>,
    pub material: Option<u32>,
}

/// A mesh has lost its shape where its coordinates are rounded to this share of its size: light is
/// wrong by about half a percent.
const LOST: f32 = 1e-3;

/// Rounding of the coordinates of a mesh, if that is more than [`LOST`] of its size: it lies far
/// from its own zero. Coordinates that all have spare digits were exact and lost nothing.
pub(super) fn coarse_rounding(parts: &[Part]) -> Option<f32> {
    let all = || parts.iter().flat_map(|part| &part.positions);
    let (lower, upper) =
        all().fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(lower, upper), at| (lower.min(*at), upper.max(*at)));
    let size = (upper - lower).max_element();
    let rounding = |axis: usize| {
        let largest = lower[axis].abs().max(upper[axis].abs());
        let unit = largest.next_up() - largest;
        let is_exact = || all().all(|at| (at[axis] / (4.0 * unit)).fract() == 0.0);
        (unit.is_finite() && unit > LOST * size && !is_exact()).then_some(unit)
    };
    (0..3).filter_map(rounding).reduce(f32::max)
}

/// Where the attributes of a primitive come from.
enum Source<'a> {
    Accessors(&'a Primitive),
    Draco { mesh: DracoMesh, ids: serde_json::Map<String, serde_json::Value>, primitive: &'a Primitive },
}

impl Source<'_> {
    fn values<const N: usize>(&self, data: &GltfData, semantic: &Semantic) -> Result<Option<Vec<[f64; N]>>, Problem> {
        let accessor = |primitive: &Primitive| primitive.attributes.get(&Checked::Valid(semantic.clone())).copied();
        match self {
            Self::Accessors(primitive) => accessor(primitive).map(|index| data.vectors::<N>(index)).transpose(),
            Self::Draco { mesh, ids, primitive } => {
                let Some(id) = ids.get(&semantic.to_string()).and_then(serde_json::Value::as_u64) else {
                    // What is not compressed may stand beside it.
                    return accessor(primitive).map(|index| data.vectors::<N>(index)).transpose();
                };
                let normalized = accessor(primitive)
                    .and_then(|index| data.root.accessors.get(index.value()))
                    .is_some_and(|accessor| accessor.normalized);
                let values = mesh.values::<N>(id as u32, normalized);
                Ok(values.map(|values| values.into_iter().map(|value| value.map(f64::from)).collect()))
            }
        }
    }

    /// Number of components of an attribute.
    fn components(&self, data: &GltfData, semantic: &Semantic) -> usize {
        let of_accessor = |primitive: &Primitive| {
            let index = primitive.attributes.get(&Checked::Valid(semantic.clone()))?;
            data.components(*index)
        };
        match self {
            Self::Accessors(primitive) => of_accessor(primitive).unwrap_or(0),
            Self::Draco { mesh, ids, primitive } => {
                let id = ids.get(&semantic.to_string()).and_then(serde_json::Value::as_u64);
                let of_mesh = id.and_then(|id| mesh.components(id as u32)).map(usize::from);
                of_mesh.or_else(|| of_accessor(primitive)).unwrap_or(0)
            }
        }
    }
}

/// Reads a primitive whose material uses some sets of texture coordinates; `None` for lines and
/// points.
pub(super) fn read_primitive(
    data: &GltfData,
    mesh: &Mesh,
    primitive: &Primitive,
    weights: &[f32],
    uv_sets: UvSets,
) -> Result<Option<Part>, Problem> {
    let Checked::Valid(mode) = primitive.mode else { return Ok(None) };
    if !matches!(mode, Mode::Triangles | Mode::TriangleStrip | Mode::TriangleFan) {
        return Ok(None);
    }
    let compressed = primitive.extensions.as_ref().and_then(|it| it.others.get("KHR_draco_mesh_compression"));
    let source = match compressed {
        Some(said) => {
            let view = said["bufferView"].as_u64().ok_or("its compression names no buffer view")?;
            let ids = said["attributes"].as_object().cloned().unwrap_or_default();
            Source::Draco { mesh: DracoMesh::decode(data.view_bytes(Index::new(view as u32))?)?, ids, primitive }
        }
        None => Source::Accessors(primitive),
    };
    let positions = source.values::<3>(data, &Semantic::Positions)?.ok_or("it has no positions")?;
    let mut positions: Vec<Vec3> = positions.into_iter().map(vec3).collect();
    let count = positions.len();
    let indices = match (&source, primitive.indices) {
        (Source::Draco { mesh, .. }, _) => mesh.indices(),
        (_, Some(indices)) => data.indices(indices)?,
        (_, None) => (0..count as u32).collect(),
    };
    add_morphs(data, mesh, primitive, weights, &mut positions)?;
    // What is shorter than the positions belongs to no vertex.
    let uvs = |set: u32| -> Result<Option<Vec<Vec2>>, Problem> {
        let uvs = source.values::<2>(data, &Semantic::TexCoords(set))?.filter(|it| it.len() == count);
        Ok(uvs.map(|uvs| uvs.into_iter().map(|[u, v]| Vec2::new(u as f32, v as f32)).collect()))
    };
    let emission_uvs = uv_sets.of_emission.map(uvs).transpose()?.flatten();
    let uvs = uvs(uv_sets.first)?;
    let normals = source.values::<3>(data, &Semantic::Normals)?.filter(|it| it.len() == count);
    let colours = colours(&source, data)?.filter(|it| it.len() == count);
    let joints = source.values::<4>(data, &Semantic::Joints(0))?.filter(|it| it.len() == count);
    let shares = source.values::<4>(data, &Semantic::Weights(0))?.filter(|it| it.len() == count);
    Ok(Some(Part {
        positions,
        uvs,
        emission_uvs,
        normals: normals.map(|normals| normals.into_iter().map(vec3).collect()),
        colours,
        joints: joints.zip(shares).map(Into::into),
        triangles: triangles(if compressed.is_some() { Mode::Triangles } else { mode }, &indices),
        material: primitive.material.map(|material| material.value() as u32),
    }))
}

fn vec3(value: [f64; 3]) -> Vec3 {
    Vec3::from_array(value.map(|value| value as f32))
}

fn colours(source: &Source<'_>, data: &GltfData) -> Result<Option<Vec<[u16; 4]>>, Problem> {
    let semantic = Semantic::Colors(0);
    let packed = |[r, g, b, a]: [f64; 4]| packed_colour(Vec4::new(r as f32, g as f32, b as f32, a as f32));
    Ok(match source.components(data, &semantic) {
        3 => source
            .values::<3>(data, &semantic)?
            .map(|it| it.into_iter().map(|[r, g, b]| packed([r, g, b, 1.0])).collect()),
        4 => source.values::<4>(data, &semantic)?.map(|it| it.into_iter().map(packed).collect()),
        _ => None,
    })
}

/// Moves vertices by morph targets, as far as they count at rest.
fn add_morphs(
    data: &GltfData,
    mesh: &Mesh,
    primitive: &Primitive,
    weights: &[f32],
    positions: &mut [Vec3],
) -> Result<(), Problem> {
    let weights = if weights.is_empty() { mesh.weights.as_deref().unwrap_or_default() } else { weights };
    let targets = primitive.targets.iter().flatten().zip(weights).filter(|(_, weight)| **weight != 0.0);
    for (target, weight) in targets {
        let Some(moves) = target.positions else { continue };
        for (position, [x, y, z]) in positions.iter_mut().zip(data.vectors::<3>(moves)?) {
            *position += *weight * Vec3::new(x as f32, y as f32, z as f32);
        }
    }
    Ok(())
}

/// Matrices that a skin's joints move vertices by at rest.
pub(super) fn joint_matrices(
    data: &GltfData,
    joints: &[usize],
    inverse: Option<Index<Accessor>>,
    worlds: &[DMat4],
) -> Result<Vec<DMat4>, Problem> {
    let inverse = inverse.map(|index| data.vectors::<16>(index)).transpose()?;
    let matrix = |(place, joint): (usize, &usize)| {
        let world = worlds.get(*joint).copied().unwrap_or(DMat4::IDENTITY);
        let from_mesh =
            inverse.as_ref().and_then(|list| list.get(place)).map_or(DMat4::IDENTITY, DMat4::from_cols_array);
        world * from_mesh
    };
    Ok(joints.iter().enumerate().map(matrix).collect())
}

impl Part {
    /// Where its vertices are in the file's coordinates.
    pub fn placed(&self, world: DMat4, skin: Option<&[DMat4]>) -> Vec<DVec3> {
        let matrix = |vertex: usize| match (skin, &self.joints) {
            (Some(matrices), Some([joints, shares])) => {
                let (joints, shares) = (joints[vertex], shares[vertex]);
                let total: f64 = shares.iter().sum();
                let of_joint = |place: usize| {
                    let joint = matrices.get(joints[place] as usize).copied().unwrap_or(DMat4::IDENTITY);
                    joint * (shares[place] / total)
                };
                if total > 0.0 { of_joint(0) + of_joint(1) + of_joint(2) + of_joint(3) } else { world }
            }
            _ => world,
        };
        let place = |(vertex, position): (usize, &Vec3)| (matrix(vertex) * position.as_dvec3().extend(1.0)).truncate();
        self.positions.iter().enumerate().map(place).collect()
    }

    /// Packed normals in the scene, turned as a transform turns planes.
    pub fn placed_normals(&self, world: DMat4) -> Option<Vec<Option<[i16; 2]>>> {
        let turn = glam::DMat3::from_mat4(world).inverse().transpose();
        let turn = if turn.is_finite() { turn } else { glam::DMat3::from_mat4(world) };
        let packed = |normal: &Vec3| packed_normal((turn * normal.as_dvec3()).as_vec3()).filter(|_| normal.is_finite());
        self.normals.as_ref().map(|normals| normals.iter().map(packed).collect())
    }
}

/// The triangles of a list, strip or fan, all wound as the first one.
fn triangles(mode: Mode, indices: &[u32]) -> Vec<[u32; 3]> {
    match mode {
        Mode::TriangleStrip => indices
            .windows(3)
            .enumerate()
            .map(|(number, corners)| match number % 2 {
                0 => [corners[0], corners[1], corners[2]],
                _ => [corners[1], corners[0], corners[2]],
            })
            .collect(),
        Mode::TriangleFan => indices
            .iter()
            .skip(1)
            .zip(indices.iter().skip(2))
            .map(|(&second, &third)| [indices[0], second, third])
            .collect(),
        _ => indices.chunks_exact(3).map(|corners| [corners[0], corners[1], corners[2]]).collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Truth: the glTF 2.0 specification, section 3.7.2.1: every triangle of a strip keeps the
    /// winding of the first.
    #[test]
    fn strips_and_fans_keep_their_winding() {
        assert_eq!(triangles(Mode::TriangleStrip, &[0, 1, 2, 3, 4]), [[0, 1, 2], [2, 1, 3], [2, 3, 4]]);
        assert_eq!(triangles(Mode::TriangleFan, &[0, 1, 2, 3]), [[0, 1, 2], [0, 2, 3]]);
        assert_eq!(triangles(Mode::Triangles, &[0, 1, 2, 3, 4]), [[0, 1, 2]]);
        assert!(triangles(Mode::TriangleStrip, &[0]).is_empty() && triangles(Mode::TriangleFan, &[]).is_empty());
    }
}
