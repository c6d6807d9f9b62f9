//! glTF and GLB by the `gltf` crate: the node tree is the hierarchy, transforms are applied,
//! instances copied.
//!
//! Base colour is reflectance (of metals too: there is no gloss here), emission a radiance (B_e =
//! π·value).

mod buffers;
mod compression;
mod extensions;
mod extras;
mod materials;
mod mesh;
mod nodes;
mod walk;

use glam::DMat4;
use gltf::json::Root;
use gltf::json::mesh::Semantic;
use gltf::json::validation::{Checked, Error, Validate};
use serde_json::Value;

use super::draft::Draft;
use super::files::SceneFiles;
use super::load_error::Fault;
use super::sanitize::sentence;
use super::up::UpAxis;
use buffers::{GltfData, Problem};

/// Extensions that hold the picture of a texture; those whose format is not read cost the texture
/// alone.
const PICTURES: [&str; 4] = ["EXT_texture_webp", "MSFT_texture_dds", "EXT_texture_avif", "KHR_texture_basisu"];

/// Reads a glTF or GLB file with its buffers and textures.
///
/// # Errors
/// One sentence with the part of the file that cannot be used.
pub(super) fn read(name: &str, bytes: &[u8], files: &dyn SceneFiles) -> Result<Draft, Fault> {
    let parse_error = |problem: Problem| Fault::Parse("as glTF".to_owned(), sentence(&problem));
    let mut draft = Draft::new(name);
    let Document { root, blob, parents_from_nodes } = parse(bytes, &mut draft).map_err(parse_error)?;
    let root = &root;
    let data = GltfData::read(files, root, blob).map_err(parse_error)?;
    draft.prescribed_up = Some(UpAxis::Y);
    draft.skipped.animations = root.animations.len();
    let uv_sets = materials::add_materials(&mut draft, &data);
    walk::run(&data, parents_from_nodes, draft, &uv_sets)
}

/// A file's content, checked by the crate.
struct Document {
    root: Root,
    /// The binary chunk.
    blob: Option<Vec<u8>>,
    /// Of each node, into the space of its parent.
    parents_from_nodes: Vec<DMat4>,
}

fn parse(bytes: &[u8], draft: &mut Draft) -> Result<Document, Problem> {
    let damaged = |error: gltf::Error| format!("not understood ({error}); the file is damaged or cut off");
    let (text, blob) = if bytes.starts_with(b"glTF") {
        let length = bytes.get(8..12).map_or(0, |word| u32::from_le_bytes([word[0], word[1], word[2], word[3]]));
        // The crate subtracts the header's size from this length without looking.
        if length < 20 || (length as usize) > bytes.len() {
            let there = bytes.len();
            return Err(format!("the header tells of {length} bytes but there are {there}; the file is cut off"));
        }
        let glb = gltf::Glb::from_slice(bytes).map_err(damaged)?;
        (glb.json, glb.bin.map(std::borrow::Cow::into_owned))
    } else {
        (std::borrow::Cow::Borrowed(bytes), None)
    };
    let text = text.strip_prefix(b"\xef\xbb\xbf").unwrap_or(&text);
    let not_json = |error: serde_json::Error| {
        format!("not understood ({}); the file is damaged or cut off", sentence(&error.to_string()))
    };
    let mut json: Value = serde_json::from_slice(text).map_err(not_json)?;
    choose_pictures(&mut json);
    let parents_from_nodes = nodes::parents_from_nodes(&json)?;
    let mut root: Root = serde_json::from_value(json).map_err(not_json)?;
    draft.skipped.unread_extensions = extensions::unread(&root);
    // The crate refuses those that it does not know itself.
    root.extensions_required.clear();
    extensions::check_numbers(&root)?;
    prepare_for_validation(&mut root)?;
    let mut first = None;
    root.validate(&root, gltf::json::Path::new, &mut |place, error| {
        // Draco keeps the data of such accessors; one that has none is reported when it is read.
        let is_elsewhere = error == Error::Missing && place().0.ends_with(".bufferView");
        if first.is_none() && !is_elsewhere {
            first = Some(format!("not valid ({}: {error}); export the scene again", place()));
        }
    });
    match first {
        Some(problem) => Err(problem),
        None => Ok(Document { root, blob, parents_from_nodes }),
    }
}

/// Gives each texture the picture that can be read best: its own, or one of an extension.
fn choose_pictures(json: &mut Value) {
    let count = json.get("images").and_then(Value::as_array).map_or(0, Vec::len) as u64;
    for texture in json.get_mut("textures").and_then(Value::as_array_mut).into_iter().flatten() {
        let is_there = |source: &Value| source.as_u64().is_some_and(|source| source < count);
        if texture.get("source").is_some_and(is_there) {
            continue;
        }
        let source = |name: &&str| texture.get("extensions")?.get(*name)?.get("source").cloned();
        let other = PICTURES.iter().filter_map(source).find(is_there);
        match (other, texture.as_object_mut()) {
            (Some(source), Some(texture)) => {
                texture.insert("source".to_owned(), source);
            }
            (None, Some(texture)) => {
                // The crate asks for one; see `materials`.
                texture.insert("source".to_owned(), Value::from(count));
            }
            _ => {}
        }
    }
}

/// Mends parts that the crate's validation would refuse or trip over, though nothing here needs
/// them: bounds of positions, which some exporters forget; accessors of positions, which it looks
/// up unchecked; textures without a picture; animations.
fn prepare_for_validation(root: &mut Root) -> Result<(), Problem> {
    for (mesh, primitive) in
        root.meshes.iter().enumerate().flat_map(|(mesh, it)| it.primitives.iter().map(move |part| (mesh, part)))
    {
        if let Some(positions) = primitive.attributes.get(&Checked::Valid(Semantic::Positions)) {
            let number = positions.value();
            let accessor = root.accessors.get_mut(number);
            let accessor =
                accessor.ok_or_else(|| format!("mesh {mesh} asks for accessor {number}, which is not there"))?;
            let unknown = serde_json::json!([0.0, 0.0, 0.0]);
            (accessor.min, accessor.max) = (Some(unknown.clone()), Some(unknown));
        }
    }
    let count = root.images.len();
    if root.textures.iter().any(|texture| texture.source.value() >= count) {
        root.images.push(serde_json::from_value(serde_json::json!({"uri": ""})).map_err(|error| error.to_string())?);
        for texture in root.textures.iter_mut().filter(|texture| texture.source.value() >= count) {
            texture.source = gltf::json::Index::new(count as u32);
        }
    }
    Ok(())
}
