//! Irradiance in our own scenes as another program finds it: Mitsuba 3.9, a path tracer;
//! `tests/accuracy/mitsuba/README.md` tells how.

use glam::{DVec3, Vec3};
use selflink::measure::reference::SurfacePoint;
use selflink::scene::Scene;

/// Mitsuba's light at one point.
#[derive(Clone, Copy, Debug)]
pub struct Known {
    /// Position, m.
    pub position: Vec3,
    /// Unit normal of the side that is lit.
    pub normal: Vec3,
    /// Irradiance E, W/m².
    pub irradiance: DVec3,
    /// Standard error of E, W/m².
    pub standard_error: DVec3,
}

/// All points of `cornell`, `seminar` or `office`.
pub fn known(scene: &str) -> Vec<Known> {
    let text = match scene {
        "cornell" => include_str!("../accuracy/mitsuba/cornell.csv"),
        "seminar" => include_str!("../accuracy/mitsuba/seminar.csv"),
        "office" => include_str!("../accuracy/mitsuba/office.csv"),
        _ => panic!("there are no figures of {scene}"),
    };
    text.lines().skip(1).map(row).collect()
}

fn row(line: &str) -> Known {
    let numbers: Vec<f64> = line.split(',').map(|field| field.parse().expect("a number")).collect();
    let three = |first: usize| DVec3::from_slice(&numbers[first..first + 3]);
    assert_eq!(numbers.len(), 12, "{line}");
    let normal = three(3).as_vec3().normalize();
    Known { position: three(0).as_vec3(), normal, irradiance: three(6), standard_error: three(9) }
}

/// The point on the scene's own polygon.
pub fn on_scene(scene: &Scene, known: &Known) -> SurfacePoint {
    let away = |polygon: u32| {
        let of = &scene.polygons[polygon as usize];
        let normal = scene.normal(of);
        if normal.dot(known.normal) < 0.999 {
            return f32::INFINITY;
        }
        let (corners, count) = scene.corner_positions(of);
        let outside = (0..count).map(|side| {
            let (from, to) = (corners[side], corners[(side + 1) % count]);
            (to - from).cross(normal).normalize_or_zero().dot(known.position - from)
        });
        outside.fold(normal.dot(known.position - corners[0]).abs(), f32::max)
    };
    let nearest = (0..scene.polygons.len() as u32).min_by(|a, b| away(*a).total_cmp(&away(*b)));
    let polygon = nearest.expect("a scene has polygons");
    assert!(away(polygon) < 1e-5, "{known:?} lies {} m off its face", away(polygon));
    SurfacePoint::on(scene, polygon, known.position)
}
