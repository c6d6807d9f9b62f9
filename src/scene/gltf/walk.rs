//! The way through the node tree: groups, transforms, copies of meshes, lights and cameras.

use glam::{DMat4, DVec3};
use rustc_hash::FxHashMap;

use super::buffers::GltfData;
use super::extras::{add_camera, add_light, instances, light_of};
use super::materials::UvSets;
use super::mesh::{Part, coarse_rounding, joint_matrices, read_primitive};
use crate::scene::draft::{Draft, DraftMaterial, MOST_POLYGONS};
use crate::scene::load_error::Fault;
use crate::scene::place::{Reach, is_usable};
use crate::scene::{GroupId, sanitize};

/// Visits every node of the scene that is shown and fills the draft.
///
/// # Errors
/// The first part of the file that cannot be used.
pub(super) fn run(
    data: &GltfData,
    parents_from_nodes: Vec<DMat4>,
    draft: Draft,
    uv_sets: &[UvSets],
) -> Result<Draft, Fault> {
    let mut walk = Walk {
        data,
        parents_from_nodes,
        draft,
        uv_sets,
        meshes: FxHashMap::default(),
        worlds: Vec::new(),
        grey: None,
        reach: Reach::new(),
        rounded: (0, 0.0),
        decoded: 0,
    };
    walk.nodes()?;
    let Walk { mut draft, reach, rounded, .. } = walk;
    if let Some(place) = reach.too_far() {
        return Err(coordinate_error(place));
    }
    if let (meshes @ 1.., unit) = rounded {
        draft.skipped.note(format!(
            "The file's own coordinates are too far from zero and have lost the shape of its meshes ({meshes}), to {unit}: export with the meshes near zero and let a node move them."
        ));
    }
    Ok(draft)
}

struct Walk<'a> {
    data: &'a GltfData<'a>,
    /// Of each node, into the space of its parent.
    parents_from_nodes: Vec<DMat4>,
    draft: Draft,
    /// The sets of texture coordinates of each material.
    uv_sets: &'a [UvSets],
    /// Meshes by number and by the node whose morph weights they have, if it has its own.
    meshes: FxHashMap<(usize, Option<usize>), Vec<Part>>,
    /// From each node's space to the scene's, once all are known.
    worlds: Vec<DMat4>,
    /// The material of primitives without one, once there is such a primitive.
    grey: Option<u32>,
    /// How far vertices reach, by their nodes, meshes and numbers.
    reach: Reach<(usize, usize, u32)>,
    /// Meshes whose coordinates have lost their shape, and the coarsest rounding among them.
    rounded: (usize, f32),
    /// Vertices and triangles of all meshes read so far: many primitives can share one accessor.
    decoded: usize,
}

/// A node with its place in the scene.
struct Placed {
    node: usize,
    name: String,
    group: GroupId,
    world: DMat4,
}

impl Walk<'_> {
    fn nodes(&mut self) -> Result<(), Fault> {
        let root = self.data.root;
        let placed = self.placed()?;
        self.worlds = vec![DMat4::IDENTITY; root.nodes.len()];
        for it in &placed {
            self.worlds[it.node] = it.world;
        }
        self.check_count(&placed)?;
        for Placed { node: index, name, group, world } in &placed {
            let node = &root.nodes[*index];
            if let Some(light) = light_of(self.data, node) {
                add_light(&mut self.draft, light, name, *group, *world);
            }
            if let Some(mesh) = node.mesh {
                self.add_mesh(mesh.value(), *index, *group, *world)?;
            }
        }
        self.add_cameras(&placed);
        Ok(())
    }

    /// Every node of the scene that is shown, parents first and in the file's order.
    fn placed(&mut self) -> Result<Vec<Placed>, Fault> {
        let root = self.data.root;
        let mut placed = Vec::new();
        let mut visited = vec![false; root.nodes.len()];
        let mut waiting: Vec<(usize, GroupId, DMat4)> =
            self.root_nodes().into_iter().rev().map(|node| (node, GroupId(0), DMat4::IDENTITY)).collect();
        while let Some((index, parent, world_from_parent)) = waiting.pop() {
            let place = || format!("node {index}");
            let node = root.nodes.get(index).ok_or_else(|| Fault::Parse(place(), "there is no such node".into()))?;
            if std::mem::replace(&mut visited[index], true) {
                return Err(Fault::Parse(place(), "it has two parents or is its own ancestor".into()));
            }
            let name = node.name.clone().unwrap_or_else(|| format!("node_{index}"));
            let world = world_from_parent * self.parents_from_nodes.get(index).copied().unwrap_or_default();
            let group = self.draft.add_group(&name, parent);
            let children = node.children.iter().flatten().rev();
            waiting.extend(children.map(|child| (child.value(), group, world)));
            placed.push(Placed { node: index, name, group, world });
        }
        Ok(placed)
    }

    /// The roots of the default scene, of the first scene, or of all nodes.
    fn root_nodes(&mut self) -> Vec<usize> {
        let root = self.data.root;
        let shown = root.scene.map_or(0, |scene| scene.value());
        if let Some(scene) = root.scenes.get(shown) {
            if root.scenes.len() > 1 {
                let count = root.scenes.len();
                let name = scene.name.as_deref().map_or_else(|| format!("number {shown}"), sanitize::quoted);
                self.draft.skipped.note(format!("Of {count} scenes in the file {name} is shown."));
            }
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

    /// Says that it is too much before any of it is made.
    fn check_count(&mut self, placed: &[Placed]) -> Result<(), Fault> {
        let mut count = 0_usize;
        for Placed { node, .. } in placed {
            let Some(mesh) = self.data.root.nodes[*node].mesh else { continue };
            let key = self.known_mesh(mesh.value(), *node)?;
            count = count.saturating_add(self.meshes[&key].iter().map(|part| part.triangles.len()).sum());
            if count > MOST_POLYGONS {
                return Err(Fault::TooLarge(count));
            }
        }
        Ok(())
    }

    /// Reads a node's mesh unless it is known already.
    fn known_mesh(&mut self, mesh: usize, node: usize) -> Result<(usize, Option<usize>), Fault> {
        let weights = self.data.root.nodes[node].weights.as_deref();
        let key = (mesh, weights.map(|_| node));
        if !self.meshes.contains_key(&key) {
            let parts = self.read_mesh(mesh, weights.unwrap_or_default())?;
            if let Some(rounding) = coarse_rounding(&parts) {
                self.rounded = (self.rounded.0 + 1, self.rounded.1.max(rounding));
            }
            self.meshes.insert(key, parts);
        }
        Ok(key)
    }

    /// Copies a node's mesh to wherever the node puts it.
    fn add_mesh(&mut self, mesh: usize, node: usize, group: GroupId, world: DMat4) -> Result<(), Fault> {
        let root = self.data.root;
        let said = &root.nodes[node];
        let key = self.known_mesh(mesh, node)?;
        let problem = |problem| Fault::Parse(format!("node {node}"), problem);
        let skin = said.skin.and_then(|skin| root.skins.get(skin.value()));
        let skin = skin.map(|skin| {
            let joints: Vec<usize> = skin.joints.iter().map(gltf::json::Index::value).collect();
            joint_matrices(self.data, &joints, skin.inverse_bind_matrices, &self.worlds)
        });
        let skin = skin.transpose().map_err(problem)?;
        let instances = instances(self.data, said).map_err(problem)?;
        let is_one = instances.len() == 1;
        for (number, instance) in instances.into_iter().enumerate() {
            let group = if is_one { group } else { self.draft.add_group(&(number + 1).to_string(), group) };
            self.add_instance(key, node, group, world * instance, skin.as_deref())?;
        }
        Ok(())
    }

    fn add_instance(
        &mut self,
        key: (usize, Option<usize>),
        node: usize,
        group: GroupId,
        world: DMat4,
        skin: Option<&[DMat4]>,
    ) -> Result<(), Fault> {
        let Self { draft, meshes, grey, reach, .. } = self;
        let mirrored = world.determinant() < 0.0 && skin.is_none();
        for part in &meshes[&key] {
            let count = draft.faces.len().saturating_add(part.triangles.len());
            let vertices = draft.vertices.len().saturating_add(part.positions.len());
            if count.max(vertices / 3) > MOST_POLYGONS {
                return Err(Fault::TooLarge(count));
            }
            let material = part.material.unwrap_or_else(|| {
                *grey.get_or_insert_with(|| {
                    draft.materials.push(DraftMaterial::undefined("(no material)"));
                    draft.materials.len() as u32 - 1
                })
            });
            let first = draft.vertices.len() as u32;
            let positions = part.placed(world, skin);
            let normals = if skin.is_some() { None } else { part.placed_normals(world) };
            for &[a, b, c] in &part.triangles {
                let corners = if mirrored { [a, c, b] } else { [a, b, c] };
                for corner in corners {
                    let position = positions[corner as usize];
                    if !is_usable(position) {
                        return Err(coordinate_error((node, key.0, corner)));
                    }
                    reach.add(position, (node, key.0, corner));
                }
                draft.add_face(&corners.map(|corner| first + corner), material, group);
                if let Some(uvs) = &part.uvs {
                    draft.add_uvs(corners.map(|corner| uvs[corner as usize]));
                }
                if let Some(uvs) = &part.emission_uvs {
                    draft.add_emission_uvs(corners.map(|corner| uvs[corner as usize]));
                }
                if let Some(normals) = &normals {
                    draft.add_normals(corners.map(|corner| normals[corner as usize]));
                }
                if let Some(colours) = &part.colours {
                    draft.add_colours(corners.map(|corner| Some(colours[corner as usize])));
                }
            }
            draft.vertices.extend(positions);
        }
        Ok(())
    }

    fn read_mesh(&mut self, mesh: usize, weights: &[f32]) -> Result<Vec<Part>, Fault> {
        let place = |part: usize| format!("mesh {mesh}, primitive {part}");
        let Some(said) = self.data.root.meshes.get(mesh) else { return Ok(Vec::new()) };
        let mut parts = Vec::with_capacity(said.primitives.len());
        for (number, primitive) in said.primitives.iter().enumerate() {
            let uv_sets = primitive.material.and_then(|it| self.uv_sets.get(it.value())).copied().unwrap_or_default();
            let part = read_primitive(self.data, said, primitive, weights, uv_sets);
            let Some(part) = part.map_err(|problem| Fault::Parse(place(number), problem))? else {
                self.draft.skipped.lines_and_points += 1;
                continue;
            };
            let count = part.positions.len();
            self.decoded = self.decoded.saturating_add(part.triangles.len().max(count / 3));
            if self.decoded > MOST_POLYGONS {
                return Err(Fault::TooLarge(self.decoded));
            }
            if let Some(&index) = part.triangles.iter().flatten().find(|&&index| index as usize >= count) {
                return Err(Fault::FaceIndex(place(number), i64::from(index), count));
            }
            parts.push(part);
        }
        Ok(parts)
    }

    /// Adds the views; they look at the middle of the scene as far as they can.
    fn add_cameras(&mut self, placed: &[Placed]) {
        let (lower, upper) = self.draft.bounds();
        let (middle, size) = (0.5 * (lower + upper), (upper - lower).length());
        for Placed { node, name, world, .. } in placed {
            let said = self.data.root.nodes[*node].camera;
            let Some(camera) = said.and_then(|camera| self.data.root.cameras.get(camera.value())) else { continue };
            let eye = world.transform_point3(DVec3::ZERO);
            let ahead = world.transform_vector3(-DVec3::Z).normalize_or_zero();
            let reach = (middle - eye).dot(ahead);
            let reach = if reach.is_finite() && size.is_finite() { reach.clamp(0.1 * size, size) } else { 1.0 };
            add_camera(&mut self.draft, camera, name, *world, reach);
        }
    }
}

fn coordinate_error((node, mesh, number): (usize, usize, u32)) -> Fault {
    Fault::Coordinate(format!("node {node}, mesh {mesh}"), format!("vertex {number}"))
}
