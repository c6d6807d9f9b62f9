//! What shines: the lamps, and what reflects like one.

use glam::Vec3;
use rayon::prelude::*;
use rustc_hash::FxHashMap;

use super::lamps::{Lamps, Reflecting, Seen, Sent};
use super::{Context, LAMP_RAYS};
use crate::cancel::CancelToken;
use crate::hierarchy::{ElementId, Hierarchy, Shape, SurfacePoint};
use crate::random::mix;

/// What reflects so many times more than the mean is a lamp to all others.
const BRIGHT: f32 = 10.0;
/// Points of a polygon by which that is decided, where the first of them found this share of what it takes.
const BRIGHT_POINTS: u32 = 4;
const MAY_BE: f32 = 0.2;
/// Places on a polygon that is bright, at which it is known what it reflects: at the edge of a shade much less than deep in it.
const PLACES: u32 = 16;
/// Reflections are followed until one brings less than this share of all that they reflect.
const TOLERANCE: f32 = 0.005;
const MOST_SWEEPS: u32 = 32;
/// What is nearer than so many radii of a polygon gets what it reflects by random rays: many of them meet it, and find where on it there
/// is how much light.
const REACH: f32 = 3.0;

/// Radiosity of all that shines: what lamps emit, and what surfaces reflect that are much brighter than the rest; `None` if cancelled.
///
/// These light each other in a small space, as a bulb and the inside of its shade do, so that links know little about it. What they
/// reflect of each other is therefore followed by rays, one reflection after the other. What links say of indirect light counts as
/// far as it may come from the rest of the room.
pub fn what_is_sent(
    hierarchy: &Hierarchy,
    context: &Context,
    error: f64,
    indirect: &[Vec3],
    cancel: &CancelToken,
) -> Option<Sent> {
    let emission: Vec<Vec3> = context.surfaces.iter().map(|surface| surface.emission).collect();
    let emitted = Sent::new(hierarchy, emission, FxHashMap::default());
    let rays = (LAMP_RAYS / error).clamp(8.0, 64.0) as f32;
    // Irradiance at a place of the patch of a polygon.
    let irradiance = |sent: &Sent, id: ElementId, index: u32, salt: u64, cut: &mut Vec<Seen>| {
        let lamps = Lamps { hierarchy, sent, occluders: context.occluders };
        let point = place(hierarchy, id, index);
        let seed = mix(mix(mix(context.seed, hierarchy.element(id).key), salt), u64::from(index));
        let lit = lamps.irradiance(point.position, point.normal, rays, f32::INFINITY, seed, cut);
        (!cancel.is_cancelled()).then_some(lit.irradiance)
    };
    let surface_of = |id: ElementId| match hierarchy.element(id).shape {
        Shape::Patch(patch) => Some((patch.polygon, &context.surfaces[patch.polygon as usize])),
        Shape::Cluster(_) => None,
    };
    let look = |id: ElementId, points: u32, cut: &mut Vec<Seen>| {
        let reflectance = surface_of(id).map_or(Vec3::ZERO, |(_, surface)| surface.reflectance);
        let direct = (0..points).map(|index| irradiance(&emitted, id, index, 0, cut)).sum::<Option<Vec3>>()?;
        Some((reflectance * direct / points as f32, reflectance * indirect[id.index()]))
    };
    let ids = hierarchy.initial_patches();
    let patches = ids.par_iter().with_min_len(64);
    let glances: Vec<(Vec3, Vec3)> = patches.map_init(Vec::new, |cut, id| look(*id, 1, cut)).collect::<Option<_>>()?;
    let area = |id: &ElementId| hierarchy.element(*id).area;
    let brightness = |(direct, indirect): (Vec3, Vec3)| (direct + indirect).max_element();
    let mean = ids.iter().zip(&glances).map(|(id, glance)| area(id) * brightness(*glance)).sum::<f32>()
        / ids.iter().map(area).sum::<f32>();
    let may_be_bright = |glance: &(Vec3, Vec3)| brightness(*glance) > MAY_BE * BRIGHT * mean;
    let looked: Vec<(ElementId, (Vec3, Vec3))> = ids
        .par_iter()
        .zip(&glances)
        .filter(|(_, glance)| may_be_bright(glance))
        .map_init(Vec::new, |cut, (id, _)| Some((*id, look(*id, BRIGHT_POINTS, cut)?)))
        .collect::<Option<_>>()?;

    // What comes from the rest of the room is known; each reflection adds to it.
    let of_room = |indirect: Vec3| indirect * (mean / indirect.max_element().max(f32::MIN_POSITIVE)).min(1.0);
    let is_bright = |looked: &&(ElementId, (Vec3, Vec3))| brightness(looked.1) > BRIGHT * mean;
    let mut bright: Vec<Bright> = looked
        .iter()
        .filter(is_bright)
        .filter_map(|(id, (_, indirect))| {
            let (polygon, surface) = surface_of(*id)?;
            let reflected = vec![of_room(*indirect); PLACES as usize];
            Some(Bright { id: *id, polygon, reflectance: surface.reflectance, reflected, last: Vec3::ZERO })
        })
        .collect();
    for sweep in 0..MOST_SWEEPS {
        let last = (sweep > 0).then(|| {
            let mut last = vec![Vec3::ZERO; context.surfaces.len()];
            bright.iter().for_each(|bright| last[bright.polygon as usize] = bright.last);
            Sent::new(hierarchy, last, FxHashMap::default())
        });
        let sent = last.as_ref().unwrap_or(&emitted);
        let received = bright.par_iter().map_init(Vec::new, |cut, bright| {
            (0..PLACES).map(|index| irradiance(sent, bright.id, index, 1 + u64::from(sweep), cut)).collect()
        });
        let received: Vec<Vec<Vec3>> = received.collect::<Option<_>>()?;
        bright.iter_mut().zip(&received).for_each(|(bright, received)| bright.reflect(received, sweep == 0));
        let power = |of: fn(&Bright) -> Vec3| -> f32 {
            bright.iter().map(|bright| area(&bright.id) * of(bright).max_element()).sum()
        };
        if power(|bright| bright.last) <= TOLERANCE * power(Bright::mean) {
            break;
        }
    }

    let mut radiosity = emitted.radiosity;
    let mut reflecting = FxHashMap::default();
    for bright in bright {
        let element = hierarchy.element(bright.id);
        let Shape::Patch(patch) = &element.shape else { continue };
        let (corners, count) = hierarchy.corner_positions(patch);
        let radius = corners[..count].iter().map(|corner| corner.distance(element.centre)).fold(0.0, f32::max);
        let sent = &mut radiosity[patch.polygon as usize];
        let (emission, reflected) = (*sent, bright.mean());
        *sent += reflected;
        let places = (0..PLACES).map(|index| place(hierarchy, bright.id, index).position);
        let places = places.zip(bright.reflected).collect();
        let of = Reflecting { centre: element.centre, reach: REACH * radius, emission, places };
        reflecting.insert(patch.polygon, of);
    }
    Some(Sent::new(hierarchy, radiosity, reflecting))
}

/// A polygon that reflects like a lamp.
struct Bright {
    /// Its initial patch.
    id: ElementId,
    polygon: u32,
    reflectance: Vec3,
    /// What it reflects at each place, W/m².
    reflected: Vec<Vec3>,
    /// In the mean, what of that came last and was not reflected further by others, W/m².
    last: Vec3,
}

impl Bright {
    /// Reflects what its places received.
    fn reflect(&mut self, received: &[Vec3], is_first: bool) {
        for (reflected, received) in self.reflected.iter_mut().zip(received) {
            *reflected += self.reflectance * *received;
        }
        // The first time what comes from the room has not been sent on to the others either.
        self.last = match is_first {
            true => self.mean(),
            false => self.reflectance * received.iter().sum::<Vec3>() / received.len() as f32,
        };
    }

    /// What it reflects in the mean, W/m².
    fn mean(&self) -> Vec3 {
        self.reflected.iter().sum::<Vec3>() / self.reflected.len() as f32
    }
}

/// A place on a patch, by its number: a lattice of any number of them is even \[Roberts 2018\].
fn place(hierarchy: &Hierarchy, id: ElementId, index: u32) -> SurfacePoint {
    let [u, v] = [0.754_877_7_f32, 0.569_840_3].map(|step| (0.5 + step * index as f32).fract());
    hierarchy.point_on(id, u, v)
}
