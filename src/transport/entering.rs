//! Light that comes in from outside: the power that bright sides get, as the scale of ε and one
//! side of the balance.

use std::sync::Arc;

use glam::{DVec3, Vec3};
use rayon::prelude::*;

use crate::base::random::{hash64, r2_sequence};
use crate::geometry::{Occluders, Reachability};
use crate::hierarchy::{ClusteringMode, ElementId, Hierarchy, Shape};
use crate::scene::Scene;
use crate::scene::outside::{Amount, Daylight, LuminanceDistribution, Outside, SkySpec};

/// Rays from the sky, and as many from the sun, by which the power is measured. Where none of them
/// gets in, less than a thousandth of what falls on the scene's hull does: it counts as closed, and
/// nothing outside is linked or looked for.
pub const ENTERING_RAYS: u32 = 1 << 13;
/// Numbers of a sequence before another one begins.
const SEQUENCE: u32 = 0xffff;

/// Power from outside that meets bright sides, W per colour, without what they reflect: by rays
/// that come in through a disc as large as the scene.
pub fn entering_power(scene: &Scene, occluders: &Occluders, rays: u32, seed: u64) -> Vec3 {
    scene.outside().map_or(Vec3::ZERO, |outside| power_from(outside, scene.bounds(), occluders, (rays, seed)))
}

fn power_from(
    outside: &Outside,
    (lower, upper): (Vec3, Vec3),
    occluders: &Occluders,
    (rays, seed): (u32, u64),
) -> Vec3 {
    let (centre, radius) = (0.5 * (lower + upper), 0.5 * lower.distance(upper));
    let disc = std::f32::consts::PI * radius * radius;
    let arrives = |direction: Vec3, [u, v]: [f32; 2]| {
        let (east, north) = direction.any_orthonormal_pair();
        let (sine, cosine) = (std::f32::consts::TAU * v).sin_cos();
        let away = radius * u.sqrt() * (cosine * east + sine * north);
        let hit = occluders.first_hit(centre + away + 1.5 * radius * direction, -direction);
        hit.is_some_and(|hit| hit.front)
    };
    let from_sky = |index: u32| sky_ray(outside, &arrives, seed, index);
    let sky: Vec<Vec3> = (0..if outside.has_sky() { rays } else { 0 }).into_par_iter().map(from_sky).collect();
    let sun = outside.sun().map_or(0, |sun| {
        let hits = |index: &u32| arrives(sun.direction, r2_sequence(hash64(seed, 1), *index));
        (0..rays).into_par_iter().filter(hits).count()
    });
    let of_sun = outside.sun().map_or(DVec3::ZERO, |of| sun as f64 * of.irradiance.as_dvec3());
    let sum = sky.iter().map(|light| light.as_dvec3()).sum::<DVec3>() + of_sun;
    (f64::from(disc) / f64::from(rays) * sum).as_vec3()
}

/// Radiance over density of a direction drawn by it, W/m², if it meets a bright side.
fn sky_ray(outside: &Outside, arrives: &(impl Fn(Vec3, [f32; 2]) -> bool + Sync), seed: u64, index: u32) -> Vec3 {
    let [u, v, w, x] = sobol_burley::sample_4d(index & SEQUENCE, index / (SEQUENCE + 1), hash64(seed, 0) as u32);
    let drawn = outside.draw([u, v]).filter(|drawn| drawn.density > 0.0);
    match drawn.filter(|drawn| arrives(drawn.direction, [w, x])) {
        Some(drawn) => outside.radiance(drawn.direction) / drawn.density,
        None => Vec3::ZERO,
    }
}

/// Whether light from the sky would meet bright sides of a scene, as some thousand rays tell.
pub fn lets_daylight_in(scene: &Scene, occluders: &Occluders) -> bool {
    let sky = Daylight { sky: Some(SkySpec::of(LuminanceDistribution::Uniform, Amount::Lux(1.0))), sun: None };
    let outside = Outside::new(&sky, scene.up_axis(), |_| Err(String::new()));
    outside.is_ok_and(|outside| power_from(&outside, scene.bounds(), occluders, (ENTERING_RAYS, 1)) != Vec3::ZERO)
}

/// A hierarchy of the scene as its clusters are asked for; nothing is outside of a closed scene.
pub fn new_hierarchy(
    scene: &Scene,
    reachability: Arc<Reachability>,
    (clustering, octree_depth): (ClusteringMode, u32),
    entering: Vec3,
) -> Hierarchy {
    let mut hierarchy = Hierarchy::new(scene, reachability, clustering, octree_depth);
    if entering == Vec3::ZERO {
        hierarchy.close();
    }
    hierarchy
}

/// Whether an element is a part of the sky; the sun is none.
pub(super) fn is_sky(hierarchy: &Hierarchy, id: ElementId) -> bool {
    match hierarchy.element(id).shape {
        Shape::Sky(number) => !hierarchy.sky_part(number).is_sun,
        _ => false,
    }
}
