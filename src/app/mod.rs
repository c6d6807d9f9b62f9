//! The window: state, and what happens in a frame.
//!
//! The window owns no solver state. In each frame it takes up what the worker has to say (`Shown`), lets the panels and the view
//! write commands into an outbox, and sends them. Panels see only what they are given, so none of them can wait for the solver.
//! Imports everything below it; only `main` knows this module.

mod appearance;
mod launch;
mod layout;
mod panels;
mod shortcuts;
mod state;
mod timeline;
mod tools;
mod view;
mod widgets;
pub mod words;

use std::sync::Arc;
use std::sync::mpsc::{Receiver, channel};
use std::time::Duration;

use eframe::CreationContext;

pub use launch::{AppError, run};

use crate::added_light::AddedLight;
use crate::format;
use crate::hierarchy::ElementId;
use crate::scene::{CameraPose, Reading, Source};
use crate::solve::{Snapshot, SolverParams};
use crate::worker::{Command, Event, RunState, SceneInfo, SolverThread, Status};
use appearance::Appearance;
use panels::light::LightEditor;
use state::comparison::Comparison;
use state::device::{DeviceLossState, DeviceState};
use state::exports::Exports;
use state::files::Files;
use state::inspection::Inspection;
use state::measuring::Measuring;
use state::messages::Messages;
use state::picked::PickedElement;
use state::pinned::Pinned;
use state::playback::Playback;
use state::readings::ReadingInView;
use state::session::Opened;
use state::settings::DisplaySettings;
use state::time_left::{Clock, Course};
use state::undo::History;
use state::watch::Watch;
use view::best::BestPicture;
use view::cluster_view::ClusterScene;
use view::gathering::Gathering;
use view::highlight::Pointing;
use view::marks::MarksOverView;
use view::metering::Metering;
use view::viewport::Viewport;

/// On software adapters drawing takes the solver's cores, so pictures wait this long for each other.
const REPAINT_INTERVAL_ON_CPU: Duration = Duration::from_millis(100);
/// What was put off for want of time is looked at again after this.
const LATER: Duration = Duration::from_millis(200);

/// Keys under which the storage keeps what lasts from one run to the next.
const RECENT_KEY: &str = "recent_files";
const DISPLAY_KEY: &str = "display";

/// What the worker last said, as every panel sees it.
#[derive(Default)]
struct Shown {
    /// The scene of `snapshot`.
    info: Option<Arc<SceneInfo>>,
    snapshot: Option<Arc<Snapshot>>,
    status: Status,
}

/// Commands that a frame gives rise to.
type Outbox = Vec<Command>;

/// What threads call when they have something to show.
type Wake = Arc<dyn Fn() + Send + Sync>;

/// The window's state.
pub struct App {
    worker: SolverThread,
    shown: Shown,
    /// A scene whose first snapshot has not come yet; the former one stays in view meanwhile.
    incoming: Option<Incoming>,
    /// The solver's parameters as the panel shows them; ahead of the worker's while a slider is dragged.
    params: SolverParams,
    messages: Messages,
    files: Files,
    light: LightEditor,
    history: History,
    display: DisplaySettings,
    reading: ReadingInView,
    measuring: Measuring,
    gathering: Gathering,
    metering: Metering,
    /// The metered exposure of the view, m²/W.
    exposure: f32,
    /// The gathered picture in view.
    painted: Option<view::gathering::Painted>,
    view: Viewport,
    best: BestPicture,
    appearance: Appearance,
    /// Where the scene in view came from.
    opened: Opened,
    watch: Watch,
    picked: Option<PickedElement>,
    inspection: Inspection,
    inspector: tools::Inspector,
    marks: MarksOverView,
    /// What the mouse is over, in a panel or in the view.
    pointing: Pointing,
    matrix: tools::LinkMatrix,
    course: Course,
    comparison: Comparison,
    cluster_view: ClusterScene,
    clusters: tools::Clusters,
    pinned: Pinned,
    exports: Exports,
    /// The tool that the dock shows.
    tool: Option<tools::Tool>,
    /// Whether the list of keys is open.
    are_keys_shown: bool,
    /// Whether panels, bars and dock are hidden.
    is_full_picture: bool,
    /// Whether the settings at the left are wanted.
    shows_settings: bool,
    /// Width that they take, points; 0 where they are hidden.
    settings_width: f32,
    /// Whether the card of the selected element is open.
    is_card_open: bool,
    /// Whether the fold of the method's parameters is to be opened.
    opens_method: bool,
    playback: Playback,
    wake: Wake,
    clock: Clock,
    drawing_failures: Receiver<String>,
    device: DeviceState,
    /// Where the window leaves what it shows when it loses its device.
    will: Option<DeviceLossState>,
}

struct Incoming {
    info: Arc<SceneInfo>,
    /// A new scene rather than an edit: the camera starts afresh.
    is_new: bool,
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
        view::paint::install(render_state, failures, cc.egui_ctx.clone());
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
        let mut opened = Opened::default();
        if let Some((source, reading, light)) = opening {
            opened.ask(&source, &light);
            worker.send(Command::Load(source, reading, light));
        }
        let stored = |key| cc.storage.map(|storage| (storage, key));
        let recent = stored(RECENT_KEY).and_then(|(storage, key)| eframe::get_value(storage, key)).unwrap_or_default();
        let display =
            stored(DISPLAY_KEY).and_then(|(storage, key)| eframe::get_value(storage, key)).unwrap_or_default();
        Ok(Self {
            worker,
            shown: Shown::default(),
            incoming: None,
            params,
            messages: Messages::default(),
            files: Files::new(recent),
            light: LightEditor::default(),
            history: History::default(),
            display,
            reading: ReadingInView::default(),
            measuring: Measuring::default(),
            gathering: Gathering::start(&wake),
            metering: Metering::default(),
            exposure: 1.0,
            painted: None,
            view: Viewport::default(),
            best: BestPicture::default(),
            appearance,
            opened,
            watch: Watch::default(),
            picked: None,
            inspection: Inspection::default(),
            inspector: tools::Inspector::default(),
            marks: MarksOverView::default(),
            pointing: Pointing::default(),
            matrix: tools::LinkMatrix::default(),
            course: Course::default(),
            comparison: Comparison::default(),
            cluster_view: ClusterScene::default(),
            clusters: tools::Clusters::default(),
            pinned: Pinned::default(),
            exports: Exports::default(),
            tool: None,
            are_keys_shown: false,
            is_full_picture: false,
            shows_settings: true,
            settings_width: 0.0,
            is_card_open: false,
            opens_method: false,
            playback: Playback::default(),
            wake,
            clock: Clock::default(),
            drawing_failures,
            device,
            will: None,
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
        self.view.pose()
    }

    /// Why the graphics device was lost, if it was: the window then closes, for another one to take its place.
    pub fn lost_device(&self) -> Option<String> {
        self.device.lost()
    }

    /// What the worker said it is about, as of the last frame.
    pub fn status(&self) -> &Status {
        &self.shown.status
    }

    /// Whether the view shows a picture that was gathered at its pixels, and whether that is as good as was asked for.
    pub fn is_gathered(&self) -> (bool, bool) {
        (self.painted.is_some(), self.painted.as_ref().is_some_and(|painted| painted.is_done))
    }

    /// The picked element, in the snapshot in view.
    pub fn picked_element(&self) -> Option<ElementId> {
        self.picked.as_ref().map(|picked| picked.element)
    }

    /// Where the view lies in the window, points.
    pub fn view_rect(&self) -> egui::Rect {
        self.view.rect()
    }

    /// Takes up everything that the worker has to say.
    fn take_up_news(&mut self, ctx: &egui::Context) {
        // Events before the snapshot: whoever has read the event of a scene finds that scene's snapshot or an older one.
        while let Some(event) = self.worker.try_event() {
            self.take_up(event);
        }
        while let Ok(failure) = self.drawing_failures.try_recv() {
            self.messages.error(format!("The view cannot be drawn: {failure}."));
        }
        self.shown.status = self.worker.status();
        self.comparison.note(self.shown.snapshot.as_ref(), &self.shown.status.params);
        self.pinned.note(self.shown.snapshot.as_ref(), &self.wake);
        self.exports.poll();
        if let Some(sentence) = self.watch.poll() {
            self.messages.note(sentence);
        }
        self.clock.note(self.shown.status.run, false);
        let Some(latest) = self.worker.latest() else { return };
        if let Some(incoming) = self.incoming.take_if(|incoming| incoming.info.generation <= latest.generation) {
            self.adopt(ctx, incoming);
        } else if self.incoming.is_some() {
            return;
        }
        let is_newer = self.shown.snapshot.as_ref().is_none_or(|shown| !Arc::ptr_eq(shown, &latest));
        if is_newer {
            self.course.note(&latest, &self.shown.status.params);
            self.clock.note(self.shown.status.run, true);
            self.playback.follow(&latest);
            self.follow_picked(&latest);
            self.shown.snapshot = Some(latest);
        }
        self.follow_measuring();
    }

    /// Shows the picture alone over all of the screen, or the window as it was.
    fn set_full_screen(&mut self, ctx: &egui::Context, is_full: bool) {
        self.is_full_picture = is_full;
        ctx.send_viewport_cmd(egui::ViewportCommand::Fullscreen(is_full));
    }

    /// Shows how the method works: its parameters, links of a level, and the solve played slowly from the root's self-link.
    fn study(&mut self, ctx: &egui::Context) {
        self.opens_method = true;
        self.display.links.of = state::settings::LinksOf::Level;
        self.playback.study(ctx.input(|input| input.time));
    }

    /// Shows the surveyor what is in view, and takes up what it found.
    fn follow_measuring(&mut self) {
        if let (Some(snapshot), Some(info)) = (&self.shown.snapshot, &self.shown.info) {
            let is_settled = matches!(self.shown.status.run, RunState::Finished | RunState::Paused);
            self.measuring.note(&info.scene, snapshot, is_settled);
        }
    }

    fn take_up(&mut self, event: Event) {
        match event {
            Event::SceneLoaded(info) => {
                if let Some(path) = &info.path {
                    self.files.note_opened(path);
                }
                self.opened.note(&info);
                self.messages.forget_errors();
                self.incoming = Some(Incoming { info, is_new: true });
            }
            Event::SceneEdited(info) => {
                let known = self.shown.info.as_ref().map_or(&[][..], |shown| &shown.scene.skipped.notes[..]);
                for note in info.scene.skipped.notes.iter().filter(|note| !known.contains(note)) {
                    self.messages.note(note.clone());
                }
                let is_new = self.incoming.as_ref().is_some_and(|incoming| incoming.is_new);
                self.incoming = Some(Incoming { info, is_new });
            }
            Event::LoadFailed(sentence) => {
                self.watch.forget_reload();
                self.messages.error(sentence);
            }
            Event::SolveFailed(sentence) => {
                self.messages.error(sentence);
                self.params = self.worker.status().params;
                if let Some(info) = &self.shown.info {
                    self.light.take_back_luminaires(&info.scene);
                }
                self.history.take_as_given(self.undoable());
            }
            Event::Finished => {}
            Event::Saved(path) => {
                self.watch.accept(&path);
                self.messages.note(format!("Saved {}.", path.display()));
            }
            Event::SaveFailed(sentence) => self.messages.error(sentence),
        }
    }

    /// Brings a scene into view whose first snapshot is there.
    fn adopt(&mut self, ctx: &egui::Context, incoming: Incoming) {
        let Incoming { info, is_new } = incoming;
        self.comparison.follow_scene(&info.scene, is_new);
        if is_new {
            let title = format!("{} – Selflink", info.scene.name);
            ctx.send_viewport_cmd(egui::ViewportCommand::Title(title));
            let is_reload = self.watch.take_reloading();
            self.watch.start_with(&info, &self.wake);
            self.deselect();
            self.clusters = tools::Clusters::default();
            self.pinned.let_go();
            let former = self.shown.info.as_ref().map(|former| former.scene.name.as_str());
            self.exports.suggest(&info.scene.name, former);
            if is_reload {
                self.view.go_on_with(&info.scene);
            } else {
                let first = self.opened.camera.take().map(|camera| camera.in_scene(&info.scene));
                self.view.start_with(&info.scene, first);
                self.measuring.start_with(&info.scene);
                // A correction made for another scene's light would make this one black or white.
                self.display.auto_stops = 0.0;
            }
            self.light = LightEditor::for_scene(&info.scene);
            self.history = History::default();
            self.history.take_as_given(self.undoable());
        }
        self.light.follow(&info.scene);
        self.shown.info = Some(info);
    }

    fn open_dropped_files(&self, ctx: &egui::Context, outbox: &mut Outbox) {
        let dropped = ctx.input(|input| input.raw.dropped_files.first().map(|file| file.path().to_owned()));
        outbox.extend(dropped.map(|path| Command::load(Source::File(path))));
    }
}

impl eframe::App for App {
    fn logic(&mut self, ctx: &egui::Context, _frame: &mut eframe::Frame) {
        self.take_up_news(ctx);
        self.appearance.follow(ctx);
        if self.device.lost().is_some() {
            ctx.send_viewport_cmd(egui::ViewportCommand::Close);
        }
    }

    fn ui(&mut self, ui: &mut egui::Ui, _frame: &mut eframe::Frame) {
        let mut outbox = Outbox::new();
        self.open_dropped_files(ui.ctx(), &mut outbox);
        if let Some(answer) = self.files.poll_dialog() {
            match answer {
                state::files::DialogAnswer::Chosen(path) => outbox.push(Command::load(Source::File(path))),
                state::files::DialogAnswer::NoDialog => self.messages.note(state::files::NO_DIALOG.into()),
            }
        }
        shortcuts::act(self, ui, &mut outbox);
        state::undo::take_keys(self, ui.ctx(), &mut outbox);
        self.inspect_picked(ui.ctx());
        if !self.is_full_picture {
            panels::show_sides(self, ui, &mut outbox);
            egui::Panel::top("tools").show(ui, |ui| {
                ui.horizontal(|ui| {
                    let are_shown = layout::Sides::of(self, ui.ctx()).settings.is_some();
                    let settings = ui.selectable_label(are_shown, words::SETTINGS);
                    if settings.on_hover_text("Show or hide the panels at the left").clicked() {
                        self.toggle_settings(ui.ctx());
                    }
                    view::camera_menu::show(self, ui);
                    state::undo::show_buttons(self, ui, &mut outbox);
                    tools::show_bar(self, ui);
                });
            });
            tools::show(self, ui, &mut outbox);
            timeline::show(self, ui);
        }
        egui::CentralPanel::no_frame().show(ui, |ui| {
            ui.spacing_mut().item_spacing.y = 0.0;
            self.messages.show(ui);
            state::watch::show(self, ui, &mut outbox);
            let clicked = view::viewport::show(self, ui, &mut outbox);
            if let Some(clicked) = clicked {
                self.pick(clicked);
            }
        });
        shortcuts::show_list(self, ui.ctx());
        let links_wanted = match self.display.links.of {
            state::settings::LinksOf::Level => true,
            state::settings::LinksOf::Picked => self.picked.is_some(),
            state::settings::LinksOf::Nothing => self.is_card_open && self.picked.is_some(),
        };
        let wants_solution_view =
            links_wanted || self.cluster_view.is_active() || self.tool.is_some_and(tools::Tool::reads_anatomy);
        outbox.extend(self.playback.command(wants_solution_view));
        self.pointing.end_frame(ui.ctx());
        outbox.extend(self.light.luminaires_command(state::undo::is_busy(ui.ctx())));
        state::undo::note(self, ui.ctx());
        for command in outbox {
            if let Command::Load(source, _, light) = &command {
                self.opened.ask(source, light);
                self.watch.note_asked(source);
                // What was kept for the first scene is none of another one's.
                self.opened.camera = None;
            }
            self.worker.send(command);
        }
    }

    fn save(&mut self, storage: &mut dyn eframe::Storage) {
        eframe::set_value(storage, RECENT_KEY, &self.files.recent());
        eframe::set_value(storage, DISPLAY_KEY, &self.display);
        self.appearance.keep(storage);
        self.keep_session(storage);
    }
}
