//! The gather: light at points, over what the links know.
//!
//! Links know how much light the elements exchange, in the mean over each. A gather starts from
//! that and looks around from each leaf: rays aimed at the emitters, and cosine-distributed rays
//! that end on other leaves [a final gather over a coarse solution, Lischinski, Tampieri, Greenberg
//! 93]. Leaves are split where emitters light them unevenly, and light is moved over the rays until
//! nothing changes, so that the links' own errors die out. What comes of it is a [`Field`], and
//! light anywhere is one look from there ([`Field::irradiance_at`]): probes, work planes, pictures
//! and the [`certificate`] all ask that.
//!
//! The links' solution is read, never written.

mod bound;
pub mod certificate;
mod compared;
mod daylight;
mod estimator;
mod facet;
mod field;
mod glance;
mod groups;
mod looks;
mod openings;
mod passes;
mod patches;
mod reaching;
mod refine;
mod relight;
mod samples;
mod source_tree;
mod sources;

use glam::Vec3;

pub use bound::Quantiles;
pub use certificate::{Certificate, Certifying, NOISE, RISK};
pub use estimator::{Checked, Irradiance};
pub use field::{Field, Met, grey};
pub use glance::{GatherPoint, Glance, GlanceRays};
use passes::{AGAIN, AIMED, MESH_PER_TARGET, MOST_ROUNDS, planned_looks, whole_numbers};
use refine::Importance;
use samples::{GatherSamples, Queue};

use crate::base::cancel::CancelToken;
use crate::base::random::hash64;
use crate::transport::LinkSolution;
use groups::Groups;
use reaching::Reaching;

/// The target error where nobody asks for one: 9 of 10 surfaces are read within it.
pub const USUAL_ERROR: f64 = 0.05;

/// Times that a field is made finer because its error was found above the target.
const MOST_ATTEMPTS: u32 = 4;
/// An attempt that leaves more than this of the share beyond the target was in vain, and so would
/// be the next one.
const LEAST_PROGRESS: f64 = 0.9;
/// Share of the risk that is left which an attempt may take.
const RISK_OF_ATTEMPT: f64 = 0.5;
/// An attempt takes the rays of all before it, times this, at most; the certificate's come on top.
const MOST_GROWTH: u64 = 2;
/// Shares of an attempt's time that go into direct light and into cosine-distributed rays; the
/// certificate takes the rest.
const DIRECT_SHARE: f32 = 0.2;
const CAST_SHARE: f32 = 0.5;

/// Target of a gather, and its limits.
#[derive(Clone, Copy, Debug)]
pub struct Goal {
    /// The target error, if one is asked for.
    pub error: Option<f64>,
    /// Memory that it may take, bytes.
    pub memory: usize,
    /// Seed of all random choices.
    pub seed: u64,
}

/// Stage of a gather.
#[derive(Clone, Debug)]
enum Stage {
    /// Finds out which leaves light reaches.
    Reach,
    /// Looks for emitters from the queued leaves, from this place on.
    Direct(usize),
    /// Casts the rays of a pass from the queued leaves, from this place on.
    Cast(usize),
    /// Compares readings with a second gather.
    Certify(Box<Certifying>),
    /// Nothing is left to do.
    Done,
}

/// Outcome of a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Progress {
    /// A part of a pass.
    Part,
    /// A pass ended: there is something new to be seen.
    Pass,
    /// Nothing is left to do.
    Done,
}

/// A gather at work.
pub struct Gather {
    field: Field,
    samples: GatherSamples,
    /// Indirect irradiance of each leaf by the links, W/m², parallel to the arena.
    of_links: Vec<Vec3>,
    /// The search for leaves that light reaches, until it is done.
    reaching: Option<Reaching>,
    /// Irradiance of each leaf by the links (mean of the colours), W/m², until leaves are grouped
    /// by it.
    lit: Vec<f32>,
    /// Leaves that share looks.
    groups: Groups,
    /// Share that each leaf's light has in its readers', as the former attempt found it.
    importance: Importance,
    goal: Goal,
    stage: Stage,
    queue: Queue,
    round: u32,
    /// Whether the field's light was moved over cosine-distributed rays, so that nothing is left of
    /// the links' own.
    is_lit_by_samples: bool,
    attempt: u32,
    /// The error that leaves and rays are made for; falls with each attempt.
    aim: f64,
    certificate: Option<Certificate>,
    /// The former attempt's comparison.
    before: Option<Box<Certifying>>,
    /// Risk that is left to certificates to come.
    risk: f64,
    /// Rays that compared.
    rays_compared: u64,
    /// Rays that samples of this attempt may lead to.
    most_rays: u64,
    is_ready: bool,
    full: Option<Full>,
}

/// The part of a gather that memory kept from being as fine as was asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Full {
    /// The leaves.
    Leaves,
    /// The looks from them.
    Looks,
}

impl Gather {
    /// Starts over a links' solution; `None` if cancelled.
    pub fn new(links: &LinkSolution, goal: Goal, cancel: &CancelToken) -> Option<Self> {
        let of_links = links.indirect(cancel)?;
        let field = Field::new(links, of_links.clone());
        Some(Self {
            samples: GatherSamples::after(field.opening_rays()),
            of_links,
            reaching: Some(Reaching::new(&field, goal.seed)),
            lit: links.light().irradiance.iter().map(|light| grey(*light)).collect(),
            groups: Groups::default(),
            importance: Importance::default(),
            stage: Stage::Reach,
            queue: Queue::new(),
            round: 0,
            is_lit_by_samples: false,
            attempt: 0,
            aim: goal.error.unwrap_or(USUAL_ERROR),
            goal: Goal { seed: hash64(goal.seed, 0x6761_7468_6572), ..goal },
            certificate: None,
            before: None,
            risk: RISK,
            rays_compared: 0,
            most_rays: u64::MAX,
            is_ready: false,
            full: None,
            field,
        })
    }

    /// Queues looks from what light reaches.
    fn begin(&mut self, reaching: &Reaching) {
        self.samples = GatherSamples::after(self.field.opening_rays() + reaching.rays);
        let dark: Vec<bool> = self.field.hierarchy.ids().map(|id| !reaching.is_lit(id)).collect();
        for leaf in self.field.leaves().filter(|leaf| dark[leaf.index()]) {
            self.of_links[leaf.index()] = Vec3::ZERO;
        }
        let count = dark.iter().filter(|is_dark| **is_dark).count();
        tracing::debug!(dark = count, rays = reaching.rays, "leaves that no light reaches found");
        self.field.set_dark(dark);
        let planned = planned_looks(&self.field, &self.importance);
        self.groups = Groups::new(&self.field, &std::mem::take(&mut self.lit), &planned);
        let looks = whole_numbers(self.field.leaves().map(|leaf| (leaf, planned(leaf))));
        let queue = looks.filter(|(_, looks)| *looks > 0).collect();
        drop(planned);
        self.field.set_reaches(&self.groups);
        (self.queue, self.stage) = (queue, Stage::Direct(0));
    }

    /// Does one bounded piece of work; what it was about is done whole or, if cancelled, not at
    /// all.
    pub fn step(&mut self, cancel: &CancelToken) -> Option<Progress> {
        if cancel.is_cancelled() {
            return None;
        }
        match self.stage.clone() {
            Stage::Reach => {
                let is_done = match &mut self.reaching {
                    Some(reaching) => reaching.advance(&self.field, cancel)?,
                    None => true,
                };
                if let Some(reaching) = self.reaching.take_if(|_| is_done) {
                    self.begin(&reaching);
                }
                Some(Progress::Part)
            }
            Stage::Direct(first) => {
                if first < self.queue.len() {
                    let next = self.draw(first, GlanceRays { aimed: AIMED, cosine: 0 }, cancel)?;
                    self.stage = Stage::Direct(next);
                    return Some(Progress::Part);
                }
                // To move light passes over all leaves, so it is done once a round.
                if self.round < MOST_ROUNDS {
                    let allowed = MESH_PER_TARGET * self.aim;
                    let mut looks = refine::leaves_to_look_from(&self.field, &self.samples, &self.importance, allowed);
                    self.afford(&mut looks, AIMED);
                    if !looks.is_empty() {
                        self.queue = looks;
                        self.stage = Stage::Direct(0);
                        return Some(Progress::Part);
                    }
                }
                self.relight(cancel)?;
                self.is_ready = true;
                self.refine(cancel)?;
                Some(Progress::Pass)
            }
            Stage::Cast(first) => {
                if first < self.queue.len() {
                    let next = self.draw(first, self.rays_of_look(), cancel)?;
                    self.stage = Stage::Cast(next);
                    return Some(Progress::Part);
                }
                self.relight(cancel)?;
                let risk = RISK_OF_ATTEMPT * self.risk;
                let mut certifying = Certifying::new(&self.field, self.target(), risk, self.goal.seed);
                if self.goal.error.is_none() {
                    certifying.be_thorough();
                }
                self.stage = Stage::Certify(Box::new(certifying));
                Some(Progress::Pass)
            }
            Stage::Certify(mut certifying) => {
                certifying.advance(&self.field, cancel)?;
                let Some(certificate) = certifying.certificate() else {
                    self.stage = Stage::Certify(certifying);
                    return Some(Progress::Part);
                };
                self.judge(certificate, certifying);
                Some(if matches!(self.stage, Stage::Done) { Progress::Done } else { Progress::Part })
            }
            Stage::Done => Some(Progress::Done),
        }
    }

    fn target(&self) -> f64 {
        self.goal.error.unwrap_or(USUAL_ERROR)
    }

    /// Ends, or makes the field finer.
    fn judge(&mut self, certificate: Certificate, mut certifying: Box<Certifying>) {
        let is_kept = self.goal.error.is_none_or(|target| certificate.bound <= target);
        let is_in_vain = self.before.as_ref().is_some_and(|before| {
            let [before, now] = certifying.beside(before);
            now > LEAST_PROGRESS * before
        });
        self.certificate = Some(certificate);
        let is_last = is_in_vain || self.full.is_some() || self.attempt >= MOST_ATTEMPTS;
        if is_last && !is_kept && certifying.has_more() {
            certifying.be_thorough();
            self.stage = Stage::Certify(certifying);
            return;
        }
        self.rays_compared += certifying.rays();
        self.risk -= certifying.risk_taken();
        if is_kept || is_last {
            self.stage = Stage::Done;
            return;
        }
        self.before = Some(certifying);
        self.most_rays = (1 + MOST_GROWTH) * self.rays();
        self.attempt += 1;
        self.aim *= 0.5;
        self.round = MOST_ROUNDS - AGAIN;
        self.importance = Importance::of(&self.field, &self.samples, &self.groups);
        // The next round begins with nothing to look for.
        self.queue.clear();
        self.stage = Stage::Direct(0);
    }

    /// The state of the light.
    pub fn field(&self) -> &Field {
        &self.field
    }

    /// The number of the attempt, and the share of it that is done, as far as can be known.
    pub fn progress(&self) -> (u32, f32) {
        let share_of_queue = |first: usize| first as f32 / self.queue.len().max(1) as f32;
        let share = match &self.stage {
            Stage::Reach => 0.0,
            // Rounds of splitting have fewer leaves each.
            Stage::Direct(first) => {
                DIRECT_SHARE * (1.0 - 0.5_f32.powi(self.round as i32) * (1.0 - 0.5 * share_of_queue(*first)))
            }
            Stage::Cast(first) => DIRECT_SHARE + CAST_SHARE * share_of_queue(*first),
            Stage::Certify(certifying) => {
                DIRECT_SHARE + CAST_SHARE + (1.0 - DIRECT_SHARE - CAST_SHARE) * certifying.progress()
            }
            Stage::Done => 1.0,
        };
        (self.attempt, share)
    }

    /// The local error within which nine tenths of the area are, by the points compared so far: of
    /// this attempt once there are some, else of the one before.
    pub fn error_so_far(&self) -> Option<f64> {
        let now = match &self.stage {
            Stage::Certify(certifying) => certifying.error_so_far(),
            _ => None,
        };
        now.or(self.certificate.as_ref().map(|certificate| certificate.read.p90))
    }

    /// Whether there is something to be shown.
    pub fn is_ready(&self) -> bool {
        self.is_ready
    }

    /// The part that memory kept from being as fine as was asked for, if any.
    pub fn full(&self) -> Option<Full> {
        self.full
    }

    /// Rays cast.
    pub fn rays(&self) -> u64 {
        self.samples.rays + self.rays_compared
    }

    /// The newest certificate, once there is one.
    pub fn certificate(&self) -> Option<&Certificate> {
        self.certificate.as_ref()
    }

    /// Memory, bytes.
    pub fn bytes(&self) -> usize {
        self.field.bytes() + self.samples.bytes() + self.groups.bytes() + size_of_val(&self.of_links[..])
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::geometry::Occluders;
    use crate::scene::builtin::BuiltinScene;
    use crate::solve::{Solver, SolverParams};

    impl Gather {
        /// A gather to 5 % over coarse links of the Cornell box, before its first step.
        pub(super) fn of_cornell() -> Self {
            let scene = Arc::new(BuiltinScene::Cornell.build());
            let occluders = Arc::new(Occluders::new(&scene));
            let params = SolverParams::with_epsilon(1e-2);
            let mut solver = Solver::new(scene, occluders, params, 1).expect("usable parameters");
            let never = CancelToken::new();
            assert!(solver.run(&never));
            let goal = Goal { error: Some(0.05), memory: 1 << 30, seed: 1 };
            Self::new(solver.link_solution(), goal, &never).expect("nobody cancels")
        }
    }
}
