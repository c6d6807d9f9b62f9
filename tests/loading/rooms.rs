//! How a room is found to stand: up, unit and sides.

use glam::Vec3;
use selflink::prepare::added_light::{AddedLight, CeilingLight};
use selflink::prepare::prepare;
use selflink::read::survey::WorkPlane;
use selflink::scene::{Reading, Sidecar, Sides, Source, Unit, UpAxis, load_with};

use crate::support::{Folder, glb};
use crate::{load, notes};

/// A room of 5 × 4 m and 3 m height with a table and a lamp, the axes given by `order`, scaled.
fn room(order: fn(f32, f32, f32) -> [f32; 3], scale: f32, outwards: bool) -> String {
    let mut text = String::from("mtllib a.mtl\n");
    let mut corners = Vec::new();
    for (x, up, z) in
        [(0., 0., 0.), (5., 0., 0.), (5., 3., 0.), (0., 3., 0.), (0., 0., 4.), (5., 0., 4.), (5., 3., 4.), (0., 3., 4.)]
    {
        corners.push((x, up, z));
    }
    corners.extend([(2.0, 0.75, 1.6), (3.2, 0.75, 1.6), (3.2, 0.75, 2.4), (2.0, 0.75, 2.4)]);
    corners.extend([(2.0, 2.9, 1.5), (3.0, 2.9, 1.5), (3.0, 2.9, 2.5), (2.0, 2.9, 2.5)]);
    for (x, up, z) in corners {
        let [x, y, z] = order(x, up, z).map(|value| scale * value);
        text += &format!("v {x} {y} {z}\n");
    }
    text += "usemtl wall\n";
    for [a, b, c, d] in [[1, 2, 3, 4], [6, 5, 8, 7], [5, 1, 4, 8], [2, 6, 7, 3], [5, 6, 2, 1], [4, 3, 7, 8]] {
        text += &if outwards { format!("f {d} {c} {b} {a}\n") } else { format!("f {a} {b} {c} {d}\n") };
    }
    text + "usemtl table\nf 12 11 10 9\nf 9 10 11 12\nusemtl lamp\nf 13 14 15 16\n"
}

const ROOM: &str = "newmtl wall\nKd .7 .7 .7\nnewmtl table\nKd .4 .25 .1\nnewmtl lamp\nKd 0 0 0\nKe 30 30 30\n";

fn y_up(x: f32, up: f32, z: f32) -> [f32; 3] {
    [x, up, z]
}

fn z_up(x: f32, up: f32, z: f32) -> [f32; 3] {
    [x, -z, up]
}

#[test]
fn up_is_seen_by_how_a_room_looks() {
    for (order, up) in [(y_up as fn(f32, f32, f32) -> [f32; 3], UpAxis::Y), (z_up, UpAxis::Z)] {
        let folder = Folder::new();
        folder.write("a.mtl", ROOM);
        let path = folder.write("a.obj", room(order, 1.0, false));
        let ready =
            prepare(&Source::File(path.clone()), &Reading::default(), &AddedLight::default(), None).expect("a room");
        let scene = &ready.scene;
        assert_eq!(scene.frame.up, Some(up));
        assert_eq!(notes(scene).contains("z is taken for up"), up == UpAxis::Z);
        let view = scene.camera.expect("a place to stand");
        assert_eq!((view.up, scene.up_axis()), (up.vector(), up.vector()));
        assert!((view.eye.dot(up.vector()) - 1.6).abs() < 1e-3, "{view:?}");
        let other = if up == UpAxis::Y { UpAxis::Z } else { UpAxis::Y };
        let reading = Reading { up: Some(other), ..Reading::default() };
        assert_eq!(load_with(&Source::File(path), &reading).expect("a room").frame.up, Some(other));
    }
}

/// Truth: the lamp hangs from the ceiling, in an empty room and in one with an upright screen, and
/// whichever way its face was wound.
#[test]
fn up_is_seen_by_the_lamp() {
    for (order, up) in [(y_up as fn(f32, f32, f32) -> [f32; 3], UpAxis::Y), (z_up, UpAxis::Z)] {
        for (is_turned, has_screen) in [(false, false), (true, false), (false, up == UpAxis::Y)] {
            let mut corners = Vec::new();
            for height in [0.0, 3.0] {
                corners.extend([[0.0, height, 0.0], [4.0, height, 0.0], [4.0, height, 4.0], [0.0, height, 4.0]]);
            }
            corners.extend([[1.5, 2.95, 1.5], [2.5, 2.95, 1.5], [2.5, 2.95, 2.5], [1.5, 2.95, 2.5]]);
            corners.extend([[1.2, 0.8, 1.5], [2.8, 0.8, 1.5], [2.8, 2.2, 1.5], [1.2, 2.2, 1.5]]);
            let corners = corners.into_iter().map(|[x, height, z]: [f32; 3]| order(x, height, z));
            let corners: String = corners.map(|[x, y, z]| format!("v {x} {y} {z}\n")).collect();
            let walls = "usemtl wall\nf 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";
            let screen = if has_screen { "f 13 14 15 16\n" } else { "" };
            let lamp = if is_turned { "f 12 11 10 9\n" } else { "f 9 10 11 12\n" };
            let text = format!("mtllib a.mtl\n{corners}{walls}{screen}usemtl lamp\n{lamp}");
            let scene = load(&[("a.obj", text.as_bytes()), ("a.mtl", ROOM.as_bytes())], "a.obj");
            assert_eq!(scene.frame.up, Some(up), "turned {is_turned}, screen {has_screen}");
        }
    }
}

/// The room as glTF, which has y up, whatever its exporter made of that.
fn as_gltf(order: fn(f32, f32, f32) -> [f32; 3]) -> Vec<u8> {
    let text = room(order, 1.0, false);
    let numbers =
        |line: &str| -> Vec<f32> { line.split(' ').skip(1).filter_map(|number| number.parse().ok()).collect() };
    let corners: Vec<Vec<f32>> = text.lines().filter(|line| line.starts_with("v ")).map(numbers).collect();
    // Lamps are as in life in the middle of a face, and a bench stands askew.
    let mut faces: Vec<Vec<Vec<f32>>> = text
        .lines()
        .filter(|line| line.starts_with("f "))
        .map(|line| numbers(line).iter().map(|corner| corners[*corner as usize - 1].clone()).collect())
        .collect();
    let bench = [[3.6, 0.0, 2.5], [4.3, 0.0, 3.2], [4.3, 0.9, 3.2], [3.6, 0.9, 2.5]];
    faces.push(bench.map(|[x, up, z]| order(x, up, z).to_vec()).to_vec());
    let triangles = faces.iter().flat_map(|face| [0, 1, 2, 0, 2, 3].map(|corner: usize| face[corner].clone()));
    let binary: Vec<u8> = triangles.flatten().flat_map(f32::to_le_bytes).collect();
    let count = binary.len() / 12;
    let json = format!(
        r#"{{"asset":{{"version":"2.0"}},"scene":0,"scenes":[{{"nodes":[0]}}],"nodes":[{{"mesh":0}}],
        "meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}}}}]}}],
        "accessors":[{{"bufferView":0,"componentType":5126,"count":{count},"type":"VEC3","min":[-9,-9,-9],"max":[9,9,9]}}],
        "bufferViews":[{{"buffer":0,"byteLength":{length}}}],"buffers":[{{"byteLength":{length}}}]}}"#,
        length = binary.len()
    );
    glb(&json, &binary)
}

/// Truth: the room stands on its floor. Exporters can be set to leave z up in glTF, and the format
/// has no word for it.
#[test]
fn up_is_seen_where_a_format_prescribes_another_axis() {
    for (order, up) in [(y_up as fn(f32, f32, f32) -> [f32; 3], UpAxis::Y), (z_up, UpAxis::Z)] {
        let scene = load(&[("a.glb", &as_gltf(order))], "a.glb");
        assert_eq!(scene.frame.up, Some(up));
        assert_eq!(notes(&scene).contains("z is taken for up, as the scene looks, though"), up == UpAxis::Z);
    }
}

/// Truth: a room of 5 × 3 × 4 m in other units is as large.
#[test]
fn lengths_become_metres() {
    for (unit, given) in [(Unit::Centimetre, false), (Unit::Millimetre, false), (Unit::Inch, false), (Unit::Foot, true)]
    {
        let folder = Folder::new();
        folder.write("a.mtl", ROOM);
        let path = folder.write("a.obj", room(y_up, (1.0 / unit.metres()) as f32, false));
        let reading = Reading { unit: given.then_some(unit), ..Reading::default() };
        let scene = load_with(&Source::File(path), &reading).expect("a room");
        assert_eq!(scene.frame.unit, unit);
        assert!(scene.bounds().1.distance(Vec3::new(5.0, 3.0, 4.0)) < 1e-4, "{unit:?}: {}", scene.bounds().1);
        assert_eq!(notes(&scene).contains(unit.name()), !given, "{}", notes(&scene));
        let saved = Sidecar::of(&scene);
        assert_eq!(saved.unit, Some(unit), "what is saved in metres stays in metres");
    }
    let scene = load(
        &[("a.obj", room(y_up, 1000.0, false).replace("mtllib", "# File units = meters\nmtllib").as_bytes())],
        "a.obj",
    );
    assert_eq!((scene.frame.unit, scene.bounds().1.x), (Unit::Metre, 5000.0));
}

/// Truth: a box of 160 m around the room, as environments are drawn, makes it neither a doll's
/// house nor lie on its side; one stands in the room, with the eyes 1.6 m above its floor.
#[test]
fn a_room_below_a_sky_is_as_large_and_stood_in() {
    for (order, up) in [(y_up as fn(f32, f32, f32) -> [f32; 3], UpAxis::Y), (z_up, UpAxis::Z)] {
        let mut text = room(order, 1.0, false);
        for (x, level, z) in [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)] {
            let [x, y, z] = order(160.0 * x as f32 - 70.0, 160.0 * level as f32 - 0.3, 160.0 * z as f32 - 90.0);
            text += &format!("v {x} {y} {z}\n");
        }
        text += "usemtl sky\n";
        for [a, b, c, d] in [[1, 2, 3, 4], [6, 5, 8, 7], [5, 1, 4, 8], [2, 6, 7, 3], [5, 6, 2, 1], [4, 3, 7, 8]] {
            text += &format!("f {} {} {} {}\n", a + 16, b + 16, c + 16, d + 16);
        }
        let folder = Folder::new();
        folder.write("a.mtl", format!("{ROOM}newmtl sky\nKd .3 .5 .9\n"));
        let source = Source::File(folder.write("a.obj", text));
        for sides in [None, Some(Sides::Both)] {
            let ready = prepare(&source, &Reading::default(), &AddedLight::default(), sides).expect("a room");
            assert_eq!((ready.scene.frame.unit, ready.scene.frame.up), (Unit::Metre, Some(up)));
            let view = ready.scene.camera.expect("a place to stand");
            let [x, y, z] = order(1.0, 1.0, 1.0);
            let of_room = |at: Vec3| {
                let [x, level, z] =
                    if up == UpAxis::Y { [x * at.x, at.y, z * at.z] } else { [x * at.x, at.z, y * at.y] };
                x > 0.0 && x < 5.0 && z > 0.0 && z < 4.0 && level > 0.0 && level < 3.0
            };
            assert!(of_room(view.eye) && of_room(view.target), "{up:?}, {sides:?}: {view:?}");
            assert!((view.eye.dot(up.vector()) - 1.6).abs() < 1e-3, "{view:?}");
        }
    }
}

/// Truth: a room with a door of 2.1 m and a chair of 0.9 m, in each unit; feet and metres differ by
/// nothing else.
#[test]
fn doors_and_chairs_tell_feet_from_metres() {
    for unit in Unit::ALL {
        let scale = 1.0 / unit.metres();
        let mut text = room(y_up, scale as f32, false);
        for (index, (name, height)) in [("door", 2.1), ("office chair", 0.9)].into_iter().enumerate() {
            let [x, high] = [scale * (1.0 + index as f64), scale * height];
            text += &format!("v {x} 0 {x}\nv {} 0 {x}\nv {x} {high} {x}\no {name}\nf -3 -2 -1\n", 1.1 * x);
        }
        let folder = Folder::new();
        folder.write("a.mtl", ROOM);
        let scene = selflink::scene::load_file(&folder.write("a.obj", text)).expect("a room");
        assert_eq!(scene.frame.unit, unit);
        assert!(scene.bounds().1.distance(Vec3::new(5.0, 3.0, 4.0)) < 1e-4, "{unit:?}: {}", scene.bounds().1);
    }
}

/// Truth: a room with a desk of 0.74 m, a bed of 0.5 m and two stools of 0.45 m, all without names,
/// in each unit; a hall of 9 m with them is one, and an empty one too.
#[test]
fn nameless_furniture_tells_feet_from_metres() {
    let board = |[x, z]: [f64; 2], [width, depth]: [f64; 2], level: f64, scale: f64| {
        let corners = [[x, z], [x + width, z], [x + width, z + depth], [x, z + depth]];
        let vertex = |[x, z]: [f64; 2]| format!("v {} {} {}\n", scale * x, scale * level, scale * z);
        corners.map(vertex).concat() + "f -1 -2 -3 -4\n"
    };
    for (order, up) in [(y_up as fn(f32, f32, f32) -> [f32; 3], UpAxis::Y), (z_up, UpAxis::Z)] {
        for unit in Unit::ALL {
            let scale = 1.0 / unit.metres();
            let mut text = room(order, scale as f32, false).replace("usemtl table", "usemtl wall");
            let tops = [
                board([3.0, 0.1], [1.6, 0.8], 0.74, scale),
                board([0.2, 2.0], [1.0, 2.0], 0.5, scale),
                board([3.2, 1.0], [0.4, 0.4], 0.45, scale),
                board([4.0, 1.0], [0.4, 0.4], 0.45, scale),
            ]
            .concat();
            for line in tops.lines() {
                let numbers: Vec<f32> = line.split(' ').skip(1).filter_map(|number| number.parse().ok()).collect();
                match (line.starts_with('v'), &numbers[..]) {
                    (true, &[x, level, z]) => {
                        let [x, y, z] = order(x, level, z);
                        text += &format!("v {x} {y} {z}\n");
                    }
                    _ => text += &format!("{line}\n"),
                }
            }
            let folder = Folder::new();
            folder.write("a.mtl", ROOM);
            let scene = selflink::scene::load_file(&folder.write("a.obj", &text)).expect("a room");
            assert_eq!((scene.frame.unit, scene.frame.up), (unit, Some(up)));
            assert_eq!(notes(&scene).contains(unit.name()), unit != Unit::Metre, "{}", notes(&scene));
        }
    }
    for furniture in [true, false] {
        let mut text = room(y_up, 3.0, false).replace("usemtl table", "usemtl wall");
        if furniture {
            text += &board([6.0, 1.0], [1.6, 0.8], 0.74, 1.0);
            text += &board([6.0, 3.0], [0.4, 0.4], 0.45, 1.0);
            text += &board([7.0, 3.0], [0.4, 0.4], 0.45, 1.0);
        }
        let scene = load(&[("a.obj", text.as_bytes()), ("a.mtl", ROOM.as_bytes())], "a.obj");
        assert_eq!(scene.frame.unit, Unit::Metre, "{furniture}");
    }
}

/// Truth: the lamp hangs under the ceiling, which is 3 m up, and shines down; the work plane lies
/// 0.8 m above the floor.
#[test]
fn lamp_and_work_plane_follow_the_axis() {
    for (order, up) in [(y_up as fn(f32, f32, f32) -> [f32; 3], UpAxis::Y), (z_up, UpAxis::Z)] {
        let folder = Folder::new();
        folder.write("a.mtl", ROOM);
        let source = Source::File(folder.write("a.obj", room(order, 1.0, false)));
        let ceiling = Some(CeilingLight { size: Some(0.5), exitance: 100.0 });
        let light = AddedLight { ceiling, ..AddedLight::default() };
        let scene = prepare(&source, &Reading::default(), &light, None).expect("a room").scene;
        let lamp = scene.luminaires()[0].form;
        let level = lamp.centre.dot(up.vector());
        assert!(level > 2.8 && level < 3.0 && lamp.direction.distance(-up.vector()) < 1e-6, "{up:?}: {lamp:?}");
        let plane = WorkPlane { height: 0.8, ..WorkPlane::default() };
        let grid = plane.grid(&scene).expect("a floor");
        assert!(grid.up == up.vector() && !grid.points.is_empty());
        assert!(grid.points.iter().all(|point| (point.dot(up.vector()) - 0.8).abs() < 1e-5), "{up:?}");
    }
}

#[test]
fn a_room_wound_outwards_opens_lit() {
    let folder = Folder::new();
    folder.write("a.mtl", ROOM);
    let source = Source::File(folder.write("a.obj", room(y_up, 1.0, true)));
    let sides = |asked: Option<Sides>| {
        let ready = prepare(&source, &Reading::default(), &AddedLight::default(), asked).expect("a room");
        (ready.scene.sides, ready.scene.skipped.turned_faces, notes(&ready.scene))
    };
    let (auto, turned, said) = sides(None);
    assert_eq!((auto, turned), (Sides::Auto, 6));
    assert!(said.contains("turn their backs to the inside"), "{said}");
    assert_eq!(
        (sides(Some(Sides::Front)).0, sides(Some(Sides::Front)).1),
        (Sides::Front, 0),
        "unless somebody asks for it"
    );
}
