//! Our own scenes: exact sizes, sound geometry, rooms without leaks, and files that say the same as
//! the code.
//!
//! Truth: the polygon counts of the paper (section 4), and invariants of closed rooms made of
//! closed solids: no ray from inside leaves the room or meets the back of a face.

use std::collections::{HashMap, HashSet};
use std::path::Path;

use glam::{Vec3, vec3};
use selflink::geometry::Occluders;
use selflink::scene::builtin::BuiltinScene;
use selflink::scene::{GroupId, Polygon, Scene, Sides, write_obj};

const SEMINAR: BuiltinScene = BuiltinScene::Seminar { polygons: BuiltinScene::SEMINAR_POLYGONS };

/// A low-discrepancy sequence is repeatable and reaches every corner (R. Cranley's additive
/// recurrence, plastic number).
fn sample(index: usize, dimension: i32) -> f32 {
    (0.5 + (index + 1) as f64 * 1.220_744_084_605_759_5_f64.powi(-dimension - 1)).fract() as f32
}

fn direction(index: usize) -> Vec3 {
    let (z, angle) = (2.0 * sample(index, 0) - 1.0, std::f32::consts::TAU * sample(index, 1));
    let r = (1.0 - z * z).sqrt();
    vec3(r * angle.cos(), r * angle.sin(), z).normalize()
}

#[test]
fn the_papers_rooms_have_the_papers_polygon_counts() {
    assert_eq!(BuiltinScene::from_name("seminar"), Some(SEMINAR));
    assert_eq!(SEMINAR.build().polygons.len(), 2_008);
    assert_eq!(BuiltinScene::default(), BuiltinScene::Office);
    assert_eq!(BuiltinScene::Office.build().polygons.len(), 4_038);
}

#[test]
fn the_seminar_room_takes_any_size_exactly() {
    let sizes = [
        1_000, 1_001, 1_002, 1_003, 1_234, 1_499, 2_007, 2_009, 2_500, 2_999, 3_333, 4_096, 6_007, 8_192, 12_345,
        16_384, 32_768, 65_537, 131_072, 262_143, 262_144,
    ];
    for polygons in sizes {
        assert_eq!(BuiltinScene::Seminar { polygons }.build().polygons.len(), polygons);
    }
    for (asked, drawn) in [(0, 1_000), (999, 1_000), (usize::MAX, 262_144)] {
        assert_eq!(BuiltinScene::Seminar { polygons: asked }.build().polygons.len(), drawn);
    }
}

/// Truth: each office of the tower is the office, moved; whole ones come as near to the number
/// asked for as they can.
#[test]
fn a_tower_is_made_of_offices() {
    let office = BuiltinScene::Office.build();
    let size = office.polygons.len();
    for (asked, offices) in [(0, 2), (10_000, 2), (30_000, 7), (80_000, 20)] {
        let tower = BuiltinScene::Tower { polygons: asked }.build();
        assert_eq!(tower.polygons.len(), offices * size, "{asked} asked for");
        assert_eq!(tower.materials, office.materials);
        for (index, polygon) in tower.polygons.iter().enumerate() {
            let own = &office.polygons[index % size];
            assert!((tower.area(polygon) - office.area(own)).abs() <= 1e-3 * office.area(own) + 1e-6);
            let path = tower.group_path(polygon.group);
            let kept = office.group_path(own.group);
            assert!(path.starts_with("storey_") && path.ends_with(&kept), "{path} is not {kept}");
        }
    }
}

#[test]
fn drawing_twice_gives_the_same_scene() {
    for builtin in BuiltinScene::ALL {
        let (one, other) = (builtin.build(), builtin.build());
        assert_eq!(one.vertices, other.vertices);
        assert_eq!(one.polygons, other.polygons);
        assert_eq!(one.materials, other.materials);
    }
}

fn scenes() -> Vec<Scene> {
    let large = BuiltinScene::Seminar { polygons: 20_001 };
    BuiltinScene::ALL.into_iter().chain([large]).map(|scene| scene.build()).collect()
}

#[test]
fn polygons_are_planar_convex_and_drawn_once() {
    for scene in scenes() {
        let mut seen = HashSet::new();
        for (index, polygon) in scene.polygons.iter().enumerate() {
            let place = || format!("{}: polygon {index} in {}", scene.name, scene.group_path(polygon.group));
            let (corners, count) = scene.corner_positions(polygon);
            let corners = &corners[..count];
            let normal = scene.normal(polygon);
            let size = corners.iter().map(|corner| corner.distance(corners[0])).fold(0.0, f32::max);
            assert!(scene.area(polygon) > 1e-6 && normal.is_normalized(), "{} has no area", place());
            for step in 0..count {
                let [a, b, c] = [0, 1, 2].map(|next| corners[(step + next) % count]);
                // f32 positions some metres from the origin are good to 5e-7 m, of 7 mm (a key)
                // 1e-4.
                assert!((a - corners[0]).dot(normal).abs() <= 1e-4 * size, "{} is not planar", place());
                assert!((b - a).cross(c - b).dot(normal) > 0.0, "{} is not convex", place());
            }
            let mut indices = polygon.corners().to_vec();
            indices.sort_unstable();
            assert!(seen.insert(indices), "{} is drawn twice", place());
        }
    }
}

#[test]
fn corners_at_one_place_share_a_vertex() {
    for scene in scenes() {
        let places: HashSet<_> = scene.vertices.iter().map(|vertex| vertex.to_array().map(f32::to_bits)).collect();
        assert_eq!(places.len(), scene.vertices.len());
    }
}

#[test]
fn groups_are_small_named_once_and_follow_their_parents() {
    for scene in scenes() {
        let mut direct = vec![0; scene.groups.len()];
        for polygon in &scene.polygons {
            direct[polygon.group.0 as usize] += 1;
        }
        assert_eq!(direct[0], 0, "{}: every polygon belongs to something", scene.name);
        let mut paths = HashSet::new();
        for (index, group) in scene.groups.iter().enumerate() {
            let path = scene.group_path(GroupId(index as u32));
            assert_eq!(group.parent.is_none(), index == 0);
            assert!(group.parent.is_none_or(|parent| (parent.0 as usize) < index), "{path} precedes its parent");
            assert!(direct[index] <= 64, "{path} holds {} polygons", direct[index]);
            assert!(paths.insert(path.clone()), "two groups are called {path}");
        }
    }
}

#[test]
fn materials_reflect_less_than_they_receive_and_some_emit() {
    for scene in scenes() {
        for material in &scene.materials {
            let rho = material.reflectance;
            assert!(rho.min_element() >= 0.0 && rho.max_element() <= 0.9, "{}: {rho}", material.name);
        }
        let used: HashSet<_> = scene.polygons.iter().map(|polygon| polygon.material.0 as usize).collect();
        assert_eq!(used.len(), scene.materials.len(), "{}: every material is used", scene.name);
        assert!(scene.emitted_power().min_element() > 0.0);
    }
}

#[test]
fn rooms_leak_no_light_and_show_no_backs() {
    for builtin in [SEMINAR, BuiltinScene::Office, BuiltinScene::Seminar { polygons: 40_000 }] {
        let scene = builtin.build();
        let occluders = Occluders::new(&scene);
        let eye = scene.camera.expect("our own scenes have a camera").eye;
        let (mut escaped, mut backs, mut rays) = (0, 0, 0);
        // Each path starts at the eye and bounces on, so that rays set out from everywhere that the
        // eye's light reaches.
        for path in 0..20_000 {
            let (mut origin, mut normal) = (eye, Vec3::ZERO);
            for bounce in 0..4 {
                let around = direction(7 * path + bounce);
                let towards = (around + normal * 1.001).normalize();
                rays += 1;
                let met = if bounce == 0 {
                    occluders.first_hit(origin, towards)
                } else {
                    occluders.ray_from(origin, normal, towards)
                };
                let Some(hit) = met else {
                    assert!(bounce > 0, "{}: a ray from the eye leaves along {towards}", scene.name);
                    escaped += 1;
                    break;
                };
                if !hit.front {
                    assert!(bounce > 0, "{}: the eye sees a back along {towards}", scene.name);
                    backs += 1;
                    break;
                }
                normal = scene.normal(&scene.polygons[hit.polygon as usize]);
                origin = hit.point;
            }
        }
        assert!(escaped == 0 && backs == 0, "{}: of {rays} rays {escaped} escaped, {backs} met a back", scene.name);
    }
}

/// What a particle sees that slipped into a solid where two of its parts cross is no back of the
/// room.
#[test]
fn loading_has_no_remark_on_our_own_scenes() {
    for scene in scenes() {
        let (scene, _) = selflink::geometry::orient::apply(scene, Sides::Front);
        assert_eq!(scene.skipped.faces_seen_from_behind, 0, "{}", scene.name);
    }
}

#[test]
fn no_two_faces_lie_on_each_other() {
    for scene in scenes() {
        // Faces by plane, whichever way they look: the unit normal's rounding and the distance to
        // 0.1 mm.
        let mut planes: HashMap<[i32; 4], Vec<usize>> = HashMap::new();
        for (index, polygon) in scene.polygons.iter().enumerate() {
            let normal = scene.normal(polygon);
            let largest = normal.to_array().into_iter().find(|part| part.abs() > 0.5).unwrap_or(1.0);
            let normal = normal * largest.signum();
            let distance = normal.dot(scene.corner_positions(polygon).0[0]);
            let key = (normal * 1e3).round().as_ivec3();
            planes.entry([key.x, key.y, key.z, (distance * 1e4).round() as i32]).or_default().push(index);
        }
        let mut clashes = HashSet::new();
        for plane in planes.values() {
            for (&one, &other) in plane.iter().flat_map(|one| plane.iter().map(move |other| (one, other))) {
                let [a, b] = [one, other].map(|index| &scene.polygons[index]);
                let (corners, count) = scene.corner_positions(a);
                let middle = corners[..count].iter().sum::<Vec3>() / count as f32;
                let mut points = corners[..count].iter().map(|corner| middle.lerp(*corner, 0.9)).chain([middle]);
                if one != other && points.any(|point| is_inside(&scene, b, point)) {
                    clashes.insert([a, b].map(|polygon| scene.group_path(polygon.group)));
                }
            }
        }
        assert!(clashes.is_empty(), "{}: faces lie on each other: {clashes:#?}", scene.name);
    }
}

#[test]
fn open_solids_rest_wholly_on_a_surface() {
    // The Cornell box has no front.
    for scene in scenes().into_iter().filter(|scene| scene.name != "cornell") {
        // An edge that one polygon has to itself is the rim of an opening.
        let mut owners: HashMap<(u32, u32), Vec<usize>> = HashMap::new();
        for (index, polygon) in scene.polygons.iter().enumerate() {
            let corners = polygon.corners();
            for (&from, &to) in corners.iter().zip(corners.iter().cycle().skip(1)) {
                owners.entry((from.min(to), from.max(to))).or_default().push(index);
            }
        }
        let occluders = Occluders::new(&scene);
        let mut loose = HashSet::new();
        for ((from, to), owners) in owners {
            let &[owner] = owners.as_slice() else { continue };
            let polygon = &scene.polygons[owner];
            let path = scene.group_path(polygon.group);
            if path == "walls" || path.starts_with("window_side") {
                continue; // the shell has edges to the outside; rays check it
            }
            let ([a, b, c, d], count) = scene.corner_positions(polygon);
            let middle = if count == 4 { (a + b + c + d) / 4.0 } else { (a + b + c) / 3.0 };
            let [from, to] = [from, to].map(|corner| scene.vertices[corner as usize]);
            for share in [0.02, 0.5, 0.98] {
                // From inside the solid, past the rim: a surface has to come at once.
                let rim = from.lerp(to, share);
                let along = (rim - middle).reject_from((to - from).normalize()).normalize();
                let start = rim - 1e-3 * along - 1e-4 * scene.normal(polygon);
                if occluders.first_hit(start, along).is_none_or(|hit| hit.distance > 4e-3) {
                    loose.insert(format!("{path} at {rim}"));
                }
            }
        }
        assert!(loose.is_empty(), "{}: {} rims hang in the air: {loose:#?}", scene.name, loose.len());
    }
}

/// Whether a point in the plane of a convex polygon lies inside it, at least 0.1 mm from its rim.
fn is_inside(scene: &Scene, polygon: &Polygon, point: Vec3) -> bool {
    let (corners, count) = scene.corner_positions(polygon);
    let normal = scene.normal(polygon);
    (0..count).all(|index| {
        let (from, to) = (corners[index], corners[(index + 1) % count]);
        (to - from).normalize().cross(point - from).dot(normal) > 1e-4
    })
}

#[test]
fn the_camera_overlooks_the_room() {
    for builtin in BuiltinScene::ALL.into_iter().skip(1) {
        let scene = builtin.build();
        let camera = scene.camera.expect("our own scenes have a camera");
        let occluders = Occluders::new(&scene);
        let forward = (camera.target - camera.eye).normalize();
        let right = forward.cross(camera.up).normalize();
        let half = (0.5 * camera.hfov_deg).to_radians().tan();
        let distances: Vec<f32> = (0..1_000)
            .map(|index| {
                let (x, y) = (2.0 * sample(index, 0) - 1.0, 1.25 * sample(index, 1) - 0.625);
                let towards = (forward + half * (x * right + y * right.cross(forward))).normalize();
                occluders.first_hit(camera.eye, towards).map_or(0.0, |hit| hit.distance)
            })
            .collect();
        let mean = distances.iter().sum::<f32>() / distances.len() as f32;
        assert!(mean > 1.5, "{}: {mean} m", scene.name);
        assert!(distances.iter().all(|&distance| distance > 0.3), "{}: something is before the eye", scene.name);
    }
}

/// A polygon by what it is rather than by index: corner bits, material and group path.
type Face = (Vec<[u32; 3]>, String, String);

fn faces(scene: &Scene) -> Vec<Face> {
    let corner = |&index: &u32| scene.vertices[index as usize].to_array().map(f32::to_bits);
    let face = |polygon: &Polygon| {
        let material = scene.materials[polygon.material.0 as usize].name.clone();
        (polygon.corners().iter().map(corner).collect(), material, scene.group_path(polygon.group))
    };
    scene.polygons.iter().map(face).collect()
}

#[test]
fn a_written_scene_reads_back_bit_for_bit() {
    let folder = tempfile::tempdir().expect("a temporary folder can be made");
    for scene in scenes() {
        let path = write_obj(&scene, folder.path()).expect("a temporary folder can be written");
        let (models, materials) = tobj::load_obj(&path, &tobj::LoadOptions::default()).expect("tobj reads the file");
        let materials = materials.expect("tobj reads the MTL");
        assert_eq!(materials.len(), scene.materials.len());
        for (read, written) in materials.iter().zip(&scene.materials) {
            assert_eq!(read.name, written.name);
            let diffuse = read.diffuse;
            assert_eq!(diffuse, Some(written.reflectance.to_array()));
            let exitance = Vec3::from(read.emissive.unwrap_or_default()) * std::f32::consts::PI;
            assert_eq!(exitance, written.emission, "{}", written.name);
        }
        let mut read: HashMap<Face, usize> = HashMap::new();
        for model in &models {
            let mesh = &model.mesh;
            let material = &materials[mesh.material_id.expect("every face has a material")].name;
            let mut start = 0;
            let counts =
                if mesh.face_arities.is_empty() { vec![3; mesh.indices.len() / 3] } else { mesh.face_arities.clone() };
            for count in counts {
                let corners = mesh.indices[start..start + count as usize]
                    .iter()
                    .map(|&index| [0, 1, 2].map(|axis| mesh.positions[3 * index as usize + axis].to_bits()))
                    .collect();
                start += count as usize;
                *read.entry((corners, material.clone(), model.name.clone())).or_default() += 1;
            }
        }
        assert_eq!(read.values().sum::<usize>(), scene.polygons.len());
        assert!(faces(&scene).iter().all(|face| read.contains_key(face)));
    }
}

#[test]
fn a_folder_that_cannot_be_written_is_one_sentence() {
    let folder = tempfile::tempdir().expect("a temporary folder can be made");
    let file = folder.path().join("taken");
    std::fs::write(&file, "not a folder").expect("a temporary folder can be written");
    let error = write_obj(&BuiltinScene::Cornell.build(), &file).expect_err("a file is no folder");
    assert!(error.to_string().contains("taken"), "{error}");
}

/// `SELFLINK_UPDATE_ASSETS=1 cargo test --test builtin assets_are_current` writes them.
#[test]
fn assets_are_current() {
    let assets = Path::new(env!("CARGO_MANIFEST_DIR")).join("assets");
    let folder = tempfile::tempdir().expect("a temporary folder can be made");
    let update = std::env::var_os("SELFLINK_UPDATE_ASSETS").is_some();
    for builtin in BuiltinScene::ALL {
        let target = if update { assets.as_path() } else { folder.path() };
        write_obj(&builtin.build(), target).expect("the folder can be written");
        for extension in ["obj", "mtl", "selflink.json"] {
            let name = format!("{}.{extension}", builtin.name());
            let [kept, drawn] =
                [&assets, target].map(|folder| std::fs::read(folder.join(&name)).expect("the file is there"));
            assert!(kept == drawn, "assets/{name} is stale: run this test once with SELFLINK_UPDATE_ASSETS=1");
        }
    }
}
