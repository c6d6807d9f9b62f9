//! Gather, push and pull: one sweep moves light once across every link (paper, sections 1.2 and
//! 3.3).

use std::ops::Range;

use glam::Vec3;
use rayon::prelude::*;

use super::entering::is_sky;
use super::link::{Link, LinkTable, VisibilitySource};
use super::nodes::{CHUNK, Kind, Node, Nodes};
use super::push::{PushTables, Pusher};
use super::rules::{LinkRules, Push};
use crate::base::cancel::CancelToken;
use crate::base::mixing::Mixing;
use crate::hierarchy::{ElementId, Hierarchy, Shape};
use crate::scene::Surface;

/// Radiosities and irradiances of all elements, parallel to the arena.
#[derive(Clone, Debug, Default)]
pub struct Light {
    /// Radiosity B, W/m².
    pub radiosity: Vec<Vec3>,
    /// Irradiance E, W/m²; meant for leaves, on other elements what reached them from above.
    pub irradiance: Vec<Vec3>,
    /// Emitted part of B, W/m².
    pub emitted: Vec<Vec3>,
    /// Factor on each leaf's irradiance; empty before the first [`Gatherer::enforce_closure`].
    pub row_scale: Vec<f32>,
}

impl Light {
    /// Extends the tables to new elements, which start with their parent's light; what lies outside
    /// has its own.
    pub fn grow(&mut self, hierarchy: &Hierarchy) {
        for id in (self.radiosity.len()..hierarchy.elements().len()).map(|index| ElementId(index as u32)) {
            let parent = hierarchy.element(id).parent().map(ElementId::index);
            let inherited = |table: &[Vec3]| parent.map_or(Vec3::ZERO, |parent| table[parent]);
            let [radiosity, irradiance, emitted] = match hierarchy.element(id).shape {
                Shape::Sky(number) => {
                    let radiosity = hierarchy.sky_part(number).radiosity;
                    [radiosity, Vec3::ZERO, radiosity]
                }
                _ => [&self.radiosity, &self.irradiance, &self.emitted].map(|table| inherited(table)),
            };
            self.radiosity.push(radiosity);
            self.irradiance.push(irradiance);
            self.emitted.push(emitted);
        }
    }

    /// Forgets all but the first so many elements.
    pub fn truncate(&mut self, elements: usize) {
        for table in [&mut self.radiosity, &mut self.irradiance, &mut self.emitted] {
            table.truncate(elements);
        }
        self.row_scale.truncate(elements);
    }

    /// Memory of the tables, bytes.
    pub fn bytes(&self) -> usize {
        size_of_val(&self.radiosity[..])
            + size_of_val(&self.irradiance[..])
            + size_of_val(&self.emitted[..])
            + size_of_val(&self.row_scale[..])
    }
}

/// Moves light over a table of links.
pub struct Gatherer<'a> {
    hierarchy: &'a Hierarchy,
    links: &'a LinkTable,
    surfaces: &'a [Surface],
    with_unjudged: bool,
    pub(super) nodes: Nodes,
    /// Hands what clusters receive to the patches below at once; `None` for a deferred push.
    pusher: Option<Pusher<'a>>,
}

/// No patch receives more than all around it send: its F·V sum to 1, give or take what few rays are
/// wrong by. Rows that are too small by chance stay as they are, so to cut those that are too large
/// at 1 would lose light: at 1.002 the seminar room gets 4 % darker. A row beyond this is no
/// chance.
const LARGEST_ROW: f32 = 1.25;
/// Where ρ times a patch's sum of F·V stays below this, light dies out however often it is
/// reflected.
pub const LARGEST_RETURN: f32 = 0.98;
/// A leaf takes over from its siblings at most as much as it has itself.
const MOST_SCALE: f32 = 2.0;

impl<'a> Gatherer<'a> {
    /// Prepares to move light over `links`, to polygons of these `surfaces`; `with_unjudged` tells
    /// whether links that no ray has judged carry light.
    pub fn new(
        hierarchy: &'a Hierarchy,
        links: &'a LinkTable,
        (surfaces, tables): (&'a [Surface], &'a PushTables),
        rules: &LinkRules,
        with_unjudged: bool,
    ) -> Self {
        let is_immediate = rules.push == Push::Immediate;
        let pusher = is_immediate.then(|| Pusher::new(hierarchy, links, tables, rules.cluster_model));
        Self { hierarchy, links, surfaces, with_unjudged, nodes: Nodes::new(hierarchy), pusher }
    }

    /// Sweeps until the power still to come is below `tolerance` of all power; false if cancelled,
    /// with `light` somewhere on the way.
    ///
    /// A reflection keeps the mean reflectance ρ̄ of what it reflects, so that ρ̄/(1−ρ̄) times the
    /// last change is still to come. Sweeps start from a [mixture](Mixing) of the ones before, but
    /// the light is always that of a sweep.
    pub fn converge(&self, light: &mut Light, tolerance: f64, most_sweeps: u32, cancel: &CancelToken) -> bool {
        let weights: Vec<f32> = self.nodes.all().iter().map(Node::weight).collect();
        let mut mixing = Mixing::default();
        for sweep in 1..=most_sweeps {
            let from = light.radiosity.clone();
            let Some(change) = self.sweep(light, cancel) else { return false };
            if change.to_come() <= tolerance * change.power || sweep == most_sweeps {
                tracing::debug!(sweep, "light converged");
                break;
            }
            light.radiosity = mixing.next(&weights, &from, std::mem::take(&mut light.radiosity));
        }
        true
    }

    /// Irradiance that emitted light and the sun alone bring over the links, parallel to the arena,
    /// W/m²; `None` if cancelled.
    pub fn direct(&self, light: &Light, cancel: &CancelToken) -> Option<Vec<Vec3>> {
        let mut emitted = light.emitted.clone();
        for id in self.hierarchy.ids().filter(|id| is_sky(self.hierarchy, *id)) {
            emitted[id.index()] = Vec3::ZERO;
        }
        let mut direct = Light { radiosity: emitted.clone(), emitted, ..light.clone() };
        self.sweep(&mut direct, cancel)?;
        Some(direct.irradiance)
    }

    /// One sweep: gather over links, push to leaves, reflect, pull up; `None` if cancelled, with
    /// nothing changed.
    fn sweep(&self, light: &mut Light, cancel: &CancelToken) -> Option<Change> {
        let lit = self.nodes.hand_down(self.incoming(&light.radiosity, &light.emitted, cancel)?);
        let Light { radiosity, irradiance, row_scale, .. } = light;
        let reflect = |(chunk, (irradiance, radiosity)): (usize, (&mut [Vec3], &mut [Vec3]))| {
            let mut change = Change::default();
            for (index, (irradiance, radiosity)) in (chunk * CHUNK..).zip(irradiance.iter_mut().zip(radiosity)) {
                let node = &self.nodes.all()[index];
                *irradiance = lit[index];
                if node.kind == Kind::Leaf {
                    let scale = row_scale.get(index).copied().unwrap_or(1.0);
                    // Hidden wholly: what the elements above hand down does not reach it.
                    let scale = if node.area > 0.0 { scale } else { 0.0 };
                    *irradiance = (scale * *irradiance).max(Vec3::ZERO);
                    let surface = &self.surfaces[node.polygon as usize];
                    let reflected = surface.reflectance * *irradiance;
                    let new = surface.emission + reflected;
                    change.note(node.area, [*radiosity, new], (reflected, surface.reflectance));
                    *radiosity = new;
                }
            }
            change
        };
        let chunks = irradiance.par_chunks_mut(CHUNK).zip(radiosity.par_chunks_mut(CHUNK)).enumerate();
        let changes: Vec<Change> = chunks.map(reflect).collect();
        self.nodes.pull(radiosity);
        Some(changes.into_iter().fold(Change::default(), Change::and))
    }

    /// Finds by how much each leaf's irradiance must be scaled for its F·V to sum to no more than
    /// 1; returns how many leaves exceeded that.
    ///
    /// A leaf shares the links of the patches above it, which are right in the mean over all their
    /// leaves but not for each: a leaf in a corner adds its own large form factors to a mean that
    /// holds them already. What a leaf has too much is therefore what its siblings have too little,
    /// and goes to them; a whole initial patch is scaled back where it would get more than there
    /// is, and never up.
    pub fn enforce_closure(&self, light: &mut Light, cancel: &CancelToken) -> Option<usize> {
        let nodes = self.nodes.all();
        let mut rows = self.rows(cancel)?;
        let exceeds = |(node, row): &(&Node, &f32)| node.kind == Kind::Leaf && **row > 1.0;
        let exceeding = nodes.par_iter().zip(&rows).with_min_len(CHUNK).filter(exceeds).count();
        let split = || self.nodes.inner().filter(|inner| nodes[inner.index].kind == Kind::Split);
        for patch in split().rev() {
            rows[patch.index] = mean_by_area(nodes, patch.children.clone(), |child| rows[child]);
        }
        let wanted = |(node, row): (&Node, &f32)| {
            let is_whole = node.parent().is_some_and(|parent| nodes[parent].kind == Kind::Cluster);
            if matches!(node.kind, Kind::Leaf | Kind::Split) && is_whole {
                let reflectance = self.surfaces[node.polygon as usize].reflectance.max_element();
                row.min((LARGEST_RETURN / reflectance).clamp(1.0, LARGEST_ROW))
            } else {
                *row
            }
        };
        let mut wanted: Vec<f32> = nodes.par_iter().zip(&rows).with_min_len(CHUNK).map(wanted).collect();
        for patch in split() {
            share_out(nodes, wanted[patch.index], patch.children.clone(), &rows, &mut wanted);
        }
        let scale = |(&wanted, &row): (&f32, &f32)| if row > 0.0 { (wanted / row).min(MOST_SCALE) } else { 1.0 };
        light.row_scale = wanted.par_iter().zip(&rows).with_min_len(CHUNK).map(scale).collect();
        Some(exceeding)
    }

    /// Each element's sum of F·V, its ancestors' included, before rows are limited; parallel to the
    /// arena. `None` if cancelled.
    pub fn rows(&self, cancel: &CancelToken) -> Option<Vec<f32>> {
        let elements = self.nodes.all().len();
        let (evenly_lit, dark) = (vec![Vec3::ONE; elements], vec![Vec3::ZERO; elements]);
        let own = self.incoming(&evenly_lit, &dark, cancel)?.into_iter().map(|row| row.x).collect();
        Some(self.nodes.hand_down(own))
    }

    /// Irradiance of each element by its own links, W/m²; at initial patches also what clusters
    /// above push to them at once.
    fn incoming(&self, radiosity: &[Vec3], emitted: &[Vec3], cancel: &CancelToken) -> Option<Vec<Vec3>> {
        let flux = |link: &Link| {
            let carries = self.with_unjudged || link.visibility_source() != VisibilitySource::None;
            let source = link.source().index();
            if carries { link.irradiance(radiosity[source], emitted[source]) } else { Vec3::ZERO }
        };
        let mut incoming: Vec<Vec3> = (0..self.nodes.all().len() as u32)
            .into_par_iter()
            .with_min_len(512)
            .map(ElementId)
            .map(|receiver| {
                if cancel.is_cancelled() {
                    return Vec3::ZERO;
                }
                let links = self.links.range(receiver).zip(self.links.of(receiver));
                match &self.pusher {
                    Some(pusher) if self.nodes.all()[receiver.index()].kind == Kind::Cluster => {
                        links.map(|(place, link)| flux(link) * pusher.share_handed_evenly(place)).sum()
                    }
                    _ => links.map(|(_, link)| flux(link)).sum(),
                }
            })
            .collect();
        if let Some(pusher) = &self.pusher {
            let pushed = pusher.push(&flux, cancel);
            for (&patch, pushed) in self.hierarchy.initial_patches().iter().zip(pushed) {
                incoming[patch.index()] += pushed;
            }
        }
        (!cancel.is_cancelled()).then_some(incoming)
    }
}

/// Sets the radiosity of all elements from their leaves', by area.
pub fn pull(hierarchy: &Hierarchy, radiosity: &mut [Vec3]) {
    for (index, element) in hierarchy.elements().iter().enumerate().rev() {
        if !element.is_leaf() {
            radiosity[index] = mean_of_children(hierarchy, radiosity, element.children());
        }
    }
}

fn mean_of_children(hierarchy: &Hierarchy, radiosity: &[Vec3], children: impl Iterator<Item = ElementId>) -> Vec3 {
    let mut power = Vec3::ZERO;
    let mut area = 0.0;
    for child in children {
        let child_area = hierarchy.element(child).area;
        power += child_area * radiosity[child.index()];
        area += child_area;
    }
    if area > 0.0 { power / area } else { Vec3::ZERO }
}

/// Mean of a value over elements, by area.
fn mean_by_area(nodes: &[Node], elements: Range<usize>, value: impl Fn(usize) -> f32) -> f32 {
    let (sum, area) = elements.fold((0.0, 0.0), |(sum, area), element| {
        let own = nodes[element].area;
        (sum + own * value(element), area + own)
    });
    if area > 0.0 { sum / area } else { 0.0 }
}

/// Shares the mean that a patch should have out to its children: each keeps its own up to the
/// larger of 1 and the mean, and what is then missing goes where there is room.
fn share_out(nodes: &[Node], mean: f32, children: Range<usize>, rows: &[f32], wanted: &mut [f32]) {
    let most = mean.max(1.0);
    let kept = mean_by_area(nodes, children.clone(), |child| rows[child].min(most));
    let room = most - kept;
    for child in children {
        let own = rows[child].min(most);
        wanted[child] = if mean >= kept {
            own + if room > 0.0 { (most - own) * (mean - kept) / room } else { 0.0 }
        } else {
            own * mean / kept
        };
    }
}

/// How much one sweep moved.
#[derive(Default)]
pub struct Change {
    /// Σ A·|ΔB| over leaves, W.
    moved: f64,
    /// Σ A·B over leaves, W.
    pub power: f64,
    /// Σ A·ρ·E over leaves, W, and what of that they would reflect themselves.
    reflected: f64,
    reflected_again: f64,
}

impl Change {
    /// Adds a leaf of this area, m², whose radiosity was the first and is the second, W/m², with
    /// what it reflects of that and its reflectance.
    pub fn note(&mut self, area: f32, [before, now]: [Vec3; 2], (reflected, reflectance): (Vec3, Vec3)) {
        let watts = |radiosity: Vec3| f64::from(area) * f64::from(radiosity.max_element());
        self.moved += watts((now - before).abs());
        self.power += watts(now);
        self.reflected += watts(reflected);
        self.reflected_again += watts(reflected) * f64::from(reflectance.max_element());
    }

    /// Both changes together.
    pub fn and(self, other: Self) -> Self {
        Self {
            moved: self.moved + other.moved,
            power: self.power + other.power,
            reflected: self.reflected + other.reflected,
            reflected_again: self.reflected_again + other.reflected_again,
        }
    }

    /// Power that further sweeps are to move, W: no less than the last one did. A reflection keeps
    /// the mean reflectance of what is reflected.
    pub fn to_come(&self) -> f64 {
        let mean = self.reflected_again / self.reflected.max(f64::MIN_POSITIVE);
        let mean = mean.min(LARGEST_RETURN.into());
        self.moved * (mean / (1.0 - mean)).max(1.0)
    }
}
