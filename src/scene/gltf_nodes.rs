//! Where the nodes of a glTF file put their meshes, with all the digits of the file.
//!
//! The `gltf` crate reads translations as f32, which tells 0.06 m apart at 1,000 km.

use glam::{DMat4, DQuat, DVec3};
use serde::Deserialize;

#[derive(Deserialize)]
struct Nodes {
    #[serde(default)]
    nodes: Vec<Place>,
}

#[derive(Deserialize)]
struct Place {
    matrix: Option<[f64; 16]>,
    translation: Option<[f64; 3]>,
    rotation: Option<[f64; 4]>,
    scale: Option<[f64; 3]>,
}

/// The transform of each node into the space of its parent, by the content of a glTF or GLB file that has been parsed already.
///
/// # Errors
/// What is not as the format says.
pub(super) fn parents_from_nodes(bytes: &[u8]) -> Result<Vec<DMat4>, String> {
    let json = match bytes.strip_prefix(b"glTF") {
        // The first chunk: its length, its kind, and the JSON text.
        Some(_) => {
            let length = bytes.get(12..16).map_or(0, |word| u32::from_le_bytes([word[0], word[1], word[2], word[3]]));
            bytes.get(20..).and_then(|rest| rest.get(..length as usize)).unwrap_or_default()
        }
        None => bytes,
    };
    let nodes: Nodes =
        serde_json::from_slice(json).map_err(|error| format!("not understood ({error}); export the scene again"))?;
    Ok(nodes.nodes.iter().map(parent_from_node).collect())
}

fn parent_from_node(node: &Place) -> DMat4 {
    if let Some(matrix) = node.matrix {
        return DMat4::from_cols_array(&matrix);
    }
    let rotation = node.rotation.map_or(DQuat::IDENTITY, DQuat::from_array);
    let rotation = if rotation.length_squared() > 0.0 { rotation.normalize() } else { DQuat::IDENTITY };
    let vector = |value: Option<[f64; 3]>, unsaid| value.map_or(unsaid, DVec3::from_array);
    DMat4::from_scale_rotation_translation(
        vector(node.scale, DVec3::ONE),
        rotation,
        vector(node.translation, DVec3::ZERO),
    )
}
