//! Groups made by hand over the objects of a scene: the paper's hand-made clusters (section 2.2).
//!
//! The scene's own groups stay as they are, for they name its polygons. What a person makes of them
//! is a list of [`GroupMember`]s, which a sidecar holds as `groups` and [`Scene::group_tree`] turns
//! into a tree:
//!
//! ```json
//! [ { "work places": ["desk_1", "desk_2"] },
//!   { "lamps": ["ceiling/lamp", { "desk lamps": ["desk_1/lamp", "desk_2/lamp"] }] },
//!   { "bookshelf": ["bookshelf/*", "plant"] },
//!   "carpet/*" ]
//! ```
//!
//! An object is named by its path in the scene's file and brings all that the file has in it,
//! except for what the list names elsewhere. With `/*` behind its path it brings what is in it, but
//! not itself: the bookshelf above is the file's own with a plant in it, and the group of the
//! carpet is dissolved. What the list does not name stays where the file has it.

use std::collections::HashMap;
use std::sync::Arc;

use rustc_hash::FxHashMap;
use serde::de::Error;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use super::{Group, GroupId, Scene, group_names, sanitize};

/// Behind the path of an object: what is in it, without itself.
pub(super) const CONTENTS: &str = "/*";

/// One member of a group made by hand.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum GroupMember {
    /// An object of the scene's file by its path; `/*` behind it stands for what is in it.
    Object(String),
    /// A group and its members.
    Group(String, Vec<GroupMember>),
}

impl Serialize for GroupMember {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self {
            Self::Object(path) => serializer.serialize_str(path),
            Self::Group(name, members) => serializer.collect_map([(name, members)]),
        }
    }
}

impl<'de> Deserialize<'de> for GroupMember {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        match serde_json::Value::deserialize(deserializer)? {
            serde_json::Value::String(path) => Ok(Self::Object(path)),
            serde_json::Value::Object(map) if map.len() == 1 => {
                let (name, members) = map.into_iter().next().unwrap_or_default();
                let members = serde_json::from_value(members).map_err(D::Error::custom)?;
                Ok(Self::Group(name, members))
            }
            _ => Err(D::Error::custom("a member of `groups` is the path of an object, or {\"name\": [members]}")),
        }
    }
}

/// The tree of a scene's groups, as its file has it or as a person made it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct GroupTree {
    /// Groups of the tree; a parent precedes its children, the first is the root.
    pub(super) groups: Vec<Group>,
    /// Of each of the scene's own groups, the group of the tree that holds what is directly in it.
    pub(super) homes: Vec<GroupId>,
}

impl Scene {
    /// The tree that `groups` clusters by: the scene's own groups, as [`Scene::regrouping`]
    /// arranges them.
    pub fn group_tree(&self) -> GroupTree {
        GroupTree::arranged(&self.groups, &self.regrouping).0
    }

    /// The scene as if its file had its groups as they are arranged; the scene itself where nobody
    /// arranged them.
    pub fn as_arranged(self: &Arc<Self>) -> Arc<Self> {
        if self.regrouping.is_empty() {
            return self.clone();
        }
        let tree = self.group_tree();
        let mut scene = (**self).clone();
        for polygon in &mut scene.polygons {
            polygon.group = tree.home(polygon.group);
        }
        (scene.groups, scene.regrouping) = (tree.groups, Vec::new());
        Arc::new(scene)
    }

    /// Arranges the groups by hand; returns a sentence for each member that the scene does not have
    /// or that is named twice.
    pub fn regroup(&mut self, members: Vec<GroupMember>) -> Vec<String> {
        let (_, remarks) = GroupTree::arranged(&self.groups, &members);
        self.regrouping = members;
        remarks
    }
}

/// How a member names one of the scene's own groups, and where it puts it.
#[derive(Clone, Copy)]
struct Named {
    into: GroupId,
    with_itself: bool,
}

impl GroupTree {
    /// The scene's own groups as a list arranges them, and a sentence for each member that cannot
    /// be followed.
    pub fn arranged(own: &[Group], members: &[GroupMember]) -> (Self, Vec<String>) {
        let mut tree = Self { groups: vec![Group { parent: None, ..own[0].clone() }], homes: Vec::new() };
        let addresses = addresses(own);
        let by_address: FxHashMap<&str, usize> =
            addresses.iter().enumerate().skip(1).map(|(index, address)| (address.as_str(), index)).collect();
        let mut named: Vec<Option<Named>> = vec![None; own.len()];
        let mut remarks = Vec::new();
        tree.add_members(members, GroupId(0), &by_address, &mut named, &mut remarks);
        tree.homes.push(GroupId(0));
        for (index, group) in own.iter().enumerate().skip(1) {
            let around = group.parent.map_or(GroupId(0), |parent| tree.homes[parent.0 as usize]);
            let home = match named[index] {
                Some(Named { into, with_itself: false }) => into,
                Some(Named { into, with_itself: true }) => tree.add(&group.name, into),
                None => tree.add(&group.name, around),
            };
            tree.homes.push(home);
        }
        (tree.in_order().0, remarks)
    }

    fn add(&mut self, name: &str, parent: GroupId) -> GroupId {
        self.groups.push(Group { name: name.to_owned(), parent: Some(parent) });
        GroupId(self.groups.len() as u32 - 1)
    }

    fn add_members(
        &mut self,
        members: &[GroupMember],
        into: GroupId,
        by_address: &FxHashMap<&str, usize>,
        named: &mut [Option<Named>],
        remarks: &mut Vec<String>,
    ) {
        for member in members {
            match member {
                GroupMember::Group(name, members) => {
                    let group = self.add(&sanitize::name(name), into);
                    self.add_members(members, group, by_address, named, remarks);
                }
                GroupMember::Object(path) => {
                    let address = path.strip_suffix(CONTENTS).unwrap_or(path);
                    let with_itself = address.len() == path.len();
                    match by_address.get(address).map(|&index| &mut named[index]) {
                        Some(place @ None) => *place = Some(Named { into, with_itself }),
                        Some(Some(_)) => remarks.push(format!(
                            "The settings file's groups name the object {} twice: its first place counts.",
                            sanitize::quoted(address)
                        )),
                        None => remarks.push(format!(
                            "The settings file's groups name an object {} that the scene does not have.",
                            sanitize::quoted(address)
                        )),
                    }
                }
            }
        }
    }

    /// The tree with its groups in the order of the scene's own that they hold, empty ones last:
    /// equal trees are laid out alike, however they came about. Beside it the new place of each
    /// group.
    pub(super) fn in_order(self) -> (Self, Vec<GroupId>) {
        let count = self.groups.len();
        let mut first = vec![u32::MAX; count];
        for (own, home) in self.homes.iter().enumerate() {
            let first = &mut first[home.0 as usize];
            *first = (*first).min(own as u32);
        }
        let children = self.children();
        // Parents may follow their children here, so depths are walked from the root.
        let mut visited = vec![0_u32];
        let mut next = 0;
        while next < visited.len() {
            visited.extend(children[visited[next] as usize].iter().map(|child| child.0));
            next += 1;
        }
        for &group in visited.iter().rev() {
            if let Some(parent) = self.groups[group as usize].parent {
                first[parent.0 as usize] = first[parent.0 as usize].min(first[group as usize]);
            }
        }
        let mut ordered = Self { groups: Vec::with_capacity(count), homes: Vec::new() };
        let mut new_index = vec![GroupId(0); count];
        let mut waiting = vec![0_u32];
        while let Some(group) = waiting.pop() {
            let Group { name, parent } = &self.groups[group as usize];
            new_index[group as usize] = GroupId(ordered.groups.len() as u32);
            let parent = parent.map(|parent| new_index[parent.0 as usize]);
            ordered.groups.push(Group { name: name.clone(), parent });
            let mut below: Vec<u32> = children[group as usize].iter().map(|child| child.0).collect();
            below.sort_by(|&a, &b| {
                let key = |group: u32| (first[group as usize], &self.groups[group as usize].name, group);
                key(b).cmp(&key(a))
            });
            waiting.extend(below);
        }
        ordered.homes = self.homes.iter().map(|home| new_index[home.0 as usize]).collect();
        (ordered, new_index)
    }

    /// The groups; a parent precedes its children, the first is the root.
    pub fn groups(&self) -> &[Group] {
        &self.groups
    }

    /// The group of the tree that holds what is directly in one of the scene's own.
    pub fn home(&self, own: GroupId) -> GroupId {
        self.homes.get(own.0 as usize).copied().unwrap_or(GroupId(0))
    }

    /// This group and all that hold it, upwards.
    pub fn upwards(&self, group: GroupId) -> impl Iterator<Item = GroupId> {
        std::iter::successors(Some(group), |&at| self.groups[at.0 as usize].parent)
    }

    /// The group's path from the root, levels joined by `/`, without the root's own name.
    pub fn path(&self, group: GroupId) -> String {
        group_names(&self.groups, group).join("/")
    }

    /// Sums over each group with all that is in it of what the scene's own groups hold directly.
    pub fn sums<T: Copy + Default + std::ops::AddAssign>(&self, held: impl Iterator<Item = (GroupId, T)>) -> Vec<T> {
        let mut sums = vec![T::default(); self.groups.len()];
        for (own, amount) in held {
            sums[self.home(own).0 as usize] += amount;
        }
        for (index, group) in self.groups.iter().enumerate().rev() {
            if let Some(parent) = group.parent {
                let amount = sums[index];
                sums[parent.0 as usize] += amount;
            }
        }
        sums
    }

    /// The groups in each group.
    pub fn children(&self) -> Vec<Vec<GroupId>> {
        let mut children = vec![Vec::new(); self.groups.len()];
        for (index, group) in self.groups.iter().enumerate() {
            if let Some(parent) = group.parent {
                children[parent.0 as usize].push(GroupId(index as u32));
            }
        }
        children
    }

    /// A path for each group that no other has: names from the root joined by `/`, numbered where
    /// they are not unique.
    pub fn addresses(&self) -> Vec<String> {
        addresses(&self.groups)
    }
}

/// The longest address of a group, bytes: a file can hold a million groups below long names.
const LONGEST_ADDRESS: usize = 1000;

/// A path for each group that no other has. A slash in a name is none between levels; of a long
/// path the last part is shown.
pub(super) fn addresses(groups: &[Group]) -> Vec<String> {
    // How often a path was asked for; numbered ones count as well.
    let mut asked: HashMap<String, u32> = HashMap::new();
    let mut addresses: Vec<String> = Vec::with_capacity(groups.len());
    for group in groups {
        let name = group.name.replace('/', "_");
        let path = match group.parent {
            None => String::new(),
            Some(GroupId(0)) => shortened(name),
            Some(parent) => shortened(format!("{}/{name}", addresses[parent.0 as usize])),
        };
        let mut address = path.clone();
        while asked.contains_key(&address) {
            let uses = asked.entry(path.clone()).or_default();
            *uses += 1;
            address = format!("{path} #{uses}");
        }
        asked.insert(address.clone(), 1);
        addresses.push(address);
    }
    addresses
}

/// The end of a path that is too long.
fn shortened(path: String) -> String {
    if path.len() <= LONGEST_ADDRESS {
        return path;
    }
    let end = path.char_indices().map(|(at, _)| at).find(|at| path.len() - at <= LONGEST_ADDRESS / 2);
    format!("…{}", &path[end.unwrap_or(0)..])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn own() -> Vec<Group> {
        let mut scene = Scene::new("room");
        let walls = scene.add_group("walls", GroupId(0));
        scene.add_group("floor", walls);
        let desk = scene.add_group("desk", GroupId(0));
        scene.add_group("lamp", desk);
        scene.add_group("top", desk);
        let chair = scene.add_group("chair", GroupId(0));
        scene.add_group("leg", chair);
        scene.add_group("leg", chair);
        scene.groups
    }

    fn read(json: &str) -> (GroupTree, Vec<String>) {
        let members: Vec<GroupMember> = serde_json::from_str(json).expect("it is a list of members");
        GroupTree::arranged(&own(), &members)
    }

    /// Truth: worked out by hand from what the module says.
    #[test]
    fn lists_arrange_groups_and_what_they_do_not_name_stays() {
        let (tree, remarks) = read(r#"[{"lamps": ["desk/lamp"]}, {"desk": ["desk/*", "chair/leg #2"]}, "walls/*"]"#);
        assert_eq!(remarks, [""; 0]);
        let addresses = tree.addresses();
        assert_eq!(
            addresses,
            ["", "floor", "desk", "desk/top", "desk/leg", "lamps", "lamps/lamp", "chair", "chair/leg"]
        );
        let home = |own: u32| addresses[tree.home(GroupId(own)).0 as usize].as_str();
        let homes: Vec<&str> = (0..9).map(home).collect();
        assert_eq!(homes, ["", "", "floor", "desk", "lamps/lamp", "desk/top", "chair", "chair/leg", "desk/leg"]);
    }

    #[test]
    fn paths_are_of_names_and_sums_of_all_that_is_in_a_group() {
        let tree = read("[]").0;
        let at = |address: &str| {
            GroupId(tree.addresses().iter().position(|other| other == address).expect("it is there") as u32)
        };
        assert_eq!(tree.path(at("chair/leg #2")), "chair/leg");
        assert_eq!(tree.sums([(at("desk/lamp"), 2), (at("desk"), 3), (at("walls"), 1)].into_iter())[..3], [6, 1, 0]);
    }

    #[test]
    fn unknown_objects_and_those_named_twice_are_told_and_the_rest_counts() {
        let (tree, remarks) = read(r#"[{"a": ["desk", "table"]}, {"b": ["desk"]}]"#);
        assert_eq!(remarks.len(), 2);
        assert!(remarks[0].contains("`table`") && remarks[1].contains("`desk` twice"), "{remarks:?}");
        assert!(tree.addresses().contains(&"a/desk/lamp".to_owned()));
    }

    /// Truth: the tree itself. Lists are as short as they can be where nothing or one thing was
    /// moved.
    #[test]
    fn what_is_written_is_read_as_the_same_tree() {
        let own = own();
        let lists = [
            "[]",
            r#"[{"lamps":["desk/lamp"]}]"#,
            r#"["walls/*"]"#,
            r#"[{"desk":["desk/*","chair"]}]"#,
            r#"[{"desk":["desk/*",{"lamp":["desk/lamp/*","chair/leg #2"]}]}]"#,
            r#"[{"table":["desk/*"]},{"empty":[]}]"#,
            r#"["chair/leg",{"all":["walls","desk/*","chair"]}]"#,
        ];
        for list in lists {
            let (tree, remarks) = read(list);
            assert_eq!(remarks, [""; 0], "{list}");
            let members = tree.members(&own);
            let (again, _) = GroupTree::arranged(&own, &members);
            assert_eq!(again, tree, "{list} became {members:?}");
        }
        for list in &lists[..4] {
            assert_eq!(serde_json::to_string(&read(list).0.members(&own)).expect("it is JSON"), *list);
        }
    }

    #[test]
    fn the_file_s_own_tree_is_the_same_however_it_is_told() {
        let plain = read("[]").0;
        assert_eq!(plain.groups(), own());
        let listed =
            read(r#"[{"chair": ["chair/leg #2", "chair/*"]}, "desk", {"walls": ["walls/*", "walls/floor"]}]"#).0;
        assert_eq!(listed, plain);
    }

    #[test]
    fn what_is_no_list_of_members_is_refused() {
        for bad in ["[3]", "[null]", r#"[{"a": "b"}]"#, r#"[{"a": ["x"], "b": []}]"#, r#"[["a"]]"#, "{}"] {
            assert!(serde_json::from_str::<Vec<GroupMember>>(bad).is_err(), "{bad}");
        }
    }
}
