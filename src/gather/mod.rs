//! The gather: light at points, over what the links know.
//!
//! Links know how much light the elements exchange, in the mean over each. A gather starts from that
//! and looks around from each leaf: rays aimed at the emitters, and cosine-distributed rays that end on
//! other leaves [a final gather over a coarse solution, Lischinski, Tampieri, Greenberg 93]. Leaves are
//! split where emitters light them unevenly, and light is moved over the rays until nothing changes, so
//! that the links' own errors die out. What comes of it is a [`Field`], and light anywhere is one look
//! from there ([`Field::irradiance_at`]): probes, work planes, pictures and the [`certificate`] all ask
//! that.
//!
//! The links' solution is read, never written.

mod bound;
pub mod certificate;
mod daylight;
mod estimator;
mod facet;
mod field;
mod glance;
mod refine;
mod samples;
mod sources;

use glam::Vec3;

pub use bound::Quantiles;
pub use certificate::{Certificate, Certifying, NOISE, RISK};
pub use estimator::{Checked, Irradiance};
pub use field::{Field, Met, grey};
pub use glance::{GatherPoint, Glance, GlanceRays};
use samples::{GatherSamples, Queue};

use crate::base::cancel::CancelToken;
use crate::base::random::mix;
use crate::hierarchy::ElementId;
use crate::transport::LinkSolution;

/// The target error where nobody asks for one: 9 of 10 surfaces are read within it.
pub const USUAL_ERROR: f64 = 0.05;

/// Looks between two looks at commands, as far as leaves are not looked from more often.
const CHUNK: u32 = 4096;
/// Rays of a look from a leaf that are aimed, an even number.
const AIMED: u32 = 4;
/// Looks from a leaf that tell how light differs over it: one from each quarter.
const LOOKS: u32 = 4;
/// Cosine-distributed rays of a look, times the target error.
const COSINE: f64 = 0.4;
/// Looks from all leaves together, by what they count, of which each gets one to [`LOOKS`]: where a hundred thousand small faces
/// share the light, one look from each says as much of it.
const LOOKS_FOR_ALL: f64 = 4e5;
/// Cosine-distributed rays that are shared out by the power that leaves send, times the square of the target error:
/// the noise of what a leaf sends is shared by all who read it.
const RAYS_BY_POWER: f64 = 500.0;
/// Looks from a leaf for that, at most.
const MOST_LOOKS: f64 = 2000.0;
/// Variation of direct light over a leaf that is allowed, as a multiple of the target error: readings look for
/// emitters themselves, so the field is to be right in the mean alone.
const MESH_PER_TARGET: f64 = 1.5;
/// Rounds of splitting leaves.
const MOST_ROUNDS: u32 = 6;
/// Sweeps end when they move less than this share of the light.
const SWEEP_TOLERANCE: f64 = 2e-4;
const MOST_SWEEPS: u32 = 200;
/// Times that a field is made finer because its error was found above the target.
const MOST_ATTEMPTS: u32 = 4;
/// An attempt that leaves more than this share of the error was in vain, and so would be the next one.
const LEAST_PROGRESS: f64 = 0.9;
/// An attempt takes the rays of all before it, times this, at most; the certificate's come on top.
const MOST_GROWTH: u64 = 2;
/// Shares of an attempt's time that go into direct light and into cosine-distributed rays; the certificate takes the rest.
const DIRECT_SHARE: f32 = 0.2;
const CAST_SHARE: f32 = 0.5;
/// Bytes of a leaf with what is kept of it beside its samples.
const LEAF_BYTES: usize = 600;
/// Bytes of a look beside those of its cosine-distributed rays, four each.
const LOOK_BYTES: usize = 72;

/// What is asked of a gather.
#[derive(Clone, Copy, Debug)]
pub struct Goal {
    /// The target error, if one is asked for.
    pub error: Option<f64>,
    /// Memory that it may take, bytes.
    pub memory: usize,
    /// Seed of all random choices.
    pub seed: u64,
}

/// What is done next.
#[derive(Clone, Debug)]
enum Stage {
    /// Looks for emitters from the queued leaves, from this place on.
    Direct(usize),
    /// Casts the rays of a pass from the queued leaves, from this place on.
    Cast(usize),
    /// Compares with light that is looked for anew.
    Certify(Box<Certifying>),
    /// Nothing is left to do.
    Done,
}

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

/// A gather at work.
pub struct Gather {
    field: Field,
    samples: GatherSamples,
    /// Indirect irradiance of each leaf by the links, W/m², parallel to the arena.
    of_links: Vec<Vec3>,
    goal: Goal,
    stage: Stage,
    queue: Queue,
    round: u32,
    /// Whether uneven leaves were split in this attempt.
    is_evened: bool,
    attempt: u32,
    /// The error that leaves and rays are made for; falls with each attempt.
    aim: f64,
    certificate: Option<Certificate>,
    /// What the attempt before found nine tenths of the area to be within.
    before: Option<f64>,
    /// Rays that compared.
    rays_compared: u64,
    /// Rays that samples of this attempt may lead to.
    most_rays: u64,
    is_ready: bool,
    full: Option<Full>,
}

/// What memory kept from being as fine as was asked for.
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
        let looks_of = looks_of_each(&field);
        let queue = field.leaves().map(|leaf| (leaf, looks_of(leaf))).collect();
        drop(looks_of);
        Some(Self {
            samples: GatherSamples::default(),
            of_links,
            stage: Stage::Direct(0),
            queue,
            round: 0,
            is_evened: false,
            attempt: 0,
            aim: goal.error.unwrap_or(USUAL_ERROR),
            goal: Goal { seed: mix(goal.seed, 0x6761_7468_6572), ..goal },
            certificate: None,
            before: None,
            rays_compared: 0,
            most_rays: u64::MAX,
            is_ready: false,
            full: None,
            field,
        })
    }

    /// Does one bounded piece of work; what it was about is done whole or, if cancelled, not at all.
    pub fn step(&mut self, cancel: &CancelToken) -> Option<Progress> {
        if cancel.is_cancelled() {
            return None;
        }
        match self.stage.clone() {
            Stage::Direct(first) => {
                if first < self.queue.len() {
                    let next = self.draw(first, GlanceRays { aimed: AIMED, cosine: 0 }, cancel)?;
                    self.stage = Stage::Direct(next);
                    return Some(Progress::Part);
                }
                self.relight(cancel)?;
                self.is_ready = true;
                if self.round < MOST_ROUNDS {
                    let mut looks = refine::leaves_to_look_from(&self.field, &self.samples, MESH_PER_TARGET * self.aim);
                    self.afford(&mut looks, AIMED);
                    if !looks.is_empty() {
                        self.queue = looks;
                        self.stage = Stage::Direct(0);
                        return Some(Progress::Part);
                    }
                }
                let split = self.leaves_to_split();
                if split.is_empty() {
                    self.open_pass();
                } else {
                    self.split(&split);
                }
                Some(Progress::Pass)
            }
            Stage::Cast(first) => {
                if first < self.queue.len() {
                    let next = self.draw(first, self.rays_of_look(), cancel)?;
                    self.stage = Stage::Cast(next);
                    return Some(Progress::Part);
                }
                self.relight(cancel)?;
                if !std::mem::replace(&mut self.is_evened, true) {
                    let split = self.within_memory(refine::uneven_leaves(&self.field));
                    if !split.is_empty() {
                        self.split(&split);
                        return Some(Progress::Pass);
                    }
                }
                let seed = mix(self.goal.seed, u64::from(self.attempt));
                let mut certifying = Certifying::new(&self.field, self.target(), self.attempt, seed);
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

    /// What is cast in each look of a pass; the same in all passes, so that their samples count alike.
    fn rays_of_look(&self) -> GlanceRays {
        GlanceRays { aimed: AIMED, cosine: ((COSINE / self.target()) as u32).clamp(4, 64) & !1 }
    }

    /// Looks from the next chunk of the queue; where the one after it starts.
    fn draw(&mut self, first: usize, rays: GlanceRays, cancel: &CancelToken) -> Option<usize> {
        let mut looks = 0;
        let part = self.queue[first..].iter().take_while(|(_, of_leaf)| {
            let has_room = looks < CHUNK;
            looks += of_leaf;
            has_room
        });
        let end = first + part.count();
        let is_done = self.samples.draw(&self.field, &self.queue[first..end], rays, self.goal.seed, cancel);
        is_done.then_some(end)
    }

    fn leaves_to_split(&mut self) -> Vec<ElementId> {
        if self.round >= MOST_ROUNDS {
            return Vec::new();
        }
        self.within_memory(refine::leaves_to_split(&self.field, &self.samples, MESH_PER_TARGET * self.aim))
    }

    /// The leaves to split, or none where there is no room for their parts.
    fn within_memory(&mut self, split: Vec<ElementId>) -> Vec<ElementId> {
        let leaves = self.field.hierarchy.leaf_count() + 3 * split.len();
        let of_looks = LOOKS as usize * (4 * self.rays_of_look().cosine as usize + LOOK_BYTES);
        if leaves * (LEAF_BYTES + of_looks) > self.goal.memory {
            self.full.get_or_insert(Full::Leaves);
            return Vec::new();
        }
        split
    }

    fn split(&mut self, leaves: &[ElementId]) {
        self.round += 1;
        self.field.split(leaves);
        self.of_links.resize(self.field.hierarchy.elements().len(), Vec3::ZERO);
        let mut queue = Queue::new();
        for leaf in leaves {
            for child in self.field.hierarchy.element(*leaf).children() {
                self.of_links[child.index()] = self.of_links[leaf.index()];
                queue.push((child, LOOKS));
            }
        }
        self.queue = queue;
        self.stage = Stage::Direct(0);
    }

    /// Aims at what is bright from now on, and queues all leaves for cosine-distributed rays: some for each, and for those
    /// that send much, more.
    fn open_pass(&mut self) {
        self.field.find_secondary();
        let field = &self.field;
        let sent = |leaf: ElementId| f64::from(field.area(leaf) * field.reflected[leaf.index()].max_element());
        let total: f64 = field.leaves().map(sent).sum();
        let cosine = self.rays_of_look().cosine;
        let by_power = RAYS_BY_POWER / (self.aim * self.aim) / f64::from(cosine);
        let (looks_of, finer) = (looks_of_each(field), (self.target() / self.aim).round() as u32);
        let looks = |leaf: ElementId| {
            let more = (by_power * sent(leaf) / total.max(f64::MIN_POSITIVE)).min(MOST_LOOKS).round() as u32;
            // Later passes add to what is there.
            (finer * looks_of(leaf) + more).saturating_sub(self.samples.whole_looks(leaf))
        };
        let mut queue: Queue = field.leaves().map(|leaf| (leaf, looks(leaf))).filter(|(_, looks)| *looks > 0).collect();
        self.afford(&mut queue, AIMED + cosine);
        // An end of a ray takes four bytes.
        let bytes: usize = queue.iter().map(|(_, looks)| *looks as usize * (4 * cosine as usize + LOOK_BYTES)).sum();
        if bytes > self.goal.memory.saturating_sub(self.bytes()) {
            self.full.get_or_insert(Full::Looks);
            queue.iter_mut().for_each(|(leaf, looks)| {
                *looks = (*looks).min(u32::from(self.samples.whole_looks(*leaf) == 0));
            });
            queue.retain(|(_, looks)| *looks > 0);
        }
        self.queue = queue;
        self.stage = Stage::Cast(0);
    }

    /// Takes from a queue what this attempt has no rays for.
    fn afford(&self, queue: &mut Queue, rays_of_look: u32) {
        let planned: u64 = queue.iter().map(|(_, looks)| u64::from(looks * rays_of_look)).sum();
        let share = self.most_rays.saturating_sub(self.rays()) as f64 / planned.max(1) as f64;
        if share < 1.0 {
            queue.iter_mut().for_each(|(_, looks)| *looks = ((share * f64::from(*looks)) as u32).max(1));
        }
    }

    /// Moves light over the samples until nothing changes.
    fn relight(&mut self, cancel: &CancelToken) -> Option<()> {
        let mut field = self.field.clone();
        if self.samples.has_cosine() {
            // From emission alone: what links let through a wall would take long to die out.
            let direct = self.field.hierarchy.ids().map(|leaf| self.samples.direct(leaf).0);
            field.set_irradiance(direct.collect());
        }
        for _ in 0..MOST_SWEEPS {
            let gathered = self.samples.irradiance(&field, &field.reflected, &self.of_links, cancel)?;
            let before = field.reflected.clone();
            field.set_areas(|leaf| self.samples.seen_share(leaf));
            field.set_irradiance(gathered.mean);
            let (mut moved, mut all) = (0.0, 0.0);
            for leaf in field.leaves() {
                let (area, new) = (field.area(leaf), field.reflected[leaf.index()]);
                moved += f64::from(area * (new - before[leaf.index()]).abs().max_element());
                all += f64::from(area * new.max_element());
            }
            if moved <= SWEEP_TOLERANCE * all {
                field.set_far(&gathered.far, gathered.variance);
                break;
            }
        }
        self.field = field;
        Some(())
    }

    /// Ends, or makes the field finer.
    fn judge(&mut self, certificate: Certificate, mut certifying: Box<Certifying>) {
        let now = certificate.read.p90;
        let is_kept = self.goal.error.is_none_or(|target| certificate.bound <= target);
        let is_in_vain = self.before.is_some_and(|before| now > LEAST_PROGRESS * before);
        self.certificate = Some(certificate);
        let is_last = is_in_vain || self.full.is_some() || self.attempt >= MOST_ATTEMPTS;
        if is_last && !is_kept && certifying.has_more() {
            certifying.be_thorough();
            self.stage = Stage::Certify(certifying);
            return;
        }
        self.rays_compared += certifying.rays();
        if is_kept || is_last {
            self.stage = Stage::Done;
            return;
        }
        self.before = Some(now);
        self.most_rays = (1 + MOST_GROWTH) * self.rays();
        self.attempt += 1;
        self.aim *= 0.5;
        self.round = MOST_ROUNDS - 1;
        self.is_evened = false;
        let split = self.leaves_to_split();
        if split.is_empty() { self.open_pass() } else { self.split(&split) }
    }

    /// The state of the light.
    pub fn field(&self) -> &Field {
        &self.field
    }

    /// The number of the attempt, and the share of it that is done, as far as can be told.
    pub fn progress(&self) -> (u32, f32) {
        let share_of_queue = |first: usize| first as f32 / self.queue.len().max(1) as f32;
        let share = match &self.stage {
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

    /// The local error within which nine tenths of the area are, by the points compared so far: of this attempt once there are
    /// some, else of the one before.
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

    /// What memory kept from being as fine as was asked for.
    pub fn full(&self) -> Option<Full> {
        self.full
    }

    /// Rays cast.
    pub fn rays(&self) -> u64 {
        self.samples.rays + self.rays_compared
    }

    /// What is known of the error, once it is.
    pub fn certificate(&self) -> Option<&Certificate> {
        self.certificate.as_ref()
    }

    /// Memory, bytes.
    pub fn bytes(&self) -> usize {
        self.field.bytes() + self.samples.bytes() + size_of_val(&self.of_links[..])
    }
}

/// Looks from a leaf that are made in any case.
fn looks_of_each(field: &Field) -> impl Fn(ElementId) -> u32 {
    let share = refine::share_of(field);
    move |leaf| (LOOKS_FOR_ALL * share(leaf)).clamp(1.0, f64::from(LOOKS)).round() as u32
}
