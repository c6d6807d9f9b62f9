//! The window: state, and what happens in a frame.
//!
//! The window owns no solver state. In each frame it takes up what the worker has to say (`Shown`),
//! lets the panels and the view write commands and actions into an outbox, sends the ones and
//! performs the others. Panels see only what they are given, so none of them can wait for the
//! solver. Imports everything below it; only `main` knows this module.

mod actions;
mod appearance;
mod frame;
mod launch;
mod layout;
mod news;
mod panels;
mod shortcuts;
mod state;
mod timeline;
mod tools;
mod view;
mod widgets;
pub mod words;

use std::sync::Arc;
use std::sync::mpsc::channel;
use std::time::Duration;

use eframe::CreationContext;

pub use launch::{AppError, run};

use crate::base::format;
use crate::hierarchy::ElementId;
use crate::prepare::added_light::AddedLight;
use crate::render::Show;
use crate::scene::{CameraPose, Reading, Source};
use crate::solve::{Snapshot, SolverParams, Stats};
use crate::transport::SolutionView;
use crate::worker::{Command, SceneInfo, SolverThread, Status};
use actions::Outbox;
use appearance::Appearance;
use layout::Layout;
use news::Incoming;
use state::device::{DeviceState, Graphics};
use state::documents::Documents;
use state::edits::Edits;
use state::messages::Messages;
use state::picked::PickedElement;
use state::settings::LinksOf;
use state::time_left::Progress;
use tools::Tools;
use view::{View, paint};

/// On software adapters drawing takes the solver's cores, so pictures wait this long for each
/// other.
const REPAINT_INTERVAL_ON_CPU: Duration = Duration::from_millis(100);
/// Work that was put off for want of time is looked at again after this.
const LATER: Duration = Duration::from_millis(200);

/// Keys under which the storage keeps what lasts from one run to the next.
const RECENT_KEY: &str = "recent_files";
const DISPLAY_KEY: &str = "display";

/// News of the worker, and what is picked in them, as every panel sees them.
#[derive(Default)]
struct Shown {
    /// The scene of `snapshot`.
    info: Option<Arc<SceneInfo>>,
    /// The newest light.
    snapshot: Option<Arc<Snapshot>>,
    /// The light in view: the newest, or a better picture that is kept until then.
    in_view: Option<Arc<Snapshot>>,
    status: Status,
    picked: Option<PickedElement>,
}

impl Shown {
    /// The statistics of the newest light.
    fn stats(&self) -> Option<&Stats> {
        self.snapshot.as_ref().map(|snapshot| &snapshot.stats)
    }

    /// Elements and links of the newest light, where it was asked for them.
    fn solution_view(&self) -> Option<&Arc<SolutionView>> {
        self.snapshot.as_ref()?.solution_view.as_ref()
    }

    fn picked_element(&self) -> Option<ElementId> {
        self.picked.as_ref().map(|picked| picked.element)
    }
}

/// Function that threads call when they have something to show.
type Wake = Arc<dyn Fn() + Send + Sync>;

/// The window's state.
pub struct App {
    worker: SolverThread,
    shown: Shown,
    /// A scene whose first snapshot has not come yet; the former one stays in view meanwhile.
    incoming: Option<Incoming>,
    messages: Messages,
    edits: Edits,
    documents: Documents,
    view: View,
    tools: Tools,
    layout: Layout,
    progress: Progress,
    graphics: Graphics,
    wake: Wake,
}

impl App {
    /// Sets up theme, renderer and solver thread, and starts loading `source`.
    ///
    /// # Errors
    /// No wgpu device is there, or no thread for the solver.
    pub fn new(
        cc: &CreationContext<'_>,
        opening: Option<(Source, Reading, AddedLight)>,
        params: SolverParams,
    ) -> Result<Self, AppError> {
        let appearance = Appearance::restore(&cc.egui_ctx, cc.storage);
        let render_state = cc.wgpu_render_state.as_ref().ok_or(AppError::NoDevice)?;
        let (failures, drawing_failures) = channel();
        paint::install(render_state, failures, cc.egui_ctx.clone());
        let device = DeviceState::watch(&render_state.device, cc.egui_ctx.clone());
        let on_cpu = render_state.adapter.get_info().device_type == wgpu::DeviceType::Cpu;
        let ctx = cc.egui_ctx.clone();
        let wake: Wake = Arc::new(move || {
            if on_cpu {
                ctx.request_repaint_after(REPAINT_INTERVAL_ON_CPU);
            } else {
                ctx.request_repaint();
            }
        });
        let of_worker = wake.clone();
        let worker = SolverThread::spawn(params, Box::new(move || of_worker()))?;
        let stored = |key| cc.storage.map(|storage| (storage, key));
        let recent = stored(RECENT_KEY).and_then(|(storage, key)| eframe::get_value(storage, key)).unwrap_or_default();
        let mut documents = Documents::new(recent);
        if let Some((source, reading, light)) = opening {
            documents.opened.ask(&source, &light);
            worker.send(Command::Load(source, reading, light));
        }
        let display =
            stored(DISPLAY_KEY).and_then(|(storage, key)| eframe::get_value(storage, key)).unwrap_or_default();
        Ok(Self {
            worker,
            shown: Shown::default(),
            incoming: None,
            messages: Messages::default(),
            edits: Edits::new(params, display),
            documents,
            view: View::new(&wake),
            tools: Tools::default(),
            layout: Layout::new(appearance),
            progress: Progress::default(),
            graphics: Graphics { drawing_failures, state: device, loss: None },
            wake,
        })
    }

    /// The snapshot in view.
    pub fn snapshot(&self) -> Option<&Arc<Snapshot>> {
        self.shown.snapshot.as_ref()
    }

    /// The scene in view.
    pub fn scene_info(&self) -> Option<&Arc<SceneInfo>> {
        self.shown.info.as_ref()
    }

    /// The eye, once there is a view.
    pub fn camera_pose(&self) -> Option<CameraPose> {
        self.view.viewport.pose()
    }

    /// Why the graphics device was lost, if it was: the window then closes, for another one to take
    /// its place.
    pub fn lost_device(&self) -> Option<String> {
        self.graphics.state.lost()
    }

    /// Status of the worker as of the last frame.
    pub fn status(&self) -> &Status {
        &self.shown.status
    }

    /// Whether the view shows a picture that was gathered at its pixels, and whether that is as
    /// good as was asked for.
    pub fn is_gathered(&self) -> (bool, bool) {
        (self.view.painted.is_some(), self.view.painted.as_ref().is_some_and(|painted| painted.is_done))
    }

    /// The picked element, in the snapshot in view.
    pub fn picked_element(&self) -> Option<ElementId> {
        self.shown.picked_element()
    }

    /// Cards, legends and notes over the view, with their places, points.
    pub fn overlays(&self) -> &[(&'static str, egui::Rect)] {
        self.view.overlays.taken()
    }

    /// Where the view lies in the window, points.
    pub fn view_rect(&self) -> egui::Rect {
        self.view.viewport.rect()
    }

    /// Shows the picture alone over all of the screen, or the window as it was.
    fn toggle_full_screen(&mut self, ctx: &egui::Context) {
        self.layout.is_full_picture = !self.layout.is_full_picture;
        ctx.send_viewport_cmd(egui::ViewportCommand::Fullscreen(self.layout.is_full_picture));
    }

    /// Shows how the method works: its parameters, links of a level, and the solve played slowly
    /// from the root's self-link.
    fn study(&mut self, ctx: &egui::Context) {
        self.layout.opens_method = true;
        let display = &mut self.edits.display;
        self.layout.before_study.get_or_insert((display.links.of, display.reading.show));
        (display.links.of, display.reading.show) = (LinksOf::Level, Show::Lit);
        self.tools.playback.study(ctx.input(|input| input.time));
    }

    /// Shows what was shown before once a study has come to the present, unless a person chose
    /// otherwise meanwhile.
    fn end_study(&mut self) {
        let display = &mut self.edits.display;
        if self.tools.playback.step.is_none()
            && let Some(before) = self.layout.before_study.take()
            && (display.links.of, display.reading.show) == (LinksOf::Level, Show::Lit)
        {
            (display.links.of, display.reading.show) = before;
        }
    }
}
