use super::*;
use crate::measure::stability::scenes::add_box;
use crate::scene::{CameraPose, GroupId, MaterialId};

/// A closed room of 4 × 3 × 4 m, bright inside, with a small lamp that shines down: faces 0 to 5
/// and 6.
fn room() -> Scene {
    let mut scene = Scene::new("room");
    let wall = scene.add_material("wall", Vec3::splat(0.5), Vec3::ZERO);
    let lamp = scene.add_material("lamp", Vec3::ZERO, Vec3::splat(10.0));
    add_box(&mut scene, (Vec3::ZERO, Vec3::new(4.0, 3.0, 4.0)), true, (wall, GroupId(0)));
    let corner = |x: f32, z: f32| Vec3::new(x, 2.9, z);
    scene.add_quad([corner(1.5, 1.5), corner(2.5, 1.5), corner(2.5, 2.5), corner(1.5, 2.5)], lamp, GroupId(0));
    scene
}

fn bright_towards(scene: &Scene, polygon: usize, point: Vec3) -> bool {
    let polygon = &scene.polygons[polygon];
    scene.normal(polygon).dot(point - scene.corner_positions(polygon).0[0]) > 0.0
}

const MIDDLE: Vec3 = Vec3::new(2.0, 1.5, 2.0);

/// Truth: in a closed room each wall is seen from inside alone.
#[test]
fn auto_turns_exactly_the_wall_that_is_wound_wrongly() {
    let (right, _) = apply(room(), Sides::Auto);
    assert_eq!(right.skipped.turned_faces, 0);
    for wrong in 0..6 {
        let mut scene = room();
        scene.polygons[wrong] = scene.polygons[wrong].flipped();
        let (front, _) = apply(scene.clone(), Sides::Front);
        assert_eq!(front.skipped.faces_seen_from_behind, 1);
        assert_eq!(front.polygons, scene.polygons);
        let (turned, occluders) = apply(scene, Sides::Auto);
        assert_eq!(turned.skipped.turned_faces, 1);
        assert_eq!(turned.polygons[wrong].corners(), room().polygons[wrong].corners());
        let ray = (turned.corner_positions(&turned.polygons[wrong]).0[0] * 0.9 + MIDDLE * 0.1 - MIDDLE).normalize();
        assert!(occluders.first_hit(MIDDLE, ray).is_some_and(|hit| hit.front));
    }
}

/// Truth: a shell around the room is seen by nobody inside and stays as it is, whichever way it is
/// wound; a chest in the room is seen from outside.
#[test]
fn auto_leaves_what_nobody_sees_and_turns_furniture_outwards() {
    for shell_bright_inside in [false, true] {
        for with_eye in [false, true] {
            let mut scene = room();
            let wall = MaterialId(0);
            add_box(&mut scene, (Vec3::splat(-0.3), Vec3::new(4.3, 3.3, 4.3)), shell_bright_inside, (wall, GroupId(0)));
            add_box(&mut scene, (Vec3::new(0.5, 0.1, 0.5), Vec3::new(1.5, 0.6, 1.0)), true, (wall, GroupId(0)));
            let target = MIDDLE + Vec3::X;
            scene.camera = with_eye.then_some(CameraPose { eye: MIDDLE, target, up: Vec3::Y, hfov_deg: 60.0 });
            let before = scene.clone();
            let (turned, _) = apply(scene, Sides::Auto);
            assert_eq!(turned.skipped.turned_faces, 6);
            assert_eq!(turned.polygons[..13], before.polygons[..13]);
            let chest_middle = Vec3::new(1.0, 0.35, 0.75);
            assert!((13..19).all(|face| !bright_towards(&turned, face, chest_middle)));
        }
    }
}

/// Truth: without eye and lamp the larger space decides, here the room around the chest.
#[test]
fn auto_works_in_the_dark() {
    let mut scene = room();
    scene.materials[1].emission = Vec3::ZERO;
    scene.polygons[2] = scene.polygons[2].flipped();
    let (turned, _) = apply(scene, Sides::Auto);
    assert_eq!(turned.skipped.turned_faces, 1);
    assert!(bright_towards(&turned, 2, MIDDLE));
}

/// Truth: each face once more, opposite, over the same vertices; occluders are those of the faces
/// alone.
#[test]
fn both_appends_opposite_patches() {
    let (scene, occluders) = apply(room(), Sides::Both);
    assert_eq!(scene.polygons.len(), 14);
    for face in 0..7 {
        let (front, back) = (scene.polygons[face], scene.polygons[face + 7]);
        assert!(!front.is_back && back.is_back);
        assert!(scene.normal(&front).distance(-scene.normal(&back)) < 1e-6);
    }
    assert!(occluders.occluded(MIDDLE, MIDDLE + 10.0 * Vec3::Y));
    assert_eq!(apply(scene.clone(), Sides::Both).0.polygons, scene.polygons);
    assert_eq!(apply(scene, Sides::Front).0.polygons, room().polygons);
}

/// Truth: from inside of a closed room wound outwards nothing but backs are seen, and of one wound
/// inwards nothing but fronts.
#[test]
fn a_room_wound_outwards_shows_its_backs() {
    let (right, occluders) = apply(room(), Sides::Front);
    assert!(!shows_backs(&right, &occluders));
    let mut scene = room();
    scene.polygons[..6].iter_mut().for_each(|polygon| *polygon = polygon.flipped());
    let (wrong, occluders) = apply(scene, Sides::Front);
    assert!(shows_backs(&wrong, &occluders));
}

/// Truth: a screen in the middle of a room is seen from both sides, its walls from inside alone; so
/// of all faces that may be bright on both sides the screen alone is doubled, and walls wound
/// outwards are turned.
#[test]
fn two_sided_faces_are_doubled_where_both_sides_are_seen() {
    for outwards in [false, true] {
        let mut scene = room();
        scene.materials[0].is_two_sided = true;
        if outwards {
            scene.polygons[..6].iter_mut().for_each(|polygon| *polygon = polygon.flipped());
        }
        let corner = |x: f32, y: f32| Vec3::new(x, y, 2.0);
        scene.add_quad(
            [corner(1.0, 0.5), corner(3.0, 0.5), corner(3.0, 2.0), corner(1.0, 2.0)],
            MaterialId(0),
            GroupId(0),
        );
        let (scene, occluders) = apply(scene, Sides::Front);
        let doubled: Vec<usize> = (0..scene.polygons.len()).filter(|&index| scene.polygons[index].has_back).collect();
        assert_eq!((scene.polygons.len(), doubled), (9, vec![7]));
        assert!(scene.normal(&scene.polygons[7]).distance(-scene.normal(&scene.polygons[8])) < 1e-6);
        assert!((0..6).all(|wall| bright_towards(&scene, wall, MIDDLE)), "{outwards}");
        assert_eq!(scene.skipped.turned_faces, 0, "no winding is wrong where both sides count");
        for (from, to) in [(1.0, Vec3::Z), (3.0, Vec3::NEG_Z)] {
            let hit = occluders.first_hit(Vec3::new(1.5, 1.0, from), to).expect("the screen");
            let normal = scene.normal(&scene.polygons[hit.polygon as usize]);
            assert!(hit.front && normal.dot(to) < 0.0 && (7..=8).contains(&hit.polygon), "{hit:?}");
        }
    }
}

#[test]
fn votes_do_not_depend_on_the_threads() {
    let mut scene = room();
    scene.polygons[3] = scene.polygons[3].flipped();
    let occluders = Occluders::new(&scene);
    let with = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool of few threads");
        pool.install(|| votes(&scene, &occluders, true).all)
    };
    assert_eq!(with(1), with(3));
}

/// Truth: a sheet of 3,200 triangles, of which few get a vote each, is wound alike throughout and
/// turns as one.
#[test]
fn unseen_faces_follow_their_surface() {
    let mut scene = Scene::new("sheet");
    let material = scene.add_material("sheet", Vec3::splat(0.5), Vec3::ZERO);
    const SIDE: u32 = 40;
    let at = |x: u32, z: u32| z * (SIDE + 1) + x;
    scene.vertices = (0..(SIDE + 1) * (SIDE + 1))
        .map(|index| Vec3::new((index % (SIDE + 1)) as f32, 0.0, (index / (SIDE + 1)) as f32))
        .collect();
    for (x, z) in (0..SIDE * SIDE).map(|cell| (cell % SIDE, cell / SIDE)) {
        let [a, b, c, d] = [at(x, z), at(x + 1, z), at(x + 1, z + 1), at(x, z + 1)];
        scene.polygons.push(Polygon::triangle([a, b, c], material, GroupId(0)));
        scene.polygons.push(Polygon::triangle([a, c, d], material, GroupId(0)));
    }
    let mut votes = vec![[0; 2]; scene.polygons.len()];
    votes[7] = [1, 6];
    votes[100] = [2, 0];
    assert!(surface_votes(&scene, &votes).iter().all(|vote| *vote == [3, 6]));
}
