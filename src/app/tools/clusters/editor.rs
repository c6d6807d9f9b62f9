//! State of the editor of groups: the tree as it is being arranged, what is selected, and former
//! trees for undo.

use std::collections::BTreeSet;
use std::sync::Arc;

use glam::Vec3;
use rustc_hash::FxHashSet;

use crate::render::box_edges;
use crate::scene::{GroupId, GroupMember, GroupTree, RegroupError, Regrouped, Scene};
use crate::worker::Command;

/// So many edits can be undone.
const MOST_UNDO: usize = 100;

/// A row of the tree.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Row {
    pub group: GroupId,
    /// Groups that hold it.
    pub depth: u16,
}

/// A tree of groups that is being arranged.
#[derive(Default)]
pub struct GroupEditor {
    scene: Option<Arc<Scene>>,
    members: Vec<GroupMember>,
    /// Whether the worker has yet to confirm the tree: until then the scene still has former
    /// groups.
    is_sent: bool,
    tree: Option<Arc<GroupTree>>,
    children: Vec<Vec<GroupId>>,
    /// Polygons in each group with all that is in it, and their area, m².
    polygons: Vec<u32>,
    areas: Vec<f64>,
    /// Lower and upper corner of each group's box; the lower one lies above the upper where it has
    /// no polygons.
    boxes: Vec<(Vec3, Vec3)>,
    /// The group whose row the mouse is over.
    pub pointed: Option<GroupId>,
    pub selected: BTreeSet<GroupId>,
    unfolded: FxHashSet<GroupId>,
    undo: Vec<Vec<GroupMember>>,
    /// The name in the text field.
    pub name: String,
    /// Why the last edit could not be made.
    pub problem: Option<String>,
}

impl GroupEditor {
    /// Takes up the scene in view.
    pub fn follow(&mut self, scene: &Arc<Scene>) {
        if self.scene.as_ref().is_some_and(|known| Arc::ptr_eq(known, scene)) {
            return;
        }
        self.scene = Some(scene.clone());
        if scene.regrouping == self.members {
            self.is_sent = false;
        } else if !self.is_sent {
            self.members.clone_from(&scene.regrouping);
            self.undo.clear();
            self.selected.clear();
        }
        let tree = GroupTree::arranged(&scene.groups, &self.members).0;
        if self.tree.as_deref() != Some(&tree) {
            self.selected.clear();
            self.unfolded = [GroupId(0)].into_iter().collect();
        }
        self.take(tree);
    }

    fn take(&mut self, tree: GroupTree) {
        if let Some(scene) = &self.scene {
            self.polygons = tree.sums(scene.polygons.iter().map(|polygon| (polygon.group, 1)));
            self.boxes = boxes(&tree, scene);
            self.areas =
                tree.sums(scene.polygons.iter().map(|polygon| (polygon.group, f64::from(scene.area(polygon)))));
        }
        self.children = tree.children();
        self.tree = Some(Arc::new(tree));
    }

    /// The tree as it is arranged now.
    pub fn tree(&self) -> Option<Arc<GroupTree>> {
        self.tree.clone()
    }

    /// Polygons in a group with all that is in it, and their area, m².
    pub fn size(&self, group: GroupId) -> (u32, f64) {
        let index = group.0 as usize;
        (self.polygons.get(index).copied().unwrap_or(0), self.areas.get(index).copied().unwrap_or(0.0))
    }

    /// The edges of the box of the group that the mouse is over; rows say anew in each frame which
    /// one it is.
    pub fn take_pointed_box(&mut self) -> Option<[[Vec3; 2]; 12]> {
        let (lower, upper) = *self.boxes.get(self.pointed.take()?.0 as usize)?;
        lower.cmple(upper).all().then(|| box_edges(lower, upper))
    }

    /// Whether groups lie in a group.
    pub fn has_groups(&self, group: GroupId) -> bool {
        self.children.get(group.0 as usize).is_some_and(|children| !children.is_empty())
    }

    /// Whether what lies in a group is shown.
    pub fn is_unfolded(&self, group: GroupId) -> bool {
        self.unfolded.contains(&group)
    }

    /// Shows or hides what lies in a group.
    pub fn toggle(&mut self, group: GroupId) {
        if !self.unfolded.remove(&group) {
            self.unfolded.insert(group);
        }
    }

    /// The rows that are to be seen, from the root down.
    pub fn rows(&self) -> Vec<Row> {
        let mut rows = Vec::new();
        let mut waiting = vec![Row { group: GroupId(0), depth: 0 }];
        while let Some(row) = waiting.pop() {
            rows.push(row);
            if self.is_unfolded(row.group)
                && let Some(children) = self.children.get(row.group.0 as usize)
            {
                waiting.extend(children.iter().rev().map(|&group| Row { group, depth: row.depth + 1 }));
            }
        }
        rows
    }

    /// Selects a group; with others, where they are to stay selected.
    pub fn select(&mut self, group: GroupId, keeps_others: bool) {
        self.problem = None;
        if !keeps_others {
            self.selected = [group].into_iter().collect();
        } else if !self.selected.remove(&group) {
            self.selected.insert(group);
        }
        self.name_selected();
    }

    fn name_selected(&mut self) {
        let only = self.selected.first().filter(|group| self.selected.len() == 1 && group.0 > 0);
        let named = only.and_then(|group| Some(self.tree.as_ref()?.groups().get(group.0 as usize)?.name.clone()));
        self.name = named.unwrap_or_default();
    }

    /// The selected groups.
    pub fn selection(&self) -> Vec<GroupId> {
        self.selected.iter().copied().collect()
    }

    /// A name that no group has yet.
    pub fn free_name(&self) -> String {
        let is_taken =
            |name: &String| self.tree.iter().any(|tree| tree.groups().iter().any(|group| group.name == *name));
        let mut names = (1..).map(|number| format!("group {number}"));
        names.find(|name| !is_taken(name)).unwrap_or_default()
    }

    /// Makes an edit and returns the command for the worker, or keeps the reason why it cannot be
    /// made.
    pub fn edit(&mut self, edited: Result<Regrouped, RegroupError>) -> Option<Command> {
        let (own, former) = (&self.scene.as_ref()?.groups, self.tree.as_deref()?);
        let Regrouped { tree, places, group } = match edited {
            Ok(edited) => edited,
            Err(error) => {
                self.problem = Some(format!("{error}."));
                return None;
            }
        };
        self.problem = None;
        if tree == *former {
            return None;
        }
        let members = tree.members(own);
        self.undo.push(std::mem::replace(&mut self.members, members));
        let surplus = self.undo.len().saturating_sub(MOST_UNDO);
        self.undo.drain(..surplus);
        let place = |group: &GroupId| places.get(group.0 as usize).copied().unwrap_or(GroupId(0));
        self.unfolded = self.unfolded.iter().map(place).collect();
        self.unfolded.extend(tree.upwards(group));
        self.selected = [group].into_iter().filter(|group| group.0 > 0).collect();
        Some(self.arranged(tree))
    }

    /// Takes the last edit back.
    pub fn undo(&mut self) -> Option<Command> {
        let members = self.undo.pop()?;
        self.members = members;
        self.rearranged()
    }

    /// Arranges all groups as the scene's file has them.
    pub fn as_in_file(&mut self) -> Option<Command> {
        self.undo.push(std::mem::take(&mut self.members));
        self.rearranged()
    }

    fn rearranged(&mut self) -> Option<Command> {
        let scene = self.scene.as_ref()?;
        let tree = GroupTree::arranged(&scene.groups, &self.members).0;
        let former = self.tree.as_deref().map(GroupTree::addresses).unwrap_or_default();
        let open: FxHashSet<&String> = self.unfolded.iter().filter_map(|group| former.get(group.0 as usize)).collect();
        let still_open = tree.addresses().into_iter().enumerate().filter(|(_, address)| open.contains(address));
        self.unfolded = still_open.map(|(index, _)| GroupId(index as u32)).collect();
        self.selected.clear();
        self.problem = None;
        Some(self.arranged(tree))
    }

    fn arranged(&mut self, tree: GroupTree) -> Command {
        self.is_sent = true;
        self.take(tree);
        self.name_selected();
        Command::SetGroups(self.members.clone())
    }

    /// Whether an edit can be taken back.
    pub fn can_undo(&self) -> bool {
        !self.undo.is_empty()
    }

    /// Whether the groups are other than the scene's file has them.
    pub fn is_arranged(&self) -> bool {
        !self.members.is_empty()
    }
}

/// The boxes of all groups.
fn boxes(tree: &GroupTree, scene: &Scene) -> Vec<(Vec3, Vec3)> {
    let mut boxes = vec![(Vec3::INFINITY, Vec3::NEG_INFINITY); tree.groups().len()];
    for polygon in &scene.polygons {
        let (lower, upper) = &mut boxes[tree.home(polygon.group).0 as usize];
        for &corner in polygon.corners() {
            let position = scene.vertices[corner as usize];
            (*lower, *upper) = (lower.min(position), upper.max(position));
        }
    }
    // Parents precede their children.
    for (index, group) in tree.groups().iter().enumerate().rev() {
        if let Some(parent) = group.parent {
            let inner = boxes[index];
            let outer = &mut boxes[parent.0 as usize];
            *outer = (outer.0.min(inner.0), outer.1.max(inner.1));
        }
    }
    boxes
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::builtin::BuiltinScene;

    fn editor() -> GroupEditor {
        let mut editor = GroupEditor::default();
        editor.follow(&Arc::new(BuiltinScene::Cornell.build()));
        editor
    }

    fn group(editor: &GroupEditor, name: &str) -> GroupId {
        let tree = editor.tree().expect("a scene is there");
        let index = tree.groups().iter().position(|group| group.name == name);
        GroupId(index.unwrap_or_else(|| panic!("there is no group {name}")) as u32)
    }

    /// Truth: polygons and areas of the scene as a whole, whatever was arranged.
    #[test]
    fn edits_are_told_to_the_worker_and_taken_back() {
        let mut editor = editor();
        let whole = editor.size(GroupId(0));
        editor.select(group(&editor, "short_block"), false);
        editor.select(group(&editor, "tall_block"), true);
        let name = editor.free_name();
        let made = editor.tree().map(|tree| tree.grouped(&editor.selection(), &name)).expect("a tree");
        let Some(Command::SetGroups(members)) = editor.edit(made) else { panic!("nothing was sent") };
        assert_eq!(
            members,
            [GroupMember::Group(
                "group 1".into(),
                vec![GroupMember::Object("short_block".into()), GroupMember::Object("tall_block".into())],
            )]
        );
        assert_eq!(editor.selection(), [group(&editor, "group 1")]);
        assert_eq!((editor.name.as_str(), editor.size(GroupId(0))), ("group 1", whole));
        let both = editor.size(group(&editor, "short_block")).0 + editor.size(group(&editor, "tall_block")).0;
        assert_eq!(editor.size(group(&editor, "group 1")).0, both);
        let made = group(&editor, "group 1");
        editor.pointed = Some(made);
        let edges = editor.take_pointed_box().expect("it has polygons");
        let (lower, upper) = editor.boxes[0];
        assert!(edges.iter().flatten().all(|corner| corner.cmpge(lower).all() && corner.cmple(upper).all()));
        assert!(editor.rows().iter().any(|row| row.group == group(&editor, "group 1")));
        let Some(Command::SetGroups(members)) = editor.undo() else { panic!("nothing was sent") };
        assert!(members.is_empty() && !editor.can_undo() && !editor.is_arranged());
    }

    #[test]
    fn an_edit_that_cannot_be_made_says_why_and_changes_nothing() {
        let mut editor = editor();
        let walls = group(&editor, "walls");
        let into_itself = editor.tree().map(|tree| tree.moved(&[walls], walls)).expect("a tree");
        assert!(editor.edit(into_itself).is_none());
        assert!(editor.problem.as_ref().is_some_and(|problem| problem.contains("`walls`")) && !editor.can_undo());
    }

    /// A scene that comes back from the worker with an older arrangement does not undo what was
    /// done since.
    #[test]
    fn what_was_sent_stays_until_the_worker_has_it() {
        let mut editor = editor();
        let walls = group(&editor, "walls");
        let dissolved = editor.tree().map(|tree| tree.dissolved(&[walls])).expect("a tree");
        let Some(Command::SetGroups(members)) = editor.edit(dissolved) else { panic!("nothing was sent") };
        editor.follow(&Arc::new(BuiltinScene::Cornell.build()));
        assert!(editor.is_arranged() && editor.can_undo());
        let mut confirmed = BuiltinScene::Cornell.build();
        confirmed.regroup(members);
        editor.follow(&Arc::new(confirmed));
        assert!(editor.is_arranged() && editor.can_undo());
        editor.follow(&Arc::new(BuiltinScene::Cornell.build()));
        assert!(!editor.is_arranged() && !editor.can_undo(), "somebody else arranged it anew");
    }
}
