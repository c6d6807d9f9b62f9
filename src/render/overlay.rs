//! What is drawn over the picture: outlines of the leaves, boxes of clusters, and marks: links and whatever else a view points at.

use std::sync::Arc;

use glam::Vec3;
use rustc_hash::FxHashMap;

use super::ramp::{VIRIDIS, along_ramp};
use crate::hierarchy::ElementId;
use crate::solver::LinkView;
use crate::solver::snapshot::{ClusterBox, Mesh, Snapshot};

/// What to draw over the picture.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Overlay {
    /// Outlines of all leaves.
    pub elements: bool,
    /// Boxes of the clusters of this level, the root being level 0.
    pub clusters: Option<u16>,
    /// Lines over everything, faint where surfaces hide them, in the order in which they are drawn.
    pub marks: Marks,
}

/// Lines that are shared with whoever made them; two are the same if they are one.
#[derive(Clone, Debug, Default)]
pub struct Marks(pub Option<Arc<Vec<Line>>>);

impl PartialEq for Marks {
    fn eq(&self, other: &Self) -> bool {
        match (&self.0, &other.0) {
            (Some(one), Some(other)) => Arc::ptr_eq(one, other),
            (one, other) => one.is_none() && other.is_none(),
        }
    }
}

impl From<Vec<Line>> for Marks {
    fn from(lines: Vec<Line>) -> Self {
        Self((!lines.is_empty()).then(|| Arc::new(lines)))
    }
}

/// As many links as can still be told apart.
pub const USUAL_LINKS: usize = 200;

/// A straight line of constant width on the screen; with both ends in one place, a round dot.
#[derive(Clone, Copy, Debug, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct Line {
    /// One end, in the scene's unit.
    pub from: [f32; 3],
    /// The other end.
    pub to: [f32; 3],
    /// Width, pixels.
    pub width: f32,
    /// Gamma-encoded colour and opacity.
    pub colour: [u8; 4],
}

impl Line {
    /// A line.
    pub fn new(from: Vec3, to: Vec3, width: f32, colour: [u8; 4]) -> Self {
        Self { from: from.into(), to: to.into(), width, colour }
    }

    /// A round dot.
    pub fn dot(at: Vec3, width: f32, colour: [u8; 4]) -> Self {
        Self::new(at, at, width, colour)
    }
}

/// Outlines of leaves: pale enough for shadows, blue enough for white walls.
const OUTLINE: ([u8; 4], f32) = ([70, 130, 220, 190], 1.2);
/// Boxes of clusters.
const CLUSTER: ([u8; 4], f32) = ([255, 176, 0, 220], 1.5);
/// The picked element.
const PICKED: ([u8; 4], f32) = ([255, 255, 255, 255], 2.5);
/// Width of a link, pixels, and diameter of the dots at its ends.
const LINK_WIDTH: f32 = 2.0;
const SOURCE_DOT: f32 = 6.0;
const CLUSTER_DOT: f32 = 9.0;
const PICKED_DOT: f32 = 10.0;
/// Links weaker than this share of the strongest have the ramp's first colour.
const WEAKEST_SHARE: f32 = 1e-3;

/// Colour of a link: `share` is its power over that of the strongest link drawn, on a logarithmic scale over three decades.
/// Gamma-encoded.
pub fn power_colour(share: f32) -> [u8; 3] {
    let decades = WEAKEST_SHARE.log10();
    let along = if share > 0.0 { 1.0 - share.log10() / decades } else { 0.0 };
    along_ramp(&VIRIDIS, along)
}

/// Outlines of all leaves.
pub(super) fn element_outlines(mesh: &Mesh) -> Vec<Line> {
    let (colour, width) = OUTLINE;
    let position = |vertex: u32| mesh.positions[vertex as usize];
    mesh.outlines.iter().map(|&[a, b]| Line { from: position(a), to: position(b), width, colour }).collect()
}

/// The twelve edges of each cluster's box of one level.
pub(super) fn cluster_boxes(clusters: &[ClusterBox], level: u16) -> Vec<Line> {
    let (colour, width) = CLUSTER;
    let of_level = clusters.iter().filter(|cluster| cluster.level == level);
    of_level.flat_map(|cluster| box_edges(cluster).map(|[from, to]| Line::new(from, to, width, colour))).collect()
}

/// The edges between corners of the box that differ in one coordinate.
fn box_edges(cluster: &ClusterBox) -> [[Vec3; 2]; 12] {
    let corner = |bits: usize| {
        let upper = glam::BVec3::new(bits & 1 != 0, bits & 2 != 0, bits & 4 != 0);
        Vec3::select(upper, cluster.upper, cluster.lower)
    };
    std::array::from_fn(|edge| {
        let (axis, rest) = (edge / 4, edge % 4);
        let low_bits = rest & ((1 << axis) - 1);
        let from = (rest - low_bits) << 1 | low_bits;
        [corner(from), corner(from | 1 << axis)]
    })
}

/// The strongest links that bring light to an element, so many at most, weakest first so that strong ones end on top, and the element
/// itself; empty where the snapshot carries no anatomy.
pub fn link_marks(snapshot: &Snapshot, element: ElementId, most: usize) -> Vec<Line> {
    let Some(anatomy) = snapshot.anatomy.as_ref().filter(|anatomy| anatomy.holds(element)) else { return Vec::new() };
    let mut lines = link_lines(&anatomy.incoming(element), most);
    let (colour, width) = PICKED;
    let rim = leaf_rim(&snapshot.mesh, element);
    lines.extend(rim.into_iter().map(|[from, to]| Line::new(from, to, width, colour)));
    lines.push(Line::dot(anatomy.hierarchy().element(element).centre, PICKED_DOT, colour));
    lines
}

fn link_lines(links: &[LinkView], most: usize) -> Vec<Line> {
    let strongest = &links[..most.min(links.len())];
    let most = strongest.iter().map(|link| link.power).fold(0.0, f32::max);
    let drawn = strongest.iter().rev().flat_map(|link| {
        let [r, g, b] = power_colour(if most > 0.0 { link.power / most } else { 0.0 });
        let colour = [r, g, b, 255];
        // A cluster receives and sends as a whole: its dot is larger.
        let dot = if link.source_is_cluster { CLUSTER_DOT } else { SOURCE_DOT };
        [
            Line::new(link.receiver_centre, link.source_centre, LINK_WIDTH, colour),
            Line::dot(link.source_centre, dot, colour),
        ]
    });
    drawn.collect()
}

/// The edges around a leaf: those that only one of its triangles has. Empty where the element is no leaf.
fn leaf_rim(mesh: &Mesh, element: ElementId) -> Vec<[Vec3; 2]> {
    let Some(leaf) = mesh.leaves.iter().position(|leaf| leaf.element == element) else { return Vec::new() };
    let triangles = mesh.triangles.iter().zip(&mesh.triangle_leaf).filter(|&(_, &of)| of as usize == leaf);
    let mut uses: FxHashMap<[u32; 2], u32> = FxHashMap::default();
    for (&[a, b, c], _) in triangles {
        for [from, to] in [[a, b], [b, c], [c, a]] {
            *uses.entry([from.min(to), from.max(to)]).or_default() += 1;
        }
    }
    let position = |vertex: u32| Vec3::from(mesh.positions[vertex as usize]);
    let mut edges: Vec<_> = uses.into_iter().filter(|&(_, count)| count == 1).map(|(edge, _)| edge).collect();
    edges.sort_unstable();
    edges.into_iter().map(|[a, b]| [position(a), position(b)]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::solver::Evidence;
    use crate::solver::snapshot::Leaf;

    fn two_leaves() -> Mesh {
        let leaf = |element| Leaf {
            element: ElementId(element),
            polygon: 0,
            material: crate::scene::MaterialId(0),
            area: 1.0,
            exposed_area: 1.0,
            level: 0,
        };
        Mesh {
            positions: vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0], [2.0, 0.0, 0.0]],
            triangles: vec![[0, 1, 2], [0, 2, 3], [1, 4, 2]],
            triangle_leaf: vec![0, 0, 1],
            outlines: vec![[0, 1], [1, 2], [2, 3], [3, 0], [1, 4], [4, 2]],
            leaves: vec![leaf(7), leaf(9)],
        }
    }

    fn link(power: f32, source_is_cluster: bool) -> LinkView {
        LinkView {
            receiver: ElementId(7),
            source: ElementId(9),
            receiver_centre: Vec3::ZERO,
            source_centre: Vec3::X * power,
            source_is_cluster,
            form_factor: 0.1,
            visibility: 1.0,
            evidence: Evidence::Inherited,
            power,
            levels_up: 0,
            receiver_is_cluster: false,
            irradiance: Vec3::ZERO,
        }
    }

    #[test]
    fn the_rim_of_a_quad_has_four_edges_without_its_diagonal() {
        let rim = leaf_rim(&two_leaves(), ElementId(7));
        assert_eq!(rim.len(), 4);
        assert!(rim.iter().all(|[a, b]| (a.distance(*b) - 1.0).abs() < 1e-6), "{rim:?}");
        assert_eq!(leaf_rim(&two_leaves(), ElementId(9)).len(), 3);
        assert!(leaf_rim(&two_leaves(), ElementId(1)).is_empty());
    }

    #[test]
    fn outlines_become_one_line_each() {
        let lines = element_outlines(&two_leaves());
        assert_eq!(lines.len(), 6);
        assert_eq!((lines[4].from, lines[4].to), ([1.0, 0.0, 0.0], [2.0, 0.0, 0.0]));
    }

    #[test]
    fn a_box_has_twelve_different_edges_four_along_each_axis() {
        let cluster = ClusterBox { lower: Vec3::ZERO, upper: Vec3::new(1.0, 2.0, 4.0), level: 3, polygons: 1 };
        assert!(cluster_boxes(&[cluster], 2).is_empty());
        let lines = cluster_boxes(&[cluster], 3);
        let spans: Vec<Vec3> = lines.iter().map(|line| Vec3::from(line.to) - Vec3::from(line.from)).collect();
        for axis in [Vec3::X, 2.0 * Vec3::Y, 4.0 * Vec3::Z] {
            assert_eq!(spans.iter().filter(|&&span| span == axis).count(), 4);
        }
        let mut starts: Vec<String> = lines.iter().map(|line| format!("{:?}", (line.from, line.to))).collect();
        starts.sort();
        starts.dedup();
        assert_eq!(starts.len(), 12);
    }

    #[test]
    fn only_the_strongest_links_are_drawn_and_the_strongest_last() {
        let links = [link(8.0, false), link(4.0, true), link(2.0, false)];
        let lines = link_lines(&links, 2);
        // Two links, each a line and the dot of its source.
        assert_eq!(lines.len(), 4);
        assert_eq!(lines[2].to, [8.0, 0.0, 0.0]);
        assert_eq!(lines[2].colour, [253, 231, 37, 255]);
        assert_eq!((lines[1].from, lines[1].width), (lines[1].to, CLUSTER_DOT));
    }

    #[test]
    fn the_ramp_runs_over_three_decades_from_violet_to_yellow() {
        assert_eq!(power_colour(1.0), [253, 231, 37]);
        assert_eq!(power_colour(1e-3), [68, 1, 84]);
        assert_eq!(power_colour(0.0), [68, 1, 84]);
        let greens: Vec<u8> = (0..30).map(|step| power_colour(10f32.powf(-0.1 * step as f32))[1]).collect();
        assert!(greens.is_sorted_by(|a, b| a > b), "{greens:?}");
    }
}
