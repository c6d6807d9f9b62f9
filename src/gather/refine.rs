//! Which leaves a gather splits: those over which emitters shine unevenly, and then those over which all light is very uneven.
//!
//! Readings look for emitters themselves, so the field is to be right in what leaves send in the mean, and what
//! counts is how much a leaf's light differs over it.

use super::field::{Field, grey};
use super::samples::GatherSamples;
use crate::hierarchy::ElementId;

/// Leaves whose errors add up to this share of what is allowed are kept; the others keep a part of
/// theirs when they are split.
const KEPT: f64 = 0.5;
/// A leaf that counts more than this share of what is allowed is looked at closely, by so many looks.
const HEAVY: f64 = 0.05;
const LOOKS_OF_HEAVY: u32 = 32;
/// Leaves below this share of the square of the scene's diagonal are not split: 3 mm in a room.
const LEAST_AREA: f32 = 1e-7;

/// The leaves to split next, so that direct light varies over a leaf by no more than this share of the local light, in the
/// RMS over all of them.
pub fn leaves_to_split(field: &Field, samples: &GatherSamples, allowed: f64) -> Vec<ElementId> {
    let least = least_area(field);
    let share = share_of(field);
    let mut errors = Vec::new();
    for leaf in field.leaves() {
        if field.emits(leaf) || field.area(leaf) < least {
            continue;
        }
        let (_, variance) = samples.direct(leaf);
        let light = grey(field.irradiance[leaf.index()]) + field.dim();
        if light > 0.0 {
            errors.push((share(leaf) * f64::from(variance / (light * light)), leaf));
        }
    }
    let allowed = allowed * allowed;
    if errors.iter().map(|(error, _)| error).sum::<f64>() <= allowed {
        return Vec::new();
    }
    errors.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut sum = 0.0;
    let kept = errors.iter().take_while(|(error, _)| {
        sum += error;
        sum <= KEPT * allowed
    });
    let kept = kept.count();
    errors[kept..].iter().map(|(_, leaf)| *leaf).collect()
}

/// Leaves whose light could differ so much over them that a few looks do not tell whether they must be split, with the looks that
/// would, beside those that there were.
pub fn leaves_to_look_from(field: &Field, samples: &GatherSamples, allowed: f64) -> Vec<(ElementId, u32)> {
    let least = least_area(field);
    let share = share_of(field);
    let is_heavy = |leaf: &ElementId| {
        !field.emits(*leaf) && field.area(*leaf) >= least && share(*leaf) > HEAVY * allowed * allowed
    };
    let looks = |leaf: ElementId| (leaf, LOOKS_OF_HEAVY.saturating_sub(samples.looks(leaf)));
    field.leaves().filter(is_heavy).map(looks).filter(|(_, looks)| *looks > 0).collect()
}

/// Weight of a leaf, of 1 for all: by its share of the area, and as much by its share of what is reflected, for its error is one of
/// those who read it, too.
pub fn share_of(field: &Field) -> impl Fn(ElementId) -> f64 + use<'_> {
    let sent = |leaf: ElementId| f64::from(field.area(leaf) * grey(field.reflected[leaf.index()]));
    let (mut area, mut power) = (0.0, 0.0);
    for leaf in field.leaves() {
        area += f64::from(field.area(leaf));
        power += sent(leaf);
    }
    move |leaf| 0.5 * (f64::from(field.area(leaf)) / area + sent(leaf) / power.max(f64::MIN_POSITIVE))
}

fn least_area(field: &Field) -> f32 {
    let (lower, upper) = field.scene().bounds();
    LEAST_AREA * lower.distance_squared(upper)
}
