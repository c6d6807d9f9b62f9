//! The clusters of one level as a picture: each in a colour of its own, or pulled apart from the
//! middle of the scene.
//!
//! Both are made of a snapshot that carries its solution view, and become a snapshot again, whose
//! mesh has each cluster's vertices apart from all others: the renderer draws it, its outlines and
//! its boxes like any other.

use std::sync::Arc;

use glam::Vec3;

use super::own_colours::shades;
use crate::base::random::hash64;
use crate::hierarchy::{Element, ElementId, Hierarchy, Shape};
use crate::solve::snapshot::{ClusterBox, Mesh, Snapshot};

/// How the clusters of a level are shown.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ClusterView {
    /// The level, the root being 0.
    pub level: u16,
    /// How far the clusters are pulled apart, 0..=1: at 1 their centres lie twice as far from the
    /// root's as they are.
    pub explode: f32,
    /// Whether surfaces show the colours of their clusters instead of their light.
    pub coloured: bool,
}

/// Colours that people with any colour vision tell apart: those of M. Okabe and K. Ito, "Color
/// Universal Design", 2008, and olive and wine of P. Tol, "Colour Schemes", SRON/EPS/TN/09-002,
/// 2021, in an order that sets neighbours off.
const PALETTE: [[u8; 3]; 9] = [
    [230, 159, 0],
    [86, 180, 233],
    [213, 94, 0],
    [0, 158, 115],
    [240, 228, 66],
    [0, 114, 178],
    [204, 121, 167],
    [153, 153, 51],
    [150, 50, 95],
];
/// Each comes in two tints, mixed with so much white.
const WHITE_SHARES: [f32; 2] = [0.10, 0.45];
/// Surfaces that hang at the root itself belong to no smaller cluster.
const AT_ROOT: [u8; 3] = [196, 197, 200];
/// Steps along each axis of the root's box by which places of clusters are distinguished.
const STEPS: f32 = 1024.0;

/// A part of the scene that moves as one, and its colour.
#[derive(Clone, Copy, Debug)]
struct Part {
    /// From the root's centre to its own, in the scene's unit.
    way: Vec3,
    /// Gamma-encoded.
    colour: [u8; 3],
}

/// The hierarchy cut at one level: a polygon belongs to the deepest cluster around it that lies no
/// deeper than that. Polygons that hang at the root are parts of their own, for a room opens when
/// its walls come apart.
#[derive(Clone, Debug)]
pub struct ClusterParts {
    parts: Vec<Part>,
    of_polygon: Vec<u32>,
    /// Of each cluster in the arena's order; `None` above the level.
    of_cluster: Vec<Option<u32>>,
}

impl ClusterParts {
    /// Cuts a hierarchy.
    pub fn new(hierarchy: &Hierarchy, level: u16) -> Self {
        let root = hierarchy.element(Hierarchy::ROOT);
        let whole = Part { way: Vec3::ZERO, colour: AT_ROOT };
        let mut cut = Self { parts: vec![whole], of_polygon: Vec::new(), of_cluster: Vec::new() };
        let colours = cluster_colours(hierarchy);
        // Part that holds each cluster; parents precede their children.
        let mut holder = vec![0_u32; colours.len()];
        let mut clusters = hierarchy.ids().filter(|id| hierarchy.element(*id).is_cluster());
        let places: Vec<ElementId> = clusters.by_ref().collect();
        let mut place_of = vec![0_u32; places.last().map_or(0, |last| last.index() + 1)];
        for (place, &id) in places.iter().enumerate() {
            place_of[id.index()] = place as u32;
            let element = hierarchy.element(id);
            let own_level = level_of(element);
            holder[place] = match element.parent() {
                None => 0,
                Some(parent) if own_level > level => holder[place_of[parent.index()] as usize],
                Some(_) => cut.add(element.centre - root.centre, colours[place]),
            };
            cut.of_cluster.push((own_level >= level).then_some(holder[place]));
        }
        cut.of_polygon = vec![0; hierarchy.initial_patches().len()];
        for &id in hierarchy.initial_patches() {
            let element = hierarchy.element(id);
            let (Shape::Patch(patch), Some(parent)) = (&element.shape, element.parent()) else { continue };
            let part = match holder[place_of[parent.index()] as usize] {
                0 if level > 0 => cut.add(element.centre - root.centre, AT_ROOT),
                part => part,
            };
            cut.of_polygon[patch.polygon as usize] = part;
        }
        cut
    }

    fn add(&mut self, way: Vec3, colour: [u8; 3]) -> u32 {
        self.parts.push(Part { way, colour });
        self.parts.len() as u32 - 1
    }

    /// How far a polygon is moved, in the scene's unit.
    pub fn offset_of_polygon(&self, polygon: u32, explode: f32) -> Vec3 {
        self.offset(self.of_polygon.get(polygon as usize).copied().unwrap_or(0), explode)
    }

    /// How far the cluster is moved that comes at this place among the clusters of the arena; not
    /// at all above the level.
    pub fn offset_of_cluster(&self, place: usize, explode: f32) -> Vec3 {
        let part = self.of_cluster.get(place).copied().flatten();
        part.map_or(Vec3::ZERO, |part| self.offset(part, explode))
    }

    /// How far an element is moved.
    pub fn offset_of(&self, hierarchy: &Hierarchy, id: ElementId, explode: f32) -> Vec3 {
        match &hierarchy.element(id).shape {
            Shape::Patch(patch) => self.offset_of_polygon(patch.polygon, explode),
            Shape::Sky(_) => Vec3::ZERO,
            Shape::Cluster(_) => {
                let before = &hierarchy.elements()[..id.index()];
                self.offset_of_cluster(before.iter().filter(|element| element.is_cluster()).count(), explode)
            }
        }
    }

    /// The colour of a polygon's part, gamma-encoded.
    pub fn colour_of_polygon(&self, polygon: u32) -> [u8; 3] {
        self.of_polygon.get(polygon as usize).map_or(AT_ROOT, |part| self.parts[*part as usize].colour)
    }

    fn offset(&self, part: u32, explode: f32) -> Vec3 {
        explode * self.parts[part as usize].way
    }
}

fn level_of(element: &Element) -> u16 {
    match &element.shape {
        Shape::Cluster(cluster) => cluster.level,
        Shape::Patch(_) | Shape::Sky(_) => u16::MAX,
    }
}

/// The colour of each cluster in the arena's order: given by its place in the scene, so that it is
/// the same whenever the cluster is, and another one than its siblings' as long as there are
/// colours enough.
pub fn cluster_colours(hierarchy: &Hierarchy) -> Vec<[u8; 3]> {
    let root = hierarchy.element(Hierarchy::ROOT);
    let side = match &root.shape {
        Shape::Cluster(cluster) => 2.0 * cluster.half_extent.max_element(),
        Shape::Patch(_) | Shape::Sky(_) => 0.0,
    };
    let step = if side > 0.0 { STEPS / side } else { 0.0 };
    let (mut parent, mut taken) = (None, 0_u32);
    let colour = |element: &Element| {
        let Shape::Cluster(cluster) = &element.shape else { return AT_ROOT };
        if element.parent().is_none() {
            return AT_ROOT;
        }
        if parent != element.parent() {
            (parent, taken) = (element.parent(), 0);
        }
        let place = [element.centre - root.centre, cluster.half_extent];
        let steps = place.iter().flat_map(|vector| (step * *vector).round().to_array());
        let hash = steps.fold(1, |hash, step| hash64(hash, u64::from((step as i32).cast_unsigned())));
        let mut index = hash as usize % PALETTE.len();
        let all = (1_u32 << PALETTE.len()) - 1;
        while taken != all && taken & (1 << index) != 0 {
            index = (index + 1) % PALETTE.len();
        }
        taken |= 1 << index;
        let white = WHITE_SHARES[(hash >> 32) as usize % WHITE_SHARES.len()];
        PALETTE[index].map(|channel| (f32::from(channel) + white * (255.0 - f32::from(channel))).round() as u8)
    };
    hierarchy.elements().iter().filter(|element| element.is_cluster()).map(colour).collect()
}

/// A mesh whose parts share no vertices.
pub struct ApartMesh {
    mesh: Mesh,
    /// Of each vertex, the one that it was made of.
    source: Vec<u32>,
    /// Of each vertex.
    part: Vec<u32>,
}

/// The edges of a leaf's triangles that no other of them shares.
fn rim(triangles: &[[u32; 3]]) -> impl Iterator<Item = [u32; 2]> + '_ {
    let edges = || triangles.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]);
    edges().filter(move |&[from, to]| edges().all(|other| other != [to, from]))
}

/// Stands for "no part yet".
const NO_PART: u32 = u32::MAX;

impl ApartMesh {
    /// Cuts a mesh between parts; triangles and leaves stay in their order.
    pub fn new(mesh: &Mesh, parts: &ClusterParts) -> Self {
        let part_of_leaf = |leaf: u32| parts.of_polygon[mesh.leaves[leaf as usize].polygon as usize];
        let mut apart = Self {
            mesh: Mesh { leaves: mesh.leaves.clone(), triangle_leaf: mesh.triangle_leaf.clone(), ..Mesh::default() },
            source: Vec::with_capacity(mesh.positions.len()),
            part: Vec::with_capacity(mesh.positions.len()),
        };
        apart.mesh.positions.reserve(mesh.positions.len());
        // Triangles of a part lie together, so that the vertex made last is the one wanted.
        let mut last = vec![(NO_PART, 0_u32); mesh.positions.len()];
        let corner = |apart: &mut Self, last: &mut [(u32, u32)], vertex: u32, part: u32| {
            let known = &mut last[vertex as usize];
            if known.0 != part {
                *known = (part, apart.source.len() as u32);
                apart.source.push(vertex);
                apart.part.push(part);
                apart.mesh.positions.push(mesh.positions[vertex as usize]);
            }
            known.1
        };
        let triangles = mesh.triangles.iter().zip(&mesh.triangle_leaf);
        apart.mesh.triangles = triangles
            .map(|(corners, &leaf)| corners.map(|vertex| corner(&mut apart, &mut last, vertex, part_of_leaf(leaf))))
            .collect();
        apart.mesh.outlines.reserve(mesh.outlines.len());
        let runs = apart.mesh.triangle_leaf.chunk_by(|a, b| a == b);
        let mut rest = apart.mesh.triangles.as_slice();
        for run in runs {
            let (of_leaf, behind) = rest.split_at(run.len());
            rest = behind;
            apart.mesh.outlines.extend(rim(of_leaf));
        }
        apart
    }

    /// The mesh with its parts pulled apart.
    fn exploded(&self, parts: &ClusterParts, explode: f32) -> Mesh {
        let mut mesh = self.mesh.clone();
        if explode > 0.0 {
            for (position, &part) in mesh.positions.iter_mut().zip(&self.part) {
                *position = (Vec3::from(*position) + parts.offset(part, explode)).to_array();
            }
        }
        mesh
    }

    /// Gamma-encoded colours of the vertices, shaded by how their surfaces are turned.
    fn colours(&self, parts: &ClusterParts) -> Vec<[f32; 3]> {
        let coloured = |(shade, &part): (f32, &u32)| {
            parts.parts[part as usize].colour.map(|channel| shade * f32::from(channel) / 255.0)
        };
        shades(&self.mesh).into_iter().zip(&self.part).map(coloured).collect()
    }

    /// The values of the vertices that these were made of.
    fn of_source(&self, values: &[[f32; 3]]) -> Vec<[f32; 3]> {
        self.source.iter().map(|&vertex| values[vertex as usize]).collect()
    }

    /// A snapshot of this mesh as a view shows it; the vertices carry colours where the view is
    /// coloured, else their radiosities.
    pub fn snapshot(&self, of: &Snapshot, parts: &ClusterParts, view: ClusterView) -> Snapshot {
        let moved = |(place, cluster): (usize, &ClusterBox)| {
            let offset = parts.offset_of_cluster(place, view.explode);
            ClusterBox { lower: cluster.lower + offset, upper: cluster.upper + offset, ..*cluster }
        };
        Snapshot {
            mesh: Arc::new(self.exploded(parts, view.explode)),
            vertex_radiosity: match view.coloured {
                true => self.colours(parts),
                false => self.of_source(&of.vertex_radiosity),
            },
            vertex_irradiance: self.of_source(&of.vertex_irradiance),
            clusters: Arc::new(of.clusters.iter().enumerate().map(moved).collect()),
            ..of.clone()
        }
    }
}

/// A snapshot as a view of its clusters shows it; `None` where it carries no solution view.
pub fn by_clusters(snapshot: &Snapshot, view: ClusterView) -> Option<Snapshot> {
    let solution_view = snapshot.solution_view.as_ref()?;
    let parts = ClusterParts::new(solution_view.hierarchy(), view.level);
    Some(ApartMesh::new(&snapshot.mesh, &parts).snapshot(snapshot, &parts, view))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::render::{Camera, Display, Offscreen, Overlay, auto_exposure};
    use crate::scene::Scene;
    use crate::scene::builtin::BuiltinScene;
    use crate::solve::{ClusteringMode, Solver, SolverParams};

    fn solved(name: &str, clustering: ClusteringMode) -> (Arc<Scene>, Snapshot) {
        let scene = Arc::new(BuiltinScene::from_name(name).expect("ours").build());
        let params = SolverParams { clustering, ..SolverParams::with_epsilon(3e-2) };
        let snapshot = Solver::solved(scene.clone(), params).snapshot();
        (scene, snapshot)
    }

    fn picture(scene: &Scene, snapshot: &Snapshot, as_colours: bool) -> image::RgbaImage {
        let camera = Camera::of_scene(scene, 1.5);
        let display = Display { exposure: auto_exposure(snapshot), as_colours, ..Display::default() };
        let mut offscreen = Offscreen::new().expect("an adapter is there");
        offscreen.picture(snapshot, &camera, &display, &Overlay::default(), [180, 120]).expect("it can be drawn")
    }

    /// Truth: the plain picture, pixel by pixel.
    #[test]
    fn at_rest_it_is_the_plain_picture_and_pulled_apart_it_is_not() {
        let (scene, snapshot) = solved("cornell", ClusteringMode::Adaptive);
        let plain = picture(&scene, &snapshot, false);
        let view = ClusterView { level: 2, explode: 0.0, coloured: false };
        let at_rest = by_clusters(&snapshot, view).expect("it carries its solution view");
        assert!(at_rest.mesh.positions.len() >= snapshot.mesh.positions.len());
        assert!(picture(&scene, &at_rest, false) == plain, "at rest it differs");
        for other in [ClusterView { explode: 0.3, ..view }, ClusterView { coloured: true, ..view }] {
            let shown = by_clusters(&snapshot, other).expect("it carries its solution view");
            assert!(picture(&scene, &shown, other.coloured) != plain, "{other:?} shows nothing");
        }
        let dark = Snapshot { solution_view: None, ..snapshot };
        assert!(by_clusters(&dark, view).is_none());
    }

    /// Volume that two boxes share.
    fn overlap(one: &ClusterBox, other: &ClusterBox) -> f64 {
        let extent = one.upper.min(other.upper) - one.lower.max(other.lower);
        if extent.min_element() <= 0.0 { 0.0 } else { extent.as_dvec3().element_product() }
    }

    /// Truth: centres that move apart along every axis share no more of their boxes than before;
    /// sizes stay.
    #[test]
    fn boxes_of_a_level_overlap_no_more_than_before() {
        let (_, snapshot) = solved("seminar", ClusteringMode::Adaptive);
        for level in [1, 3, 5] {
            let of_level = |snapshot: &Snapshot| -> Vec<ClusterBox> {
                snapshot.clusters.iter().filter(|cluster| cluster.level == level).copied().collect()
            };
            let before = of_level(&snapshot);
            let view = ClusterView { level, explode: 0.8, coloured: true };
            let after = of_level(&by_clusters(&snapshot, view).expect("it carries its solution view"));
            let moved = before.iter().zip(&after).any(|(before, after)| before.lower.distance(after.lower) > 0.1);
            assert!(moved && before.len() == after.len());
            for one in 0..before.len() {
                let size = |cluster: &ClusterBox| cluster.upper - cluster.lower;
                assert!(size(&before[one]).distance(size(&after[one])) < 1e-4);
                for other in 0..one {
                    let (was, is) = (overlap(&before[one], &before[other]), overlap(&after[one], &after[other]));
                    assert!(is <= was + 1e-5, "{one} and {other} of level {level} share {is} instead of {was}");
                }
            }
        }
    }

    /// Truth: the hierarchy. Surfaces of a cluster move as one and look alike; its siblings have
    /// other colours.
    #[test]
    fn a_cluster_moves_as_one_and_has_one_colour() {
        let (_, snapshot) = solved("cornell", ClusteringMode::Groups);
        let solution_view = snapshot.solution_view.as_ref().expect("it was asked for");
        let hierarchy = solution_view.hierarchy();
        let parts = ClusterParts::new(hierarchy, 1);
        let mut colours = Vec::new();
        for child in hierarchy.element(Hierarchy::ROOT).children() {
            let element = hierarchy.element(child);
            let way = element.centre - hierarchy.element(Hierarchy::ROOT).centre;
            assert_eq!(parts.offset_of(hierarchy, child, 0.5), 0.5 * way);
            let Shape::Cluster(cluster) = &element.shape else { continue };
            let polygons = hierarchy.patches_below(cluster).iter().map(|id| match &hierarchy.element(*id).shape {
                Shape::Patch(patch) => patch.polygon,
                Shape::Cluster(_) | Shape::Sky(_) => panic!("an initial patch is a patch"),
            });
            let polygons: Vec<u32> = polygons.collect();
            assert!(polygons.iter().all(|polygon| parts.offset_of_polygon(*polygon, 0.5) == 0.5 * way));
            let colour = parts.colour_of_polygon(polygons[0]);
            assert!(polygons.iter().all(|polygon| parts.colour_of_polygon(*polygon) == colour));
            assert!(!colours.contains(&colour) && colour != AT_ROOT);
            colours.push(colour);
        }
        assert!(colours.len() >= 3, "{colours:?}");
        assert_eq!(cluster_colours(hierarchy), cluster_colours(&hierarchy.clone()), "colours stay");
    }

    /// Outlines of a mesh that was cut are those of its leaves.
    #[test]
    fn outlines_follow_the_surfaces() {
        let (_, snapshot) = solved("cornell", ClusteringMode::Adaptive);
        let view = ClusterView { level: 2, explode: 0.0, coloured: false };
        let cut = by_clusters(&snapshot, view).expect("it carries its solution view");
        let ends = |mesh: &Mesh| {
            let point = |vertex: u32| mesh.positions[vertex as usize].map(f32::to_bits);
            let mut ends: Vec<_> = mesh.outlines.iter().map(|[a, b]| (point(*a), point(*b))).collect();
            ends.sort_unstable();
            ends
        };
        assert_eq!(ends(&cut.mesh), ends(&snapshot.mesh));
    }
}
