//! Where irradiance is wanted: points on the bright sides of a scene.

use glam::Vec3;

use super::glow::glow;
use super::lamps::point_on_polygon;
use super::sequence::hash64;
use crate::scene::Scene;

/// Keeps the places of points apart from the paths of the same seed.
const SALT: u64 = 0x706f_696e_7473;

/// Steps of the points that follow one another on a polygon: the two-dimensional sequence of the
/// plastic number, 1.3247 \[M. Roberts, *The unreasonable effectiveness of quasirandom sequences*,
/// 2018\].
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
    /// Weight of the point where points are summed up: the area that it stands for, as a share of
    /// what it would be among as many points spread evenly by area.
    pub weight: f32,
}

impl SurfacePoint {
    /// A point of a polygon, given by its position; normal and reflectance are the polygon's, and
    /// it counts once.
    pub fn on(scene: &Scene, polygon: u32, position: Vec3) -> Self {
        let of = &scene.polygons[polygon as usize];
        let reflectance = scene.surface(of).reflectance;
        Self { position, normal: scene.normal(of), polygon, reflectance, weight: 1.0 }
    }
}

/// So many random points on all bright sides but the lamps', those that no light reaches included.
///
/// Half of them lie evenly by area, half by A·|B|² as far as a few paths tell it: a small bright
/// place may hold most of what an RMS is about, and by area alone hardly a point would meet it.
/// [`SurfacePoint::weight`] makes up for that.
///
/// All polygons, one after the other, are cut into as many parts of equal chance, and each part
/// holds one point; points of one polygon are spread evenly over it.
pub fn random_points(scene: &Scene, count: usize, seed: u64) -> Vec<SurfacePoint> {
    let is_lamp = |index: usize| scene.emits(&scene.polygons[index]);
    let polygons: Vec<u32> = (0..scene.polygons.len()).filter(|index| !is_lamp(*index)).map(|i| i as u32).collect();
    let areas = areas(scene, &polygons);
    let chances = halves(&areas, &glow(scene, &polygons, &areas, seed));
    points_by(scene, &polygons, (&areas, &chances), count, seed)
}

/// So many random points on these polygons, evenly by area.
pub fn random_points_on(scene: &Scene, polygons: &[u32], count: usize, seed: u64) -> Vec<SurfacePoint> {
    let areas = areas(scene, polygons);
    points_by(scene, polygons, (&areas, &areas), count, seed)
}

pub(super) fn areas(scene: &Scene, polygons: &[u32]) -> Vec<f64> {
    polygons.iter().map(|polygon| f64::from(scene.area(&scene.polygons[*polygon as usize]))).collect()
}

/// Half of each, as shares of their sums; all of the first where there is nothing of the second.
pub(super) fn halves(one: &[f64], other: &[f64]) -> Vec<f64> {
    let [of_one, of_other] = [one, other].map(|values| values.iter().sum::<f64>());
    if of_other > 0.0 {
        one.iter().zip(other).map(|(one, other)| 0.5 * (one / of_one + other / of_other)).collect()
    } else {
        one.to_vec()
    }
}

/// So many random points on these polygons, of known areas, by their chances of a point.
pub(super) fn points_by(
    scene: &Scene,
    polygons: &[u32],
    (areas, chances): (&[f64], &[f64]),
    count: usize,
    seed: u64,
) -> Vec<SurfacePoint> {
    let mut sum = 0.0;
    let up_to = chances.iter().map(|chance| {
        sum += chance;
        sum
    });
    let up_to: Vec<f64> = up_to.collect();
    let area: f64 = areas.iter().sum();
    if sum <= 0.0 || area <= 0.0 {
        return Vec::new();
    }
    let random = |number: u64| (hash64(seed ^ SALT, number) >> 11) as f64 / (1_u64 << 53) as f64;
    // Two numbers shift the whole sequence, so that each point alone is uniform on its polygon.
    let shift = [random(0), random(1)];
    let point = |index: usize| {
        let wanted = (index as f64 + random(index as u64 + 2)) / count as f64 * sum;
        let place = up_to.partition_point(|chance| *chance <= wanted).min(polygons.len() - 1);
        let polygon = polygons[place];
        let [u, v] = [0, 1].map(|axis| (shift[axis] + index as f64 * STEPS[axis]).fract() as f32);
        let position = point_on_polygon(scene, &scene.polygons[polygon as usize], u, v);
        let weight = (areas[place] / area / (chances[place] / sum)) as f32;
        SurfacePoint { weight, ..SurfacePoint::on(scene, polygon, position) }
    };
    (0..count).map(point).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{GroupId, MaterialId};

    fn square(scene: &mut Scene, corner: Vec3, (along, across): (Vec3, Vec3), material: MaterialId) {
        let corners = [corner, corner + along, corner + along + across, corner + across];
        scene.add_quad(corners, material, GroupId(0));
    }

    /// Truth: shares of area, exact to one point, and no point on a lamp, where no light arrives.
    #[test]
    fn points_are_spread_by_area_and_leave_lamps_out() {
        let mut scene = Scene::new("three squares");
        let wall = scene.add_material("wall", Vec3::splat(0.5), Vec3::ZERO);
        let lamp = scene.add_material("lamp", Vec3::splat(0.5), Vec3::X);
        for (size, aside, material) in [(1.0, 20.0, wall), (5.0, 10.0, lamp), (3.0, 0.0, wall)] {
            square(&mut scene, Vec3::new(aside, 0.0, 2.0), (size * Vec3::X, size * Vec3::Y), material);
        }
        let points = random_points(&scene, 1000, 1);
        let on = |polygon: u32| points.iter().filter(|point| point.polygon == polygon).count();
        assert_eq!((on(0), on(1), on(2)), (100, 0, 900));
        let is_plain = |point: &SurfacePoint| (point.normal, point.reflectance) == (Vec3::Z, Vec3::splat(0.5));
        assert!(points.iter().all(|point| is_plain(point) && (point.weight - 1.0).abs() < 1e-6));
        let mean = points[100..].iter().map(|point| point.position).sum::<Vec3>() / 900.0;
        assert!(mean.distance(Vec3::new(1.5, 1.5, 2.0)) < 0.02, "{mean}");
        assert_ne!(points, random_points(&scene, 1000, 2));
    }

    /// Truth: two floors far apart, of 1 and 99 m², each below a lamp as large; the small one's
    /// shines ten times as brightly, and holds half of A·|B|² and more, for near all of what a lamp
    /// sends to a floor much wider than the room is high arrives there. So it gets a good quarter
    /// of all points, which count as much as a hundredth of them.
    #[test]
    fn small_bright_places_are_met_and_do_not_count_more() {
        let mut scene = Scene::new("two floors");
        let floor = scene.add_material("floor", Vec3::splat(0.5), Vec3::ZERO);
        let sizes = [(1.0, 10.0_f32), (99.0_f32.sqrt(), 1.0)];
        for (index, (size, exitance)) in sizes.into_iter().enumerate() {
            let lamp = scene.add_material("lamp", Vec3::ZERO, Vec3::splat(exitance));
            let corner = Vec3::new(0.0, 20.0 * index as f32, 0.0);
            square(&mut scene, corner, (size * Vec3::X, size * Vec3::Y), floor);
            square(&mut scene, corner + 0.01 * size * Vec3::Z, (size * Vec3::Y, size * Vec3::X), lamp);
        }
        let points = random_points(&scene, 1000, 1);
        let small: Vec<&SurfacePoint> = points.iter().filter(|point| point.polygon == 0).collect();
        assert!((220..300).contains(&small.len()), "{}", small.len());
        let sum = |points: &[&SurfacePoint]| points.iter().map(|point| point.weight).sum::<f32>();
        let (of_small, all) = (sum(&small), sum(&points.iter().collect::<Vec<_>>()));
        assert!((of_small - 10.0).abs() < 0.2 && (all - 1000.0).abs() < 2.0, "{of_small} of {all}");
    }
}
