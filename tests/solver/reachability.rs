//! What is hidden inside of things: it has no area, gets no light and takes none from what is seen.
//!
//! Truth: geometry, and the furnace B = B_e / (1 − ρ).

use std::sync::Arc;

use glam::Vec3;
use selflink::geometry::Occluders;
use selflink::geometry::{Reachability, quarter};
use selflink::hierarchy::{ClusteringMode, Hierarchy, Shape};
use selflink::scene::{GroupId, Scene};

use super::support::{MODES, add_box, empty_room, links, params, solve};

/// A closed room of 1 × 1 × 1 with a box of 0.3 × 0.4 × 0.4 that stands on its floor, open below.
fn room_with_a_box() -> Scene {
    let mut scene = empty_room(0.5, 1.0);
    let material = scene.polygons[0].material;
    add_box(&mut scene, (Vec3::new(0.25, 0.0, 0.3), Vec3::new(0.55, 0.4, 0.7)), false, (material, GroupId(0)));
    let bottom = scene.polygons.len() - 5;
    assert!(scene.normal(&scene.polygons[bottom]).y < -0.99);
    scene.polygons.remove(bottom);
    scene
}

fn floor_of(scene: &Scene) -> u32 {
    let is_floor = |polygon: &selflink::scene::Polygon| {
        scene.normal(polygon).y > 0.99 && scene.corner_positions(polygon).0[0].y.abs() < 1e-6
    };
    scene.polygons.iter().position(is_floor).expect("a floor") as u32
}

/// 12 % of the floor are under the box; cells are 4 cm wide and have four points each, so that the
/// 1.4 m around the box are good to some 1 %. Whatever the refinement, areas add up, and random
/// points lie where light can come or right beside.
#[test]
fn the_floor_under_a_box_is_no_area() {
    let scene = room_with_a_box();
    let reachability = Reachability::new(&scene, &Occluders::new(&scene));
    for polygon in 0..scene.polygons.len() as u32 {
        let shares = reachability.shares(reachability.of_polygon(polygon));
        let truth = if polygon == floor_of(&scene) { 0.88 } else { 1.0 };
        assert!((shares.reachable - truth).abs() < 0.012, "polygon {polygon}: {shares:?}");
        assert!(shares.sampled >= shares.reachable);
    }
    let mut hierarchy = Hierarchy::new(&scene, Arc::new(reachability), ClusteringMode::None, 1);
    let of_floor = |hierarchy: &Hierarchy| {
        let leaves = hierarchy.ids().filter(|id| match hierarchy.element(*id).shape {
            Shape::Patch(patch) => hierarchy.element(*id).is_leaf() && patch.polygon == floor_of(&scene),
            Shape::Cluster(_) | Shape::Sky(_) => false,
        });
        leaves.collect::<Vec<_>>()
    };
    let area = |hierarchy: &Hierarchy| of_floor(hierarchy).iter().map(|id| hierarchy.element(*id).area).sum::<f32>();
    let whole = area(&hierarchy);
    for _ in 0..6 {
        of_floor(&hierarchy).into_iter().for_each(|id| hierarchy.subdivide(id));
        assert!((area(&hierarchy) - whole).abs() < 1e-5);
    }
    let floor = hierarchy.initial_patches().iter().find(|id| match hierarchy.element(**id).shape {
        Shape::Patch(patch) => patch.polygon == floor_of(&scene),
        Shape::Cluster(_) | Shape::Sky(_) => false,
    });
    for index in 0..1000_u32 {
        let (u, v) =
            ((f64::from(index) * 0.754_877_666).fract() as f32, (f64::from(index) * 0.569_840_291).fract() as f32);
        let point = hierarchy.point_on(*floor.expect("a floor"), u, v).position;
        // More than a cell away from the box's sides.
        let inside = point.x > 0.31 && point.x < 0.49 && point.z > 0.36 && point.z < 0.64;
        assert!(!inside, "{point} is under the box");
    }
}

/// Cells are the very quarters into which patches are split, in the same order: else a patch would
/// hold its neighbour's cells.
#[test]
fn cells_are_the_quarters_of_patches() {
    let mut scene = Scene::new("a quad and a triangle");
    let grey = scene.add_material("grey", Vec3::splat(0.5), Vec3::ONE);
    let corners = [Vec3::ZERO, Vec3::new(4.0, 0.0, 1.0), Vec3::new(4.5, 2.0, 1.0), Vec3::new(0.0, 3.0, 0.0)];
    scene.add_quad(corners, grey, GroupId(0));
    scene.add_triangle([corners[0], corners[1], corners[3]], grey, GroupId(0));
    let mut hierarchy = Hierarchy::new(&scene, Arc::default(), ClusteringMode::None, 1);
    for id in hierarchy.initial_patches().to_vec() {
        hierarchy.subdivide(id);
        let Shape::Patch(whole) = hierarchy.element(id).shape else { panic!("an initial patch") };
        let (corners, count) = hierarchy.corner_positions(&whole);
        for (number, child) in hierarchy.element(id).children().enumerate() {
            let Shape::Patch(part) = hierarchy.element(child).shape else { panic!("a patch holds patches") };
            let (found, _) = hierarchy.corner_positions(&part);
            assert_eq!(found[..count], quarter(corners, count, number as u32)[..count], "quarter {number}");
        }
    }
}

/// With ε so coarse that the floor is a few leaves, all of it glows as the walls do: 4 % where
/// twenty links have five rays each, 2 % where there are a thousand. If the hidden part counted, it
/// would be 12 % darker. Leaves that lie wholly under the box have no light and no link.
#[test]
fn a_box_does_not_darken_the_floor_around_it() {
    let scene = room_with_a_box();
    for mode in MODES {
        for (epsilon, tolerance) in [(3e-2, 0.04), (1e-3, 0.02)] {
            let solved = solve(&scene, params(mode, epsilon));
            let hierarchy = solved.hierarchy();
            let (mut area, mut power, mut hidden) = (0.0, 0.0, 0);
            for id in hierarchy.ids() {
                let element = hierarchy.element(id);
                let Shape::Patch(patch) = element.shape else { continue };
                if element.is_leaf() && patch.polygon == floor_of(&scene) {
                    area += element.area;
                    power += element.area * solved.radiosity()[id.index()].x;
                    if element.area <= 0.0 {
                        hidden += 1;
                        assert_eq!(solved.irradiance()[id.index()], Vec3::ZERO);
                        assert!(!links(&solved).iter().any(|link| link.receiver == id || link.source == id));
                    }
                }
            }
            println!("{mode:?}, ε = {epsilon:e}: B = {:.4}, {hidden} hidden leaves", power / area);
            assert!((power / area / 2.0 - 1.0).abs() < tolerance, "{mode:?}, ε = {epsilon:e}: B = {}", power / area);
        }
    }
}

/// A room wound inside out shows its backs to a floor that a small lamp lights: that floor is dim,
/// not hidden.
#[test]
fn what_a_small_lamp_lights_among_backs_is_not_hidden() {
    let mut scene = Scene::new("inside out");
    let grey = scene.add_material("grey", Vec3::splat(0.5), Vec3::ZERO);
    let lamp = scene.add_material("lamp", Vec3::ZERO, Vec3::splat(100.0));
    add_box(&mut scene, (Vec3::ZERO, Vec3::ONE), false, (grey, GroupId(0)));
    let square = |y: f32, half: f32| {
        [[-half, -half], [-half, half], [half, half], [half, -half]].map(|[x, z]| Vec3::new(0.5 + x, y, 0.5 + z))
    };
    scene.add_quad(square(0.05, 0.4), grey, GroupId(0));
    let mut down = square(0.95, 0.01);
    down.reverse();
    scene.add_quad(down, lamp, GroupId(0));
    let reachability = Reachability::new(&scene, &Occluders::new(&scene));
    let floor = scene.polygons.len() as u32 - 2;
    assert!(scene.normal(&scene.polygons[floor as usize]).y > 0.99);
    assert_eq!(reachability.shares(reachability.of_polygon(floor)).reachable, 1.0);
    let solved = solve(&scene, params(ClusteringMode::Adaptive, 1e-2));
    assert!(super::support::received(&solved, floor) > 0.0);
}
