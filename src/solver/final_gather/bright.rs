//! What shines: the lamps, and what reflects like one.

use glam::Vec3;
use rayon::prelude::*;

use super::lamps::{Lamps, Seen, Sent};
use super::{Context, LAMP_RAYS};
use crate::cancel::CancelToken;
use crate::hierarchy::{ElementId, Hierarchy, Shape};
use crate::random::mix;

/// What reflects so many times more than the mean is a lamp to all others.
const BRIGHT: f32 = 10.0;
/// Points of a polygon by which that is decided, where the first of them found this share of what it takes.
const BRIGHT_POINTS: u32 = 4;
const MAY_BE: f32 = 0.2;

/// Radiosity of all that shines: what lamps emit, and what surfaces reflect that are much brighter than the rest; `None` if cancelled.
pub fn what_is_sent(
    hierarchy: &Hierarchy,
    context: &Context,
    error: f64,
    indirect: &[Vec3],
    cancel: &CancelToken,
) -> Option<Sent> {
    let emission: Vec<Vec3> = context.surfaces.iter().map(|surface| surface.emission).collect();
    let emitted = Sent::new(hierarchy, emission, Vec::new());
    let lamps = Lamps { hierarchy, sent: &emitted, occluders: context.occluders };
    let rays = (LAMP_RAYS / error).clamp(8.0, 64.0) as f32;
    // What the patch of a polygon reflects, by so many points.
    let look = |id: ElementId, points: u32, cut: &mut Vec<Seen>| {
        if cancel.is_cancelled() {
            return None;
        }
        let element = hierarchy.element(id);
        let Shape::Patch(patch) = element.shape else { return Some((0, 0.0, Vec3::ZERO)) };
        let surface = &context.surfaces[patch.polygon as usize];
        let light = |index: u32| {
            let [u, v] = [0.7549, 0.5698].map(|step| (0.5 + step * index as f32).fract());
            let point = hierarchy.point_on(id, u, v);
            let seed = mix(mix(context.seed, element.key), u64::from(index));
            lamps.irradiance(point.position, point.normal, rays, f32::INFINITY, seed, cut).irradiance
        };
        let direct = (0..points).map(light).sum::<Vec3>() / points as f32;
        Some((patch.polygon, element.area, surface.reflectance * (direct + indirect[id.index()])))
    };
    let patches = hierarchy.initial_patches().par_iter().with_min_len(64);
    let glances: Vec<(u32, f32, Vec3)> =
        patches.map_init(Vec::new, |cut, id| look(*id, 1, cut)).collect::<Option<_>>()?;
    let area: f32 = glances.iter().map(|of| of.1).sum();
    let mean = glances.iter().map(|of| of.1 * of.2.max_element()).sum::<f32>() / area;
    let may_be_bright = |glance: &(u32, f32, Vec3)| glance.2.max_element() > MAY_BE * BRIGHT * mean;
    let reflected: Vec<(u32, f32, Vec3)> = hierarchy
        .initial_patches()
        .par_iter()
        .zip(&glances)
        .filter(|(_, glance)| may_be_bright(glance))
        .map_init(Vec::new, |cut, (id, _)| look(*id, BRIGHT_POINTS, cut))
        .collect::<Option<_>>()?;
    let mut radiosity = emitted.radiosity;
    let mut is_bright = vec![false; radiosity.len()];
    for (polygon, _, reflected) in reflected {
        if reflected.max_element() > BRIGHT * mean {
            radiosity[polygon as usize] += reflected;
            is_bright[polygon as usize] = true;
        }
    }
    Some(Sent::new(hierarchy, radiosity, is_bright))
}
