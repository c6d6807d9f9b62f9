//! The solution of the links: elements, links, light, and the pairs that wait to be judged.

use std::sync::Arc;

use glam::Vec3;
use rayon::prelude::*;

use super::SolutionView;
use super::candidate::Candidate;
use super::harmonics::{NormalMoments, normal_moments};
use super::link::LinkTable;
use super::nodes::Nodes;
use super::oracle::Oracle;
use super::pair_samples::RaySampler;
use super::recheck::SCHEDULE;
use super::refine::{Applied, Refinement};
use super::rules::LinkRules;
use super::sweep::{Gatherer, Light};
use crate::base::cancel::CancelToken;
use crate::geometry::Occluders;
use crate::hierarchy::{Element, ElementId, Hierarchy, PatchSums, Shape};
use crate::scene::{Scene, Surface};

/// Where memory is full, a child with more siblings to be judged than this is lit by its cluster as
/// a whole.
const LONGEST_ROW: u32 = 16;
/// A gather is given up after this many sweeps; at the largest reflectance that files may hold
/// (0.99) light needs 1,400 sweeps to fall to 10⁻⁶.
const MOST_SWEEPS: u32 = 2000;

/// Elements, the links between them, and their light.
pub struct LinkSolution {
    pub(super) scene: Arc<Scene>,
    pub(super) occluders: Arc<Occluders>,
    pub(super) surfaces: Vec<Surface>,
    pub(super) entering: Vec3,
    pub(super) rules: LinkRules,
    pub(super) hierarchy: Hierarchy,
    /// How the patches of each cluster are turned.
    normal_moments: Vec<NormalMoments>,
    pub(super) light: Light,
    pub(super) links: LinkTable,
    pub(super) refinement: Refinement,
    /// Emitted power of the initial patches, by the largest colour, W.
    pub(super) emission: PatchSums,
    /// Largest colour of each element's B at the last fixed point of the algorithm, which verdicts
    /// look at.
    pub(super) max_radiosity: Vec<f32>,
    /// Place in [`SCHEDULE`].
    pub(super) stage: usize,
    /// Whether the light is that of the stored links to the last digit, emission and reflectances
    /// included.
    pub(super) is_converged: bool,
    /// Whether nothing is split any more, because memory would not hold it.
    is_full: bool,
    /// Whether clusters light some of their children as a whole because memory was full: pairs of
    /// siblings would count twice beside that.
    has_coarsened_siblings: bool,
    /// Times that light was moved until it converged.
    iterations: u32,
    clamped_leaves: usize,
    bounded_leaves: usize,
}

impl LinkSolution {
    /// The root's self-link over these clusters, which waits, and emitted light; `entering` is the
    /// power that comes in from outside, W per colour.
    pub fn new(
        scene: Arc<Scene>,
        occluders: Arc<Occluders>,
        hierarchy: Hierarchy,
        entering: Vec3,
        rules: LinkRules,
    ) -> Self {
        let mut solution = Self {
            surfaces: surfaces_of(&scene),
            scene,
            occluders,
            entering,
            rules,
            normal_moments: normal_moments(&hierarchy),
            hierarchy,
            light: Light::default(),
            links: LinkTable::default(),
            refinement: Refinement::default(),
            emission: PatchSums::default(),
            max_radiosity: Vec::new(),
            stage: 0,
            is_converged: false,
            is_full: false,
            has_coarsened_siblings: false,
            iterations: 0,
            clamped_leaves: 0,
            bounded_leaves: 0,
        };
        solution.light = solution.emitted_light();
        solution.emission = solution.emission_sums();
        solution.fix_max_radiosity();
        solution.refinement.start(Candidate::first(&solution.hierarchy));
        solution
    }

    /// Starts over from the root's self-link, over new clusters; judges by the radiosities of the
    /// polygons that are known.
    pub fn restarted(&self, hierarchy: Hierarchy, rules: LinkRules) -> Self {
        let mut new = Self::new(self.scene.clone(), self.occluders.clone(), hierarchy, self.entering, rules);
        if self.refinement.rejected.is_some() {
            new.record_rejected();
        }
        let mut of_polygons = vec![Vec3::ZERO; self.scene.polygons.len()];
        for &id in self.hierarchy.initial_patches() {
            if let Shape::Patch(patch) = self.hierarchy.element(id).shape {
                of_polygons[patch.polygon as usize] = self.light.radiosity[id.index()];
            }
        }
        for (element, radiosity) in new.hierarchy.elements().iter().zip(&mut new.light.radiosity) {
            if let Shape::Patch(patch) = element.shape {
                *radiosity = of_polygons[patch.polygon as usize];
            }
        }
        Nodes::new(&new.hierarchy).pull(&mut new.light.radiosity);
        new.fix_max_radiosity();
        new
    }

    /// Judges a part of the pairs that wait, and applies the verdicts as long as `has_room` for
    /// what comes of them; from then on nothing is split. `None` if cancelled, with nothing
    /// changed.
    pub fn refine(
        &mut self,
        has_room: impl Fn(&Refinement, &Hierarchy) -> bool,
        cancel: &CancelToken,
    ) -> Option<Applied> {
        // Out of the way of the oracle, which looks at all the rest.
        let mut refinement = std::mem::take(&mut self.refinement);
        let judged = refinement.judge(&self.oracle(), cancel);
        self.refinement = refinement;
        let judged = judged?;
        let is_full = self.is_full;
        let has_room = |refinement: &Refinement, hierarchy: &Hierarchy| is_full || has_room(refinement, hierarchy);
        let applied = self.refinement.apply(&mut self.hierarchy, &judged, has_room);
        if !applied.is_whole {
            self.is_full = true;
            self.has_coarsened_siblings |= self.refinement.coarsen_sibling_batches(&self.hierarchy, LONGEST_ROW);
        }
        self.grow_light();
        Some(applied)
    }

    /// Takes accepted links into the table.
    pub fn store_accepted(&mut self) {
        let accepted = std::mem::take(&mut self.refinement.accepted);
        self.is_converged &= accepted.is_empty();
        if !accepted.is_empty() || self.links.receivers() < self.hierarchy.elements().len() {
            self.links.append(self.hierarchy.elements().len(), &accepted);
        }
    }

    /// Moves light over the stored links until less than `tolerance` of the power is still to come;
    /// `None` if cancelled, with nothing changed. Light that starts `afresh`, from emission, does
    /// not depend on what was solved before.
    pub fn converge(&mut self, tolerance: f64, afresh: bool, cancel: &CancelToken) -> Option<()> {
        let mut light = if afresh { self.emitted_light() } else { self.light.clone() };
        let gatherer = self.gatherer(&self.links, false);
        let clamped = gatherer.enforce_closure(&mut light, cancel)?;
        if !gatherer.converge(&mut light, tolerance, MOST_SWEEPS, cancel) {
            return None;
        }
        let bounded = gatherer.keep_bounds(self, &mut light);
        self.light = light;
        (self.clamped_leaves, self.bounded_leaves) = (clamped, bounded);
        self.fix_max_radiosity();
        self.iterations += 1;
        Some(())
    }

    /// Says that the light is that of the stored links to the last digit.
    pub fn settle(&mut self) {
        self.is_converged = true;
    }

    /// Says that light must be moved again although no link has changed.
    pub fn unsettle(&mut self) {
        self.is_converged = false;
    }

    /// Goes by other rules from now on.
    pub fn set_rules(&mut self, rules: LinkRules) {
        self.rules = rules;
    }

    /// Lets elements be split again after memory was full; false where siblings that their cluster
    /// lights as a whole forbid it.
    pub fn split_again(&mut self) -> bool {
        self.is_full = self.has_coarsened_siblings;
        !self.is_full
    }

    /// Irradiance by what others reflect and by the sky, of each element, W/m², parallel to the
    /// arena; `None` if cancelled.
    pub fn indirect(&self, cancel: &CancelToken) -> Option<Vec<Vec3>> {
        let direct = self.gatherer(&self.links, false).direct(&self.light, cancel)?;
        let all = self.light.irradiance.iter().zip(&direct);
        Some(all.map(|(all, direct)| (*all - *direct).max(Vec3::ZERO)).collect())
    }

    /// The solution view of a state with these links and this light, over a copy of the hierarchy.
    pub fn solution_view(
        &self,
        hierarchy: Arc<Hierarchy>,
        links: &LinkTable,
        light: &Light,
        is_final: bool,
    ) -> SolutionView {
        let mut light = light.clone();
        light.grow(&hierarchy);
        SolutionView::new(hierarchy, links.clone(), light, self.rules, is_final)
    }

    /// Moves light over a table of links between the present elements.
    pub fn gatherer<'a>(&'a self, links: &'a LinkTable, with_unjudged: bool) -> Gatherer<'a> {
        Gatherer::new(&self.hierarchy, links, (&self.surfaces, &self.normal_moments), &self.rules, with_unjudged)
    }

    /// The oracle over the present state.
    pub(super) fn oracle(&self) -> Oracle<'_> {
        Oracle {
            hierarchy: &self.hierarchy,
            max_radiosity: &self.max_radiosity,
            thresholds: self.rules.thresholds(SCHEDULE[self.stage]),
            model: self.rules.cluster_model,
            may_split: !self.is_full,
            sampler: RaySampler { occluders: &self.occluders, seed: self.rules.seed, emission: &self.emission },
        }
    }

    /// Emitted light alone, pulled up the tree.
    pub fn emitted_light(&self) -> Light {
        let emission = |element: &Element| match element.shape {
            Shape::Patch(patch) => self.surfaces[patch.polygon as usize].emission,
            Shape::Cluster(_) => Vec3::ZERO,
            Shape::Sky(number) => self.hierarchy.sky_part(number).radiosity,
        };
        let elements = self.hierarchy.elements();
        let mut radiosity: Vec<Vec3> = elements.par_iter().with_min_len(1 << 12).map(emission).collect();
        Nodes::new(&self.hierarchy).pull(&mut radiosity);
        let irradiance = vec![Vec3::ZERO; radiosity.len()];
        Light { emitted: radiosity.clone(), radiosity, irradiance, row_scale: Vec::new() }
    }

    pub(super) fn emission_sums(&self) -> PatchSums {
        let power = |&id: &ElementId| {
            f64::from(self.hierarchy.element(id).sampled_area * self.light.emitted[id.index()].max_element())
        };
        PatchSums::new(self.hierarchy.initial_patches().iter().map(power))
    }

    /// Lets new elements start with their parents' light, in all that verdicts look at.
    fn grow_light(&mut self) {
        self.light.grow(&self.hierarchy);
        let known = self.max_radiosity.len();
        self.max_radiosity.extend(self.light.radiosity[known..].iter().map(|radiosity| radiosity.max_element()));
    }

    /// Makes the present radiosities those that verdicts look at.
    fn fix_max_radiosity(&mut self) {
        let largest = |radiosity: &Vec3| radiosity.max_element();
        self.max_radiosity = self.light.radiosity.par_iter().with_min_len(1 << 12).map(largest).collect();
    }
}

/// The parts.
impl LinkSolution {
    /// The scene as it is solved, edits of materials included.
    pub fn scene(&self) -> &Arc<Scene> {
        &self.scene
    }

    /// Faces that rays meet.
    pub fn occluders(&self) -> &Arc<Occluders> {
        &self.occluders
    }

    /// Reflectance and emission of each polygon.
    pub fn surfaces(&self) -> &[Surface] {
        &self.surfaces
    }

    /// Power that comes in from outside, W per colour, as far as a few thousand rays tell.
    pub fn entering_power(&self) -> Vec3 {
        self.entering
    }

    /// Power Φ that the scene gets, emitted or from outside, by the largest colour, W.
    pub fn largest_power(&self) -> f64 {
        f64::from((self.scene.emitted_power() + self.entering).max_element())
    }

    /// Rules of the solution.
    pub fn rules(&self) -> &LinkRules {
        &self.rules
    }

    /// The elements.
    pub fn hierarchy(&self) -> &Hierarchy {
        &self.hierarchy
    }

    /// How the patches of each cluster are turned.
    pub fn normal_moments(&self) -> &[NormalMoments] {
        &self.normal_moments
    }

    /// The stored links.
    pub fn links(&self) -> &LinkTable {
        &self.links
    }

    /// The light that the last gather found.
    pub fn light(&self) -> &Light {
        &self.light
    }

    /// The pairs that wait, and those that were accepted since the last gather.
    pub fn refinement(&self) -> &Refinement {
        &self.refinement
    }

    /// Records every rejected pair from now on; for tests that ask whether all pairs are covered.
    pub fn record_rejected(&mut self) {
        self.refinement.rejected.get_or_insert_default();
    }

    /// Whether the light is that of the stored links to the last digit.
    pub fn is_converged(&self) -> bool {
        self.is_converged
    }

    /// Whether siblings are lit by their cluster as a whole, which only a new start undoes.
    pub fn has_coarsened_siblings(&self) -> bool {
        self.has_coarsened_siblings
    }

    /// Times that light was moved until it converged.
    pub fn iterations(&self) -> u32 {
        self.iterations
    }

    /// Leaves whose form factors summed to more than 1, and leaves that were brighter than anything
    /// can be.
    pub fn limited_leaves(&self) -> (usize, usize) {
        (self.clamped_leaves, self.bounded_leaves)
    }
}

pub(super) fn surfaces_of(scene: &Scene) -> Vec<Surface> {
    scene.polygons.par_iter().with_min_len(1 << 12).map(|polygon| scene.surface(polygon)).collect()
}
