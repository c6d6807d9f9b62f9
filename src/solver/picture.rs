//! Pictures: what the solution looks like before it is finished, made on the side.
//!
//! A picture gathers over the stored links and over everything that still waits, at its present level; it never writes the
//! solver's own radiosities, so a solve is the same whether or not anybody looks.

use rayon::prelude::*;

use super::Solver;
use super::candidate::Waiting;
use super::display::Display;
use super::form_factor::{Exchange, exchange, self_exchange};
use super::gather::{Gatherer, Light};
use super::link::{Evidence, Link, LinkTable};
use super::push::Inspector;
use super::snapshot::{InspectedElement, LinkView, Snapshot};
use super::stats::Phase;
use crate::cancel::CancelToken;
use crate::hierarchy::{ElementId, Hierarchy, Shape};

/// The light of the last picture, from which the next one starts.
#[derive(Default)]
pub struct Picture {
    light: Option<Light>,
}

/// A picture's gather ends when this share of the power is still to come: less than a shade on a screen.
const PICTURE_TOLERANCE: f64 = 5e-3;
/// Sweeps of the first picture, which starts from emitted light.
const FIRST_SWEEPS: u32 = 12;
/// Sweeps of a later one, which starts from the picture before.
const LATER_SWEEPS: u32 = 3;

/// The present state as a snapshot.
pub(super) fn snapshot(solver: &mut Solver) -> Snapshot {
    solver.serial += 1;
    let finished = matches!(solver.phase, Phase::Reconstruct | Phase::Done);
    let table = (!finished).then(|| table_with_waiting(solver));
    let light = match &table {
        Some(table) => picture_light(solver, table),
        None => solver.light.clone(),
    };
    let style = solver.style();
    let gathered = solver.final_gather.as_ref().filter(|gather| gather.is_ready());
    let of_links = match gathered {
        Some(_) => None,
        None => Some(Display::current(solver.display.take(), &solver.scene, &solver.hierarchy, style)),
    };
    let (display, vertex_radiosity) = match (&of_links, gathered) {
        (None, Some(gather)) => (gather.display(), gather.radiosity()),
        (Some(display), _) => (display, display.of_vertices(&light.radiosity)),
        (None, None) => unreachable!("what is not gathered comes from links"),
    };
    let snapshot = Snapshot {
        generation: solver.generation,
        serial: solver.serial,
        mesh: display.mesh.clone(),
        vertex_radiosity,
        leaf_irradiance: display.of_leaves(&light.irradiance),
        leaf_radiosity: display.of_leaves(&light.radiosity),
        clusters: display.clusters.clone(),
        inspected: solver
            .inspected
            .and_then(|element| inspected(solver, table.as_ref().unwrap_or(&solver.links), &light, element)),
        stats: solver.stats(),
    };
    if of_links.is_some() {
        solver.display = of_links;
    }
    solver.picture.light = Some(light);
    snapshot
}

/// Irradiance E of each vertex of the last snapshot's mesh, W/m².
pub(super) fn vertex_irradiance(solver: &Solver) -> Vec<[f32; 3]> {
    let gathered = solver.final_gather.as_ref().filter(|gather| gather.is_ready());
    match (gathered, &solver.display, &solver.picture.light) {
        (Some(gather), ..) => gather.vertex_irradiance(),
        (None, Some(display), Some(light)) => display.of_vertices(&light.irradiance),
        _ => Vec::new(),
    }
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
    let hierarchy = &solver.hierarchy;
    let waiting: Vec<&Waiting> = solver.refinement.waiting().collect();
    let as_links: Vec<[Option<(ElementId, Link)>; 2]> =
        waiting.par_iter().with_min_len(256).map(|waiting| links_of_waiting(hierarchy, waiting)).collect();
    let accepted = solver.refinement.accepted.iter().copied();
    let further: Vec<(ElementId, Link)> = accepted.chain(as_links.into_iter().flatten().flatten()).collect();
    let mut table = solver.links.clone();
    table.append(hierarchy.elements().len(), &further);
    table
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
        // A row of siblings stands for the exchange of one child with the rest of its cluster: let the cluster light it.
        Waiting::Siblings { cluster, child, from } => {
            let element = hierarchy.element(cluster);
            let Some(own) = element.children().nth(child as usize) else { return [None, None] };
            let Some((_, link)) = self_link(hierarchy, cluster) else { return [None, None] };
            let left = (element.children().len() as u32 - from) as f32 / element.children().len() as f32;
            // Rows shrink as the wave goes on; both halves of the pairs of a row go to its child.
            let form_factor = (link.form_factor * 2.0 * left).min(link.form_factor);
            [Some((own, Link::new(cluster, form_factor, 1.0, Evidence::None))), None]
        }
    }
}

fn self_link(hierarchy: &Hierarchy, id: ElementId) -> Option<(ElementId, Link)> {
    let element = hierarchy.element(id);
    let Shape::Cluster(cluster) = &element.shape else { return None };
    let form_factor = if element.area > 0.0 { self_exchange(element, cluster) / element.area } else { 0.0 };
    Some((id, Link::new(id, form_factor, 1.0, Evidence::None)))
}

/// The links that bring light to an element, its own and its ancestors', among those that `light` came over; strongest first.
fn inspected(solver: &Solver, table: &LinkTable, light: &Light, id: ElementId) -> Option<InspectedElement> {
    let hierarchy = &solver.hierarchy;
    let element = hierarchy.elements().get(id.index())?;
    let scale = light.row_scale.get(id.index()).copied().unwrap_or(1.0);
    let finished = matches!(solver.phase, Phase::Reconstruct | Phase::Done);
    let inspector = Inspector::new(hierarchy, &solver.params);
    let mut links = Vec::new();
    for (levels_up, at) in std::iter::successors(Some(id), |&at| hierarchy.element(at).parent()).enumerate() {
        let receiver = hierarchy.element(at);
        for link in table.of(at) {
            if finished && link.evidence() == Evidence::None {
                // The source was dark, and the last gather passed it over.
                continue;
            }
            let source = hierarchy.element(link.source());
            let from = link.source().index();
            let flux = link.irradiance(light.radiosity[from], light.emitted[from]);
            links.push(LinkView {
                receiver: at,
                source: link.source(),
                receiver_centre: receiver.centre,
                source_centre: source.centre,
                source_is_cluster: source.is_cluster(),
                form_factor: link.form_factor,
                visibility: link.visibility(),
                power: flux.max_element() * receiver.area,
                levels_up: levels_up as u16,
                receiver_is_cluster: receiver.is_cluster(),
                irradiance: scale * inspector.handed_down((at, link), flux, id),
            });
        }
    }
    links.sort_by(|a, b| b.power.total_cmp(&a.power));
    Some(InspectedElement { element: id, centre: element.centre, links })
}
