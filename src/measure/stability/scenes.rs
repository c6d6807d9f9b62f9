//! Rooms, boxes and rectangles of which the rows of the suite are made; some are used by the
//! solver's own tests.

use glam::Vec3;

use crate::scene::{GroupId, MaterialId, Scene};

/// Adds the six faces of a box, bright outside or (a room) inside.
pub fn add_box(scene: &mut Scene, (lower, upper): (Vec3, Vec3), bright_inside: bool, of: (MaterialId, GroupId)) {
    let corner = |index: usize| {
        let pick = |axis: usize| if index >> axis & 1 == 1 { upper[axis] } else { lower[axis] };
        Vec3::new(pick(0), pick(1), pick(2))
    };
    // Anticlockwise as seen from outside: x, y and z low, then high.
    let faces = [[0, 4, 6, 2], [0, 1, 5, 4], [0, 2, 3, 1], [1, 3, 7, 5], [2, 6, 7, 3], [4, 5, 7, 6]];
    for mut face in faces {
        if bright_inside {
            face.reverse();
        }
        scene.add_quad(face.map(corner), of.0, of.1);
    }
}

/// A closed room of 1 × 1 × 1 without anything in it.
pub fn empty_room(reflectance: f32, emission: f32) -> Scene {
    let mut scene = Scene::new("room");
    let material = scene.add_material("wall", Vec3::splat(reflectance), Vec3::splat(emission));
    add_box(&mut scene, (Vec3::ZERO, Vec3::ONE), true, (material, GroupId(0)));
    scene
}

/// Boxes of the furniture of [`furnished_room`], by group. They stand a little above the floor and
/// off each other, so that every bright side sees something.
const FURNITURE: [(&str, &[[f32; 6]]); 3] = [
    (
        "table",
        &[
            [0.15, 0.34, 0.15, 0.60, 0.37, 0.45],
            [0.17, 0.02, 0.17, 0.21, 0.32, 0.21],
            [0.54, 0.02, 0.17, 0.58, 0.32, 0.21],
            [0.17, 0.02, 0.39, 0.21, 0.32, 0.43],
            [0.54, 0.02, 0.39, 0.58, 0.32, 0.43],
        ],
    ),
    (
        "shelf",
        &[
            [0.70, 0.05, 0.70, 0.95, 0.08, 0.95],
            [0.70, 0.30, 0.70, 0.95, 0.33, 0.95],
            [0.70, 0.55, 0.70, 0.95, 0.58, 0.95],
        ],
    ),
    ("crate", &[[0.15, 0.03, 0.65, 0.40, 0.28, 0.90]]),
];

/// The room with a table, a shelf and a crate in it: 60 polygons of one material.
pub fn furnished_room(reflectance: f32, emission: f32) -> Scene {
    let mut scene = empty_room(reflectance, emission);
    add_furniture(&mut scene, MaterialId(0));
    scene
}

/// The furnished room, black but for grey walls, red furniture and a white lamp under the ceiling:
/// 61 polygons.
pub fn lamp_room() -> Scene {
    let mut scene = empty_room(0.6, 0.0);
    scene.materials[0].reflectance = Vec3::new(0.7, 0.6, 0.5);
    let furniture = scene.add_material("furniture", Vec3::new(0.6, 0.2, 0.1), Vec3::ZERO);
    add_furniture(&mut scene, furniture);
    let lamp = scene.add_material("lamp", Vec3::splat(0.3), Vec3::new(20.0, 18.0, 14.0));
    let group = scene.add_group("lamp", GroupId(0));
    scene.add_quad([[0.4, 0.4], [0.6, 0.4], [0.6, 0.6], [0.4, 0.6]].map(|[x, z]| Vec3::new(x, 0.98, z)), lamp, group);
    assert!(scene.normal(scene.polygons.last().expect("the lamp")).y < 0.0, "the lamp shines down");
    scene
}

fn add_furniture(scene: &mut Scene, material: MaterialId) {
    for (name, boxes) in FURNITURE {
        let group = scene.add_group(name, GroupId(0));
        for &[x, y, z, right, top, front] in boxes {
            let piece = scene.add_group("piece", group);
            let corners = (Vec3::new(x, y, z), Vec3::new(right, top, front));
            add_box(scene, corners, false, (material, piece));
        }
    }
}
