//! Gather, push and pull: one sweep moves light once across every link (paper, sections 1.2 and
//! 3.3).

use glam::Vec3;
use rayon::prelude::*;

use super::entering::is_sky;
use super::harmonics::{NormalMoments, ReflectionMoments};
use super::link::{Link, LinkTable, VisibilitySource};
use super::nodes::{CHUNK, Kind, Nodes};
use super::push::{Arrived, Pusher};
use super::rules::LinkRules;
use crate::base::cancel::CancelToken;
use crate::base::mixing::Mixing;
use crate::hierarchy::{ElementId, Hierarchy, Shape};
use crate::scene::Surface;

/// Radiosities and irradiances of all elements, parallel to the arena.
#[derive(Clone, Debug, Default)]
pub struct Light {
    /// Radiosity B, W/m².
    pub radiosity: Vec<Vec3>,
    /// Irradiance E, W/m²; meant for leaves, on other elements what reached them from above.
    pub irradiance: Vec<Vec3>,
    /// Emitted part of B, W/m².
    pub emitted: Vec<Vec3>,
    /// Factor on each leaf's irradiance; empty before the first [`Gatherer::enforce_closure`].
    pub row_scale: Vec<f32>,
}

impl Light {
    /// Extends the tables to new elements, which start with their parent's light; what lies outside
    /// has its own.
    pub fn grow(&mut self, hierarchy: &Hierarchy) {
        for id in (self.radiosity.len()..hierarchy.elements().len()).map(|index| ElementId(index as u32)) {
            let parent = hierarchy.element(id).parent().map(ElementId::index);
            let inherited = |table: &[Vec3]| parent.map_or(Vec3::ZERO, |parent| table[parent]);
            let [radiosity, irradiance, emitted] = match hierarchy.element(id).shape {
                Shape::Sky(number) => {
                    let radiosity = hierarchy.sky_part(number).radiosity;
                    [radiosity, Vec3::ZERO, radiosity]
                }
                _ => [&self.radiosity, &self.irradiance, &self.emitted].map(|table| inherited(table)),
            };
            self.radiosity.push(radiosity);
            self.irradiance.push(irradiance);
            self.emitted.push(emitted);
        }
    }

    /// Forgets all but the first so many elements.
    pub fn truncate(&mut self, elements: usize) {
        for table in [&mut self.radiosity, &mut self.irradiance, &mut self.emitted] {
            table.truncate(elements);
        }
        self.row_scale.truncate(elements);
    }

    /// Memory of the tables, bytes.
    pub fn bytes(&self) -> usize {
        size_of_val(&self.radiosity[..])
            + size_of_val(&self.irradiance[..])
            + size_of_val(&self.emitted[..])
            + size_of_val(&self.row_scale[..])
    }
}

/// Moves light over a table of links.
pub struct Gatherer<'a> {
    hierarchy: &'a Hierarchy,
    pub(super) surfaces: &'a [Surface],
    with_unjudged: bool,
    pub(super) nodes: Nodes,
    pub(super) pusher: Pusher<'a>,
}

/// An element on the rim of the stem.
struct Rim {
    /// Place of the element in the stem.
    place: usize,
    /// Moments of the reflectances of the element's faces.
    moments: ReflectionMoments,
}

/// Where ρ times a patch's sum of F·V stays below this, light dies out however often it is
/// reflected.
pub const LARGEST_RETURN: f32 = 0.98;

impl<'a> Gatherer<'a> {
    /// Prepares to move light over `links`, to polygons of these `surfaces` and clusters with these
    /// `normal_moments`; `with_unjudged` tells whether links that no ray has judged carry light.
    pub fn new(
        hierarchy: &'a Hierarchy,
        links: &'a LinkTable,
        (surfaces, normal_moments): (&'a [Surface], &[NormalMoments]),
        rules: &LinkRules,
        with_unjudged: bool,
    ) -> Self {
        let nodes = Nodes::new(hierarchy);
        let pusher = Pusher::new(hierarchy, links, normal_moments, rules, &nodes);
        Self { hierarchy, surfaces, with_unjudged, nodes, pusher }
    }

    /// Sweeps until the power still to come is below `tolerance` of all power; false if cancelled,
    /// with `light` as it was.
    ///
    /// A reflection keeps the mean reflectance ρ̄ of what it reflects, so that ρ̄/(1−ρ̄) times the
    /// last change is still to come. Sweeps pass over the stem of the tree, and start from a
    /// [mixture](Mixing) of the ones before; the last one reaches all the rest.
    pub fn converge(&self, light: &mut Light, tolerance: f64, most_sweeps: u32, cancel: &CancelToken) -> bool {
        let stem = self.pusher.stem();
        let rims = self.rims(&light.row_scale);
        let emitted = stem.of(&light.emitted);
        let mut radiosity = stem.of(&light.radiosity);
        let mut weights = vec![0.0; radiosity.len()];
        rims.iter().for_each(|rim| weights[rim.place] = stem.elements()[rim.place].node.area);
        let mut mixing = Mixing::default();
        for sweep in 1..=most_sweeps {
            let Some(arrived) = self.arrive(&radiosity, &emitted, cancel) else { return false };
            let from = radiosity.clone();
            let change = self.reflect(&rims, &arrived, &emitted, &mut radiosity);
            if change.to_come() <= tolerance * change.power || sweep == most_sweeps {
                tracing::debug!(sweep, "light converged");
                self.spread(&arrived, light);
                break;
            }
            radiosity = mixing.next(&weights, &from, radiosity);
        }
        true
    }

    /// Irradiance that emitted light and the sun alone bring over the links, parallel to the arena,
    /// W/m²; `None` if cancelled.
    pub fn direct(&self, light: &Light, cancel: &CancelToken) -> Option<Vec<Vec3>> {
        let stem = self.pusher.stem();
        let mut emitted = stem.of(&light.emitted);
        for (emitted, element) in emitted.iter_mut().zip(stem.elements()) {
            if is_sky(self.hierarchy, ElementId(element.index as u32)) {
                *emitted = Vec3::ZERO;
            }
        }
        let mut direct = light.clone();
        self.spread(&self.arrive(&emitted, &emitted, cancel)?, &mut direct);
        Some(direct.irradiance)
    }

    /// The light that reaches the stem, of whose elements these are the radiosities and what of
    /// them is emitted, W/m²; `None` if cancelled.
    pub(super) fn arrive(&self, radiosity: &[Vec3], emitted: &[Vec3], cancel: &CancelToken) -> Option<Arrived> {
        let flux = |link: &Link, source: usize| {
            let carries = self.with_unjudged || link.visibility_source() != VisibilitySource::None;
            if carries { link.irradiance(radiosity[source], emitted[source]) } else { Vec3::ZERO }
        };
        self.pusher.push(&flux, cancel)
    }

    /// Elements on the rim with the light that they reflect, each leaf's irradiance scaled by its
    /// factor.
    fn rims(&self, row_scale: &[f32]) -> Vec<Rim> {
        let elements = self.pusher.stem().elements();
        let rim = |place: usize| {
            let element = &elements[place];
            let mut moments = ReflectionMoments::default();
            let mut add = |id: ElementId, share: f32| {
                let node = &self.nodes.all()[id.index()];
                let reflectance = self.surfaces[node.polygon as usize].reflectance;
                moments.add(share * self.mean_scale(id, row_scale) * reflectance, node.normal);
            };
            let id = ElementId(element.index as u32);
            match &self.hierarchy.element(id).shape {
                Shape::Cluster(cluster) if element.node.area > 0.0 => {
                    let patches = self.hierarchy.patches_below(cluster).iter();
                    patches.for_each(|id| add(*id, self.nodes.all()[id.index()].area / element.node.area));
                }
                Shape::Patch(_) => add(id, 1.0),
                Shape::Cluster(_) | Shape::Sky(_) => {}
            }
            Rim { place, moments }
        };
        let is_lit = |place: &usize| elements[*place].is_rim && elements[*place].node.kind != Kind::Sky;
        (0..elements.len()).into_par_iter().with_min_len(64).filter(is_lit).map(rim).collect()
    }

    /// Factor on a patch's irradiance, in the mean over the area of its leaves.
    fn mean_scale(&self, id: ElementId, row_scale: &[f32]) -> f32 {
        let node = &self.nodes.all()[id.index()];
        if node.area <= 0.0 {
            // Hidden wholly: what the elements above hand down does not reach it.
            return 0.0;
        }
        if node.kind == Kind::Leaf {
            return row_scale.get(id.index()).copied().unwrap_or(1.0);
        }
        let children = self.hierarchy.element(id).children();
        children.map(|child| self.nodes.all()[child.index()].area * self.mean_scale(child, row_scale)).sum::<f32>()
            / node.area
    }

    /// Reflects on the rim what has arrived, and pulls it up the stem.
    fn reflect(&self, rims: &[Rim], arrived: &Arrived, emitted: &[Vec3], radiosity: &mut [Vec3]) -> Change {
        let stem = self.pusher.stem();
        let of_chunk = |rims: &[Rim]| {
            let mut change = Change::default();
            let reflect = |Rim { place, moments }: &Rim| {
                let (even, harmonics) = self.pusher.reaching(arrived, *place);
                let reflected = moments.reflected(even, harmonics).max(Vec3::ZERO);
                let new = emitted[*place] + reflected;
                change.note(stem.elements()[*place].node.area, [radiosity[*place], new], (reflected, moments.mean()));
                new
            };
            (rims.iter().map(reflect).collect::<Vec<_>>(), change)
        };
        let chunks: Vec<_> = rims.par_chunks(CHUNK / 8).map(of_chunk).collect();
        let mut change = Change::default();
        for (rims, (new, changed)) in rims.chunks(CHUNK / 8).zip(chunks) {
            rims.iter().zip(new).for_each(|(rim, new)| radiosity[rim.place] = new);
            change = change.and(changed);
        }
        stem.pull(radiosity);
        change
    }

    /// Gives all patches what has arrived, lets the leaves reflect it, and pulls that up the tree.
    fn spread(&self, arrived: &Arrived, light: &mut Light) {
        let Light { radiosity, irradiance, row_scale, .. } = light;
        let reflect = |(chunk, (irradiance, radiosity)): (usize, (&mut [Vec3], &mut [Vec3]))| {
            for (index, (irradiance, radiosity)) in (chunk * CHUNK..).zip(irradiance.iter_mut().zip(radiosity)) {
                let node = &self.nodes.all()[index];
                if !node.is_patch() {
                    continue;
                }
                *irradiance = self.pusher.irradiance(arrived, index, node.normal);
                if node.kind == Kind::Leaf {
                    let scale = row_scale.get(index).copied().unwrap_or(1.0);
                    let scale = if node.area > 0.0 { scale } else { 0.0 };
                    *irradiance = (scale * *irradiance).max(Vec3::ZERO);
                    let surface = &self.surfaces[node.polygon as usize];
                    *radiosity = surface.emission + surface.reflectance * *irradiance;
                }
            }
        };
        let chunks = irradiance.par_chunks_mut(CHUNK).zip(radiosity.par_chunks_mut(CHUNK)).enumerate();
        chunks.for_each(reflect);
        self.nodes.pull(radiosity);
    }
}

/// How much one sweep moved.
#[derive(Default)]
pub struct Change {
    /// Σ A·|ΔB| over leaves, W.
    moved: f64,
    /// Σ A·B over leaves, W.
    pub power: f64,
    /// Σ A·ρ·E over leaves, W, and what of that they would reflect themselves.
    reflected: f64,
    reflected_again: f64,
}

impl Change {
    /// Adds a leaf of this area, m², whose radiosity was the first and is the second, W/m², with
    /// what it reflects of that and its reflectance.
    pub fn note(&mut self, area: f32, [before, now]: [Vec3; 2], (reflected, reflectance): (Vec3, Vec3)) {
        let watts = |radiosity: Vec3| f64::from(area) * f64::from(radiosity.max_element());
        self.moved += watts((now - before).abs());
        self.power += watts(now);
        self.reflected += watts(reflected);
        self.reflected_again += watts(reflected) * f64::from(reflectance.max_element());
    }

    /// Both changes together.
    pub fn and(self, other: Self) -> Self {
        Self {
            moved: self.moved + other.moved,
            power: self.power + other.power,
            reflected: self.reflected + other.reflected,
            reflected_again: self.reflected_again + other.reflected_again,
        }
    }

    /// Power that further sweeps are to move, W: no less than the last one did. A reflection keeps
    /// the mean reflectance of what is reflected.
    pub fn to_come(&self) -> f64 {
        let mean = self.reflected_again / self.reflected.max(f64::MIN_POSITIVE);
        let mean = mean.min(LARGEST_RETURN.into());
        self.moved * (mean / (1.0 - mean)).max(1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::builtin::BuiltinScene;
    use crate::solve::{Solver, SolverParams};
    use crate::transport::Push;

    /// Truth: the leaves themselves, one by one. Where none of them is lit by less than nothing,
    /// for which the lights from far away are known too coarsely, the rim reflects what they do.
    #[test]
    fn the_rim_of_the_stem_reflects_what_its_leaves_do() {
        for push in [Push::Immediate, Push::Deferred] {
            let params = SolverParams { push, ..SolverParams::with_epsilon(3e-2) };
            let solved = Solver::solved(BuiltinScene::Office.build(), params);
            let solution = solved.link_solution();
            let never = CancelToken::new();
            let gatherer = solution.gatherer(solution.links(), false);
            let stem = gatherer.pusher.stem();
            let mut light = solution.light().clone();
            // Leaves that are scaled back must count as such.
            light.row_scale.iter_mut().step_by(3).for_each(|scale| *scale = 0.5);
            let (mut radiosity, emitted) = (stem.of(&light.radiosity), stem.of(&light.emitted));
            let arrived = gatherer.arrive(&radiosity, &emitted, &never).expect("nobody cancels");
            let rims = gatherer.rims(&light.row_scale);
            gatherer.reflect(&rims, &arrived, &emitted, &mut radiosity);
            gatherer.spread(&arrived, &mut light);
            let is_lit = |id: ElementId| light.irradiance[id.index()].min_element() > 0.0;
            let (mut compared, mut with_harmonics) = (0, 0);
            for Rim { place, .. } in &rims {
                let index = stem.elements()[*place].index;
                let Shape::Cluster(cluster) = &solution.hierarchy().elements()[index].shape else { continue };
                if solution.hierarchy().patches_below(cluster).iter().all(|id| is_lit(*id)) {
                    let off = (radiosity[*place] - light.radiosity[index]).abs().max_element();
                    assert!(off < 1e-4 * light.radiosity[index].max_element(), "{push:?}, {index}: off by {off} W/m²");
                    compared += 1;
                    with_harmonics += usize::from(gatherer.pusher.reaching(&arrived, *place).1.is_some());
                }
            }
            assert!(
                compared > 20 && (with_harmonics > 10) == (push == Push::Immediate),
                "{compared}, {with_harmonics}"
            );
            let [stem, all] = [stem.elements().len(), solution.hierarchy().elements().len()];
            assert!(4 * stem < 3 * all, "{stem} of {all} elements");
        }
    }
}
