//! The immediate push: what a cluster receives goes at once to the patches below, link by link, each patch by its cosine
//! towards the source (paper, section 3.3; the receiving half of the α-links of [Smits 94]).
//!
//! A large cluster holds many patches and has many links. To meet each patch with each link would cost more than all else: in a room of
//! 130,000 polygons three quarters of the solve. A link of a large cluster is therefore handed down the tree as far
//! as its clusters are seen from the source under more than a small angle. Smaller ones take it as a light from one direction into a
//! [`Sky`], which takes up any number of lights and tells their irradiance on a face that is turned anyhow; the skies of all
//! clusters above a patch are summed on the way down. This costs time in proportion to links and elements.

use glam::Vec3;
use rayon::prelude::*;

use super::form_factor::CLUSTER_COSINE;
use super::link::{Link, LinkTable};
use super::rules::{ClusterModel, LinkRules, Push};
use crate::cancel::CancelToken;
use crate::hierarchy::{Cluster, Element, ElementId, Hierarchy, Shape};

/// Links of clusters of up to this many patches meet each of these by itself.
const MOST_MET: usize = 64;
/// Clusters of more patches than this have a sky.
const MOST_WITHOUT_SKY: usize = 8;
/// A cluster takes a light as from one direction where the source is farther than so many of its radii.
const FAR: f32 = 3.0;

/// Hands light down over one table of links.
pub struct Pusher<'a> {
    hierarchy: &'a Hierarchy,
    links: &'a LinkTable,
    /// How each link's light is handed down, in the order of the table.
    handing: Vec<Handing>,
    /// Targets of the links of large clusters.
    spreads: Vec<Spread>,
    /// Small clusters that have links.
    lit: Vec<ElementId>,
    /// Place in `lit` of the nearest cluster around each element that is there.
    lit_around: Vec<u32>,
    /// Sky of each element: its own, or that of the nearest cluster above it that has one.
    sky_of: Vec<u32>,
    /// Clusters with a sky, parents first.
    with_sky: Vec<ElementId>,
    /// The initial patches in their order.
    faces: Vec<Face>,
}

/// What is read of each initial patch whenever light is handed down.
struct Face {
    id: ElementId,
    normal: Vec3,
    sky: u32,
    lit_around: u32,
}

/// How a link's light is handed down, in multiples of the receiver's mean irradiance.
#[derive(Clone, Copy, Debug)]
struct Handing {
    /// To a face turned to the source; each patch gets its cosine's share.
    beam: f32,
    /// To every patch, whichever way it faces.
    even: f32,
}

/// Where the light of one link of a large cluster goes.
struct Spread {
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

impl Handing {
    const EVEN: Self = Self { beam: 0.0, even: 1.0 };

    /// A beam of one over the mean cosine of the cluster's patches towards the source, so that together they get the power
    /// that the link carries. For randomly turned faces this is the 4 of the paper's model, whose mean cosine is ¼. What would
    /// give a face more than the source sends out is handed down evenly.
    ///
    /// The isotropic model has that 4 whichever way the patches are turned, so that their light may be more or less than the link's.
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

impl<'a> Pusher<'a> {
    /// Prepares to hand down the light of these links.
    pub fn new(hierarchy: &'a Hierarchy, links: &'a LinkTable, model: ClusterModel) -> Self {
        let facings = facings(hierarchy);
        let of_receiver = |receiver: usize| {
            let receiver = ElementId(receiver as u32);
            let places = links.range(receiver).zip(links.of(receiver));
            places
                .map(|(place, link)| handed(hierarchy, &facings, model, (receiver, link), place))
                .unzip::<_, _, Vec<_>, Vec<_>>()
        };
        let per_receiver: Vec<_> = (0..links.receivers()).into_par_iter().with_min_len(64).map(of_receiver).collect();
        let (mut handing, mut spreads) = (Vec::with_capacity(links.len()), Vec::new());
        for (handings, spread) in per_receiver {
            handing.extend(handings);
            spreads.extend(spread.into_iter().flatten());
        }
        let (sky_of, with_sky) = skies(hierarchy);
        let (lit, lit_around) = lit_clusters(hierarchy, links);
        let face = |&id: &ElementId| {
            let normal = match &hierarchy.element(id).shape {
                Shape::Patch(patch) => patch.normal,
                Shape::Cluster(_) | Shape::Sky(_) => Vec3::ZERO,
            };
            Face { id, normal, sky: sky_of[id.index()], lit_around: lit_around[id.index()] }
        };
        let faces = hierarchy.initial_patches().iter().map(face).collect();
        Self { hierarchy, links, handing, spreads, lit, lit_around, sky_of, with_sky, faces }
    }

    /// Share of the light of the link at this place of the table that its receiver hands to every patch alike.
    pub fn share_handed_evenly(&self, place: usize) -> f32 {
        self.handing[place].even
    }

    /// What the clusters above hand to each initial patch by its cosines, W/m², where each link brings `flux`; anything if cancelled.
    pub fn push(&self, flux: &(impl Fn(&Link) -> Vec3 + Sync), cancel: &CancelToken) -> Vec<Vec3> {
        let mut skies = vec![Sky::default(); self.with_sky.len()];
        let mut met = vec![Vec3::ZERO; if self.spreads.is_empty() { 0 } else { self.hierarchy.elements().len() }];
        for spread in &self.spreads {
            let flux = flux(&self.links.all()[spread.place]) * self.handing[spread.place].beam;
            for target in &spread.targets {
                match *target {
                    Target::Cluster(id, direction) => skies[self.sky_of[id.index()] as usize].add(flux, direction),
                    Target::Patch(id, cosine) => met[id.index()] += cosine * flux,
                }
            }
        }
        for (index, &id) in self.with_sky.iter().enumerate() {
            let above = self.hierarchy.element(id).parent().map(|parent| self.sky_of[parent.index()]);
            if let Some(above) = above.filter(|above| *above != NONE) {
                let above = skies[above as usize];
                skies[index].join(&above);
            }
        }
        let beams = self.beams(flux);
        let pushed_to = |face: &Face| {
            if cancel.is_cancelled() {
                return Vec3::ZERO;
            }
            met.get(face.id.index()).copied().unwrap_or_default() + self.pushed_to(face, &beams, &skies)
        };
        self.faces.par_iter().with_min_len(256).map(pushed_to).collect()
    }

    /// For each small cluster the light that its links bring, with where it comes from.
    fn beams(&self, flux: &(impl Fn(&Link) -> Vec3 + Sync)) -> Vec<Vec<Beam>> {
        let of_cluster = |&receiver: &ElementId| {
            let links = self.links.range(receiver).zip(self.links.of(receiver));
            let beam = |(place, link): (usize, &Link)| Beam {
                from: self.hierarchy.element(link.source()).centre,
                flux: flux(link) * self.handing[place].beam,
            };
            links.filter(|(place, _)| self.handing[*place].beam > 0.0).map(beam).collect()
        };
        self.lit.par_iter().with_min_len(64).map(of_cluster).collect()
    }

    fn pushed_to(&self, face: &Face, beams: &[Vec<Beam>], skies: &[Sky]) -> Vec3 {
        let mut sum = skies.get(face.sky as usize).map_or(Vec3::ZERO, |sky| sky.on(face.normal));
        let mut around = face.lit_around;
        while let Some(beams) = beams.get(around as usize) {
            let centre = self.hierarchy.element(face.id).centre;
            for beam in beams {
                sum += beam.flux * cosine_towards(centre, face.normal, beam.from);
            }
            around = self.lit_around[self.lit[around as usize].index()];
        }
        sum
    }
}

/// Tells what single links hand down to one leaf: the patch's own cosine stands for that of the clusters around it.
pub struct Inspector<'a> {
    hierarchy: &'a Hierarchy,
    rules: &'a LinkRules,
    facings: Vec<Facing>,
}

impl<'a> Inspector<'a> {
    /// Prepares to look at any number of links.
    pub fn new(hierarchy: &'a Hierarchy, rules: &'a LinkRules) -> Self {
        Self { hierarchy, rules, facings: facings(hierarchy) }
    }

    /// What a link at `receiver`, which brings it `flux` (W/m²), hands down to an element below: a cluster's to the initial patch by that
    /// one's cosine, to a cluster below by the mean cosine of its patches.
    pub fn handed_down(&self, (receiver, link): (ElementId, &Link), flux: Vec3, below: ElementId) -> Vec3 {
        let (hierarchy, rules) = (self.hierarchy, self.rules);
        if rules.push == Push::Deferred || !hierarchy.element(receiver).is_cluster() {
            return flux;
        }
        let (handing, _) = handed(hierarchy, &self.facings, rules.cluster_model, (receiver, link), 0);
        let initial = std::iter::successors(Some(below), |&id| {
            hierarchy.element(id).parent().filter(|&parent| !hierarchy.element(parent).is_cluster())
        });
        let element = hierarchy.element(initial.last().unwrap_or(below));
        let from = hierarchy.element(link.source()).centre;
        match element.shape {
            Shape::Patch(_) => flux * (handing.even + handing.beam * cosine_of(element, from)),
            Shape::Cluster(cluster) => {
                let patches = hierarchy.patches_below(&cluster).iter().map(|&id| hierarchy.element(id));
                let seen: f32 = patches.map(|patch| patch.area * cosine_of(patch, from)).sum();
                let mean = if element.area > 0.0 { seen / element.area } else { 0.0 };
                flux * (handing.even + handing.beam * mean)
            }
            Shape::Sky(_) => Vec3::ZERO,
        }
    }
}

/// How a link is handed down, and to which parts of a large cluster.
fn handed(
    hierarchy: &Hierarchy,
    facings: &[Facing],
    model: ClusterModel,
    (receiver, link): (ElementId, &Link),
    place: usize,
) -> (Handing, Option<Spread>) {
    let element = hierarchy.element(receiver);
    let Shape::Cluster(cluster) = &element.shape else { return (Handing::EVEN, None) };
    // A self-link has no direction.
    if link.source() == receiver || element.area <= 0.0 {
        return (Handing::EVEN, None);
    }
    let from = hierarchy.element(link.source()).centre;
    if meets_each(hierarchy, cluster) {
        let below = hierarchy.patches_below(cluster).iter().map(|&id| hierarchy.element(id));
        let seen = below.map(|patch| patch.area * cosine_of(patch, from));
        return (Handing::new(model, seen.sum::<f32>() / element.area, link), None);
    }
    let mut targets = Vec::new();
    let seen = spread(hierarchy, facings, receiver, from, &mut targets);
    let handing = Handing::new(model, seen / element.area, link);
    let spread = (handing.beam > 0.0).then_some(Spread { place, targets });
    (handing, spread)
}

/// Finds the parts of a cluster that take a light from a point; returns the sum of their areas times mean cosines, m².
fn spread(hierarchy: &Hierarchy, facings: &[Facing], id: ElementId, from: Vec3, targets: &mut Vec<Target>) -> f32 {
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
            if is_far && has_sky(hierarchy, cluster) {
                let direction = towards.normalize();
                targets.push(Target::Cluster(id, direction));
                return element.area * facings[id.index()].mean_cosine(direction);
            }
            element.children().map(|child| spread(hierarchy, facings, child, from, targets)).sum()
        }
        Shape::Sky(_) => 0.0,
    }
}

fn meets_each(hierarchy: &Hierarchy, cluster: &Cluster) -> bool {
    hierarchy.patches_below(cluster).len() <= MOST_MET
}

fn has_sky(hierarchy: &Hierarchy, cluster: &Cluster) -> bool {
    hierarchy.patches_below(cluster).len() > MOST_WITHOUT_SKY
}

/// The small clusters that have links, and the nearest of them around each element.
fn lit_clusters(hierarchy: &Hierarchy, links: &LinkTable) -> (Vec<ElementId>, Vec<u32>) {
    let mut place_of = vec![NONE; hierarchy.elements().len()];
    let mut around = vec![NONE; hierarchy.elements().len()];
    let mut lit = Vec::new();
    for id in hierarchy.ids() {
        let element = hierarchy.element(id);
        if let Some(parent) = element.parent() {
            let own = place_of[parent.index()];
            around[id.index()] = if own == NONE { around[parent.index()] } else { own };
        }
        if let Shape::Cluster(cluster) = &element.shape
            && meets_each(hierarchy, cluster)
            && !links.of(id).is_empty()
        {
            place_of[id.index()] = lit.len() as u32;
            lit.push(id);
        }
    }
    (lit, around)
}

/// The sky that each element stands under, and the clusters that have one.
fn skies(hierarchy: &Hierarchy) -> (Vec<u32>, Vec<ElementId>) {
    let mut sky_of = vec![NONE; hierarchy.elements().len()];
    let mut with_sky = Vec::new();
    for id in hierarchy.ids() {
        let element = hierarchy.element(id);
        sky_of[id.index()] = match &element.shape {
            Shape::Cluster(cluster) if has_sky(hierarchy, cluster) => {
                with_sky.push(id);
                with_sky.len() as u32 - 1
            }
            _ => element.parent().map_or(NONE, |parent| sky_of[parent.index()]),
        };
    }
    (sky_of, with_sky)
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

/// The positive cosine max(0, x) as c₀ + c₁x + c₂x², its expansion in spherical harmonics up to the second order: off by 6 % of
/// the full cosine at most, and by nothing in the mean over all directions [Ramamoorthi, Hanrahan 2001].
const COSINE: [f32; 3] = [3.0 / 32.0, 0.5, 15.0 / 32.0];

/// Products of the coordinates of a direction: xx, yy, zz, 2xy, 2yz, 2zx.
fn products(direction: Vec3) -> [f32; 6] {
    let Vec3 { x, y, z } = direction;
    [x * x, y * y, z * z, 2.0 * x * y, 2.0 * y * z, 2.0 * z * x]
}

/// Lights from far away, summed so that their irradiance on a face of any direction is one polynomial of its normal.
#[derive(Clone, Copy, Default)]
struct Sky {
    constant: Vec3,
    linear: [Vec3; 3],
    square: [Vec3; 6],
}

impl Sky {
    /// Adds a light that brings `flux` (W/m²) to a face turned to it.
    fn add(&mut self, flux: Vec3, direction: Vec3) {
        self.constant += COSINE[0] * flux;
        for (sum, component) in self.linear.iter_mut().zip(direction.to_array()) {
            *sum += COSINE[1] * component * flux;
        }
        let [xx, yy, zz, xy, yz, zx] = products(direction);
        // Mixed products count twice in the square, once here and once in the face's own.
        for (sum, product) in self.square.iter_mut().zip([xx, yy, zz, 0.5 * xy, 0.5 * yz, 0.5 * zx]) {
            *sum += COSINE[2] * product * flux;
        }
    }

    fn join(&mut self, other: &Self) {
        self.constant += other.constant;
        self.linear.iter_mut().zip(other.linear).for_each(|(sum, term)| *sum += term);
        self.square.iter_mut().zip(other.square).for_each(|(sum, term)| *sum += term);
    }

    /// Irradiance of a face with this normal, W/m²; may be a little less than none on one turned away from all light.
    fn on(&self, normal: Vec3) -> Vec3 {
        let linear = self.linear.iter().zip(normal.to_array()).map(|(term, component)| *term * component).sum::<Vec3>();
        let square = self.square.iter().zip(products(normal)).map(|(term, product)| *term * product).sum::<Vec3>();
        self.constant + linear + square
    }
}

/// How the patches of a cluster are turned: means over their area.
#[derive(Clone, Copy, Default)]
struct Facing {
    normal: Vec3,
    products: [f32; 6],
}

impl Facing {
    /// Mean positive cosine of the patches towards a direction, as a [`Sky`] gives it.
    fn mean_cosine(&self, direction: Vec3) -> f32 {
        let [xx, yy, zz, xy, yz, zx] = products(direction);
        let halved = [xx, yy, zz, 0.5 * xy, 0.5 * yz, 0.5 * zx];
        let square = self.products.iter().zip(halved).map(|(mean, product)| mean * product).sum::<f32>();
        COSINE[0] + COSINE[1] * self.normal.dot(direction) + COSINE[2] * square
    }
}

/// The facings of all clusters, parallel to the arena.
fn facings(hierarchy: &Hierarchy) -> Vec<Facing> {
    let elements = hierarchy.elements();
    let mut facings = vec![Facing::default(); elements.len()];
    for (index, element) in elements.iter().enumerate().rev() {
        let (facing, is_initial) = match &element.shape {
            Shape::Patch(patch) => {
                (Facing { normal: patch.normal, products: products(patch.normal) }, patch.level == 0)
            }
            Shape::Cluster(_) => (facings[index], true),
            Shape::Sky(_) => continue,
        };
        let Some(parent) = element.parent().filter(|_| is_initial) else { continue };
        let parent_area = hierarchy.element(parent).area;
        if parent_area > 0.0 {
            let share = element.area / parent_area;
            let sum = &mut facings[parent.index()];
            sum.normal += share * facing.normal;
            sum.products.iter_mut().zip(facing.products).for_each(|(sum, product)| *sum += share * product);
        }
    }
    facings
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Truth: the cosine itself, and its mean over all directions, ¼.
    #[test]
    fn a_sky_lights_faces_by_their_cosine() {
        let light = Vec3::new(0.36, 0.48, 0.8);
        let mut sky = Sky::default();
        sky.add(Vec3::splat(2.0), light);
        let (mut mean, count) = (0.0, 4000);
        for index in 0..count {
            // Fibonacci's sphere.
            let height = 1.0 - (2 * index + 1) as f32 / count as f32;
            let (sine, cosine) = (2.399_963_2 * index as f32).sin_cos();
            let radius = (1.0 - height * height).sqrt();
            let normal = Vec3::new(radius * cosine, radius * sine, height);
            let found = sky.on(normal).x;
            assert!((found - 2.0 * normal.dot(light).max(0.0)).abs() < 2.0 * 0.1, "{normal}: {found}");
            mean += found / count as f32;
        }
        assert!((mean - 0.5).abs() < 0.01, "{mean}");
        let facing = Facing { normal: light, products: products(light) };
        assert!((2.0 * facing.mean_cosine(light) - sky.on(light).x).abs() < 1e-6);
    }
}
