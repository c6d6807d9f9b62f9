//! Faces at the same place: walls of two faces back to back, rooms that share a wall, faces that
//! are there twice. Nothing here goes through the program's own turning and cutting of faces: the
//! reference is right on its own.

use glam::{DVec3, EulerRot, Quat, Vec3, vec3};
use selflink::base::cancel::CancelToken;
use selflink::measure::reference::{Reference, ReferenceRun, SurfacePoint};
use selflink::measure::stability::scenes::add_box;
use selflink::scene::{GroupId, MaterialId, Scene};

const GROUP: GroupId = GroupId(0);
const SIZE: Vec3 = vec3(5.0, 3.0, 4.0);

/// A room with a ceiling panel of 1 m² 0.1 m below the ceiling; its faces are the first six
/// polygons.
fn room() -> Scene {
    let mut scene = Scene::new("room");
    let wall = scene.add_material("wall", Vec3::splat(0.7), Vec3::ZERO);
    add_box(&mut scene, (Vec3::ZERO, SIZE), true, (wall, GROUP));
    let lamp = scene.add_material("lamp", Vec3::ZERO, Vec3::splat(30.0 * std::f32::consts::PI));
    let panel = [[2.0, 1.5], [3.0, 1.5], [3.0, 2.5], [2.0, 2.5]].map(|[x, z]| vec3(x, 2.9, z));
    scene.add_quad(panel, lamp, GROUP);
    scene
}

/// Points on the floor, the ceiling and two walls of the room.
const PLACES: [Vec3; 4] = [vec3(0.5, 0.0, 0.5), vec3(1.0, 3.0, 1.0), vec3(5.0, 1.5, 2.0), vec3(2.5, 1.0, 0.0)];

/// The points of a scene's first six faces nearest to these places, which are moved with the scene.
fn points(scene: &Scene, place: impl Fn(Vec3) -> Vec3) -> Vec<SurfacePoint> {
    let nearest = |at: Vec3| {
        let height = |polygon: u32| {
            let of = &scene.polygons[polygon as usize];
            scene.normal(of).dot(at - scene.corner_positions(of).0[0]).abs()
        };
        (0..6).min_by(|a, b| height(*a).total_cmp(&height(*b))).expect("six faces")
    };
    PLACES.map(|at| SurfacePoint::on(scene, nearest(place(at)), place(at))).to_vec()
}

fn trace(scene: &Scene, points: Vec<SurfacePoint>, passes: u32) -> Reference {
    let mut run = ReferenceRun::new(scene, points.into(), 1);
    for _ in 0..passes {
        assert!(run.pass(&CancelToken::new()), "nobody cancels");
    }
    run.reference()
}

/// Truth: the same room without them. Paths use the same random numbers, so that nothing but
/// rounding may differ.
fn assert_alike(found: &Reference, truth: &Reference, within: f64, what: &str) {
    for (found, truth) in found.irradiance.iter().zip(&truth.irradiance) {
        assert!((*found - *truth).abs().max_element() <= within * truth.x, "{what}: {found} instead of {truth}");
    }
}

/// Adds each of these polygons once more, wound the other way and cut into `cuts`² parts.
fn add_twins(scene: &mut Scene, polygons: std::ops::Range<usize>, cuts: usize) {
    for index in polygons {
        let polygon = scene.polygons[index];
        let ([a, b, c, d], _) = scene.corner_positions(&polygon);
        let at = |i: usize, j: usize| {
            let (u, v) = (i as f32 / cuts as f32, j as f32 / cuts as f32);
            a.lerp(b, u).lerp(d.lerp(c, u), v)
        };
        for (i, j) in (0..cuts * cuts).map(|part| (part % cuts, part / cuts)) {
            let corners = [at(i, j), at(i, j + 1), at(i + 1, j + 1), at(i + 1, j)];
            scene.add_triangle([corners[0], corners[1], corners[2]], polygon.material, GROUP);
            scene.add_triangle([corners[0], corners[2], corners[3]], polygon.material, GROUP);
        }
    }
}

fn moved(scene: &Scene, place: impl Fn(Vec3) -> Vec3) -> Scene {
    let mut scene = scene.clone();
    scene.vertices.iter_mut().for_each(|vertex| *vertex = place(*vertex));
    scene
}

/// Truth: Mitsuba 3.9's figures for this room, E in W/m² at the four places with their standard
/// errors, and the room without twins where everything is rounded another way: turned, and walls
/// cut otherwise on the other side.
#[test]
fn a_wall_of_two_faces_is_a_wall() {
    let single = room();
    let truth = trace(&single, points(&single, |at| at), 64);
    let known = [(3.2635, 0.0063), (2.4979, 0.0006), (3.9319, 0.006), (4.3944, 0.01)];
    for (index, (known, its_error)) in known.into_iter().enumerate() {
        let (found, error) = (truth.irradiance[index].x, truth.standard_error[index].x);
        assert!((found - known).abs() < 3.0 * error.hypot(its_error), "{found} ± {error} instead of {known}");
    }
    let turn = Quat::from_euler(EulerRot::XYZ, 0.3, 1.1, -0.7);
    for (cuts, turn) in [(1, Quat::IDENTITY), (1, turn), (7, Quat::IDENTITY), (7, turn)] {
        let mut double = moved(&single, |at| turn * at);
        add_twins(&mut double, 0..6, cuts);
        let found = trace(&double, points(&double, |at| turn * at), 64);
        // What is turned looks in other directions.
        if turn == Quat::IDENTITY {
            assert_alike(&found, &truth, 1e-6, "twins");
        } else {
            let mut alone = double.clone();
            alone.polygons.truncate(7);
            let truth = trace(&alone, points(&alone, |at| turn * at), 64);
            assert_alike(&found, &truth, 1e-4, "turned twins");
        }
    }
}

/// Truth: no light gets through a wall. The neighbour shares the whole plane of a wall, or has a
/// wall that is larger and reaches beyond.
#[test]
fn a_neighbour_that_shares_a_wall_stays_dark() {
    let single = room();
    let truth = trace(&single, points(&single, |at| at), 32);
    for upper in [vec3(10.0, 3.0, 4.0), vec3(10.0, 4.0, 6.0)] {
        let mut both = single.clone();
        add_box(&mut both, (vec3(5.0, 0.0, 0.0), upper), true, (MaterialId(0), GROUP));
        let found = trace(&both, points(&both, |at| at), 32);
        assert_alike(&found, &truth, 1e-6, "beside a neighbour");
        let (lower, upper) = (vec3(5.0, 0.0, 0.0), upper);
        let beside = (7..13_u32).flat_map(|polygon| {
            let (corners, _) = both.corner_positions(&both.polygons[polygon as usize]);
            let middle = corners.iter().sum::<Vec3>() / 4.0;
            [middle, middle.lerp(corners[0], 0.999), middle.lerp(corners[2], 0.9999)].map(|at| (polygon, at))
        });
        let points: Vec<SurfacePoint> =
            beside.map(|(polygon, at)| SurfacePoint::on(&both, polygon, at.clamp(lower, upper))).collect();
        let dark = trace(&both, points, 32);
        assert!(dark.irradiance.iter().all(|value| *value == DVec3::ZERO), "{:?}", dark.irradiance);
    }
}

/// Truth: the furnace, B = B_e/(1 − ρ) everywhere and so E = 2 for ρ = ½ and B_e = 1, whatever is
/// there twice: a floor and the same floor in triangles, a floor and a smaller one that lies on it,
/// all faces.
#[test]
fn a_face_that_is_there_twice_counts_once() {
    let furnace = selflink::measure::stability::scenes::empty_room(0.5, 1.0);
    let again = |polygons: std::ops::Range<usize>, cuts: usize, size: f32| {
        let mut scene = furnace.clone();
        for index in polygons {
            let polygon = scene.polygons[index];
            let ([a, b, c, d], _) = scene.corner_positions(&polygon);
            let [b, c, d] = [b, c, d].map(|corner| a.lerp(corner, size));
            if cuts == 0 {
                scene.add_quad([a, b, c, d], polygon.material, GROUP);
            } else {
                scene.add_triangle([a, b, c], polygon.material, GROUP);
                scene.add_triangle([a, c, d], polygon.material, GROUP);
            }
        }
        scene
    };
    for (what, scene) in [
        ("a floor in triangles", again(1..2, 2, 1.0)),
        ("a smaller floor on it", again(1..2, 0, 0.6)),
        ("all faces", again(0..6, 2, 1.0)),
    ] {
        let of = |polygon: u32| {
            let ([a, b, c, _], _) = scene.corner_positions(&scene.polygons[polygon as usize]);
            SurfacePoint::on(&scene, polygon, a.lerp(b.lerp(c, 0.7), 0.4))
        };
        let found = trace(&scene, (0..scene.polygons.len() as u32).map(of).collect(), 48);
        for (value, error) in found.irradiance.iter().zip(&found.standard_error) {
            assert!((value.x - 2.0).abs() < 4.0 * error.x + 1e-6 && error.x < 0.05, "{what}: {value} ± {error}");
        }
    }
}

/// Truth: similarity. E does not depend on the size of a scene, as long as its lamps shine alike:
/// from 10⁻⁴ to 10⁴ m.
#[test]
fn scenes_of_any_size_are_lit_alike() {
    let mut scene = room();
    add_twins(&mut scene, 0..6, 3);
    let truth = trace(&scene, points(&scene, |at| at), 16);
    for scale in [2e-5, 0.01, 100.0, 2e3] {
        let other = moved(&scene, |at| scale * at);
        let found = trace(&other, points(&other, |at| scale * at), 16);
        assert_alike(&found, &truth, 1e-4, &format!("scale {scale}"));
    }
}

/// Truth: translation. Corners that single precision holds exactly are where they are, 16 and 262
/// km from the origin too.
#[test]
fn a_room_far_from_the_origin_is_lit_alike() {
    let scene = room();
    let truth = trace(&scene, points(&scene, |at| at), 16);
    for far in [16_384.0, 262_144.0] {
        let place = |at: Vec3| at + vec3(far, 0.0, far);
        let found = trace(&moved(&scene, place), points(&moved(&scene, place), place), 16);
        assert_alike(&found, &truth, 1e-3, &format!("{far} m away"));
    }
}

/// Truth: a sheet 1 mm above the floor keeps all light from it and is lit like the floor; 1 mm
/// below it changes nothing.
#[test]
fn faces_a_millimetre_apart_are_two() {
    let single = room();
    let truth = trace(&single, points(&single, |at| at), 16);
    for height in [0.001_f32, -0.001] {
        let mut scene = single.clone();
        let lower = vec3(0.25, height.min(0.0), 0.25);
        let upper = vec3(0.75, height.max(0.0), 0.75);
        let sheet = [[lower.x, lower.z], [lower.x, upper.z], [upper.x, upper.z], [upper.x, lower.z]];
        scene.add_quad(sheet.map(|[x, z]| vec3(x, height, z)), MaterialId(0), GROUP);
        let mut places = points(&scene, |at| at);
        places.push(SurfacePoint::on(&scene, 7, vec3(0.5, height, 0.5)));
        let found = trace(&scene, places, 16);
        let (floor, sheet) = (found.irradiance[0].x, found.irradiance[4].x);
        let error = found.standard_error[4].x + truth.standard_error[0].x;
        if height > 0.0 {
            // All that gets under it comes through a slit of 1 mm.
            assert!(floor < 0.01 * truth.irradiance[0].x, "{floor}");
            assert!((sheet - truth.irradiance[0].x).abs() < 3.0 * error, "{sheet} ± {error}");
        } else {
            assert!((floor - truth.irradiance[0].x).abs() < 1e-6 * floor, "{floor}");
            assert_eq!(sheet, 0.0, "nothing is below the floor");
        }
    }
}
