//! Enclosure: points inside of things, which see nothing but the backs of faces.

use std::sync::Arc;

use glam::Vec3;

use super::reachability::{point_in, uniform};
use super::{Hit, Occluders};
use crate::base::random::{cosine_direction, hash64};
use crate::scene::outside::Outside;
use crate::scene::{Polygon, Scene};

/// The polygons that emit, as targets of rays.
#[derive(Debug)]
pub struct LampList {
    /// Polygons that emit, and the sums of their powers, W.
    lamps: Vec<u32>,
    powers: Vec<f32>,
}

impl LampList {
    /// Those of a scene.
    pub fn new(scene: &Scene) -> Self {
        let emitted = |polygon: &Polygon| scene.surface(polygon).emission.max_element() * scene.area(polygon);
        let is_lamp = |index: &u32| emitted(&scene.polygons[*index as usize]) > 0.0;
        let lamps: Vec<u32> = (0..scene.polygons.len() as u32).filter(is_lamp).collect();
        let mut sum = 0.0;
        let power = |lamp: &u32| {
            sum += emitted(&scene.polygons[*lamp as usize]);
            sum
        };
        let powers = lamps.iter().map(power).collect();
        Self { lamps, powers }
    }
}

/// Tells points that no light can reach.
pub struct EnclosureTest<'a> {
    scene: &'a Scene,
    occluders: &'a Occluders,
    lamps: Arc<LampList>,
}

impl<'a> EnclosureTest<'a> {
    /// For a scene whose faces are bright on one side.
    pub fn new(scene: &'a Scene, occluders: &'a Occluders) -> Self {
        Self::with_lamps(scene, occluders, Arc::new(LampList::new(scene)))
    }

    /// A test with lamps that were found before, for which all polygons are looked at.
    pub fn with_lamps(scene: &'a Scene, occluders: &'a Occluders, lamps: Arc<LampList>) -> Self {
        Self { scene, occluders, lamps }
    }

    /// Whether a point lies inside of something: of so many random rays none meets a bright side,
    /// at least half meet the backs of faces (the others leave the scene), and as many rays to the
    /// lamps are blocked.
    pub fn is_enclosed(&self, point: Vec3, normal: Vec3, seed: u64, rays: u32) -> bool {
        let mut backs = 0;
        for ray in 0..rays {
            match self.look(point, normal, hash64(seed, 2 * u64::from(ray) + 2)) {
                Some(hit) if hit.front => return false,
                Some(_) => backs += 1,
                None if self.shines_along(normal, hash64(seed, 2 * u64::from(ray) + 2)) => return false,
                None => {}
            }
        }
        2 * backs >= rays && !(0..rays).any(|ray| self.shows_lamp(point, normal, hash64(seed, 2 * u64::from(ray) + 3)))
    }

    /// The hit of a random ray.
    fn look(&self, point: Vec3, normal: Vec3, random: u64) -> Option<Hit> {
        let [u, v] = uniform(random);
        self.occluders.ray_from(point, normal, cosine_direction(normal, u, v))
    }

    /// Whether a random ray that leaves the scene finds the sky bright.
    fn shines_along(&self, normal: Vec3, random: u64) -> bool {
        let [u, v] = uniform(random);
        let radiance = |outside: &Arc<Outside>| outside.radiance(cosine_direction(normal, u, v));
        self.scene.outside().is_some_and(|outside| radiance(outside) != Vec3::ZERO)
    }

    fn shows_lamp(&self, point: Vec3, normal: Vec3, random: u64) -> bool {
        let Some(&power) = self.lamps.powers.last() else { return false };
        let wanted = uniform(hash64(random, 1))[0] * power;
        let place = self.lamps.powers.partition_point(|&sum| sum <= wanted).min(self.lamps.lamps.len() - 1);
        let lamp = &self.scene.polygons[self.lamps.lamps[place] as usize];
        let (corners, count) = self.scene.corner_positions(lamp);
        let on_lamp = point_in(corners, count, uniform(random));
        self.occluders.sees((point, normal), (on_lamp, self.scene.normal(lamp)))
    }
}
