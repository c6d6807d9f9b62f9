//! Where irradiance is wanted: points on the bright sides of a scene.

use glam::Vec3;
use rayon::prelude::*;

use super::lamps::point_on_polygon;
use super::sequence::mix;
use crate::exposure::Darkness;
use crate::scene::Scene;
use crate::visibility::Occluders;

/// Keeps the places of points apart from the paths of the same seed.
const SALT: u64 = 0x706f_696e_7473;

/// Rays that must all meet backs before a point is left out: one that sees a tenth of the room is so once in a thousand times.
const RAYS: u32 = 64;
/// A scene of which next to everything is hidden gets fewer points.
const MOST_ROUNDS: u64 = 16;

/// Steps of the points that follow one another on a polygon: the two-dimensional sequence of the plastic number, 1.3247
/// \[M. Roberts, *The unreasonable effectiveness of quasirandom sequences*, 2018\].
const STEPS: [f64; 2] = [0.754_877_666_246_692_7, 0.569_840_290_998_053_2];

/// A point on the bright side of a polygon.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfacePoint {
    /// Position, in the scene's length unit.
    pub position: Vec3,
    /// Unit normal of the bright side.
    pub normal: Vec3,
    /// Index into [`Scene::polygons`].
    pub polygon: u32,
    /// Reflectance ρ there, which makes a radiosity of an irradiance.
    pub reflectance: Vec3,
}

impl SurfacePoint {
    /// A point of a polygon, given by its position; normal and reflectance are the polygon's.
    pub fn on(scene: &Scene, polygon: u32, position: Vec3) -> Self {
        let of = &scene.polygons[polygon as usize];
        let reflectance = scene.materials[of.material.0 as usize].reflectance;
        Self { position, normal: scene.normal(of), polygon, reflectance }
    }
}

/// So many random points on all bright sides but the lamps' and what is hidden inside of things, evenly by area: each stands for
/// the same area, and light can reach each ([`Darkness`]).
///
/// The area of all sides, one after the other, is cut into as many equal parts, and each part holds one point; points of one
/// polygon are spread evenly over it. Where hidden points are left out, others come from another such round.
pub fn random_points(scene: &Scene, occluders: &Occluders, count: usize, seed: u64) -> Vec<SurfacePoint> {
    let is_lamp = |index: usize| {
        let material = scene.polygons[index].material;
        scene.materials[material.0 as usize].emission.max_element() > 0.0
    };
    let polygons: Vec<u32> = (0..scene.polygons.len()).filter(|index| !is_lamp(*index)).map(|i| i as u32).collect();
    if scene.polygons.iter().any(|polygon| polygon.is_back) {
        // Both sides of faces are bright: nothing lies behind a back.
        return random_points_on(scene, &polygons, count, seed);
    }
    let darkness = Darkness::new(scene, occluders);
    let mut points = Vec::with_capacity(count);
    for round in 0..MOST_ROUNDS {
        let drawn = random_points_on(scene, &polygons, count - points.len(), mix(seed, round));
        let is_exposed = |(index, point): (usize, &SurfacePoint)| {
            !darkness.encloses(point.position, point.normal, mix(seed ^ SALT, index as u64), RAYS)
        };
        let exposed: Vec<bool> = drawn.par_iter().enumerate().map(is_exposed).collect();
        points.extend(drawn.into_iter().zip(exposed).filter_map(|(point, is_exposed)| is_exposed.then_some(point)));
        if points.len() == count {
            break;
        }
    }
    points
}

/// So many random points on these polygons, evenly by area.
pub fn random_points_on(scene: &Scene, polygons: &[u32], count: usize, seed: u64) -> Vec<SurfacePoint> {
    let mut sum = 0.0;
    let up_to = polygons.iter().map(|polygon| {
        sum += f64::from(scene.area(&scene.polygons[*polygon as usize]));
        sum
    });
    let up_to: Vec<f64> = up_to.collect();
    if sum <= 0.0 {
        return Vec::new();
    }
    let random = |number: u64| (mix(seed ^ SALT, number) >> 11) as f64 / (1_u64 << 53) as f64;
    // Two numbers shift the whole sequence, so that each point alone is uniform on its polygon.
    let shift = [random(0), random(1)];
    let point = |index: usize| {
        let wanted = (index as f64 + random(index as u64 + 2)) / count as f64 * sum;
        let place = up_to.partition_point(|area| *area <= wanted).min(polygons.len() - 1);
        let polygon = polygons[place];
        let [u, v] = [0, 1].map(|axis| (shift[axis] + index as f64 * STEPS[axis]).fract() as f32);
        let position = point_on_polygon(scene, &scene.polygons[polygon as usize], u, v);
        SurfacePoint::on(scene, polygon, position)
    };
    (0..count).map(point).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::GroupId;

    /// Truth: shares of area, exact to one point, and no point on a lamp.
    #[test]
    fn points_are_spread_by_area_and_leave_lamps_out() {
        let mut scene = Scene::new("three squares");
        let wall = scene.add_material("wall", Vec3::splat(0.5), Vec3::ZERO);
        let lamp = scene.add_material("lamp", Vec3::splat(0.5), Vec3::X);
        for (size, aside, material) in [(1.0, 20.0, wall), (5.0, 10.0, lamp), (3.0, 0.0, wall)] {
            let corner = |x: f32, y: f32| Vec3::new(aside + size * x, size * y, 2.0);
            scene.add_quad([corner(0., 0.), corner(1., 0.), corner(1., 1.), corner(0., 1.)], material, GroupId(0));
        }
        let occluders = Occluders::new(&scene);
        let points = random_points(&scene, &occluders, 1000, 1);
        let on = |polygon: u32| points.iter().filter(|point| point.polygon == polygon).count();
        assert_eq!((on(0), on(1), on(2)), (100, 0, 900));
        assert!(points.iter().all(|point| point.normal == Vec3::Z && point.reflectance == Vec3::splat(0.5)));
        let mean = points[100..].iter().map(|point| point.position).sum::<Vec3>() / 900.0;
        assert!(mean.distance(Vec3::new(1.5, 1.5, 2.0)) < 0.02, "{mean}");
        assert_ne!(points, random_points(&scene, &occluders, 1000, 2));
    }
}
