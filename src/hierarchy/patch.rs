//! Patches: planar triangles and quads, and their split into four.

use glam::Vec3;

use crate::geometry::Cells;

use super::{Element, ElementId, Hierarchy, NO_PARENT, Shape};

/// Marks the absent fourth corner of a triangle.
const NO_CORNER: u32 = u32::MAX;

/// A triangle or quad with one bright side.
#[derive(Clone, Copy, Debug)]
pub struct Patch {
    /// Corners in [`Hierarchy::vertices`], anticlockwise from the bright side; the fourth is absent
    /// in a triangle.
    corners: [u32; 4],
    /// Unit normal of the bright side.
    pub normal: Vec3,
    /// Index of the scene's polygon.
    pub polygon: u32,
    /// Subdivision level; initial patches have level 0.
    pub level: u8,
    /// Which parts of it are hidden.
    pub(super) cells: Cells,
}

impl Patch {
    /// Whether a part of it is hidden, as far as is known.
    pub fn is_hidden_in_part(&self) -> bool {
        !self.cells.are_all_reachable()
    }

    /// A patch over three or four vertices; the normal is set by [`Hierarchy::patch_element`].
    pub(super) fn new(corners: &[u32], polygon: u32, level: u8, cells: Cells) -> Self {
        let mut padded = [NO_CORNER; 4];
        padded[..corners.len()].copy_from_slice(corners);
        Self { corners: padded, normal: Vec3::ZERO, polygon, level, cells }
    }

    /// The three or four corners.
    #[inline]
    pub fn corners(&self) -> &[u32] {
        if self.corners[3] == NO_CORNER { &self.corners[..3] } else { &self.corners }
    }
}

/// Area vector of a polygon with three or four corners: normal times area.
pub(super) fn area_vector(corners: &[Vec3]) -> Vec3 {
    match *corners {
        [a, b, c] => 0.5 * (b - a).cross(c - a),
        [a, b, c, d] => 0.5 * (c - a).cross(d - b),
        _ => Vec3::ZERO,
    }
}

/// Centroid of a polygon with three or four corners.
fn centroid(corners: &[Vec3]) -> Vec3 {
    match *corners {
        [a, b, c] => (a + b + c) / 3.0,
        [a, b, c, d] => {
            let (first, second) = ((b - a).cross(c - a).length(), (c - a).cross(d - a).length());
            let total = first + second;
            let share = if total > 0.0 { second / total } else { 0.5 };
            (a + c + (1.0 - share) * b + share * d) / 3.0
        }
        _ => Vec3::ZERO,
    }
}

impl Hierarchy {
    /// Corner positions of a patch in the first `count` places.
    #[inline]
    pub fn corner_positions(&self, patch: &Patch) -> ([Vec3; 4], usize) {
        let mut positions = [Vec3::ZERO; 4];
        let corners = patch.corners();
        for (position, &corner) in positions.iter_mut().zip(corners) {
            *position = self.vertices[corner as usize];
        }
        (positions, corners.len())
    }

    /// An element without relatives for a patch, with normal, area and centroid filled in.
    pub(super) fn patch_element(&self, mut patch: Patch, key: u64) -> Element {
        let (positions, count) = self.corner_positions(&patch);
        let area_vector = area_vector(&positions[..count]);
        patch.normal = area_vector.normalize_or_zero();
        let shares = self.reachability.shares(patch.cells);
        Element {
            parent: NO_PARENT,
            first_child: 0,
            child_count: 0,
            area: area_vector.length() * shares.reachable,
            sampled_area: area_vector.length() * shares.sampled,
            centre: centroid(&positions[..count]),
            key,
            shape: Shape::Patch(patch),
        }
    }

    /// Area of a patch with what is hidden of it, m²; its element's is without.
    pub fn whole_area(&self, element: &Element, patch: &Patch) -> f32 {
        if patch.cells.are_all_reachable() {
            return element.area;
        }
        let (positions, count) = self.corner_positions(patch);
        area_vector(&positions[..count]).length()
    }

    /// How much of a patch is reachable near one of its corners, 0..=1.
    pub fn reachable_at_corner(&self, patch: &Patch, corner: usize) -> f32 {
        self.reachability.share_at_corner(patch.cells, corner as u32)
    }

    /// The four quarters of a patch, as if nothing of them were hidden; new vertices in the middle
    /// of edges are shared with the neighbours.
    pub(super) fn quarters(&mut self, patch: &Patch) -> [Patch; 4] {
        let quarter = |corners: &[u32]| Patch::new(corners, patch.polygon, patch.level + 1, Cells::default());
        match *patch.corners() {
            [a, b, c] => {
                let (ab, bc, ca) = (self.split_edge(a, b), self.split_edge(b, c), self.split_edge(c, a));
                [quarter(&[a, ab, ca]), quarter(&[ab, b, bc]), quarter(&[ca, bc, c]), quarter(&[bc, ca, ab])]
            }
            [a, b, c, d] => {
                let (ab, bc) = (self.split_edge(a, b), self.split_edge(b, c));
                let (cd, da) = (self.split_edge(c, d), self.split_edge(d, a));
                let centre = self.vertices.len() as u32;
                let position = [a, b, c, d].iter().map(|&corner| self.vertices[corner as usize]).sum::<Vec3>() / 4.0;
                self.vertices.push(position);
                [
                    quarter(&[a, ab, centre, da]),
                    quarter(&[ab, b, bc, centre]),
                    quarter(&[centre, bc, c, cd]),
                    quarter(&[da, centre, cd, d]),
                ]
            }
            _ => unreachable!("a patch has three or four corners"),
        }
    }

    fn split_edge(&mut self, a: u32, b: u32) -> u32 {
        let vertices = &mut self.vertices;
        *self.midpoints.entry((a.min(b), a.max(b))).or_insert_with(|| {
            let middle = 0.5 * (vertices[a as usize] + vertices[b as usize]);
            vertices.push(middle);
            vertices.len() as u32 - 1
        })
    }

    /// The leaf below (or at) a patch that holds a point of its plane.
    pub fn leaf_at(&self, mut id: ElementId, point: Vec3) -> ElementId {
        loop {
            let element = self.element(id);
            let Shape::Patch(patch) = &element.shape else { return id };
            if element.is_leaf() {
                return id;
            }
            let (positions, count) = self.corner_positions(patch);
            let is_left = |from: Vec3, to: Vec3| (to - from).cross(point - from).dot(patch.normal) > 0.0;
            let middle = |first: usize, second: usize| 0.5 * (positions[first] + positions[second]);
            let child = if count == 4 {
                // The lines between the middles of opposite sides cross in the quarters' common
                // corner.
                let (is_left, is_upper) = (is_left(middle(0, 1), middle(2, 3)), is_left(middle(3, 0), middle(1, 2)));
                match (is_left, is_upper) {
                    (true, false) => 0,
                    (false, false) => 1,
                    (false, true) => 2,
                    (true, true) => 3,
                }
            } else {
                let (ab, bc, ca) = (middle(0, 1), middle(1, 2), middle(2, 0));
                match (is_left(ca, ab), is_left(ab, bc), is_left(bc, ca)) {
                    (false, ..) => 0,
                    (_, false, _) => 1,
                    (.., false) => 2,
                    _ => 3,
                }
            };
            id = ElementId(element.first_child + child);
        }
    }

    /// The leaf patches below (or at) a patch, in order.
    pub fn leaves_below(&self, id: ElementId, visit: &mut impl FnMut(ElementId)) {
        if self.element(id).is_leaf() {
            visit(id);
        } else {
            self.element(id).children().for_each(|child| self.leaves_below(child, visit));
        }
    }
}
