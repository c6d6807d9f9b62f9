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

use super::harmonics::{IrradianceHarmonics, NormalMoments, normal_moments};
use super::link::{Link, LinkTable};
use super::nodes::{Kind, Nodes};
use super::push_weights::{LinkTargets, PushWeights, Target, cosine_of, cosine_towards, meets_each, push_weights};
use super::rules::{LinkRules, Push};
use super::stem::{Stem, StemElement};
use crate::base::cancel::CancelToken;
use crate::hierarchy::{ElementId, Hierarchy, Shape};

/// Moves the light of one table of links to where they end, and on to the patches below.
pub struct Pusher<'a> {
    hierarchy: &'a Hierarchy,
    links: &'a LinkTable,
    /// How each link's light is handed down, in the order of the table.
    weights: Vec<PushWeights>,
    /// Targets of the links of large clusters.
    link_targets: Vec<LinkTargets>,
    /// The part of the tree that all of these end in.
    stem: Stem,
    /// Place in the stem of each link's source, in the order of the table.
    sources: Vec<u32>,
    /// Small clusters that have links, with the place of the nearest one around each.
    lit: Vec<(ElementId, u32)>,
    /// Place of the nearest one around each initial patch of the stem.
    lit_around: Vec<u32>,
    /// Number of the harmonics of each element of the stem: its own, or those of the nearest
    /// cluster above it that has any.
    harmonics_of: Vec<u32>,
    /// The harmonics around each of them, outermost first.
    harmonics_around: Vec<u32>,
}

/// Light that has reached the stem.
pub struct Arrived {
    /// Irradiance of each element of the stem that reaches all of its faces alike, W/m²; of
    /// patches, all of it.
    even: Vec<Vec3>,
    harmonics: Vec<IrradianceHarmonics>,
}

/// Stands for "no such cluster".
const NONE: u32 = u32::MAX;

impl<'a> Pusher<'a> {
    /// Prepares to hand down the light of these links over clusters with these moments.
    pub fn new(
        hierarchy: &'a Hierarchy,
        links: &'a LinkTable,
        normal_moments: &[NormalMoments],
        rules: &LinkRules,
        nodes: &Nodes,
    ) -> Self {
        let is_met = |receiver: &ElementId| !links.of(*receiver).is_empty();
        let receivers: Vec<_> = (0..links.receivers() as u32).map(ElementId).filter(is_met).collect();
        let of_receiver = |&receiver: &ElementId| {
            let places = links.range(receiver).zip(links.of(receiver));
            places
                .map(|(place, link)| push_weights(hierarchy, normal_moments, rules, (receiver, link), place))
                .unzip::<_, _, Vec<_>, Vec<_>>()
        };
        let per_receiver: Vec<_> = receivers.par_iter().with_min_len(64).map(of_receiver).collect();
        let (mut weights, mut link_targets) = (Vec::with_capacity(links.len()), Vec::new());
        for (of_links, targeted) in per_receiver {
            weights.extend(of_links);
            link_targets.extend(targeted.into_iter().flatten());
        }
        let small_clusters = || {
            receivers.iter().filter_map(|&receiver| match &hierarchy.element(receiver).shape {
                Shape::Cluster(cluster) if meets_each(hierarchy, cluster) && rules.push == Push::Immediate => {
                    Some((receiver, hierarchy.patches_below(cluster)))
                }
                _ => None,
            })
        };
        let targets = || link_targets.iter().flat_map(|targeted| &targeted.targets);
        let ends = receivers
            .iter()
            .copied()
            .chain(links.all().iter().map(Link::source))
            .chain(small_clusters().flat_map(|(_, patches)| patches.iter().copied()))
            .chain(targets().map(Target::id));
        let stem = Stem::new(nodes, ends);
        let sources = links.all().par_iter().map(|link| stem.place(link.source().index()) as u32).collect();
        let mut lit_around = vec![NONE; stem.elements().len()];
        let mut lit = Vec::new();
        // Parents come first, so the nearest one has the last word.
        for (receiver, patches) in small_clusters() {
            let place = |patch: &ElementId| stem.place(patch.index());
            lit.push((receiver, patches.first().map_or(NONE, |patch| lit_around[place(patch)])));
            patches.iter().for_each(|patch| lit_around[place(patch)] = lit.len() as u32 - 1);
        }
        let mut has_own = vec![false; stem.elements().len()];
        for target in targets() {
            if let Target::Cluster(id, _) = target {
                has_own[stem.place(id.index())] = true;
            }
        }
        let (mut harmonics_of, mut harmonics_around): (Vec<u32>, Vec<u32>) = Default::default();
        for (element, has_own) in stem.elements().iter().zip(has_own) {
            let around = element.parent().map_or(NONE, |parent| harmonics_of[parent]);
            harmonics_of.push(if has_own { harmonics_around.len() as u32 } else { around });
            harmonics_around.extend(has_own.then_some(around));
        }
        Self { hierarchy, links, weights, link_targets, stem, sources, lit, lit_around, harmonics_of, harmonics_around }
    }

    /// The part of the tree that links end in.
    pub fn stem(&self) -> &Stem {
        &self.stem
    }

    /// The light that reaches the stem where each link brings `flux`, which gets the place of the
    /// link's source in the stem; `None` if cancelled.
    pub fn push(&self, flux: &(impl Fn(&Link, usize) -> Vec3 + Sync), cancel: &CancelToken) -> Option<Arrived> {
        let flux_at = &|place: usize| flux(&self.links.all()[place], self.sources[place] as usize);
        let mut harmonics = vec![IrradianceHarmonics::default(); self.harmonics_around.len()];
        let mut met = vec![Vec3::ZERO; self.stem.elements().len()];
        for targeted in &self.link_targets {
            let flux = flux_at(targeted.place) * self.weights[targeted.place].beam;
            for target in &targeted.targets {
                let place = self.stem.place(target.id().index());
                match *target {
                    Target::Cluster(_, direction) => harmonics[self.harmonics_of[place] as usize].add(flux, direction),
                    Target::Patch(_, cosine) => met[place] += cosine * flux,
                }
            }
        }
        for (number, around) in self.harmonics_around.iter().enumerate() {
            if let Some(around) = harmonics.get(*around as usize).copied() {
                harmonics[number].join(&around);
            }
        }
        let beams = self.beams(flux_at);
        let own = |(place, met): (usize, Vec3)| {
            if cancel.is_cancelled() {
                return Vec3::ZERO;
            }
            let element = &self.stem.elements()[place];
            let receiver = ElementId(element.index as u32);
            let range = self.links.range(receiver);
            let links = self.links.of(receiver).iter().zip(&self.sources[range.clone()]).zip(&self.weights[range]);
            let own: Vec3 = links.map(|((link, source), weights)| weights.even * flux(link, *source as usize)).sum();
            let is_initial = element.node.is_patch()
                && element.parent().is_some_and(|parent| self.stem.elements()[parent].node.kind == Kind::Cluster);
            if is_initial { own + met + self.pushed_to(place, &beams, &harmonics) } else { own }
        };
        let mut even: Vec<Vec3> = met.into_par_iter().enumerate().with_min_len(256).map(own).collect();
        for (place, element) in self.stem.elements().iter().enumerate() {
            if let Some(parent) = element.parent() {
                even[place] = even[parent] + even[place];
            }
        }
        (!cancel.is_cancelled()).then_some(Arrived { even, harmonics })
    }

    /// For each small cluster the light that its links bring, with where it comes from.
    fn beams(&self, flux_at: &(impl Fn(usize) -> Vec3 + Sync)) -> Vec<Vec<Beam>> {
        let of_cluster = |&(receiver, _): &(ElementId, u32)| {
            let beam = |place: usize| Beam {
                from: self.hierarchy.element(self.links.all()[place].source()).centre,
                flux: flux_at(place) * self.weights[place].beam,
            };
            self.links.range(receiver).filter(|place| self.weights[*place].beam > 0.0).map(beam).collect()
        };
        self.lit.par_iter().with_min_len(64).map(of_cluster).collect()
    }

    /// Irradiance that the clusters above an initial patch of the stem hand to it by its cosines.
    fn pushed_to(&self, place: usize, beams: &[Vec<Beam>], harmonics: &[IrradianceHarmonics]) -> Vec3 {
        let StemElement { index, node, .. } = self.stem.elements()[place];
        let around = harmonics.get(self.harmonics_of[place] as usize);
        let mut sum = around.map_or(Vec3::ZERO, |harmonics| harmonics.on(node.normal));
        let mut around = self.lit_around[place];
        while let Some(beams) = beams.get(around as usize) {
            let centre = self.hierarchy.elements()[index].centre;
            for beam in beams {
                sum += beam.flux * cosine_towards(centre, node.normal, beam.from);
            }
            around = self.lit[around as usize].1;
        }
        sum
    }

    /// Light that reaches an element of the stem: on all of its faces alike, and from far away.
    pub fn reaching<'b>(&self, arrived: &'b Arrived, place: usize) -> (Vec3, Option<&'b IrradianceHarmonics>) {
        let is_cluster = self.stem.elements()[place].node.kind == Kind::Cluster;
        let harmonics = arrived.harmonics.get(self.harmonics_of[place] as usize).filter(|_| is_cluster);
        (arrived.even[place], harmonics)
    }

    /// Irradiance of a patch, W/m², before it is scaled or limited.
    pub fn irradiance(&self, arrived: &Arrived, index: usize, normal: Vec3) -> Vec3 {
        let (even, harmonics) = self.reaching(arrived, self.stem.place(index));
        harmonics.map_or(even, |harmonics| even + harmonics.on(normal))
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
        let (weights, _) = push_weights(hierarchy, &self.normal_moments, rules, (receiver, link), 0);
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

/// Light on its way into a small cluster.
struct Beam {
    from: Vec3,
    flux: Vec3,
}
