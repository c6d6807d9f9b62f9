//! Rows 7, 12, 16, 20, 22 and 23: meshes, and scenes that are the same but for how they are cut or
//! turned.

use glam::{Mat3, Vec3, vec3};
use rustc_hash::FxHashMap;

use super::measure::{CLUSTERED, MODES, deviation, difference, is_sound, leaves, params, received, solve};
use super::scenes::{add_box, empty_room, furnished_room, lamp_room};
use super::{Check, Row};
use crate::hierarchy::ClusteringMode;
use crate::measure::accuracy::cases::{self, level};
use crate::scene::{GroupId, Polygon, Scene};
use crate::solve::{Solver, SolverError};

pub(super) fn rows() -> Vec<Row> {
    vec![
        Row {
            number: 7,
            name: "hanging-vertices",
            asked: "the shown mesh has no crack and no jump inside a surface, and each surface its whole rim, to 1e-4",
            limit: None,
            measure: hanging_vertices,
        },
        Row {
            number: 12,
            name: "moved-scene",
            asked: "a room moved and turned keeps its B to twice the error that it has",
            limit: None,
            measure: moved_scene,
        },
        Row {
            number: 16,
            name: "many-patches",
            asked: "a floor of 10,000 patches is lit like one polygon, to 1 %, with fewer than 3 times the links",
            limit: Some("clusters of small patches are lit as one where a polygon would be split along the shadow"),
            measure: many_patches,
        },
        Row {
            number: 20,
            name: "sibling-noise",
            asked: "an evenly lit surface is even to 1 %, and the same bits on 1 and 3 threads",
            limit: Some("a sphere of 320 flat faces is itself uneven by some tenths of a per cent"),
            measure: sibling_noise,
        },
        Row {
            number: 22,
            name: "duplicates",
            asked: "a room with a second skin 1 mm behind its own is lit alike, to 1 %",
            limit: Some("the skin makes other clusters, and so other links that few rays judge"),
            measure: duplicates,
        },
        Row {
            number: 23,
            name: "slivers",
            asked: "slivers and flat clusters give numbers, and the light of the floor that they make up, to 1 %",
            limit: None,
            measure: slivers,
        },
    ]
}

/// Ends of an edge by the bits of their positions, and the surface that it lies on.
type Edge = ([[u32; 3]; 2], u32);

fn hanging_vertices() -> Result<Vec<Check>, SolverError> {
    let scene = lamp_room();
    let mut checks = Vec::new();
    for mode in MODES {
        let mut solved = solve(&scene, params(mode, 1e-3))?;
        let snapshot = solved.snapshot();
        let mesh = &snapshot.mesh;
        let surfaces = solved.hierarchy().smooth_surfaces();
        let bits = |vertex: u32| mesh.positions[vertex as usize].map(|value| (value + 0.0).to_bits());
        let (mut uses, mut vertex_at) = (FxHashMap::<Edge, usize>::default(), FxHashMap::default());
        let mut jumps = 0.0_f64;
        for (triangle, &leaf) in mesh.triangles.iter().zip(&mesh.triangle_leaf) {
            let surface = surfaces[mesh.leaves[leaf as usize].polygon as usize];
            for corner in 0..3 {
                let (from, to) = (triangle[corner], triangle[(corner + 1) % 3]);
                let mut ends = [bits(from), bits(to)];
                ends.sort_unstable();
                *uses.entry((ends, surface)).or_insert(0) += 1;
                // One position of one surface must show one light.
                let first = *vertex_at.entry((bits(from), surface)).or_insert(from);
                let [a, b] = [first, from].map(|vertex| Vec3::from(snapshot.vertex_radiosity[vertex as usize]));
                jumps = jumps.max(f64::from((a - b).abs().max_element()));
            }
        }
        let length = |ends: &[[u32; 3]; 2]| {
            let [a, b] = ends.map(|end| Vec3::from(end.map(f32::from_bits)));
            f64::from((a - b).length())
        };
        // A hanging vertex leaves edges with one triangle inside a surface, which count as rim.
        let rims: f64 = uses.iter().filter(|(_, uses)| **uses == 1).map(|((ends, _), _)| length(ends)).sum();
        let expected: f64 = scene.polygons.iter().map(|polygon| perimeter(&scene, polygon)).sum();
        checks.push(Check::within(format!("rims, m, {mode:?}"), expected, rims, 1e-4));
        checks.push(Check::near(format!("largest jump, W/m², {mode:?}"), 0.0, jumps, 0.0));
    }
    Ok(checks)
}

fn perimeter(scene: &Scene, polygon: &Polygon) -> f64 {
    let (corners, count) = scene.corner_positions(polygon);
    (0..count).map(|index| f64::from((corners[index] - corners[(index + 1) % count]).length())).sum()
}

fn moved_scene() -> Result<Vec<Check>, SolverError> {
    let scene = lamp_room();
    let axis = vec3(0.3, 0.8, 0.52).normalize();
    let turn = Mat3::from_axis_angle(axis, 0.7);
    let shift = vec3(std::f32::consts::PI, -std::f32::consts::E, std::f32::consts::SQRT_2);
    let moved = |by: &dyn Fn(Vec3) -> Vec3| {
        let mut scene = scene.clone();
        scene.vertices.iter_mut().for_each(|vertex| *vertex = by(*vertex));
        scene
    };
    let truth = solve(&scene, params(ClusteringMode::Adaptive, 1e-4))?;
    let mut checks = Vec::new();
    for mode in MODES {
        let plain = solve(&scene, params(mode, 1e-3))?;
        let error = difference(&plain, &truth);
        for (what, scene) in [
            ("shifted", moved(&|vertex| vertex + shift)),
            ("turned", moved(&|vertex| turn * vertex)),
            ("both", moved(&|vertex| turn * vertex + shift)),
        ] {
            let off = difference(&solve(&scene, params(mode, 1e-3))?, &plain);
            checks.push(Check::at_most(format!("{what}, {mode:?}, RMS of B"), 2.0 * error, off));
        }
    }
    Ok(checks)
}

/// The lamp room, its floor cut into so many squares along each side.
fn with_floor_of(pieces: usize) -> (Scene, Vec<u32>) {
    let mut scene = lamp_room();
    // The face whose corners all lie at y = 0; it stays in its place as the first piece.
    let is_floor = |scene: &Scene, polygon: &Polygon| {
        let (corners, count) = scene.corner_positions(polygon);
        corners[..count].iter().all(|corner| corner.y == 0.0)
    };
    let place = scene.polygons.iter().position(|polygon| is_floor(&scene, polygon)).unwrap_or(0);
    let floor = scene.polygons.remove(place);
    let first = scene.polygons.len() as u32;
    let at = |piece: usize| piece as f32 / pieces as f32;
    let group = scene.add_group("floor", GroupId(0));
    for (i, j) in (0..pieces * pieces).map(|piece| (piece / pieces, piece % pieces)) {
        let corner = |i: usize, j: usize| vec3(at(i), 0.0, at(j));
        let corners = [corner(i, j), corner(i, j + 1), corner(i + 1, j + 1), corner(i + 1, j)];
        scene.add_quad(corners, floor.material, group);
    }
    let pieces = (first..scene.polygons.len() as u32).collect();
    (scene, pieces)
}

fn many_patches() -> Result<Vec<Check>, SolverError> {
    let ((whole, one), (cut, many)) = (with_floor_of(1), with_floor_of(100));
    let mean = |solved: &Solver, polygons: &[u32]| {
        let mut sum = (0.0, 0.0);
        let hierarchy = solved.hierarchy();
        let is_wanted = |polygon: u32| (polygons[0]..=polygons[polygons.len() - 1]).contains(&polygon);
        for (leaf, _) in leaves(hierarchy).into_iter().filter(|(_, polygon)| is_wanted(*polygon)) {
            let area = f64::from(hierarchy.element(leaf).area);
            sum = (sum.0 + area, sum.1 + area * f64::from(solved.irradiance()[leaf.index()].x));
        }
        sum.1 / sum.0
    };
    let mut checks = Vec::new();
    for mode in CLUSTERED {
        let (plain, other) = (solve(&whole, params(mode, 1e-3))?, solve(&cut, params(mode, 1e-3))?);
        let check = Check::within(format!("E of the floor, {mode:?}"), mean(&plain, &one), mean(&other, &many), 0.01);
        checks.push(check.known_within(0.055));
        let (links, most) = (other.links().len() as f64, 3.0 * plain.links().len() as f64);
        checks.push(Check::at_most(format!("links, {mode:?}"), most, links));
    }
    Ok(checks)
}

fn sibling_noise() -> Result<Vec<Check>, SolverError> {
    let sphere = cases::all().into_iter().find(|case| case.name.starts_with("sphere")).map(|case| case.scene);
    let mut checks = Vec::new();
    for mode in MODES {
        let (_, rms, _) = deviation(&solve(&empty_room(0.5, 1.0), params(mode, 1e-4))?, 2.0);
        checks.push(Check::near(format!("RMS of an empty furnace, {mode:?}"), 0.0, rms, 0.01));
        let (_, rms, _) = deviation(&solve(&furnished_room(0.5, 1.0), params(mode, 1e-4))?, 2.0);
        checks.push(Check::near(format!("RMS of a furnished furnace, {mode:?}"), 0.0, rms, 0.01));
        if let Some(sphere) = &sphere {
            let rms = unevenness(&solve(sphere, params(mode, 1e-4))?, |centre| centre.z < 0.0);
            checks.push(Check::near(format!("RMS of E in half a sphere, {mode:?}"), 0.0, rms, 0.01).known_to(0.014));
        }
    }
    let on = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        let solve = || solve(&lamp_room(), params(ClusteringMode::Adaptive, 1e-3));
        // Without threads of its own it runs on those that are there.
        pool.map_or_else(|_| solve(), |pool| pool.install(solve))
    };
    let (one, three) = (on(1)?, on(3)?);
    let differing = one.radiosity().iter().zip(three.radiosity()).filter(|(a, b)| a != b).count();
    let missing = one.radiosity().len().abs_diff(three.radiosity().len());
    checks.push(Check::near("elements that differ by threads", 0.0, (differing + missing) as f64, 0.0));
    Ok(checks)
}

/// RMS deviation of E from its mean over the leaves whose centre is wanted.
fn unevenness(solved: &Solver, is_wanted: impl Fn(Vec3) -> bool) -> f64 {
    let hierarchy = solved.hierarchy();
    let values: Vec<(f64, f64)> = leaves(hierarchy)
        .into_iter()
        .filter(|(leaf, _)| is_wanted(hierarchy.element(*leaf).centre))
        .map(|(leaf, _)| (f64::from(hierarchy.element(leaf).area), f64::from(solved.irradiance()[leaf.index()].x)))
        .collect();
    let area: f64 = values.iter().map(|(area, _)| area).sum();
    let mean = values.iter().map(|(area, value)| area * value).sum::<f64>() / area;
    let square = values.iter().map(|(area, value)| area * (value / mean - 1.0).powi(2)).sum::<f64>() / area;
    square.sqrt()
}

fn duplicates() -> Result<Vec<Check>, SolverError> {
    let scene = lamp_room();
    let mut doubled = scene.clone();
    for polygon in &scene.polygons {
        let (corners, count) = scene.corner_positions(polygon);
        let behind = corners.map(|corner| corner - 0.001 * scene.normal(polygon));
        if count == 4 {
            doubled.add_quad(behind, polygon.material, polygon.group);
        }
    }
    let mut checks = Vec::new();
    for mode in MODES {
        let (plain, other) = (solve(&scene, params(mode, 1e-3))?, solve(&doubled, params(mode, 1e-3))?);
        let power = |solved: &Solver| (0..scene.polygons.len() as u32).map(|face| received(solved, face)).sum::<f64>();
        let what = format!("W on the room's own faces, {mode:?}");
        checks.push(Check::within(what, power(&plain), power(&other), 0.01).known_within(0.02));
    }
    Ok(checks)
}

/// A lamp over a floor of one square, or of 200 strips, each cut into two long triangles.
fn floor_of_strips(strips: usize) -> Scene {
    let mut scene = Scene::new("strips");
    let lamp = scene.add_material("lamp", Vec3::ZERO, Vec3::ONE);
    let grey = scene.add_material("grey", Vec3::splat(0.5), Vec3::ZERO);
    scene.add_quad(level([0.0, 1.0], [0.0, 1.0], 1.0, false), lamp, GroupId(0));
    // A flat cluster: squares of one plane in a group of their own.
    let board = scene.add_group("board", GroupId(0));
    for index in 0..9 {
        let (x, y) = (f64::from(index % 3), f64::from(index / 3));
        scene.add_quad(level([3.0 + x, 3.9 + x], [y, y + 0.9], 0.0, true), grey, board);
    }
    let floor = scene.add_group("floor", GroupId(0));
    for strip in 0..strips {
        let at = |strip: usize| strip as f64 / strips as f64;
        let [a, b, c, d] = level([at(strip), at(strip + 1)], [0.0, 1.0], 0.0, true);
        if strips == 1 {
            scene.add_quad([a, b, c, d], grey, floor);
        } else {
            scene.add_triangle([a, b, c], grey, floor);
            scene.add_triangle([a, c, d], grey, floor);
        }
    }
    // A needle of a ten-thousandth of its length across.
    scene.add_triangle([vec3(1.5, 0.0, 0.2), vec3(2.5, 0.0, 0.2), vec3(2.0, 1e-4, 0.2)], grey, floor);
    add_box(&mut scene, (vec3(1.5, 0.0, -1e-4), vec3(1.7, 1.0, 0.0)), false, (grey, floor));
    scene
}

fn slivers() -> Result<Vec<Check>, SolverError> {
    let (whole, cut) = (floor_of_strips(1), floor_of_strips(200));
    let mut checks = Vec::new();
    for mode in MODES {
        let (plain, other) = (solve(&whole, params(mode, 1e-4))?, solve(&cut, params(mode, 1e-4))?);
        let of_strips = (10..410).map(|polygon| received(&other, polygon)).sum::<f64>();
        checks.push(Check::within(format!("W on the floor, {mode:?}"), received(&plain, 10), of_strips, 0.01));
        let sound = is_sound(&plain) && is_sound(&other);
        checks.push(Check::near(format!("all are numbers, {mode:?}"), 1.0, f64::from(u8::from(sound)), 0.0));
    }
    Ok(checks)
}
