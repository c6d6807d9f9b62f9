//! The final gather: light looked for anew at every vertex of the mesh that is shown.
//!
//! Links know how much light the elements exchange, in the mean over each; at the edge of a shadow, or below a table,
//! that mean is wrong. So vertices get direct light by rays to the lamps, leaves are split where it is not linear between them, and
//! indirect light comes over rows of rays that end on the mesh (a final gather over a coarse solution, [Lischinski, Tampieri, Greenberg 93]).
//! Rows are kept and gathered over again until nothing changes, starting with what the links say: so the links' own errors die out.
//! At last the result is looked at in random places, and what is not as exact as was asked for is made so.

mod bright;
mod estimate;
mod lamps;
mod local;
mod memory;
mod passes;
mod places;
mod rows;
mod split;
mod stance;
mod vertices;

use std::ops::Range;
use std::sync::Arc;

use glam::Vec3;
use rayon::prelude::*;
use rustc_hash::FxHashMap;

use super::display::{Display, Style, VertexKey};
use super::gather::Surface;
use super::memory::{GATHERED_LEAF, MemoryStop};
use super::params::USUAL_ERROR;
use crate::cancel::CancelToken;
use crate::geometry::LampList;
use crate::geometry::Occluders;
use crate::hierarchy::{ElementId, Hierarchy, Shape};
use crate::random::mix;
use crate::scene::Scene;
pub use estimate::Estimate;
use estimate::Tally;
use lamps::{Seen, Sent};
use local::Local;
use rows::{Rows, Surroundings, position_hash};
use stance::{Finder, Stance};
use vertices::Vertex;

/// Vertices looked at between two looks at commands.
const CHUNK: usize = 512;
/// Rays to lamps from a point, times the error that is allowed between vertices.
const LAMP_RAYS: f64 = 0.9;
/// Noise of direct light at vertices, as a share of the error that is allowed between them.
const DIRECT_NOISE: f64 = 0.7;
/// Splitting ends when it made many leaves and left more than this share of the squared error: noise does not fall by it.
const LEAST_GAIN: f64 = 0.95;
/// Leaves of less than this share of the mean area have no vertex in their middle.
const MIDDLE: f32 = 0.1;
/// Rounds of splitting leaves before rays are cast, and after the solution was found wanting.
const MOST_ROUNDS: u32 = 8;
/// Times that a solution is made finer because its error was estimated above the goal.
const MOST_ATTEMPTS: u32 = 6;
/// An attempt that leaves more than this share of the estimated error was in vain, and so would be the next one.
const LEAST_PROGRESS: f64 = 0.9;
/// More vertices than this are not made for the sake of the goal.
const MOST_VERTICES: usize = 1 << 21;
/// The allowed error is shared out to what lies between vertices and to the noise of their values.
const MESH_SHARE: f64 = 0.7;
const NOISE_SHARE: f64 = 0.5;
/// The next attempt aims below the goal by this factor.
const AIM: f64 = 0.85;
/// It allows for no less than this share of the error that was believed to lie between vertices.
const LEAST_STEP: f64 = 0.5;
/// Standard deviation of the light along one random ray, as a share of all, as low-discrepancy directions make it.
const SPREAD: f64 = 0.35;

/// What the gather reads of the solver.
pub struct Context<'a> {
    /// The scene.
    pub scene: &'a Scene,
    /// What stops light.
    pub occluders: &'a Occluders,
    /// Reflectance and emission of each polygon.
    pub surfaces: &'a [Surface],
    /// Seed of all random choices.
    pub seed: u64,
    /// Memory that the final gather may take, bytes.
    pub memory: usize,
}

/// Allowed errors, as shares of the RMS radiosity.
#[derive(Clone, Copy, Debug)]
struct Goal {
    /// Of everything: what was asked for.
    error: f64,
    /// Of values between vertices.
    mesh: f64,
    /// Noise of the vertices' values.
    noise: f64,
}

/// What is done next.
#[derive(Clone, Copy, Debug)]
enum Stage {
    /// Direct light at vertices from this one on.
    Direct(usize),
    /// Rays of the open pass, from this vertex on.
    Cast(usize),
    /// The estimate, from this point on.
    Estimate(usize, Tally),
    /// The goal is reached, or cannot be.
    Done,
}

/// Direct irradiance of a vertex, where it was looked for, and the rays that it took.
type Lit = (Vec3, Box<[Stance]>, u32);

/// What a step did.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Progress {
    /// A part of a pass.
    Part,
    /// A pass ended: there is something new to be seen.
    Pass,
    /// Nothing is left to do.
    Done,
}

/// The state of a final gather.
pub struct FinalGather {
    goal: Goal,
    /// Whether the error was asked for, and must be estimated.
    is_promise: bool,
    stage: Stage,
    round: u32,
    attempt: u32,
    last_error: Option<f64>,
    /// What was in doubt of local errors when the last attempt ended, and its error; as long as it is too large.
    local: Option<Local>,
    last_local: Option<f64>,
    /// The mesh, with middles.
    display: Display,
    vertices: Vec<Vertex>,
    /// Of each vertex, where it is looked at from; none where it is hidden.
    stances: Vec<Box<[Stance]>>,
    /// Direct irradiance of each vertex, W/m²; NaN where it is still to be found.
    direct: Vec<Vec3>,
    /// Indirect irradiance of each vertex, W/m².
    indirect: Vec<Vec3>,
    rows: Rows,
    /// Of leaves that were looked at and kept: sum of the squared errors of direct light that looks found, and number of looks.
    looks: FxHashMap<ElementId, (f64, u32)>,
    /// Σ A·|B|², W²/m²: of what links say, later of what was found when the present pass began.
    known_energy: f64,
    /// Squared error between the vertices, measured last, W²/m².
    mesh_error: f64,
    /// Whether the last round of splitting made many leaves.
    grew: bool,
    /// Noise of the vertices' values, measured last; infinite before.
    noise: f64,
    /// Variance of the light along one ray, as a share of the squared light; as measured.
    spread: f32,
    estimate: Option<Estimate>,
    /// Rays cast, those of former attempts and of looks at the error included.
    rays: u64,
    /// What memory did not allow.
    memory_stop: Option<MemoryStop>,
    sent: Sent,
    lamp_list: Arc<LampList>,
    /// The initial patch of each polygon.
    patches: Vec<ElementId>,
    /// Whether faces have dark sides, behind which points may lie.
    has_dark_sides: bool,
    diagonal: f32,
}

impl FinalGather {
    /// Starts with what links say of all and of the indirect irradiance (parallel to the hierarchy's arena, W/m²); `asked` is
    /// the RMS error that is asked for, as a share of the RMS radiosity. Where none is, the usual one is aimed at once, and what
    /// came of it is not looked at. `None` if cancelled.
    pub fn new(
        old: &Display,
        hierarchy: &Hierarchy,
        context: &Context,
        asked: Option<f64>,
        irradiance: &[Vec3],
        indirect: &[Vec3],
        cancel: &CancelToken,
    ) -> Option<Self> {
        let error = asked.unwrap_or(USUAL_ERROR);
        let leaves = &old.mesh.leaves;
        let mean_area = leaves.iter().map(|leaf| leaf.area).sum::<f32>() / leaves.len().max(1) as f32;
        let display = old.rebuilt(context.scene, hierarchy, Style::WithCentres(MIDDLE * mean_area));
        let (lower, upper) = context.scene.bounds();
        let mut patches = vec![Hierarchy::ROOT; context.scene.polygons.len()];
        for &id in hierarchy.initial_patches() {
            if let Shape::Patch(patch) = hierarchy.element(id).shape {
                patches[patch.polygon as usize] = id;
            }
        }
        let energy_of = |leaf: &super::Leaf| {
            let surface = &context.surfaces[leaf.polygon as usize];
            match surface.emission == Vec3::ZERO {
                true => {
                    f64::from(leaf.area * (surface.reflectance * irradiance[leaf.element.index()]).length_squared())
                }
                false => 0.0,
            }
        };
        let known_energy = leaves.iter().map(energy_of).sum();
        let sent = bright::what_is_sent(hierarchy, context, error, indirect, cancel)?;
        let indirect = display.of_vertices(indirect).into_iter().map(Vec3::from).collect();
        let mut gather = Self {
            goal: Goal { error, mesh: MESH_SHARE * error, noise: NOISE_SHARE * error },
            is_promise: asked.is_some(),
            stage: Stage::Direct(0),
            round: 0,
            attempt: 0,
            last_error: None,
            local: None,
            last_local: None,
            vertices: Vec::new(),
            stances: Vec::new(),
            direct: Vec::new(),
            indirect,
            rows: Rows::default(),
            looks: FxHashMap::default(),
            known_energy,
            mesh_error: f64::INFINITY,
            grew: false,
            noise: f64::INFINITY,
            spread: (SPREAD * SPREAD) as f32,
            estimate: None,
            rays: 0,
            memory_stop: None,
            sent,
            lamp_list: Arc::new(LampList::new(context.scene)),
            patches,
            has_dark_sides: context.scene.has_dark_sides(),
            diagonal: lower.distance(upper),
            display,
        };
        gather.take_mesh(context, FxHashMap::default());
        Some(gather)
    }

    /// Does one bounded piece of work; what it was about is done whole or, if cancelled, not at all.
    pub fn step(&mut self, hierarchy: &mut Hierarchy, context: &Context, cancel: &CancelToken) -> Option<Progress> {
        if cancel.is_cancelled() {
            return None;
        }
        let progress = match self.stage {
            Stage::Direct(first) => {
                let range = first..(first + CHUNK).min(self.vertices.len());
                self.find_direct(hierarchy, context, range.clone(), cancel)?;
                self.stage = Stage::Direct(range.end);
                if range.end < self.vertices.len() {
                    return Some(Progress::Part);
                }
                if self.round < MOST_ROUNDS && self.split(hierarchy, context, cancel)? {
                    self.round += 1;
                    self.stage = Stage::Direct(0);
                } else {
                    self.open_pass(context);
                }
                Progress::Pass
            }
            Stage::Cast(first) => {
                let range = first..(first + CHUNK).min(self.vertices.len());
                let chunk = self.rows.cast(&self.surroundings(hierarchy, context), range.clone(), cancel)?;
                self.rows.take(range.clone(), chunk);
                self.stage = Stage::Cast(range.end);
                if range.end < self.vertices.len() {
                    return Some(Progress::Part);
                }
                self.end_pass(cancel)?;
                if self.noise > self.goal.noise && self.has_room() {
                    self.open_pass(context);
                } else if self.is_promise {
                    self.stage = Stage::Estimate(0, Tally::default());
                } else {
                    self.stage = Stage::Done;
                }
                Progress::Pass
            }
            Stage::Estimate(first, tally) => {
                let mut tally = tally.add(self.look_at_points(hierarchy, context, first..first + CHUNK, cancel)?);
                let points = first + CHUNK;
                if points.is_multiple_of(estimate::POINTS)
                    && let Some(ruler) = tally.ruler()
                {
                    tally = self.doubt_point(hierarchy, context, tally, ruler, cancel)?;
                }
                self.stage = Stage::Estimate(points, tally);
                if points.is_multiple_of(estimate::POINTS) && tally.is_clear(self.goal.error, points) {
                    self.rays += tally.rays;
                    self.estimate = tally.estimate();
                    self.stage = self.after_estimate();
                }
                Progress::Part
            }
            Stage::Done => Progress::Done,
        };
        Some(progress)
    }

    /// Whether the goal is reached; if not, what comes next with a stricter aim.
    fn after_estimate(&mut self) -> Stage {
        let error = self.estimate.map_or(0.0, |estimate| estimate.cautious());
        let is_kept = error <= self.goal.error;
        let local = Some(self.local()).filter(|local| local.error > self.local_allowed());
        // What a finer mesh does not help is smaller than leaves may be.
        let is_vain = |last: Option<f64>, error: f64| last.is_some_and(|last| error > LEAST_PROGRESS * last);
        let was_in_vain = is_vain(self.last_error, error) && error > estimate::NEAR * self.goal.error;
        let local = local.filter(|local| !is_vain(self.last_local, local.error));
        self.last_error = Some(error);
        self.last_local = local.as_ref().map(|local| local.error).or(self.last_local);
        self.local = local;
        if was_in_vain || is_kept && self.local.is_none() {
            return Stage::Done;
        }
        if self.attempt >= MOST_ATTEMPTS || self.vertices.len() > MOST_VERTICES || !self.has_room() {
            return Stage::Done;
        }
        self.attempt += 1;
        self.round = 0;
        // What is not noise lies between the vertices.
        let between = |error: f64| (error.powi(2) - self.noise.powi(2)).max(0.0).sqrt();
        let (found, wanted) = (between(error), between(AIM * self.goal.error));
        if !is_kept && found > MESH_SHARE * self.goal.error {
            let believed = (self.mesh_error.max(0.0) / self.energy()).sqrt();
            self.goal.mesh = self.goal.mesh.min((wanted / found).max(LEAST_STEP) * believed);
        }
        if !is_kept && self.noise > NOISE_SHARE * self.goal.error {
            self.goal.noise *= (AIM * self.goal.error / error).max(LEAST_STEP);
        }
        Stage::Direct(self.vertices.len())
    }

    /// Estimated error, if there is an estimate yet.
    pub fn estimate(&self) -> Option<Estimate> {
        self.estimate
    }

    /// The mesh of the values.
    pub fn display(&self) -> &Display {
        &self.display
    }

    /// Whether there are values to be shown: the first pass has met every vertex.
    pub fn is_ready(&self) -> bool {
        self.round > 0 || self.attempt > 0 || !matches!(self.stage, Stage::Direct(_))
    }

    /// Rays cast.
    pub fn rays(&self) -> u64 {
        self.rays + self.rows.rays()
    }

    fn surroundings<'a>(&'a self, hierarchy: &'a Hierarchy, context: &'a Context) -> Surroundings<'a> {
        Surroundings {
            display: &self.display,
            hierarchy,
            occluders: context.occluders,
            stances: &self.stances,
            patches: &self.patches,
            sent: &self.sent,
            seed: context.seed,
        }
    }

    /// Rays to lamps that a point deserves.
    fn lamp_rays(&self) -> f32 {
        (LAMP_RAYS / self.goal.mesh).clamp(8.0, 512.0) as f32
    }

    fn find_direct(
        &mut self,
        hierarchy: &Hierarchy,
        context: &Context,
        range: Range<usize>,
        cancel: &CancelToken,
    ) -> Option<()> {
        if range.start == 0 && self.round > 0 {
            self.known_energy = self.energy();
        }
        let lamps = self.lamps(hierarchy, context);
        let darkness = self.darkness(context);
        let finder = Finder { display: &self.display, hierarchy, darkness: darkness.as_ref(), seed: context.seed };
        let energy = self.known_energy;
        let allowed = (DIRECT_NOISE * self.goal.mesh).powi(2) * energy / self.vertices.len() as f64;
        let find = |cut: &mut Vec<Seen>, vertex: usize| {
            let find = || {
                let seed = mix(context.seed, position_hash(&self.display, vertex));
                // Each vertex may hold its part of the error.
                let of = &self.vertices[vertex];
                let weight = f64::from(of.area * of.reflectance.length_squared()).max(f64::MIN_POSITIVE);
                let doubt = (allowed / weight).sqrt() as f32;
                let mut rays = 0;
                let (stances, irradiance) = finder.find(vertex, &mut |stance| {
                    let wanted = self.lamp_rays() * stance.weight;
                    let lit = lamps.irradiance(stance.position, stance.normal, wanted, doubt, seed, cut);
                    rays += lit.rays;
                    lit.irradiance
                });
                (irradiance, stances, rays)
            };
            (!cancel.is_cancelled()).then(|| self.direct[vertex].is_nan().then(find))
        };
        let found: Vec<Option<Lit>> =
            range.clone().into_par_iter().with_min_len(16).map_init(Vec::new, find).collect::<Option<_>>()?;
        for (vertex, found) in range.zip(found) {
            if let Some((irradiance, stances, rays)) = found {
                (self.direct[vertex], self.stances[vertex]) = (irradiance, stances);
                self.rays += u64::from(rays);
            }
        }
        Some(())
    }

    /// Splits the leaves in which light at random points is not what the vertices around say; whether there were any, `None` if
    /// cancelled.
    fn split(&mut self, hierarchy: &mut Hierarchy, context: &Context, cancel: &CancelToken) -> Option<bool> {
        let look = self.look_at_leaves(hierarchy, context, cancel)?;
        self.rays += look.rays;
        let allowed = self.goal.mesh * self.goal.mesh * self.energy();
        let mesh = self.display.mesh.clone();
        let known = std::mem::take(&mut self.looks);
        for (leaf, direct) in mesh.leaves.iter().zip(&look.direct) {
            let (sum, count) = known.get(&leaf.element).copied().unwrap_or_default();
            self.looks.insert(leaf.element, (sum + direct, count + 1));
        }
        let errors = self.errors_of_leaves();
        let error = errors.iter().sum::<f64>();
        let is_vain = self.round > 0 && self.grew && error > LEAST_GAIN * self.mesh_error;
        self.mesh_error = error;
        let local = self.doubtful_leaves();
        if (error <= allowed || is_vain) && local.is_empty() || self.vertices.len() > MOST_VERTICES {
            return Some(false);
        }
        let threshold = if error <= allowed { f64::INFINITY } else { split::threshold(&errors, allowed) };
        let is_split = |leaf: usize| errors[leaf] >= threshold || local.binary_search(&leaf).is_ok();
        let split = (0..errors.len()).filter(|leaf| is_split(*leaf)).count();
        if self.bytes() + 4 * split * GATHERED_LEAF > context.memory {
            self.memory_stop = Some(MemoryStop::Vertices);
            return Some(false);
        }
        for (_, leaf) in mesh.leaves.iter().enumerate().filter(|(index, _)| is_split(*index)) {
            hierarchy.subdivide(leaf.element);
            self.looks.remove(&leaf.element);
        }
        let new = self.display.rebuilt(context.scene, hierarchy, self.display.style());
        self.grew = 10 * new.mesh.leaves.len() > 11 * mesh.leaves.len();
        let former = std::mem::replace(&mut self.display, new);
        let of_vertex = std::mem::take(&mut self.direct).into_iter().zip(std::mem::take(&mut self.stances));
        let known: FxHashMap<VertexKey, _> = former.keys().iter().copied().zip(of_vertex).collect();
        let indirect: FxHashMap<VertexKey, Vec3> =
            former.keys().iter().copied().zip(std::mem::take(&mut self.indirect)).collect();
        self.indirect = self.interpolated(&indirect);
        self.take_mesh(context, known);
        Some(true)
    }

    /// Squared error of each leaf, A·(ρ·ΔE)², as far as looks and rows tell.
    fn errors_of_leaves(&self) -> Vec<f64> {
        let of = |(index, leaf): (usize, &super::Leaf)| {
            let direct = self.looks.get(&leaf.element).map_or(0.0, |(sum, count)| sum / f64::from(*count));
            direct + self.indirect_error(index)
        };
        self.display.mesh.leaves.iter().enumerate().map(of).collect()
    }

    /// Tables of the present mesh; `known` is what was found before.
    fn take_mesh(&mut self, context: &Context, mut known: FxHashMap<VertexKey, (Vec3, Box<[Stance]>)>) {
        self.vertices = vertices::of_mesh(&self.display, context.scene);
        let of = |key: &VertexKey| known.remove(key).unwrap_or((Vec3::NAN, Box::default()));
        (self.direct, self.stances) = self.display.keys().iter().map(of).unzip();
        self.rays += self.rows.rays();
        self.rows = Rows::new(self.vertices.len());
        self.noise = f64::INFINITY;
    }
}
