//! Names for elements, from the scene's groups and materials where an element coincides with one.

use crate::format;
use crate::hierarchy::{ElementId, Hierarchy, Shape};
use crate::scene::{GroupId, MaterialId, Scene};

/// What all polygons below an element have in common.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Common {
    group: GroupId,
    material: Option<MaterialId>,
    polygons: u32,
}

/// Names of the elements of one scene's hierarchy; valid for all states of it, since quarters are named by their polygon.
#[derive(Clone, Debug)]
pub struct Names {
    /// By cluster and initial patch; `None` for quarters.
    common: Vec<Option<Common>>,
    /// By group: its path's last part, and how many polygons it has, those of its parts included.
    groups: Vec<(String, u32)>,
    materials: Vec<String>,
    scene: String,
}

impl Names {
    /// Reads them out of a scene; `hierarchy` is one of its polygons.
    pub fn new(scene: &Scene, hierarchy: &Hierarchy) -> Self {
        let mut common: Vec<Option<Common>> = vec![None; hierarchy.elements().len()];
        // Parents precede their children.
        for (index, element) in hierarchy.elements().iter().enumerate().rev() {
            let own = match &element.shape {
                Shape::Patch(patch) if patch.level > 0 => None,
                Shape::Patch(patch) => scene.polygons.get(patch.polygon as usize).map(|polygon| Common {
                    group: polygon.group,
                    material: Some(polygon.material),
                    polygons: 1,
                }),
                Shape::Cluster(_) => {
                    let below = element.children().filter_map(|child| common[child.index()]);
                    below.reduce(|one, other| Common {
                        group: nearest_common(scene, one.group, other.group),
                        material: one.material.filter(|_| one.material == other.material),
                        polygons: one.polygons + other.polygons,
                    })
                }
            };
            common[index] = own;
        }
        let mut counts = vec![0_u32; scene.groups.len()];
        for polygon in &scene.polygons {
            counts[polygon.group.0 as usize] += 1;
        }
        for (index, group) in scene.groups.iter().enumerate().rev() {
            if let Some(parent) = group.parent {
                counts[parent.0 as usize] += counts[index];
            }
        }
        let groups = scene.groups.iter().zip(counts).map(|(group, count)| (group.name.clone(), count)).collect();
        let materials = scene.materials.iter().map(|material| material.name.clone()).collect();
        Self { common, groups, materials, scene: scene.name.clone() }
    }

    /// What an element is called: its group where it lies in one, else its material, else by how many polygons it has.
    pub fn of(&self, hierarchy: &Hierarchy, id: ElementId) -> String {
        if id == Hierarchy::ROOT {
            return self.scene.clone();
        }
        let (at, quarters) = initial(hierarchy, id);
        let Some(common) = self.common.get(at.index()).copied().flatten() else { return "cluster".into() };
        let material = common.material.and_then(|material| self.materials.get(material.0 as usize));
        let (group, size) = &self.groups[common.group.0 as usize];
        let is_named = common.group.0 != 0;
        match (hierarchy.element(id).is_cluster(), material) {
            (true, _) if is_named && *size == common.polygons => group.clone(),
            (true, _) if is_named => format!("{group}, {}", polygons(common.polygons)),
            (true, Some(material)) => format!("{material}, {}", polygons(common.polygons)),
            (true, None) => format::things(common.polygons as usize, "polygon", "polygons"),
            (false, material) => {
                let material = material.map_or("", String::as_str);
                let whole = if is_named { format!("{group} ({material})") } else { material.to_owned() };
                if quarters > 0 { format!("{whole}, 1/{}", format::count(4_u64.pow(quarters))) } else { whole }
            }
        }
    }

    /// The same without numbers, where room is scarce: the group or material alone; `None` for a cluster of many things.
    pub fn short(&self, hierarchy: &Hierarchy, id: ElementId) -> Option<&str> {
        if id == Hierarchy::ROOT {
            return Some(&self.scene);
        }
        let common = self.common.get(initial(hierarchy, id).0.index()).copied().flatten()?;
        match common.group.0 {
            0 => common.material.and_then(|material| self.materials.get(material.0 as usize)).map(String::as_str),
            group => Some(&self.groups[group as usize].0),
        }
    }
}

fn polygons(count: u32) -> String {
    format::things(count as usize, "polygon", "polygons")
}

/// The initial patch of a quarter and how often it was split on the way; any other element itself.
fn initial(hierarchy: &Hierarchy, id: ElementId) -> (ElementId, u32) {
    match &hierarchy.element(id).shape {
        Shape::Cluster(_) => (id, 0),
        Shape::Patch(patch) => {
            let levels = u32::from(patch.level);
            let up = std::iter::successors(Some(id), |&at| hierarchy.element(at).parent());
            (up.take(levels as usize + 1).last().unwrap_or(id), levels)
        }
    }
}

/// The smallest group that holds both.
fn nearest_common(scene: &Scene, mut one: GroupId, mut other: GroupId) -> GroupId {
    // A parent precedes its children, so the later of the two lies nowhere above the other.
    while one != other {
        let later = if one.0 > other.0 { &mut one } else { &mut other };
        *later = scene.groups[later.0 as usize].parent.unwrap_or(GroupId(0));
    }
    one
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::exposure::Exposure;
    use crate::hierarchy::ClusteringMode;
    use crate::scene::builtin::BuiltinScene;

    /// Truth: by groups, each cluster is a group, and our own office has a desk.
    #[test]
    fn clusters_by_groups_have_the_names_of_groups() {
        let scene = BuiltinScene::from_name("office").expect("ours").build();
        let mut hierarchy = Hierarchy::new(&scene, Exposure::default().into(), ClusteringMode::Groups, 4);
        let patch = hierarchy.initial_patches()[3];
        let names = Names::new(&scene, &hierarchy);
        assert_eq!(names.of(&hierarchy, Hierarchy::ROOT), "office");
        let own: Vec<String> = hierarchy
            .element(Hierarchy::ROOT)
            .children()
            .filter(|&id| hierarchy.element(id).is_cluster())
            .map(|id| names.of(&hierarchy, id))
            .collect();
        let groups: Vec<&str> = scene.groups.iter().map(|group| group.name.as_str()).collect();
        assert!(own.len() > 3 && own.iter().all(|name| groups.contains(&name.as_str())), "{own:?}");

        let whole = names.of(&hierarchy, patch);
        hierarchy.subdivide(patch);
        let quarter = hierarchy.element(patch).children().next().expect("it was split");
        hierarchy.subdivide(quarter);
        let sixteenth = hierarchy.element(quarter).children().next().expect("it was split");
        assert_eq!(names.of(&hierarchy, sixteenth), format!("{whole}, 1/16"));
        assert_eq!(names.short(&hierarchy, sixteenth), names.short(&hierarchy, patch));
    }
}
