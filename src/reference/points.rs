//! Where irradiance is wanted: points on the bright sides of a scene.

use glam::Vec3;

use super::lamps::point_on_polygon;
use super::sequence::mix;
use crate::scene::Scene;

/// Keeps the places of points apart from the paths of the same seed.
const SALT: u64 = 0x706f_696e_7473;

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

/// So many random points on all bright sides but the lamps', evenly by area: each stands for the same area.
///
/// The area of all sides, one after the other, is cut into as many equal parts, and each part holds one point.
pub fn random_points(scene: &Scene, count: usize, seed: u64) -> Vec<SurfacePoint> {
    let is_lamp = |index: usize| {
        let material = scene.polygons[index].material;
        scene.materials[material.0 as usize].emission.max_element() > 0.0
    };
    let polygons: Vec<u32> = (0..scene.polygons.len()).filter(|index| !is_lamp(*index)).map(|i| i as u32).collect();
    random_points_on(scene, &polygons, count, seed)
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
    let point = |index: usize| {
        let number = |axis: u64| (mix(mix(seed ^ SALT, index as u64), axis) >> 40) as f32 / 16_777_216.0;
        let wanted = (index as f64 + f64::from(number(0))) / count as f64 * sum;
        let place = up_to.partition_point(|area| *area <= wanted).min(polygons.len() - 1);
        let polygon = polygons[place];
        let position = point_on_polygon(scene, &scene.polygons[polygon as usize], number(1), number(2));
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
        for (size, z, material) in [(1.0, 0.0, wall), (5.0, 1.0, lamp), (3.0, 2.0, wall)] {
            let corner = |x: f32, y: f32| Vec3::new(size * x, size * y, z);
            scene.add_quad([corner(0., 0.), corner(1., 0.), corner(1., 1.), corner(0., 1.)], material, GroupId(0));
        }
        let points = random_points(&scene, 1000, 1);
        let on = |polygon: u32| points.iter().filter(|point| point.polygon == polygon).count();
        assert_eq!((on(0), on(1), on(2)), (100, 0, 900));
        assert!(points.iter().all(|point| point.normal == Vec3::Z && point.reflectance == Vec3::splat(0.5)));
        let mean = points[100..].iter().map(|point| point.position).sum::<Vec3>() / 900.0;
        assert!(mean.distance(Vec3::new(1.5, 1.5, 2.0)) < 4.0 * 0.87 * 1.5 / 30.0, "{mean}");
        assert_ne!(points, random_points(&scene, 1000, 2));
    }
}
