//! Truth of all tests: where a person would stand and look in rooms that are built here.

use super::view::HFOV;
use super::*;
use crate::geometry::orient;
use crate::measure::stability::scenes::add_box;
use crate::scene::{GroupId, MaterialId, Sides};

/// Material and group of all that is built here, but for single things.
const WALL: (MaterialId, GroupId) = (MaterialId(0), GroupId(0));

/// A scene that has the material of walls.
fn walls() -> Scene {
    let mut scene = Scene::new("walls");
    scene.add_material("wall", Vec3::splat(0.5), Vec3::ZERO);
    scene
}

/// A room of this size with a corner at the origin.
fn room(width: f32, height: f32, depth: f32) -> Scene {
    let mut scene = walls();
    add_box(&mut scene, (Vec3::ZERO, Vec3::new(width, height, depth)), true, WALL);
    scene
}

/// Boxes of this size on the floor, a material each, in rows of so many, a step apart.
fn add_things(scene: &mut Scene, count: usize, from: Vec3, (of_row, step): (usize, [f32; 2]), size: Vec3) {
    for index in 0..count {
        let thing = scene.add_material(&format!("thing {index}"), Vec3::splat(0.3), Vec3::ZERO);
        let [x, z] = [step[0] * (index % of_row) as f32, step[1] * (index / of_row) as f32];
        let at = from + Vec3::new(x, 0.0, z);
        add_box(scene, (at, at + size), false, (thing, GroupId(0)));
    }
}

/// Takes away the faces all of whose corners lie where this says.
fn remove_faces(scene: &mut Scene, is_there: impl Fn(Vec3) -> bool) {
    let vertices = &scene.vertices;
    scene.polygons.retain(|polygon| !polygon.corners().iter().all(|&corner| is_there(vertices[corner as usize])));
}

/// The view into a scene, and what hides things there.
fn view_of(scene: Scene, sides: Sides) -> (CameraPose, Occluders) {
    let (scene, occluders) = orient::apply(scene, sides);
    (find(&scene, &occluders).expect("a room"), occluders)
}

/// Truth: of two rooms beside each other, on a ground of 200 m, the larger one; eyes at 1.6 m, and
/// nearly its diagonal of 10 m ahead.
#[test]
fn one_stands_in_the_largest_room() {
    let mut scene = room(3.0, 2.5, 3.0);
    add_box(&mut scene, (Vec3::new(4.0, 0.2, 0.0), Vec3::new(12.0, 2.9, 6.0)), true, WALL);
    let ground = [[-100.0, -100.0], [-100.0, 100.0], [100.0, 100.0], [100.0, -100.0]];
    scene.add_quad(ground.map(|[x, z]| Vec3::new(x, -0.3, z)), WALL.0, WALL.1);
    let (view, occluders) = view_of(scene, Sides::Front);
    assert!((view.eye.y - 1.8).abs() < 1e-3, "{view:?}");
    assert!(view.eye.x > 4.2 && view.eye.x < 11.8 && view.eye.z > 0.2 && view.eye.z < 5.8, "{view:?}");
    let ahead = (view.target - view.eye).with_y(0.0).normalize();
    let free = occluders.first_hit(view.eye, ahead).expect("a wall").distance;
    assert!(free > 7.0, "{free} m ahead of {view:?}");
    assert_eq!(view.up, Vec3::Y);
}

/// Truth: the picture. A long room whose longest diagonals look past a screen and at bare walls,
/// with a dozen things in one of its corners: most of the things are ahead, and no wall within a
/// metre fills the picture.
#[test]
fn the_first_view_shows_things_and_no_blank_wall() {
    let mut scene = room(7.0, 2.7, 6.0);
    add_things(&mut scene, 12, Vec3::new(0.3, 0.0, 5.0), (4, [0.7, -0.6]), Vec3::new(0.4, 0.9, 0.4));
    let (view, occluders) = view_of(scene, Sides::Front);
    let ahead = (view.target - view.eye).normalize();
    let middle = Vec3::new(1.4, 0.5, 4.6);
    let aside = ahead.angle_between(middle - view.eye).to_degrees();
    assert!(aside < 0.5 * HFOV, "the things are {aside}° aside of {view:?}");
    let rays = (-7..=7).map(|across| ahead + across as f32 / 7.0 * 0.7 * ahead.cross(Vec3::Y));
    let near = rays.filter(|ray| occluders.first_hit(view.eye, ray.normalize()).is_some_and(|hit| hit.distance < 1.0));
    assert!(near.count() < 3, "{view:?}");
}

/// A house of two rooms, 3 × 3 m and 8 × 6 m, with walls of 20 cm; a wall of the larger one has a
/// window of 2 m².
fn house() -> Scene {
    let mut scene = room(3.0, 2.6, 3.0);
    add_box(&mut scene, (Vec3::new(3.2, 0.0, 0.0), Vec3::new(11.2, 2.6, 6.0)), true, WALL);
    add_box(&mut scene, (Vec3::new(-0.2, -0.2, -0.2), Vec3::new(11.4, 2.8, 6.2)), false, WALL);
    for (x, turned) in [(11.2, false), (11.4, true)] {
        remove_faces(&mut scene, |at| at.x == x);
        for [[low_y, low_z], [high_y, high_z]] in
            [[[-0.2, -0.2], [1.0, 6.2]], [[2.0, -0.2], [2.8, 6.2]], [[1.0, -0.2], [2.0, 2.0]], [[1.0, 4.0], [2.0, 6.2]]]
        {
            let mut corners = [[low_y, low_z], [low_y, high_z], [high_y, high_z], [high_y, low_z]];
            if turned {
                corners.reverse();
            }
            scene.add_quad(corners.map(|[y, z]| Vec3::new(x, y, z)), WALL.0, WALL.1);
        }
    }
    scene
}

fn is_in_larger_room(view: &CameraPose) -> bool {
    let inside = |at: Vec3| at.x > 3.3 && at.x < 11.1 && at.z > 0.1 && at.z < 5.9;
    (view.eye.y - 1.6).abs() < 1e-3 && inside(view.eye) && inside(view.target)
}

/// Truth: below a sky, on a lawn before a hedge, and between three backdrops one stands in the
/// house's larger room.
#[test]
fn one_stands_in_the_house_and_not_in_its_surroundings() {
    let sky = |lower: Vec3, upper: Vec3| {
        let mut scene = house();
        add_box(&mut scene, (lower, upper), true, WALL);
        scene
    };
    let mut backdrops = sky(Vec3::new(-50.0, -0.2, -50.0), Vec3::new(60.0, 40.0, 60.0));
    remove_faces(&mut backdrops, |at| at.y == 40.0);
    remove_faces(&mut backdrops, |at| at.z == 60.0);
    for (what, scene) in [
        ("a small sky", sky(Vec3::new(-10.0, -0.2, -10.0), Vec3::new(20.0, 12.0, 20.0))),
        ("a large sky", sky(Vec3::new(-100.0, -0.2, -100.0), Vec3::new(100.0, 100.0, 100.0))),
        ("a sky all round", sky(Vec3::splat(-200.0), Vec3::splat(200.0))),
        ("backdrops", backdrops),
    ] {
        for sides in [Sides::Front, Sides::Both] {
            let (view, _) = view_of(scene.clone(), sides);
            assert!(is_in_larger_room(&view), "{what}, {sides:?}: {view:?}");
        }
    }
}

/// Truth: a hall stays one's place, with low rooms along its walls and a booth of 2 m² in its
/// middle.
#[test]
fn one_stands_in_a_hall_and_not_in_its_side_rooms() {
    let mut scene = room(30.0, 12.0, 20.0);
    for (x, size) in [(30.2, 5.0), (-5.2, 5.0)] {
        add_box(&mut scene, (Vec3::new(x, 0.0, 2.0), Vec3::new(x + size, 3.0, 18.0)), true, WALL);
    }
    for (outwards, thick) in [(true, 0.0), (false, 0.1)] {
        let (lower, upper) = (Vec3::new(14.0, 0.0, 9.0) - thick, Vec3::new(15.4, 2.2, 10.4) + thick);
        add_box(&mut scene, (lower.with_y(0.0), upper), outwards, WALL);
    }
    let (view, occluders) = view_of(scene, Sides::Front);
    let above = occluders.first_hit(view.eye, Vec3::Y).expect("a ceiling").distance;
    assert!((above + 1.6 - 12.0).abs() < 1e-3, "{view:?}");
}

/// Truth: in a room without a wall one stands inside and looks at the others, not from afar.
#[test]
fn a_room_may_be_open_to_a_side() {
    let mut scene = room(5.0, 3.0, 4.0);
    remove_faces(&mut scene, |at| at.z == 0.0);
    let (view, occluders) = view_of(scene, Sides::Front);
    assert!(view.eye.x > 0.2 && view.eye.x < 4.8 && view.eye.z > 0.0 && view.eye.z < 3.8, "{view:?}");
    let ahead = (view.target - view.eye).with_y(0.0).normalize();
    assert!(occluders.first_hit(view.eye, ahead).is_some_and(|hit| hit.front), "{view:?}");
}

/// Truth: under a table, however much of the room one sees from there, nobody stands, also where
/// the room has no ceiling.
#[test]
fn one_stands_beside_a_table_and_not_under_it() {
    let mut scene = room(5.0, 3.0, 4.0);
    remove_faces(&mut scene, |at| at.y == 3.0);
    add_box(&mut scene, (Vec3::new(1.0, 0.7, 0.8), Vec3::new(4.0, 0.75, 3.2)), false, WALL);
    let (view, _) = view_of(scene, Sides::Front);
    assert!((view.eye.y - 1.6).abs() < 1e-3, "{view:?}");
}

/// Truth: a room without a floor is stood in as if it had one where its walls end.
#[test]
fn a_room_may_have_no_floor() {
    let mut scene = room(4.0, 2.6, 4.0);
    remove_faces(&mut scene, |at| at.y == 0.0);
    let (view, _) = view_of(scene, Sides::Front);
    assert!((view.eye.y - 1.6).abs() < 1e-3 && view.eye.cmpgt(Vec3::ZERO).all(), "{view:?}");
}

/// Truth: nobody stands in a sofa, which is closed and bright inside where its faces have two
/// sides; a box of that size alone is a room.
#[test]
fn a_sofa_is_no_room() {
    let scene = |with_table: bool| {
        let mut scene = room(2.0, 0.8, 0.9);
        if with_table {
            add_box(&mut scene, (Vec3::new(0.0, 0.0, 2.5), Vec3::new(3.0, 0.5, 3.5)), false, WALL);
        }
        orient::apply(scene, Sides::Front)
    };
    let (suite, occluders) = scene(true);
    assert_eq!(find(&suite, &occluders), None);
    let (alone, occluders) = scene(false);
    assert!(find(&alone, &occluders).is_some());
}

/// Truth: a table is seen from outside alone.
#[test]
fn a_single_thing_has_no_inside() {
    let mut scene = walls();
    let top = [[0.0, 0.0], [0.0, 1.0], [1.0, 1.0], [1.0, 0.0]];
    scene.add_quad(top.map(|[x, z]| Vec3::new(x, 0.7, z)), WALL.0, WALL.1);
    let (scene, occluders) = orient::apply(scene, Sides::Front);
    assert_eq!(find(&scene, &occluders), None);
    assert_eq!(find(&Scene::new(""), &Occluders::new(&Scene::new(""))), None);
}

/// Ten boxes on a table's place, as somebody's things are.
fn add_ten_things(scene: &mut Scene, from: Vec3) {
    add_things(scene, 10, from, (5, [0.25, 0.3]), Vec3::new(0.2, 0.8, 0.2));
}

/// Truth: below a room with things lies a larger cellar with nothing in it; one stands in the room.
#[test]
fn one_stands_where_there_is_something_to_see() {
    let mut scene = walls();
    add_box(&mut scene, (Vec3::new(-5.0, -6.0, -5.0), Vec3::new(9.0, -0.2, 9.0)), true, WALL);
    add_box(&mut scene, (Vec3::ZERO, Vec3::new(4.0, 2.6, 4.0)), true, WALL);
    add_ten_things(&mut scene, Vec3::new(1.0, 0.0, 1.0));
    let (view, _) = view_of(scene, Sides::Front);
    assert!((view.eye.y - 1.6).abs() < 1e-3 && view.eye.cmpgt(Vec3::ZERO).all(), "{view:?}");
}

/// Truth: of a room in the corner of two walls, which are hollow and bright inside, one sees the
/// room and not what is in the walls.
#[test]
fn nobody_stands_in_a_wall() {
    let mut scene = walls();
    for walls in [Vec3::new(10.0, 5.0, 0.9), Vec3::new(0.9, 5.0, 10.0)] {
        add_box(&mut scene, (Vec3::new(0.0, -0.1, 0.0), walls), false, WALL);
    }
    add_box(&mut scene, (Vec3::new(0.0, -0.2, 0.0), Vec3::new(10.0, 0.0, 10.0)), false, WALL);
    add_ten_things(&mut scene, Vec3::new(5.0, 0.0, 5.0));
    let (scene, occluders) = orient::apply(scene, Sides::Both);
    if let Some(view) = find(&scene, &occluders) {
        assert!(view.eye.x > 0.9 && view.eye.z > 0.9, "{view:?}");
    }
}

/// Truth: in a wide room with a few small things by one of its walls, and nothing else, these are
/// in the middle of the picture.
#[test]
fn the_first_view_looks_at_the_things_that_are_there() {
    let mut scene = room(6.0, 2.6, 6.0);
    add_ten_things(&mut scene, Vec3::new(2.4, 0.0, 0.4));
    let (view, _) = view_of(scene, Sides::Front);
    let [ahead, to_things] = [view.target, Vec3::new(2.9, 0.4, 0.6)].map(|at| (at - view.eye).with_y(0.0));
    let aside = ahead.angle_between(to_things).to_degrees();
    assert!(aside < 20.0, "the things are {aside}° aside of {view:?}");
}

/// Truth: the picture. A desk with a flat screen on it in an otherwise empty room: the screen is
/// seen from its front, not from its edge.
#[test]
fn the_first_view_sees_a_screen_from_its_front() {
    for (middle, length) in [(0.6, 4.0), (0.6, 4.4), (1.0, 4.0), (1.0, 4.4), (2.6, 4.0), (2.6, 4.4)] {
        let mut scene = Scene::new("study");
        for (name, lower, upper) in [
            ("wall", Vec3::ZERO, Vec3::new(4.0, 2.7, length)),
            ("desk", Vec3::new(middle - 0.5, 0.7, 0.1), Vec3::new(middle + 0.5, 0.75, 0.9)),
            ("screen", Vec3::new(middle - 0.4, 0.85, 0.4), Vec3::new(middle + 0.4, 1.4, 0.43)),
        ] {
            let material = scene.add_material(name, Vec3::splat(0.5), Vec3::ZERO);
            add_box(&mut scene, (lower, upper), name == "wall", (material, GroupId(0)));
        }
        let (view, _) = view_of(scene, Sides::Front);
        let to_screen = (Vec3::new(middle, 1.1, 0.43) - view.eye).with_y(0.0);
        let from_front = to_screen.angle_between(-Vec3::Z).to_degrees();
        let aside = to_screen.angle_between((view.target - view.eye).with_y(0.0)).to_degrees();
        assert!(from_front < 50.0 && aside < 20.0, "{from_front}° from its front, {aside}° aside of {view:?}");
    }
}

/// Truth: of two rooms, the larger one with three things in a corner and the other full of things,
/// one stands in the latter.
#[test]
fn one_stands_where_more_is_to_be_seen() {
    let mut scene = room(6.0, 2.6, 6.0);
    add_box(&mut scene, (Vec3::new(6.2, 0.0, 0.0), Vec3::new(11.2, 2.6, 5.0)), true, WALL);
    add_things(&mut scene, 3, Vec3::new(0.1, 0.0, 0.1), (3, [0.5, 0.0]), Vec3::splat(0.4));
    for corner in [[7.0, 0.6], [9.0, 0.6], [7.0, 3.6], [9.0, 3.6]] {
        add_ten_things(&mut scene, Vec3::new(corner[0], 0.0, corner[1]));
    }
    let (view, _) = view_of(scene, Sides::Front);
    assert!(view.eye.x > 6.2, "{view:?}");
}

/// Truth: two walls on a hollow podium, with things between them, are looked at from outside:
/// inside the podium, which is bright and as high as a room, there is nothing.
#[test]
fn a_stage_is_seen_from_outside() {
    let mut scene = walls();
    add_box(&mut scene, (Vec3::new(0.0, -2.2, 0.0), Vec3::new(8.0, 0.0, 8.0)), false, WALL);
    for upper in [Vec3::new(8.0, 5.0, 0.1), Vec3::new(0.1, 5.0, 8.0)] {
        add_box(&mut scene, (Vec3::ZERO, upper), false, WALL);
    }
    add_things(&mut scene, 12, Vec3::new(0.5, 0.01, 0.5), (4, [1.8, 2.0]), Vec3::new(1.2, 0.9, 0.8));
    let (scene, occluders) = orient::apply(scene, Sides::Both);
    assert_eq!(find(&scene, &occluders), None);
}
