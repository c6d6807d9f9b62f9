//! A thread beside the solver's that makes a reference of a scene and measures snapshots by it.
//!
//! It has half of the machine's threads, makes pass after pass of paths until the reference is good
//! enough, and measures the newest snapshot in between. Like the solver's thread it never waits for
//! its owner, nor its owner for it.

use std::sync::Arc;
use std::time::{Duration, Instant};

use crate::base::actor::{Actor, Desk};
use crate::measure::accuracy::{ErrorMeter, ScatteredField, SolutionError};
use crate::measure::reference::{Cache, LEAST_PASSES, ReferenceRun, SAVE_EVERY, random_points};
use crate::scene::Scene;
use crate::solve::{Mesh, Snapshot};

/// Noise at which a reference is good enough, relative RMS.
pub const GOAL: f64 = 0.01;
/// A snapshot is measured again by a better reference this often at most.
const MEASURE_EVERY: Duration = Duration::from_millis(400);
/// Seed of points and paths.
const SEED: u64 = 1;

/// How a snapshot compares with the reference.
pub struct Measurement {
    /// The snapshot.
    pub snapshot: Arc<Snapshot>,
    /// Error of the snapshot by the reference.
    pub error: SolutionError,
    /// Signed relative error of B at each vertex of its mesh, from the points nearby; NaN where
    /// none is near.
    pub differences: Vec<f32>,
    /// Counts up; tells measurements of one snapshot apart.
    pub serial: u64,
}

/// State and findings of the thread.
#[derive(Clone, Default)]
pub struct Report {
    /// Whether there is a scene to make a reference of.
    pub is_active: bool,
    /// Relative RMS noise of the reference, once that is known.
    pub noise: Option<f64>,
    /// Passes of paths made so far, of [`LEAST_PASSES`] before any noise is known.
    pub passes: u32,
    /// Seconds until the noise is as low as [`GOAL`], once there is an estimate
    /// ([`ReferenceRun::passes_left`]).
    pub seconds_left: Option<f64>,
    /// Whether the noise is as low as [`GOAL`].
    pub is_done: bool,
    /// Points of the reference.
    pub points: usize,
    /// Why the reference is not kept on disk, if so; one sentence.
    pub cache_failure: Option<String>,
    /// The newest measurement.
    pub measured: Option<Arc<Measurement>>,
}

enum Ask {
    Begin { scene: Arc<Scene>, points: usize, cache: Option<Cache> },
    Measure(Arc<Snapshot>),
    Forget,
}

/// The thread; dropping it lets the thread end by itself.
pub struct ReferenceWorker(Actor<Ask, Report>);

impl ReferenceWorker {
    /// Starts the thread. `wake` is called on it whenever there is something new; it must not
    /// block.
    ///
    /// # Errors
    /// The system gives no further thread.
    pub fn spawn(wake: Box<dyn Fn() + Send>) -> std::io::Result<Self> {
        let run = |desk| Session { desk, work: None, waiting: None, serial: 0 }.run();
        Actor::spawn("reference_worker", wake, run).map(Self)
    }

    /// Makes a reference at so many points of a scene, whose faces are turned and doubled as it is
    /// solved; goes on with what the cache has. A reference that is being made is forgotten.
    pub fn begin(&self, scene: Arc<Scene>, points: usize, cache: Option<Cache>) {
        self.0.ask_instead(Ask::Begin { scene, points, cache });
    }

    /// Measures a snapshot of that scene as soon as there is time; of several that wait only the
    /// last is measured.
    pub fn measure(&self, snapshot: Arc<Snapshot>) {
        self.0.ask(Ask::Measure(snapshot));
    }

    /// Stops and forgets the reference.
    pub fn forget(&self) {
        self.0.ask_instead(Ask::Forget);
    }

    /// State and findings of the thread as they are now.
    pub fn report(&self) -> Report {
        self.0.report()
    }
}

/// A reference in the making.
struct Work {
    run: ReferenceRun,
    cache: Option<Cache>,
    is_done: bool,
    meter: Option<ErrorMeter>,
    field: Option<(Arc<Mesh>, ScatteredField)>,
    /// The scene, which tells what is a lamp and is not compared.
    scene: Arc<Scene>,
    /// Snapshot that was measured last, and when.
    last: Option<(Arc<Snapshot>, Instant)>,
    saved: Instant,
    /// Passes made here, not read from the cache, and the time that they took.
    made: (u32, Duration),
}

impl Work {
    /// Seconds until the noise is as low as [`GOAL`], at the pace of the passes so far.
    fn seconds_left(&self, noise: f64) -> Option<f64> {
        let (passes, time) = self.made;
        let each = (passes > 0 && noise.is_finite()).then(|| time.as_secs_f64() / f64::from(passes))?;
        Some(each * self.run.passes_left(noise, GOAL))
    }
}

struct Session {
    desk: Desk<Ask, Report>,
    work: Option<Work>,
    waiting: Option<Arc<Snapshot>>,
    serial: u64,
}

impl Session {
    fn run(mut self) {
        loop {
            let has_work = self.work.as_ref().is_some_and(|work| !work.is_done) || self.can_measure();
            let Some(asks) = self.desk.take(has_work.then_some(Duration::ZERO)) else { return self.save() };
            for ask in asks {
                match ask {
                    Ask::Begin { scene, points, cache } => self.begin(scene, points, cache),
                    Ask::Measure(snapshot) => self.waiting = Some(snapshot),
                    Ask::Forget => self.forget(),
                }
            }
            self.measure();
            self.pass();
        }
    }

    fn can_measure(&self) -> bool {
        self.waiting.is_some() && self.work.as_ref().is_some_and(|work| work.meter.is_some())
    }

    fn begin(&mut self, scene: Arc<Scene>, points: usize, cache: Option<Cache>) {
        self.forget();
        let points: Arc<[_]> = random_points(&scene, points, SEED).into();
        let mut run = ReferenceRun::new(&scene, points, SEED);
        if let Some(cache) = &cache {
            cache.load(&mut run);
        }
        self.desk.tell(|report| *report = Report { is_active: true, points: run.points().len(), ..Report::default() });
        let is_done = run.points().is_empty();
        let saved = Instant::now();
        self.work = Some(Work {
            run,
            cache,
            is_done,
            meter: None,
            field: None,
            scene,
            last: None,
            saved,
            made: (0, Duration::ZERO),
        });
        self.take_reference();
    }

    fn forget(&mut self) {
        self.save();
        (self.work, self.waiting) = (None, None);
        self.desk.tell(|report| *report = Report::default());
    }

    fn save(&mut self) {
        let Some(Work { run, cache: Some(cache), saved, .. }) = &mut self.work else { return };
        *saved = Instant::now();
        if let Err(error) = cache.store(run) {
            let failure = format!("The reference is not kept on disk ({error}).");
            self.desk.tell(|report| report.cache_failure = Some(failure));
        }
    }

    /// One pass of paths.
    fn pass(&mut self) {
        let Some(work) = self.work.as_mut().filter(|work| !work.is_done) else { return };
        let (cancel, begun) = (&self.desk.cancel, Instant::now());
        if self.desk.work(|| work.run.pass(cancel)) {
            work.made = (work.made.0 + 1, work.made.1 + begun.elapsed());
            self.take_reference();
        }
        if self.work.as_ref().is_some_and(|work| work.is_done || work.saved.elapsed() >= SAVE_EVERY) {
            self.save();
        }
    }

    /// Takes the reference as far as it is.
    fn take_reference(&mut self) {
        let Some(work) = self.work.as_mut() else { return };
        let passes = work.run.passes();
        if passes < LEAST_PASSES {
            self.desk.tell(|report| report.passes = passes);
            return;
        }
        let reference = Arc::new(work.run.reference());
        let noise = reference.noise();
        work.is_done |= noise <= GOAL;
        match &mut work.meter {
            Some(meter) => meter.set_reference(reference),
            None => work.meter = Some(ErrorMeter::new(reference)),
        }
        if let Some((snapshot, at)) = &work.last
            && (work.is_done || at.elapsed() >= MEASURE_EVERY)
            && self.waiting.is_none()
        {
            self.waiting = Some(snapshot.clone());
        }
        let (is_done, seconds_left) = (work.is_done, work.seconds_left(noise));
        self.desk.tell(|report| {
            (report.noise, report.is_done) = (noise.is_finite().then_some(noise), is_done);
            (report.passes, report.seconds_left) = (passes, seconds_left);
        });
    }

    fn measure(&mut self) {
        let Some(Work { meter: Some(meter), field, scene, last, run, .. }) = self.work.as_mut() else { return };
        let Some(snapshot) = self.waiting.take() else { return };
        let measure = || {
            if field.as_ref().is_none_or(|(mesh, _)| !Arc::ptr_eq(mesh, &snapshot.mesh)) {
                *field = Some((snapshot.mesh.clone(), ScatteredField::new(run.points(), &snapshot.mesh)));
            }
            let error = meter.measure(&snapshot);
            let at_points = meter.relative_differences(&snapshot);
            let mut differences = field.as_ref().map(|(_, field)| field.at_vertices(&at_points)).unwrap_or_default();
            forget_lamps(scene, &snapshot.mesh, &mut differences);
            (error, differences)
        };
        let (error, differences) = self.desk.work(measure);
        *last = Some((snapshot.clone(), Instant::now()));
        self.serial += 1;
        let measured = Measurement { snapshot, error, differences, serial: self.serial };
        self.desk.tell(|report| report.measured = Some(Arc::new(measured)));
    }
}

/// Nothing is known of lamps: their own light is given, not found.
fn forget_lamps(scene: &Scene, mesh: &Mesh, differences: &mut [f32]) {
    for (triangle, &leaf) in mesh.triangles.iter().zip(&mesh.triangle_leaf) {
        if scene.emits(&scene.polygons[mesh.leaves[leaf as usize].polygon as usize]) {
            triangle.iter().for_each(|&vertex| differences[vertex as usize] = f32::NAN);
        }
    }
}
