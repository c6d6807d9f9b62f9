//! Where most of A·|B|² is, as far as a few paths tell.

use rayon::prelude::*;

use super::path::Tracer;
use super::points::{halves, points_by};
use super::sequence::hash64;
use crate::scene::Scene;

/// Keeps these paths apart from those that count.
const SALT: u64 = 0x67_6c6f_7721;
/// Paths from each place, a power of two.
const PATHS: u32 = 8;
/// Places for each polygon, and for all of them so that large ones get several.
const OF_EACH: usize = 2;
const OF_ALL: usize = 2048;
/// No more places than these in scenes of many polygons: neighbours in the scene's order then share
/// theirs.
const MOST: usize = 1 << 16;

/// A·|B|² of each of these polygons, in m²·(W/m²)², lamps' own light left out. Rough, and good for
/// nothing but to decide where to look: half of the places lie by area, half evenly over the
/// polygons, so that small things are met too.
pub fn glow(scene: &Scene, polygons: &[u32], areas: &[f64], seed: u64) -> Vec<f64> {
    let seed = seed ^ SALT;
    let chances = halves(areas, &vec![1.0; polygons.len()]);
    let count = (OF_EACH * polygons.len() + OF_ALL).min(MOST);
    let places = points_by(scene, polygons, (areas, &chances), count, seed);
    let tracer = Tracer::new(scene);
    let brightness = |(index, point): (usize, &super::SurfacePoint)| {
        let irradiance = tracer.irradiance(point, hash64(seed, index as u64), PATHS);
        (point.reflectance.as_dvec3() * irradiance).length_squared()
    };
    let squares: Vec<f64> = places.par_iter().enumerate().map(brightness).collect();
    let per_place = places.len() as f64 / chances.iter().sum::<f64>();
    let mut begun = 0.0;
    let of = |(chance, area): (&f64, &f64)| {
        // Places are dealt out along the polygons: these are the ones on this polygon, or the one
        // that it shares.
        let range = begun..begun + chance * per_place;
        begun = range.end;
        let last = (range.end.ceil() as usize).clamp(1, squares.len().max(1));
        let met = squares.get((range.start as usize).min(last - 1)..last).unwrap_or(&[]);
        area * met.iter().sum::<f64>() / met.len().max(1) as f64
    };
    chances.iter().zip(areas).map(of).collect()
}
