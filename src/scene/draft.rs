//! A scene as a reader found it, before anything is checked: what OBJ and glTF have in common.

use std::collections::HashMap;
use std::path::Path;

use glam::{DVec3, Vec3};

use super::{Group, GroupId, Skipped, said};

/// More polygons than this are refused: they would take tens of gigabytes to light.
pub(super) const MOST_POLYGONS: usize = 32_000_000;

/// The name shown to a person.
pub(super) fn scene_name(path: &Path) -> String {
    path.file_stem().map_or_else(|| "scene".to_owned(), |stem| stem.to_string_lossy().into_owned())
}

/// Groups nested deeper than this belong to the one at this depth. A sidecar that arranges them is then nested less deeply than its
/// parser allows (128 brackets, two for each group).
const MOST_LEVELS: u8 = 48;

/// Reflectance of faces whose material nobody defines.
pub(super) const GREY: Vec3 = Vec3::splat(0.5);

/// A material as the file has it; nothing is clamped yet.
pub(super) struct DraftMaterial {
    pub name: String,
    pub reflectance: Vec3,
    /// Exitance, W/m².
    pub emission: Vec3,
    /// A pane: dissolve under a half, transmission or alpha BLEND.
    pub transparent: bool,
    /// False for the grey that stands in for a material that the file does not define.
    pub defined: bool,
}

impl DraftMaterial {
    /// The grey that stands in for a material that the file does not define.
    pub fn undefined(name: &str) -> Self {
        let name = name.to_owned();
        Self { name, reflectance: GREY, emission: Vec3::ZERO, transparent: false, defined: false }
    }
}

/// A run of corners in [`Draft::corners`].
pub(super) struct DraftFace {
    /// Number of corners, at least 3.
    pub count: u32,
    /// Index into [`Draft::materials`].
    pub material: u32,
    pub group: GroupId,
}

/// What a reader hands on.
pub(super) struct Draft {
    /// Positions in the file's coordinates.
    pub vertices: Vec<DVec3>,
    /// Vertex indices (all valid) of one face after the other.
    pub corners: Vec<u32>,
    pub faces: Vec<DraftFace>,
    pub materials: Vec<DraftMaterial>,
    /// Names that the file defines but no face uses; a sidecar may speak of them.
    pub unused_materials: Vec<String>,
    pub groups: Vec<Group>,
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
        Self {
            vertices: Vec::new(),
            corners: Vec::new(),
            faces: Vec::new(),
            materials: Vec::new(),
            unused_materials: Vec::new(),
            groups: vec![Group { name: said::name(name), parent: None }],
            skipped: Skipped::default(),
            levels: vec![0],
            too_deep: 0,
            children: HashMap::new(),
        }
    }

    /// A new group below `parent`, whether or not it has a sibling of the same name; `parent` itself where that lies too deep.
    pub fn add_group(&mut self, name: &str, parent: GroupId) -> GroupId {
        let level = self.levels[parent.0 as usize];
        if level >= MOST_LEVELS {
            self.too_deep += 1;
            return parent;
        }
        self.levels.push(level + 1);
        self.groups.push(Group { name: said::name(name), parent: Some(parent) });
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

    /// Adds a face over valid vertex indices.
    pub fn add_face(&mut self, corners: &[u32], material: u32, group: GroupId) {
        self.corners.extend_from_slice(corners);
        self.faces.push(DraftFace { count: corners.len() as u32, material, group });
    }
}
