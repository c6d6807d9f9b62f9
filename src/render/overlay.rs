//! Drawings over the picture: outlines of the leaves, boxes of clusters, and marks: links and
//! whatever else a view points at.

use std::sync::Arc;

use glam::Vec3;

use super::outline::{box_edges, element_outline};
use crate::hierarchy::ElementId;
use crate::read::ramp::{VIRIDIS, along_ramp};
use crate::solve::snapshot::{ClusterBox, Mesh};
use crate::transport::SolutionView;

/// Drawings over a picture.
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
/// The picked element, among its links and without them: a quiet line around what is read.
const PICKED: ([u8; 4], f32) = ([255, 255, 255, 255], 2.5);
const PICKED_QUIETLY: ([u8; 4], f32) = ([255, 255, 255, 215], 1.5);
/// Diameter of the dot at its centre.
const PICKED_DOT: f32 = 10.0;
/// Links weaker than this share of the strongest have the ramp's first colour.
const WEAKEST_SHARE: f32 = 1e-3;

/// Colour of a link: `share` is its power over that of the strongest link drawn, on a logarithmic
/// scale over three decades. Gamma-encoded.
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
    of_level
        .flat_map(|cluster| {
            box_edges(cluster.lower, cluster.upper).map(|[from, to]| Line::new(from, to, width, colour))
        })
        .collect()
}

/// The rim of a picked leaf, from the mesh alone: edges that only one of its triangles has.
pub fn picked_leaf(mesh: &Mesh, element: ElementId) -> Vec<Line> {
    let Some(leaf) = mesh.leaves.iter().position(|leaf| leaf.element == element) else { return Vec::new() };
    let of_leaf = mesh.triangles.iter().zip(&mesh.triangle_leaf).filter(|(_, of)| **of as usize == leaf);
    let mut edges: Vec<[u32; 2]> =
        of_leaf.flat_map(|(&[a, b, c], _)| [[a, b], [b, c], [c, a]].map(|[a, b]| [a.min(b), a.max(b)])).collect();
    edges.sort_unstable();
    let rim = edges.chunk_by(PartialEq::eq).filter(|same| same.len() == 1).map(|same| same[0]);
    quietly(rim.map(|ends| ends.map(|vertex| Vec3::from(mesh.positions[vertex as usize]))))
}

/// The picked element without its links: its rim or box.
pub fn picked_rim(solution_view: &SolutionView, element: ElementId) -> Vec<Line> {
    quietly(element_outline(solution_view.hierarchy(), element).into_iter())
}

fn quietly(rim: impl Iterator<Item = [Vec3; 2]>) -> Vec<Line> {
    let (colour, width) = PICKED_QUIETLY;
    rim.map(|[from, to]| Line::new(from, to, width, colour)).collect()
}

/// The picked element among its links: its rim or box, and its centre.
pub fn picked_marks(solution_view: &SolutionView, element: ElementId) -> Vec<Line> {
    let (colour, width) = PICKED;
    let rim = element_outline(solution_view.hierarchy(), element).into_iter();
    let mut lines: Vec<Line> = rim.map(|[from, to]| Line::new(from, to, width, colour)).collect();
    lines.push(Line::dot(solution_view.hierarchy().element(element).centre, PICKED_DOT, colour));
    lines
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::solve::snapshot::Leaf;

    fn two_leaves() -> Mesh {
        let leaf = |element| Leaf::square_metre(element, 0);
        Mesh {
            positions: vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0], [2.0, 0.0, 0.0]],
            triangles: vec![[0, 1, 2], [0, 2, 3], [1, 4, 2]],
            triangle_leaf: vec![0, 0, 1],
            outlines: vec![[0, 1], [1, 2], [2, 3], [3, 0], [1, 4], [4, 2]],
            leaves: vec![leaf(7), leaf(9)],
        }
    }

    #[test]
    fn outlines_become_one_line_each() {
        let lines = element_outlines(&two_leaves());
        assert_eq!(lines.len(), 6);
        assert_eq!((lines[4].from, lines[4].to), ([1.0, 0.0, 0.0], [2.0, 0.0, 0.0]));
    }

    /// Truth: the mesh by hand: a square of two triangles has four sides, and not their common one.
    #[test]
    fn the_rim_of_a_leaf_leaves_its_inner_edges_out() {
        let mesh = two_leaves();
        let ends = |element| -> Vec<_> {
            picked_leaf(&mesh, ElementId(element)).iter().map(|line| (line.from, line.to)).collect()
        };
        assert_eq!([7, 9, 1].map(|element| ends(element).len()), [4, 3, 0]);
        assert!(!ends(7).contains(&([0.0, 0.0, 0.0], [1.0, 1.0, 0.0])));
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
    fn the_ramp_runs_over_three_decades_from_violet_to_yellow() {
        assert_eq!(power_colour(1.0), [253, 231, 37]);
        assert_eq!(power_colour(1e-3), [68, 1, 84]);
        assert_eq!(power_colour(0.0), [68, 1, 84]);
        let greens: Vec<u8> = (0..30).map(|step| power_colour(10f32.powf(-0.1 * step as f32))[1]).collect();
        assert!(greens.is_sorted_by(|a, b| a > b), "{greens:?}");
    }
}
