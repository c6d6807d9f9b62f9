//! Readings at the very edges and corners of faces, and where one face stands on another: rays that
//! leave from there must neither slip through the seam nor be stopped by the neighbour.

use std::f32::consts::PI;

use glam::Vec3;
use selflink::gather::{Field, grey};
use selflink::scene::{GroupId, Scene};
use selflink::solve::SolverParams;

use super::support::{add_box, empty_room, furnished_room, solve};

/// Standard error of the readings, as a share of E + E₀.
const NOISE: f32 = 0.02;

/// Corners and middles of edges of a polygon, each with the polygon's centre.
fn rim(scene: &Scene, polygon: u32) -> Vec<Vec3> {
    let (corners, count) = scene.corner_positions(&scene.polygons[polygon as usize]);
    let corners = &corners[..count];
    let next = |index: usize| corners[(index + 1) % count];
    (0..count).flat_map(|index| [corners[index], 0.5 * (corners[index] + next(index))]).collect()
}

fn read(field: &Field, polygon: u32, position: Vec3) -> f32 {
    grey(field.read(polygon, position, NOISE).mean)
}

/// Truth: B = B_e/(1−ρ) everywhere in a furnace, and so is E, in the corners of the room and along
/// the feet and rims of what stands in it as well. Allowed are five standard errors, for 200
/// readings, and the field's own target error.
#[test]
fn furnaces_glow_evenly_at_edges() {
    let truth = 2.0;
    for scene in [empty_room(0.5, 1.0), furnished_room(0.5, 1.0)] {
        let error = 0.02;
        let solved = solve(&scene, SolverParams { error: Some(error), ..SolverParams::default() });
        let field = solved.field().expect("a gather");
        let mut read_here = 0;
        for polygon in 0..scene.polygons.len() as u32 {
            for position in rim(&scene, polygon) {
                // The undersides of what stands on the floor see nothing.
                let is_enclosed = field.is_shut_in((position, field.normal(polygon)), 1, 64);
                if is_enclosed {
                    continue;
                }
                let found = read(field, polygon, position);
                read_here += 1;
                let allowed = truth * (5.0 * 1.1 * NOISE + error as f32);
                assert!((found - truth).abs() < allowed, "polygon {polygon} at {position}: {found}, not {truth}");
            }
        }
        assert!(read_here >= 48, "{read_here} readings");
    }
}

/// Truth: a wall that emits 1 W/m² fills the half above its own foot, so the floor there has half
/// of that; nothing reflects. The foot of a box that stands before it has light in front, by the
/// closed form of parallel rectangles, and none behind.
#[test]
fn the_foot_of_a_wall_has_half_of_its_light() {
    let mut scene = Scene::new("foot");
    let black = scene.add_material("black", Vec3::ZERO, Vec3::ZERO);
    let lamp = scene.add_material("lamp", Vec3::ZERO, Vec3::ONE);
    let quad = |corners: [[f32; 3]; 4]| corners.map(Vec3::from);
    scene.add_quad(quad([[0.0, 0.0, 0.0], [0.0, 0.0, 2.0], [2.0, 0.0, 2.0], [2.0, 0.0, 0.0]]), black, GroupId(0));
    scene.add_quad(quad([[0.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 1.0, 2.0], [0.0, 0.0, 2.0]]), lamp, GroupId(0));
    add_box(&mut scene, (Vec3::new(1.0, 0.0, 0.5), Vec3::new(1.3, 1.5, 1.5)), false, (black, GroupId(1)));
    let solved = solve(&scene, SolverParams { error: Some(0.05), ..SolverParams::default() });
    let field = solved.field().expect("a gather");
    for z in [0.5, 1.0, 1.5] {
        let (found, wanted) = (read(field, 0, Vec3::new(0.0, 0.0, z)), 0.5);
        assert!((found - wanted).abs() < 5.0 * NOISE * wanted, "{found} at z = {z}, not {wanted}");
    }
    // The sides of the box, at their feet: one turns its back on the wall, one sees it as two
    // squares of a metre from their common corner, a metre away.
    let opposite = 2.0 * (0.5_f32.sqrt() * 0.5_f32.sqrt().atan()) / PI;
    for polygon in 2..scene.polygons.len() as u32 {
        let found = read(field, polygon, Vec3::new(if field.normal(polygon).x < 0.0 { 1.0 } else { 1.3 }, 0.0, 1.0));
        match field.normal(polygon).x {
            x if x < -0.5 => {
                assert!((found - opposite).abs() < 5.0 * NOISE * opposite, "{found} in front, not {opposite}");
            }
            x if x > 0.5 => assert_eq!(found, 0.0, "on the back"),
            _ => {}
        }
    }
}
