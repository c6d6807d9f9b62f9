//! The scene of a session: loading another, editing the present one, and the solvers made for them.

use std::sync::Arc;

use glam::Vec3;

use super::guard::guarded;
use super::loader::{Awaited, CeilingLight, Job, Prepared};
use super::session::{Drive, Session};
use super::{Event, SceneInfo};
use crate::added_light::AddedLight;
use crate::scene::{
    CameraPose, GroupMember, MAX_EMISSION, MAX_SIDECAR_REFLECTANCE, Material, MaterialId, Sidecar, SidecarError, Source,
};
use crate::solver::{ClusteringMode, Solver, SolverError};

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
    pub(super) fn load(&mut self, source: Source, light: AddedLight) {
        let name = match &source {
            Source::File(path) => path.file_name().unwrap_or(path.as_os_str()).to_string_lossy().into_owned(),
            Source::Builtin(scene) => scene.name().to_owned(),
        };
        self.loading = self.start_loader(Job::Load(source, light), name, Vec::new());
    }

    /// Makes the present scene anew on a thread of its own: with the sides of the present parameters, and one more light
    /// if there is one. Lights that were under way come with it.
    pub(super) fn remake(&mut self, light: Option<CeilingLight>) {
        let Some(prepared) = &self.prepared else { return };
        let (raw, path, stamps) = (prepared.raw.clone(), prepared.path.clone(), prepared.stamps.clone());
        let mut lights = self.remaking.take().map(|awaited| awaited.lights).unwrap_or_default();
        lights.extend(light);
        let name = if lights.is_empty() { "the turned faces" } else { "the ceiling light" };
        let job = Job::Remake { raw, path, stamps, lights: lights.clone() };
        self.remaking = self.start_loader(job, name.into(), lights);
    }

    fn start_loader(&mut self, job: Job, name: String, lights: Vec<CeilingLight>) -> Option<Awaited> {
        self.tickets += 1;
        let ticket = self.tickets;
        let ends = (&self.ends.loopback, &self.ends.cancel);
        match self.loaders.start((ticket, job, self.params.sides), ends) {
            Ok(()) => Some(Awaited { ticket, name, lights }),
            Err(error) => {
                self.emit(Event::LoadFailed(format!("{name} cannot be loaded, no thread is left ({error})")));
                None
            }
        }
    }

    /// Takes over what a loader made, if it is still wanted; a failure leaves everything as it is.
    pub(super) fn take_prepared(&mut self, ticket: u64, result: Result<Box<Prepared>, String>) {
        let wanted = [&self.loading, &self.remaking].map(|awaited| awaited.as_ref().map(|awaited| awaited.ticket));
        let ends = (&self.ends.loopback, &self.ends.cancel);
        if let Err(error) = self.loaders.one_ended(|ticket| wanted.contains(&Some(ticket)), ends) {
            self.emit(Event::LoadFailed(format!("the scene cannot be loaded, no thread is left ({error})")));
        }
        let is_it = |awaited: &mut Awaited| awaited.ticket == ticket;
        let is_new = self.loading.take_if(is_it).is_some();
        if !is_new && self.remaking.take_if(is_it).is_none() {
            return;
        }
        let adopted = result.and_then(|prepared| Ok((self.build_solver(&prepared)?, prepared)));
        match adopted {
            Ok((solver, prepared)) => {
                self.install(solver);
                let are_sides_old = prepared.sides != self.params.sides;
                self.prepared = Some(prepared);
                self.announce_scene(is_new);
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
                if let Some(solver) = &self.solver {
                    self.params = *solver.params();
                }
                self.emit(Event::SolveFailed(sentence));
            }
        }
    }

    /// A new solver of the present scene with a higher generation; the one that is there stays if that fails.
    pub(super) fn start_solver(&mut self) -> Result<(), String> {
        if let Some(prepared) = &self.prepared {
            let solver = self.build_solver(prepared)?;
            self.install(solver);
        }
        Ok(())
    }

    fn build_solver(&self, prepared: &Prepared) -> Result<Solver, String> {
        let (scene, occluders) = (prepared.scene.clone(), prepared.occluders.clone());
        let (params, generation) = (self.params, self.generation + 1);
        let mut solver = guarded(self.pool.as_ref(), move || {
            Solver::new(scene, occluders, params, generation).map_err(|error: SolverError| error.to_string())
        })?;
        solver.set_load_seconds(prepared.seconds);
        Ok(solver)
    }

    fn announce_scene(&self, is_new: bool) {
        let Some(prepared) = &self.prepared else { return };
        let info = Arc::new(SceneInfo {
            scene: prepared.scene.clone(),
            path: prepared.path.clone(),
            stamps: prepared.stamps.clone(),
            generation: self.generation,
            has_light: prepared.scene.has_light(),
            skipped: prepared.scene.skipped.sentences(),
            load_seconds: prepared.seconds,
        });
        self.emit(if is_new { Event::SceneLoaded(info) } else { Event::SceneEdited(info) });
    }

    /// A solver with other clusters takes over, which starts with what the present one knows.
    pub(super) fn rebuild_solver(&mut self) -> Result<(), String> {
        let Some(solver) = &self.solver else { return self.start_solver() };
        let (params, generation) = (self.params, self.generation + 1);
        let rebuilt = guarded(self.pool.as_ref(), || {
            solver.rebuilt(params, generation).map_err(|error: SolverError| error.to_string())
        })?;
        self.install(rebuilt);
        Ok(())
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
        let outcome = match self.solver.as_mut() {
            Some(solver) => {
                let edited = guarded(self.pool.as_ref(), || {
                    match edit {
                        MaterialEdit::Emission(emission) => solver.set_emission(material, emission),
                        MaterialEdit::Reflectance(reflectance) => solver.set_reflectance(material, reflectance),
                    }
                    Ok(())
                });
                edited.map(|()| self.refine_again())
            }
            None => self.start_solver(),
        };
        if let Err(sentence) = outcome {
            self.emit(Event::SolveFailed(sentence));
        }
        self.announce_scene(false);
        if self.remaking.is_some() {
            // What is under way knows nothing of the edit.
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
        if (self.solver.is_none() || self.params.clustering == ClusteringMode::Groups)
            && let Err(sentence) = self.start_solver()
        {
            self.emit(Event::SolveFailed(sentence));
        }
        self.announce_scene(false);
        if self.remaking.is_some() {
            // What is under way knows nothing of the new groups.
            self.remake(None);
        }
    }

    /// Measures a relative ε by the power that is emitted now.
    pub(super) fn anchor_epsilon(&mut self) {
        if let Some(solver) = self.solver.as_mut() {
            solver.anchor_epsilon();
            self.refine_again();
        }
    }

    /// Adds a light; occluders and clusters are made anew.
    pub(super) fn add_ceiling_light(&mut self, size: f32, exitance: Vec3) {
        let is_usable = size.is_finite() && size > 0.0 && exitance.is_finite() && exitance.min_element() >= 0.0;
        if is_usable {
            self.remake(Some(CeilingLight { size, exitance }));
        } else {
            let sentence = "a ceiling light needs a side greater than 0 and a strength that is not negative";
            self.emit(Event::SolveFailed(sentence.into()));
        }
    }

    /// Writes what a person changed beside the scene's file, into what a sidecar that is there already says.
    pub(super) fn save_sidecar(&mut self, camera: Option<CameraPose>) {
        let Some(prepared) = &self.prepared else { return };
        let Some(path) = prepared.path.as_deref().map(Sidecar::path_for) else {
            let sentence = "one of our own scenes has no file beside which a sidecar could lie";
            return self.emit(Event::SaveFailed(sentence.into()));
        };
        let write = || {
            let mut sidecar = if path.exists() { Sidecar::read(&path)? } else { Sidecar::default() };
            let mut scene = (*prepared.raw).clone();
            scene.sides = self.params.sides.unwrap_or(scene.sides);
            scene.camera = camera.or(scene.camera);
            sidecar.update(&scene);
            sidecar.write(&path)
        };
        match write() {
            Ok(()) => self.emit(Event::Saved(path)),
            Err(error) => self.emit(Event::SaveFailed(SidecarError::to_string(&error))),
        }
    }
}
