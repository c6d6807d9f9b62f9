//! Writing a tree of groups as the shortest list that arranges the scene's own groups as it does:
//! what [`GroupTree::arranged`] reads.

use super::regroup::{CONTENTS, addresses};
use super::{Group, GroupId, GroupMember, GroupTree};

impl GroupTree {
    /// The shortest list that arranges the scene's own groups as this tree does.
    pub fn members(&self, own: &[Group]) -> Vec<GroupMember> {
        Listing::new(self, own).members_of(GroupId(0))
    }
}

/// Writes a tree as what differs from the scene's own.
struct Listing<'a> {
    tree: &'a GroupTree,
    children: Vec<Vec<GroupId>>,
    addresses: Vec<String>,
    /// Of each group of the tree, the scene's own that it stands for.
    stands_for: Vec<Option<usize>>,
    /// The scene's own groups that are dissolved into each group.
    dissolved: Vec<Vec<usize>>,
    /// Whether a group stands where the list's reader would put it by itself.
    is_in_place: Vec<bool>,
    /// Whether a group must be listed with its members.
    is_listed: Vec<bool>,
}

impl<'a> Listing<'a> {
    fn new(tree: &'a GroupTree, own: &[Group]) -> Self {
        let count = tree.groups.len();
        let mut stands_for: Vec<Option<usize>> = vec![None; count];
        let mut dissolved = vec![Vec::new(); count];
        for (index, group) in own.iter().enumerate() {
            let home = tree.home(GroupId(index as u32)).0 as usize;
            let is_it = index == 0 || (home > 0 && group.name == tree.groups[home].name);
            match &mut stands_for[home] {
                free @ None if is_it => *free = Some(index),
                _ => dissolved[home].push(index),
            }
        }
        let in_place = |index: usize| {
            let stands_for = stands_for[index]?;
            let around = own[stands_for].parent.map(|parent| tree.home(parent));
            (tree.groups[index].parent == around).then_some(())
        };
        let is_in_place: Vec<bool> = (0..count).map(|index| in_place(index).is_some()).collect();
        let mut is_listed: Vec<bool> =
            (0..count).map(|index| stands_for[index].is_none() || !dissolved[index].is_empty()).collect();
        // What is in its parent's list makes the parent listed; parents precede their children.
        for index in (1..count).rev() {
            if let Some(parent) = tree.groups[index].parent.filter(|_| is_listed[index] || !is_in_place[index]) {
                is_listed[parent.0 as usize] = true;
            }
        }
        Self {
            tree,
            children: tree.children(),
            addresses: addresses(own),
            stands_for,
            dissolved,
            is_in_place,
            is_listed,
        }
    }

    fn members_of(&self, group: GroupId) -> Vec<GroupMember> {
        let index = group.0 as usize;
        let own = self.stands_for[index].filter(|own| *own > 0);
        let contents = |own: usize| GroupMember::Object(format!("{}{CONTENTS}", self.addresses[own]));
        let mut members: Vec<_> = own.into_iter().chain(self.dissolved[index].iter().copied()).map(contents).collect();
        for &child in &self.children[index] {
            let place = child.0 as usize;
            match self.stands_for[place] {
                Some(own) if !self.is_listed[place] => {
                    if !self.is_in_place[place] {
                        members.push(GroupMember::Object(self.addresses[own].clone()));
                    }
                }
                _ => members.push(GroupMember::Group(self.tree.groups[place].name.clone(), self.members_of(child))),
            }
        }
        members
    }
}
