//! The solver's thread: commands go in, events and the latest snapshot come out.
//!
//! A window owns no solver state and never waits for the solver, nor the solver for the window.
//! Bulk results lie in a slot that holds the newest `Arc<Snapshot>`; what must not be lost comes as
//! an [`Event`] on a channel. The solver works on a pool (`task`), so commands are taken up at once
//! whatever it is about; a command cancels the step that runs, and bursts of commands are merged:
//! the newest settings win.
//!
//! Files are read and BVHs built on a further thread (`loader`), which is orphaned when its result
//! is no longer wanted: the present scene stays in view, and rests, until the new one is ready.
//! Knows no window.

mod guard;
mod loader;
mod merge;
mod pacing;
mod session;
mod stage;
mod stamp;
mod task;

use std::path::PathBuf;
use std::sync::mpsc::{Receiver, Sender, channel};
use std::sync::{Arc, Mutex};
use std::thread::{Builder, JoinHandle};

use glam::Vec3;

use crate::base::threads::lock;
use crate::geometry::Occluders;
use crate::prepare::added_light::AddedLight;
use crate::read::daylight_factor::NoDaylightFactor;
use crate::scene::outside::Daylight;
use crate::scene::{GroupMember, Kept, Luminaire, MaterialId, Reading, Scene, Source};
use crate::solve::{MeshError, Snapshot, SolverParams, TimelineStep};
pub use stamp::FileStamp;

/// A person's command to the solver.
#[derive(Clone, Debug)]
pub enum Command {
    /// Reads a scene, adds light to it and, when that succeeds, solves it in place of the present
    /// one.
    Load(Source, Reading, AddedLight),
    /// Forgets a load that is under way.
    CancelLoad,
    /// Takes over new parameters with the least work that suffices.
    SetParams(SolverParams),
    /// Stops after the present step.
    Pause,
    /// Goes on where it stopped.
    Resume,
    /// Goes on until the present wave ends, then pauses.
    StepWave,
    /// Solves afresh from the root's self-link.
    Restart,
    /// Says what snapshots show.
    Show(SnapshotRequest),
    /// Changes a material's emission; ε in watts stays.
    SetEmission {
        /// The material.
        material: MaterialId,
        /// Exitance B_e, W/m².
        emission: Vec3,
    },
    /// Changes a material's reflectance; ε in watts stays.
    SetReflectance {
        /// The material.
        material: MaterialId,
        /// Reflectance ρ per colour, 0 to 0.99.
        reflectance: Vec3,
    },
    /// Measures a relative ε by the power that is emitted now.
    AnchorEpsilon,
    /// Puts these luminaires in the place of those that were added to the scene's file. Another
    /// exitance alone changes materials in place; otherwise the scene is solved anew.
    SetLuminaires(Vec<Luminaire>),
    /// Lets another daylight in; the scene is solved anew.
    SetDaylight(Daylight),
    /// Arranges the scene's groups by hand; an empty list has them as the file does. Clusters are
    /// built anew where they go by groups.
    SetGroups(Vec<GroupMember>),
    /// Writes the sidecar beside the scene's file, with what a person keeps there.
    SaveSidecar(Kept),
    /// Ends the thread.
    Shutdown,
}

impl Command {
    /// Reads a scene as it is.
    pub fn load(source: Source) -> Self {
        Self::Load(source, Reading::default(), AddedLight::default())
    }

    /// Whether the solver answers it with another solution, or says why there is none.
    pub fn solves_anew(&self) -> bool {
        match self {
            Self::Load(..)
            | Self::SetParams(_)
            | Self::Restart
            | Self::SetEmission { .. }
            | Self::SetReflectance { .. }
            | Self::AnchorEpsilon
            | Self::SetLuminaires(_)
            | Self::SetDaylight(_)
            | Self::SetGroups(_) => true,
            Self::CancelLoad
            | Self::Pause
            | Self::Resume
            | Self::StepWave
            | Self::Show(_)
            | Self::SaveSidecar(_)
            | Self::Shutdown => false,
        }
    }
}

/// Content of snapshots.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SnapshotRequest {
    /// Whether they carry a solution view: elements and links.
    pub solution_view: bool,
    /// A former step in place of the present; the solver goes on meanwhile. Another solve forgets
    /// it.
    pub former_step: Option<usize>,
}

/// News that must not be lost on the way to a person.
#[derive(Clone, Debug)]
pub enum Event {
    /// A new scene is being solved.
    SceneLoaded(Arc<SceneInfo>),
    /// The present scene was changed: a lamp, an emission, turned faces.
    SceneEdited(Arc<SceneInfo>),
    /// A scene could not be loaded; one sentence. The present one stays.
    LoadFailed(String),
    /// Parameters or an edit could not be used, or the solver broke; one sentence. The last picture
    /// stays.
    SolveFailed(String),
    /// Nothing is left to refine.
    Finished,
    /// The sidecar was written.
    Saved(PathBuf),
    /// The sidecar could not be written; one sentence.
    SaveFailed(String),
}

/// The scene that is being solved.
#[derive(Clone, Debug)]
pub struct SceneInfo {
    /// The scene, faces turned or doubled as its sides ask.
    pub scene: Arc<Scene>,
    /// The faces that stop light in it.
    pub occluders: Arc<Occluders>,
    /// The file it came from; `None` for our own scenes.
    pub path: Option<PathBuf>,
    /// Stamps of the scene's files before they were read; empty for our own scenes.
    pub stamps: Vec<FileStamp>,
    /// The first generation of snapshots that show this scene.
    pub generation: u64,
    /// Whether anything emits, or shines in from outside.
    pub has_light: bool,
    /// Whether daylight would get in.
    pub is_open: bool,
    /// Irradiance of open horizontal ground, W/m², weighted as the eye does, or why there is no
    /// daylight factor.
    pub open_ground: Result<f32, NoDaylightFactor>,
    /// A size that suits a luminaire, in the scene's length unit.
    pub luminaire_size: f32,
    /// A luminous flux that suits it, lm.
    pub luminaire_lumens: f32,
    /// Remarks of loading on parts skipped, clamped or ignored, a sentence each.
    pub skipped: Vec<String>,
    /// Seconds spent reading, turning faces and building the occluders.
    pub load_seconds: f64,
}

/// State of the solver's thread.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum RunState {
    /// No scene is there, or the solve could not start.
    #[default]
    Idle,
    /// Refining.
    Running,
    /// Waiting for a person.
    Paused,
    /// Nothing is left to do.
    Finished,
}

/// Error of a finished solve by ε, which no certificate tells of.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum ErrorOfMesh {
    /// Nothing.
    #[default]
    Unknown,
    /// It is being measured.
    Measuring,
    /// It was measured.
    Measured(MeshError),
}

/// A small summary that a window may read in every frame.
#[derive(Clone, Debug, Default)]
pub struct Status {
    /// State of the thread.
    pub run: RunState,
    /// The parameters that are in force.
    pub params: SolverParams,
    /// Name of the scene that is being loaded, if any is; the present scene rests meanwhile.
    pub loading: Option<String>,
    /// Error of a finished solve by ε, as far as it is known.
    pub mesh_error: ErrorOfMesh,
    /// The steps of the solve so far, which [`SnapshotRequest::former_step`] counts; oldest first.
    pub steps: Arc<[TimelineStep]>,
}

/// State that the thread shares with its owner; both locks are held for a swap or a copy only.
#[derive(Default)]
struct Shared {
    latest: Mutex<Option<Arc<Snapshot>>>,
    status: Mutex<Status>,
}

/// A message to the thread.
enum Message {
    Command(Box<Command>),
    /// A loader is done; the number says which.
    Prepared(u64, Result<Box<loader::Prepared>, String>),
    /// The solver comes back from a task.
    TaskResult(Box<task::TaskResult>),
}

/// The solver's thread and the ends of its channels; dropping it lets the thread end by itself.
pub struct SolverThread {
    inbox: Sender<Message>,
    events: Receiver<Event>,
    shared: Arc<Shared>,
    handle: JoinHandle<()>,
}

impl SolverThread {
    /// Starts the thread with nothing to solve. `wake` is called on that thread whenever a new
    /// snapshot, event or status is there; it must not block.
    ///
    /// # Errors
    /// The system gives no further thread.
    pub fn spawn(params: SolverParams, wake: Box<dyn Fn() + Send>) -> std::io::Result<Self> {
        let (inbox, messages) = channel();
        let (event_sender, events) = channel();
        let shared = Arc::new(Shared::default());
        lock(&shared.status).params = params;
        let session = session::Session::new(
            session::Ends { messages, loopback: inbox.clone(), events: event_sender, shared: shared.clone(), wake },
            params,
        );
        let handle = Builder::new().name("solver".into()).spawn(move || session.run())?;
        Ok(Self { inbox, events, shared, handle })
    }

    /// Hands a command over; returns at once.
    pub fn send(&self, command: Command) {
        // A thread that has ended takes no commands, and none is missed: only Shutdown ends it.
        let _ = self.inbox.send(Message::Command(Box::new(command)));
    }

    /// The next event, if one is there.
    pub fn try_event(&self) -> Option<Event> {
        self.events.try_recv().ok()
    }

    /// The newest snapshot.
    pub fn latest(&self) -> Option<Arc<Snapshot>> {
        lock(&self.shared.latest).clone()
    }

    /// State and settings of the thread.
    pub fn status(&self) -> Status {
        lock(&self.shared.status).clone()
    }

    /// Whether the thread has ended (after [`Command::Shutdown`]).
    pub fn has_ended(&self) -> bool {
        self.handle.is_finished()
    }
}

impl Drop for SolverThread {
    fn drop(&mut self) {
        self.send(Command::Shutdown);
    }
}
