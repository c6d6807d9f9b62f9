//! Gather, push and pull: one sweep moves light once across every link (paper, sections 1.2 and 3.3).

use glam::Vec3;
use rayon::prelude::*;

use super::link::{Link, LinkTable};
use super::params::Push;
use crate::cancel::CancelToken;
use crate::hierarchy::{ElementId, Hierarchy, Shape};

/// Radiosities and irradiances of all elements, parallel to the arena.
#[derive(Clone, Debug, Default)]
pub struct Light {
    /// Radiosity B, W/m².
    pub radiosity: Vec<Vec3>,
    /// Irradiance E, W/m²; meant for leaves, on other elements what reached them from above.
    pub irradiance: Vec<Vec3>,
    /// Emitted part of B, W/m².
    pub emitted: Vec<Vec3>,
    /// What a leaf's irradiance is multiplied by; empty before the first [`Gatherer::limit_rows`].
    pub row_scale: Vec<f32>,
}

impl Light {
    /// Extends the tables to new elements, which start with their parent's light.
    pub fn grow(&mut self, hierarchy: &Hierarchy) {
        for id in (self.radiosity.len()..hierarchy.elements().len()).map(|index| ElementId(index as u32)) {
            let parent = hierarchy.element(id).parent().map(ElementId::index);
            let inherited = |table: &[Vec3]| parent.map_or(Vec3::ZERO, |parent| table[parent]);
            let (radiosity, irradiance) = (inherited(&self.radiosity), inherited(&self.irradiance));
            self.radiosity.push(radiosity);
            self.irradiance.push(irradiance);
            self.emitted.push(inherited(&self.emitted));
        }
    }

    /// Memory of the tables, bytes.
    pub fn bytes(&self) -> usize {
        size_of_val(&self.radiosity[..])
            + size_of_val(&self.irradiance[..])
            + size_of_val(&self.emitted[..])
            + size_of_val(&self.row_scale[..])
    }
}

/// Reflectance and emission of a polygon.
#[derive(Clone, Copy, Debug)]
pub struct Surface {
    /// ρ.
    pub reflectance: Vec3,
    /// B_e, W/m².
    pub emission: Vec3,
}

/// Moves light over a table of links.
pub struct Gatherer<'a> {
    hierarchy: &'a Hierarchy,
    links: &'a LinkTable,
    surfaces: &'a [Surface],
    push: Push,
    with_unjudged: bool,
    /// How each link's light is handed to the patches of its receiver; empty for a deferred push.
    handing: Vec<Handing>,
}

/// No patch receives more than all around it send: its F·V sum to 1 at most, and to so much more as form factors are good for.
/// A row that rays see too well by chance is cut as a whole, and with it light that they see well: to cut at 1 sharply would lose
/// 2 % of the power of a furnished room instead of 1.8 %.
const LARGEST_ROW: f32 = 1.25;
/// Where ρ times a patch's sum of F·V stays below this, light dies out however often it is reflected.
const LARGEST_RETURN: f32 = 0.98;
/// A leaf takes over from its siblings at most as much as it has itself.
const MOST_SCALE: f32 = 2.0;

impl<'a> Gatherer<'a> {
    /// Prepares to move light over `links`, to polygons of these `surfaces`; `with_unjudged` tells whether links that no
    /// ray has judged carry light.
    pub fn new(
        hierarchy: &'a Hierarchy,
        links: &'a LinkTable,
        surfaces: &'a [Surface],
        push: Push,
        with_unjudged: bool,
    ) -> Self {
        let handing = match push {
            Push::Immediate => handings(hierarchy, links),
            Push::Deferred => Vec::new(),
        };
        Self { hierarchy, links, surfaces, push, with_unjudged, handing }
    }

    /// Sweeps until the power still to come is below `tolerance` of all power; false if cancelled, with `light` as the last
    /// whole sweep left it.
    ///
    /// What is to come is estimated by the ratio of successive changes, as of a geometric series.
    pub fn converge(&self, light: &mut Light, tolerance: f64, most_sweeps: u32, cancel: &CancelToken) -> bool {
        let mut last_change = f64::INFINITY;
        for _ in 0..most_sweeps {
            let Some(change) = self.sweep(light, cancel) else { return false };
            let ratio =
                if last_change.is_finite() && last_change > 0.0 { (change.moved / last_change).min(0.99) } else { 0.9 };
            let to_come = change.moved * ratio / (1.0 - ratio);
            if to_come.max(change.moved) <= tolerance * change.power || change.moved == 0.0 {
                break;
            }
            last_change = change.moved;
        }
        true
    }

    /// One sweep: gather over links, push to leaves, reflect, pull up; `None` if cancelled, with nothing changed.
    fn sweep(&self, light: &mut Light, cancel: &CancelToken) -> Option<Change> {
        let incoming = self.incoming(&light.radiosity, &light.emitted, cancel)?;
        let elements = self.hierarchy.elements();
        let mut change = Change::default();
        for (index, element) in elements.iter().enumerate() {
            let from_above = element.parent().map_or(Vec3::ZERO, |parent| light.irradiance[parent.index()]);
            light.irradiance[index] = from_above + incoming[index];
        }
        for (index, element) in elements.iter().enumerate().rev() {
            let old = light.radiosity[index];
            let new = match element.shape {
                Shape::Patch(patch) if element.is_leaf() => {
                    if let Some(&scale) = light.row_scale.get(index) {
                        light.irradiance[index] *= scale;
                    }
                    if element.area <= 0.0 {
                        // Hidden: what the elements above hand down does not reach it.
                        light.irradiance[index] = Vec3::ZERO;
                    }
                    let surface = &self.surfaces[patch.polygon as usize];
                    let new = surface.emission + surface.reflectance * light.irradiance[index];
                    change.moved += f64::from(element.area) * f64::from((new - old).abs().max_element());
                    change.power += f64::from(element.area) * f64::from(new.max_element());
                    new
                }
                _ => mean_of_children(self.hierarchy, &light.radiosity, element.children()),
            };
            light.radiosity[index] = new;
        }
        Some(change)
    }

    /// Finds by how much each leaf's irradiance must be scaled for its F·V to sum to no more than 1; returns how many leaves
    /// exceeded that.
    ///
    /// A leaf shares the links of the patches above it, which are right in the mean over all their leaves but not for each: a
    /// leaf in a corner adds its own large form factors to a mean that holds them already. What a leaf has too much is
    /// therefore what its siblings have too little, and goes to them; a whole initial patch is scaled back where it would get
    /// more than there is, and never up.
    pub fn limit_rows(&self, light: &mut Light, cancel: &CancelToken) -> Option<usize> {
        let elements = self.hierarchy.elements();
        let (evenly_lit, dark) = (vec![Vec3::ONE; elements.len()], vec![Vec3::ZERO; elements.len()]);
        let mut rows: Vec<f32> = self.incoming(&evenly_lit, &dark, cancel)?.into_iter().map(|row| row.x).collect();
        for (index, element) in elements.iter().enumerate() {
            rows[index] += element.parent().map_or(0.0, |parent| rows[parent.index()]);
        }
        let mut exceeding = 0;
        for (index, element) in elements.iter().enumerate().rev().filter(|(_, element)| !element.is_cluster()) {
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
            if !element.is_cluster() && !element.is_leaf() {
                share_out(self.hierarchy, wanted[index], element.children(), &rows, &mut wanted);
            }
        }
        let scale = |(&wanted, &row): (&f32, &f32)| if row > 0.0 { (wanted / row).min(MOST_SCALE) } else { 1.0 };
        light.row_scale = wanted.iter().zip(&rows).map(scale).collect();
        Some(exceeding)
    }

    /// What arrives at each element by its own links; at initial patches also what clusters above push to them at once.
    fn incoming(&self, radiosity: &[Vec3], emitted: &[Vec3], cancel: &CancelToken) -> Option<Vec<Vec3>> {
        let immediate = self.push == Push::Immediate;
        let flux = |link: &Link| {
            let carries = self.with_unjudged || link.evidence() != super::link::Evidence::None;
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
                if immediate && self.hierarchy.element(receiver).is_cluster() {
                    links.map(|(place, link)| flux(link) * self.handing[place].even).sum()
                } else {
                    links.map(|(_, link)| flux(link)).sum()
                }
            })
            .collect();
        if immediate {
            let rays = self.beams(&flux);
            let pushed: Vec<Vec3> = self
                .hierarchy
                .initial_patches()
                .par_iter()
                .with_min_len(64)
                .map(|&patch| if cancel.is_cancelled() { Vec3::ZERO } else { self.pushed_to(patch, &rays) })
                .collect();
            for (&patch, pushed) in self.hierarchy.initial_patches().iter().zip(pushed) {
                incoming[patch.index()] += pushed;
            }
        }
        (!cancel.is_cancelled()).then_some(incoming)
    }

    /// For each cluster the light that its links bring, with where it comes from.
    fn beams(&self, flux: &(impl Fn(&Link) -> Vec3 + Sync)) -> Vec<Vec<Beam>> {
        let cluster_beams = |(index, element): (usize, &crate::hierarchy::Element)| {
            let receiver = ElementId(index as u32);
            if !element.is_cluster() {
                return Vec::new();
            }
            let links = self.links.range(receiver).zip(self.links.of(receiver));
            let beam = |(place, link): (usize, &Link)| Beam {
                from: self.hierarchy.element(link.source()).centre,
                flux: flux(link) * self.handing[place].beam,
            };
            links.filter(|(place, _)| self.handing[*place].beam > 0.0).map(beam).collect()
        };
        self.hierarchy.elements().par_iter().with_min_len(256).enumerate().map(cluster_beams).collect()
    }

    /// Immediate push (α-links, section 3.3): what the clusters above hand to an initial patch, each link by the patch's cosine.
    fn pushed_to(&self, id: ElementId, beams: &[Vec<Beam>]) -> Vec3 {
        let element = self.hierarchy.element(id);
        let Shape::Patch(patch) = element.shape else { return Vec3::ZERO };
        let mut sum = Vec3::ZERO;
        let mut above = element.parent();
        while let Some(cluster) = above {
            for beam in &beams[cluster.index()] {
                sum += beam.flux * cosine_towards(element.centre, patch.normal, beam.from);
            }
            above = self.hierarchy.element(cluster).parent();
        }
        sum
    }
}

/// Positive cosine of a face towards a point.
#[inline]
fn cosine_towards(centre: Vec3, normal: Vec3, point: Vec3) -> f32 {
    let towards = point - centre;
    let height = normal.dot(towards);
    if height > 0.0 { height * towards.length_recip() } else { 0.0 }
}

/// How an immediate push hands a link's light down, in multiples of the receiver's mean irradiance.
#[derive(Clone, Copy, Debug)]
struct Handing {
    /// To a face turned to the source; each patch gets its cosine's share.
    beam: f32,
    /// To every patch, whichever way it faces.
    even: f32,
}

impl Handing {
    const EVEN: Self = Self { beam: 0.0, even: 1.0 };
}

/// The immediate push of each link: a beam of one over the mean cosine of the cluster's patches towards the source, so that
/// together they get the power that the link carries. For randomly turned faces this is the 4 of the paper's model, whose
/// mean cosine is ¼. What has no direction, or would give a face more than the source sends out, is handed down evenly.
fn handings(hierarchy: &Hierarchy, links: &LinkTable) -> Vec<Handing> {
    let of_receiver = |receiver: usize| {
        let receiver = ElementId(receiver as u32);
        links.of(receiver).iter().map(|link| handing(hierarchy, receiver, link)).collect::<Vec<_>>()
    };
    let per_receiver: Vec<Vec<Handing>> =
        (0..links.receivers()).into_par_iter().with_min_len(64).map(of_receiver).collect();
    per_receiver.into_iter().flatten().collect()
}

/// The immediate push of one link.
fn handing(hierarchy: &Hierarchy, receiver: ElementId, link: &Link) -> Handing {
    let element = hierarchy.element(receiver);
    let Shape::Cluster(cluster) = &element.shape else { return Handing::EVEN };
    if link.source() == receiver {
        return Handing::EVEN;
    }
    let from = hierarchy.element(link.source()).centre;
    let seen = hierarchy.patches_below(cluster).iter().map(|&id| {
        let below = hierarchy.element(id);
        let Shape::Patch(patch) = below.shape else { return 0.0 };
        below.area * cosine_towards(below.centre, patch.normal, from)
    });
    let mean_cosine = seen.sum::<f32>() / element.area;
    if mean_cosine <= 0.0 {
        return Handing::EVEN;
    }
    let beam = mean_cosine.recip().min(link.form_factor.recip());
    Handing { beam, even: (1.0 - beam * mean_cosine).max(0.0) }
}

/// What a link at `receiver`, which brings it `flux` (W/m²), hands down to a leaf below: a cluster's to the leaf's initial
/// patch by that one's cosine, as [`Gatherer`] does.
pub fn handed_down(
    hierarchy: &Hierarchy,
    push: Push,
    (receiver, link): (ElementId, &Link),
    flux: Vec3,
    leaf: ElementId,
) -> Vec3 {
    if push == Push::Deferred || !hierarchy.element(receiver).is_cluster() {
        return flux;
    }
    let handing = handing(hierarchy, receiver, link);
    let initial = std::iter::successors(Some(leaf), |&id| {
        hierarchy.element(id).parent().filter(|&parent| !hierarchy.element(parent).is_cluster())
    });
    let element = hierarchy.element(initial.last().unwrap_or(leaf));
    let from = hierarchy.element(link.source()).centre;
    match element.shape {
        Shape::Patch(patch) => {
            flux * (handing.even + handing.beam * cosine_towards(element.centre, patch.normal, from))
        }
        Shape::Cluster(_) => flux,
    }
}

/// Light on its way into a cluster.
struct Beam {
    from: Vec3,
    flux: Vec3,
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

/// Shares the mean that a patch should have out to its children: each keeps its own up to the larger of 1 and the mean,
/// and what is then missing goes where there is room.
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
struct Change {
    /// Σ A·|ΔB| over leaves, W.
    moved: f64,
    /// Σ A·B over leaves, W.
    power: f64,
}
