//! From the links' solution to what is shown: nothing more to do, or a final gather over it.

use std::sync::Arc;

use super::display::{Display, Style};
use super::final_gather::{Context, FinalGather, Progress};
use super::gather::pull;
use super::memory::MemoryStop;
use super::params::Reconstruct;
use super::stats::Phase;
use super::{Solver, Step};
use crate::cancel::CancelToken;
use crate::gather::Field;
use crate::hierarchy::Shape;

impl Solver {
    /// What comes after the last gather over links.
    pub(super) fn end_links(&mut self) {
        self.final_gather = None;
        self.phase = if self.is_to_reconstruct() { Phase::Reconstruct } else { Phase::Done };
    }

    /// Whether a final gather is asked for, and there is light to look for.
    pub(super) fn is_to_reconstruct(&self) -> bool {
        self.params.shown_by() == Reconstruct::Gather && self.scene.has_light()
    }

    /// How leaves become triangles while links are all there is.
    pub(super) fn style(&self) -> Style {
        match self.params.shown_by() {
            Reconstruct::Constant => Style::Flat,
            Reconstruct::Vertex | Reconstruct::Gather => Style::Shared,
        }
    }

    /// The field that readings gather over, once a final gather has ended.
    pub(super) fn field(&mut self) -> Option<Arc<Field>> {
        if self.phase != Phase::Done || self.final_gather.is_none() {
            self.field = None;
            return None;
        }
        let make = || Field::new(&self.scene, &self.occluders, self.hierarchy.clone(), &self.light.irradiance);
        Some(self.field.get_or_insert_with(|| Arc::new(make())).clone())
    }

    /// The error that can be promised, as a share of the RMS radiosity, once it was estimated.
    pub(super) fn error_estimate(&self) -> Option<f64> {
        Some(self.final_gather.as_ref()?.estimate()?.cautious())
    }

    /// A part of the final gather.
    pub(super) fn reconstruct(&mut self, cancel: &CancelToken) -> Step {
        let mut gather = match self.final_gather.take() {
            Some(gather) => gather,
            None if !self.has_room_for_gather() => {
                self.memory_stop.get_or_insert(MemoryStop::Vertices);
                self.phase = Phase::Done;
                return Step::Reconstructed { pass_ended: true };
            }
            None => match self.new_final_gather(cancel) {
                Some(gather) => gather,
                None => return Step::Interrupted,
            },
        };
        let memory = self.budget_of_gather();
        let context = Context {
            scene: &self.scene,
            occluders: &self.occluders,
            surfaces: &self.surfaces,
            seed: self.params.seed,
            memory,
        };
        let progress = gather.step(&mut self.hierarchy, &context, cancel);
        self.memory_stop = self.memory_stop.or(gather.memory_stop());
        self.final_gather = Some(gather);
        let elements = self.hierarchy.elements().len();
        if self.links.receivers() < elements {
            // Leaves that were split keep their light, and share the links of what they were.
            self.links.append(elements, &[]);
            self.grow_light();
        }
        match progress {
            None => Step::Interrupted,
            Some(Progress::Part) => Step::Reconstructed { pass_ended: false },
            Some(Progress::Pass) => Step::Reconstructed { pass_ended: true },
            Some(Progress::Done) => {
                self.take_over();
                self.phase = Phase::Done;
                Step::Reconstructed { pass_ended: true }
            }
        }
    }

    /// What was found at the vertices becomes the leaves' light, in the mean over each.
    fn take_over(&mut self) {
        let Some(gather) = &self.final_gather else { return };
        for (leaf, irradiance) in gather.of_leaves() {
            let Shape::Patch(patch) = self.hierarchy.element(leaf).shape else { continue };
            let surface = &self.surfaces[patch.polygon as usize];
            self.light.irradiance[leaf.index()] = irradiance;
            self.light.radiosity[leaf.index()] = surface.emission + surface.reflectance * irradiance;
        }
        pull(&self.hierarchy, &mut self.light.radiosity);
    }

    fn new_final_gather(&mut self, cancel: &CancelToken) -> Option<FinalGather> {
        let direct = self.gatherer(&self.links).direct(&self.light, cancel)?;
        let all = self.light.irradiance.iter().zip(&direct);
        let indirect: Vec<_> = all.map(|(all, direct)| (*all - *direct).max(glam::Vec3::ZERO)).collect();
        let display = Display::current(self.display.take(), &self.scene, &self.hierarchy, self.style());
        let memory = self.budget_of_gather();
        let context = Context {
            scene: &self.scene,
            occluders: &self.occluders,
            surfaces: &self.surfaces,
            seed: self.params.seed,
            memory,
        };
        let gather = FinalGather::new(
            &display,
            &self.hierarchy,
            &context,
            self.params.error,
            &self.light.irradiance,
            &indirect,
            cancel,
        );
        self.display = Some(display);
        gather
    }
}
