//! Names of elements, from the scene's groups and materials.
//!
//! A patch is named by its polygon's group and material, a cluster by the deepest group that holds
//! all its polygons, or by those of its groups that send most. Groups are those that a person
//! arranged, where somebody did.

use std::sync::Arc;

use rustc_hash::FxHashMap;

use crate::base::format;
use crate::hierarchy::{Cluster, ElementId, Hierarchy, Shape, SkyPart};
use crate::scene::outside::Axes;
use crate::scene::{GroupId, GroupMember, Scene};
use crate::transport::SolutionView;

/// So many groups of a cluster that has several are named.
const NAMED: usize = 2;

/// Groups of the clusters of one generation.
pub struct Names {
    generation: u64,
    /// The scene with its groups as they are arranged.
    scene: Arc<Scene>,
    /// How they were arranged.
    regrouping: Vec<GroupMember>,
    /// The deepest group that holds all polygons of a cluster.
    group_of: FxHashMap<ElementId, GroupId>,
    /// Polygons in each group and those below it.
    polygons_in: Vec<u32>,
}

impl Names {
    /// Looks at the clusters of a hierarchy.
    pub fn new(generation: u64, hierarchy: &Hierarchy, scene: &Arc<Scene>) -> Self {
        let regrouping = scene.regrouping.clone();
        let scene = scene.as_arranged();
        let mut polygons_in = vec![0; scene.groups.len()];
        for polygon in &scene.polygons {
            if let Some(count) = polygons_in.get_mut(polygon.group.0 as usize) {
                *count += 1;
            }
        }
        // A parent precedes its children.
        for group in (0..scene.groups.len()).rev() {
            if let Some(parent) = scene.groups[group].parent {
                polygons_in[parent.0 as usize] += polygons_in[group];
            }
        }
        let mut group_of = FxHashMap::default();
        for id in hierarchy.ids().rev() {
            let element = hierarchy.element(id);
            if element.is_cluster() {
                let groups = element.children().filter_map(|child| match &hierarchy.element(child).shape {
                    Shape::Cluster(_) => group_of.get(&child).copied(),
                    Shape::Patch(patch) => scene.polygons.get(patch.polygon as usize).map(|polygon| polygon.group),
                    Shape::Sky(_) => None,
                });
                let common = groups.reduce(|one, other| common_group(&scene, one, other));
                group_of.insert(id, common.unwrap_or(GroupId(0)));
            }
        }
        Self { generation, scene, regrouping, group_of, polygons_in }
    }

    /// Whether these are the names of a generation with the groups of a scene.
    pub fn are_of(&self, generation: u64, scene: &Scene) -> bool {
        self.generation == generation && self.regrouping == scene.regrouping
    }

    /// Name of an element, the same wherever it is named; in the light of a solution, by which the
    /// contents of a cluster are ranked.
    pub fn full(&self, solution_view: &SolutionView, id: ElementId) -> String {
        let hierarchy = solution_view.hierarchy();
        match &hierarchy.element(id).shape {
            Shape::Cluster(_) if id == Hierarchy::ROOT => "the whole scene".into(),
            Shape::Cluster(cluster) => {
                let size = hierarchy.patches_below(cluster).len();
                let polygons = format::things(size, "polygon", "polygons");
                match self.group(id) {
                    Some((path, whole)) if size == whole => path,
                    Some((path, _)) => format!("{path}: {polygons} of it"),
                    None => match self.contents(solution_view, cluster) {
                        contents if contents.is_empty() => format!("cluster of {polygons}"),
                        contents => contents,
                    },
                }
            }
            Shape::Patch(patch) => of_polygon(&self.scene, patch.polygon),
            Shape::Sky(number) => outside(&self.scene, hierarchy.sky_part(*number)),
        }
    }

    /// Name of an element in a word or two, for a place among those that hold it.
    pub fn short(&self, hierarchy: &Hierarchy, id: ElementId) -> String {
        let element = hierarchy.element(id);
        match &element.shape {
            Shape::Cluster(_) if id == Hierarchy::ROOT => "scene".into(),
            Shape::Cluster(cluster) => {
                let size = hierarchy.patches_below(cluster).len();
                match self.group(id) {
                    Some((path, whole)) if size == whole => path.rsplit('/').next().unwrap_or_default().to_owned(),
                    _ => format!("{} polygons", format::count(size)),
                }
            }
            Shape::Patch(patch) if patch.level == 0 => format!("polygon {}", format::count(patch.polygon)),
            Shape::Patch(_) => {
                let first = element.parent().and_then(|parent| hierarchy.element(parent).children().next());
                let number = first.map_or(0, |first| id.0 - first.0) + 1;
                format!("child {number}")
            }
            Shape::Sky(number) => match hierarchy.sky_part(*number) {
                part if part.is_sun => "sun".into(),
                part if part.level == 0 => "sky".into(),
                _ => "part of the sky".into(),
            },
        }
    }

    /// Name of an element where room is scarce and numbers say little, such as along an axis: the
    /// group's last name or the patch's material.
    pub fn label(&self, hierarchy: &Hierarchy, id: ElementId) -> String {
        let last_of = |path: String| path.rsplit('/').next().unwrap_or_default().to_owned();
        match &hierarchy.element(id).shape {
            Shape::Cluster(_) => match self.group(id) {
                Some((path, _)) => last_of(path),
                None => self.short(hierarchy, id),
            },
            Shape::Patch(patch) => {
                let scene = &self.scene;
                let material = scene.polygons.get(patch.polygon as usize).map(|polygon| polygon.material.0 as usize);
                let material = material.and_then(|material| scene.materials.get(material));
                material.map_or_else(|| self.short(hierarchy, id), |material| material.name.clone())
            }
            Shape::Sky(_) => self.short(hierarchy, id),
        }
    }

    /// The topmost groups that a cluster has polygons of: how many, and two by name, those that
    /// send most first, emitted or reflected, then those with most polygons.
    fn contents(&self, solution_view: &SolutionView, cluster: &Cluster) -> String {
        let (hierarchy, scene) = (solution_view.hierarchy(), &self.scene);
        let mut weights: FxHashMap<GroupId, (f32, usize)> = FxHashMap::default();
        for &id in hierarchy.patches_below(cluster) {
            let element = hierarchy.element(id);
            if let Shape::Patch(patch) = &element.shape
                && let Some(polygon) = scene.polygons.get(patch.polygon as usize)
            {
                let (power, polygons) = weights.entry(topmost_group(scene, polygon.group)).or_default();
                *power += element.area * solution_view.radiosity(id).element_sum();
                *polygons += 1;
            }
        }
        weights.remove(&GroupId(0));
        let mut weights: Vec<(GroupId, (f32, usize))> = weights.into_iter().collect();
        weights.sort_by(|(a, one), (b, other)| other.0.total_cmp(&one.0).then(other.1.cmp(&one.1)).then(a.cmp(b)));
        let named: Vec<String> = weights.iter().take(NAMED).map(|(group, _)| scene.group_path(*group)).collect();
        let named = named.join(", ");
        match weights.len() {
            0 => String::new(),
            1 => named,
            count if count > NAMED => format!("{count} objects: {named}, …"),
            count => format!("{count} objects: {named}"),
        }
    }

    /// The path of a cluster's group, and how many polygons that one holds; `None` for the scene's
    /// root group.
    fn group(&self, id: ElementId) -> Option<(String, usize)> {
        let (group, scene) = (*self.group_of.get(&id)?, &self.scene);
        let path =
            scene.groups.get(group.0 as usize).map(|_| scene.group_path(group)).filter(|path| !path.is_empty())?;
        Some((path, self.polygons_in.get(group.0 as usize).copied()? as usize))
    }
}

/// Name of a polygon and of all its parts: group and material.
pub fn of_polygon(scene: &Scene, polygon: u32) -> String {
    let Some(polygon) = scene.polygons.get(polygon as usize) else {
        return format!("polygon {}", format::count(polygon));
    };
    let material = scene.materials.get(polygon.material.0 as usize).map_or("", |material| material.name.as_str());
    match scene.group_path(polygon.group) {
        path if path.is_empty() => material.to_owned(),
        path => of_material(&path, material),
    }
}

/// A group and a material; one that a file does not name stands in brackets already.
fn of_material(group: &str, material: &str) -> String {
    let is_bracketed = material.starts_with('(') && material.ends_with(')');
    if is_bracketed { format!("{group} {material}") } else { format!("{group} ({material})") }
}

/// A part of what lies outside by where it stands: *sky, southeast, 45° up*.
fn outside(scene: &Scene, part: &SkyPart) -> String {
    const SIDES: [&str; 8] = ["north", "northeast", "east", "southeast", "south", "southwest", "west", "northwest"];
    let [azimuth, elevation] = Axes::with_up(scene.up_axis()).angles(part.direction.as_dvec3());
    let side = SIDES[(azimuth / 45.0).round() as usize % SIDES.len()];
    let what = if part.is_sun { "sun" } else { "sky" };
    format!("{what}, {side}, {elevation:.0}° up")
}

/// The group below the root that holds this one; the root for itself.
fn topmost_group(scene: &Scene, mut group: GroupId) -> GroupId {
    while let Some(parent) = scene.groups.get(group.0 as usize).and_then(|of| of.parent) {
        if parent == GroupId(0) {
            break;
        }
        group = parent;
    }
    group
}

/// The deepest group that holds both; a parent precedes its children.
fn common_group(scene: &Scene, mut one: GroupId, mut other: GroupId) -> GroupId {
    while one != other {
        let later = if one > other { &mut one } else { &mut other };
        match scene.groups.get(later.0 as usize).and_then(|group| group.parent) {
            Some(parent) => *later = parent,
            None => return GroupId(0),
        }
    }
    one
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;
    use crate::hierarchy::ClusteringMode;
    use crate::solve::{Solver, SolverParams};

    /// A ceiling of two triangles and a floor of one, in a room; beside it a post.
    fn room() -> Scene {
        let mut scene = Scene::new("house");
        let white = scene.add_material("white", Vec3::splat(0.5), Vec3::ONE);
        let room = scene.add_group("room", GroupId(0));
        let (ceiling, floor) = (scene.add_group("ceiling", room), scene.add_group("floor", room));
        let post = scene.add_group("post", GroupId(0));
        for (x, group) in [(0.0, ceiling), (1.0, ceiling), (2.0, floor), (9.0, post), (9.5, post)] {
            scene.add_triangle([Vec3::X * x, Vec3::new(x + 1.0, 0.0, 0.0), Vec3::new(x, 1.0, 0.0)], white, group);
        }
        scene
    }

    /// A solution of the scene, clustered by its groups, and the names in it.
    fn solved(scene: Scene) -> (Arc<SolutionView>, Names) {
        let scene = Arc::new(scene);
        let params = SolverParams { clustering: ClusteringMode::Groups, ..SolverParams::default() };
        let solution_view = Solver::solved_view(scene.clone(), params);
        let names = Names::new(1, solution_view.hierarchy(), &scene);
        (solution_view, names)
    }

    fn contents(solution_view: &SolutionView, names: &Names) -> String {
        let Shape::Cluster(root) = &solution_view.hierarchy().element(Hierarchy::ROOT).shape else {
            unreachable!("the root is a cluster")
        };
        names.contents(solution_view, root)
    }

    #[test]
    fn brackets_are_not_doubled() {
        assert_eq!(of_material("desk", "oak"), "desk (oak)");
        assert_eq!(of_material("desk", "(no material)"), "desk (no material)");
    }

    /// Truth: the groups as they were made.
    #[test]
    fn elements_are_named_by_groups_and_materials() {
        let scene = room();
        let (solution_view, names) = solved(scene.clone());
        let hierarchy = solution_view.hierarchy();
        let full: Vec<String> = hierarchy.ids().map(|id| names.full(&solution_view, id)).collect();
        for name in ["the whole scene", "room", "room/ceiling", "post", "room/floor (white)", "room/ceiling (white)"] {
            assert!(full.iter().any(|full| full == name), "{name} is not among {full:?}");
        }
        let ceiling = hierarchy.ids().find(|id| full[id.index()] == "room/ceiling").expect("it was there");
        assert_eq!(names.short(hierarchy, ceiling), "ceiling");
        assert_eq!(names.label(hierarchy, ceiling), "ceiling");
        let patch = hierarchy.initial_patches()[0];
        assert_eq!(names.label(hierarchy, patch), "white");
        assert!(names.are_of(1, &scene) && !names.are_of(2, &scene));
        let mut arranged = scene;
        arranged.regroup(vec![GroupMember::Group("all".into(), vec![GroupMember::Object("post".into())])]);
        assert!(!names.are_of(1, &arranged), "other groups, other names");
        assert_eq!(contents(&solution_view, &names), "2 objects: room, post");
    }

    /// Truth: powers by hand. The lamp sends 10 W; of them a sheet below reflects watts; the candle
    /// emits a ten-thousandth of a watt.
    #[test]
    fn contents_are_ranked_by_what_they_send_emitted_or_reflected() {
        let mut scene = Scene::new("house");
        let quad = |scene: &mut Scene, size: f32, height: f32, up: bool, material, group| {
            let at = |x: f32, y: f32| Vec3::new(size * x, height, size * y);
            let corners = [at(-0.5, -0.5), at(-0.5, 0.5), at(0.5, 0.5), at(0.5, -0.5)];
            let [a, b, c, d] = corners;
            let corners = if up { [a, b, c, d] } else { [d, c, b, a] };
            scene.add_triangle([corners[0], corners[1], corners[2]], material, group);
            scene.add_triangle([corners[0], corners[2], corners[3]], material, group);
        };
        let black = scene.add_material("black", Vec3::ZERO, Vec3::ZERO);
        let white = scene.add_material("white", Vec3::splat(0.9), Vec3::ZERO);
        let faint = scene.add_material("faint", Vec3::ZERO, Vec3::splat(0.01));
        let bright = scene.add_material("bright", Vec3::ZERO, Vec3::splat(10.0));
        let [pit, sheet, candle, lamp] =
            ["pit", "sheet", "candle", "lamp"].map(|name| scene.add_group(name, GroupId(0)));
        quad(&mut scene, 1.0, -0.5, false, black, pit);
        quad(&mut scene, 4.0, 0.0, true, white, sheet);
        quad(&mut scene, 0.1, 2.5, false, faint, candle);
        quad(&mut scene, 1.0, 2.0, false, bright, lamp);
        let (solution_view, names) = solved(scene);
        assert_eq!(contents(&solution_view, &names), "4 objects: lamp, sheet, …");
    }

    /// Truth: the nearest group above both, by hand.
    #[test]
    fn the_common_group_is_the_deepest_that_holds_both() {
        let scene = room();
        let [root, room, ceiling, floor, post] = [0, 1, 2, 3, 4].map(GroupId);
        for (one, other, common) in
            [(ceiling, floor, room), (room, floor, room), (floor, post, root), (post, post, post)]
        {
            assert_eq!(common_group(&scene, one, other), common);
            assert_eq!(common_group(&scene, other, one), common);
        }
    }
}
