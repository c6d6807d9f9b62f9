//! A scene as a reader found it, before anything is checked: what OBJ and glTF have in common.

use std::collections::HashMap;
use std::ops::Range;

use glam::{DVec3, Vec2, Vec3};

use super::face::CornerDetail;
use super::place::{FiledCamera, Reach, is_usable};
use super::punctual::{DirectionalLight, PunctualLight};
use super::texture::{Opacity, TextureMap};
use super::unit::Unit;
use super::up::UpAxis;
use super::{Group, GroupId, Skipped, sanitize};

/// More polygons than this are refused: they would take tens of gigabytes to light.
pub(super) const MOST_POLYGONS: usize = 32_000_000;

/// Groups nested deeper than this belong to the one at this depth. A sidecar that arranges them is
/// then nested less deeply than its parser allows (128 brackets, two for each group).
const MOST_LEVELS: u8 = 48;

/// The material of faces that name none.
pub(super) const NO_MATERIAL: &str = "(no material)";

/// Reflectance of faces whose material nobody defines.
pub(super) const GREY: Vec3 = Vec3::splat(0.5);

/// A material as the file has it; nothing is clamped yet.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct DraftMaterial {
    pub name: String,
    /// Reflectance, or what its texture is multiplied with.
    pub reflectance: Vec3,
    /// Alpha, or what its texture's is multiplied with.
    pub alpha: f32,
    /// Exitance, W/m², or what its texture is multiplied with.
    pub emission: Vec3,
    pub reflectance_map: Option<TextureMap>,
    pub emission_map: Option<TextureMap>,
    /// Alpha is multiplied with this texture's too.
    pub opacity_map: Option<TextureMap>,
    pub opacity: Opacity,
    /// It lets light through whatever its alpha is (transmission).
    pub transmits: bool,
    /// Whether faces of the material are bright on both sides.
    pub is_two_sided: bool,
    /// Whether its emission is laid on by [`Draft::emission_uvs`].
    pub has_emission_uvs: bool,
    /// False for the grey that stands in for a material that the file does not define.
    pub defined: bool,
}

impl DraftMaterial {
    /// Black, opaque, bright in front.
    pub fn new(name: &str) -> Self {
        Self { name: name.to_owned(), alpha: 1.0, defined: true, ..Self::default() }
    }

    /// The grey that stands in for a material that the file does not define.
    pub fn undefined(name: &str) -> Self {
        Self { reflectance: GREY, defined: false, ..Self::new(name) }
    }
}

/// A run of corners in [`Draft::corners`].
pub(super) struct DraftFace {
    first: u32,
    /// Number of corners, at least 3.
    count: u32,
    /// Index into [`Draft::materials`].
    pub material: u32,
    pub group: GroupId,
}

impl DraftFace {
    /// Places of the face's corners in [`Draft::corners`] and what goes with them.
    pub fn corners(&self) -> Range<usize> {
        let first = self.first as usize;
        first..first + self.count as usize
    }
}

/// Scene as a reader hands it on.
#[derive(Default)]
pub(super) struct Draft {
    /// Positions in the file's coordinates.
    pub vertices: Vec<DVec3>,
    /// Vertex indices (all valid) of one face after the other.
    pub corners: Vec<u32>,
    /// Texture coordinates of each corner, NaN where a face has none; shorter where the last faces
    /// have none.
    pub uvs: Vec<Vec2>,
    /// Texture coordinates of each corner for emission alone, likewise, where its material has
    /// such.
    pub emission_uvs: Vec<Vec2>,
    /// Normals of each corner, likewise.
    pub normals: Vec<Option<[i16; 2]>>,
    /// Colours of each corner, likewise.
    pub colours: Vec<Option<[u16; 4]>>,
    pub faces: Vec<DraftFace>,
    pub materials: Vec<DraftMaterial>,
    /// Names that the file defines but no face uses; a sidecar may speak of them.
    pub unused_materials: Vec<String>,
    pub groups: Vec<Group>,
    /// Views that the file holds, with their names.
    pub cameras: Vec<(String, FiledCamera)>,
    /// Lights that are no surfaces.
    pub lights: Vec<PunctualLight>,
    /// Directional lights, the first of the brightest ones first.
    pub suns: Vec<DirectionalLight>,
    /// The length unit, where the file tells it.
    pub unit: Option<Unit>,
    /// The axis that points up in files of the format, where it prescribes one.
    pub prescribed_up: Option<UpAxis>,
    pub skipped: Skipped,
    /// How deep each group lies below the root.
    levels: Vec<u8>,
    /// Groups that are not, because they would lie deeper than [`MOST_LEVELS`].
    pub too_deep: usize,
    children: HashMap<(GroupId, String), GroupId>,
}

impl Draft {
    /// Nothing but a root group.
    pub fn new(name: &str) -> Self {
        Self { groups: vec![Group { name: sanitize::name(name), parent: None }], levels: vec![0], ..Self::default() }
    }

    /// A new group below `parent`, whether or not it has a sibling of the same name; `parent`
    /// itself where that lies too deep.
    pub fn add_group(&mut self, name: &str, parent: GroupId) -> GroupId {
        let level = self.levels[parent.0 as usize];
        if level >= MOST_LEVELS {
            self.too_deep += 1;
            return parent;
        }
        self.levels.push(level + 1);
        self.groups.push(Group { name: sanitize::name(name), parent: Some(parent) });
        GroupId(self.groups.len() as u32 - 1)
    }

    /// The group with a `/`-separated path, made with its parents where it is not there yet.
    pub fn group_at(&mut self, path: &str) -> GroupId {
        let levels = path.split('/').map(str::trim).filter(|level| !level.is_empty());
        levels.fold(GroupId(0), |parent, level| {
            if self.levels[parent.0 as usize] >= MOST_LEVELS {
                self.too_deep += 1;
                return parent;
            }
            let key = (parent, level.to_owned());
            if let Some(&group) = self.children.get(&key) {
                return group;
            }
            let group = self.add_group(level, parent);
            self.children.insert(key, group);
            group
        })
    }

    /// Adds a face over vertex indices.
    pub fn add_face(&mut self, corners: &[u32], material: u32, group: GroupId) {
        self.add_face_of(corners.iter().copied(), material, group);
    }

    /// Adds a face over vertex indices.
    pub fn add_face_of(&mut self, corners: impl Iterator<Item = u32>, material: u32, group: GroupId) {
        let before = self.corners.len();
        self.corners.extend(corners);
        let count = (self.corners.len() - before) as u32;
        self.faces.push(DraftFace { first: before as u32, count, material, group });
    }

    /// Texture coordinates of the face that was added last, one for each corner.
    pub fn add_uvs(&mut self, uvs: impl IntoIterator<Item = Vec2>) {
        add_to(&mut self.uvs, self.faces.last(), uvs, Vec2::NAN);
    }

    /// Texture coordinates for emission alone of the face that was added last, one for each corner.
    pub fn add_emission_uvs(&mut self, uvs: impl IntoIterator<Item = Vec2>) {
        add_to(&mut self.emission_uvs, self.faces.last(), uvs, Vec2::NAN);
    }

    /// Normals of the face that was added last, one for each corner.
    pub fn add_normals(&mut self, normals: impl IntoIterator<Item = Option<[i16; 2]>>) {
        add_to(&mut self.normals, self.faces.last(), normals, None);
    }

    /// Colours of the face that was added last, one for each corner.
    pub fn add_colours(&mut self, colours: impl IntoIterator<Item = Option<[u16; 4]>>) {
        add_to(&mut self.colours, self.faces.last(), colours, None);
    }

    /// Lower and upper end of what faces use; infinite where there are none.
    pub fn bounds(&self) -> (DVec3, DVec3) {
        let used = self.corners.iter().map(|&corner| self.vertices[corner as usize]);
        let none = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        used.fold(none, |(lower, upper), vertex| (lower.min(vertex), upper.max(vertex)))
    }

    /// A vertex that faces use and that is not finite, or lies too far from the others.
    pub fn unusable_vertex(&self) -> Option<u32> {
        let mut reach = Reach::new();
        for &corner in &self.corners {
            let vertex = self.vertices[corner as usize];
            if !is_usable(vertex) {
                return Some(corner);
            }
            reach.add(vertex, corner);
        }
        reach.too_far()
    }

    /// Details of a corner beside its vertex.
    pub fn detail(&self, corner: usize) -> CornerDetail {
        CornerDetail {
            uv: self.uvs.get(corner).copied().filter(|uv| !uv.is_nan()),
            normal: self.normals.get(corner).copied().flatten(),
            colour: self.colours.get(corner).copied().flatten(),
        }
    }
}

/// Appends what the last face has at its corners; faces before it without are made up for.
fn add_to<T: Clone>(list: &mut Vec<T>, last: Option<&DraftFace>, values: impl IntoIterator<Item = T>, absent: T) {
    let Range { start, end } = last.map(DraftFace::corners).unwrap_or_default();
    list.resize(start, absent.clone());
    list.extend(values);
    list.resize(end, absent);
}
