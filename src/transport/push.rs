//! The immediate push: what a cluster receives goes at once to the patches below, link by link,
//! each patch by its cosine towards the source (paper, section 3.3; the receiving half of the
//! α-links of [Smits 94]).
//!
//! A large cluster holds many patches and has many links. To meet each patch with each link would
//! cost more than all else: in a room of 130,000 polygons three quarters of the solve. A link of a
//! large cluster is therefore handed down the tree as far as its clusters are seen from the source
//! under more than a small angle. Smaller ones take it as a light from one direction into a
//! [`IrradianceHarmonics`], which takes up any number of lights and tells their irradiance on a
//! face that is turned anyhow; the harmonics of all clusters above a patch are summed on the way
//! down. This costs time in proportion to links and elements.

use glam::Vec3;
use rayon::prelude::*;

use super::form_factor::CLUSTER_COSINE;
use super::harmonics::{IrradianceHarmonics, NormalMoments, normal_moments};
use super::link::{Link, LinkTable};
use super::rules::{ClusterModel, LinkRules, Push};
use crate::base::cancel::CancelToken;
use crate::hierarchy::{Cluster, Element, ElementId, Hierarchy, Shape};

/// Links of clusters of up to this many patches meet each of these by itself.
const MOST_MET: usize = 64;
/// Clusters of more patches than this have harmonics.
const MOST_WITHOUT_HARMONICS: usize = 8;
/// A cluster takes a light as from one direction where the source is farther than so many of its
/// radii.
const FAR: f32 = 3.0;

/// What all pushes over one hierarchy read of its clusters and initial patches, whatever links
/// there are; parallel to them.
pub struct PushTables {
    normal_moments: Vec<NormalMoments>,
    /// Harmonics of each element: its own, or that of the nearest cluster above it that has one.
    harmonics_of: Vec<u32>,
    /// Clusters with harmonics, parents first.
    with_harmonics: Vec<ElementId>,
    /// The initial patches in their order.
    faces: Vec<Face>,
}

/// Facts about an initial patch that are read whenever light is handed down.
struct Face {
    id: ElementId,
    normal: Vec3,
    harmonics: u32,
}

/// Hands light down over one table of links.
pub struct Pusher<'a> {
    hierarchy: &'a Hierarchy,
    links: &'a LinkTable,
    tables: &'a PushTables,
    /// How each link's light is handed down, in the order of the table.
    weights: Vec<PushWeights>,
    /// Targets of the links of large clusters.
    link_targets: Vec<LinkTargets>,
    /// Small clusters that have links, with the place of the nearest one around each.
    lit: Vec<(ElementId, u32)>,
    /// Place of the nearest one around each initial patch, in their order.
    lit_around: Vec<u32>,
}

/// How a link's light is handed down, in multiples of the receiver's mean irradiance.
#[derive(Clone, Copy, Debug)]
struct PushWeights {
    /// To a face turned to the source; each patch gets its cosine's share.
    beam: f32,
    /// To every patch, whichever way it faces.
    even: f32,
}

/// Where the light of one link of a large cluster goes.
struct LinkTargets {
    place: usize,
    targets: Vec<Target>,
}

/// A part of a cluster that takes a link's light.
#[derive(Clone, Copy)]
enum Target {
    /// A cluster, which sees the source in this direction.
    Cluster(ElementId, Vec3),
    /// A patch, by its cosine towards the source.
    Patch(ElementId, f32),
}

/// Stands for "no such cluster".
const NONE: u32 = u32::MAX;

impl PushWeights {
    const EVEN: Self = Self { beam: 0.0, even: 1.0 };

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

impl PushTables {
    /// Those of a hierarchy, of which nothing but initial patches and what lies outside may have
    /// been split.
    pub fn new(hierarchy: &Hierarchy) -> Self {
        let (harmonics_of, with_harmonics) = harmonics_around(hierarchy);
        let face = |&id: &ElementId| {
            let normal = match &hierarchy.element(id).shape {
                Shape::Patch(patch) => patch.normal,
                Shape::Cluster(_) | Shape::Sky(_) => Vec3::ZERO,
            };
            Face { id, normal, harmonics: harmonics_of[id.index()] }
        };
        let faces = hierarchy.initial_patches().par_iter().with_min_len(1 << 12).map(face).collect();
        Self { normal_moments: normal_moments(hierarchy), harmonics_of, with_harmonics, faces }
    }

    /// Memory, bytes.
    pub fn bytes(&self) -> usize {
        size_of_val(&self.normal_moments[..])
            + size_of_val(&self.harmonics_of[..])
            + size_of_val(&self.with_harmonics[..])
            + size_of_val(&self.faces[..])
    }
}

impl<'a> Pusher<'a> {
    /// Prepares to hand down the light of these links.
    pub fn new(hierarchy: &'a Hierarchy, links: &'a LinkTable, tables: &'a PushTables, model: ClusterModel) -> Self {
        let of_receiver = |receiver: usize| {
            let receiver = ElementId(receiver as u32);
            let places = links.range(receiver).zip(links.of(receiver));
            places
                .map(|(place, link)| push_weights(hierarchy, &tables.normal_moments, model, (receiver, link), place))
                .unzip::<_, _, Vec<_>, Vec<_>>()
        };
        let per_receiver: Vec<_> = (0..links.receivers()).into_par_iter().with_min_len(64).map(of_receiver).collect();
        let (mut weights, mut link_targets) = (Vec::with_capacity(links.len()), Vec::new());
        for (of_links, targeted) in per_receiver {
            weights.extend(of_links);
            link_targets.extend(targeted.into_iter().flatten());
        }
        let (lit, lit_around) = lit_clusters(hierarchy, links);
        Self { hierarchy, links, tables, weights, link_targets, lit, lit_around }
    }

    /// Share of the light of the link at this place of the table that its receiver hands to every
    /// patch alike.
    pub fn share_handed_evenly(&self, place: usize) -> f32 {
        self.weights[place].even
    }

    /// Irradiance that the clusters above hand to each initial patch by its cosines, W/m², where
    /// each link brings `flux`; anything if cancelled.
    pub fn push(&self, flux: &(impl Fn(&Link) -> Vec3 + Sync), cancel: &CancelToken) -> Vec<Vec3> {
        let mut harmonics = vec![IrradianceHarmonics::default(); self.tables.with_harmonics.len()];
        let mut met = vec![Vec3::ZERO; if self.link_targets.is_empty() { 0 } else { self.hierarchy.elements().len() }];
        for targeted in &self.link_targets {
            let flux = flux(&self.links.all()[targeted.place]) * self.weights[targeted.place].beam;
            for target in &targeted.targets {
                match *target {
                    Target::Cluster(id, direction) => {
                        harmonics[self.tables.harmonics_of[id.index()] as usize].add(flux, direction)
                    }
                    Target::Patch(id, cosine) => met[id.index()] += cosine * flux,
                }
            }
        }
        for (index, &id) in self.tables.with_harmonics.iter().enumerate() {
            let above = self.hierarchy.element(id).parent().map(|parent| self.tables.harmonics_of[parent.index()]);
            if let Some(above) = above.filter(|above| *above != NONE) {
                let above = harmonics[above as usize];
                harmonics[index].join(&above);
            }
        }
        let beams = self.beams(flux);
        let pushed_to = |(face, around): (&Face, &u32)| {
            if cancel.is_cancelled() {
                return Vec3::ZERO;
            }
            let met = met.get(face.id.index()).copied().unwrap_or_default();
            met + self.pushed_to(face, *around, &beams, &harmonics)
        };
        self.tables.faces.par_iter().zip(&self.lit_around).with_min_len(256).map(pushed_to).collect()
    }

    /// For each small cluster the light that its links bring, with where it comes from.
    fn beams(&self, flux: &(impl Fn(&Link) -> Vec3 + Sync)) -> Vec<Vec<Beam>> {
        let of_cluster = |&(receiver, _): &(ElementId, u32)| {
            let links = self.links.range(receiver).zip(self.links.of(receiver));
            let beam = |(place, link): (usize, &Link)| Beam {
                from: self.hierarchy.element(link.source()).centre,
                flux: flux(link) * self.weights[place].beam,
            };
            links.filter(|(place, _)| self.weights[*place].beam > 0.0).map(beam).collect()
        };
        self.lit.par_iter().with_min_len(64).map(of_cluster).collect()
    }

    fn pushed_to(&self, face: &Face, mut around: u32, beams: &[Vec<Beam>], harmonics: &[IrradianceHarmonics]) -> Vec3 {
        let mut sum = harmonics.get(face.harmonics as usize).map_or(Vec3::ZERO, |harmonics| harmonics.on(face.normal));
        while let Some(beams) = beams.get(around as usize) {
            let centre = self.hierarchy.element(face.id).centre;
            for beam in beams {
                sum += beam.flux * cosine_towards(centre, face.normal, beam.from);
            }
            around = self.lit[around as usize].1;
        }
        sum
    }
}

/// Tells what single links hand down to one leaf: the patch's own cosine stands for that of the
/// clusters around it.
pub struct Inspector<'a> {
    hierarchy: &'a Hierarchy,
    rules: &'a LinkRules,
    normal_moments: Vec<NormalMoments>,
}

impl<'a> Inspector<'a> {
    /// Prepares to look at any number of links.
    pub fn new(hierarchy: &'a Hierarchy, rules: &'a LinkRules) -> Self {
        Self { hierarchy, rules, normal_moments: normal_moments(hierarchy) }
    }

    /// Irradiance that a link at `receiver`, which brings it `flux` (W/m²), hands down to an
    /// element below: a cluster's to the initial patch by that one's cosine, to a cluster below by
    /// the mean cosine of its patches.
    pub fn handed_down(&self, (receiver, link): (ElementId, &Link), flux: Vec3, below: ElementId) -> Vec3 {
        let (hierarchy, rules) = (self.hierarchy, self.rules);
        if rules.push == Push::Deferred || !hierarchy.element(receiver).is_cluster() {
            return flux;
        }
        let (weights, _) = push_weights(hierarchy, &self.normal_moments, rules.cluster_model, (receiver, link), 0);
        let initial = std::iter::successors(Some(below), |&id| {
            hierarchy.element(id).parent().filter(|&parent| !hierarchy.element(parent).is_cluster())
        });
        let element = hierarchy.element(initial.last().unwrap_or(below));
        let from = hierarchy.element(link.source()).centre;
        match element.shape {
            Shape::Patch(_) => flux * (weights.even + weights.beam * cosine_of(element, from)),
            Shape::Cluster(cluster) => {
                let patches = hierarchy.patches_below(&cluster).iter().map(|&id| hierarchy.element(id));
                let seen: f32 = patches.map(|patch| patch.area * cosine_of(patch, from)).sum();
                let mean = if element.area > 0.0 { seen / element.area } else { 0.0 };
                flux * (weights.even + weights.beam * mean)
            }
            Shape::Sky(_) => Vec3::ZERO,
        }
    }
}

/// How a link is handed down, and to which parts of a large cluster.
fn push_weights(
    hierarchy: &Hierarchy,
    normal_moments: &[NormalMoments],
    model: ClusterModel,
    (receiver, link): (ElementId, &Link),
    place: usize,
) -> (PushWeights, Option<LinkTargets>) {
    let element = hierarchy.element(receiver);
    let Shape::Cluster(cluster) = &element.shape else { return (PushWeights::EVEN, None) };
    // A self-link has no direction.
    if link.source() == receiver || element.area <= 0.0 {
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
                return element.area * normal_moments[id.index()].mean_cosine(direction);
            }
            element.children().map(|child| collect_targets(hierarchy, normal_moments, child, from, targets)).sum()
        }
        Shape::Sky(_) => 0.0,
    }
}

fn meets_each(hierarchy: &Hierarchy, cluster: &Cluster) -> bool {
    hierarchy.patches_below(cluster).len() <= MOST_MET
}

fn has_harmonics(hierarchy: &Hierarchy, cluster: &Cluster) -> bool {
    hierarchy.patches_below(cluster).len() > MOST_WITHOUT_HARMONICS
}

/// The small clusters that have links, each with the place of the nearest one around it; and that
/// around each initial patch.
fn lit_clusters(hierarchy: &Hierarchy, links: &LinkTable) -> (Vec<(ElementId, u32)>, Vec<u32>) {
    let mut around = vec![NONE; hierarchy.initial_patches().len()];
    let mut lit = Vec::new();
    // Parents come first, so the nearest one has the last word.
    for receiver in (0..links.receivers() as u32).map(ElementId).filter(|receiver| !links.of(*receiver).is_empty()) {
        let Shape::Cluster(cluster) = &hierarchy.element(receiver).shape else { continue };
        if meets_each(hierarchy, cluster) {
            let below = &mut around[cluster.patches()];
            lit.push((receiver, below.first().copied().unwrap_or(NONE)));
            below.fill(lit.len() as u32 - 1);
        }
    }
    (lit, around)
}

/// The harmonics around each element, and the clusters that have one.
fn harmonics_around(hierarchy: &Hierarchy) -> (Vec<u32>, Vec<ElementId>) {
    let mut harmonics_of = vec![NONE; hierarchy.elements().len()];
    let mut with_harmonics = Vec::new();
    for id in hierarchy.ids() {
        let element = hierarchy.element(id);
        harmonics_of[id.index()] = match &element.shape {
            Shape::Cluster(cluster) if has_harmonics(hierarchy, cluster) => {
                with_harmonics.push(id);
                with_harmonics.len() as u32 - 1
            }
            _ => element.parent().map_or(NONE, |parent| harmonics_of[parent.index()]),
        };
    }
    (harmonics_of, with_harmonics)
}

/// Positive cosine of a patch towards a point.
fn cosine_of(element: &Element, point: Vec3) -> f32 {
    match element.shape {
        Shape::Patch(patch) => cosine_towards(element.centre, patch.normal, point),
        Shape::Cluster(_) | Shape::Sky(_) => 0.0,
    }
}

/// Positive cosine of a face towards a point.
#[inline]
fn cosine_towards(centre: Vec3, normal: Vec3, point: Vec3) -> f32 {
    let towards = point - centre;
    let height = normal.dot(towards);
    if height > 0.0 { height * towards.length_recip() } else { 0.0 }
}

/// Light on its way into a small cluster.
struct Beam {
    from: Vec3,
    flux: Vec3,
}
