//! A scene that nothing lights, in its surfaces' own colours: black in black nothing could be
//! distinguished, nor chosen to be a lamp.
//!
//! This is no light, and nothing reads it. Surfaces are shaded by how they are turned, so that
//! shapes are seen.

use glam::Vec3;

use super::encode_gamma;
use crate::scene::Scene;
use crate::solve::snapshot::{Mesh, Snapshot};

/// Where surfaces seem to be lit from, so that shapes read; askew, so that no two walls of a room
/// look alike.
const LIT_FROM: Vec3 = Vec3::new(0.33, 0.80, 0.50);
/// Brightness of a surface that faces the light and of one that turns its back to it.
const SHADES: (f32, f32) = (1.0, 0.46);
/// Reflectance that black surfaces are drawn with, so that a black thing has a shape too.
const BLACKEST: f32 = 0.02;

/// How bright each vertex of a mesh is drawn by how its surface is turned, 0..=1.
pub(super) fn shades(mesh: &Mesh) -> Vec<f32> {
    let mut normals = vec![Vec3::ZERO; mesh.positions.len()];
    for &corners in &mesh.triangles {
        let [a, b, c] = mesh.corners(corners);
        for vertex in corners {
            normals[vertex as usize] += (b - a).cross(c - a);
        }
    }
    let towards = LIT_FROM.normalize();
    let shade = |normal: &Vec3| {
        let facing = 0.5 + 0.5 * normal.normalize_or_zero().dot(towards);
        SHADES.1 + (SHADES.0 - SHADES.1) * facing
    };
    normals.iter().map(shade).collect()
}

/// A snapshot whose vertices carry the gamma-encoded colours of a scene's surfaces, to be shown as
/// they are ([`as_colours`](super::Display::as_colours)).
pub fn in_own_colours(snapshot: &Snapshot, scene: &Scene) -> Snapshot {
    let mesh = &snapshot.mesh;
    let mut sums = vec![(Vec3::ZERO, 0.0_f32); mesh.positions.len()];
    for (corners, &leaf) in mesh.triangles.iter().zip(&mesh.triangle_leaf) {
        // A scene that has just taken the place of this one may be smaller.
        let Some(polygon) = scene.polygons.get(mesh.leaves[leaf as usize].polygon as usize) else { continue };
        let reflectance = scene.surface(polygon).reflectance;
        for &vertex in corners {
            let (sum, count) = &mut sums[vertex as usize];
            *sum += reflectance;
            *count += 1.0;
        }
    }
    let coloured = |((sum, count), shade): (&(Vec3, f32), f32)| {
        let reflectance = *sum / count.max(1.0);
        reflectance.to_array().map(|channel| shade * encode_gamma(BLACKEST + (1.0 - BLACKEST) * channel))
    };
    Snapshot { vertex_radiosity: sums.iter().zip(shades(mesh)).map(coloured).collect(), ..snapshot.clone() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::render::{Camera, Display, Offscreen, Overlay};
    use crate::scene::builtin::BuiltinScene;
    use crate::solve::{Solver, SolverParams};

    /// Truth: the Cornell box without its lamp is black as light has it; its left wall is red and
    /// its right one green, and corners of white walls are seen because the walls differ.
    #[test]
    fn a_dark_room_shows_its_own_colours() {
        let mut scene = BuiltinScene::Cornell.build();
        for material in &mut scene.materials {
            material.emission = Vec3::ZERO;
        }
        let dark = Solver::solved(scene.clone(), SolverParams::default()).snapshot();
        assert!(dark.vertex_radiosity.iter().flatten().all(|channel| *channel == 0.0));
        let shown = in_own_colours(&dark, &scene);
        // Mean colour of the vertices of faces that are turned this way.
        let of_faces = |way: Vec3| {
            let of = |triangle: &&[u32; 3]| {
                let [a, b, c] = dark.mesh.corners(**triangle);
                (b - a).cross(c - a).normalize_or_zero().dot(way) > 0.99
            };
            let corners: Vec<u32> = dark.mesh.triangles.iter().filter(of).flatten().copied().collect();
            let sum: Vec3 = corners.iter().map(|&vertex| Vec3::from(shown.vertex_radiosity[vertex as usize])).sum();
            sum / corners.len() as f32
        };
        let [left, right, floor, ceiling] = [Vec3::X, Vec3::NEG_X, Vec3::Y, Vec3::NEG_Y].map(of_faces);
        let (red, green) = if left.x > right.x { (left, right) } else { (right, left) };
        assert!(red.x > 1.2 * red.y && green.y > 1.2 * green.x, "{red} {green}");
        assert!(floor.y > ceiling.y + 0.1 && ceiling.min_element() > 0.2, "{floor} {ceiling}");
        let display = Display { as_colours: true, ..Display::default() };
        let mut offscreen = Offscreen::new().expect("an adapter is there");
        let camera = Camera::of_scene(&scene, 1.0);
        let picture =
            offscreen.picture(&shown, &camera, &display, &Overlay::default(), [120, 120]).expect("it can be drawn");
        assert!(picture.get_pixel(60, 50).0[0] > 80, "{:?}", picture.get_pixel(60, 50));
    }
}
