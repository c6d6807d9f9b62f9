//! Scenes whose irradiance is known exactly at some places: what the reference and the solver must
//! find.
//!
//! Figures are those of the closed forms; CIE 171:2006 is *Test cases to assess the accuracy of
//! lighting computer programs*, its analytical cases for diffuse surfaces. The z axis points up.

use std::f64::consts::PI;

use glam::{DVec3, Vec3, vec3};

use super::closed_forms::{self, Span};
use crate::measure::stability::scenes::add_box;
use crate::scene::{GroupId, MaterialId, Scene};

/// A scene and what is known of it.
pub struct Case {
    /// Description of the case.
    pub name: &'static str,
    /// Where its truth comes from.
    pub source: &'static str,
    /// The scene; nothing is to be turned or doubled.
    pub scene: Scene,
    /// Known values.
    pub readings: Vec<Reading>,
}

/// An irradiance that is known.
pub struct Reading {
    /// Name of the reading in a table.
    pub label: String,
    /// Where it is read.
    pub place: Place,
    /// The truth, in `unit`.
    pub truth: f64,
    /// Share by which the scene itself may miss the truth: curved surfaces are drawn with flat
    /// faces.
    pub allowance: f64,
    /// By how much an error in a row of form factors grows: 1/(1−ρ) in a closed room of one
    /// reflectance, else 1.
    pub gain: f64,
    /// Value of an irradiance of 1 W/m² in `unit`.
    pub factor: f64,
    /// `lx`, `%`, or empty for a form factor or an irradiance per exitance of 1.
    pub unit: &'static str,
}

/// Where something is read.
#[derive(Clone, Debug, PartialEq)]
pub enum Place {
    /// At a point of a polygon.
    Point {
        /// Index into [`Scene::polygons`].
        polygon: u32,
        /// Position, m.
        position: Vec3,
    },
    /// The mean over the area of these polygons.
    Mean(Vec<u32>),
}

/// All cases, in the order of the table.
pub fn all() -> Vec<Case> {
    let mut cases = rectangles();
    cases.push(point_and_rectangle());
    cases.push(sphere());
    cases.extend([0.5, 0.95].map(furnace));
    cases.extend(cubes());
    cases.extend([cie_5_2(), cie_5_3(), cie_5_6(), cie_5_7()]);
    cases.push(cie_5_8());
    cases
}

const UNIT: Span = [0.0, 1.0];

fn rectangles() -> Vec<Case> {
    let facing = |name, x, y, xi, eta, z| {
        let exchange = closed_forms::parallel_exchange(x, y, xi, eta, z);
        exchange_case(name, "Howell C-11", level(x, y, 0.0, true), level(xi, eta, z, false), exchange)
    };
    let perpendicular = |name, x, y, xi, eta| {
        let exchange = closed_forms::perpendicular_exchange(x, y, xi, eta);
        exchange_case(name, "Howell C-14", level(x, y, 0.0, true), upright(xi, eta), exchange)
    };
    vec![
        facing("facing unit squares", UNIT, UNIT, UNIT, UNIT, 1.0),
        facing("facing rectangles 2 × 1 at 0.5", [0.0, 2.0], UNIT, [0.0, 2.0], UNIT, 0.5),
        facing("facing squares shifted by 2 at 1", UNIT, UNIT, [2.0, 3.0], UNIT, 1.0),
        facing("facing squares shifted by (1, 1) at 2", UNIT, UNIT, [1.0, 2.0], [1.0, 2.0], 2.0),
        perpendicular("perpendicular unit squares", UNIT, UNIT, UNIT, UNIT),
        perpendicular("floor with a wall of half its height", UNIT, UNIT, [0.0, 0.5], UNIT),
        perpendicular("perpendicular squares, apart", [1.0, 2.0], UNIT, [1.0, 2.0], UNIT),
        perpendicular("perpendicular squares, apart and shifted", [0.5, 1.5], UNIT, [0.25, 1.25], [2.0, 3.0]),
    ]
}

/// One rectangle shines on the other: the mean irradiance of the black one is F(it←lamp).
fn exchange_case(name: &'static str, source: &'static str, lamp: [Vec3; 4], other: [Vec3; 4], exchange: f64) -> Case {
    let mut scene = Scene::new(name);
    let (emitter, black) = lamp_and_black(&mut scene, 1.0);
    scene.add_quad(lamp, emitter, GroupId(0));
    scene.add_quad(other, black, GroupId(0));
    let area = f64::from(scene.area(&scene.polygons[1]));
    Case { name, source, readings: vec![mean("F", vec![1], exchange / area)], scene }
}

fn point_and_rectangle() -> Case {
    let mut scene = Scene::new("point and rectangle");
    let (emitter, black) = lamp_and_black(&mut scene, 1.0);
    scene.add_quad(level([0.0, 1.0], [0.0, 2.0], 0.5, false), emitter, GroupId(0));
    scene.add_quad(level([-1.0, 2.0], [-1.0, 3.0], 0.0, true), black, GroupId(0));
    let lamp = corners(&scene, 0);
    let points = [("below a corner", 0.0, 0.0), ("below the middle", 0.5, 1.0), ("beside", 1.75, 0.25)];
    let reading = |(label, x, y): (&str, f64, f64)| {
        let truth = closed_forms::point_to_polygon(DVec3::new(x, y, 0.0), DVec3::Z, &lamp);
        point(label, 1, vec3(x as f32, y as f32, 0.0), truth)
    };
    Case { name: "point to rectangle", source: "Lambert", readings: points.map(reading).into(), scene }
}

fn furnace(reflectance: f64) -> Case {
    let name = if reflectance < 0.9 { "furnace, ρ = 0.5" } else { "furnace, ρ = 0.95" };
    let mut scene = Scene::new(name);
    let wall = scene.add_material("wall", Vec3::splat(reflectance as f32), Vec3::ONE);
    add_box(&mut scene, (Vec3::ZERO, Vec3::ONE), true, (wall, GroupId(0)));
    let truth = closed_forms::closed_room(1.0, 1.0, reflectance);
    let readings = [
        mean("all walls", (0..6).collect(), truth),
        point("in a wall", FLOOR, vec3(0.3, 0.6, 0.0), truth),
        point("near a corner", FLOOR, vec3(0.02, 0.03, 0.0), truth),
    ];
    let readings = readings.into_iter().map(|reading| in_closed_room(reading, reflectance)).collect();
    Case { name, source: "E = B_e/(1−ρ)", readings, scene }
}

/// The ceiling of a unit cube shines; means of B as found by solves with exact form factors,
/// extrapolated to N → ∞ (good to 2·10⁻⁵), here as E = (B − B_e)/ρ.
fn cubes() -> [Case; 3] {
    let cube = |name, reflectance: f64, ceiling_reflectance: f64, floor: f64, ceiling: Option<f64>, wall: f64| {
        let mut scene = Scene::new(name);
        let grey = scene.add_material("grey", Vec3::splat(reflectance as f32), Vec3::ZERO);
        let emitter = scene.add_material("ceiling", Vec3::splat(ceiling_reflectance as f32), Vec3::ONE);
        add_box(&mut scene, (Vec3::ZERO, Vec3::ONE), true, (grey, GroupId(0)));
        scene.polygons[CEILING as usize].material = emitter;
        let walls = (0..6).filter(|face| ![FLOOR, CEILING].contains(face)).collect();
        let mut readings =
            vec![mean("floor", vec![FLOOR], floor / reflectance), mean("walls", walls, wall / reflectance)];
        if let Some(ceiling) = ceiling {
            readings.push(mean("ceiling", vec![CEILING], (ceiling - 1.0) / ceiling_reflectance));
        }
        let readings = readings.into_iter().map(|reading| in_closed_room(reading, reflectance)).collect();
        Case { name, source: "extrapolated exact solves", readings, scene }
    };
    [
        cube("cube, ρ = 0.5", 0.5, 0.5, 0.17121, Some(1.10437), 0.18110),
        cube("cube, ρ = 0.8", 0.8, 0.8, 0.66097, Some(1.58755), 0.68787),
        cube("cube, black ceiling, ρ = 0.8", 0.8, 0.0, 0.41704, None, 0.43346),
    ]
}

/// A sphere of 320 triangles of ρ = 0.5 whose top shines. The mean over all faces is exact by
/// conservation; between flat faces F = A/4πR² holds to 0.5 % for the far half (measured with the
/// reference).
fn sphere() -> Case {
    let mut scene = Scene::new("sphere");
    let wall = scene.add_material("wall", Vec3::splat(0.5), Vec3::ZERO);
    let emitter = scene.add_material("top", Vec3::splat(0.5), Vec3::ONE);
    let mut far = Vec::new();
    for corners in icosphere(2) {
        let height = corners.iter().map(|corner| corner.z).sum::<f32>() / 3.0;
        if height < 0.0 {
            far.push(scene.polygons.len() as u32);
        }
        scene.add_triangle(corners, if height > 0.8 { emitter } else { wall }, GroupId(0));
    }
    let area: f64 = scene.polygons.iter().map(|polygon| f64::from(scene.area(polygon))).sum();
    let truth = closed_forms::closed_room(f64::from(scene.emitted_power().x), area, 0.5);
    let all = (0..scene.polygons.len() as u32).collect();
    let readings = [mean("all", all, truth), Reading { allowance: 0.005, ..mean("lower half", far, truth) }];
    let readings = readings.map(|reading| in_closed_room(reading, 0.5)).into();
    Case { name: "sphere, ρ = 0.5", source: "F = A/4πR²", readings, scene }
}

/// CIE 171:2006, 5.2: a point lamp of 1,000 cd, 3 m above a plane; here a Lambertian square of 1
/// cm, which differs by 10⁻⁵.
fn cie_5_2() -> Case {
    let mut scene = Scene::new("CIE 171 5.2");
    let side = 0.01;
    let (emitter, black) = lamp_and_black(&mut scene, PI * 1000.0 / (side * side));
    let half = [-0.5 * side, 0.5 * side];
    scene.add_quad(level(half, half, 3.0, false), emitter, GroupId(0));
    scene.add_quad(level([-2.0, 2.0], [-2.0, 2.0], 0.0, true), black, GroupId(0));
    let places = [("below", 0.0, 0.0), ("0.5 m aside", 0.5, 0.0), ("1 m aside", 1.0, 0.0), ("corner", 1.5, 1.5)];
    let reading = |(label, x, y): (&str, f64, f64)| {
        let truth = closed_forms::small_lamp(1000.0, 3.0, f64::hypot(x, y));
        Reading { unit: "lx", allowance: 1e-5, ..point(label, 1, vec3(x as f32, y as f32, 0.0), truth) }
    };
    Case { name: "CIE 171 5.2, point lamp", source: "I₀h²/d⁴", readings: places.map(reading).into(), scene }
}

/// CIE 171:2006, 5.3: a Lambertian square of 1 m and 1,000 cd in the ceiling of a black room of 4 ×
/// 4 × 3 m. The ceiling, which neither emits nor reflects, is left out.
fn cie_5_3() -> Case {
    let mut scene = Scene::new("CIE 171 5.3");
    let (emitter, black) = lamp_and_black(&mut scene, PI * 1000.0);
    scene.add_quad(level([1.5, 2.5], [1.5, 2.5], 3.0, false), emitter, GroupId(0));
    scene.add_quad(level([0.0, 4.0], [0.0, 4.0], 0.0, true), black, GroupId(0));
    scene.add_quad(wall(0.0, [0.0, 3.0], true), black, GroupId(0));
    let lamp = corners(&scene, 0);
    let on_wall = [2.75, 2.25, 1.75, 1.25, 0.75, 0.25].map(|z| (format!("wall, z = {z}"), 2, [2.0, 0.0, z], DVec3::Y));
    let on_floor = [0.25, 0.75, 1.25, 1.75].map(|y| (format!("floor, y = {y}"), 1, [2.0, y, 0.0], DVec3::Z));
    let reading = |(label, polygon, at, normal): (String, u32, [f64; 3], DVec3)| {
        let at = DVec3::from(at);
        let truth = PI * 1000.0 * closed_forms::point_to_polygon(at, normal, &lamp);
        Reading { unit: "lx", ..point(&label, polygon, at.as_vec3(), truth) }
    };
    let readings = on_wall.into_iter().chain(on_floor).map(reading).collect();
    Case { name: "CIE 171 5.3, area lamp", source: "Lambert", readings, scene }
}

/// CIE 171:2006, 5.6: light that a floor of 4 × 4 m reflects, as shares of what leaves it; here the
/// floor itself shines.
fn cie_5_6() -> Case {
    let mut scene = Scene::new("CIE 171 5.6");
    let (emitter, black) = lamp_and_black(&mut scene, 1.0);
    scene.add_quad(level([0.0, 4.0], [0.0, 4.0], 0.0, true), emitter, GroupId(0));
    scene.add_quad(wall(0.0, [0.0, 3.0], true), black, GroupId(0));
    scene.add_quad(level([0.0, 4.0], [0.0, 4.0], 3.0, false), black, GroupId(0));
    let floor = corners(&scene, 0);
    let on_wall = [0.75, 1.25, 1.75, 2.25, 2.75].map(|z| (format!("wall, z = {z}"), 1, [2.0, 0.0, z], DVec3::Y));
    let on_ceiling = [0.25, 0.75, 1.25, 1.75].map(|y| (format!("ceiling, y = {y}"), 2, [2.0, y, 3.0], DVec3::NEG_Z));
    let reading = |(label, polygon, at, normal): (String, u32, [f64; 3], DVec3)| {
        let at = DVec3::from(at);
        share(&label, polygon, at, closed_forms::point_to_polygon(at, normal, &floor))
    };
    let readings = on_wall.into_iter().chain(on_ceiling).map(reading).collect();
    Case { name: "CIE 171 5.6, reflecting floor", source: "Lambert", readings, scene }
}

/// CIE 171:2006, 5.7: light that the wall y = 4 reflects, behind a black box of 4 × 0.2 × 1 m (y
/// from 2.5 to 2.7), as shares of what leaves it; here the wall itself shines. The standard's own
/// Table 19 is wrong; truth is the part of the wall that is seen.
fn cie_5_7() -> Case {
    let mut scene = Scene::new("CIE 171 5.7");
    let (emitter, black) = lamp_and_black(&mut scene, 1.0);
    scene.add_quad(wall(4.0, [0.0, 3.0], false), emitter, GroupId(0));
    scene.add_quad(wall(0.0, [0.0, 3.0], true), black, GroupId(0));
    scene.add_quad(level([0.0, 4.0], [0.0, 4.0], 0.0, true), black, GroupId(0));
    scene.add_quad(wall(2.5, [0.0, 1.0], false), black, GroupId(0));
    scene.add_quad(wall(2.7, [0.0, 1.0], true), black, GroupId(0));
    scene.add_quad(level([0.0, 4.0], [2.5, 2.7], 1.0, true), black, GroupId(0));
    let on_wall = [2.75, 2.25, 1.75, 1.25, 0.75, 0.25].map(|z| (format!("wall, z = {z}"), 1, [2.0, 0.0, z], DVec3::Y));
    let on_floor = [0.25, 0.75, 1.25, 1.75, 2.25].map(|y| (format!("floor, y = {y}"), 2, [2.0, y, 0.0], DVec3::Z));
    let reading = |(label, polygon, at, normal): (String, u32, [f64; 3], DVec3)| {
        // The line over the box's top edge meets the wall there: over the far edge from above it,
        // the near one from below.
        let [_, y, z] = at;
        let edge = if z > 1.0 { 2.7 } else { 2.5 };
        let from = (z + (1.0 - z) * (4.0 - y) / (edge - y)).clamp(0.0, 3.0);
        let seen = [(0.0, from), (4.0, from), (4.0, 3.0), (0.0, 3.0)].map(|(x, z)| DVec3::new(x, 4.0, z));
        let at = DVec3::from(at);
        share(&label, polygon, at, closed_forms::point_to_polygon(at, normal, &seen))
    };
    let readings = on_wall.into_iter().chain(on_floor).map(reading).collect();
    Case { name: "CIE 171 5.7, box before a wall", source: "Lambert, part seen", readings, scene }
}

/// CIE 171:2006, 5.8: a cube of 4 m with a lamp of 10,000 lm; the mean illuminance of its six
/// faces, direct light included. One case of one cube for each reflectance would differ in a number
/// only: the cubes stand side by side and cannot see each other.
fn cie_5_8() -> Case {
    let mut scene = Scene::new("CIE 171 5.8");
    let side = 0.01;
    let (emitter, _) = lamp_and_black(&mut scene, 10_000.0 / (side * side));
    let mut readings = Vec::new();
    for (index, reflectance) in [0.1, 0.3, 0.5, 0.7, 0.8, 0.9, 0.95].into_iter().enumerate() {
        let wall = scene.add_material(&format!("ρ = {reflectance}"), Vec3::splat(reflectance as f32), Vec3::ZERO);
        let group = scene.add_group(&format!("cube_{index}"), GroupId(0));
        let aside = vec3(5.0 * index as f32, 0.0, 0.0);
        let first = scene.polygons.len();
        add_box(&mut scene, (aside, aside + 4.0), true, (wall, group));
        let square = [2.0 - 0.5 * side, 2.0 + 0.5 * side];
        scene.add_quad(level(square, square, 2.0, false).map(|corner| corner + aside), emitter, group);
        let truth = closed_forms::closed_room(10_000.0, 96.0, reflectance);
        let faces = (first as u32..first as u32 + 6).collect();
        let reading = Reading { unit: "lx", ..mean(&format!("ρ = {reflectance}"), faces, truth) };
        readings.push(in_closed_room(reading, reflectance));
    }
    Case { name: "CIE 171 5.8, closed cube", source: "Φ/(S(1−ρ))", readings, scene }
}

/// The mean over some polygons as a reading.
pub(crate) fn mean(label: &str, polygons: Vec<u32>, truth: f64) -> Reading {
    known(label, Place::Mean(polygons), truth)
}

/// A point of a polygon as a reading.
pub(crate) fn point(label: &str, polygon: u32, position: Vec3, truth: f64) -> Reading {
    known(label, Place::Point { polygon, position }, truth)
}

fn known(label: &str, place: Place, truth: f64) -> Reading {
    Reading { label: label.to_owned(), place, truth, allowance: 0.0, gain: 1.0, factor: 1.0, unit: "" }
}

fn in_closed_room(reading: Reading, reflectance: f64) -> Reading {
    Reading { gain: 1.0 / (1.0 - reflectance), ..reading }
}

/// A form factor in per cent.
fn share(label: &str, polygon: u32, at: DVec3, truth: f64) -> Reading {
    Reading { factor: 100.0, unit: "%", ..point(label, polygon, at.as_vec3(), 100.0 * truth) }
}

/// A lamp of this exitance, W/m², that reflects nothing, and a material that neither emits nor
/// reflects.
pub(crate) fn lamp_and_black(scene: &mut Scene, exitance: f64) -> (MaterialId, MaterialId) {
    let lamp = scene.add_material("lamp", Vec3::ZERO, Vec3::splat(exitance as f32));
    (lamp, scene.add_material("black", Vec3::ZERO, Vec3::ZERO))
}

/// Corners of a polygon.
pub(crate) fn corners(scene: &Scene, polygon: usize) -> Vec<DVec3> {
    let (corners, count) = scene.corner_positions(&scene.polygons[polygon]);
    corners[..count].iter().map(|corner| corner.as_dvec3()).collect()
}

/// A rectangle at height `z` that faces up or down.
pub(crate) fn level(x: Span, y: Span, z: f64, up: bool) -> [Vec3; 4] {
    let corners = [(x[0], y[0]), (x[1], y[0]), (x[1], y[1]), (x[0], y[1])];
    turned(corners.map(|(x, y)| vec3(x as f32, y as f32, z as f32)), up)
}

/// A rectangle at x = 0 that faces +x: z from ξ and y from η.
pub(crate) fn upright(xi: Span, eta: Span) -> [Vec3; 4] {
    [(eta[0], xi[0]), (eta[1], xi[0]), (eta[1], xi[1]), (eta[0], xi[1])].map(|(y, z)| vec3(0.0, y as f32, z as f32))
}

/// A wall from x = 0 to 4 at this y, which faces +y or −y.
fn wall(y: f64, z: Span, towards_y: bool) -> [Vec3; 4] {
    let corners = [(4.0, z[0]), (0.0, z[0]), (0.0, z[1]), (4.0, z[1])];
    turned(corners.map(|(x, z)| vec3(x, y as f32, z as f32)), towards_y)
}

fn turned(mut corners: [Vec3; 4], stays: bool) -> [Vec3; 4] {
    if !stays {
        corners.reverse();
    }
    corners
}

/// Faces of a room that [`add_box`] made.
const FLOOR: u32 = 2;
const CEILING: u32 = 5;

/// The triangles of a unit sphere, bright inside: an icosahedron, each face cut into four so many
/// times.
fn icosphere(cuts: u32) -> Vec<[Vec3; 3]> {
    let golden = 0.5 * (1.0 + 5.0_f32.sqrt());
    let axes = [(0, 1, 2), (1, 2, 0), (2, 0, 1)];
    let corners: Vec<Vec3> = axes
        .iter()
        .flat_map(|&(zero, one, long)| {
            [(-1.0, -golden), (-1.0, golden), (1.0, -golden), (1.0, golden)].map(|(short_value, long_value)| {
                let mut corner = Vec3::ZERO;
                (corner[zero], corner[one], corner[long]) = (0.0, short_value, long_value);
                corner.normalize()
            })
        })
        .collect();
    // The faces of an icosahedron are the triples of corners that are neighbours.
    let edge = corners.iter().skip(1).map(|corner| corner.distance(corners[0])).fold(f32::INFINITY, f32::min);
    let near = |a: usize, b: usize| corners[a].distance(corners[b]) < 1.1 * edge;
    let mut triangles = Vec::new();
    for a in 0..12 {
        for b in a + 1..12 {
            for c in b + 1..12 {
                if near(a, b) && near(b, c) && near(a, c) {
                    let [a, b, c] = [a, b, c].map(|index| corners[index]);
                    let inwards = (b - a).cross(c - a).dot(a) < 0.0;
                    triangles.push(if inwards { [a, b, c] } else { [a, c, b] });
                }
            }
        }
    }
    for _ in 0..cuts {
        let quarters = triangles.into_iter().flat_map(|[a, b, c]: [Vec3; 3]| {
            let [ab, bc, ca] = [(a, b), (b, c), (c, a)].map(|(from, to)| from.midpoint(to).normalize());
            [[a, ab, ca], [b, bc, ab], [c, ca, bc], [ab, bc, ca]]
        });
        triangles = quarters.collect();
    }
    triangles
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Truth: the values of CIE 171:2006 as recomputed and published, to their last digit; those of
    /// 5.7 are good to 0.3 %.
    #[test]
    fn the_cases_have_the_published_values() {
        let known: [(Case, &[f64], f64); 4] = [
            (cie_5_2(), &[111.11, 105.19, 90.00, 49.38], 0.0),
            (cie_5_3(), &[32.68, 75.19, 81.32, 69.06, 53.40, 40.00, 61.42, 79.26, 95.67, 105.78], 0.0),
            (cie_5_6(), &[35.901, 27.992, 21.639, 16.716, 12.967, 26.80, 30.94, 33.98, 35.57], 0.0),
            (cie_5_7(), &[16.07, 16.33, 15.41, 13.34, 10.33, 7.09, 3.39, 3.62, 3.02, 0.0, 0.0], 0.003),
        ];
        for (case, values, share) in known {
            let truths: Vec<f64> = case.readings.iter().map(|reading| reading.truth).collect();
            let is_near = |(truth, known): (&f64, &f64)| (truth - known).abs() < 0.006 + share * known;
            let agree = truths.len() == values.len() && truths.iter().zip(values).all(is_near);
            assert!(agree, "{}: {truths:.3?} instead of {values:?}", case.name);
        }
    }

    /// Truth: closed rooms are bright inside; the faces of a sphere are 20·4ⁿ.
    #[test]
    fn rooms_and_spheres_are_bright_inside() {
        for case in all() {
            for reading in &case.readings {
                if let Place::Point { polygon, position } = reading.place {
                    let of = &case.scene.polygons[polygon as usize];
                    let plane = (position - case.scene.corner_positions(of).0[0]).dot(case.scene.normal(of));
                    assert!(plane.abs() < 1e-5, "{}, {}: off its polygon", case.name, reading.label);
                }
            }
        }
        let sphere = sphere().scene;
        assert_eq!(sphere.polygons.len(), 320);
        assert!(sphere.polygons.iter().all(|face| sphere.normal(face).dot(sphere.corner_positions(face).0[0]) < 0.0));
        let cube = &cubes()[0].scene;
        let middle = Vec3::splat(0.5);
        assert!(
            cube.polygons.iter().all(|face| cube.normal(face).dot(middle - cube.corner_positions(face).0[0]) > 0.4)
        );
    }
}
