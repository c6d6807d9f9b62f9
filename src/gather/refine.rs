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
/// Leaves below this share of the square of the scene's diagonal are not split: 3 mm in a room.
const LEAST_AREA: f32 = 1e-7;

/// The leaves to split next, so that direct light varies over a leaf by no more than this share of the local light, in the
/// RMS over the area.
pub fn leaves_to_split(field: &Field, samples: &GatherSamples, allowed: f64) -> Vec<ElementId> {
    let least = least_area(field);
    let mut all = 0.0;
    let mut errors = Vec::new();
    for leaf in field.leaves() {
        let area = field.area(leaf);
        all += f64::from(area);
        if field.emits(leaf) || area < least {
            continue;
        }
        let (_, variance) = samples.direct(leaf);
        let light = grey(field.irradiance[leaf.index()]) + field.dim();
        if light > 0.0 {
            errors.push((f64::from(area * variance / (light * light)), leaf));
        }
    }
    let allowed = allowed * allowed * all;
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

/// The leaves over which light differs so much that one value does not stand for it.
pub fn uneven_leaves(field: &Field) -> Vec<ElementId> {
    let least = least_area(field);
    let is_split = |leaf: &ElementId| field.is_uneven(*leaf) && !field.emits(*leaf) && field.area(*leaf) >= least;
    field.leaves().filter(is_split).collect()
}

fn least_area(field: &Field) -> f32 {
    let (lower, upper) = field.scene().bounds();
    LEAST_AREA * lower.distance_squared(upper)
}
