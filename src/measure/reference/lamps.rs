//! The faces that emit, as targets of next-event estimation.
//!
//! A point is picked on them by power, and power counts by what it could send to the place that is
//! lit: lamps are bundled into a few bundles of neighbours, each of which is weighed by its
//! distance and by its slope to that place. Without this a small bulb would hardly ever be picked
//! by what stands beside it.

use glam::{DVec3, Vec3};

use super::surfaces::corners_of;
use crate::scene::{Polygon, Scene};

/// Bundles at most: each costs some nanoseconds at every vertex of a path.
const BUNDLES: usize = 16;
/// Share of the picks that go by power alone: what a bundle could send is an estimate.
const BY_POWER: f32 = 0.1;

/// A point on a lamp.
pub struct LampPoint {
    pub polygon: u32,
    pub position: DVec3,
    /// Unit normal of the bright side.
    pub normal: DVec3,
    /// Emission B_e, W/m².
    pub emission: Vec3,
    /// Probability density, per area.
    pub density: f32,
}

/// The lamps of a scene; both sides of a doubled face are lamps of their own.
pub struct Lamps {
    /// Bundle by bundle.
    lamps: Vec<Lamp>,
    /// Power of all lamps up to and including each, W (largest colour).
    power_up_to: Vec<f64>,
    bundles: Vec<Bundle>,
    /// The bundle of each polygon that is a lamp.
    bundle_of: Vec<Option<u32>>,
}

struct Lamp {
    polygon: u32,
    corners: [DVec3; 4],
    count: usize,
    normal: DVec3,
    emission: Vec3,
    centre: Vec3,
    /// W, largest colour.
    power: f64,
}

/// Neighbouring lamps.
struct Bundle {
    /// Lamps of the bundle, `first..end`.
    first: usize,
    end: usize,
    centre: Vec3,
    /// Distance of the farthest corner from the centre.
    radius: f32,
    /// The normal, if all lamps have the same.
    normal: Option<Vec3>,
    /// Share of the power of all.
    power: f32,
}

/// With what probability each bundle is picked at one place.
pub struct Choice {
    probability: [f32; BUNDLES],
}

impl Lamps {
    /// The lamps; `None` where nothing emits.
    pub fn new(scene: &Scene) -> Option<Self> {
        let lamp = |(index, polygon): (usize, &Polygon)| {
            let emission = scene.surface(polygon).emission;
            let power = f64::from(scene.area(polygon)) * f64::from(emission.max_element());
            let (corners, count) = corners_of(scene, polygon);
            let centre = (corners[..count].iter().sum::<DVec3>() / count as f64).as_vec3();
            let normal = scene.normal(polygon).as_dvec3();
            (power > 0.0).then_some(Lamp { polygon: index as u32, corners, count, normal, emission, centre, power })
        };
        let mut lamps: Vec<Lamp> = scene.polygons.iter().enumerate().filter_map(lamp).collect();
        let total: f64 = lamps.iter().map(|lamp| lamp.power).sum();
        let mut bundles = vec![Bundle::new(&lamps, 0, lamps.len(), total)];
        while bundles.len() < BUNDLES {
            let widest = |(_, a): &(usize, &Bundle), (_, b): &(usize, &Bundle)| a.radius.total_cmp(&b.radius);
            let divisible = bundles.iter().enumerate().filter(|(_, bundle)| bundle.end > bundle.first + 1);
            let Some((index, bundle)) = divisible.max_by(widest) else { break };
            let (first, end) = (bundle.first, bundle.end);
            let middle = first + halve(&mut lamps[first..end]);
            bundles[index] = Bundle::new(&lamps, first, middle, total);
            bundles.push(Bundle::new(&lamps, middle, end, total));
        }
        let mut bundle_of = vec![None; scene.polygons.len()];
        for (index, bundle) in bundles.iter().enumerate() {
            for lamp in &lamps[bundle.first..bundle.end] {
                bundle_of[lamp.polygon as usize] = Some(index as u32);
            }
        }
        let mut sum = 0.0;
        let up_to = lamps.iter().map(|lamp| {
            sum += lamp.power;
            sum
        });
        let power_up_to = up_to.collect();
        (total > 0.0).then_some(Self { lamps, power_up_to, bundles, bundle_of })
    }

    /// The choice at a place that is lit.
    #[inline]
    pub fn choice(&self, place: Vec3, normal: Vec3) -> Choice {
        let mut probability = [0.0; BUNDLES];
        if let [_] = *self.bundles {
            probability[0] = 1.0;
            return Choice { probability };
        }
        let mut sum = 0.0;
        for (probability, bundle) in probability.iter_mut().zip(&self.bundles) {
            *probability = bundle.power * bundle.sent_to(place, normal);
            sum += *probability;
        }
        let (by_power, factor) = if sum > 0.0 { (BY_POWER, (1.0 - BY_POWER) / sum) } else { (1.0, 0.0) };
        for (probability, bundle) in probability.iter_mut().zip(&self.bundles) {
            *probability = by_power * bundle.power + factor * *probability;
        }
        Choice { probability }
    }

    /// The point that a choice and three numbers in 0..1 pick.
    #[inline]
    pub fn point(&self, choice: &Choice, pick: f32, u: f32, v: f32) -> LampPoint {
        let (mut index, mut rest) = (0, pick);
        while rest >= choice.probability[index] && index + 1 < self.bundles.len() {
            rest -= choice.probability[index];
            index += 1;
        }
        let bundle = &self.bundles[index];
        let within = f64::from((rest / choice.probability[index]).clamp(0.0, 1.0));
        let before = if bundle.first > 0 { self.power_up_to[bundle.first - 1] } else { 0.0 };
        let wanted = before + within * (self.power_up_to[bundle.end - 1] - before);
        let place = self.power_up_to[bundle.first..bundle.end - 1].partition_point(|up_to| *up_to <= wanted);
        let lamp = &self.lamps[bundle.first + place];
        let position = point_on(&lamp.corners[..lamp.count], u, v);
        let density = self.density_in(choice, index, lamp.emission);
        LampPoint { polygon: lamp.polygon, position, normal: lamp.normal, emission: lamp.emission, density }
    }

    /// Probability density of a point on a polygon with this emission, per area.
    #[inline]
    pub fn density(&self, choice: &Choice, polygon: u32, emission: Vec3) -> f32 {
        self.bundle_of[polygon as usize].map_or(0.0, |bundle| self.density_in(choice, bundle as usize, emission))
    }

    #[inline]
    fn density_in(&self, choice: &Choice, bundle: usize, emission: Vec3) -> f32 {
        let total = self.power_up_to[self.power_up_to.len() - 1] as f32;
        choice.probability[bundle] * emission.max_element() / (self.bundles[bundle].power * total)
    }
}

impl Bundle {
    fn new(lamps: &[Lamp], first: usize, end: usize, total: f64) -> Self {
        let bundled = &lamps[first..end];
        let corners =
            || bundled.iter().flat_map(|lamp| lamp.corners[..lamp.count].iter().map(|corner| corner.as_vec3()));
        let box_around = corners().fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(lower, upper), corner| {
            (lower.min(corner), upper.max(corner))
        });
        let centre = 0.5 * (box_around.0 + box_around.1);
        let radius = corners().map(|corner| corner.distance(centre)).fold(0.0, f32::max);
        let normal = bundled.first().map(|lamp| lamp.normal.as_vec3());
        let normal = normal.filter(|normal| bundled.iter().all(|lamp| lamp.normal.as_vec3().dot(*normal) > 0.999));
        let power = (bundled.iter().map(|lamp| lamp.power).sum::<f64>() / total) as f32;
        Self { first, end, centre, radius, normal, power }
    }

    /// About how much of its power reaches a place, up to a factor.
    #[inline]
    fn sent_to(&self, place: Vec3, normal: Vec3) -> f32 {
        let span = self.centre - place;
        let distance_squared = span.length_squared() + self.radius * self.radius;
        if distance_squared <= 0.0 {
            return 0.0;
        }
        // A part of it may rise above a horizon that the centre is below.
        let cosine = |height: f32| ((height + self.radius) / distance_squared.sqrt()).clamp(0.0, 1.0);
        let slope = self.normal.map_or(0.5, |normal| cosine(-span.dot(normal)));
        cosine(span.dot(normal)) * slope / distance_squared
    }
}

/// Sorts lamps along the longest side of their box and returns how many lie in its first half, at
/// least one on either side.
fn halve(lamps: &mut [Lamp]) -> usize {
    let bounds = lamps.iter().fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(lower, upper), lamp| {
        (lower.min(lamp.centre), upper.max(lamp.centre))
    });
    let extent = bounds.1 - bounds.0;
    let axis = (0..3).max_by(|a, b| extent[*a].total_cmp(&extent[*b])).unwrap_or(0);
    lamps.sort_by(|a, b| a.centre[axis].total_cmp(&b.centre[axis]));
    let middle = 0.5 * (bounds.0[axis] + bounds.1[axis]);
    lamps.partition_point(|lamp| lamp.centre[axis] < middle).clamp(1, lamps.len() - 1)
}

/// A point on a polygon, uniform by area; a quad is the two triangles that rays meet.
pub fn point_on_polygon(scene: &Scene, polygon: &Polygon, u: f32, v: f32) -> Vec3 {
    let (corners, count) = corners_of(scene, polygon);
    point_on(&corners[..count], u, v).as_vec3()
}

fn point_on(corners: &[DVec3], u: f32, v: f32) -> DVec3 {
    let (u, v) = (f64::from(u), f64::from(v));
    match *corners {
        [a, b, c, d] if is_parallelogram([a, b, c, d]) => a + u * (b - a) + v * (d - a),
        [a, b, c, d] => {
            let (first, second) = ((b - a).cross(c - a).length(), (c - a).cross(d - a).length());
            let share = if first + second > 0.0 { first / (first + second) } else { 1.0 };
            if u < share {
                point_on_triangle([a, b, c], u / share, v)
            } else {
                point_on_triangle([a, c, d], (u - share) / (1.0 - share), v)
            }
        }
        [a, b, c] => point_on_triangle([a, b, c], u, v),
        _ => unreachable!("a polygon has three or four corners"),
    }
}

/// Such a quad keeps the evenness of the unit square. Its corners are rounded to single precision.
fn is_parallelogram([a, b, c, d]: [DVec3; 4]) -> bool {
    let largest = [a, b, c, d].map(|corner| corner.abs().max_element()).into_iter().fold(0.0, f64::max);
    ((b - a) - (c - d)).abs().max_element() <= 2.0 * f64::from(f32::EPSILON) * largest
}

fn point_on_triangle([a, b, c]: [DVec3; 3], u: f64, v: f64) -> DVec3 {
    let root = u.sqrt();
    a + root * ((1.0 - v) * (b - a) + v * (c - a))
}
