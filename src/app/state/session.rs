//! State that the window goes on with at its next start: scene, added light, parameters, view and
//! the open tool.
//!
//! Folded sections and the window's place are kept by egui itself. The storage is the one that the
//! window was made with; none in tests.

use glam::Vec3;
use serde::{Deserialize, Serialize};

use crate::app::state::messages::Topic;
use crate::app::tools::Tool;
use crate::app::{App, AppError};
use crate::export::settings::Settings;
use crate::prepare::added_light::AddedLight;
use crate::scene::builtin::BuiltinScene;
use crate::scene::outside::Daylight;
use crate::scene::{FiledCamera, Kept, Luminaire, MaterialId, Scene, Source};
use crate::worker::SceneInfo;
use eframe::CreationContext;

/// Key under which the storage keeps it.
const KEY: &str = "session";

/// The window as it was left.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
struct Session {
    settings: Settings,
    tool: Option<Tool>,
}

/// Where the scene in view came from, and what it was like when it came.
#[derive(Default)]
pub struct Opened {
    /// Scene and light that were last asked for.
    asked: Option<(Source, AddedLight)>,
    /// The view to start with, where the first scene is to have another than its own.
    pub camera: Option<FiledCamera>,
    source: Option<Source>,
    light: AddedLight,
    /// Emission of each material, W/m², and luminaires, before anybody changed them here.
    emission: Vec<Vec3>,
    luminaires: Vec<Luminaire>,
    /// Daylight of the scene when it came.
    daylight: Daylight,
}

impl Opened {
    /// A scene is asked for.
    pub fn ask(&mut self, source: &Source, light: &AddedLight) {
        self.asked = Some((source.clone(), light.clone()));
    }

    /// A scene has come.
    pub fn note(&mut self, info: &SceneInfo) {
        let source = match &info.path {
            Some(path) => Some(Source::File(path.clone())),
            None => BuiltinScene::from_name(&info.scene.name).map(Source::Builtin),
        };
        let asked = self.asked.take_if(|(asked, _)| Some(&*asked) == source.as_ref());
        self.light = asked.map(|(_, light)| light).unwrap_or_default();
        self.source = source;
        self.emission = info.scene.materials.iter().map(|material| material.emission).collect();
        self.luminaires = info.scene.luminaires();
        self.daylight = info.scene.daylight();
    }

    /// Light added to the scene's file: what was asked for, and what was changed in the window.
    fn light(&self, scene: &Scene) -> AddedLight {
        let mut light = self.light.clone();
        let is_luminaire = |index: usize| scene.luminaire_of(MaterialId(index as u32)).is_some();
        for (index, (material, before)) in scene.materials.iter().zip(&self.emission).enumerate() {
            if !is_luminaire(index) && material.emission != *before {
                light.emitting.retain(|(name, _)| *name != material.name);
                light.emitting.push((material.name.clone(), material.emission));
            }
        }
        if scene.daylight() != self.daylight {
            light.daylight = scene.daylight();
        }
        let luminaires = scene.luminaires();
        if luminaires != self.luminaires {
            // With the one that was asked for under the ceiling.
            light.ceiling = None;
            light.luminaires = Some(luminaires.iter().map(|luminaire| luminaire.in_file(scene)).collect());
        }
        light
    }
}

impl App {
    /// The window with these settings.
    ///
    /// # Errors
    /// No wgpu device is there, or no thread for the solver.
    pub fn open(cc: &CreationContext<'_>, settings: &Settings) -> Result<Self, AppError> {
        let opening = settings.source().map(|source| (source, settings.reading.clone(), settings.light.clone()));
        let mut app = Self::new(cc, opening, settings.solver)?;
        app.documents.opened.camera = settings.camera;
        Ok(app)
    }

    /// The window as it was left, or with `fallback` at the very first start.
    ///
    /// # Errors
    /// No wgpu device is there, or no thread for the solver.
    pub fn resume(cc: &CreationContext<'_>, fallback: &Settings) -> Result<Self, AppError> {
        let kept: Option<Session> = cc.storage.and_then(|storage| eframe::get_value(storage, KEY));
        let Some(mut session) = kept else {
            let mut app = Self::open(cc, fallback)?;
            app.layout.appearance.is_hint_shown = true;
            return Ok(app);
        };
        if session.settings.solver.validate().is_err() {
            session.settings.solver = fallback.solver;
        }
        let former = session.settings.solver.forget_criterion();
        let vanished = match session.settings.source() {
            Some(Source::File(path)) if !path.exists() => Some(path),
            Some(_) => None,
            None => {
                session.settings.scene.clone_from(&fallback.scene);
                None
            }
        };
        if vanished.is_some() {
            session.settings = Settings { solver: session.settings.solver, ..fallback.clone() };
        }
        let mut app = Self::open(cc, &session.settings)?;
        app.tools.open = session.tool;
        if let Some(sentence) = former {
            app.messages.note(Topic::Remark, format!("Since the last time, {sentence}."));
        }
        if let Some(path) = vanished {
            let instead = fallback.scene.as_deref().unwrap_or("nothing");
            let path = path.display();
            app.messages.note(
                Topic::Remark,
                format!("The scene of the last time, {path}, is gone: this is {instead} in its place."),
            );
        }
        Ok(app)
    }

    /// All that the solution in view is made with.
    pub(in crate::app) fn settings(&self) -> Settings {
        let light = self.shown.info.as_ref().map(|info| self.documents.opened.light(&info.scene)).unwrap_or_default();
        let scene = self.documents.opened.source.as_ref().map(Settings::name_of);
        let reading = self.shown.info.as_ref().map(|info| info.scene.reading.clone()).unwrap_or_default();
        let camera = self.view.viewport.pose().zip(self.shown.info.as_ref());
        let camera = camera.map(|(pose, info)| pose.in_file(&info.scene));
        Settings { scene, reading, light, camera, solver: self.edits.params }
    }

    /// View and task area that are kept beside the scene's file.
    pub(in crate::app) fn kept(&self) -> Kept {
        let bookmarks = self.view.viewport.bookmarks().to_vec();
        Kept { camera: self.view.viewport.pose(), bookmarks, task_area: self.tools.measuring.task_area() }
    }

    /// Keeps what the next start goes on with.
    pub(in crate::app) fn keep_session(&self, storage: &mut dyn eframe::Storage) {
        eframe::set_value(storage, KEY, &Session { settings: self.settings(), tool: self.tools.open });
    }
}
