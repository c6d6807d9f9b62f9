//! From the links' solution to what is shown: nothing more to do, or a gather over it.

use std::sync::Arc;

use super::Solver;
use super::job::{Job, Step};
use super::memory::MemoryStop;
use super::params::Reconstruct;
use super::reconstruction_mesh::MeshKind;
use super::stats::ErrorFound;
use crate::base::cancel::CancelToken;
use crate::gather::{Certificate, Field, Full, Gather, Goal, Progress, Quantiles, RISK};

fn log_attempt(gather: &Gather, attempt: u32) {
    let Some(certificate) = gather.certificate() else { return };
    let Certificate { bound, read, points, .. } = certificate;
    let (p90, points, rays) = (read.p90, points.len(), gather.rays());
    tracing::info!(attempt, bound, p90, points, rays, "certificate");
}

impl Solver {
    /// Ends the work on links, after light was moved over them for the last time.
    pub(super) fn end_links(&mut self) {
        self.gather = None;
        self.job = if self.is_to_gather() { Job::Gather } else { Job::Done };
    }

    /// Whether a final gather is asked for, and there is light to look for.
    pub(super) fn is_to_gather(&self) -> bool {
        self.params.shown_by() == Reconstruct::Gather && self.scene().has_light()
    }

    /// How leaves become triangles.
    pub(super) fn mesh_kind(&self) -> MeshKind {
        match self.params.shown_by() {
            Reconstruct::Constant => MeshKind::Flat,
            Reconstruct::Vertex | Reconstruct::Gather => MeshKind::Shared,
        }
    }

    /// The field that readings gather over, as soon as there is one.
    pub fn field(&self) -> Option<&Field> {
        self.gather.as_ref().filter(|gather| gather.is_ready()).map(Gather::field)
    }

    /// That field, to be kept.
    pub(super) fn shared_field(&self) -> Option<Arc<Field>> {
        self.field().cloned().map(Arc::new)
    }

    /// Certificate of the error of readings, once there is one.
    pub fn certificate(&self) -> Option<&Certificate> {
        self.gather.as_ref()?.certificate()
    }

    /// A part of the final gather; `None` if cancelled.
    pub(super) fn gather(&mut self, cancel: &CancelToken) -> Option<Step> {
        if self.gather.is_none() {
            if !self.has_room_for_gather() {
                self.memory_stop.get_or_insert(MemoryStop::Vertices);
                self.job = Job::Done;
                return Some(Step::Reconstructed { pass_ended: true });
            }
            let goal = Goal { error: self.params.error, memory: self.budget_of_gather(), seed: self.params.seed };
            self.gather = Some(Gather::new(&self.links, goal, cancel)?);
        }
        let gather = self.gather.as_mut()?;
        let (attempt, _) = gather.progress();
        let progress = gather.step(cancel);
        if gather.progress().0 != attempt || matches!(progress, Some(Progress::Done)) {
            log_attempt(gather, attempt);
        }
        let stop = gather.full().map(|full| match full {
            Full::Leaves => MemoryStop::Vertices,
            Full::Looks => MemoryStop::Rays,
        });
        self.memory_stop = self.memory_stop.or(stop);
        let progress = progress?;
        if progress == Progress::Done {
            self.job = Job::Done;
            self.error_found = self.find_error();
        }
        Some(Step::Reconstructed { pass_ended: progress != Progress::Part })
    }

    /// Errors by the certificate, and of the bare mesh at its points.
    fn find_error(&mut self) -> Option<ErrorFound> {
        let field = self.field()?.clone();
        let certificate = self.certificate()?.clone();
        let mut errors = self.errors_of_mesh(&field, certificate.points.iter().copied());
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
}
