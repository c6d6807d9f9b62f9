//! The scene of a session: loading another, editing the present one, and the solvers made for them.

use std::sync::Arc;

use glam::Vec3;

use super::loader::{Awaited, Job, Order, Prepared};
use super::session::{Drive, Session};
use super::task::{Change, Changed, Task};
use super::{Command, Event, SceneInfo};
use crate::prepare::added_light::AddedLight;
use crate::prepare::ceiling;
use crate::read::daylight_factor::open_ground;
use crate::scene::outside::Daylight;
use crate::scene::{
    GroupMember, Kept, Luminaire, MAX_EMISSION, MAX_SIDECAR_REFLECTANCE, Material, MaterialId, Reading, Sidecar,
    SidecarError, Source,
};
use crate::solve::{ClusteringMode, Solver};

/// A change of one material.
#[derive(Clone, Copy, Debug)]
pub(super) enum MaterialEdit {
    /// Emission B_e, W/m².
    Emission(Vec3),
    /// Reflectance ρ.
    Reflectance(Vec3),
}

impl MaterialEdit {
    /// Why it cannot be made.
    fn problem(self) -> Option<String> {
        let (value, most, what, unit) = match self {
            Self::Emission(value) => (value, MAX_EMISSION, "emission", " W/m²"),
            Self::Reflectance(value) => (value, MAX_SIDECAR_REFLECTANCE, "reflectance", ""),
        };
        let is_usable = value.is_finite() && value.min_element() >= 0.0 && value.max_element() <= most;
        (!is_usable).then(|| format!("{what} of a material must be three numbers between 0 and {most}{unit}"))
    }

    fn apply(self, material: &mut Material) {
        match self {
            Self::Emission(emission) => material.emission = emission,
            Self::Reflectance(reflectance) => material.reflectance = reflectance,
        }
    }
}

impl Session {
    /// Reads a scene on a thread of its own; one that is being read already is forgotten.
    pub(super) fn load(&mut self, source: Source, reading: Reading, light: AddedLight) {
        let name = match &source {
            Source::File(path) => path.file_name().unwrap_or(path.as_os_str()).to_string_lossy().into_owned(),
            Source::Builtin(scene) => scene.name().to_owned(),
        };
        self.loading = self.start_loader(Job::Load(source, reading, light), name, None);
    }

    /// Makes the present scene anew on a thread of its own: with the sides of the present
    /// parameters, and with other luminaires if there are any. Without, those that were under way
    /// come with it.
    pub(super) fn remake(&mut self, luminaires: Option<Vec<Luminaire>>) {
        let Some(prepared) = &self.prepared else { return };
        let (raw, path, stamps) = (prepared.raw.clone(), prepared.path.clone(), prepared.stamps.clone());
        let under_way = self.remaking.take().and_then(|awaited| awaited.luminaires);
        let luminaires = luminaires.or(under_way);
        let name = if luminaires.is_none() { "the turned faces" } else { "the luminaires" };
        let job = Job::Remake { raw, path, stamps, luminaires: luminaires.clone() };
        self.remaking = self.start_loader(job, name.into(), luminaires);
    }

    fn start_loader(&mut self, job: Job, name: String, luminaires: Option<Vec<Luminaire>>) -> Option<Awaited> {
        self.tickets += 1;
        let ticket = self.tickets;
        let order = Order { ticket, job, params: self.params, pool: self.pool.clone() };
        match self.loaders.start(order, &self.ends.loopback) {
            Ok(()) => Some(Awaited { ticket, name, luminaires }),
            Err(error) => {
                self.emit(Event::LoadFailed(format!("{name} cannot be loaded, no thread is left ({error})")));
                None
            }
        }
    }

    /// Takes over what a loader made, if it is still wanted; a failure leaves everything as it is.
    pub(super) fn take_prepared(&mut self, ticket: u64, result: Result<Box<Prepared>, String>) {
        let wanted = [&self.loading, &self.remaking].map(|awaited| awaited.as_ref().map(|awaited| awaited.ticket));
        let is_wanted = |ticket| wanted.contains(&Some(ticket));
        if let Err(error) = self.loaders.one_ended(is_wanted, &self.ends.loopback) {
            self.emit(Event::LoadFailed(format!("the scene cannot be loaded, no thread is left ({error})")));
        }
        let is_it = |awaited: &mut Awaited| awaited.ticket == ticket;
        let is_new = self.loading.take_if(is_it).is_some();
        if !is_new && self.remaking.take_if(is_it).is_none() {
            return self.discard(result);
        }
        self.tell_status_soon();
        match result {
            Ok(mut prepared) => {
                let solver = prepared.solver.take();
                let are_sides_old = prepared.sides != self.params.sides;
                let former = self.prepared.replace(prepared);
                self.discard(former);
                if is_new {
                    // They were meant for the scene that is gone.
                    self.deferred.clear();
                }
                if let Some(solver) = solver {
                    self.install(solver);
                }
                self.announce_scene(is_new, self.generation);
                if is_new {
                    if self.runs_when_loaded {
                        self.drive = Drive::Run;
                    }
                    // It was to change the scene that is gone.
                    self.remaking = None;
                }
                if are_sides_old {
                    self.remake(None);
                }
            }
            Err(sentence) if is_new => self.emit(Event::LoadFailed(sentence)),
            Err(sentence) => {
                if let Some(prepared) = &self.prepared {
                    self.params.sides = prepared.sides;
                }
                self.emit(Event::SolveFailed(sentence));
            }
        }
    }

    /// Makes a new solver of the present scene; the one that is there stays if that fails.
    pub(super) fn start_solver(&mut self) {
        let Some(prepared) = &self.prepared else { return };
        let (scene, occluders, seconds) = (prepared.scene.clone(), prepared.occluders.clone(), prepared.seconds);
        let params = self.params;
        self.wants_solver = true;
        self.send_solver(Task::Change(Box::new(move |former| match Solver::new(scene, occluders, params, 0) {
            Ok(mut solver) => {
                solver.set_load_seconds(seconds);
                Changed { solver: Some(solver), outcome: Ok(Change::Replaced) }
            }
            Err(error) => Changed { solver: former, outcome: Err(error.to_string()) },
        })));
    }

    /// Tells of the scene; its snapshots are those from this generation on.
    pub(super) fn announce_scene(&mut self, is_new: bool, generation: u64) {
        self.announced = generation;
        let Some(prepared) = &self.prepared else { return };
        let info = Arc::new(SceneInfo {
            scene: prepared.scene.clone(),
            occluders: prepared.occluders.clone(),
            path: prepared.path.clone(),
            stamps: prepared.stamps.clone(),
            generation,
            has_light: prepared.scene.has_light(),
            is_open: prepared.is_open,
            open_ground: open_ground(&prepared.scene),
            luminaire_size: ceiling::suggested_size(&prepared.scene, &prepared.occluders),
            luminaire_lumens: ceiling::suggested_lumens(&prepared.scene, &prepared.occluders),
            skipped: prepared.scene.skipped.sentences(),
            load_seconds: prepared.seconds,
        });
        self.emit(if is_new { Event::SceneLoaded(info) } else { Event::SceneEdited(info) });
    }

    /// Changes a material in place; links and ε in watts stay.
    pub(super) fn edit_material(&mut self, material: MaterialId, edit: MaterialEdit) {
        let Some(prepared) = self.prepared.as_mut() else { return };
        let index = material.0 as usize;
        let Some(name) = prepared.scene.materials.get(index).map(|material| material.name.clone()) else {
            return self.emit(Event::SolveFailed(format!("the scene has no material number {index}")));
        };
        if let Some(problem) = edit.problem() {
            return self.emit(Event::SolveFailed(format!("the {problem}, that of {name} too")));
        }
        edit.apply(&mut Arc::make_mut(&mut prepared.scene).materials[index]);
        edit.apply(&mut Arc::make_mut(&mut prepared.raw).materials[index]);
        match self.solver {
            Some(_) => self.change_in_place(move |solver| match edit {
                MaterialEdit::Emission(emission) => solver.set_emission(material, emission),
                MaterialEdit::Reflectance(reflectance) => solver.set_reflectance(material, reflectance),
            }),
            None => self.start_solver(),
        }
        self.announce_scene(false, self.generation);
        if let Some(awaited) = &mut self.remaking {
            // What is under way knows nothing of the edit.
            if let MaterialEdit::Emission(exitance) = edit {
                let same = awaited.luminaires.iter_mut().flatten().filter(|luminaire| luminaire.name == name);
                same.for_each(|luminaire| luminaire.exitance = exitance);
            }
            self.remake(None);
        }
    }

    /// Lets another daylight in; the scene is solved anew.
    pub(super) fn set_daylight(&mut self, spec: &Daylight) {
        let Some(prepared) = self.prepared.as_mut() else { return };
        if prepared.raw.daylight() == *spec {
            return;
        }
        let mut scene = (*prepared.scene).clone();
        if let Err(error) = scene.replace_daylight(spec) {
            return self.emit(Event::SolveFailed(error.to_string()));
        }
        Arc::make_mut(&mut prepared.raw).outside.clone_from(&scene.outside);
        prepared.scene = Arc::new(scene);
        self.start_solver();
        self.announce_scene(false, self.generation + 1);
        if self.remaking.is_some() {
            // What is under way knows nothing of it.
            self.remake(None);
        }
    }

    /// Arranges groups by hand; a solution whose clusters do not go by groups stays as it is.
    pub(super) fn set_groups(&mut self, members: Vec<GroupMember>) {
        let Some(prepared) = self.prepared.as_mut() else { return };
        if prepared.raw.regrouping == members {
            return;
        }
        Arc::make_mut(&mut prepared.scene).regrouping.clone_from(&members);
        Arc::make_mut(&mut prepared.raw).regrouping = members;
        let is_solved_anew = self.solver.is_none() || self.params.clustering == ClusteringMode::Groups;
        if is_solved_anew {
            self.start_solver();
        }
        self.announce_scene(false, self.generation + u64::from(is_solved_anew));
        if self.remaking.is_some() {
            // What is under way knows nothing of the new groups.
            self.remake(None);
        }
    }

    /// Measures a relative ε by the power that is emitted now.
    pub(super) fn anchor_epsilon(&mut self) {
        if self.solver.is_some() {
            self.change_in_place(Solver::anchor_epsilon);
        }
    }

    fn change_in_place(&mut self, change: impl FnOnce(&mut Solver) + Send + 'static) {
        self.send_solver(Task::Change(Box::new(move |mut solver| {
            if let Some(solver) = solver.as_mut() {
                change(solver);
            }
            Changed { solver, outcome: Ok(Change::InPlace) }
        })));
    }

    /// Puts other luminaires in place of the present ones. Those that differ in exitance alone are
    /// changed in place; otherwise occluders and clusters are made anew.
    pub(super) fn set_luminaires(&mut self, luminaires: Vec<Luminaire>) {
        let Some(prepared) = &self.prepared else { return };
        let present = prepared.raw.luminaires();
        let is_same = |(a, b): (&Luminaire, &Luminaire)| a.name == b.name && a.form == b.form;
        let is_of_present = luminaires.len() == present.len() && luminaires.iter().zip(&present).all(is_same);
        if !is_of_present || self.remaking.as_ref().is_some_and(|awaited| awaited.luminaires.is_some()) {
            return self.remake(Some(luminaires));
        }
        let materials = prepared.raw.placed_luminaires.iter().map(|placed| placed.material);
        let changed: Vec<(MaterialId, Vec3)> = materials
            .zip(luminaires.iter().zip(&present))
            .filter(|(_, (wanted, present))| wanted.exitance != present.exitance)
            .map(|(material, (wanted, _))| (material, wanted.exitance))
            .collect();
        // Each waits for the solver to come home from the one before.
        self.deferred
            .splice(0..0, changed.into_iter().map(|(material, emission)| Command::SetEmission { material, emission }));
    }

    /// Writes what a person changed beside the scene's file, into what a sidecar that is there
    /// already says.
    pub(super) fn save_sidecar(&mut self, kept: Kept) {
        let Some(prepared) = &self.prepared else { return };
        let Some(path) = prepared.path.as_deref().map(Sidecar::path_for) else {
            let sentence = "a sample scene has no file beside which a settings file could lie";
            return self.emit(Event::SaveFailed(sentence.into()));
        };
        let write = || {
            let mut sidecar = if path.exists() { Sidecar::read(&path)? } else { Sidecar::default() };
            let mut scene = (*prepared.raw).clone();
            scene.sides = self.params.sides.unwrap_or(scene.sides);
            scene.keep(kept);
            sidecar.update(&scene);
            sidecar.write(&path)
        };
        match write() {
            Ok(()) => self.emit(Event::Saved(path)),
            Err(error) => self.emit(Event::SaveFailed(SidecarError::to_string(&error))),
        }
    }
}
