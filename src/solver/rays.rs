//! Visibility rays between random points of two elements (section 2.4).

use crate::hierarchy::{ElementId, Hierarchy, mix};
use crate::visibility::Occluders;

/// How many rays went out and came through.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Seen {
    /// Rays cast.
    pub cast: u32,
    /// Rays that met nothing.
    pub visible: u32,
}

impl Seen {
    /// Share of rays that came through.
    pub fn share(self) -> f32 {
        if self.cast == 0 { 0.0 } else { self.visible as f32 / self.cast as f32 }
    }
}

/// Casts rays between elements; the points depend on what the two are and on the seed, not on who asks.
#[derive(Clone, Copy)]
pub struct RaySampler<'a> {
    /// What stops light.
    pub occluders: &'a Occluders,
    /// Seed of all points.
    pub seed: u64,
}

/// Steps of the four-dimensional R-sequence (Roberts), inverse powers of the root of x⁵ = x + 1, as 32-bit fractions.
const STEPS: [u32; 4] = [3_679_390_609, 3_152_041_523, 2_700_274_806, 2_313_257_605];
/// Pairs of points tried for each ray before an end is said to turn its back.
const TRIES: u32 = 8;

impl RaySampler<'_> {
    /// Casts up to `rays` rays between points that face each other; with `stop_when_mixed` it ends as soon as one came
    /// through and one did not.
    pub fn cast(&self, hierarchy: &Hierarchy, a: ElementId, b: ElementId, rays: u32, stop_when_mixed: bool) -> Seen {
        let (a_key, b_key) = (hierarchy.element(a).key, hierarchy.element(b).key);
        // The same points for both directions: order the ends by what they are.
        let (first, second) = if a_key <= b_key { (a, b) } else { (b, a) };
        let pair = mix(mix(a_key.min(b_key), a_key.max(b_key)), self.seed);
        let (low, high) = (mix(pair, 1), mix(pair, 2));
        let start = [low as u32, (low >> 32) as u32, high as u32, (high >> 32) as u32];
        let mut seen = Seen { cast: 0, visible: 0 };
        for index in 0..rays.saturating_mul(TRIES) {
            let coordinate = |axis: usize| {
                let fixed = start[axis].wrapping_add(STEPS[axis].wrapping_mul(index));
                (fixed >> 8) as f32 * (1.0 / 16_777_216.0)
            };
            let from = hierarchy.point_on(first, coordinate(0), coordinate(1));
            let to = hierarchy.point_on(second, coordinate(2), coordinate(3));
            let span = to.position - from.position;
            if from.normal.dot(span) <= 0.0 || to.normal.dot(span) >= 0.0 {
                continue;
            }
            seen.cast += 1;
            seen.visible += u32::from(!self.occluders.occluded(from.position, to.position));
            let mixed = seen.visible > 0 && seen.visible < seen.cast;
            if seen.cast == rays || (mixed && stop_when_mixed) {
                break;
            }
        }
        seen
    }
}
