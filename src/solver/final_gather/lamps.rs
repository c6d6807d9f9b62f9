//! Direct light at a point: lamps by their exact form factors, seen by rays that are shared out by what each lamp could send.
//!
//! What shines like a lamp is one: the inside of a lamp's shade reflects more than all the room does, out of a corner that random
//! rays hardly meet. From afar such surfaces count by all that they send, and random rays that meet them find nothing more; to what is near
//! enough for random rays to meet them often they are surfaces like others.

use std::f32::consts::PI;

use glam::Vec3;
use rustc_hash::FxHashMap;

use super::super::form_factor::point_to_polygon;
use crate::geometry::Occluders;
use crate::geometry::quarter;
use crate::hierarchy::{ElementId, Hierarchy, PatchSums, Shape, SurfacePoint, point_on_polygon};
use crate::random::{even_point, fraction, mix};

/// A cluster of lamps this small, as a share of its distance, is one lamp: a ray to a random point of it tells as much as a ray to one
/// of its members.
const SMALL: f32 = 0.1;

/// A patch of a larger radius than this share of its distance is near.
const NEAR: f32 = 0.7;
/// It is cut into quarters so many times at most.
const MOST_CUTS: u32 = 4;

/// What the lamps of a scene send.
pub struct Sent {
    /// Radiosity of each polygon that is a lamp, zero for the others, W/m².
    pub radiosity: Vec<Vec3>,
    /// Power of the initial patches, W (largest colour).
    powers: PatchSums,
    /// Polygons whose radiosity holds what they reflect as well.
    reflecting: FxHashMap<u32, Reflecting>,
}

/// A polygon that reflects so much that it is a lamp from afar.
#[derive(Clone, Debug)]
pub struct Reflecting {
    /// Its middle.
    pub centre: Vec3,
    /// What is nearer than this receives its reflected light by random rays, in the scene's length unit.
    pub reach: f32,
    /// What it emits, W/m².
    pub emission: Vec3,
    /// What it reflects at places on it, W/m².
    pub places: Vec<(Vec3, Vec3)>,
}

impl Reflecting {
    /// What it reflects at a point of it, W/m²: between the places, by inverse distances \[D. Shepard, *A two-dimensional interpolation
    /// function for irregularly-spaced data*, ACM 1968\].
    fn at(&self, point: Vec3) -> Vec3 {
        let (mut sum, mut weights) = (Vec3::ZERO, 0.0);
        for (place, reflected) in &self.places {
            let square = place.distance_squared(point).max(f32::MIN_POSITIVE);
            let weight = 1.0 / (square * square);
            (sum, weights) = (sum + weight * *reflected, weights + weight);
        }
        sum / weights
    }
}

impl Sent {
    /// By the radiosity that each polygon sends as a lamp, and by those that reflect some of it.
    pub fn new(hierarchy: &Hierarchy, radiosity: Vec<Vec3>, reflecting: FxHashMap<u32, Reflecting>) -> Self {
        let power = |&id: &ElementId| {
            let element = hierarchy.element(id);
            let Shape::Patch(patch) = element.shape else { return 0.0 };
            f64::from(element.sampled_area * radiosity[patch.polygon as usize].max_element())
        };
        let powers = PatchSums::new(hierarchy.initial_patches().iter().map(power));
        Self { radiosity, powers, reflecting }
    }

    /// Whether a point receives by rays to lamps what this polygon reflects, and not by random rays.
    pub fn is_reflected_to(&self, polygon: u32, point: Vec3) -> bool {
        self.reflecting.get(&polygon).is_some_and(|of| of.centre.distance_squared(point) >= of.reach * of.reach)
    }

    /// Mean radiosity of a polygon that a point receives by rays to lamps, W/m².
    fn towards(&self, polygon: u32, point: Vec3) -> Vec3 {
        match self.reflecting.get(&polygon) {
            Some(of) if !self.is_reflected_to(polygon, point) => of.emission,
            _ => self.radiosity[polygon as usize],
        }
    }

    /// The radiosity that leaves a place of a polygon for a point, W/m².
    fn from(&self, polygon: u32, place: Vec3, point: Vec3) -> Vec3 {
        match self.reflecting.get(&polygon) {
            Some(of) if self.is_reflected_to(polygon, point) => of.emission + of.at(place),
            Some(of) => of.emission,
            None => self.radiosity[polygon as usize],
        }
    }

    /// Power of a cluster's lamps, W (largest colour).
    fn power(&self, hierarchy: &Hierarchy, cluster: ElementId) -> f32 {
        self.powers.of(hierarchy, cluster) as f32
    }
}

/// All that shines.
#[derive(Clone, Copy)]
pub struct Lamps<'a> {
    /// Elements.
    pub hierarchy: &'a Hierarchy,
    /// What the lamps send.
    pub sent: &'a Sent,
    /// What stops light.
    pub occluders: &'a Occluders,
}

/// Light at a point and what it cost.
#[derive(Clone, Copy, Debug, Default)]
pub struct Lit {
    /// Irradiance, W/m².
    pub irradiance: Vec3,
    /// Rays cast.
    pub rays: u32,
}

/// A lamp, or a small cluster of them, as a point sees it.
#[derive(Clone, Copy, Debug)]
pub struct Seen {
    lamp: Lamp,
    /// What it could send, W/m² (largest colour).
    most: f32,
}

#[derive(Clone, Copy, Debug)]
enum Lamp {
    Cluster(ElementId),
    /// A patch, or a part of one that is near.
    Part {
        polygon: u32,
        corners: [Vec3; 4],
        count: usize,
        normal: Vec3,
        form_factor: f32,
    },
}

/// What the rays to a lamp found.
#[derive(Clone, Copy, Debug, Default)]
struct Found {
    /// Points of the lamp tried, and rays cast to those that face the point.
    points: u32,
    rays: u32,
    /// Sums of kernels: of all rays, and of those that came through.
    all: f32,
    visible: f32,
    /// Sum of kernel and radiosity where they came through; of a cluster, over the density of the points on it.
    light: Vec3,
}

impl Seen {
    fn new(lamp: Lamp, most: f32) -> Self {
        Self { lamp, most }
    }
}

/// Most rays to all lamps, as a multiple of those that a point gets first.
const MOST_AGAIN: f32 = 16.0;

impl Lamps<'_> {
    /// Irradiance that lamps send to a point, by about so many rays, and by more where what they find leaves it more doubtful than
    /// `doubt` (standard deviation, W/m²); `cut` is room to work in.
    pub fn irradiance(&self, point: Vec3, normal: Vec3, rays: f32, doubt: f32, seed: u64, cut: &mut Vec<Seen>) -> Lit {
        cut.clear();
        self.collect(Hierarchy::ROOT, point, normal, cut);
        let total: f32 = cut.iter().map(|seen| seen.most).sum();
        if total <= 0.0 {
            return Lit::default();
        }
        let (mut lit, variance) = self.look_at_all(point, normal, (rays, total), seed, cut);
        if variance > doubt * doubt {
            let times = (variance / (doubt * doubt)).min(MOST_AGAIN);
            let (better, _) = self.look_at_all(point, normal, (times * rays, total), mix(seed, 3), cut);
            // Both looks are right in the mean.
            lit.irradiance = (lit.irradiance + times * better.irradiance) / (1.0 + times);
            lit.rays += better.rays;
        }
        lit
    }

    /// Looks at every lamp of a cut with its share of the rays; what was found, and its variance as far as it can be told, (W/m²)².
    fn look_at_all(
        &self,
        point: Vec3,
        normal: Vec3,
        (rays, total): (f32, f32),
        seed: u64,
        cut: &mut [Seen],
    ) -> (Lit, f32) {
        // What deserves less than a ray gets one by chance, and counts for all those that get none; the chances are dealt out in
        // turn, so that as many get one as there should.
        let mut dealt = fraction(mix(seed, 1) as u32);
        // Of those: what they could send, how many got a ray, and how much of it came through.
        let (mut small, mut picks, mut through) = (0.0, 0.0, 0.0);
        let (mut lit, mut variance) = (Lit::default(), 0.0);
        for (index, seen) in cut.iter_mut().enumerate() {
            let wanted = rays * seen.most / total;
            let chance = wanted.min(1.0);
            small += if wanted < 1.0 { seen.most } else { 0.0 };
            dealt += chance;
            if dealt < 1.0 {
                continue;
            }
            dealt -= 1.0;
            let found = self.look(seen, point, normal, wanted.ceil().max(1.0) as u32, mix(seed, index as u64));
            lit.irradiance += self.light(seen, &found) / chance;
            lit.rays += found.rays;
            let visibility = if found.all > 0.0 { (found.visible / found.all).min(1.0) } else { 0.0 };
            if wanted < 1.0 {
                picks += 1.0;
                through += visibility;
            } else if found.rays > 1 {
                variance += seen.most * seen.most * visibility * (1.0 - visibility) / found.rays as f32;
            }
        }
        if picks > 1.0 {
            let share = through / picks;
            variance += small * small * share * (1.0 - share) / picks;
        }
        (lit, variance)
    }

    /// B_e·F·V with V weighted by the kernel, since rays to the near end of a lamp decide about more light.
    fn light(&self, seen: &Seen, found: &Found) -> Vec3 {
        match seen.lamp {
            Lamp::Part { .. } if found.all <= 0.0 => Vec3::ZERO,
            Lamp::Part { form_factor, .. } => form_factor / found.all * found.light,
            Lamp::Cluster(_) => found.light / found.points as f32,
        }
    }

    /// Casts rays to a lamp.
    fn look(&self, seen: &Seen, point: Vec3, normal: Vec3, count: u32, seed: u64) -> Found {
        let start = mix(seed, 2);
        let mut found = Found::default();
        for index in 0..count {
            let [u, v] = even_point(start, index);
            let target = match seen.lamp {
                Lamp::Cluster(id) => self.hierarchy.point_on_by(&self.sent.powers, id, u, v),
                Lamp::Part { polygon, corners, count, normal, .. } => {
                    SurfacePoint { position: point_on_polygon(&corners[..count], u, v), normal, polygon }
                }
            };
            let kernel = kernel(point, normal, target.position, target.normal);
            found.points += 1;
            if kernel <= 0.0 {
                continue;
            }
            found.all += kernel;
            found.rays += 1;
            if self.occluders.sees((point, normal), (target.position, target.normal)) {
                found.visible += kernel;
                let radiosity = self.sent.from(target.polygon, target.position, point);
                found.light += kernel
                    * match seen.lamp {
                        Lamp::Part { .. } => radiosity,
                        Lamp::Cluster(id) => {
                            // Points lie by power.
                            let mean = self.sent.radiosity[target.polygon as usize].max_element();
                            self.sent.power(self.hierarchy, id) / mean * radiosity
                        }
                    };
            }
        }
        found
    }

    fn collect(&self, id: ElementId, point: Vec3, normal: Vec3, cut: &mut Vec<Seen>) {
        let element = self.hierarchy.element(id);
        match &element.shape {
            Shape::Cluster(cluster) => {
                let power = self.sent.powers.over(cluster);
                let span = element.centre - point;
                if power <= 0.0 || normal.dot(span) + normal.abs().dot(cluster.half_extent) <= 0.0 {
                    return;
                }
                let distance_squared = span.length_squared();
                if cluster.half_extent.length_squared() < SMALL * SMALL * distance_squared {
                    let cosine = (normal.dot(span) / distance_squared.sqrt()).max(SMALL);
                    let most = power as f32 * cosine / (PI * distance_squared);
                    cut.push(Seen::new(Lamp::Cluster(id), most));
                } else {
                    element.children().for_each(|child| self.collect(child, point, normal, cut));
                }
            }
            Shape::Patch(patch) => {
                if self.sent.radiosity[patch.polygon as usize] == Vec3::ZERO {
                    return;
                }
                let radiosity = self.sent.towards(patch.polygon, point);
                if radiosity != Vec3::ZERO && patch.normal.dot(point - element.centre) > 0.0 {
                    let (corners, count) = self.hierarchy.corner_positions(patch);
                    let part = Part { polygon: patch.polygon, radiosity, normal: patch.normal, count };
                    part.collect(corners, (point, normal), MOST_CUTS, cut);
                }
            }
        }
    }
}

/// A part of a patch that shines.
#[derive(Clone, Copy)]
struct Part {
    polygon: u32,
    radiosity: Vec3,
    normal: Vec3,
    count: usize,
}

impl Part {
    /// What is near for its size is cut into quarters: most of its light comes from its nearest end, and few rays to all of it would
    /// tell about the rest.
    fn collect(&self, corners: [Vec3; 4], (point, normal): (Vec3, Vec3), cuts: u32, cut: &mut Vec<Seen>) {
        let used = &corners[..self.count];
        let highest = used.iter().map(|corner| normal.dot(*corner - point)).fold(f32::NEG_INFINITY, f32::max);
        if highest <= 0.0 {
            return;
        }
        let centre = used.iter().sum::<Vec3>() / self.count as f32;
        let size = used.iter().map(|corner| corner.distance_squared(centre)).fold(0.0, f32::max);
        if cuts > 0 && size > NEAR * NEAR * centre.distance_squared(point) {
            for number in 0..4 {
                self.collect(quarter(corners, self.count, number), (point, normal), cuts - 1, cut);
            }
            return;
        }
        let form_factor = point_to_polygon(point, normal, used);
        if form_factor > 0.0 {
            let Self { polygon, radiosity, normal, count } = *self;
            let most = form_factor * radiosity.max_element();
            cut.push(Seen::new(Lamp::Part { polygon, corners, count, normal, form_factor }, most));
        }
    }
}

/// cosθ·cosθ'/(πd²) between two points, 1/m²; 0 where one faces away.
fn kernel(point: Vec3, normal: Vec3, target: Vec3, target_normal: Vec3) -> f32 {
    let span = target - point;
    let square = span.length_squared();
    let (cosine, target_cosine) = (normal.dot(span), -target_normal.dot(span));
    if cosine > 0.0 && target_cosine > 0.0 && square > 0.0 {
        cosine * target_cosine / (PI * square * square)
    } else {
        0.0
    }
}
