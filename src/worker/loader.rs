//! The loader's thread: reads a file or remakes a scene, turns its faces and builds its occluders.
//!
//! A parser and a BVH build cannot be interrupted, so the thread is orphaned when nobody waits for it any more; its
//! result then carries a number that the session no longer expects. Few run at a time, orphans among them; the next one waits until
//! one of these is done.

use std::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::mpsc::Sender;
use std::thread::Builder;
use std::time::Instant;

use glam::Vec3;

use super::{FileStamp, Message};
use crate::added_light::AddedLight;
use crate::cancel::CancelToken;
use crate::scene::{self, Scene, Sides, Source};
use crate::visibility::Occluders;
use crate::{ceiling, orient};

/// What a loader is to do.
pub(super) enum Job {
    /// Read this and add light to it.
    Load(Source, AddedLight),
    /// Add lights to the present scene, or turn its faces, and build its occluders anew.
    Remake { raw: Arc<Scene>, path: Option<PathBuf>, stamps: Vec<FileStamp>, lights: Vec<CeilingLight> },
}

/// A square light to be added below the ceiling.
#[derive(Clone, Copy, Debug)]
pub(super) struct CeilingLight {
    /// Length of its sides, in the scene's length unit.
    pub size: f32,
    /// Exitance B_e, W/m².
    pub exitance: Vec3,
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
    /// What its files looked like before they were read.
    pub stamps: Vec<FileStamp>,
    /// The sides that were asked for; `None` as the scene says.
    pub sides: Option<Sides>,
    /// Seconds that all this took.
    pub seconds: f64,
}

/// A loader whose result is awaited.
pub(super) struct Awaited {
    /// The number that its result carries.
    pub ticket: u64,
    /// What is being made, for a person.
    pub name: String,
    /// Lights that it adds to the present scene.
    pub lights: Vec<CeilingLight>,
}

/// So many loaders run at a time at most.
const MOST: usize = 4;

/// The loaders that run, wanted or not, and what waits for one of them to end.
#[derive(Default)]
pub(super) struct Loaders {
    running: usize,
    waiting: Vec<(u64, Job, Option<Sides>)>,
}

impl Loaders {
    /// Starts a loader as soon as few enough run; its result comes as [`Message::Prepared`] with `ticket`.
    ///
    /// # Errors
    /// The system gives no further thread.
    pub(super) fn start(
        &mut self,
        (ticket, job, sides): (u64, Job, Option<Sides>),
        ends: (&Sender<Message>, &CancelToken),
    ) -> std::io::Result<()> {
        if self.running < MOST {
            spawn(job, sides, ticket, ends.0.clone(), ends.1.clone())?;
            self.running += 1;
        } else {
            self.waiting.push((ticket, job, sides));
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
        ends: (&Sender<Message>, &CancelToken),
    ) -> std::io::Result<()> {
        self.running = self.running.saturating_sub(1);
        for order in std::mem::take(&mut self.waiting) {
            if is_wanted(order.0) {
                self.start(order, ends)?;
            }
        }
        Ok(())
    }
}

fn spawn(
    job: Job,
    sides: Option<Sides>,
    ticket: u64,
    inbox: Sender<Message>,
    cancel: CancelToken,
) -> std::io::Result<()> {
    let work = move || {
        let result = catch_unwind(AssertUnwindSafe(|| prepare(job, sides)));
        let result = result.unwrap_or_else(|panic| Err(format!("The loader broke: {}.", panic_message(&*panic))));
        // The session may have ended meanwhile; then nobody wants the result.
        let _ = inbox.send(Message::Prepared(ticket, result.map(Box::new)));
        cancel.cancel();
    };
    Builder::new().name("loader".into()).spawn(work).map(drop)
}

fn prepare(job: Job, sides: Option<Sides>) -> Result<Prepared, String> {
    let begun = Instant::now();
    let (raw, path, stamps) = match job {
        Job::Load(source, light) => {
            let path = match &source {
                Source::File(path) => Some(path.clone()),
                Source::Builtin(_) => None,
            };
            let stamps = path.iter().flat_map(|path| FileStamp::of_scene(path)).collect();
            let mut raw = scene::load(&source).map_err(|error| error.to_string())?;
            light.add_to(&mut raw).map_err(|error| error.to_string())?;
            (Arc::new(raw), path, stamps)
        }
        Job::Remake { mut raw, path, stamps, lights } => {
            for CeilingLight { size, exitance } in lights {
                ceiling::add_light(Arc::make_mut(&mut raw), size, exitance).map_err(|error| error.to_string())?;
            }
            (raw, path, stamps)
        }
    };
    let (scene, occluders) = orient::apply((*raw).clone(), sides.unwrap_or(raw.sides));
    let seconds = begun.elapsed().as_secs_f64();
    Ok(Prepared { raw, scene: Arc::new(scene), occluders: Arc::new(occluders), path, stamps, sides, seconds })
}

/// What a panic said.
pub(super) fn panic_message(panic: &(dyn Any + Send)) -> &str {
    let text = panic.downcast_ref::<&str>().copied();
    text.or_else(|| panic.downcast_ref::<String>().map(String::as_str)).unwrap_or("it gave no reason")
}
