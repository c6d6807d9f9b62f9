//! From the links' solution to what is shown: nothing more to do, or a gather over it.

use std::sync::Arc;

use glam::Vec3;

use super::display::Style;
use super::memory::MemoryStop;
use super::params::Reconstruct;
use super::stats::{ErrorFound, Phase};
use super::{Solver, Step};
use crate::cancel::CancelToken;
use crate::gather::{Certificate, Field, Full, Gather, Goal, LinkLight, Progress, Quantiles, RISK};

impl Solver {
    /// What comes after the last gather over links.
    pub(super) fn end_links(&mut self) {
        self.gather = None;
        self.phase = if self.is_to_reconstruct() { Phase::Reconstruct } else { Phase::Done };
    }

    /// Whether a final gather is asked for, and there is light to look for.
    pub(super) fn is_to_reconstruct(&self) -> bool {
        self.params.shown_by() == Reconstruct::Gather && self.scene.has_light()
    }

    /// How leaves become triangles.
    pub(super) fn style(&self) -> Style {
        match self.params.shown_by() {
            Reconstruct::Constant => Style::Flat,
            Reconstruct::Vertex | Reconstruct::Gather => Style::Shared,
        }
    }

    /// The field that readings gather over, as soon as there is one.
    pub fn field(&self) -> Option<&Field> {
        self.gather.as_ref().filter(|gather| gather.is_ready()).map(Gather::field)
    }

    /// The same, to be kept.
    pub(super) fn shared_field(&self) -> Option<Arc<Field>> {
        self.field().cloned().map(Arc::new)
    }

    /// What is known of the error of readings, once it is.
    pub fn certificate(&self) -> Option<&Certificate> {
        self.gather.as_ref()?.certificate()
    }

    /// A part of the final gather.
    pub(super) fn reconstruct(&mut self, cancel: &CancelToken) -> Step {
        let mut gather = match self.gather.take() {
            Some(gather) => gather,
            None if !self.has_room_for_gather() => {
                self.memory_stop.get_or_insert(MemoryStop::Vertices);
                self.phase = Phase::Done;
                return Step::Reconstructed { pass_ended: true };
            }
            None => match self.new_gather(cancel) {
                Some(gather) => gather,
                None => return Step::Interrupted,
            },
        };
        let progress = gather.step(cancel);
        let stop = gather.full().map(|full| match full {
            Full::Leaves => MemoryStop::Vertices,
            Full::Looks => MemoryStop::Rays,
        });
        self.memory_stop = self.memory_stop.or(stop);
        self.gather = Some(gather);
        match progress {
            None => Step::Interrupted,
            Some(Progress::Part) => Step::Reconstructed { pass_ended: false },
            Some(Progress::Pass) => Step::Reconstructed { pass_ended: true },
            Some(Progress::Done) => {
                self.phase = Phase::Done;
                self.error_found = self.find_error();
                Step::Reconstructed { pass_ended: true }
            }
        }
    }

    /// What the certificate says, and what the bare mesh shows at its points.
    fn find_error(&mut self) -> Option<ErrorFound> {
        let field = self.field()?.clone();
        let certificate = self.certificate()?.clone();
        let points = certificate.points.iter().map(|(point, truth)| (*point, *truth, 0.0));
        let mut errors = self.errors_of_mesh(&field, points);
        let found = ErrorFound {
            bound: certificate.bound,
            confidence: 1.0 - RISK,
            points: certificate.points.len(),
            read: certificate.read,
            radiosity_rms: certificate.radiosity_rms,
            mesh: Quantiles::of(&mut errors),
        };
        Some(found)
    }

    fn new_gather(&mut self, cancel: &CancelToken) -> Option<Gather> {
        let direct = self.gatherer(&self.links).direct(&self.light, cancel)?;
        let all = self.light.irradiance.iter().zip(&direct);
        let indirect: Vec<_> = all.map(|(all, direct)| (*all - *direct).max(Vec3::ZERO)).collect();
        let links = LinkLight {
            scene: &self.scene,
            occluders: &self.occluders,
            surfaces: &self.surfaces,
            hierarchy: &self.hierarchy,
            indirect: &indirect,
        };
        let goal = Goal { error: self.params.error, memory: self.budget_of_gather(), seed: self.params.seed };
        Some(Gather::new(&links, goal))
    }
}
