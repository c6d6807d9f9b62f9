//! How the light of a link is handed down: evenly, as a beam by each patch's cosine, and of a large
//! cluster to which of its parts.

use glam::Vec3;

use super::form_factor::CLUSTER_COSINE;
use super::harmonics::NormalMoments;
use super::link::Link;
use super::rules::{ClusterModel, LinkRules, Push};
use crate::hierarchy::{Cluster, Element, ElementId, Hierarchy, Shape};

/// Links of clusters of up to this many patches meet each of these by itself.
const MOST_MET: usize = 64;
/// Clusters of more patches than this have harmonics.
const MOST_WITHOUT_HARMONICS: usize = 8;
/// A cluster takes a light as from one direction where the source is farther than so many of its
/// radii.
const FAR: f32 = 3.0;

/// How a link's light is handed down, in multiples of the receiver's mean irradiance.
#[derive(Clone, Copy, Debug)]
pub struct PushWeights {
    /// To a face turned to the source; each patch gets its cosine's share.
    pub beam: f32,
    /// To every patch, whichever way it faces.
    pub even: f32,
}

/// Where the light of one link of a large cluster goes.
pub struct LinkTargets {
    /// Place of the link in the table.
    pub place: usize,
    /// The parts that take it.
    pub targets: Vec<Target>,
}

/// A part of a cluster that takes a link's light.
#[derive(Clone, Copy)]
pub enum Target {
    /// A cluster, which sees the source in this direction.
    Cluster(ElementId, Vec3),
    /// A patch, by its cosine towards the source.
    Patch(ElementId, f32),
}

impl Target {
    /// The part.
    pub fn id(&self) -> ElementId {
        match *self {
            Self::Cluster(id, _) | Self::Patch(id, _) => id,
        }
    }
}

impl PushWeights {
    /// To all patches alike.
    pub const EVEN: Self = Self { beam: 0.0, even: 1.0 };

    /// A beam of one over the mean cosine of the cluster's patches towards the source, so that
    /// together they get the power that the link carries. For randomly turned faces this is the 4
    /// of the paper's model, whose mean cosine is ¼. What would give a face more than the source
    /// sends out is handed down evenly.
    ///
    /// The isotropic model has that 4 whichever way the patches are turned, so that their light may
    /// be more or less than the link's.
    fn new(model: ClusterModel, mean_cosine: f32, link: &Link) -> Self {
        if model == ClusterModel::Isotropic {
            return Self { beam: CLUSTER_COSINE.recip().min(link.form_factor.recip()), even: 0.0 };
        }
        if mean_cosine <= 0.0 {
            return Self::EVEN;
        }
        let beam = mean_cosine.recip().min(link.form_factor.recip());
        Self { beam, even: (1.0 - beam * mean_cosine).max(0.0) }
    }
}

/// How a link is handed down, and to which parts of a large cluster.
pub fn push_weights(
    hierarchy: &Hierarchy,
    normal_moments: &[NormalMoments],
    rules: &LinkRules,
    (receiver, link): (ElementId, &Link),
    place: usize,
) -> (PushWeights, Option<LinkTargets>) {
    let (element, model) = (hierarchy.element(receiver), rules.cluster_model);
    let Shape::Cluster(cluster) = &element.shape else { return (PushWeights::EVEN, None) };
    // A self-link has no direction.
    if rules.push == Push::Deferred || link.source() == receiver || element.area <= 0.0 {
        return (PushWeights::EVEN, None);
    }
    let from = hierarchy.element(link.source()).centre;
    if meets_each(hierarchy, cluster) {
        let below = hierarchy.patches_below(cluster).iter().map(|&id| hierarchy.element(id));
        let seen = below.map(|patch| patch.area * cosine_of(patch, from));
        return (PushWeights::new(model, seen.sum::<f32>() / element.area, link), None);
    }
    let mut targets = Vec::new();
    let seen = collect_targets(hierarchy, normal_moments, receiver, from, &mut targets);
    let weights = PushWeights::new(model, seen / element.area, link);
    let targeted = (weights.beam > 0.0).then_some(LinkTargets { place, targets });
    (weights, targeted)
}

/// Finds the parts of a cluster that take a light from a point; returns the sum of their areas
/// times mean cosines, m².
fn collect_targets(
    hierarchy: &Hierarchy,
    normal_moments: &[NormalMoments],
    id: ElementId,
    from: Vec3,
    targets: &mut Vec<Target>,
) -> f32 {
    let element = hierarchy.element(id);
    match &element.shape {
        Shape::Patch(patch) => {
            let cosine = cosine_towards(element.centre, patch.normal, from);
            if cosine > 0.0 {
                targets.push(Target::Patch(id, cosine));
            }
            element.area * cosine
        }
        Shape::Cluster(cluster) => {
            let towards = from - element.centre;
            let is_far = towards.length_squared() > FAR * FAR * cluster.half_extent.length_squared();
            if is_far && has_harmonics(hierarchy, cluster) {
                let direction = towards.normalize();
                targets.push(Target::Cluster(id, direction));
                return element.area * normal_moments[cluster.number as usize].mean_cosine(direction);
            }
            element.children().map(|child| collect_targets(hierarchy, normal_moments, child, from, targets)).sum()
        }
        Shape::Sky(_) => 0.0,
    }
}

/// Whether each link of a cluster meets its patches one by one.
pub fn meets_each(hierarchy: &Hierarchy, cluster: &Cluster) -> bool {
    hierarchy.patches_below(cluster).len() <= MOST_MET
}

fn has_harmonics(hierarchy: &Hierarchy, cluster: &Cluster) -> bool {
    hierarchy.patches_below(cluster).len() > MOST_WITHOUT_HARMONICS
}

/// Positive cosine of a patch towards a point.
pub fn cosine_of(element: &Element, point: Vec3) -> f32 {
    match element.shape {
        Shape::Patch(patch) => cosine_towards(element.centre, patch.normal, point),
        Shape::Cluster(_) | Shape::Sky(_) => 0.0,
    }
}

/// Positive cosine of a face towards a point.
#[inline]
pub fn cosine_towards(centre: Vec3, normal: Vec3, point: Vec3) -> f32 {
    let towards = point - centre;
    let height = normal.dot(towards);
    if height > 0.0 { height * towards.length_recip() } else { 0.0 }
}
