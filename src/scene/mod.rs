//! The scene: polygons, materials, groups and a camera, as every later layer reads them.
//!
//! A scene comes from a file ([`load_file`]: OBJ, glTF/GLB, PLY or STL, and its sidecar) or from
//! code ([`builtin`]). Nothing here knows about clusters, links or windows.

mod assemble;
pub mod builtin;
mod check;
mod draft;
mod edit;
mod face;
mod files;
mod flat_tops;
mod gltf;
mod kept;
mod known_sizes;
mod load;
mod load_error;
mod luminaire;
mod mtl;
mod obj;
pub mod outside;
mod paint;
mod place;
mod ply;
mod punctual;
mod reading;
mod regroup;
mod regroup_edit;
mod regroup_list;
mod sanitize;
mod sidecar;
mod stl;
pub mod texture;
mod triangulate;
mod unit;
mod up;
mod write;

use std::sync::Arc;

use glam::{DVec3, Vec3};
use outside::Outside;
use rustc_hash::FxHashMap;
use serde::{Deserialize, Serialize};
use texture::MaterialTextures;

pub use check::{Skipped, UnreadExtension, UnreadTexture};
pub use edit::EditError;
pub use face::{FaceDetails, Surface};
pub use files::{FileError, SceneFiles, SceneFolder};
pub use kept::{FiledTaskArea, Kept, TaskArea};
pub use load::{Source, load_bytes, load_file, load_with};
pub use load_error::{Fault, LoadError};
pub use luminaire::{
    CEILING_LIGHT, FiledLuminaire, LINE_WIDTH, Luminaire, LuminaireForm, LuminaireShape, PlacedLuminaire,
};
pub use place::FiledCamera;
pub(crate) use place::to_file;
pub use reading::{Frame, Reading};
pub use regroup::{GroupMember, GroupTree};
pub use regroup_edit::{RegroupError, Regrouped};
pub use sidecar::{MAX_EMISSION, MAX_SIDECAR_REFLECTANCE, Sidecar, SidecarError, SidecarFault, SidecarMaterial};
pub use unit::Unit;
pub use up::UpAxis;
pub use write::{WriteError, write_obj};
pub(crate) use write::{make_folder, write_file};

/// Index into [`Scene::materials`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct MaterialId(pub u32);

/// Index into [`Scene::groups`]; the root group is `GroupId(0)`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct GroupId(pub u32);

/// A diffuse material.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Material {
    /// Name as the file gives it.
    pub name: String,
    /// Reflectance ρ per colour, 0 ≤ ρ < 1: the mean by area where faces differ
    /// ([`Scene::surface`]).
    pub reflectance: Vec3,
    /// Emission B_e per colour, W/m² (exitance, π times the radiance of OBJ `Ke`): the mean by area
    /// where faces differ.
    pub emission: Vec3,
    /// Textures, where there are any.
    pub textures: Option<Arc<MaterialTextures>>,
    /// Whether its faces are bright on both sides (glTF's `doubleSided`).
    pub is_two_sided: bool,
    /// Faces that were left out because they are transparent.
    pub left_out: usize,
}

/// A node of the scene's own hierarchy: an OBJ path such as `office/desk_2`, or a glTF node.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Group {
    /// Name of this level alone, without its parents'.
    pub name: String,
    /// The group that holds this one; `None` for the root alone.
    pub parent: Option<GroupId>,
}

/// A triangle or a (nearly planar, convex) quad with one bright side: the one from which its
/// corners run anticlockwise.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Polygon {
    corners: [u32; 4],
    /// The material of the bright side.
    pub material: MaterialId,
    /// The group that holds the polygon directly.
    pub group: GroupId,
    /// True for the second of two opposite patches made of one face ([`Sides::Both`]); it casts no
    /// shadow of its own.
    pub is_back: bool,
    /// True for a face that is bright on both sides: a further polygon is its back.
    pub has_back: bool,
    /// Number of the polygon's entry in [`Scene::details`], or [`NO_DETAIL`].
    detail: u32,
}

/// Marks a polygon of which a file says nothing beside its material.
const NO_DETAIL: u32 = u32::MAX;

/// Marks the absent fourth corner of a triangle.
const NO_CORNER: u32 = u32::MAX;

impl Polygon {
    /// A triangle over vertex indices.
    pub fn triangle(corners: [u32; 3], material: MaterialId, group: GroupId) -> Self {
        let [a, b, c] = corners;
        Self { corners: [a, b, c, NO_CORNER], material, group, is_back: false, has_back: false, detail: NO_DETAIL }
    }

    /// A quad over vertex indices, in order around its rim.
    pub fn quad(corners: [u32; 4], material: MaterialId, group: GroupId) -> Self {
        Self { corners, material, group, is_back: false, has_back: false, detail: NO_DETAIL }
    }

    /// A part of this face over other vertex indices, three or four; it is what the whole face is
    /// in all else.
    ///
    /// # Panics
    /// There must be three or four corners.
    pub fn part(&self, corners: &[u32]) -> Self {
        let corners = match *corners {
            [a, b, c] => [a, b, c, NO_CORNER],
            [a, b, c, d] => [a, b, c, d],
            _ => panic!("a polygon has three or four corners, not {}", corners.len()),
        };
        Self { corners, ..*self }
    }

    /// The three or four vertex indices, anticlockwise as seen from the bright side.
    pub fn corners(&self) -> &[u32] {
        if self.corners[3] == NO_CORNER { &self.corners[..3] } else { &self.corners }
    }

    /// Replaces each vertex index; [`builtin`] welds with it.
    pub(crate) fn map_corners(&mut self, mut replace: impl FnMut(u32) -> u32) {
        let count = self.corners().len();
        for corner in &mut self.corners[..count] {
            *corner = replace(*corner);
        }
    }

    /// Whether the polygon has four corners.
    pub fn is_quad(&self) -> bool {
        self.corners[3] != NO_CORNER
    }

    /// The face with its bright side turned to the other half space.
    pub fn flipped(&self) -> Self {
        let [a, b, c, d] = self.corners;
        let corners = if self.is_quad() { [a, d, c, b] } else { [a, c, b, NO_CORNER] };
        Self { corners, ..*self }
    }
}

/// Which sides of a face reflect and emit light. Occluders stop light from either side in every
/// case.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Sides {
    /// The side that the winding shows; both where a file's material says so and both are seen.
    #[default]
    Front,
    /// Both: each face becomes two opposite patches.
    Both,
    /// Each face is turned towards the space that sees it (rays decide).
    Auto,
}

/// A view: where the eye is, what it looks at and how wide.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct CameraPose {
    /// Eye position, in the scene's length unit.
    pub eye: Vec3,
    /// The point looked at.
    pub target: Vec3,
    /// Up direction; need not be normalised.
    pub up: Vec3,
    /// Horizontal field of view, degrees.
    pub hfov_deg: f32,
}

/// A view with a name.
#[derive(Clone, Debug, PartialEq)]
pub struct NamedCamera {
    /// Name as the file gives it.
    pub name: String,
    /// The view.
    pub pose: CameraPose,
}

/// A light of a file that is no surface there (KHR_lights_punctual).
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FileLight {
    /// Name of its emitter's material: the file's, with a number where that has others of the name.
    pub name: String,
    /// Material of its emitter.
    #[serde(skip)]
    pub material: MaterialId,
    /// Luminous intensity per colour, cd.
    pub candelas: Vec3,
    /// Where its light may end by the file, m; here it goes on, as light does.
    pub range: Option<f32>,
    /// Half angles of a spot light's cone, inner and outer, radians.
    pub cone: Option<[f32; 2]>,
}

/// Polygons with materials, groups and what loading had to say about them; the default lacks even
/// the root group.
#[derive(Clone, Debug, Default)]
pub struct Scene {
    /// Name shown to a person (file stem or the name of our own scene).
    pub name: String,
    /// Where the zero of the scene's coordinates lies in its file's: files of surveyed places lie
    /// far off.
    pub origin: DVec3,
    /// Positions, in the scene's length unit (metres where areas and watts are to be read).
    pub vertices: Vec<Vec3>,
    /// Faces; order is the file's.
    pub polygons: Vec<Polygon>,
    /// Details of single faces by the file.
    pub details: Arc<FaceDetails>,
    /// Materials; every polygon's index is valid.
    pub materials: Vec<Material>,
    /// Reflectance and emission of the first materials as the scene's file alone has them, without
    /// its sidecar; empty where no file is.
    pub filed_materials: Vec<Material>,
    /// Groups; a parent precedes its children, `groups[0]` is the root.
    pub groups: Vec<Group>,
    /// How a person arranged the groups by hand; empty where they are as the file has them.
    pub regrouping: Vec<GroupMember>,
    /// Luminaires among the polygons, which no scene file holds: [`Scene::set_luminaires`] makes
    /// them.
    pub placed_luminaires: Vec<PlacedLuminaire>,
    /// The view to open with, where the scene names one.
    pub camera: Option<CameraPose>,
    /// Further views that a person kept.
    pub bookmarks: Vec<CameraPose>,
    /// Where on the work plane a task is done, if a person said so.
    pub task_area: Option<TaskArea>,
    /// Views that the scene's file holds.
    pub cameras: Vec<NamedCamera>,
    /// Lights of the file that are no surfaces there; each is a small emitter here, of a material
    /// of its own.
    pub lights: Vec<FileLight>,
    /// Sky and sun, where the scene has them.
    pub outside: Option<Arc<Outside>>,
    /// How the scene's file was read.
    pub frame: Frame,
    /// Wishes of a person on how the file is to be read.
    pub reading: Reading,
    /// Which sides of its faces are bright; [`crate::geometry::orient::apply`] makes it so.
    pub sides: Sides,
    /// Edges, by their ends, that part what is shown on their sides: a wall stands on them
    /// ([`crate::geometry::cuts`]).
    pub cut_edges: Vec<[Vec3; 2]>,
    /// Counts of what loading skipped, clamped or ignored.
    pub skipped: Skipped,
}

impl Scene {
    /// An empty scene with a root group.
    pub fn new(name: impl Into<String>) -> Self {
        let name = name.into();
        Self { groups: vec![Group { name: name.clone(), parent: None }], name, ..Self::default() }
    }

    /// Memory of vertices, polygons and groups, bytes.
    pub fn bytes(&self) -> usize {
        let names = self.groups.iter().map(|group| group.name.len()).sum::<usize>();
        let lists = size_of_val(&self.vertices[..]) + size_of_val(&self.polygons[..]) + size_of_val(&self.groups[..]);
        lists + self.details.bytes() + names
    }

    /// Adds a material and returns its id.
    pub fn add_material(&mut self, name: &str, reflectance: Vec3, emission: Vec3) -> MaterialId {
        self.materials.push(Material { name: name.to_owned(), reflectance, emission, ..Material::default() });
        MaterialId(self.materials.len() as u32 - 1)
    }

    /// Adds a group below `parent` and returns its id.
    pub fn add_group(&mut self, name: &str, parent: GroupId) -> GroupId {
        self.groups.push(Group { name: name.to_owned(), parent: Some(parent) });
        GroupId(self.groups.len() as u32 - 1)
    }

    /// Adds a quad by its corner positions, anticlockwise as seen from the bright side; vertices
    /// are not shared.
    pub fn add_quad(&mut self, corners: [Vec3; 4], material: MaterialId, group: GroupId) {
        let first = self.vertices.len() as u32;
        self.vertices.extend(corners);
        self.polygons.push(Polygon::quad([first, first + 1, first + 2, first + 3], material, group));
    }

    /// Adds a triangle by its corner positions, anticlockwise as seen from the bright side;
    /// vertices are not shared.
    pub fn add_triangle(&mut self, corners: [Vec3; 3], material: MaterialId, group: GroupId) {
        let first = self.vertices.len() as u32;
        self.vertices.extend(corners);
        self.polygons.push(Polygon::triangle([first, first + 1, first + 2], material, group));
    }

    /// Corner positions of a polygon: three or four.
    pub fn corner_positions(&self, polygon: &Polygon) -> ([Vec3; 4], usize) {
        let mut positions = [Vec3::ZERO; 4];
        let corners = polygon.corners();
        for (position, &corner) in positions.iter_mut().zip(corners) {
            *position = self.vertices[corner as usize];
        }
        (positions, corners.len())
    }

    /// Area of a polygon, in the square of the length unit (a quad's as its two triangles').
    pub fn area(&self, polygon: &Polygon) -> f32 {
        let ([a, b, c, d], count) = self.corner_positions(polygon);
        let first = (b - a).cross(c - a).length();
        let second = if count == 4 { (c - a).cross(d - a).length() } else { 0.0 };
        0.5 * (first + second)
    }

    /// Unit normal of the bright side.
    pub fn normal(&self, polygon: &Polygon) -> Vec3 {
        let ([a, b, c, d], count) = self.corner_positions(polygon);
        let twice_area = if count == 4 { (c - a).cross(d - b) } else { (b - a).cross(c - a) };
        twice_area.normalize_or_zero()
    }

    /// Whether any face is bright on one side alone, so that something can lie inside of things.
    pub fn has_dark_sides(&self) -> bool {
        self.polygons.iter().any(|polygon| !polygon.is_back && !polygon.has_back)
    }

    /// Lower and upper corner of the box around all polygons; both zero for an empty scene.
    pub fn bounds(&self) -> (Vec3, Vec3) {
        let used = self.polygons.iter().flat_map(|polygon| polygon.corners());
        let (lower, upper) = used.fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(lower, upper), &corner| {
            let position = self.vertices[corner as usize];
            (lower.min(position), upper.max(position))
        });
        if lower.x <= upper.x { (lower, upper) } else { (Vec3::ZERO, Vec3::ZERO) }
    }

    /// Total emitted power Φ = Σ A·B_e per colour, W (for lengths in metres).
    pub fn emitted_power(&self) -> Vec3 {
        let power = |polygon: &Polygon| {
            let emission = self.surface(polygon).emission;
            // Most polygons emit nothing, and nobody need know their area for that.
            (emission != Vec3::ZERO).then(|| self.area(polygon) * emission)
        };
        self.polygons.iter().filter_map(power).sum()
    }

    /// The group's path from the root, levels joined by `/`, without the root's own name.
    pub fn group_path(&self, group: GroupId) -> String {
        group_names(&self.groups, group).join("/")
    }

    /// The material with this name.
    pub fn material_named(&self, name: &str) -> Option<MaterialId> {
        self.materials.iter().position(|material| material.name == name).map(|index| MaterialId(index as u32))
    }
}

/// Names of all groups that hold one of some groups, and its own, without the root's.
fn group_names(groups: &[Group], group: GroupId) -> Vec<&str> {
    let upwards = std::iter::successors(Some(group), |at| groups[at.0 as usize].parent);
    let mut names: Vec<&str> = upwards.filter(|at| at.0 > 0).map(|at| groups[at.0 as usize].name.as_str()).collect();
    names.reverse();
    names
}

/// Vertices with bit-equal positions made one, and the new index of each old one.
pub(crate) fn weld(positions: &[Vec3]) -> (Vec<Vec3>, Vec<u32>) {
    let mut index_of = FxHashMap::with_capacity_and_hasher(positions.len(), Default::default());
    let mut vertices = Vec::with_capacity(positions.len());
    let welded = positions.iter().map(|&position| {
        // Adding zero makes −0 and 0 the same key.
        *index_of.entry((position + Vec3::ZERO).to_array().map(f32::to_bits)).or_insert_with(|| {
            vertices.push(position);
            vertices.len() as u32 - 1
        })
    });
    let welded = welded.collect();
    (vertices, welded)
}
