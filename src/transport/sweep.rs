//! Gather, push and pull: one sweep moves light once across every link (paper, sections 1.2 and
//! 3.3).

use glam::Vec3;
use rayon::prelude::*;

use super::entering::is_sky;
use super::link::{Link, LinkTable};
use super::push::Pusher;
use super::rules::{LinkRules, Push};
use crate::base::cancel::CancelToken;
use crate::base::mixing::Mixing;
use crate::hierarchy::{Element, ElementId, Hierarchy, Shape};
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
    /// Facts about each element that a sweep reads, parallel to the arena.
    nodes: Vec<Node>,
    /// Hands what clusters receive to the patches below at once; `None` for a deferred push.
    pusher: Option<Pusher<'a>>,
}

/// The little that a sweep reads of an element: it passes over all of them, and memory is what it
/// waits for.
struct Node {
    parent: u32,
    /// Polygon of a leaf.
    polygon: u32,
    area: f32,
    /// Whether it lies outside, where light is as it is.
    is_sky: bool,
}

/// Stands for "no parent" and "no leaf".
const NONE: u32 = u32::MAX;

impl Node {
    /// Area of a leaf, m², and 0 of other elements, whose light is that of their leaves.
    fn weight(&self) -> f32 {
        if self.polygon == NONE { 0.0 } else { self.area }
    }

    fn of(element: &Element) -> Self {
        let polygon = match element.shape {
            Shape::Patch(patch) if element.is_leaf() => patch.polygon,
            _ => NONE,
        };
        Self {
            parent: element.parent().map_or(NONE, |parent| parent.0),
            polygon,
            area: element.area,
            is_sky: element.is_sky(),
        }
    }
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
        surfaces: &'a [Surface],
        rules: &LinkRules,
        with_unjudged: bool,
    ) -> Self {
        let is_immediate = rules.push == Push::Immediate;
        let pusher = is_immediate.then(|| Pusher::new(hierarchy, links, rules.cluster_model));
        let nodes = hierarchy.elements().iter().map(Node::of).collect();
        Self { hierarchy, links, surfaces, with_unjudged, nodes, pusher }
    }

    /// Sweeps until the power still to come is below `tolerance` of all power; false if cancelled,
    /// with `light` somewhere on the way.
    ///
    /// A reflection keeps the mean reflectance ρ̄ of what it reflects, so that ρ̄/(1−ρ̄) times the
    /// last change is still to come. Sweeps start from a [mixture](Mixing) of the ones before, but
    /// the light is always that of a sweep.
    pub fn converge(&self, light: &mut Light, tolerance: f64, most_sweeps: u32, cancel: &CancelToken) -> bool {
        let weights: Vec<f32> = self.nodes.iter().map(Node::weight).collect();
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
        let incoming = self.incoming(&light.radiosity, &light.emitted, cancel)?;
        let mut change = Change::default();
        for (index, (incoming, node)) in incoming.into_iter().zip(&self.nodes).enumerate() {
            let from_above = light.irradiance.get(node.parent as usize).copied().unwrap_or(Vec3::ZERO);
            light.irradiance[index] = from_above + incoming;
        }
        // Σ A·B of the children, W.
        let mut power_below = vec![Vec3::ZERO; self.nodes.len()];
        for (index, node) in self.nodes.iter().enumerate().rev() {
            if node.is_sky {
                continue;
            }
            let new = if node.polygon == NONE {
                if node.area > 0.0 { power_below[index] / node.area } else { Vec3::ZERO }
            } else {
                let scale = light.row_scale.get(index).copied().unwrap_or(1.0);
                // Hidden wholly: what the elements above hand down does not reach it.
                let scale = if node.area > 0.0 { scale } else { 0.0 };
                light.irradiance[index] = (scale * light.irradiance[index]).max(Vec3::ZERO);
                let surface = &self.surfaces[node.polygon as usize];
                let reflected = surface.reflectance * light.irradiance[index];
                let new = surface.emission + reflected;
                change.note(node.area, [light.radiosity[index], new], (reflected, surface.reflectance));
                new
            };
            light.radiosity[index] = new;
            if let Some(above) = power_below.get_mut(node.parent as usize) {
                *above += node.area * new;
            }
        }
        Some(change)
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
        let elements = self.hierarchy.elements();
        let mut rows = self.rows(cancel)?;
        let mut exceeding = 0;
        for (index, element) in elements.iter().enumerate().rev().filter(|(_, element)| element.is_patch()) {
            if element.is_leaf() {
                exceeding += usize::from(rows[index] > 1.0);
            } else {
                rows[index] = mean_of(self.hierarchy, element.children(), |child| rows[child.index()]);
            }
        }
        let mut wanted = rows.clone();
        for &id in self.hierarchy.initial_patches() {
            let Shape::Patch(patch) = self.hierarchy.element(id).shape else { continue };
            let reflectance = self.surfaces[patch.polygon as usize].reflectance.max_element();
            wanted[id.index()] = rows[id.index()].min((LARGEST_RETURN / reflectance).clamp(1.0, LARGEST_ROW));
        }
        for (index, element) in elements.iter().enumerate() {
            if element.is_patch() && !element.is_leaf() {
                share_out(self.hierarchy, wanted[index], element.children(), &rows, &mut wanted);
            }
        }
        let scale = |(&wanted, &row): (&f32, &f32)| if row > 0.0 { (wanted / row).min(MOST_SCALE) } else { 1.0 };
        light.row_scale = wanted.iter().zip(&rows).map(scale).collect();
        Some(exceeding)
    }

    /// Each element's sum of F·V, its ancestors' included, before rows are limited; parallel to the
    /// arena. `None` if cancelled.
    pub fn rows(&self, cancel: &CancelToken) -> Option<Vec<f32>> {
        let elements = self.hierarchy.elements();
        let (evenly_lit, dark) = (vec![Vec3::ONE; elements.len()], vec![Vec3::ZERO; elements.len()]);
        let mut rows: Vec<f32> = self.incoming(&evenly_lit, &dark, cancel)?.into_iter().map(|row| row.x).collect();
        for (index, element) in elements.iter().enumerate() {
            rows[index] += element.parent().map_or(0.0, |parent| rows[parent.index()]);
        }
        Some(rows)
    }

    /// Irradiance of each element by its own links, W/m²; at initial patches also what clusters
    /// above push to them at once.
    fn incoming(&self, radiosity: &[Vec3], emitted: &[Vec3], cancel: &CancelToken) -> Option<Vec<Vec3>> {
        let flux = |link: &Link| {
            let carries = self.with_unjudged || link.visibility_source() != super::link::VisibilitySource::None;
            let source = link.source().index();
            if carries { link.irradiance(radiosity[source], emitted[source]) } else { Vec3::ZERO }
        };
        let mut incoming: Vec<Vec3> = (0..self.hierarchy.elements().len() as u32)
            .into_par_iter()
            .with_min_len(512)
            .map(ElementId)
            .map(|receiver| {
                if cancel.is_cancelled() {
                    return Vec3::ZERO;
                }
                let links = self.links.range(receiver).zip(self.links.of(receiver));
                match &self.pusher {
                    Some(pusher) if self.hierarchy.element(receiver).is_cluster() => {
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
fn mean_of(hierarchy: &Hierarchy, elements: impl Iterator<Item = ElementId>, value: impl Fn(ElementId) -> f32) -> f32 {
    let (sum, area) = elements.fold((0.0, 0.0), |(sum, area), id| {
        let own = hierarchy.element(id).area;
        (sum + own * value(id), area + own)
    });
    if area > 0.0 { sum / area } else { 0.0 }
}

/// Shares the mean that a patch should have out to its children: each keeps its own up to the
/// larger of 1 and the mean, and what is then missing goes where there is room.
fn share_out(
    hierarchy: &Hierarchy,
    mean: f32,
    children: impl Iterator<Item = ElementId> + Clone,
    rows: &[f32],
    wanted: &mut [f32],
) {
    let most = mean.max(1.0);
    let kept = mean_of(hierarchy, children.clone(), |child| rows[child.index()].min(most));
    let room = most - kept;
    for child in children {
        let own = rows[child.index()].min(most);
        wanted[child.index()] = if mean >= kept {
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

    /// Power that further sweeps are to move, W: no less than the last one did. A reflection keeps
    /// the mean reflectance of what is reflected.
    pub fn to_come(&self) -> f64 {
        let mean = self.reflected_again / self.reflected.max(f64::MIN_POSITIVE);
        let mean = mean.min(LARGEST_RETURN.into());
        self.moved * (mean / (1.0 - mean)).max(1.0)
    }
}
