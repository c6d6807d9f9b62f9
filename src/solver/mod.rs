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
//! Settings, lamps and materials may change meanwhile (`live`): what that costs is told by `change`, and a coarser threshold merges
//! links and patches back (`coarsen`).
//!
//! This module imports `scene`, `visibility` and `hierarchy`.

pub mod anatomy;
mod audit;
mod balance;
mod bounds;
mod candidate;
mod change;
mod coarsen;
mod display;
mod final_gather;
mod form_factor;
mod gather;
mod history;
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

pub use anatomy::{Anatomy, LinkView};
pub use audit::{Audit, audit};
pub use balance::{PowerBalance, power_balance};
pub use change::Invalidates;
pub use display::barycentric;
pub use form_factor::{Exchange, exchange, point_to_polygon};
pub use history::{MomentInfo, MomentKind};
pub use link::{Evidence, Link, LinkTable};
pub use link_error::LinkError;
pub use params::{
    ClusterModel, ClusteringMode, Epsilon, OracleKind, PARAMETERS, Parameter, ParameterId, ParamsError, Push,
    Reconstruct, SolverParams, USUAL_ERROR, ValueKind,
};
pub use refine::RejectedPair;
pub use snapshot::{ClusterBox, Leaf, Mesh, Snapshot};
pub use stats::{Bytes, Phase, Seconds, Stats};
pub use verdict::Rejection;

use crate::cancel::CancelToken;
use crate::exposure::Exposure;
use crate::hierarchy::{ElementId, Hierarchy, PatchSums, Shape};
use crate::scene::Scene;
use crate::visibility::Occluders;
use candidate::{Candidate, Directions};
use change::Doubts;
use display::Display;
use final_gather::FinalGather;
use gather::{Gatherer, Light, Surface, pull};
use history::History;
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
    /// The Φ by which ε became watts, W.
    anchor_watts: f64,
    /// Whether links may be finer than ε asks for, because it was raised.
    merges_back: bool,
    /// What the next look at the stored links must look for.
    doubts: Doubts,
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
    /// Whether the light is that of the last gather, and nothing has changed since but what is asked of links.
    is_converged: bool,
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
    /// Whether snapshots carry the anatomy, and the hierarchy of the last one that did.
    wants_anatomy: bool,
    frozen: Option<Arc<Hierarchy>>,
    history: Option<History>,
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
        Self::with_exposure(scene, occluders, params, generation, |scene, occluders| {
            Arc::new(Exposure::new(scene, occluders))
        })
    }

    /// The same where somebody may know already what is hidden.
    fn with_exposure(
        scene: Arc<Scene>,
        occluders: Arc<Occluders>,
        params: SolverParams,
        generation: u64,
        exposure: impl FnOnce(&Scene, &Occluders) -> Arc<Exposure>,
    ) -> Result<Self, SolverError> {
        params.validate()?;
        if params.clustering == ClusteringMode::None {
            check_pairs_fit(scene.polygons.len() as u64)?;
        }
        let (hierarchy, seconds) =
            timed(|| Hierarchy::new(&scene, exposure(&scene, &occluders), params.clustering, params.octree_depth));
        let seconds = Seconds { hierarchy: seconds, total: seconds, ..Seconds::default() };
        let mut solver = Self {
            surfaces: surfaces_of(&scene),
            epsilon_watts: watts(&params, &scene),
            anchor_watts: largest_power(&scene),
            merges_back: false,
            doubts: Doubts::default(),
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
            is_converged: false,
            iterations: 0,
            clamped_leaves: 0,
            bounded_leaves: 0,
            seconds,
            generation,
            serial: 0,
            picture: Picture::default(),
            display: None,
            final_gather: None,
            wants_anatomy: false,
            frozen: None,
            history: None,
        };
        solver.light = solver.emitted_light();
        solver.emission = solver.emission_sums();
        solver.fix_brightness();
        solver.refinement.start([Candidate::root()]);
        Ok(solver)
    }

    fn work(&mut self, cancel: &CancelToken) -> Step {
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
            Phase::Gather if self.merges_back => {
                let (is_done, seconds) = timed(|| self.merge_back(cancel));
                self.seconds.refine += seconds;
                self.seconds.total += seconds;
                self.merges_back = !is_done;
                if is_done { Step::Refined { wave_ended: true } } else { Step::Interrupted }
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

    /// Does one bounded piece of work, and keeps the moment where one ends with it and history is kept.
    pub fn step(&mut self, cancel: &CancelToken) -> Step {
        let step = self.work(cancel);
        match step {
            Step::Refined { wave_ended: true } => self.remember(MomentKind::Wave),
            Step::Gathered => self.remember(MomentKind::Round),
            Step::Reconstructed { pass_ended: true } => self.remember(MomentKind::Pass),
            _ => {}
        }
        step
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
        self.is_converged &= accepted.is_empty();
        if !accepted.is_empty() || self.links.receivers() < self.hierarchy.elements().len() {
            self.links.append(self.hierarchy.elements().len(), &accepted);
        }
        if self.is_converged && !self.gathers_finely {
            self.judge_stored();
            return Step::Gathered;
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
            self.is_converged = true;
            self.end_links();
        } else {
            self.judge_stored();
        }
        Step::Gathered
    }

    /// Judges the stored links by the present radiosities; those that fail are candidates of the next round.
    fn judge_stored(&mut self) {
        let doubts = std::mem::take(&mut self.doubts);
        let mut failing = self.take_failing(doubts);
        let few_fail = failing.len() * FEW <= self.links.len();
        if few_fail && self.stage + 1 < SCHEDULE.len() {
            self.stage += 1;
            failing.append(&mut self.take_failing(Doubts { finer_epsilon: true, ..Doubts::default() }));
        } else {
            self.gathers_finely = few_fail;
        }
        if !failing.is_empty() {
            self.refinement.start(failing);
            if doubts != Doubts::default() {
                self.refinement.hurry();
            }
            self.phase = Phase::Refine;
        }
    }

    /// ε of the present stage, W.
    fn stage_epsilon(&self) -> f64 {
        self.epsilon_watts * SCHEDULE[self.stage]
    }

    /// Takes out what must be judged again as candidates. A link that fails by the present radiosities or is in doubt; and pairs
    /// whose occlusion matters more than when it was found.
    fn take_failing(&mut self, doubts: Doubts) -> Vec<Candidate> {
        let oracle = oracle(
            &self.hierarchy,
            &self.brightness,
            &self.spread,
            &self.emission,
            &self.occluders,
            &self.params,
            self.stage_epsilon(),
        );
        let failing = self.links.drain(|receiver, link| {
            oracle.must_judge_again(receiver, link) || oracle.is_in_doubt(receiver, link, doubts)
        });
        let of_link = |(receiver, link): (ElementId, Link)| judged_again(receiver, &link, doubts);
        let occluded = std::mem::take(&mut self.refinement.occluded);
        let (doubtful, believed): (Vec<_>, _) =
            occluded.into_par_iter().partition(|pair| oracle.is_doubtful(pair, doubts));
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

    /// Says whether snapshots carry the [`Anatomy`] of what they show.
    pub fn show_anatomy(&mut self, is_wanted: bool) {
        self.wants_anatomy = is_wanted;
        if !is_wanted {
            self.frozen = None;
        }
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
            power_watts: largest,
            anchor_watts: self.anchor_watts,
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
}

/// Does some work; also tells how many seconds it took.
fn timed<T>(work: impl FnOnce() -> T) -> (T, f64) {
    let begun = Instant::now();
    let result = work();
    (result, begun.elapsed().as_secs_f64())
}

/// The candidate that a stored link becomes; by a finer ε or with more rays, visibility that it inherited must show itself.
fn judged_again(receiver: ElementId, link: &Link, doubts: Doubts) -> Candidate {
    let directions = Directions { to_a: true, to_b: false };
    let is_inherited = link.evidence() == Evidence::Inherited && receiver != link.source();
    let must_show = doubts.finer_epsilon || doubts.more_rays;
    Candidate::new(receiver, link.source(), directions, link.visibility(), is_inherited && !must_show)
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
        Epsilon::Relative(share) => share * largest_power(scene),
    }
}

/// Emitted power Φ by the largest colour, W.
fn largest_power(scene: &Scene) -> f64 {
    f64::from(scene.emitted_power().max_element())
}

fn surfaces_of(scene: &Scene) -> Vec<Surface> {
    let surface = |polygon: &crate::scene::Polygon| {
        let material = &scene.materials[polygon.material.0 as usize];
        Surface { reflectance: material.reflectance, emission: material.emission }
    };
    scene.polygons.iter().map(surface).collect()
}
