//! Editing a tree of groups by hand: move, make, rename, dissolve. Each edit gives a new tree and
//! leaves the old one, for undo.

use super::regroup::GroupTree;
use super::{Group, GroupId};

/// An edit that cannot be made.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum RegroupError {
    /// Nothing is selected, or nothing but the scene itself.
    #[error("no group is selected: choose one other than the scene itself")]
    Nothing,
    /// A group cannot hold itself.
    #[error("`{name}` cannot go into a group that lies in it: choose a group outside of it")]
    IntoItself {
        /// The group that was to be moved.
        name: String,
    },
    /// A group must be called something.
    #[error("a group needs a name: type one")]
    NoName,
    /// The scene as a whole is no group to be edited.
    #[error("the scene itself is the root of all groups and stays: choose a group in it")]
    Root,
}

/// A tree after an edit.
#[derive(Clone, Debug)]
pub struct Regrouped {
    /// The new tree.
    pub tree: GroupTree,
    /// Where each group of the former tree is in it, a dissolved one by what it was dissolved into.
    pub places: Vec<GroupId>,
    /// The group that was made or changed, in the new tree.
    pub group: GroupId,
}

impl GroupTree {
    fn parent(&self, group: GroupId) -> Option<GroupId> {
        self.groups[group.0 as usize].parent
    }

    /// Those of some groups that lie in no other of them; never the root.
    fn topmost(&self, groups: &[GroupId]) -> Result<Vec<GroupId>, RegroupError> {
        let is_inside =
            |group: GroupId| self.upwards(group).skip(1).any(|around| groups.contains(&around) && around.0 > 0);
        let mut topmost: Vec<_> = groups.iter().copied().filter(|group| group.0 > 0 && !is_inside(*group)).collect();
        topmost.sort_unstable();
        topmost.dedup();
        if topmost.is_empty() { Err(RegroupError::Nothing) } else { Ok(topmost) }
    }

    fn finish(self, group: GroupId) -> Regrouped {
        let (tree, places) = self.in_order();
        let group = places[group.0 as usize];
        Regrouped { tree, places, group }
    }

    /// Moves groups with all that is in them into another one.
    ///
    /// # Errors
    /// Nothing to move, or a group into itself.
    pub fn moved(&self, groups: &[GroupId], into: GroupId) -> Result<Regrouped, RegroupError> {
        let moving = self.topmost(groups)?;
        if let Some(around) = self.upwards(into).find(|around| moving.contains(around)) {
            return Err(RegroupError::IntoItself { name: self.groups[around.0 as usize].name.clone() });
        }
        let mut tree = self.clone();
        for group in moving {
            tree.groups[group.0 as usize].parent = Some(into);
        }
        Ok(tree.finish(into))
    }

    /// Moves groups out of the group that holds them, to stand beside it.
    ///
    /// # Errors
    /// Nothing to move.
    pub fn moved_out(&self, groups: &[GroupId]) -> Result<Regrouped, RegroupError> {
        let mut tree = self.clone();
        let mut last = GroupId(0);
        for group in self.topmost(groups)? {
            let around = self.parent(group).and_then(|parent| self.parent(parent));
            tree.groups[group.0 as usize].parent = Some(around.unwrap_or(GroupId(0)));
            last = group;
        }
        Ok(tree.finish(last))
    }

    /// Makes a group of some groups, in the group that holds all of them.
    ///
    /// # Errors
    /// Nothing to group, or no name.
    pub fn grouped(&self, groups: &[GroupId], name: &str) -> Result<Regrouped, RegroupError> {
        let name = checked(name)?;
        let members = self.topmost(groups)?;
        let holds_all =
            |around: &GroupId| members.iter().all(|&member| self.upwards(member).skip(1).any(|at| at == *around));
        let parent = self.upwards(members[0]).skip(1).find(holds_all).unwrap_or(GroupId(0));
        let mut tree = self.clone();
        let made = GroupId(tree.groups.len() as u32);
        tree.groups.push(Group { name, parent: Some(parent) });
        for member in members {
            tree.groups[member.0 as usize].parent = Some(made);
        }
        Ok(tree.finish(made))
    }

    /// Gives a group another name.
    ///
    /// # Errors
    /// The root, or no name.
    pub fn renamed(&self, group: GroupId, name: &str) -> Result<Regrouped, RegroupError> {
        let name = checked(name)?;
        if group.0 == 0 {
            return Err(RegroupError::Root);
        }
        let mut tree = self.clone();
        tree.groups[group.0 as usize].name = name;
        Ok(tree.finish(group))
    }

    /// Dissolves groups: what is in them goes into what holds them.
    ///
    /// # Errors
    /// Nothing to dissolve.
    pub fn dissolved(&self, groups: &[GroupId]) -> Result<Regrouped, RegroupError> {
        let gone: Vec<GroupId> = groups.iter().copied().filter(|group| group.0 > 0).collect();
        let Some(&first) = gone.first() else { return Err(RegroupError::Nothing) };
        let stays = |group: GroupId| self.upwards(group).find(|at| !gone.contains(at)).unwrap_or(GroupId(0));
        let mut places = Vec::with_capacity(self.groups.len());
        let mut tree = Self { groups: Vec::new(), homes: Vec::new() };
        // Parents precede their children, so what a group goes into has its place already.
        for (index, group) in self.groups.iter().enumerate() {
            let group_id = GroupId(index as u32);
            if gone.contains(&group_id) {
                places.push(places[stays(group_id).0 as usize]);
                continue;
            }
            places.push(GroupId(tree.groups.len() as u32));
            let parent = group.parent.map(|parent| places[stays(parent).0 as usize]);
            tree.groups.push(Group { name: group.name.clone(), parent });
        }
        tree.homes = self.homes.iter().map(|home| places[home.0 as usize]).collect();
        let (tree, ordered) = tree.in_order();
        let places: Vec<GroupId> = places.into_iter().map(|place: GroupId| ordered[place.0 as usize]).collect();
        Ok(Regrouped { group: places[first.0 as usize], tree, places })
    }
}

fn checked(name: &str) -> Result<String, RegroupError> {
    let name = name.trim();
    if name.is_empty() { Err(RegroupError::NoName) } else { Ok(name.to_owned()) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Scene;

    fn tree() -> (Vec<Group>, GroupTree) {
        let mut scene = Scene::new("room");
        let desk = scene.add_group("desk", GroupId(0));
        scene.add_group("lamp", desk);
        let shelf = scene.add_group("shelf", GroupId(0));
        let board = scene.add_group("board", shelf);
        scene.add_group("book", board);
        (scene.groups.clone(), scene.group_tree())
    }

    fn at(tree: &GroupTree, address: &str) -> GroupId {
        let index = tree.addresses().iter().position(|other| other == address);
        GroupId(index.unwrap_or_else(|| panic!("there is a group {address}")) as u32)
    }

    /// Truth: worked out by hand; and each tree can be given by a list.
    #[test]
    fn groups_are_moved_made_renamed_and_dissolved() {
        let (own, tree) = tree();
        let check = |edited: &Regrouped, expected: &[&str]| {
            assert_eq!(edited.tree.addresses(), expected);
            let members = edited.tree.members(&own);
            assert_eq!(GroupTree::arranged(&own, &members).0, edited.tree, "{members:?}");
        };
        let moved =
            tree.moved(&[at(&tree, "shelf/board"), at(&tree, "shelf/board/book")], at(&tree, "desk")).expect("it can");
        check(&moved, &["", "desk", "desk/lamp", "desk/board", "desk/board/book", "shelf"]);
        let out = tree.moved_out(&[at(&tree, "shelf/board/book")]).expect("it can");
        check(&out, &["", "desk", "desk/lamp", "shelf", "shelf/board", "shelf/book"]);
        let made = tree.grouped(&[at(&tree, "shelf/board"), at(&tree, "desk/lamp")], " things ").expect("it can");
        check(&made, &["", "desk", "things", "things/lamp", "things/board", "things/board/book", "shelf"]);
        assert_eq!(made.group, at(&made.tree, "things"));
        assert_eq!(made.places[at(&tree, "desk/lamp").0 as usize], at(&made.tree, "things/lamp"));
        let within = tree.grouped(&[at(&tree, "shelf/board/book")], "books").expect("it can");
        check(
            &within,
            &["", "desk", "desk/lamp", "shelf", "shelf/board", "shelf/board/books", "shelf/board/books/book"],
        );
        let renamed = made.tree.renamed(at(&made.tree, "desk"), "table").expect("it can");
        check(&renamed, &["", "table", "things", "things/lamp", "things/board", "things/board/book", "shelf"]);
        let dissolved = tree.dissolved(&[at(&tree, "shelf"), at(&tree, "shelf/board")]).expect("it can");
        check(&dissolved, &["", "desk", "desk/lamp", "book"]);
        assert_eq!(dissolved.group, GroupId(0));
        assert_eq!(dissolved.tree.home(GroupId(4)), GroupId(0), "the board's faces are the scene's own now");
        let back = made.tree.dissolved(&[made.group]).and_then(|edited| {
            let lamp = at(&edited.tree, "lamp");
            edited.tree.moved(&[lamp], at(&edited.tree, "desk"))
        });
        let back = back.and_then(|edited| edited.tree.moved(&[at(&edited.tree, "board")], at(&edited.tree, "shelf")));
        let back = back.expect("it can").tree;
        assert_eq!(
            (back.members(&own), &back),
            (Vec::new(), &tree),
            "edits that undo each other leave nothing to tell"
        );
    }

    #[test]
    fn what_cannot_be_is_told() {
        let (_, tree) = tree();
        let shelf = at(&tree, "shelf");
        let into_itself = tree.moved(&[shelf], at(&tree, "shelf/board/book")).expect_err("it holds it");
        assert_eq!(into_itself, RegroupError::IntoItself { name: "shelf".into() });
        assert!(tree.moved(&[GroupId(0)], shelf).is_err_and(|error| error == RegroupError::Nothing));
        assert!(tree.grouped(&[shelf], "  ").is_err_and(|error| error == RegroupError::NoName));
        assert!(tree.renamed(GroupId(0), "x").is_err_and(|error| error == RegroupError::Root));
        assert!(tree.dissolved(&[]).is_err());
    }
}
