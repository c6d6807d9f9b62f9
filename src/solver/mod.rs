//! The solver: one link, from the root cluster to itself, refined until every link carries little enough.
//!
//! [`Solver::step`] does one bounded piece of work at a time, so that whoever drives it can look at pictures, change
//! parameters or stop in between. The algorithm:
//!
//! 1. Start with emitted light and the root's self-link as the one candidate.
//! 2. Judge the candidates of a wave (`Oracle`), apply the verdicts (`Refinement`); repeat until none is left.
//! 3. Gather to convergence (`Gatherer`).
//! 4. Judge the stored links again, for B has grown; those that fail are candidates of the next round, until none fails.
//! 5. Where an error is asked for, look for light anew at the vertices (a final gather) until its own estimate keeps the promise.
//!
//! This module imports `scene`, `visibility` and `hierarchy`.

mod audit;
mod balance;
mod bounds;
mod candidate;
mod display;
mod final_gather;
mod form_factor;
mod gather;
mod link;
mod link_error;
mod live;
mod memory;
mod oracle;
pub mod params;
mod picture;
mod push;
mod rays;
mod reconstruct;
mod refine;
mod sight;
pub mod snapshot;
pub mod stats;
mod verdict;

use std::sync::Arc;
use std::time::Instant;

use glam::Vec3;
use rayon::prelude::*;

pub use audit::{Audit, audit};
pub use balance::{PowerBalance, power_balance};
pub use display::barycentric;
pub use form_factor::{Exchange, exchange, point_to_polygon};
pub use link::{Evidence, Link, LinkTable};
pub use params::{
    ClusterModel, ClusteringMode, Epsilon, Invalidates, OracleKind, PARAMETERS, Parameter, ParameterId, ParamsError,
    Push, Reconstruct, SolverParams, USUAL_ERROR, ValueKind,
};
pub use refine::RejectedPair;
pub use snapshot::{ClusterBox, InspectedElement, Leaf, LinkView, Mesh, Snapshot};
pub use stats::{Bytes, Phase, Seconds, Stats};
pub use verdict::Rejection;

use crate::cancel::CancelToken;
use crate::exposure::Exposure;
use crate::hierarchy::{ElementId, Hierarchy, PatchSums, Shape};
use crate::scene::Scene;
use crate::visibility::Occluders;
use candidate::{Candidate, Directions};
use display::Display;
use final_gather::FinalGather;
use gather::{Gatherer, Light, Surface, pull};
use memory::check_pairs_fit;
use oracle::Oracle;
use picture::Picture;
use rays::RaySampler;
use refine::Refinement;
use sight::Thresholds;

/// Why a solve cannot start.
#[derive(Debug, thiserror::Error)]
pub enum SolverError {
    /// A parameter cannot be used.
    #[error(transparent)]
    Params(#[from] ParamsError),
    /// Plain HR would need more memory than there is.
    #[error(
        "clustering none would judge {pairs} pairs and needs up to {needed_mib} MiB for their links, but only {available_mib} MiB are free: choose adaptive, groups or octree"
    )]
    TooManyPairs {
        /// Pairs of initial patches.
        pairs: u64,
        /// Memory their links may take, MiB.
        needed_mib: u64,
        /// Memory that is free, MiB.
        available_mib: u64,
    },
}

/// What one call of [`Solver::step`] did.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Step {
    /// Judged and applied a part of a wave.
    Refined {
        /// Whether the wave ended with it.
        wave_ended: bool,
    },
    /// Gathered to convergence and judged the stored links again.
    Gathered,
    /// Looked for light at vertices.
    Reconstructed {
        /// Whether a pass over all of them ended with it.
        pass_ended: bool,
    },
    /// Nothing is left to do.
    Finished,
    /// The token was cancelled; the same step can be taken again, with the same result.
    Interrupted,
}

/// Multiples of ε that a solve goes through. Verdicts look at radiosities, so a fine ε needs them nearly right: with the
/// last ε alone, links judged while B was small are judged again and again as it grows, and are refined by wrong values.
const SCHEDULE: [f64; 2] = [2.0, 1.0];

/// Rounds end when no more than one in so many links fails its threshold: the last ones are refined, but what little that
/// changes is not judged again.
const FEW: usize = 100;

/// A round's gather ends when less than this share of the power is still to come: thresholds do not ask for more.
const ROUND_TOLERANCE: f64 = 1e-2;
/// The last gather ends when less than this share of the power is still to come.
const FINAL_TOLERANCE: f64 = 1e-5;
/// A gather is given up after this many sweeps; at the largest reflectance that files may hold (0.99) light needs 1,400
/// sweeps to fall to 10⁻⁶.
const MOST_SWEEPS: u32 = 2000;

/// Refines the root's self-link and gathers, step by step.
pub struct Solver {
    scene: Arc<Scene>,
    occluders: Arc<Occluders>,
    surfaces: Vec<Surface>,
    params: SolverParams,
    epsilon_watts: f64,
    hierarchy: Hierarchy,
    light: Light,
    /// Emitted power of the initial patches, by the largest colour, W.
    emission: PatchSums,
    /// Largest colour of each element's B at the last fixed point of the algorithm; what verdicts look at.
    brightness: Vec<f32>,
    /// Standard deviation of that over each element's leaves, W/m².
    spread: Vec<f32>,
    links: LinkTable,
    refinement: Refinement,
    phase: Phase,
    /// Place in [`SCHEDULE`].
    stage: usize,
    /// Whether the next gather is the last one, to [`FINAL_TOLERANCE`].
    gathers_finely: bool,
    iterations: u32,
    clamped_leaves: usize,
    bounded_leaves: usize,
    /// Time spent working; whoever drives the solver may let it rest in between.
    seconds: Seconds,
    generation: u64,
    serial: u64,
    picture: Picture,
    display: Option<Display>,
    final_gather: Option<FinalGather>,
    inspected: Option<ElementId>,
}

impl Solver {
    /// Builds the hierarchy and the root's self-link.
    ///
    /// # Errors
    /// Parameters out of range, or a `none` solve that cannot fit into memory.
    pub fn new(
        scene: Arc<Scene>,
        occluders: Arc<Occluders>,
        params: SolverParams,
        generation: u64,
    ) -> Result<Self, SolverError> {
        params.validate()?;
        if params.clustering == ClusteringMode::None {
            check_pairs_fit(scene.polygons.len() as u64)?;
        }
        let (hierarchy, seconds) = timed(|| {
            let exposure = Arc::new(Exposure::new(&scene, &occluders));
            Hierarchy::new(&scene, exposure, params.clustering, params.octree_depth)
        });
        let seconds = Seconds { hierarchy: seconds, total: seconds, ..Seconds::default() };
        let mut solver = Self {
            surfaces: surfaces_of(&scene),
            epsilon_watts: watts(&params, &scene),
            scene,
            occluders,
            params,
            hierarchy,
            light: Light::default(),
            emission: PatchSums::default(),
            brightness: Vec::new(),
            spread: Vec::new(),
            links: LinkTable::default(),
            refinement: Refinement::default(),
            phase: Phase::Refine,
            stage: 0,
            gathers_finely: false,
            iterations: 0,
            clamped_leaves: 0,
            bounded_leaves: 0,
            seconds,
            generation,
            serial: 0,
            picture: Picture::default(),
            display: None,
            final_gather: None,
            inspected: None,
        };
        solver.light = solver.emitted_light();
        solver.emission = solver.emission_sums();
        solver.fix_brightness();
        solver.refinement.start([Candidate::root()]);
        Ok(solver)
    }

    /// Does one bounded piece of work.
    pub fn step(&mut self, cancel: &CancelToken) -> Step {
        if cancel.is_cancelled() {
            return Step::Interrupted;
        }
        match self.phase {
            Phase::Hierarchy | Phase::Refine => {
                let (step, seconds) = timed(|| self.refine(cancel));
                self.seconds.refine += seconds;
                self.seconds.total += seconds;
                step
            }
            Phase::Gather => {
                let (step, seconds) = timed(|| self.gather(cancel));
                self.seconds.gather += seconds;
                self.seconds.total += seconds;
                step
            }
            Phase::Reconstruct => {
                let (step, seconds) = timed(|| self.reconstruct(cancel));
                self.seconds.reconstruct += seconds;
                self.seconds.total += seconds;
                step
            }
            Phase::Done => Step::Finished,
        }
    }

    /// Steps until nothing is left to do; false if cancelled.
    pub fn run(&mut self, cancel: &CancelToken) -> bool {
        loop {
            match self.step(cancel) {
                Step::Finished => return true,
                Step::Interrupted => return false,
                Step::Refined { .. } | Step::Gathered | Step::Reconstructed { .. } => {}
            }
        }
    }

    fn refine(&mut self, cancel: &CancelToken) -> Step {
        let epsilon = self.stage_epsilon();
        let oracle = oracle(
            &self.hierarchy,
            &self.brightness,
            &self.spread,
            &self.emission,
            &self.occluders,
            &self.params,
            epsilon,
        );
        let Some(judged) = self.refinement.judge(&oracle, cancel) else { return Step::Interrupted };
        let wave_ended = self.refinement.apply(&mut self.hierarchy, &judged);
        self.grow_light();
        if self.refinement.is_finished() {
            self.phase = Phase::Gather;
        }
        Step::Refined { wave_ended }
    }

    fn gather(&mut self, cancel: &CancelToken) -> Step {
        let accepted = std::mem::take(&mut self.refinement.accepted);
        if !accepted.is_empty() || self.links.receivers() < self.hierarchy.elements().len() {
            self.links.append(self.hierarchy.elements().len(), &accepted);
        }
        // The first rounds are coarse: light that is not judged yet has no place in what verdicts look at.
        let tolerance = if self.gathers_finely { FINAL_TOLERANCE } else { ROUND_TOLERANCE };
        let mut light = self.light.clone();
        let gatherer = self.gatherer(&self.links);
        let Some(clamped) = gatherer.limit_rows(&mut light, cancel) else { return Step::Interrupted };
        if !gatherer.converge(&mut light, tolerance, MOST_SWEEPS, cancel) {
            return Step::Interrupted;
        }
        self.bounded_leaves = self.keep_bounds(&mut light);
        self.light = light;
        self.clamped_leaves = clamped;
        self.fix_brightness();
        self.iterations += 1;
        if self.gathers_finely {
            self.end_links();
            return Step::Gathered;
        }
        let mut failing = self.take_failing(false);
        let few_fail = failing.len() * FEW <= self.links.len();
        if few_fail && self.stage + 1 < SCHEDULE.len() {
            self.stage += 1;
            failing.append(&mut self.take_failing(true));
        } else {
            self.gathers_finely = few_fail;
        }
        if !failing.is_empty() {
            self.refinement.start(failing);
            self.phase = Phase::Refine;
        }
        Step::Gathered
    }

    /// ε of the present stage, W.
    fn stage_epsilon(&self) -> f64 {
        self.epsilon_watts * SCHEDULE[self.stage]
    }

    /// Takes out what must be judged again as candidates. A link that fails by the present radiosities, where visibility that
    /// was inherited by a coarser ε must show itself by this one; and pairs whose occlusion matters more than when it was found.
    fn take_failing(&mut self, finer_epsilon: bool) -> Vec<Candidate> {
        let epsilon = self.stage_epsilon();
        let oracle = oracle(
            &self.hierarchy,
            &self.brightness,
            &self.spread,
            &self.emission,
            &self.occluders,
            &self.params,
            epsilon,
        );
        let failing = self.links.drain(|receiver, link| oracle.must_judge_again(receiver, link));
        let of_link = |(receiver, link): (ElementId, Link)| judged_again(receiver, &link, finer_epsilon);
        let occluded = std::mem::take(&mut self.refinement.occluded);
        let (doubtful, believed): (Vec<_>, _) =
            occluded.into_par_iter().partition(|pair| oracle.is_doubtful(pair, finer_epsilon));
        let doubtful: Vec<Candidate> = doubtful.into_iter().map(|occluded| occluded.pair).collect();
        self.refinement.occluded = believed;
        self.refinement.forget_rejections(&doubtful);
        failing.into_iter().map(of_link).chain(doubtful).collect()
    }

    fn gatherer<'a>(&'a self, links: &'a LinkTable) -> Gatherer<'a> {
        Gatherer::new(&self.hierarchy, links, &self.surfaces, &self.params, false)
    }

    /// Emitted light alone, pulled up the tree.
    fn emitted_light(&self) -> Light {
        let emission = |element: &crate::hierarchy::Element| match element.shape {
            Shape::Patch(patch) => self.surfaces[patch.polygon as usize].emission,
            Shape::Cluster(_) => Vec3::ZERO,
        };
        let mut radiosity: Vec<Vec3> = self.hierarchy.elements().iter().map(emission).collect();
        pull(&self.hierarchy, &mut radiosity);
        let irradiance = vec![Vec3::ZERO; radiosity.len()];
        Light { emitted: radiosity.clone(), radiosity, irradiance, row_scale: Vec::new() }
    }

    fn emission_sums(&self) -> PatchSums {
        let power = |&id: &ElementId| {
            f64::from(self.hierarchy.element(id).sampled_area * self.light.emitted[id.index()].max_element())
        };
        PatchSums::new(self.hierarchy.initial_patches().iter().map(power))
    }

    /// Lets new elements start with their parents' light, in all that verdicts look at.
    fn grow_light(&mut self) {
        self.light.grow(&self.hierarchy);
        let known = self.brightness.len();
        self.brightness.extend(self.light.radiosity[known..].iter().map(|radiosity| radiosity.max_element()));
        self.spread.resize(self.brightness.len(), 0.0);
    }

    /// Makes the present radiosities those that verdicts look at.
    fn fix_brightness(&mut self) {
        self.brightness.clear();
        self.brightness.extend(self.light.radiosity.iter().map(|radiosity| radiosity.max_element()));
        link_error::spread_of(&self.hierarchy, &self.brightness, &mut self.spread);
    }

    /// The scene as it is solved, edits of emission included.
    pub fn scene(&self) -> &Arc<Scene> {
        &self.scene
    }

    /// The present parameters.
    pub fn params(&self) -> &SolverParams {
        &self.params
    }

    /// The elements.
    pub fn hierarchy(&self) -> &Hierarchy {
        &self.hierarchy
    }

    /// The links that the last gather knew.
    pub fn links(&self) -> &LinkTable {
        &self.links
    }

    /// Radiosity B of each element, W/m², parallel to the hierarchy's arena.
    pub fn radiosity(&self) -> &[Vec3] {
        &self.light.radiosity
    }

    /// Irradiance E of each leaf, W/m², parallel to the hierarchy's arena.
    pub fn irradiance(&self) -> &[Vec3] {
        &self.light.irradiance
    }

    /// Records every rejected pair from now on; for tests that ask whether all pairs are covered.
    pub fn record_rejected(&mut self) {
        self.refinement.rejected.get_or_insert_default();
    }

    /// The pairs rejected since [`Self::record_rejected`].
    pub fn rejected(&self) -> &[RejectedPair] {
        self.refinement.rejected.as_deref().unwrap_or_default()
    }

    /// Asks that snapshots carry the links of an element.
    pub fn inspect(&mut self, element: Option<ElementId>) {
        self.inspected = element;
    }

    /// Books time that passed before the solver was made: reading the file and building the occluders.
    pub fn set_load_seconds(&mut self, seconds: f64) {
        self.seconds.load = seconds;
    }

    /// Counts and times so far.
    pub fn stats(&self) -> Stats {
        let (wave, next_wave) = self.refinement.waiting_len();
        let emitted = self.scene.emitted_power();
        let largest = f64::from(emitted.max_element());
        Stats {
            phase: self.phase,
            epsilon_watts: self.epsilon_watts,
            epsilon_relative: if largest > 0.0 { self.epsilon_watts / largest } else { 0.0 },
            initial_patches: self.hierarchy.initial_patches().len(),
            clusters: self.hierarchy.cluster_count(),
            patches: self.hierarchy.leaf_count(),
            elements: self.hierarchy.elements().len(),
            links: self.links.len() + self.refinement.accepted.len(),
            pairs_judged: self.refinement.counts.pairs_judged,
            rays: self.refinement.counts.rays + self.final_gather.as_ref().map_or(0, FinalGather::rays),
            iterations: self.iterations,
            wave: self.refinement.waves,
            candidates_left: wave + next_wave,
            converged: self.phase == Phase::Done,
            depth_guard_struck: self.refinement.counts.depth_guard_struck,
            clamped_leaves: self.clamped_leaves,
            bounded_leaves: self.bounded_leaves,
            error_asked: self.params.error,
            error_estimate: self.error_estimate(),
            seconds: self.seconds,
            bytes: Bytes {
                links: self.links.bytes(),
                elements: self.hierarchy.bytes() + self.light.bytes(),
                rows: self.final_gather.as_ref().map_or(0, FinalGather::bytes),
            },
            emitted_watts: f64::from(emitted.element_sum()),
            absorbed_watts: balance::absorbed(self).element_sum(),
            progress: self.refinement.progress().filter(|_| self.phase == Phase::Refine),
        }
    }

    /// A picture of what is there, candidates counted at their present level.
    pub fn snapshot(&mut self) -> Snapshot {
        let is_first = self.seconds.first_snapshot <= 0.0;
        let (mut snapshot, seconds) = timed(|| picture::snapshot(self));
        // Who looks at a finished solution adds nothing to the time that it took.
        if self.phase != Phase::Done {
            self.seconds.total += seconds;
        }
        if is_first {
            self.seconds.first_snapshot = self.seconds.total;
        }
        snapshot.stats.seconds = self.seconds;
        snapshot
    }

    /// Irradiance E of each mesh vertex of the last snapshot, W/m², averaged like its radiosity; empty before the first one.
    pub fn vertex_irradiance(&self) -> Vec<[f32; 3]> {
        picture::vertex_irradiance(self)
    }
}

/// Does some work; also tells how many seconds it took.
fn timed<T>(work: impl FnOnce() -> T) -> (T, f64) {
    let begun = Instant::now();
    let result = work();
    (result, begun.elapsed().as_secs_f64())
}

/// The candidate that a stored link becomes; by a finer ε, visibility that it inherited must show itself.
fn judged_again(receiver: ElementId, link: &Link, finer_epsilon: bool) -> Candidate {
    let directions = Directions { to_a: true, to_b: false };
    let inherited = link.evidence() == Evidence::Inherited && receiver != link.source();
    Candidate::new(receiver, link.source(), directions, link.visibility(), inherited && !finer_epsilon)
}

/// The oracle over the present state; a function of the parts, so that refinement can be borrowed beside it.
fn oracle<'a>(
    hierarchy: &'a Hierarchy,
    brightness: &'a [f32],
    spread: &'a [f32],
    emission: &'a PatchSums,
    occluders: &'a Occluders,
    params: &SolverParams,
    epsilon_watts: f64,
) -> Oracle<'a> {
    let thresholds = Thresholds {
        epsilon: epsilon_watts as f32,
        epsilon_partial: (params.partial_factor * epsilon_watts) as f32,
        visibility_factor: params.visibility_factor as f32,
        rays_min: params.rays_min,
        rays_max: params.rays_max,
        is_patient: params.oracle == OracleKind::Error || params.error.is_some(),
    };
    let model = params.cluster_model;
    let kind = params.oracle;
    Oracle {
        hierarchy,
        brightness,
        spread,
        thresholds,
        model,
        kind,
        sampler: RaySampler { occluders, seed: params.seed, emission },
    }
}

/// ε in W.
fn watts(params: &SolverParams, scene: &Scene) -> f64 {
    match params.threshold() {
        Epsilon::Watts(watts) => watts,
        Epsilon::Relative(share) => share * f64::from(scene.emitted_power().max_element()),
    }
}

fn surfaces_of(scene: &Scene) -> Vec<Surface> {
    let surface = |polygon: &crate::scene::Polygon| {
        let material = &scene.materials[polygon.material.0 as usize];
        Surface { reflectance: material.reflectance, emission: material.emission }
    };
    scene.polygons.iter().map(surface).collect()
}
