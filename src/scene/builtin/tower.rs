//! A tower of offices: storeys of the paper's office, as many as are asked for, to see how cost
//! grows with the scene.
//!
//! Each office is closed: no light passes between them, and what one costs the next one costs
//! again.

use glam::{Vec3, vec3};

use super::office;
use crate::scene::{Group, GroupId, Scene};

/// Offices of a storey, side by side and behind each other.
const STOREY: [usize; 2] = [4, 2];
/// From an office to the next along each axis, m: the room with its walls and slabs.
const STEP: Vec3 = vec3(6.2, 3.0, 6.2);

/// Draws as many whole offices as come nearest to this number of polygons, at least one.
pub(super) fn build(polygons: usize) -> Scene {
    let office = office::build();
    let count = ((polygons as f64 / office.polygons.len() as f64).round() as usize).max(1);
    let mut tower = Scene::new("tower");
    tower.materials.clone_from(&office.materials);
    tower.camera = office.camera;
    tower.vertices.reserve(count * office.vertices.len());
    tower.polygons.reserve(count * office.polygons.len());
    let mut storey = GroupId(0);
    for number in 0..count {
        let [across, deep] = STOREY;
        let (level, place) = (number / (across * deep), number % (across * deep));
        if place == 0 {
            storey = tower.add_group(&format!("storey_{}", level + 1), GroupId(0));
        }
        let steps = vec3((place % across) as f32, level as f32, (place / across) as f32);
        add_copy(&mut tower, &office, STEP * steps, (&format!("office_{}", place + 1), storey));
    }
    tower
}

/// Adds a copy of a scene, moved by `by`, as a group of this name below another one.
fn add_copy(to: &mut Scene, scene: &Scene, by: Vec3, (name, parent): (&str, GroupId)) {
    let (first_vertex, first_group) = (to.vertices.len() as u32, to.groups.len() as u32);
    to.vertices.extend(scene.vertices.iter().map(|vertex| *vertex + by));
    let moved = |group: &Group| match group.parent {
        Some(parent) => Group { name: group.name.clone(), parent: Some(GroupId(first_group + parent.0)) },
        None => Group { name: name.to_owned(), parent: Some(parent) },
    };
    to.groups.extend(scene.groups.iter().map(moved));
    to.polygons.extend(scene.polygons.iter().map(|polygon| {
        let mut polygon = *polygon;
        polygon.map_corners(|corner| first_vertex + corner);
        polygon.group = GroupId(first_group + polygon.group.0);
        polygon
    }));
}
