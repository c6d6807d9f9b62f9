//! Names for the elements that light the picked one: a link knows only ids and centres.

use crate::render::pick;
use crate::scene::Scene;
use crate::solver::{LinkView, Snapshot};

/// So many sources are named, the strongest.
const MOST: usize = 5;
/// A ray towards a source starts this far from it, as a share of the link's length, so that nothing lies between.
const STEP_BACK: f32 = 1e-3;
/// Centres that are this near, as a share of the link's length, are one.
const SAME: f32 = 1e-4;

/// A link with a name for its source.
pub(super) struct NamedSource {
    pub link: LinkView,
    pub name: String,
}

impl NamedSource {
    /// Which element's link it is, seen from the inspected one.
    pub(super) fn receiver(&self) -> String {
        let kind = if self.link.receiver_is_cluster { "cluster" } else { "patch" };
        match self.link.levels_up {
            0 => "a link of the element's own".to_owned(),
            1 => format!("a link of the {kind} that holds it"),
            levels => format!("a link of the {kind} {levels} levels above it"),
        }
    }
}

/// The links that bring an element most, named.
pub(super) fn strongest(links: &[LinkView], snapshot: &Snapshot, scene: &Scene) -> Vec<NamedSource> {
    let mut links: Vec<&LinkView> = links.iter().collect();
    links.sort_by(|a, b| b.irradiance.max_element().total_cmp(&a.irradiance.max_element()));
    let strongest = links.into_iter().take(MOST);
    strongest.map(|link| NamedSource { link: *link, name: name(link, snapshot, scene) }).collect()
}

/// A patch by its group and material, a cluster by its size.
fn name(link: &LinkView, snapshot: &Snapshot, scene: &Scene) -> String {
    let place = link.source_centre;
    if link.source == link.receiver {
        return "itself, among its parts".to_owned();
    }
    let way = place - link.receiver_centre;
    if link.source_is_cluster {
        let near =
            |lower: glam::Vec3, upper: glam::Vec3| (0.5 * (lower + upper) - place).length() <= SAME * way.length();
        return match snapshot.clusters.iter().find(|cluster| near(cluster.lower, cluster.upper)) {
            Some(cluster) => format!("cluster of {} polygons", super::format::count(cluster.polygons)),
            None => "cluster".to_owned(),
        };
    }
    let hit = pick(&snapshot.mesh, place - STEP_BACK * way, way).filter(|hit| hit.distance <= 2.0 * STEP_BACK);
    let leaf = hit.and_then(|hit| snapshot.mesh.leaves.get(hit.leaf as usize));
    match leaf.and_then(|leaf| scene.polygons.get(leaf.polygon as usize)) {
        Some(polygon) => name_of_polygon(scene, polygon),
        None => format!("patch at {:.2}, {:.2}, {:.2}", place.x, place.y, place.z),
    }
}

fn name_of_polygon(scene: &Scene, polygon: &crate::scene::Polygon) -> String {
    let material = scene.materials.get(polygon.material.0 as usize).map_or("", |material| material.name.as_str());
    match scene.group_path(polygon.group) {
        path if path.is_empty() => material.to_owned(),
        path => format!("{path} ({material})"),
    }
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;
    use crate::hierarchy::ElementId;
    use crate::scene::{GroupId, MaterialId};
    use crate::solver::{Evidence, Leaf, Mesh, Stats};

    /// A ceiling of one triangle, subdivided or not, is named by its polygon.
    #[test]
    fn sources_are_named_by_group_and_material() {
        let mut scene = Scene::new("room");
        let white = scene.add_material("white", Vec3::splat(0.5), Vec3::ONE);
        let group = scene.add_group("ceiling", GroupId(0));
        let corners = [Vec3::new(-1.0, 2.0, -1.0), Vec3::new(1.0, 2.0, -1.0), Vec3::new(0.0, 2.0, 1.0)];
        scene.add_triangle(corners, white, group);
        let leaf =
            Leaf { element: ElementId(7), polygon: 0, material: MaterialId(0), area: 2.0, exposed_area: 2.0, level: 1 };
        let mesh = Mesh {
            positions: corners.map(|corner| corner.to_array()).into(),
            triangles: vec![[0, 1, 2]],
            triangle_leaf: vec![0],
            outlines: Vec::new(),
            leaves: vec![leaf],
        };
        let snapshot = Snapshot {
            generation: 1,
            serial: 1,
            mesh: mesh.into(),
            vertex_radiosity: vec![[0.0; 3]; 3],
            vertex_irradiance: vec![[0.0; 3]; 3],
            leaf_irradiance: vec![[0.0; 3]],
            leaf_radiosity: vec![[0.0; 3]],
            clusters: Vec::new().into(),
            moment: None,
            anatomy: None,
            stats: Stats::default(),
        };
        let link = LinkView {
            receiver: ElementId(1),
            source: ElementId(3),
            receiver_centre: Vec3::ZERO,
            source_centre: Vec3::new(0.0, 2.0, -0.3),
            source_is_cluster: false,
            form_factor: 0.1,
            visibility: 1.0,
            evidence: Evidence::Inherited,
            power: 1.0,
            levels_up: 0,
            receiver_is_cluster: false,
            irradiance: Vec3::ONE,
        };
        assert_eq!(name(&link, &snapshot, &scene), "ceiling (white)");
        let elsewhere = LinkView { source_centre: Vec3::new(5.0, 2.0, 0.0), ..link };
        assert_eq!(name(&elsewhere, &snapshot, &scene), "patch at 5.00, 2.00, 0.00");
    }
}
