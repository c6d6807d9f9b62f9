//! Points on elements: area-weighted over a cluster's polygons, uniform on a patch.

use glam::Vec3;

use super::{Cluster, Element, ElementId, Hierarchy, Shape};
use crate::geometry::quarter;

/// Running sums over the initial patches, in the order of [`Hierarchy::initial_patches`]: what
/// points are spread by.
#[derive(Clone, Debug)]
pub struct PatchSums(Vec<f64>);

impl Default for PatchSums {
    fn default() -> Self {
        Self(vec![0.0])
    }
}

impl PatchSums {
    /// Sums up a value of each initial patch.
    pub fn new(values: impl IntoIterator<Item = f64>) -> Self {
        let mut sums = Self::default();
        values.into_iter().for_each(|value| sums.push(value));
        sums
    }

    /// Adds the value of the next patch.
    pub(super) fn push(&mut self, value: f64) {
        self.0.push(self.0[self.0.len() - 1] + value);
    }

    /// Memory, bytes.
    pub fn bytes(&self) -> usize {
        size_of_val(&self.0[..])
    }

    /// The sum over a cluster's patches; 0 for a patch.
    pub fn of(&self, hierarchy: &Hierarchy, id: ElementId) -> f64 {
        match &hierarchy.element(id).shape {
            Shape::Cluster(cluster) => self.over(cluster),
            Shape::Patch(_) | Shape::Sky(_) => 0.0,
        }
    }

    /// The sum over a cluster's patches.
    pub fn over(&self, cluster: &Cluster) -> f64 {
        let first = cluster.first_patch as usize;
        self.0[first + cluster.patch_count as usize] - self.0[first]
    }

    /// The place of the patch of a cluster that holds the share `u` of its sum, and how far into
    /// that patch it is, 0..=1.
    fn locate(&self, cluster: &Cluster, u: f32) -> (usize, f32) {
        let first = cluster.first_patch as usize;
        let last = first + cluster.patch_count as usize;
        let (start, end) = (self.0[first], self.0[last]);
        let wanted = start + f64::from(u) * (end - start);
        let index = first + self.0[first + 1..last].partition_point(|&sum| sum <= wanted);
        let (before, after) = (self.0[index], self.0[index + 1]);
        let rest = if after > before { (wanted - before) / (after - before) } else { 0.5 };
        (index, (rest as f32).clamp(0.0, 1.0))
    }
}

/// A point on a bright side.
#[derive(Clone, Copy, Debug)]
pub struct SurfacePoint {
    /// Position.
    pub position: Vec3,
    /// Unit normal of the bright side.
    pub normal: Vec3,
    /// Index of the scene's polygon.
    pub polygon: u32,
}

impl Hierarchy {
    /// The point of an element at `(u, v)` in the unit square; equal areas of the square are equal
    /// areas of the element.
    #[inline]
    pub fn point_on(&self, id: ElementId, u: f32, v: f32) -> SurfacePoint {
        self.point_on_by(&self.area_sums, id, u, v)
    }

    /// A point of an element where a cluster's points are spread over its patches by their share of
    /// `sums` instead of their area.
    #[inline]
    pub fn point_on_by(&self, sums: &PatchSums, id: ElementId, u: f32, v: f32) -> SurfacePoint {
        match &self.element(id).shape {
            Shape::Patch(_) => self.point_on_patch(id, u, v),
            Shape::Sky(_) => unreachable!("what lies outside has no points"),
            Shape::Cluster(cluster) => {
                let (index, rest) = sums.locate(cluster, u);
                self.point_on_patch(self.initial_patches[index], rest, v)
            }
        }
    }

    /// The points of an element, a cluster's by these sums or by area.
    pub fn points_on<'a>(&'a self, sums: Option<&'a PatchSums>, id: ElementId) -> ElementPoints<'a> {
        let element = self.element(id);
        let open = match &element.shape {
            Shape::Patch(patch) if patch.cells.are_all_reachable() => {
                let (corners, count) = self.corner_positions(patch);
                let point = SurfacePoint { position: corners[0], normal: patch.normal, polygon: patch.polygon };
                Some((PolygonMap::new(&corners[..count]), point))
            }
            _ => None,
        };
        ElementPoints { hierarchy: self, sums: sums.unwrap_or(&self.area_sums), id, open }
    }

    /// The point of a patch; where it is hidden in part, found by going down to a leaf, or to a
    /// part that is not.
    fn point_on_patch(&self, mut id: ElementId, mut u: f32, v: f32) -> SurfacePoint {
        loop {
            let element = self.element(id);
            let Shape::Patch(patch) = &element.shape else { unreachable!("below a patch there are patches") };
            let is_open = patch.cells.are_all_reachable();
            if is_open || element.is_leaf() {
                let (mut corners, count) = self.corner_positions(patch);
                if !is_open && let Some((quarters, rest)) = self.reachability.sampled_cell(patch.cells, u) {
                    corners = quarters.fold(corners, |corners, number| quarter(corners, count, number));
                    u = rest;
                }
                let position = point_on_polygon(&corners[..count], u, v);
                return SurfacePoint { position, normal: patch.normal, polygon: patch.polygon };
            }
            let child = self.quarter_by_area(element, &mut u);
            id = ElementId(element.first_child + child);
        }
    }
}

impl Hierarchy {
    /// The quarter of a patch hidden in part at `u` of its sampled area; spreads that quarter's
    /// share over the unit interval.
    fn quarter_by_area(&self, element: &Element, u: &mut f32) -> u32 {
        let areas = [0, 1, 2, 3].map(|child| self.elements[element.first_child as usize + child].sampled_area);
        let mut rest = *u * areas.iter().sum::<f32>();
        let last = areas.iter().rposition(|area| *area > 0.0).unwrap_or(0);
        let mut child = 0;
        while child < last && rest >= areas[child] {
            rest -= areas[child];
            child += 1;
        }
        *u = if areas[child] > 0.0 { (rest / areas[child]).clamp(0.0, 1.0) } else { 0.5 };
        child as u32
    }
}

/// The point of a triangle or convex quad at `(u, v)`, uniform by area.
pub fn point_on_polygon(corners: &[Vec3], u: f32, v: f32) -> Vec3 {
    PolygonMap::new(corners).at(u, v)
}

/// Sides of a parallelogram may differ by this share of its diagonal: what rounding does to the
/// corners of all but the smallest.
const MOST_SKEWED: f32 = 1e-5;

/// The unit square on a triangle or convex quad, equal areas on equal areas.
#[derive(Clone, Copy)]
struct PolygonMap {
    corners: [Vec3; 4],
    form: Form,
}

#[derive(Clone, Copy)]
enum Form {
    Triangle,
    /// Keeps the stratification of the square.
    Parallelogram,
    /// Two triangles, the first of which has this share of the area.
    Quad(f32),
}

impl PolygonMap {
    fn new(corners: &[Vec3]) -> Self {
        match *corners {
            [a, b, c] => Self { corners: [a, b, c, a], form: Form::Triangle },
            [a, b, c, d] => {
                let is_parallelogram =
                    ((b - a) - (c - d)).length_squared() < MOST_SKEWED * MOST_SKEWED * (c - a).length_squared();
                let form = if is_parallelogram {
                    Form::Parallelogram
                } else {
                    let (first, second) = ((b - a).cross(c - a).length(), (c - a).cross(d - a).length());
                    Form::Quad(first / (first + second))
                };
                Self { corners: [a, b, c, d], form }
            }
            _ => unreachable!("a patch has three or four corners"),
        }
    }

    fn at(&self, u: f32, v: f32) -> Vec3 {
        let [a, b, c, d] = self.corners;
        match self.form {
            Form::Triangle => point_on_triangle(a, b, c, u, v),
            Form::Parallelogram => a + u * (b - a) + v * (d - a),
            Form::Quad(share) if u < share => point_on_triangle(a, b, c, u / share, v),
            Form::Quad(share) => point_on_triangle(a, c, d, (u - share) / (1.0 - share), v),
        }
    }
}

/// Points of one element: [`Hierarchy::point_on`] for whoever asks for many.
pub struct ElementPoints<'a> {
    hierarchy: &'a Hierarchy,
    sums: &'a PatchSums,
    id: ElementId,
    /// A patch that is not hidden anywhere, with a point of it.
    open: Option<(PolygonMap, SurfacePoint)>,
}

impl ElementPoints<'_> {
    /// The point at `(u, v)` in the unit square.
    #[inline]
    pub fn at(&self, u: f32, v: f32) -> SurfacePoint {
        match &self.open {
            Some((map, point)) => SurfacePoint { position: map.at(u, v), ..*point },
            None => self.hierarchy.point_on_by(self.sums, self.id, u, v),
        }
    }
}

fn point_on_triangle(a: Vec3, b: Vec3, c: Vec3, u: f32, v: f32) -> Vec3 {
    let root = u.max(0.0).sqrt();
    a + root * ((1.0 - v) * (b - a) + v * (c - a))
}
