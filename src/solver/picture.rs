//! Pictures: what the solution looks like before it is finished, made on the side.
//!
//! A picture gathers over the stored links and over everything that still waits, at its present level; it never writes the
//! solver's own radiosities, so a solve is the same whether or not anybody looks.

use std::sync::Arc;

use rayon::prelude::*;

use super::Solver;
use super::anatomy::Anatomy;
use super::candidate::Waiting;
use super::display::Display;
use super::final_gather::FinalGather;
use super::form_factor::{Exchange, exchange, self_exchange};
use super::gather::{Gatherer, Light};
use super::link::{Evidence, Link, LinkTable};
use super::snapshot::Snapshot;
use super::stats::Phase;
use crate::cancel::CancelToken;
use crate::hierarchy::{ElementId, Hierarchy, Shape};

/// The light of the last picture, from which the next one starts.
#[derive(Default)]
pub struct Picture {
    light: Option<Light>,
}

impl Picture {
    /// As if this had been the light of the last picture.
    pub fn of(light: Light) -> Self {
        Self { light: Some(light) }
    }
}

/// A picture's gather ends when this share of the power is still to come: less than a shade on a screen.
pub(super) const PICTURE_TOLERANCE: f64 = 5e-3;
/// Sweeps of the first picture, which starts from emitted light.
pub(super) const FIRST_SWEEPS: u32 = 12;
/// Sweeps of a later one, which starts from the picture before.
const LATER_SWEEPS: u32 = 3;

/// The present state as a snapshot.
pub(super) fn snapshot(solver: &mut Solver) -> Snapshot {
    solver.serial += 1;
    let finished = matches!(solver.phase, Phase::Reconstruct | Phase::Done);
    let nothing_waits = solver.refinement.is_finished() && solver.refinement.accepted.is_empty();
    let is_known = finished || solver.is_converged && nothing_waits;
    let table = (!is_known).then(|| table_with_waiting(solver));
    let light = match &table {
        Some(table) => picture_light(solver, table),
        None => solver.light.clone(),
    };
    let style = solver.style();
    if solver.wants_anatomy {
        solver.freeze();
    }
    let is_gathered = solver.final_gather.as_ref().is_some_and(FinalGather::is_ready);
    let of_links =
        (!is_gathered).then(|| Display::current(solver.display.take(), &solver.scene, &solver.hierarchy, style));
    let field = solver.field();
    let gathered = solver.final_gather.as_ref().filter(|gather| gather.is_ready());
    let (display, vertex_irradiance, vertex_radiosity) = match (&of_links, gathered) {
        (None, Some(gather)) => {
            let irradiance = gather.vertex_irradiance();
            let radiosity = gather.radiosity_of(&irradiance);
            (gather.display(), irradiance, radiosity)
        }
        (Some(display), _) => (display, display.of_vertices(&light.irradiance), display.of_vertices(&light.radiosity)),
        (None, None) => unreachable!("what is not gathered comes from links"),
    };
    let anatomy =
        solver.wants_anatomy.then(|| solver.anatomy(table.as_ref().unwrap_or(&solver.links), &light, finished));
    let snapshot = Snapshot {
        generation: solver.generation,
        serial: solver.serial,
        mesh: display.mesh.clone(),
        vertex_radiosity,
        vertex_irradiance,
        leaf_irradiance: display.of_leaves(&light.irradiance),
        leaf_radiosity: display.of_leaves(&light.radiosity),
        clusters: display.clusters.clone(),
        moment: None,
        field,
        anatomy,
        stats: solver.stats(),
    };
    if of_links.is_some() {
        solver.display = of_links;
    }
    solver.picture.light = Some(light);
    snapshot
}

fn picture_light(solver: &mut Solver, table: &LinkTable) -> Light {
    let first = solver.picture.light.is_none();
    let mut light = solver.picture.light.take().unwrap_or_else(|| solver.light.clone());
    light.grow(&solver.hierarchy);
    let gatherer = Gatherer::new(&solver.hierarchy, table, &solver.surfaces, &solver.params, true);
    let never = CancelToken::new();
    gatherer.limit_rows(&mut light, &never);
    gatherer.converge(&mut light, PICTURE_TOLERANCE, if first { FIRST_SWEEPS } else { LATER_SWEEPS }, &never);
    solver.keep_bounds(&mut light);
    light
}

/// Stored links, those that wait to be stored, and candidates as if they had been accepted.
fn table_with_waiting(solver: &Solver) -> LinkTable {
    let mut table = solver.links.clone();
    table.append(solver.hierarchy.elements().len(), &links_not_stored(solver));
    table
}

/// Links that wait to be stored, and candidates as if they had been accepted; with their receivers.
pub(super) fn links_not_stored(solver: &Solver) -> Vec<(ElementId, Link)> {
    let hierarchy = &solver.hierarchy;
    let waiting: Vec<&Waiting> = solver.refinement.waiting().collect();
    let as_links: Vec<[Option<(ElementId, Link)>; 2]> =
        waiting.par_iter().with_min_len(256).map(|waiting| links_of_waiting(hierarchy, waiting)).collect();
    let accepted = solver.refinement.accepted.iter().copied();
    accepted.chain(as_links.into_iter().flatten().flatten()).collect()
}

/// What waits, as links with their estimated form factor and the visibility of what they came from.
fn links_of_waiting(hierarchy: &Hierarchy, waiting: &Waiting) -> [Option<(ElementId, Link)>; 2] {
    match *waiting {
        Waiting::Pair(candidate) if candidate.is_self() => [self_link(hierarchy, candidate.a), None],
        Waiting::Pair(candidate) => {
            let (a, b) = (candidate.a, candidate.b);
            let Exchange::Facing { estimate, .. } = exchange(hierarchy, a, b) else { return [None, None] };
            let link = |asked: bool, receiver: ElementId, source: ElementId| {
                let area = hierarchy.element(receiver).area;
                let form_factor = if area > 0.0 { (estimate / area).min(1.0) } else { 0.0 };
                asked.then(|| (receiver, Link::new(source, form_factor, candidate.visibility(), Evidence::None)))
            };
            [link(candidate.directions.to_a, a, b), link(candidate.directions.to_b, b, a)]
        }
        Waiting::Siblings { .. } => [link_of_row(hierarchy, waiting).map(|(own, link)| (own, link.unjudged())), None],
    }
}

/// A row of siblings stands for the exchange of one child with the rest of its cluster: lets the cluster light it. `None` for
/// anything else.
pub(super) fn link_of_row(hierarchy: &Hierarchy, waiting: &Waiting) -> Option<(ElementId, Link)> {
    let Waiting::Siblings { cluster, child, from } = *waiting else { return None };
    let element = hierarchy.element(cluster);
    let own = element.children().nth(child as usize)?;
    let (_, link) = self_link(hierarchy, cluster)?;
    let left = (element.children().len() as u32 - from) as f32 / element.children().len() as f32;
    // Rows shrink as the wave goes on; both halves of the pairs of a row go to its child.
    let form_factor = (link.form_factor * 2.0 * left).min(link.form_factor);
    Some((own, Link::new(cluster, form_factor, 1.0, Evidence::Inherited)))
}

fn self_link(hierarchy: &Hierarchy, id: ElementId) -> Option<(ElementId, Link)> {
    let element = hierarchy.element(id);
    let Shape::Cluster(cluster) = &element.shape else { return None };
    let form_factor = if element.area > 0.0 { self_exchange(element, cluster) / element.area } else { 0.0 };
    Some((id, Link::new(id, form_factor, 1.0, Evidence::None)))
}

impl Solver {
    /// Copies the hierarchy unless the copy that is there still is as it is.
    pub(super) fn freeze(&mut self) {
        let elements = self.hierarchy.elements().len();
        if self.frozen.as_ref().is_none_or(|frozen| frozen.elements().len() != elements) {
            self.frozen = Some(Arc::new(self.hierarchy.clone()));
        }
    }

    /// The anatomy of a state with these links and this light, over the hierarchy that was last frozen.
    pub(super) fn anatomy(&self, links: &LinkTable, light: &Light, is_final: bool) -> Arc<Anatomy> {
        let hierarchy = self.frozen.clone().unwrap_or_else(|| Arc::new(self.hierarchy.clone()));
        let mut light = light.clone();
        light.grow(&hierarchy);
        Arc::new(Anatomy::new(hierarchy, links.clone(), light, self.params, self.epsilon_watts, is_final))
    }
}
