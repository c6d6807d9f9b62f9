//! Which leaves a gather splits: those over which emitters shine unevenly, and, as soon as
//! cosine-distributed rays tell, those over which all light is uneven.
//!
//! Readings look for emitters themselves, so the field is to be right in what leaves send in the
//! mean, and what counts is how much a leaf's light differs over it, and how much of that light
//! others have: a patch beside a gap, bright on one side of it, may be most of what a dark room
//! behind it sees \[importance: Smits, Arvo, Salesin, *An importance-driven radiosity algorithm*,
//! SIGGRAPH 1992\].

use rayon::prelude::*;

use super::field::{CHUNK, Field, grey};
use super::groups::Groups;
use super::samples::GatherSamples;
use crate::hierarchy::ElementId;

/// Leaves whose errors add up to this share of what is allowed are kept; the others keep a part of
/// theirs when they are split.
const KEPT: f64 = 0.5;
/// A leaf that counts more than this share of what is allowed is looked at closely, by so many
/// looks.
const HEAVY: f64 = 0.05;
const LOOKS_OF_HEAVY: u32 = 32;
/// Leaves below this share of the square of the scene's diagonal are not split: 3 mm in a room.
const LEAST_AREA: f32 = 1e-7;

/// The leaves to split next, so that light varies over a leaf by no more than this share of it, in
/// the RMS over all of them; variances are in W²/m⁴, parallel to the arena.
pub fn leaves_to_split(field: &Field, importance: &Importance, variances: &[f32], allowed: f64) -> Vec<ElementId> {
    let least = least_area(field);
    let share = importance.share_of(field);
    let error = |&leaf: &ElementId| {
        let light = grey(field.irradiance[leaf.index()]) + field.dim();
        let may_split = !field.emits(leaf) && field.area(leaf) >= least && light > 0.0;
        may_split.then(|| (share(leaf) * f64::from(variances[leaf.index()] / (light * light)), leaf))
    };
    let mut errors: Vec<(f64, ElementId)> =
        field.all_leaves().par_iter().with_min_len(CHUNK).filter_map(error).collect();
    let allowed = allowed * allowed;
    if errors.iter().map(|(error, _)| error).sum::<f64>() <= allowed {
        return Vec::new();
    }
    errors.par_sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut sum = 0.0;
    let kept = errors.iter().take_while(|(error, _)| {
        sum += error;
        sum <= KEPT * allowed
    });
    let kept = kept.count();
    errors[kept..].iter().map(|(_, leaf)| *leaf).collect()
}

/// Leaves whose light could differ so much over them that a few looks do not tell whether they must
/// be split, with the looks that would, beside those that there were.
pub fn leaves_to_look_from(
    field: &Field,
    samples: &GatherSamples,
    importance: &Importance,
    allowed: f64,
) -> Vec<(ElementId, u32)> {
    let least = least_area(field);
    let share = importance.share_of(field);
    let is_heavy = |leaf: &ElementId| {
        !field.emits(*leaf) && field.area(*leaf) >= least && share(*leaf) > HEAVY * allowed * allowed
    };
    let looks = |&leaf: &ElementId| (leaf, LOOKS_OF_HEAVY.saturating_sub(samples.looks(leaf)));
    let leaves = field.all_leaves().par_iter().with_min_len(CHUNK);
    leaves.filter(|leaf| is_heavy(leaf)).map(looks).filter(|(_, looks)| *looks > 0).collect()
}

/// Share of its readers' light that each patch brings for what it reflects and its area, m²/W,
/// parallel to the arena; of patches that hold others it is that of all their parts. Empty before
/// anybody read them.
#[derive(Debug, Default)]
pub struct Importance(Vec<f32>);

impl Importance {
    /// By the rays of a gather: which leaves they met, from where, and what light there is.
    pub fn of(field: &Field, samples: &GatherSamples, groups: &Groups) -> Self {
        // What a look stands for is the area that it is drawn from, each part of it as far as it is
        // dark.
        let of_look = |leaf: ElementId| {
            let looks = groups.planned(leaf).unwrap_or_else(|| f64::from(samples.whole_looks(leaf)).max(1.0));
            let light = f64::from(grey(field.irradiance[leaf.index()]) + field.dim());
            f64::from(field.area(leaf)) / (looks * light.max(f64::MIN_POSITIVE))
        };
        let mut of = samples.read(field.hierarchy.elements().len(), of_look);
        let hierarchy = field.hierarchy();
        for id in hierarchy.ids() {
            let element = hierarchy.element(id);
            let whole = match element.parent().filter(|parent| hierarchy.element(*parent).is_patch()) {
                Some(parent) => of[parent.index()],
                None => 0.0,
            };
            if element.area > 0.0 {
                of[id.index()] = whole + of[id.index()] / element.area;
            }
        }
        Self(of)
    }

    /// The parts of leaves that were split have theirs.
    pub fn split(&mut self, field: &Field, leaves: &[ElementId]) {
        if self.0.is_empty() {
            return;
        }
        self.0.resize(field.hierarchy.elements().len(), 0.0);
        for leaf in leaves {
            let of_leaf = self.0[leaf.index()];
            field.hierarchy.element(*leaf).children().for_each(|child| self.0[child.index()] = of_leaf);
        }
    }

    /// Share that a leaf has in the light of its readers, 1 for all leaves together: in proportion
    /// to its power before anybody read it.
    pub fn brought_by<'a>(&'a self, field: &'a Field) -> impl Fn(ElementId) -> f64 + Sync + use<'a> {
        let brought = move |leaf: ElementId| {
            let importance = self.0.get(leaf.index()).copied().unwrap_or(1.0);
            f64::from(importance * field.area(leaf) * field.reflected[leaf.index()].max_element())
        };
        let total = field.sum_over_leaves(brought).max(f64::MIN_POSITIVE);
        move |leaf| brought(leaf) / total
    }

    /// Weight of a leaf, of 1 for all: by its share of the area, and as much by what it brings to
    /// others, for its error is one of theirs, too.
    pub fn share_of<'a>(&'a self, field: &'a Field) -> impl Fn(ElementId) -> f64 + Sync + use<'a> {
        let brought = self.brought_by(field);
        let area = field.sum_over_leaves(|leaf| field.area(leaf).into());
        move |leaf| 0.5 * (f64::from(field.area(leaf)) / area + brought(leaf))
    }
}

fn least_area(field: &Field) -> f32 {
    let (lower, upper) = field.scene().bounds();
    LEAST_AREA * lower.distance_squared(upper)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::cancel::CancelToken;
    use crate::gather::Gather;

    /// Truth: readers share their light out among what they see, so that over all leaves what each
    /// brings sums to the light that is reflected to the readers, each by its own E + E₀.
    #[test]
    fn importance_shares_out_the_light_of_readers() {
        let mut gather = Gather::of_cornell();
        while gather.certificate().is_none() {
            gather.step(&CancelToken::new()).expect("nobody cancels");
        }
        let (field, samples) = (&gather.field, &gather.samples);
        let importance = Importance::of(field, samples, &gather.groups);
        let (mut brought, mut had) = (0.0, 0.0);
        for leaf in field.leaves() {
            let area = f64::from(field.area(leaf));
            brought += area * f64::from(importance.0[leaf.index()] * grey(field.reflected[leaf.index()]));
            let light = field.irradiance[leaf.index()];
            had += area * f64::from(grey(light - samples.direct(leaf).0) / (grey(light) + field.dim()));
        }
        assert!(had > 0.1 && (brought / had - 1.0).abs() < 0.03, "{brought} {had}");
        // Parts of a leaf bring as much as it did.
        let mut finer = field.clone();
        let mut split = Importance(importance.0.clone());
        let leaf = field.leaves().max_by(|a, b| field.area(*a).total_cmp(&field.area(*b))).expect("a leaf");
        finer.split(&[leaf]);
        split.split(&finer, &[leaf]);
        let parts: f64 = finer.hierarchy().element(leaf).children().map(split.brought_by(&finer)).sum();
        assert!((parts / importance.brought_by(field)(leaf) - 1.0).abs() < 1e-3, "{parts}");
    }
}
