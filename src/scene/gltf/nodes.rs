//! Where the nodes of a glTF file put their meshes, with all the digits of the file.
//!
//! The `gltf` crate reads translations as f32, which tells 0.06 m apart at 1,000 km.

use glam::{DMat4, DQuat, DVec3};
use serde::Deserialize;
use serde_json::Value;

#[derive(Deserialize)]
struct Place {
    matrix: Option<[f64; 16]>,
    translation: Option<[f64; 3]>,
    rotation: Option<[f64; 4]>,
    scale: Option<[f64; 3]>,
}

/// The transform of each node into the space of its parent, by the document of a file.
///
/// # Errors
/// Nodes that are not as the format says.
pub(super) fn parents_from_nodes(json: &Value) -> Result<Vec<DMat4>, String> {
    let place = |node: &Value| {
        let place = Place::deserialize(node);
        place.map_err(|error| format!("not understood ({error}); export the scene again"))
    };
    let nodes = json.get("nodes").and_then(Value::as_array).into_iter().flatten();
    nodes.map(|node| Ok(parent_from_node(&place(node)?))).collect()
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
