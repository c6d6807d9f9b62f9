//! glTF and GLB by the `gltf` crate: the node tree is the hierarchy, transforms are applied, instances copied.
//!
//! Base colour is reflectance (of metals too: there is no gloss here), emission a radiance (B_e = π·value).

use std::collections::HashMap;
use std::f32::consts::PI;
use std::path::Path;

use glam::{DMat4, Vec3, Vec4};
use gltf::json::mesh::{Mode, Primitive, Semantic};
use gltf::json::validation::Checked;
use gltf::{Document, Gltf};
use rustc_hash::FxHashMap;

use super::GroupId;
use super::draft::scene_name;
use super::draft::{Draft, DraftMaterial, MOST_POLYGONS};
use super::files::SceneFiles;
use super::gltf_buffers::{GltfData, Problem};
use super::gltf_nodes::parents_from_nodes;
use super::load_error::LoadError;
use super::place::{Reach, is_usable};
use super::said::{self, quoted, sentence};
use super::texture::mean_colours;

/// Extensions that change nothing here, so that a file which requires them can be read all the same.
const HARMLESS: [&str; 3] = ["KHR_texture_transform", "KHR_mesh_quantization", "KHR_materials_"];

/// Reads a glTF or GLB file with its buffers and textures.
///
/// # Errors
/// One sentence with the part of the file that cannot be used.
pub(super) fn read(path: &Path, bytes: &[u8], files: &dyn SceneFiles) -> Result<Draft, LoadError> {
    let parse_error = |problem: Problem| {
        let (place, problem) = ("as glTF".to_owned(), sentence(&problem));
        LoadError::Parse { path: path.to_owned(), place, problem }
    };
    let (document, blob) = parse(bytes).map_err(parse_error)?;
    let data = GltfData::read(files, document.as_json(), blob).map_err(parse_error)?;
    let mut draft = Draft::new(&scene_name(path));
    add_materials(&mut draft, &document, &data);
    let mut walk = Walk {
        path,
        data: &data,
        draft,
        meshes: FxHashMap::default(),
        grey: None,
        parents_from_nodes: parents_from_nodes(bytes).map_err(parse_error)?,
        areas_missing: 0,
        reach: Reach::new(),
        rounded: (0, 0.0),
        decoded: 0,
    };
    let lights = walk.run()?;
    let Walk { mut draft, areas_missing, reach, rounded, .. } = walk;
    if let Some(place) = reach.too_far() {
        return Err(coordinate_error(path, place));
    }
    if let (meshes @ 1.., unit) = rounded {
        draft.skipped.note(format!(
            "The file's own coordinates are too far from zero and have lost the shape of its meshes ({meshes}), to {unit}: export with the meshes near zero and let a node move them."
        ));
    }
    if areas_missing > 0 {
        draft.skipped.note(format!("Lines and points have no area and are left out ({areas_missing})."));
    }
    if let Some((first, more)) = lights.split_first() {
        let shown = more.iter().take(4).fold(said::name(first), |names, name| names + ", " + &said::name(name));
        let and_more = if lights.len() > 5 { format!(" and {} more", lights.len() - 5) } else { String::new() };
        draft.skipped.ignored_lights = lights.len();
        draft.skipped.note(format!("Ignored because they are no surfaces: the lights {shown}{and_more}."));
    }
    Ok(draft)
}

/// The document, checked by the crate, and the binary chunk.
fn parse(bytes: &[u8]) -> Result<(Document, Option<Vec<u8>>), Problem> {
    let damaged = |error: gltf::Error| match error {
        gltf::Error::Validation(errors) => {
            let first = errors.first().map(|(place, error)| format!("{place}: {error}")).unwrap_or_default();
            format!("not valid ({first}); export the scene again")
        }
        other => format!("not understood ({other}); the file is damaged or cut off"),
    };
    if bytes.starts_with(b"glTF") {
        let length = bytes.get(8..12).map_or(0, |word| u32::from_le_bytes([word[0], word[1], word[2], word[3]]));
        // The crate subtracts the header's size from this length without looking.
        if length < 20 || (length as usize) > bytes.len() {
            let there = bytes.len();
            return Err(format!("the header tells of {length} bytes but there are {there}; the file is cut off"));
        }
    }
    let Gltf { document, blob } = Gltf::from_slice_without_validation(bytes).map_err(damaged)?;
    let mut root = document.into_json();
    root.extensions_required.retain(|name| !HARMLESS.iter().any(|harmless| name.starts_with(harmless)));
    if let Some(compressed) = root.extensions_required.iter().find(|name| name.contains("compression")) {
        return Err(format!(
            "the geometry is compressed ({}), which is not read; export without compression",
            quoted(compressed)
        ));
    }
    prepare_for_validation(&mut root)?;
    Ok((Document::from_json(root).map_err(damaged)?, blob))
}

/// The crate's validation looks up the accessor of positions unchecked, and asks for bounds, which nothing here needs
/// and some exporters forget.
fn prepare_for_validation(root: &mut gltf::json::Root) -> Result<(), Problem> {
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
    Ok(())
}

/// Materials in the order of the file, so that its material numbers are the draft's.
fn add_materials(draft: &mut Draft, document: &Document, data: &GltfData) {
    let means = image_means(draft, document, data);
    for (index, material) in document.materials().enumerate() {
        let name = material.name().map_or_else(|| format!("material_{index}"), str::to_owned);
        let mean = |info: Option<gltf::texture::Info>| {
            info.and_then(|info| means.get(&info.texture().source().index()).copied()).unwrap_or(Vec4::ONE)
        };
        let surface = material.pbr_metallic_roughness();
        let base = Vec4::from_array(surface.base_color_factor()) * mean(surface.base_color_texture());
        let strength = material.emissive_strength().unwrap_or(1.0);
        let glow = Vec3::from_array(material.emissive_factor()) * mean(material.emissive_texture()).truncate();
        let transmits = material.transmission().is_some_and(|it| it.transmission_factor() > 0.5);
        let sound = |value: Vec3| if value.is_finite() { value } else { Vec3::ZERO };
        draft.materials.push(DraftMaterial {
            name,
            reflectance: sound(base.truncate()),
            emission: sound(PI * strength * glow),
            transparent: transmits || material.alpha_mode() == gltf::material::AlphaMode::Blend,
            defined: true,
        });
    }
    let unread = "KHR_materials_pbrSpecularGlossiness";
    if document.as_json().extensions_used.iter().any(|name| name == unread) {
        draft.skipped.note(format!("Colours given by the old extension {unread} are not read."));
    }
}

/// Mean colours by image number, of the images that matter here.
fn image_means(draft: &mut Draft, document: &Document, data: &GltfData) -> FxHashMap<usize, Vec4> {
    let used = document
        .materials()
        .flat_map(|material| [material.pbr_metallic_roughness().base_color_texture(), material.emissive_texture()]);
    let mut numbers: Vec<usize> = used.flatten().map(|info| info.texture().source().index()).collect();
    numbers.sort_unstable();
    numbers.dedup();
    // Many images can be one picture.
    let mut sources: Vec<usize> = Vec::new();
    let mut source_of: HashMap<_, usize> = HashMap::new();
    let place = |number: &usize| {
        let source = data.root.images.get(*number).map(|image| (image.buffer_view, &image.uri));
        *source_of.entry(source).or_insert_with(|| {
            sources.push(*number);
            sources.len() - 1
        })
    };
    let places: Vec<usize> = numbers.iter().map(place).collect();
    let means = mean_colours(&sources, |number| {
        let image = data.root.images.get(*number).ok_or("there is no such image")?;
        data.image(image)
    });
    let mut known = FxHashMap::default();
    for (number, place) in numbers.into_iter().zip(places) {
        match &means[place] {
            Ok(mean) => {
                known.insert(number, *mean);
            }
            Err(problem) => draft.skipped.note(format!("The texture of image {number} is not used: {problem}.")),
        }
    }
    known
}

/// A mesh has lost its shape where its coordinates are rounded to this share of its size: light is wrong by about half a percent.
const LOST: f32 = 1e-3;

/// What the coordinates of a mesh are rounded to, if that is more than [`LOST`] of its size: it lies far from its own zero. Coordinates
/// that all have spare digits were exact and lost nothing.
fn coarse_rounding(parts: &[Part]) -> Option<f32> {
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

fn coordinate_error(path: &Path, (node, mesh, number): (usize, usize, usize)) -> LoadError {
    let (place, vertex) = (format!("node {node}, mesh {mesh}"), format!("vertex {number}"));
    LoadError::Coordinate { path: path.to_path_buf(), place, vertex }
}

/// A primitive in the space of its mesh.
struct Part {
    positions: Vec<Vec3>,
    triangles: Vec<[u32; 3]>,
    material: Option<u32>,
}

/// The way through the node tree.
struct Walk<'a> {
    path: &'a Path,
    data: &'a GltfData<'a>,
    draft: Draft,
    meshes: FxHashMap<usize, Vec<Part>>,
    /// Of each node, into the space of its parent.
    parents_from_nodes: Vec<DMat4>,
    /// The material of primitives without one, once there is such a primitive.
    grey: Option<u32>,
    /// Primitives of lines or points.
    areas_missing: usize,
    /// How far vertices reach, by their nodes, meshes and numbers.
    reach: Reach<(usize, usize, usize)>,
    /// Meshes whose coordinates are rounded to more than [`LOST`] of their size, and the coarsest rounding among them.
    rounded: (usize, f32),
    /// Vertices and triangles of all meshes read so far: many primitives can share one accessor.
    decoded: usize,
}

impl Walk<'_> {
    /// Visits every node of the scene, parents first and in the file's order; returns the names of the lights.
    fn run(&mut self) -> Result<Vec<String>, LoadError> {
        let root = self.data.root;
        let mut lights = Vec::new();
        let mut visited = vec![false; root.nodes.len()];
        let mut waiting: Vec<(usize, GroupId, DMat4)> =
            self.root_nodes().into_iter().rev().map(|node| (node, GroupId(0), DMat4::IDENTITY)).collect();
        while let Some((index, parent, world_from_parent)) = waiting.pop() {
            let place = || format!("node {index}");
            let node = root.nodes.get(index).ok_or_else(|| self.problem(place(), "there is no such node".into()))?;
            if std::mem::replace(&mut visited[index], true) {
                return Err(self.problem(place(), "it has two parents or is its own ancestor".into()));
            }
            let name = node.name.clone().unwrap_or_else(|| format!("node_{index}"));
            let world_from_node = world_from_parent * self.parents_from_nodes.get(index).copied().unwrap_or_default();
            let group = self.draft.add_group(&name, parent);
            if let Some(light) = node.extensions.as_ref().and_then(|it| it.khr_lights_punctual.as_ref()) {
                let lights_of_root = root.extensions.as_ref().and_then(|it| it.khr_lights_punctual.as_ref());
                let light = lights_of_root.and_then(|it| it.lights.get(light.light.value()));
                lights.push(light.and_then(|light| light.name.clone()).unwrap_or(name));
            }
            if let Some(mesh) = node.mesh {
                self.add_instance(mesh.value(), group, world_from_node, index)?;
            }
            let children = node.children.iter().flatten().rev();
            waiting.extend(children.map(|child| (child.value(), group, world_from_node)));
        }
        Ok(lights)
    }

    /// The roots of the default scene, of the first scene, or of all nodes.
    fn root_nodes(&self) -> Vec<usize> {
        let root = self.data.root;
        if let Some(scene) = root.scenes.get(root.scene.map_or(0, |scene| scene.value())) {
            return scene.nodes.iter().map(gltf::json::Index::value).collect();
        }
        let mut is_child = vec![false; root.nodes.len()];
        for child in root.nodes.iter().flat_map(|node| node.children.iter().flatten()) {
            if let Some(slot) = is_child.get_mut(child.value()) {
                *slot = true;
            }
        }
        (0..root.nodes.len()).filter(|&node| !is_child[node]).collect()
    }

    /// Copies a mesh to where a node puts it.
    fn add_instance(&mut self, mesh: usize, group: GroupId, world: DMat4, node: usize) -> Result<(), LoadError> {
        if !self.meshes.contains_key(&mesh) {
            let parts = self.read_mesh(mesh)?;
            if let Some(rounding) = coarse_rounding(&parts) {
                self.rounded = (self.rounded.0 + 1, self.rounded.1.max(rounding));
            }
            self.meshes.insert(mesh, parts);
        }
        let Self { path, draft, meshes, grey, reach, .. } = self;
        let mirrored = world.determinant() < 0.0;
        for part in &meshes[&mesh] {
            let count = draft.faces.len().saturating_add(part.triangles.len());
            let vertices = draft.vertices.len().saturating_add(part.positions.len());
            if count.max(vertices / 3) > MOST_POLYGONS {
                return Err(LoadError::TooLarge { path: path.to_path_buf(), count, most: MOST_POLYGONS });
            }
            let material = part.material.unwrap_or_else(|| {
                *grey.get_or_insert_with(|| {
                    draft.materials.push(DraftMaterial::undefined("(no material)"));
                    draft.materials.len() as u32 - 1
                })
            });
            let first = draft.vertices.len() as u32;
            for (number, position) in part.positions.iter().enumerate() {
                let position = world.transform_point3(position.as_dvec3());
                if !position.to_array().into_iter().all(is_usable) {
                    return Err(coordinate_error(path, (node, mesh, number)));
                }
                reach.add(position, (node, mesh, number));
                draft.vertices.push(position);
            }
            for &[a, b, c] in &part.triangles {
                let [a, b, c] = if mirrored { [a, c, b] } else { [a, b, c] };
                draft.add_face(&[first + a, first + b, first + c], material, group);
            }
        }
        Ok(())
    }

    fn read_mesh(&mut self, mesh: usize) -> Result<Vec<Part>, LoadError> {
        let place = |part: usize| format!("mesh {mesh}, primitive {part}");
        let primitives = self.data.root.meshes.get(mesh).map_or(&[][..], |mesh| &mesh.primitives);
        let mut parts = Vec::with_capacity(primitives.len());
        for (number, primitive) in primitives.iter().enumerate() {
            let Checked::Valid(mode) = primitive.mode else { continue };
            if !matches!(mode, Mode::Triangles | Mode::TriangleStrip | Mode::TriangleFan) {
                self.areas_missing += 1;
                continue;
            }
            let (positions, indices) =
                self.read_primitive(primitive).map_err(|problem| self.problem(place(number), problem))?;
            let triangles = triangles(mode, &indices);
            let count = positions.len();
            self.decoded = self.decoded.saturating_add(triangles.len().max(count / 3));
            if self.decoded > MOST_POLYGONS {
                let (path, count) = (self.path.to_owned(), self.decoded);
                return Err(LoadError::TooLarge { path, count, most: MOST_POLYGONS });
            }
            if let Some(&index) = indices.iter().find(|&&index| index as usize >= count) {
                let (path, place) = (self.path.to_owned(), place(number));
                return Err(LoadError::FaceIndex { path, place, index: i64::from(index), count });
            }
            let material = primitive.material.map(|material| material.value() as u32);
            parts.push(Part { positions, triangles, material });
        }
        Ok(parts)
    }

    fn read_primitive(&self, primitive: &Primitive) -> Result<(Vec<Vec3>, Vec<u32>), Problem> {
        let positions = primitive.attributes.get(&Checked::Valid(Semantic::Positions)).ok_or("it has no positions")?;
        let positions = self.data.positions(*positions)?;
        let indices = match primitive.indices {
            Some(indices) => self.data.indices(indices)?,
            None => (0..positions.len() as u32).collect(),
        };
        Ok((positions, indices))
    }

    fn problem(&self, place: String, problem: Problem) -> LoadError {
        LoadError::Parse { path: self.path.to_owned(), place, problem }
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

    /// Truth: the glTF 2.0 specification, section 3.7.2.1: every triangle of a strip keeps the winding of the first.
    #[test]
    fn strips_and_fans_keep_their_winding() {
        assert_eq!(triangles(Mode::TriangleStrip, &[0, 1, 2, 3, 4]), [[0, 1, 2], [2, 1, 3], [2, 3, 4]]);
        assert_eq!(triangles(Mode::TriangleFan, &[0, 1, 2, 3]), [[0, 1, 2], [0, 2, 3]]);
        assert_eq!(triangles(Mode::Triangles, &[0, 1, 2, 3, 4]), [[0, 1, 2]]);
        assert!(triangles(Mode::TriangleStrip, &[0]).is_empty() && triangles(Mode::TriangleFan, &[]).is_empty());
    }
}
