//! Parts of nodes beside meshes: lights, cameras, instances.

use glam::{DMat4, DQuat, DVec3, Vec3};
use gltf::json::Index;
use gltf::json::camera::Camera;
use gltf::json::extensions::scene::khr_lights_punctual::{Light, Type};
use gltf::json::scene::Node;
use gltf::json::validation::Checked;

use super::buffers::{GltfData, Problem};
use crate::scene::draft::Draft;
use crate::scene::place::{FiledCamera, is_usable};
use crate::scene::punctual::{DirectionalLight, PunctualLight};
use crate::scene::{GroupId, sanitize};

/// Width by height that a camera without one is made for.
const USUAL_ASPECT: f64 = 1.6;

/// The light of a node.
pub(super) fn light_of<'a>(data: &GltfData<'a>, node: &Node) -> Option<&'a Light> {
    let light = node.extensions.as_ref()?.khr_lights_punctual.as_ref()?.light;
    data.root.extensions.as_ref()?.khr_lights_punctual.as_ref()?.lights.get(light.value())
}

/// Adds a light; one of a kind that there is not is passed over.
pub(super) fn add_light(draft: &mut Draft, light: &Light, name: &str, group: GroupId, world: DMat4) {
    let name = light.name.clone().unwrap_or_else(|| name.to_owned());
    let candelas = light.intensity * Vec3::from_array(light.color);
    let candelas = if candelas.is_finite() { candelas.max(Vec3::ZERO) } else { Vec3::ZERO };
    let cone = match light.type_ {
        Checked::Valid(Type::Point) => None,
        Checked::Valid(Type::Spot) => {
            light.spot.as_ref().map(|spot| [spot.inner_cone_angle, spot.outer_cone_angle]).or(Some([0.0, 0.785]))
        }
        Checked::Valid(Type::Directional) => {
            let towards = world.transform_vector3(DVec3::Z).normalize_or(DVec3::Y);
            draft.suns.push(DirectionalLight { name, towards, lux: candelas });
            return;
        }
        Checked::Invalid => return,
    };
    let cone = cone.map(|cone| cone.map(|angle| if angle.is_finite() { angle } else { 0.785 }));
    let range = light.range.filter(|range| range.is_finite() && *range > 0.0);
    draft.lights.push(PunctualLight { name, group, world, candelas, range, cone });
}

/// Adds the view of a camera; one without perspective, or out of all bounds, is counted.
pub(super) fn add_camera(draft: &mut Draft, camera: &Camera, name: &str, world: DMat4, reach: f64) {
    let eye = world.transform_point3(DVec3::ZERO);
    let axis = |axis: DVec3| world.transform_vector3(axis).try_normalize();
    let (Some(ahead), Some(up), Some(lens)) = (axis(-DVec3::Z), axis(DVec3::Y), camera.perspective.as_ref()) else {
        draft.skipped.ignored_cameras += 1;
        return;
    };
    let aspect =
        lens.aspect_ratio.map(f64::from).filter(|aspect| aspect.is_finite() && *aspect > 0.0).unwrap_or(USUAL_ASPECT);
    let hfov_deg = (2.0 * (aspect * (0.5 * f64::from(lens.yfov)).tan()).atan()).to_degrees();
    let target = eye + reach.max(1e-3) * ahead;
    let is_sound = is_usable(eye) && is_usable(target) && eye != target;
    if !(is_sound && hfov_deg > 0.0 && hfov_deg < 180.0) {
        draft.skipped.ignored_cameras += 1;
        return;
    }
    // Nodes may share a camera: the first goes by its name, others by their nodes', so that each
    // can be chosen.
    let is_free = |name: &String| draft.cameras.iter().all(|(other, _)| other != name);
    let names = camera.name.as_deref().into_iter().chain([name]).map(sanitize::name);
    let numbered = (2..).map(|number| format!("{} {number}", sanitize::name(name)));
    let name = names.chain(numbered).find(is_free).unwrap_or_default();
    draft.cameras.push((name, FiledCamera { eye, target, up, hfov_deg }));
}

/// Where a node's mesh lies in the node's space: once where it is, or wherever
/// EXT_mesh_gpu_instancing says.
pub(super) fn instances(data: &GltfData, node: &Node) -> Result<Vec<DMat4>, Problem> {
    let said = node.extensions.as_ref().and_then(|it| it.others.get("EXT_mesh_gpu_instancing"));
    let Some(said) = said else { return Ok(vec![DMat4::IDENTITY]) };
    let accessor = |name: &str| said["attributes"][name].as_u64().map(|number| Index::new(number as u32));
    let translations = accessor("TRANSLATION").map(|it| data.vectors::<3>(it)).transpose()?;
    let rotations = accessor("ROTATION").map(|it| data.vectors::<4>(it)).transpose()?;
    let scales = accessor("SCALE").map(|it| data.vectors::<3>(it)).transpose()?;
    let counts = [&translations, &scales].map(|list| list.as_ref().map(Vec::len));
    let counts = [counts[0], counts[1], rotations.as_ref().map(Vec::len)];
    let Some(count) = counts.into_iter().flatten().min() else { return Ok(vec![DMat4::IDENTITY]) };
    let instance = |index: usize| {
        let translation = translations.as_ref().map_or(DVec3::ZERO, |list| DVec3::from_array(list[index]));
        let scale = scales.as_ref().map_or(DVec3::ONE, |list| DVec3::from_array(list[index]));
        let rotation = rotations.as_ref().map_or(DQuat::IDENTITY, |list| DQuat::from_array(list[index]));
        let rotation = if rotation.length_squared() > 0.0 { rotation.normalize() } else { DQuat::IDENTITY };
        DMat4::from_scale_rotation_translation(scale, rotation, translation)
    };
    Ok((0..count).map(instance).collect())
}
