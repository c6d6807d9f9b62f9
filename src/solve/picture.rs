//! Pictures: what the solution looks like before it is finished, made on the side.
//!
//! A picture gathers over the stored links and over everything that still waits, at its present
//! level; it never writes the solver's own radiosities, so a solve is the same whether or not
//! anybody looks.

use std::sync::Arc;

use glam::Vec3;

use super::Solver;
use super::reconstruction_mesh::ReconstructionMesh;
use super::snapshot::Snapshot;
use crate::base::cancel::CancelToken;
use crate::hierarchy::Hierarchy;
use crate::transport::{Light, LinkSolution, LinkTable, SolutionView};

/// State that pictures keep from one to the next.
#[derive(Default)]
pub(super) struct View {
    /// Number of the solve that the pictures are of.
    pub generation: u64,
    /// Number of the last picture.
    pub serial: u64,
    /// The light of the last picture, from which the next one starts.
    pub light: Option<Light>,
    /// Mesh of the hierarchy.
    pub reconstruction: Option<ReconstructionMesh>,
    /// Whether snapshots carry the solution view.
    pub wants_solution_view: bool,
    /// The hierarchy of the last one that did.
    pub hierarchy: Option<Arc<Hierarchy>>,
}

impl View {
    /// Nothing was seen of this solve yet.
    pub fn new(generation: u64) -> Self {
        Self { generation, ..Self::default() }
    }

    /// Forgets all that was seen; numbers go on.
    pub fn clear(&mut self) {
        (self.light, self.reconstruction, self.hierarchy) = (None, None, None);
    }
}

/// A picture's gather ends when this share of the power is still to come: less than a shade on a
/// screen.
pub(super) const PICTURE_TOLERANCE: f64 = 5e-3;
/// Sweeps of the first picture, which starts from emitted light.
pub(super) const FIRST_SWEEPS: u32 = 12;
/// Sweeps of a later one, which starts from the picture before.
const LATER_SWEEPS: u32 = 3;

/// The present state as a snapshot.
pub(super) fn snapshot(solver: &mut Solver) -> Snapshot {
    solver.view.serial += 1;
    let is_finished = solver.job.is_past_links();
    let refinement = solver.links.refinement();
    let nothing_waits = refinement.is_finished() && refinement.accepted.is_empty();
    let is_known = is_finished || solver.links.is_converged() && nothing_waits;
    let table = (!is_known).then(|| solver.links.table_with_waiting());
    let kind = solver.mesh_kind();
    if solver.view.wants_solution_view {
        solver.copy_hierarchy();
    }
    let field = solver.shared_field();
    let (old, former) = (solver.view.reconstruction.take(), solver.view.light.take());
    let hierarchy = field.as_ref().map_or(solver.hierarchy(), |field| field.hierarchy());
    let link_elements = solver.hierarchy().elements().len();
    let links = &solver.links;
    let (light, reconstruction) = rayon::join(
        || table.as_ref().map_or_else(|| links.light().clone(), |table| picture_light(links, former, table)),
        || ReconstructionMesh::current(old, links.scene(), hierarchy, link_elements, kind),
    );
    let radiosity_of_field = field.as_ref().map(|field| field.radiosity());
    let irradiance: &[Vec3] = field.as_ref().map_or(&light.irradiance, |field| field.irradiance());
    let radiosity: &[Vec3] = radiosity_of_field.as_deref().unwrap_or(&light.radiosity);
    let links = table.as_ref().unwrap_or(solver.links.links());
    let solution_view = solver.view.wants_solution_view.then(|| solver.solution_view(links, &light, is_finished));
    let snapshot = Snapshot {
        generation: solver.view.generation,
        serial: solver.view.serial,
        mesh: reconstruction.mesh.clone(),
        vertex_radiosity: reconstruction.of_vertices(radiosity),
        vertex_irradiance: reconstruction.of_vertices(irradiance),
        leaf_irradiance: reconstruction.of_leaves(irradiance),
        leaf_radiosity: reconstruction.of_leaves(radiosity),
        clusters: reconstruction.clusters.clone(),
        former_step: None,
        field,
        solution_view,
        stats: solver.stats(),
    };
    solver.view.reconstruction = Some(reconstruction);
    solver.view.light = Some(light);
    snapshot
}

fn picture_light(links: &LinkSolution, former: Option<Light>, table: &LinkTable) -> Light {
    let first = former.is_none();
    let mut light = former.unwrap_or_else(|| links.light().clone());
    light.grow(links.hierarchy());
    let gatherer = links.gatherer(table, true);
    let never = CancelToken::new();
    gatherer.enforce_closure(&mut light, &never);
    gatherer.converge(&mut light, PICTURE_TOLERANCE, if first { FIRST_SWEEPS } else { LATER_SWEEPS }, &never);
    gatherer.keep_bounds(links, &mut light);
    light
}

impl Solver {
    /// Copies the hierarchy unless the copy that is there still is as it is.
    fn copy_hierarchy(&mut self) {
        let elements = self.hierarchy().elements().len();
        if self.view.hierarchy.as_ref().is_none_or(|hierarchy| hierarchy.elements().len() != elements) {
            self.view.hierarchy = Some(Arc::new(self.hierarchy().clone()));
        }
    }

    /// The solution view of a state with these links and this light, over the hierarchy that was
    /// last copied.
    pub(super) fn solution_view(&self, links: &LinkTable, light: &Light, is_final: bool) -> Arc<SolutionView> {
        let hierarchy = self.view.hierarchy.clone().unwrap_or_else(|| Arc::new(self.hierarchy().clone()));
        Arc::new(self.links.solution_view(hierarchy, links, light, is_final))
    }
}
