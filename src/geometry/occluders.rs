//! Occluders: a ray BVH over the scene's faces, which stop light from either side.
//!
//! Where faces coincide, a ray meets the one that faces it: the walls of two rooms that share a
//! plane, or a face that a file lists once more, wound the other way.

use glam::{Vec3, Vec3A};
use rayon::prelude::*;

use super::offset::{Crossing, End, Triangle};
use super::wide_bvh::{Effort, LastStop, WideBvh};
use crate::scene::{Polygon, Scene};

/// Marks a triangle that is dark from behind.
const DARK: u32 = u32::MAX;

/// Where a ray first meets a face.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// Distance along the ray, in lengths of its direction.
    pub distance: f32,
    /// Index into [`Scene::polygons`]: the polygon that is bright on the side met, or a face met
    /// from its dark side.
    pub polygon: u32,
    /// Whether the side met is bright.
    pub front: bool,
    /// The point met, as near to its face as rounding allows.
    pub point: Vec3,
}

/// The faces of a scene in a BVH; a face that is bright on both sides is there once.
pub struct Occluders {
    bvh: WideBvh,
    polygon_of_triangle: Vec<u32>,
    /// The polygon that is bright behind each triangle, or [`DARK`]; empty where all are.
    behind_triangle: Vec<u32>,
    /// How far points of each triangle's polygon may lie off its plane, m; empty where all polygons
    /// are flat.
    slack: Vec<f32>,
}

/// A triangle of a scene.
struct Face {
    corners: [Vec3; 3],
    polygon: u32,
    behind: u32,
    slack: f32,
}

/// A face that a ray meets.
struct Met {
    triangle: Triangle,
    crossing: Crossing,
    tolerance: f32,
    index: usize,
}

impl std::fmt::Debug for Occluders {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Occluders").finish_non_exhaustive()
    }
}

impl Occluders {
    /// Builds the BVH over every face of the scene.
    pub fn new(scene: &Scene) -> Self {
        Self::of_scene(scene, Effort::Thorough)
    }

    /// Builds the BVH for no more than a few rays a face.
    pub(super) fn for_few_rays(scene: &Scene) -> Self {
        Self::of_scene(scene, Effort::Quick)
    }

    fn of_scene(scene: &Scene, effort: Effort) -> Self {
        let behind = second_sides(scene);
        let all = scene.polygons.par_iter().zip(behind).enumerate();
        let faces_of = |(index, (polygon, behind)): (usize, (&Polygon, Option<u32>))| {
            let ([a, b, c, d], count) = scene.corner_positions(polygon);
            let slack = if count == 4 { warp([a, b, c, d]) } else { 0.0 };
            let fan = [[a, b, c], [a, c, d]];
            let behind = behind.unwrap_or(DARK);
            // The second side of another stands for no face of its own.
            let count = if behind == index as u32 { 0 } else { count - 2 };
            let face = move |corners: [Vec3; 3]| Face { corners, polygon: index as u32, behind, slack };
            fan.into_iter().take(count).map(face)
        };
        Self::build(&all.flat_map_iter(faces_of).collect::<Vec<_>>(), effort)
    }

    /// Builds the BVH over triangles, anticlockwise from their bright side, each of which stands
    /// for a polygon of that number when a ray meets it.
    pub fn of_triangles(faces: &[([Vec3; 3], u32)]) -> Self {
        let face = |&(corners, polygon): &([Vec3; 3], u32)| Face { corners, polygon, behind: DARK, slack: 0.0 };
        Self::build(&faces.iter().map(face).collect::<Vec<_>>(), Effort::Thorough)
    }

    fn build(faces: &[Face], effort: Effort) -> Self {
        let corners: Vec<[Vec3A; 3]> = faces.par_iter().map(|face| face.corners.map(Vec3A::from)).collect();
        let (bvh, order) = WideBvh::new(&corners, effort);
        let order = || order.iter().map(|index| &faces[*index as usize]);
        let are_double = faces.iter().any(|face| face.behind != DARK);
        let are_warped = faces.iter().any(|face| face.slack > 0.0);
        Self {
            bvh,
            polygon_of_triangle: order().map(|face| face.polygon).collect(),
            behind_triangle: if are_double { order().map(|face| face.behind).collect() } else { Vec::new() },
            slack: if are_warped { order().map(|face| face.slack).collect() } else { Vec::new() },
        }
    }

    /// Memory, bytes.
    pub fn bytes(&self) -> usize {
        self.bvh.bytes()
            + size_of_val(&self.polygon_of_triangle[..])
            + size_of_val(&self.behind_triangle[..])
            + size_of_val(&self.slack[..])
    }

    /// Whether two points of faces, with the unit normals of their bright sides, face each other
    /// with nothing between them.
    #[inline]
    pub fn sees(&self, from: (Vec3, Vec3), to: (Vec3, Vec3)) -> bool {
        self.sees_after(&mut LastStop::default(), from, to)
    }

    /// Whether two points of faces see each other, as [`Self::sees`]; quicker after other rays that
    /// are likely to have been stopped by the same faces.
    #[inline]
    pub fn sees_after(&self, last: &mut LastStop, from: (Vec3, Vec3), to: (Vec3, Vec3)) -> bool {
        let span = to.0 - from.0;
        if !(from.1.dot(span) > 0.0 && to.1.dot(span) < 0.0) {
            return false;
        }
        let [start, end] = [from.0, to.0].map(Vec3A::from);
        let span = end - start;
        let length = span.length();
        let away = without_negative_zeros(span / length);
        let start = End { point: start, normal: from.1.into(), away };
        let end = End { point: end, normal: to.1.into(), away: -away };
        !self.is_blocked((start.point, away, length), last, |triangle, index, crossing| {
            self.is_held(&start, triangle, index, crossing) || self.is_held(&end, triangle, index, crossing)
        })
    }

    /// Whether a face lies between two points in the air.
    pub fn occluded(&self, from: Vec3, to: Vec3) -> bool {
        let [start, end] = [from, to].map(Vec3A::from);
        let length = start.distance(end);
        let ray = (start, without_negative_zeros((end - start) / length), length);
        length > 0.0 && self.is_blocked(ray, &mut LastStop::default(), |_, _, _| false)
    }

    /// Whether a ray that leaves a face meets no other: by a point of it and its unit normal on the
    /// side that the ray leaves; `direction` must be a unit vector.
    #[inline]
    pub fn is_open(&self, point: Vec3, normal: Vec3, direction: Vec3) -> bool {
        let away = without_negative_zeros(direction.into());
        let start = End { point: point.into(), normal: normal.into(), away };
        !self.is_blocked((start.point, away, f32::INFINITY), &mut LastStop::default(), |triangle, index, crossing| {
            self.is_held(&start, triangle, index, crossing)
        })
    }

    #[inline]
    fn is_blocked(
        &self,
        ray: (Vec3A, Vec3A, f32),
        last: &mut LastStop,
        passes: impl Fn(&Triangle, usize, &Crossing) -> bool,
    ) -> bool {
        let (start, direction, length) = ray;
        self.bvh.is_stopped(ray, last, |triangle, index| {
            let is_between =
                |met: &Crossing| met.distance >= 0.0 && met.distance <= length && !passes(triangle, index, met);
            Crossing::of(triangle, start, direction).is_some_and(|met| is_between(&met))
        })
    }

    /// The first face along a ray that leaves a face, by a point of it and its unit normal on the
    /// side that the ray leaves; `direction` must be a unit vector.
    #[inline]
    pub fn ray_from(&self, point: Vec3, normal: Vec3, direction: Vec3) -> Option<Hit> {
        let away = without_negative_zeros(direction.into());
        let end = End { point: point.into(), normal: normal.into(), away };
        self.closest(end.point, away, |triangle, index, crossing| self.is_held(&end, triangle, index, crossing))
    }

    /// The first face along a ray from a point in the air; `direction` must be a unit vector.
    pub fn first_hit(&self, origin: Vec3, direction: Vec3) -> Option<Hit> {
        let direction = without_negative_zeros(direction.into());
        self.closest(origin.into(), direction, |_, _, _| false)
    }

    /// The first bright side along a ray from a point in the air, as a picture shows it: dark sides
    /// are looked through.
    pub fn first_front(&self, origin: Vec3, direction: Vec3) -> Option<Hit> {
        let direction = without_negative_zeros(direction.into());
        self.closest(origin.into(), direction, |_, index, crossing| !self.is_bright(index, crossing))
    }

    /// The nearest face that is not passed over; of faces that coincide, one that faces the ray.
    #[inline]
    fn closest(
        &self,
        origin: Vec3A,
        direction: Vec3A,
        passes: impl Fn(&Triangle, usize, &Crossing) -> bool,
    ) -> Option<Hit> {
        let (mut bright, mut dark): (Option<Met>, Option<Met>) = (None, None);
        self.bvh.walk(origin, direction, |triangle, index| {
            let crossing = Crossing::of(triangle, origin, direction).filter(|crossing| crossing.distance >= 0.0);
            let Some(crossing) = crossing else { return f32::INFINITY };
            let nearest = if self.is_bright(index, &crossing) { &mut bright } else { &mut dark };
            let is_nearer = nearest.as_ref().is_none_or(|met| crossing.distance < met.crossing.distance);
            if !is_nearer || passes(triangle, index, &crossing) {
                return f32::INFINITY;
            }
            let tolerance = crossing.tolerance(triangle, origin, self.slack_of(index));
            *nearest = Some(Met { triangle: *triangle, crossing, tolerance, index });
            // Its twin may seem to lie behind it.
            crossing.distance + 2.0 * tolerance
        });
        let met = match (bright, dark) {
            (Some(bright), Some(dark)) => {
                let is_twin = || {
                    bright.crossing.distance - dark.crossing.distance <= bright.tolerance + dark.tolerance
                        && bright.crossing.is_opposite(&dark.crossing)
                };
                if bright.crossing.distance <= dark.crossing.distance || is_twin() { bright } else { dark }
            }
            (bright, dark) => bright.or(dark)?,
        };
        Some(self.hit(&met))
    }

    fn hit(&self, Met { triangle, crossing, index, .. }: &Met) -> Hit {
        let [u, v] = crossing.weights;
        let is_behind = crossing.descent >= 0.0;
        let polygon = match self.behind_triangle.get(*index) {
            Some(&behind) if is_behind && behind != DARK => behind,
            _ => self.polygon_of_triangle[*index],
        };
        Hit {
            distance: crossing.distance,
            polygon,
            front: self.is_bright(*index, crossing),
            point: (triangle.corner - u * triangle.first + v * triangle.last).into(),
        }
    }

    #[inline]
    fn is_held(&self, end: &End, triangle: &Triangle, index: usize, crossing: &Crossing) -> bool {
        end.holds(triangle, crossing, self.slack_of(index))
    }

    /// Whether a triangle is bright on the side met.
    fn is_bright(&self, index: usize, crossing: &Crossing) -> bool {
        crossing.descent < 0.0 || self.behind_triangle.get(index).is_some_and(|behind| *behind != DARK)
    }

    fn slack_of(&self, index: usize) -> f32 {
        self.slack.get(index).copied().unwrap_or_default()
    }
}

/// The second side of each polygon that is bright on both, by the corners that the two share; each
/// second side is its own.
fn second_sides(scene: &Scene) -> Vec<Option<u32>> {
    let mut behind = vec![None; scene.polygons.len()];
    // Second sides by the least of their corners, of equal ones the last first.
    let mut start = vec![0_u32; scene.vertices.len() + 1];
    let backs = || scene.polygons.iter().enumerate().rev().filter(|(_, polygon)| polygon.is_back);
    backs().for_each(|(_, back)| start[corner_set(back)[0] as usize + 1] += 1);
    for vertex in 1..start.len() {
        start[vertex] += start[vertex - 1];
    }
    if start.last() == Some(&0) {
        return behind;
    }
    let (mut next, mut sorted) = (start.clone(), vec![0; backs().count()]);
    for (index, back) in backs() {
        let place = &mut next[corner_set(back)[0] as usize];
        sorted[*place as usize] = index as u32;
        *place += 1;
    }
    for (index, polygon) in scene.polygons.iter().enumerate().filter(|(_, polygon)| !polygon.is_back) {
        let corners = corner_set(polygon);
        let [first, last] = [0, 1].map(|by| start[corners[0] as usize + by] as usize);
        let is_same = |back: &&u32| corner_set(&scene.polygons[**back as usize]) == corners;
        let mut same = sorted[first..last].iter().filter(is_same);
        behind[index] = same.next().copied();
        behind[index].into_iter().chain(same.copied()).for_each(|back| behind[back as usize] = Some(back));
    }
    behind
}

/// The corners of a polygon, whichever way it is wound.
fn corner_set(polygon: &Polygon) -> [u32; 4] {
    let mut corners = [u32::MAX; 4];
    corners[..polygon.corners().len()].copy_from_slice(polygon.corners());
    corners.sort_unstable();
    corners
}

/// How far points of a quad may lie off the triangles that it is made of.
fn warp([a, b, c, d]: [Vec3; 4]) -> f32 {
    let [a, b, c, d] = [a, b, c, d].map(Vec3::as_dvec3);
    let off =
        |[a, b, c]: [glam::DVec3; 3], other: glam::DVec3| (b - a).cross(c - a).normalize_or_zero().dot(other - a).abs();
    off([a, b, c], d).max(off([a, c, d], b)) as f32
}

/// The inverse of −0 would put the far side of a box before the near one.
fn without_negative_zeros(direction: Vec3A) -> Vec3A {
    direction + Vec3A::ZERO
}

#[cfg(test)]
mod tests {
    use std::f32::consts::TAU;

    use super::*;
    use crate::base::random::{hash64, r2_sequence};

    /// Truth: the inside of a convex shade sees all of itself. It is tilted and stands off the
    /// origin, so that rounding puts points on either side of their faces.
    #[test]
    fn no_face_is_in_its_own_shadow() {
        let centre = Vec3::new(-1.43, 1.13, -1.84);
        let axis = Vec3::new(0.3, 0.8, -0.2).normalize();
        let (across, along) = axis.any_orthonormal_pair();
        let rim = |number: u32, radius: f32, height: f32| {
            let (sine, cosine) = (TAU * number as f32 / 16.0).sin_cos();
            centre + height * axis + radius * (cosine * across + sine * along)
        };
        let wall = |number: u32| {
            let (low, high) = ([0, 1].map(|n| rim(number + n, 0.09, 0.0)), [0, 1].map(|n| rim(number + n, 0.03, 0.12)));
            [[low[0], high[0], low[1]], [low[1], high[0], high[1]]]
        };
        let faces: Vec<([Vec3; 3], u32)> = (0..16).flat_map(|number| wall(number).map(|face| (face, number))).collect();
        let occluders = Occluders::of_triangles(&faces);
        let point = |seed: u64, index: u32| {
            let ([a, b, c], _) = faces[hash64(seed, index.into()) as usize % faces.len()];
            let [u, v] = r2_sequence(seed, index).map(|number| 0.5 * number);
            let inward = (b - a).cross(c - a).normalize();
            let towards_axis = inward.dot(centre + 0.06 * axis - a).signum();
            (a + u * (b - a) + v * (c - a), towards_axis * inward)
        };
        let blocked = |is_blocked: &dyn Fn((Vec3, Vec3), (Vec3, Vec3)) -> bool| {
            let pairs = (0..20_000).map(|index| (point(1, index), point(2, index)));
            let facing = pairs.filter(|(from, to)| {
                let span = to.0 - from.0;
                from.1.dot(span) > 1e-4 && -to.1.dot(span) > 1e-4
            });
            facing.filter(|(from, to)| is_blocked(*from, *to)).count()
        };
        assert_eq!(blocked(&|from, to| !occluders.sees(from, to)), 0);
        assert!(blocked(&|from, to| occluders.occluded(from.0, to.0)) > 0, "a test that rounding cannot fail");
    }
}
