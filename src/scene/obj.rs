//! OBJ by tobj: polygons as they are, regrouped by object and group name.
//!
//! tobj treats `o` and `g` alike (the last one names the faces) and begins a new model at each `usemtl`; here faces of
//! one name come together again, and `/` in a name separates the levels of the scene's hierarchy.

use std::path::Path;

use glam::DVec3;

use super::draft::scene_name;
use super::draft::{Draft, DraftMaterial, MOST_POLYGONS};
use super::files::SceneFiles;
use super::load_error::LoadError;
use super::mtl::MaterialLibrary;
use super::obj_text::{ObjText, UNNAMED, material_key, plain_text};
use super::said::{quoted, sentence};

/// Reads an OBJ file and its material files.
///
/// # Errors
/// The first line that cannot be used.
pub(super) fn read(path: &Path, bytes: &[u8], files: &dyn SceneFiles) -> Result<Draft, LoadError> {
    let text = plain_text(path, bytes)?;
    if text.faces > MOST_POLYGONS {
        return Err(LoadError::TooLarge { path: path.to_owned(), count: text.faces, most: MOST_POLYGONS });
    }
    let mut draft = Draft::new(&scene_name(path));
    if text.lines_and_points > 0 {
        let count = text.lines_and_points;
        draft.skipped.note(format!("Lines and points have no area and are left out ({count})."));
    }
    add_materials(&mut draft, &text, files);
    let models = parse(path, &text)?;
    for model in &models {
        add_model(&mut draft, model);
    }
    Ok(draft)
}

/// All materials that the file uses, in that order, so that tobj's material numbers are the draft's.
fn add_materials(draft: &mut Draft, text: &ObjText, files: &dyn SceneFiles) {
    let skipped = &mut draft.skipped;
    let library = MaterialLibrary::read(files, &text.material_files, skipped);
    if text.material_files.is_empty() && !text.material_names.is_empty() {
        skipped.note("The scene names no material file; its materials are grey.");
    }
    let mut unknown = Vec::new();
    for name in &text.material_names {
        let key = material_key(name);
        draft.materials.push(library.get(name).unwrap_or_else(|| {
            unknown.push(quoted(&key));
            DraftMaterial::undefined(&key)
        }));
    }
    draft.unused_materials = library.names().cloned().collect();
    if !unknown.is_empty() && !text.material_files.is_empty() {
        let count = unknown.len();
        unknown.truncate(5);
        let more = if count > 5 { format!(" and {} more", count - 5) } else { String::new() };
        let names = unknown.join(", ");
        skipped.note(format!("No material file defines {names}{more}: grey instead."));
    }
}

fn parse(path: &Path, text: &ObjText) -> Result<Vec<tobj::Model>, LoadError> {
    let material_of_name = || {
        let named = |name: &String| tobj::Material { name: material_key(name), ..Default::default() };
        let materials: Vec<tobj::Material> = text.material_names.iter().map(named).collect();
        let numbers = materials.iter().enumerate().map(|(number, material)| (material.name.clone(), number)).collect();
        Ok((materials, numbers))
    };
    let options = tobj::LoadOptions { ignore_points: true, ignore_lines: true, ..Default::default() };
    let (models, _) =
        tobj::load_obj_buf(&mut text.plain.as_bytes(), &options, |_| material_of_name()).map_err(|error| {
            let problem = sentence(&format!("not understood ({error}); export the scene again"));
            LoadError::Parse { path: path.to_owned(), place: "as OBJ".to_owned(), problem }
        })?;
    Ok(models)
}

fn add_model(draft: &mut Draft, model: &tobj::Model) {
    let mesh = &model.mesh;
    if mesh.indices.is_empty() {
        return;
    }
    let group = draft.group_at(if model.name == UNNAMED { "" } else { &model.name });
    let material = match mesh.material_id {
        Some(number) => number as u32,
        None => grey(draft),
    };
    let first = draft.vertices.len() as u32;
    draft.vertices.extend(mesh.positions.chunks_exact(3).map(DVec3::from_slice));
    let mut rest = mesh.indices.as_slice();
    let mut corners = Vec::new();
    let all_triangles = mesh.indices.len() / 3;
    let triangles = std::iter::repeat_n(3, if mesh.face_arities.is_empty() { all_triangles } else { 0 });
    for count in mesh.face_arities.iter().copied().chain(triangles) {
        let (face, behind) = rest.split_at(count as usize);
        rest = behind;
        corners.clear();
        corners.extend(face.iter().map(|index| first + index));
        draft.add_face(&corners, material, group);
    }
}

/// The material of faces that come before any `usemtl`.
fn grey(draft: &mut Draft) -> u32 {
    const NAME: &str = "(no material)";
    let found = draft.materials.iter().position(|material| !material.defined && material.name == NAME);
    found.unwrap_or_else(|| {
        draft.materials.push(DraftMaterial::undefined(NAME));
        draft.materials.len() - 1
    }) as u32
}
