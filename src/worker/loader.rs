//! The loader's thread: reads a file or remakes a scene, turns its faces and builds its occluders.
//!
//! A parser and a BVH build cannot be interrupted, so the thread is orphaned when nobody waits for it any more; its
//! result then carries a number that the session no longer expects.

use std::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::mpsc::Sender;
use std::thread::Builder;
use std::time::Instant;

use super::Message;
use crate::cancel::CancelToken;
use crate::orient;
use crate::scene::{self, Scene, Sides, Source};
use crate::visibility::Occluders;

/// What a loader is to do.
pub(super) enum Job {
    /// Read this.
    Load(Source),
    /// Turn the faces of a scene that was edited, or whose sides are to differ.
    Remake { raw: Arc<Scene>, path: Option<PathBuf> },
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
    /// The sides that were asked for; `None` as the scene says.
    pub sides: Option<Sides>,
    /// Whether this is a new scene and not an edit of the present one.
    pub is_new: bool,
    /// Seconds that all this took.
    pub seconds: f64,
}

/// Starts a loader; its result comes as [`Message::Prepared`] with `ticket`.
pub(super) fn start(
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
    let (raw, path, is_new) = match job {
        Job::Load(source) => {
            let path = match &source {
                Source::File(path) => Some(path.clone()),
                Source::Builtin(_) => None,
            };
            (Arc::new(scene::load(&source).map_err(|error| error.to_string())?), path, true)
        }
        Job::Remake { raw, path } => (raw, path, false),
    };
    let mut turned = (*raw).clone();
    turned.sides = sides.unwrap_or(raw.sides);
    orient::apply(&mut turned);
    let scene = Arc::new(turned);
    let occluders = Arc::new(Occluders::new(&scene));
    Ok(Prepared { raw, scene, occluders, path, sides, is_new, seconds: begun.elapsed().as_secs_f64() })
}

/// What a panic said.
pub(super) fn panic_message(panic: &(dyn Any + Send)) -> &str {
    let text = panic.downcast_ref::<&str>().copied();
    text.or_else(|| panic.downcast_ref::<String>().map(String::as_str)).unwrap_or("it gave no reason")
}
