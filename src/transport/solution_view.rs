//! A view of a solution: elements, links and light of one state, which stays as it is, for views
//! that look inside.
//!
//! A snapshot carries it where somebody asked for it
//! ([`crate::solve::Solver::show_solution_view`]): to copy elements and links costs a few
//! milliseconds in a room, and some tens with a million polygons. Whoever holds it can ask about
//! any element without asking the solver.

mod error;
mod parts;

use std::sync::{Arc, OnceLock};

use glam::Vec3;

use super::link::{Link, LinkTable, VisibilitySource};
use super::push::Inspector;
use super::rules::LinkRules;
use super::sweep::Light;
use crate::hierarchy::{ElementId, Hierarchy, Order, Room};
pub use error::LinkError;

/// Elements, links and light of one state of a solution.
pub struct SolutionView {
    hierarchy: Arc<Hierarchy>,
    links: LinkTable,
    light: Light,
    rules: LinkRules,
    /// Links whose source was dark when they were judged carry nothing: the last gather passes them
    /// over.
    passes_over_unjudged: bool,
    by_source: OnceLock<BySource>,
    orders: [OnceLock<Order>; Room::ALL.len()],
    /// Levels below the root of each element.
    depths: OnceLock<Vec<u16>>,
    /// Mean over its leaves' area of what their irradiance is multiplied by, of each element.
    scales: OnceLock<Vec<f32>>,
    /// Standard deviation of radiosity over the leaves of each element, W/m².
    radiosity_stddev: OnceLock<Vec<f32>>,
}

impl std::fmt::Debug for SolutionView {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let (elements, links) = (self.hierarchy.elements().len(), self.links.len());
        f.debug_struct("SolutionView").field("elements", &elements).field("links", &links).finish_non_exhaustive()
    }
}

/// Places of links in the table, those of one source side by side, and their receivers.
struct BySource {
    starts: Vec<u32>,
    places: Vec<u32>,
    /// Receiver of the link at each place of the table.
    receivers: Vec<ElementId>,
}

/// One link as a view shows it, seen from an element at or below one of its ends.
#[derive(Clone, Copy, Debug)]
pub struct LinkView {
    /// The receiving element.
    pub receiver: ElementId,
    /// The element that sends.
    pub source: ElementId,
    /// Centre of the receiver.
    pub receiver_centre: Vec3,
    /// Centre of the source.
    pub source_centre: Vec3,
    /// Whether the receiver is a cluster.
    pub receiver_is_cluster: bool,
    /// Whether the source is a cluster.
    pub source_is_cluster: bool,
    /// Form factor F(r←s) without occlusion.
    pub form_factor: f32,
    /// Visibility V, 0..=1.
    pub visibility: f32,
    /// How V is known.
    pub visibility_source: VisibilitySource,
    /// Power carried to the whole receiver, B_s·F·V·A_r, W for each channel. People are shown the
    /// sum; ε bounds the strongest channel.
    pub power: Vec3,
    /// How many levels above the element that was asked for this end of the link lies; 0 for the
    /// element itself, negative for its parts.
    pub levels_up: i16,
    /// For light that comes in: what the link brings to the element, W/m²; over all links this adds
    /// up to its irradiance E. For light that goes out: what of the receiver's irradiance is owed
    /// to the element, by its share of the source's power.
    pub irradiance: Vec3,
}

impl SolutionView {
    /// Links and light of one state; `passes_over_unjudged` tells that links that no ray has judged
    /// carry nothing in it.
    pub fn new(
        hierarchy: Arc<Hierarchy>,
        links: LinkTable,
        light: Light,
        rules: LinkRules,
        passes_over_unjudged: bool,
    ) -> Self {
        Self {
            hierarchy,
            links,
            light,
            rules,
            passes_over_unjudged,
            by_source: OnceLock::new(),
            orders: Default::default(),
            depths: OnceLock::new(),
            scales: OnceLock::new(),
            radiosity_stddev: OnceLock::new(),
        }
    }

    /// The elements.
    pub fn hierarchy(&self) -> &Hierarchy {
        &self.hierarchy
    }

    /// The links; those that wait to be judged lie among them, with their estimated form factor and
    /// without visibility rays.
    pub fn links(&self) -> &LinkTable {
        &self.links
    }

    /// Threshold ε of this state, W.
    pub fn epsilon_watts(&self) -> f64 {
        self.rules.epsilon_watts
    }

    /// Radiosity B of an element, W/m².
    pub fn radiosity(&self, id: ElementId) -> Vec3 {
        self.light.radiosity.get(id.index()).copied().unwrap_or_default()
    }

    /// Exitance B_e of an element, the emitted part of its radiosity, W/m².
    pub fn emitted(&self, id: ElementId) -> Vec3 {
        self.light.emitted.get(id.index()).copied().unwrap_or_default()
    }

    /// Irradiance E of an element, W/m²: that of its leaves in the mean over their area.
    pub fn irradiance(&self, id: ElementId) -> Vec3 {
        let (mut sum, mut area) = (Vec3::ZERO, 0.0);
        self.hierarchy.leaves_below(id, &mut |leaf| {
            let own = self.hierarchy.element(leaf).area;
            sum += own * self.light.irradiance.get(leaf.index()).copied().unwrap_or_default();
            area += own;
        });
        if area > 0.0 { sum / area } else { Vec3::ZERO }
    }

    /// Whether there is such an element in this state.
    pub fn holds(&self, id: ElementId) -> bool {
        id.index() < self.hierarchy.elements().len()
    }

    /// The elements from the root down to this one.
    pub fn path(&self, id: ElementId) -> Vec<ElementId> {
        let mut path: Vec<ElementId> = self.upwards(id).collect();
        path.reverse();
        path
    }

    /// This element and all that hold it, upwards.
    fn upwards(&self, id: ElementId) -> impl Iterator<Item = ElementId> {
        std::iter::successors(Some(id), |&at| self.hierarchy.element(at).parent())
    }

    /// The order of the hierarchy: where each element lies on the line from 0 to 1.
    pub fn order(&self, room: Room) -> &Order {
        self.orders[room as usize].get_or_init(|| Order::new(&self.hierarchy, room))
    }

    /// Links that bring an element light, its own and those of all that holds it; strongest power
    /// first.
    pub fn incoming(&self, id: ElementId) -> Vec<LinkView> {
        let inspector = Inspector::new(&self.hierarchy, &self.rules);
        let scale = self.scale(id);
        let mut views = Vec::new();
        for (levels_up, at) in self.upwards(id).enumerate() {
            for link in self.links.of(at).iter().filter(|link| self.carries(link)) {
                let flux = self.flux(link);
                let irradiance = scale * inspector.handed_down((at, link), flux, id);
                views.push(LinkView { irradiance, ..self.view(at, link, levels_up as i16) });
            }
        }
        views.sort_by(|a, b| b.power.element_sum().total_cmp(&a.power.element_sum()));
        views
    }

    /// Links that take an element's light elsewhere, its own and those of all that holds it;
    /// strongest power first.
    pub fn outgoing(&self, id: ElementId) -> Vec<LinkView> {
        let by_source = self.by_source.get_or_init(|| BySource::new(&self.links, self.hierarchy.elements().len()));
        let power = |at: ElementId| self.radiosity(at) * self.hierarchy.element(at).area;
        let own = power(id);
        let mut views = Vec::new();
        for (levels_up, at) in self.upwards(id).enumerate() {
            let all = power(at);
            let part = |own: f32, all: f32| if all > 0.0 { (own / all).min(1.0) } else { 0.0 };
            let share = Vec3::new(part(own.x, all.x), part(own.y, all.y), part(own.z, all.z));
            for &place in by_source.of(at) {
                let link = &self.links.all()[place as usize];
                if self.carries(link) {
                    let view = self.view(by_source.receivers[place as usize], link, levels_up as i16);
                    views.push(LinkView { irradiance: share * self.flux(link), ..view });
                }
            }
        }
        views.sort_by(|a, b| b.power.element_sum().total_cmp(&a.power.element_sum()));
        views
    }

    /// Every link with its receiver, in the order of receivers.
    pub fn all_links(&self) -> impl Iterator<Item = LinkView> + '_ {
        let receivers = (0..self.links.receivers() as u32).map(ElementId);
        receivers.flat_map(move |receiver| self.links_of(receiver))
    }

    /// The links at a receiver, without those of what holds it.
    pub fn links_of(&self, receiver: ElementId) -> impl Iterator<Item = LinkView> + '_ {
        self.links.of(receiver).iter().map(move |link| self.view(receiver, link, 0))
    }

    /// A link as a view shows it; its irradiance is what it brings to its receiver.
    fn view(&self, receiver: ElementId, link: &Link, levels_up: i16) -> LinkView {
        let (to, from) = (self.hierarchy.element(receiver), self.hierarchy.element(link.source()));
        let flux = if self.carries(link) { self.flux(link) } else { Vec3::ZERO };
        LinkView {
            receiver,
            source: link.source(),
            receiver_centre: to.centre,
            source_centre: from.centre,
            receiver_is_cluster: to.is_cluster(),
            source_is_cluster: from.is_cluster(),
            form_factor: link.form_factor,
            visibility: link.visibility(),
            visibility_source: link.visibility_source(),
            power: flux * to.area,
            levels_up,
            irradiance: flux,
        }
    }

    fn carries(&self, link: &Link) -> bool {
        !self.passes_over_unjudged || link.visibility_source() != VisibilitySource::None
    }

    fn flux(&self, link: &Link) -> Vec3 {
        link.irradiance(self.radiosity(link.source()), self.emitted(link.source()))
    }
}

impl BySource {
    fn new(links: &LinkTable, elements: usize) -> Self {
        let mut starts = vec![0_u32; elements + 1];
        for link in links.all() {
            starts[link.source().index() + 1] += 1;
        }
        for source in 0..elements {
            starts[source + 1] += starts[source];
        }
        let mut next = starts.clone();
        let mut places = vec![0; links.len()];
        for (place, link) in links.all().iter().enumerate() {
            let slot = &mut next[link.source().index()];
            places[*slot as usize] = place as u32;
            *slot += 1;
        }
        let receivers = (0..links.receivers() as u32).map(ElementId);
        let receivers = receivers.flat_map(|receiver| links.of(receiver).iter().map(move |_| receiver)).collect();
        Self { starts, places, receivers }
    }

    fn of(&self, source: ElementId) -> &[u32] {
        &self.places[self.starts[source.index()] as usize..self.starts[source.index() + 1] as usize]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::builtin::BuiltinScene;
    use crate::solve::{Solver, SolverParams};

    /// Truth: each link comes in at one end and goes out at the other, and carries the same power
    /// there.
    #[test]
    fn what_goes_out_comes_in() {
        let solution_view = Solver::solved_view(BuiltinScene::Cornell.build(), SolverParams::with_epsilon(3e-3));
        let hierarchy = solution_view.hierarchy();
        let (mut incoming, mut outgoing) = (Vec::new(), Vec::new());
        for id in hierarchy.ids() {
            let own = |views: Vec<LinkView>| views.into_iter().filter(|view| view.levels_up == 0);
            let key = |view: LinkView| (view.receiver, view.source, view.power.element_sum().to_bits());
            incoming.extend(own(solution_view.incoming(id)).map(key));
            outgoing.extend(own(solution_view.outgoing(id)).map(key));
        }
        incoming.sort_unstable();
        outgoing.sort_unstable();
        assert!(incoming.len() > 100);
        assert_eq!(incoming, outgoing);
    }
}
