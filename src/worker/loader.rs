//! The loader's thread: reads a file or remakes a scene, turns its faces, builds its occluders and
//! clusters.
//!
//! A parser and the building of a BVH or of clusters cannot be interrupted, so the thread is
//! orphaned when nobody waits for it any more; its result then carries a number that the session no
//! longer expects. Few run at a time, orphans among them; the next one waits until one of these is
//! done.

use std::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::mpsc::Sender;
use std::thread::Builder;
use std::time::Instant;

use rayon::ThreadPool;

use super::guard::guarded;
use super::{FileStamp, Message};
use crate::geometry::{Occluders, orient};
use crate::prepare;
use crate::prepare::added_light::AddedLight;
use crate::scene::{Luminaire, Reading, Scene, Sides, Source};
use crate::solve::{Solver, SolverError, SolverParams};
use crate::transport::lets_daylight_in;

/// Task of a loader.
pub(super) enum Job {
    /// Read this and add light to it.
    Load(Source, Reading, AddedLight),
    /// Put luminaires in place of the present scene's, or turn its faces, and build its occluders
    /// anew.
    Remake { raw: Arc<Scene>, path: Option<PathBuf>, stamps: Vec<FileStamp>, luminaires: Option<Vec<Luminaire>> },
}

/// A scene that is ready to be solved.
pub(super) struct Prepared {
    /// As the file says, before faces were turned or doubled.
    pub raw: Arc<Scene>,
    /// As it is solved.
    pub scene: Arc<Scene>,
    /// The faces that stop light.
    pub occluders: Arc<Occluders>,
    /// The file it came from.
    pub path: Option<PathBuf>,
    /// Stamps of the scene's files before they were read.
    pub stamps: Vec<FileStamp>,
    /// The sides that were asked for; `None` as the scene says.
    pub sides: Option<Sides>,
    /// Seconds that all this took.
    pub seconds: f64,
    /// Whether daylight would get in.
    pub is_open: bool,
    /// Solver of the scene at the root's self-link, until a session takes it.
    pub solver: Option<Solver>,
}

/// A loader whose result is awaited.
pub(super) struct Awaited {
    /// The number that its result carries.
    pub ticket: u64,
    /// Name of the scene that is being made, for a person.
    pub name: String,
    /// Luminaires that it puts in place of the present scene's.
    pub luminaires: Option<Vec<Luminaire>>,
}

/// So many loaders run at a time at most.
const MOST: usize = 4;

/// A scene that is to be made ready, and all that decides what it becomes.
pub(super) struct Order {
    /// The number that the result carries.
    pub ticket: u64,
    pub job: Job,
    pub params: SolverParams,
    /// Where clusters are built.
    pub pool: Option<Arc<ThreadPool>>,
}

/// The loaders that run, wanted or not, and what waits for one of them to end.
#[derive(Default)]
pub(super) struct Loaders {
    running: usize,
    waiting: Vec<Order>,
}

impl Loaders {
    /// Starts a loader as soon as few enough run; its result comes as [`Message::Prepared`] with
    /// the order's ticket.
    ///
    /// # Errors
    /// The system gives no further thread.
    pub(super) fn start(&mut self, order: Order, inbox: &Sender<Message>) -> std::io::Result<()> {
        if self.running < MOST {
            spawn(order, inbox.clone())?;
            self.running += 1;
        } else {
            self.waiting.push(order);
        }
        Ok(())
    }

    /// Notes that one has answered, and starts those that waited and are still wanted.
    ///
    /// # Errors
    /// The system gives no further thread.
    pub(super) fn one_ended(
        &mut self,
        is_wanted: impl Fn(u64) -> bool,
        inbox: &Sender<Message>,
    ) -> std::io::Result<()> {
        self.running = self.running.saturating_sub(1);
        for order in std::mem::take(&mut self.waiting) {
            if is_wanted(order.ticket) {
                self.start(order, inbox)?;
            }
        }
        Ok(())
    }
}

fn spawn(order: Order, inbox: Sender<Message>) -> std::io::Result<()> {
    let work = move || {
        let Order { ticket, job, params, pool } = order;
        let result = catch_unwind(AssertUnwindSafe(|| make_ready(job, params, pool.as_deref())));
        let result = result.unwrap_or_else(|panic| Err(format!("The loader broke: {}.", panic_message(&*panic))));
        // The session may have ended meanwhile; then nobody wants the result.
        let _ = inbox.send(Message::Prepared(ticket, result.map(Box::new)));
    };
    Builder::new().name("loader".into()).spawn(work).map(drop)
}

fn make_ready(job: Job, params: SolverParams, pool: Option<&ThreadPool>) -> Result<Prepared, String> {
    let begun = Instant::now();
    let sides = params.sides;
    let (raw, scene, occluders, path, stamps) = match job {
        Job::Load(source, reading, light) => {
            let path = match &source {
                Source::File(path) => Some(path.clone()),
                Source::Builtin(_) => None,
            };
            let stamps = path.iter().flat_map(|path| FileStamp::of_scene(path)).collect();
            let ready = prepare::prepare(&source, &reading, &light, sides).map_err(|error| error.to_string())?;
            (Arc::new(ready.raw), ready.scene, ready.occluders, path, stamps)
        }
        Job::Remake { mut raw, path, stamps, luminaires } => {
            if let Some(luminaires) = luminaires {
                Arc::make_mut(&mut raw).set_luminaires(&luminaires).map_err(|error| error.to_string())?;
            }
            let (scene, occluders) = orient::apply((*raw).clone(), sides.unwrap_or(raw.sides));
            (raw, scene, occluders, path, stamps)
        }
    };
    let seconds = begun.elapsed().as_secs_f64();
    let (scene, occluders) = (Arc::new(scene), Arc::new(occluders));
    let (of_scene, of_occluders) = (scene.clone(), occluders.clone());
    let mut solver = guarded(pool, move || {
        Solver::new(of_scene, of_occluders, params, 0).map_err(|error: SolverError| error.to_string())
    })?;
    solver.set_load_seconds(seconds);
    let is_open = lets_daylight_in(&scene, &occluders);
    Ok(Prepared { raw, scene, occluders, path, stamps, sides, seconds, is_open, solver: Some(solver) })
}

/// Message of a panic.
pub(super) fn panic_message(panic: &(dyn Any + Send)) -> &str {
    let text = panic.downcast_ref::<&str>().copied();
    text.or_else(|| panic.downcast_ref::<String>().map(String::as_str)).unwrap_or("it gave no reason")
}
