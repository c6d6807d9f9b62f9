//! The light that surfaces send, as gathers read it: one irradiance for each leaf.
//!
//! The leaves are those of the links' hierarchy and what the gather splits further for its own
//! sake; the links' hierarchy stays as it is. A value is the mean over what is reachable of a leaf,
//! so that the power that gathers read is the power that was found, however coarse the leaves are.

use std::sync::Arc;

use glam::Vec3;
use rayon::prelude::*;

use super::groups::Groups;
use super::openings::{self, Openings};
use super::patches::Patches;
use super::sources::Sources;
use crate::base::random::{cosine_direction, r2_sequence};
use crate::geometry::{EnclosureTest, Hit, LampList, LastStop, Occluders};
use crate::hierarchy::{Element, ElementId, Hierarchy, Patch, Shape};
use crate::scene::outside::Outside;
use crate::scene::{Scene, Surface};
use crate::transport::LinkSolution;

/// Errors of places that are darker than this share of the median are relative to it.
const DIM_SHARE: f32 = 0.1;
/// Where more than half of the area is dark, this share of the mean stands for the median.
const LEAST_OF_MEAN: f32 = 0.1;

/// Elements that one task passes over; a fixed number where sums are made, for them to be the same
/// for any number of threads.
pub(super) const CHUNK: usize = 1 << 13;
/// Seed of the rays that look for openings.
const OPENINGS_SEED: u64 = 0x6f70_656e;

/// The scene as rays meet it; all states of a gather share it.
pub(super) struct Surroundings {
    scene: Arc<Scene>,
    pub(super) occluders: Arc<Occluders>,
    /// Reflectance and emission of each polygon.
    surfaces: Vec<Surface>,
    /// The initial patch of each polygon.
    patches: Vec<ElementId>,
    lamps: Arc<LampList>,
    /// The sky and the sun.
    pub(super) outside: Option<Arc<Outside>>,
    /// Where its sky is seen, unless it is open all around.
    pub(super) openings: Option<Openings>,
}

/// A state of the light that surfaces send; cheap to clone.
#[derive(Clone)]
pub struct Field {
    pub(super) around: Arc<Surroundings>,
    pub(super) hierarchy: Arc<Hierarchy>,
    /// The patches, in the order of the arena.
    patches: Arc<Patches>,
    /// E of each leaf, W/m², parallel to the arena; 0 for what is no leaf.
    pub(super) irradiance: Arc<Vec<Vec3>>,
    /// Whether no light reaches a leaf, likewise; empty before that is known.
    dark: Arc<Vec<bool>>,
    /// Area of each leaf that light can reach, m², likewise: as gathers found it, which looked at
    /// more points than the hierarchy.
    pub(super) areas: Arc<Vec<f32>>,
    /// Square of the distance from which a leaf is read as a whole, m², likewise.
    pub(super) reaches: Arc<Vec<f32>>,
    /// Mean radiosity that each patch reflects, ρE, W/m², parallel to the arena: rays that met a
    /// leaf before it was split read all its parts.
    pub(super) reflected: Arc<Vec<Vec3>>,
    /// Radiosity that readings see of each leaf, ρE, W/m²: the mean over what is seen from afar,
    /// for rays that end near are followed.
    pub(super) sent: Arc<Vec<Vec3>>,
    /// Sources that rays are aimed at.
    pub(super) sources: Arc<Sources>,
    /// E₀, a tenth of the area's median irradiance (mean of the colours), W/m².
    dim: f32,
}

impl std::fmt::Debug for Field {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Field").field("leaves", &self.hierarchy.leaf_count()).finish_non_exhaustive()
    }
}

/// Share of the scene's diagonal within which a place lies on an edge: 0.1 mm in a room, some ten
/// times rounding.
const EDGE_MARGIN: f32 = 1e-5;

/// Where a ray ends.
#[derive(Clone, Copy, Debug)]
pub struct Met {
    /// The leaf.
    pub leaf: ElementId,
    /// Where on it.
    pub position: Vec3,
}

/// How a ray ends.
#[derive(Clone, Copy, Debug)]
pub(super) enum End {
    /// On a bright side.
    Face(Met),
    /// On a dark one, where no light comes from.
    Back,
    /// Nowhere: it leaves the scene.
    Outside,
}

impl End {
    /// The place on a bright side, if it is one.
    pub fn face(self) -> Option<Met> {
        match self {
            Self::Face(met) => Some(met),
            Self::Back | Self::Outside => None,
        }
    }
}

impl Field {
    /// The field of a solution: `irradiance` is that of each leaf, W/m², parallel to the
    /// hierarchy's arena.
    pub fn new(links: &LinkSolution, irradiance: Vec<Vec3>) -> Self {
        let (scene, hierarchy) = (links.scene(), links.hierarchy().clone());
        let mut patches = vec![Hierarchy::ROOT; scene.polygons.len()];
        for &id in hierarchy.initial_patches() {
            if let Shape::Patch(patch) = hierarchy.element(id).shape {
                patches[patch.polygon as usize] = id;
            }
        }
        let surfaces = links.surfaces().to_vec();
        // Of a closed scene nothing is outside.
        let outside = scene.outside().filter(|_| hierarchy.outside().len() > 0).cloned();
        let sources = Sources::emitters(&hierarchy, &surfaces);
        let around = Surroundings {
            scene: scene.clone(),
            occluders: links.occluders().clone(),
            surfaces,
            patches,
            lamps: Arc::new(LampList::new(scene)),
            outside,
            openings: None,
        };
        let mut field = Self {
            around: Arc::new(around),
            patches: Arc::new(Patches::of(&hierarchy)),
            hierarchy: Arc::new(hierarchy),
            irradiance: Arc::default(),
            dark: Arc::default(),
            areas: Arc::default(),
            reaches: Arc::default(),
            reflected: Arc::default(),
            sent: Arc::default(),
            sources: Arc::new(sources),
            dim: 0.0,
        };
        let openings = field.outside().and_then(|outside| Openings::find(&field, outside, OPENINGS_SEED));
        if let Some(around) = Arc::get_mut(&mut field.around) {
            around.openings = openings;
        }
        field.set_areas(|_| None);
        field.reaches = Arc::new(field.own_reaches());
        field.set_irradiance(irradiance);
        field
    }

    /// Rays that looked for openings.
    pub(super) fn opening_rays(&self) -> u64 {
        if self.outside().is_some_and(Outside::has_sky) { openings::RAYS.into() } else { 0 }
    }

    /// Takes over the irradiances of the leaves, W/m², parallel to the arena; what they reflect
    /// follows.
    pub(super) fn set_irradiance(&mut self, mut irradiance: Vec<Vec3>) {
        irradiance.resize(self.hierarchy.elements().len(), Vec3::ZERO);
        self.reflected = Arc::new(self.reflect(&irradiance));
        self.sent = self.reflected.clone();
        self.dim = DIM_SHARE * self.median(&irradiance);
        self.irradiance = Arc::new(irradiance);
    }

    /// Light that each patch reflects of these irradiances of leaves in the mean, ρE, W/m²; both
    /// are parallel to the arena.
    pub(super) fn reflect(&self, irradiance: &[Vec3]) -> Vec<Vec3> {
        let mut reflected = vec![Vec3::ZERO; irradiance.len()];
        let of_leaf = |leaf: &ElementId| self.reflectance(*leaf) * irradiance[leaf.index()].max(Vec3::ZERO);
        let of_leaves: Vec<Vec3> = self.patches.leaves.par_iter().with_min_len(4096).map(of_leaf).collect();
        self.patches.leaves.iter().zip(of_leaves).for_each(|(leaf, of_leaf)| reflected[leaf.index()] = of_leaf);
        self.with_means(reflected)
    }

    /// Values of leaves, parallel to the arena, with their means by area for the patches that were
    /// split.
    pub(super) fn with_means(&self, mut values: Vec<Vec3>) -> Vec<Vec3> {
        let hierarchy = &*self.hierarchy;
        for id in self.patches.split.iter().rev() {
            let children = hierarchy.element(*id).children();
            let area: f32 = children.clone().map(|child| hierarchy.element(child).area).sum();
            let power: Vec3 = children.map(|child| hierarchy.element(child).area * values[child.index()]).sum();
            values[id.index()] = if area > 0.0 { power / area } else { Vec3::ZERO };
        }
        values
    }

    /// Takes over the irradiances of what is seen from afar of each leaf, W/m².
    pub(super) fn set_far(&mut self, irradiance: &[Vec3]) {
        let mut sent = self.reflected.to_vec();
        for leaf in self.leaves() {
            sent[leaf.index()] = self.reflectance(leaf) * irradiance[leaf.index()];
        }
        self.sent = Arc::new(sent);
    }

    /// Takes over how much of each leaf's sampled area is reachable, where that is known.
    pub(super) fn set_areas(&mut self, seen_share: impl Fn(ElementId) -> Option<f32> + Sync) {
        let of = |(index, element): (usize, &Element)| {
            if self.dark.get(index).is_some_and(|is_dark| *is_dark) {
                return 0.0;
            }
            seen_share(ElementId(index as u32)).map_or(element.area, |share| share * element.sampled_area)
        };
        self.areas = Arc::new(self.hierarchy.elements().par_iter().enumerate().map(of).collect());
    }

    /// Leaves out the leaves that no light reaches, parallel to the arena.
    pub(super) fn set_dark(&mut self, dark: Vec<bool>) {
        self.dark = Arc::new(dark);
        self.set_areas(|_| None);
    }

    /// Takes over from where a leaf is read as a whole; of those that share their looks it is their
    /// group that must be far.
    pub(super) fn set_reaches(&mut self, groups: &Groups) {
        let mut reaches = self.reaches.to_vec();
        groups.sizes(self).for_each(|(leaf, size)| reaches[leaf.index()] = 0.5 * size);
        self.reaches = Arc::new(reaches);
    }

    fn own_reaches(&self) -> Vec<f32> {
        self.hierarchy.elements().par_iter().map(|element| self.reach(element)).collect()
    }

    /// Half of the square of a patch's longest diagonal: its area, where it is a square.
    fn reach(&self, element: &Element) -> f32 {
        let Shape::Patch(patch) = &element.shape else { return 0.0 };
        let (corners, count) = self.hierarchy.corner_positions(patch);
        let corners = &corners[..count];
        let squares = corners.iter().flat_map(|a| corners.iter().map(move |b| a.distance_squared(*b)));
        0.5 * squares.fold(0.0, f32::max)
    }

    /// Whether a leaf is too large to stand for what a ray meets there that starts here.
    pub(super) fn is_near(&self, leaf: ElementId, met: Vec3, from: Vec3) -> bool {
        met.distance_squared(from) < self.reaches[leaf.index()]
    }

    /// Area of a leaf that light can reach, m².
    pub fn area(&self, leaf: ElementId) -> f32 {
        self.areas[leaf.index()]
    }

    /// Aims at what reflects much more than the mean as well, from now on.
    pub(super) fn find_secondary(&mut self) {
        let sources = Sources::with_secondary(&self.hierarchy, &self.around.surfaces, &self.reflected);
        self.sources = Arc::new(sources);
    }

    /// Splits leaves, whose parts start with their light.
    pub(super) fn split(&mut self, leaves: &[ElementId]) {
        let hierarchy = Arc::make_mut(&mut self.hierarchy);
        leaves.iter().for_each(|leaf| hierarchy.subdivide(*leaf));
        let mut irradiance = self.irradiance.to_vec();
        irradiance.resize(self.hierarchy.elements().len(), Vec3::ZERO);
        for leaf in leaves {
            let light = irradiance[leaf.index()];
            self.hierarchy.element(*leaf).children().for_each(|child| irradiance[child.index()] = light);
        }
        Arc::make_mut(&mut self.patches).split(&self.hierarchy, leaves);
        self.sources = Arc::new(Sources::emitters(&self.hierarchy, &self.around.surfaces));
        self.set_areas(|_| None);
        let mut reaches = self.reaches.to_vec();
        reaches.extend(self.hierarchy.elements()[reaches.len()..].iter().map(|element| self.reach(element)));
        self.reaches = Arc::new(reaches);
        self.set_irradiance(irradiance);
    }

    /// E₀: local errors are relative to E + E₀ (mean of the colours), W/m².
    pub fn dim(&self) -> f32 {
        self.dim
    }

    /// The leaves with all that holds them.
    pub fn hierarchy(&self) -> &Hierarchy {
        &self.hierarchy
    }

    /// E of each leaf, W/m², parallel to the hierarchy's arena.
    pub fn irradiance(&self) -> &[Vec3] {
        &self.irradiance
    }

    /// B of each leaf, W/m², parallel to the hierarchy's arena.
    pub fn radiosity(&self) -> Vec<Vec3> {
        let mut radiosity = self.reflected.to_vec();
        for leaf in self.leaves() {
            radiosity[leaf.index()] += self.surface(self.patch(leaf).polygon).emission;
        }
        radiosity
    }

    /// The scene that is lit.
    pub fn scene(&self) -> &Arc<Scene> {
        &self.around.scene
    }

    /// Faces that stop light in the scene.
    pub fn occluders(&self) -> &Arc<Occluders> {
        &self.around.occluders
    }

    /// Reflectance and emission of a polygon.
    pub fn surface(&self, polygon: u32) -> &Surface {
        &self.around.surfaces[polygon as usize]
    }

    /// Unit normal of a polygon.
    pub fn normal(&self, polygon: u32) -> Vec3 {
        self.around.scene.normal(&self.around.scene.polygons[polygon as usize])
    }

    /// The bright side that a ray through the air meets first, as a picture shows it: dark sides
    /// are looked through.
    pub fn look_along(&self, origin: Vec3, direction: Vec3) -> Option<Hit> {
        self.around.occluders.first_front(origin, direction)
    }

    /// The leaf of a polygon that holds a point of it.
    pub fn leaf_at(&self, polygon: u32, position: Vec3) -> ElementId {
        self.hierarchy.leaf_at(self.around.patches[polygon as usize], position)
    }

    /// The leaves, in the order of the arena.
    pub fn leaves(&self) -> impl ExactSizeIterator<Item = ElementId> + Clone {
        self.all_leaves().iter().copied()
    }

    /// The leaves, in the order of the arena, for all threads to share out.
    pub(super) fn all_leaves(&self) -> &[ElementId] {
        &self.patches.leaves
    }

    /// Sum of a value over all leaves, the same for any number of threads.
    pub(super) fn sum_over_leaves(&self, value: impl Fn(ElementId) -> f64 + Sync) -> f64 {
        let of_chunk = |leaves: &[ElementId]| leaves.iter().map(|leaf| value(*leaf)).sum::<f64>();
        self.all_leaves().par_chunks(CHUNK).map(of_chunk).collect::<Vec<f64>>().into_iter().sum()
    }

    /// Memory, bytes.
    pub fn bytes(&self) -> usize {
        self.hierarchy.bytes()
            + self.sources.bytes()
            + size_of_val(&self.around.surfaces[..])
            + self.around.openings.as_ref().map_or(0, Openings::bytes)
            + size_of_val(&self.around.patches[..])
            + size_of_val(&self.patches.polygons[..])
            + size_of_val(&self.patches.leaves[..])
            + size_of_val(&self.reaches[..])
            + size_of_val(&self.areas[..])
            + size_of_val(&self.irradiance[..])
            + size_of_val(&self.reflected[..])
    }

    /// The end of a ray from a face.
    pub(super) fn meet(&self, point: Vec3, normal: Vec3, direction: Vec3) -> End {
        match self.around.occluders.ray_from(point, normal, direction) {
            None => End::Outside,
            Some(hit) if hit.front => {
                End::Face(Met { leaf: self.leaf_at(hit.polygon, hit.point), position: hit.point })
            }
            Some(_) => End::Back,
        }
    }

    /// Whether nothing stands between two points of faces with these normals.
    pub(super) fn sees(&self, last: &mut LastStop, from: (Vec3, Vec3), to: (Vec3, Vec3)) -> bool {
        self.around.occluders.sees_after(last, from, to)
    }

    /// Whether a point lies inside of something, as so many rays tell.
    pub(super) fn is_enclosed(&self, point: Vec3, normal: Vec3, seed: u64, rays: u32) -> bool {
        let around = &*self.around;
        EnclosureTest::with_lamps(&around.scene, &around.occluders, around.lamps.clone())
            .is_enclosed(point, normal, seed, rays)
    }

    /// Whether of so many rays from a point at least half meet the backs of faces, or faces that
    /// no light reaches: it lies inside of things, which may run into each other.
    pub fn is_shut_in(&self, (point, normal): (Vec3, Vec3), seed: u64, rays: u32) -> bool {
        let is_stopped = |ray: &u32| {
            let [u, v] = r2_sequence(seed, *ray);
            match self.meet(point, normal, cosine_direction(normal, u, v)) {
                End::Face(met) => self.area(met.leaf) <= 0.0,
                End::Back => true,
                End::Outside => false,
            }
        };
        2 * (0..rays).filter(is_stopped).count() >= rays as usize
    }

    /// The patch that a leaf is.
    pub(super) fn patch(&self, leaf: ElementId) -> &Patch {
        match &self.hierarchy.element(leaf).shape {
            Shape::Patch(patch) => patch,
            Shape::Cluster(_) | Shape::Sky(_) => unreachable!("leaves are patches"),
        }
    }

    /// The point of a leaf's plane that is nearest to a place which was found from afar: what a ray
    /// leaves must lie on its face as nearly as rounding allows.
    pub(super) fn on_plane(&self, leaf: ElementId, position: Vec3) -> Vec3 {
        let patch = self.patch(leaf);
        let corner = self.hierarchy.vertices()[patch.corners()[0] as usize];
        position - patch.normal.dot(position - corner) * patch.normal
    }

    /// A place of a polygon, moved off the edges that it lies on.
    pub(super) fn off_edges(&self, polygon: u32, position: Vec3) -> Vec3 {
        let scene = self.scene();
        let (lower, upper) = scene.bounds();
        let margin = EDGE_MARGIN * lower.distance(upper);
        let (corners, count) = scene.corner_positions(&scene.polygons[polygon as usize]);
        let corners = &corners[..count];
        let is_near = (0..count).any(|index| {
            let (from, along) = (corners[index], corners[(index + 1) % count] - corners[index]);
            (position - from).reject_from(along.normalize_or_zero()).length() < margin
        });
        if !is_near {
            return position;
        }
        let inwards = corners.iter().sum::<Vec3>() / count as f32 - position;
        position + inwards.clamp_length_max(2.0 * margin)
    }

    /// Reflectance of a leaf.
    pub(super) fn reflectance(&self, leaf: ElementId) -> Vec3 {
        self.surface(self.patches.polygons[leaf.index()]).reflectance
    }

    /// Whether a leaf emits.
    pub(super) fn emits(&self, leaf: ElementId) -> bool {
        self.surface(self.patches.polygons[leaf.index()]).emission != Vec3::ZERO
    }

    /// The area's median, or [`LEAST_OF_MEAN`] of its mean, of an irradiance of leaves that do not
    /// emit (mean of the colours), W/m².
    fn median(&self, irradiance: &[Vec3]) -> f32 {
        let lit = |leaf: ElementId| (grey(irradiance[leaf.index()]), self.area(leaf));
        let leaves = self.all_leaves().par_iter().copied().with_min_len(CHUNK);
        let mut sorted: Vec<(f32, f32)> =
            leaves.filter(|leaf| !self.emits(*leaf)).map(lit).filter(|(_, area)| *area > 0.0).collect();
        sorted.par_sort_by(|a, b| a.0.total_cmp(&b.0));
        let area = sorted.iter().map(|(_, area)| f64::from(*area)).sum::<f64>();
        let mut below = 0.0;
        let middle = sorted.iter().find(|(_, of)| {
            below += f64::from(*of);
            below >= 0.5 * area
        });
        let sum = sorted.iter().map(|(value, of)| f64::from(*value) * f64::from(*of)).sum::<f64>();
        let least = LEAST_OF_MEAN * (sum / area.max(f64::MIN_POSITIVE)) as f32;
        middle.map_or(0.0, |(value, _)| value.max(least))
    }
}

/// Mean of the colours.
pub fn grey(light: Vec3) -> f32 {
    light.element_sum() / 3.0
}
