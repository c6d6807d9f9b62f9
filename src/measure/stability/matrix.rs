//! A brute-force solution to compare with: every polygon cut into equal parts, all form factors in
//! one matrix, all light by iteration.
//!
//! Form factors are means over points of the receiver of the exact form factor to the source times
//! the share of it that is seen, weighted by the kernel. Nothing of the solver is used but its
//! occluders' rays.

use glam::{DVec3, Vec3};

use crate::base::random::{hash64, r2_sequence};
use crate::geometry::Occluders;
use crate::geometry::quarter;
use crate::measure::accuracy::closed_forms::point_to_polygon;
use crate::scene::Scene;

/// How finely a scene is looked at.
#[derive(Clone, Copy, Debug)]
pub struct Fineness {
    /// Polygons are cut into four until their parts have no more area than this, m².
    pub largest_part: f64,
    /// Points of each part that receive.
    pub points: u32,
    /// Points of a part that each of these looks at.
    pub looks: u32,
}

/// Light is followed until less than this share of it moves.
const LEAST_CHANGE: f64 = 1e-9;

/// A part of a polygon.
struct Part {
    polygon: usize,
    corners: [Vec3; 4],
    count: usize,
    normal: Vec3,
    area: f64,
}

impl Part {
    fn corners(&self) -> &[Vec3] {
        &self.corners[..self.count]
    }

    fn point(&self, [u, v]: [f32; 2]) -> Vec3 {
        let [a, b, c, d] = self.corners;
        if self.count == 4 {
            return a.lerp(b, u).lerp(d.lerp(c, u), v);
        }
        let root = u.sqrt();
        a + root * ((1.0 - v) * (b - a) + v * (c - a))
    }
}

/// Mean radiosity (all colours) of each polygon of a scene, W/m².
pub fn radiosities(scene: &Scene, occluders: &Occluders, fineness: Fineness) -> Vec<DVec3> {
    let parts = parts(scene, fineness.largest_part);
    let surface = |part: &Part| scene.surface(&scene.polygons[part.polygon]);
    let rows: Vec<Vec<f64>> = parts.iter().map(|part| row(part, &parts, occluders, fineness)).collect();
    let emitted: Vec<DVec3> = parts.iter().map(|part| surface(part).emission.as_dvec3()).collect();
    let reflectances: Vec<DVec3> = parts.iter().map(|part| surface(part).reflectance.as_dvec3()).collect();
    let mut radiosity = emitted.clone();
    loop {
        // Gauss and Seidel: each part takes what the others have by now.
        let (mut moved, mut largest) = (0.0_f64, 0.0_f64);
        for (index, row) in rows.iter().enumerate() {
            let irradiance: DVec3 = row.iter().zip(&radiosity).map(|(factor, radiosity)| *factor * *radiosity).sum();
            let new = emitted[index] + reflectances[index] * irradiance;
            moved = moved.max((new - radiosity[index]).abs().max_element());
            largest = largest.max(new.max_element());
            radiosity[index] = new;
        }
        if moved <= LEAST_CHANGE * largest {
            break;
        }
    }
    let mut sums = vec![(0.0, DVec3::ZERO); scene.polygons.len()];
    for (part, radiosity) in parts.iter().zip(radiosity) {
        let sum = &mut sums[part.polygon];
        *sum = (sum.0 + part.area, sum.1 + part.area * radiosity);
    }
    sums.into_iter().map(|(area, power)| if area > 0.0 { power / area } else { DVec3::ZERO }).collect()
}

fn parts(scene: &Scene, largest_part: f64) -> Vec<Part> {
    let mut parts = Vec::new();
    for (index, polygon) in scene.polygons.iter().enumerate() {
        let (corners, count) = scene.corner_positions(polygon);
        let mut pieces = vec![corners];
        let area = f64::from(scene.area(polygon));
        while area > largest_part * pieces.len() as f64 {
            let cut = |piece: &[Vec3; 4]| [0, 1, 2, 3].map(|number| quarter(*piece, count, number));
            pieces = pieces.iter().flat_map(cut).collect();
        }
        let (normal, share) = (scene.normal(polygon), area / pieces.len() as f64);
        parts.extend(pieces.into_iter().map(|corners| Part { polygon: index, corners, count, normal, area: share }));
    }
    parts
}

/// Form factors from one part to all, seen parts only.
fn row(to: &Part, parts: &[Part], occluders: &Occluders, fineness: Fineness) -> Vec<f64> {
    let factor = |from: &Part| {
        if from.polygon == to.polygon || from.area <= 0.0 || to.area <= 0.0 {
            return 0.0;
        }
        let at = |index: u32| {
            let point = to.point(r2_sequence(hash64(7, 1), index));
            let places = (0..fineness.looks).map(|look| from.point(r2_sequence(hash64(11, u64::from(index)), look)));
            of_point((point, to.normal), from, occluders, places)
        };
        (0..fineness.points).map(at).sum::<f64>() / f64::from(fineness.points)
    };
    parts.iter().map(factor).collect()
}

/// Form factor from a point to a part, of what is seen of it from there at some places.
fn of_point(
    (point, normal): (Vec3, Vec3),
    from: &Part,
    occluders: &Occluders,
    places: impl Iterator<Item = Vec3>,
) -> f64 {
    if from.normal.dot(point - from.corners[0]) <= 0.0 {
        return 0.0;
    }
    let corners = [0, 1, 2, 3].map(|corner| from.corners[corner].as_dvec3());
    let whole = point_to_polygon(point.as_dvec3(), normal.as_dvec3(), &corners[..from.corners().len()]);
    if whole <= 0.0 {
        return 0.0;
    }
    let (mut all, mut seen) = (0.0, 0.0);
    for at in places {
        let span = at - point;
        let heights = normal.dot(span).max(0.0) * (-from.normal.dot(span)).max(0.0);
        let kernel = f64::from(heights) / f64::from(span.length_squared()).powi(2).max(f64::MIN_POSITIVE);
        all += kernel;
        seen += if kernel > 0.0 && occluders.sees((point, normal), (at, from.normal)) { kernel } else { 0.0 };
    }
    if all > 0.0 { whole * seen / all } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::super::scenes::empty_room;
    use super::*;

    /// Truth: the furnace. 16 points of each part at the common edges are good to 1 %.
    #[test]
    fn a_furnace_glows_evenly() {
        let scene = empty_room(0.5, 1.0);
        for radiosity in
            radiosities(&scene, &Occluders::new(&scene), Fineness { largest_part: 0.25, points: 16, looks: 1 })
        {
            assert!((radiosity - 2.0).abs().max_element() < 0.02, "{radiosity}");
        }
    }
}
