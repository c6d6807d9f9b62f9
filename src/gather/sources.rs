//! Sources that gathers aim rays at: emitters, and small surfaces that reflect so much that random
//! rays would rarely meet what decides about a point's light.
//!
//! Both lie in the cluster tree with their powers, so a point finds what matters to it by going
//! down from the root [after Walter et al., *Lightcuts*, SIGGRAPH 2005]: a cluster that is small
//! for its distance is one source, a near polygon is one by its exact form factor, and rays are
//! shared out by what each could send.

use std::f32::consts::PI;

use glam::Vec3;
use rayon::prelude::*;

use super::facet::Facet;
use super::field::{CHUNK, Field, Met};
use super::source_tree::SourceTree;
use crate::base::random::{fraction, hash64, r2_sequence};
use crate::geometry::LastStop;
use crate::hierarchy::{Element, ElementId, Hierarchy, Shape};
use crate::scene::Surface;

/// A cluster whose half diagonal is below this share of its distance is one source.
const SMALL: f32 = 0.1;
/// A secondary emitter is aimed at from where its form factor is below this; from nearer, random
/// rays meet it often enough and find where on it there is how much light. Above π·SMALL²/3, so
/// that what lies in a small cluster is always aimed at.
const AIMED_FORM_FACTOR: f32 = 0.02;
/// A leaf that reflects so many times the area's mean is a secondary emitter.
const BRIGHT: f32 = 6.0;

/// Emitters and secondary emitters of a field.
pub struct Sources {
    /// Power of each element, W (largest colour); emission and what secondary emitters reflect.
    pub(super) power: Vec<f32>,
    /// Mean reflected radiosity of each leaf that is a secondary emitter, W/m² (largest colour); 0
    /// for all others.
    secondary: Vec<f32>,
    /// The elements that send light: what a point chooses among.
    pub(super) tree: SourceTree,
}

/// A source that a point aims at, with the light that it could send (W/m², largest colour).
#[derive(Clone, Copy, Debug)]
pub struct Aim {
    at: Target,
    most: f32,
    /// Samples drawn so far.
    drawn: u32,
}

#[derive(Clone, Copy, Debug)]
enum Target {
    /// A cluster of sources, small for its distance.
    Cluster(ElementId),
    /// A polygon that emits, an initial patch.
    Emitter(ElementId, Facet),
    /// A leaf that is a secondary emitter.
    Secondary(ElementId, Facet),
}

impl Sources {
    /// The emitters alone.
    pub fn emitters(hierarchy: &Hierarchy, surfaces: &[Surface]) -> Self {
        Self::new(hierarchy, surfaces, vec![0.0; hierarchy.elements().len()])
    }

    /// Emitters, and leaves that reflect much more than the area's mean (`reflected`, W/m²,
    /// parallel to the hierarchy's arena).
    pub fn with_secondary(hierarchy: &Hierarchy, surfaces: &[Surface], reflected: &[Vec3]) -> Self {
        let (mut sent, mut area) = (0.0, 0.0);
        for (element, reflected) in hierarchy.elements().iter().zip(reflected) {
            if element.is_leaf() && element.is_patch() {
                sent += f64::from(element.area * reflected.max_element());
                area += f64::from(element.area);
            }
        }
        let least = BRIGHT * (sent / f64::max(area, f64::MIN_POSITIVE)) as f32;
        let sent = reflected.iter().map(|reflected| reflected.max_element());
        Self::new(hierarchy, surfaces, sent.map(|sent| if sent > least { sent } else { 0.0 }).collect())
    }

    fn new(hierarchy: &Hierarchy, surfaces: &[Surface], secondary: Vec<f32>) -> Self {
        let elements = hierarchy.elements();
        let of_leaf = |(element, secondary): (&Element, &f32)| match &element.shape {
            Shape::Patch(patch) if element.is_leaf() => {
                element.sampled_area * (surfaces[patch.polygon as usize].emission.max_element() + secondary)
            }
            _ => 0.0,
        };
        let mut power: Vec<f32> = elements.par_iter().zip(&secondary).with_min_len(CHUNK).map(of_leaf).collect();
        let with_children = |index: &usize| !elements[*index].is_leaf();
        let inner: Vec<usize> = (0..elements.len()).into_par_iter().with_min_len(CHUNK).filter(with_children).collect();
        for index in inner.into_iter().rev() {
            power[index] = elements[index].children().map(|child| power[child.index()]).sum();
        }
        let tree = SourceTree::new(hierarchy, surfaces, &power);
        Self { power, secondary, tree }
    }

    /// Memory, bytes.
    pub fn bytes(&self) -> usize {
        size_of_val(&self.power[..]) + size_of_val(&self.secondary[..]) + self.tree.bytes()
    }
}

impl Field {
    /// Finds the sources that a point with this unit normal aims at; `aims` is emptied first.
    pub fn find_aims(&self, point: Vec3, normal: Vec3, aims: &mut Vec<Aim>) {
        aims.clear();
        self.collect(Hierarchy::ROOT, point, normal, aims);
    }

    fn collect(&self, id: ElementId, point: Vec3, normal: Vec3, aims: &mut Vec<Aim>) {
        let power = self.sources.power[id.index()];
        if power <= 0.0 {
            return;
        }
        let hierarchy = &self.hierarchy;
        let element = hierarchy.element(id);
        match &element.shape {
            Shape::Cluster(cluster) => {
                let span = element.centre - point;
                if normal.dot(span) + normal.abs().dot(cluster.half_extent) <= 0.0 {
                    return;
                }
                let distance_squared = span.length_squared();
                if cluster.half_extent.length_squared() < SMALL * SMALL * distance_squared {
                    let cosine = (normal.dot(span) / distance_squared.sqrt()).max(SMALL);
                    let most = power * cosine / (PI * distance_squared);
                    aims.push(Aim { at: Target::Cluster(id), most, drawn: 0 });
                } else {
                    element.children().for_each(|child| self.collect(child, point, normal, aims));
                }
            }
            Shape::Patch(patch) => {
                let emission = self.surface(patch.polygon).emission.max_element();
                if patch.level == 0
                    && emission > 0.0
                    && let Some(facet) = self.facet(id, point, normal)
                {
                    let most = facet.form_factor * emission;
                    aims.push(Aim { at: Target::Emitter(id, facet), most, drawn: 0 });
                }
                self.collect_secondary(id, point, normal, aims);
            }
            // Aimed at by rays of its own.
            Shape::Sky(_) => {}
        }
    }

    fn collect_secondary(&self, id: ElementId, point: Vec3, normal: Vec3, aims: &mut Vec<Aim>) {
        let element = self.hierarchy.element(id);
        if !element.is_leaf() {
            if self.sources.power[id.index()] > 0.0 {
                element.children().for_each(|child| self.collect_secondary(child, point, normal, aims));
            }
            return;
        }
        let sent = self.sources.secondary[id.index()];
        if sent > 0.0
            && let Some(facet) = self.facet(id, point, normal)
            && (self.is_small(id, point) || facet.form_factor < AIMED_FORM_FACTOR)
        {
            aims.push(Aim { at: Target::Secondary(id, facet), most: facet.form_factor * sent, drawn: 0 });
        }
    }

    /// Whether a point aims at this leaf for what it reflects, so that random rays which meet it
    /// must not count.
    pub fn is_aimed_at(&self, leaf: ElementId, point: Vec3, normal: Vec3) -> bool {
        self.sources.secondary[leaf.index()] > 0.0
            && (self.is_small(leaf, point) || self.has_small_facet(leaf, point, normal))
    }

    /// Whether a leaf is so far away that its form factor must be small.
    fn is_small(&self, leaf: ElementId, point: Vec3) -> bool {
        let element = self.hierarchy.element(leaf);
        // Within a radius of twice the root of its area it has all of it, unless it is a sliver.
        element.area < 0.25 * AIMED_FORM_FACTOR * PI * element.centre.distance_squared(point)
    }

    fn has_small_facet(&self, leaf: ElementId, point: Vec3, normal: Vec3) -> bool {
        self.facet(leaf, point, normal).is_none_or(|facet| facet.form_factor < AIMED_FORM_FACTOR)
    }

    fn facet(&self, id: ElementId, point: Vec3, normal: Vec3) -> Option<Facet> {
        let element = self.hierarchy.element(id);
        let Shape::Patch(patch) = &element.shape else { return None };
        if patch.normal.dot(point - element.centre) <= 0.0 {
            return None;
        }
        let (corners, count) = self.hierarchy.corner_positions(patch);
        Facet::new(point, normal, &corners[..count])
    }

    /// Casts about so many rays at what a point aims at. Returns the irradiance that emission
    /// brings (W/m²) and the rays cast; `reflected` gets each place on a secondary emitter that is
    /// seen, and the share of its reflected radiosity that reaches the point.
    pub fn aim(
        &self,
        (point, normal): (Vec3, Vec3),
        aims: &mut [Aim],
        rays: f32,
        seed: u64,
        reflected: &mut impl FnMut(Met, f32),
    ) -> (Vec3, u32) {
        let total: f32 = aims.iter().map(|aim| aim.most).sum();
        let (mut light, mut cast) = (Vec3::ZERO, 0);
        if total <= 0.0 {
            return (light, cast);
        }
        // What deserves less than a ray gets one by chance; the chances are dealt out in turn, so
        // that as many get one as there should.
        let mut dealt = fraction(hash64(seed, 1) as u32);
        for (index, aim) in aims.iter_mut().enumerate() {
            let wanted = rays * aim.most / total;
            let chance = wanted.min(1.0);
            dealt += chance;
            if dealt < 1.0 {
                continue;
            }
            dealt -= 1.0;
            let count = wanted.ceil().max(1.0) as u32;
            let first = aim.drawn;
            aim.drawn += count;
            let seed = hash64(seed >> 32, index as u64);
            let (emitted, rays) = match &aim.at {
                Target::Cluster(id) => {
                    self.aim_at_cluster((point, normal), *id, (seed, first, count), &mut |met, weight| {
                        reflected(met, weight / chance)
                    })
                }
                Target::Emitter(id, facet) => {
                    let mut share = 0.0;
                    let cast =
                        self.aim_at_facet((point, normal), *id, facet, (seed, first, count), &mut |_, weight| {
                            share += weight
                        });
                    (share * self.surface(self.patch(*id).polygon).emission, cast)
                }
                Target::Secondary(id, facet) => {
                    let tell = &mut |position: Vec3, weight: f32| {
                        reflected(Met { leaf: *id, position }, weight / chance);
                    };
                    (Vec3::ZERO, self.aim_at_facet((point, normal), *id, facet, (seed, first, count), tell))
                }
            };
            light += emitted / chance;
            cast += rays;
        }
        (light, cast)
    }

    /// Tells each place of a facet that is seen and its share of the light: the exact form factor,
    /// shared out by kernels [a ratio of estimates, as Heitz, Hill, McGuire, *Combining analytic
    /// direct illumination and stochastic shadows*, I3D 2018], so that light without a shadow has
    /// no noise.
    fn aim_at_facet(
        &self,
        (point, normal): (Vec3, Vec3),
        id: ElementId,
        facet: &Facet,
        (seed, first, count): (u64, u32, u32),
        tell: &mut impl FnMut(Vec3, f32),
    ) -> u32 {
        let Shape::Patch(patch) = &self.hierarchy.element(id).shape else { return 0 };
        let sampler = facet.samples(normal, patch.normal);
        let sample = |index: u32| sampler.at(r2_sequence(seed, first + index));
        let all: f32 = (0..count).map(|index| sample(index).kernel).sum();
        if all <= 0.0 {
            return 0;
        }
        let (mut cast, mut last) = (0, LastStop::default());
        for index in 0..count {
            let sample = sample(index);
            if sample.kernel <= 0.0 {
                continue;
            }
            cast += 1;
            let position = self.on_plane(id, point + sample.span);
            if self.sees(&mut last, (point, normal), (position, patch.normal)) {
                tell(position, facet.form_factor * sample.kernel / all);
            }
        }
        cast
    }

    fn aim_at_cluster(
        &self,
        (point, normal): (Vec3, Vec3),
        id: ElementId,
        (seed, first, count): (u64, u32, u32),
        reflected: &mut impl FnMut(Met, f32),
    ) -> (Vec3, u32) {
        let (mut light, mut cast, mut last) = (Vec3::ZERO, 0, LastStop::default());
        for index in 0..count {
            let [u, v] = r2_sequence(seed, first + index);
            let (leaf, u) = self.pick_leaf(id, u);
            let target = self.hierarchy.point_on(leaf, u, v);
            let span = target.position - point;
            let square = span.length_squared();
            let cosines = normal.dot(span).max(0.0) * (-target.normal.dot(span)).max(0.0);
            if cosines <= 0.0 || square <= 0.0 {
                continue;
            }
            cast += 1;
            if !self.sees(&mut last, (point, normal), (target.position, target.normal)) {
                continue;
            }
            let emission = self.surface(target.polygon).emission;
            let secondary = self.sources.secondary[leaf.index()];
            // Points lie by power, so each stands for all of it.
            let density = (emission.max_element() + secondary) / self.sources.power[id.index()];
            let weight = cosines / (PI * square * square * density * count as f32);
            light += weight * emission;
            if secondary > 0.0 {
                reflected(Met { leaf, position: target.position }, weight);
            }
        }
        (light, cast)
    }

    /// The leaf at `u` of an element's power, and how far `u` is into it, 0..=1.
    fn pick_leaf(&self, mut id: ElementId, mut u: f32) -> (ElementId, f32) {
        let (hierarchy, power) = (&self.hierarchy, &self.sources.power);
        while !hierarchy.element(id).is_leaf() {
            let mut rest = u * power[id.index()];
            let mut children = hierarchy.element(id).children().filter(|child| power[child.index()] > 0.0);
            let Some(mut child) = children.next() else { break };
            for next in children {
                if rest < power[child.index()] {
                    break;
                }
                rest -= power[child.index()];
                child = next;
            }
            u = (rest / power[child.index()]).clamp(0.0, 1.0);
            id = child;
        }
        (id, u)
    }
}
