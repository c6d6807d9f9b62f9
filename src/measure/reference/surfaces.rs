//! Surfaces of a path: the faces of a scene as one-sided triangles, with rays of the reference's
//! own.
//!
//! Points of paths lie on their triangles to double precision, and a ray passes over the polygon
//! that it leaves; so there is no distance by which it must start off a surface. What a file rounds
//! is another matter: faces that are meant to be at the same place are so up to the rounding of
//! their corners. Parallel faces no farther apart than that **coincide**. Of coincident faces a ray
//! meets the one whose bright side it sees, the smallest if there are several, and it leaves all of
//! them at once. So a wall made of two faces back to back is a wall, also where rooms share it, and
//! the two sides of a doubled face ([`crate::scene::Sides::Both`]) need no thought; a face that is
//! there twice is met once, and a label on a box is seen.

use glam::{DVec3, Vec3};

use super::bvh::Bvh;
use super::points::SurfacePoint;
use super::triangle::{Ray, point_of};
use crate::scene::{Polygon, Scene};

/// How far a face may lie from its place in the file, as a share of its largest coordinate: each of
/// the three numbers of a corner is off by 2⁻²⁴ of it, and their length by √3 of that.
const CORNER_ROUNDING: f64 = 2.0 / 16_777_216.0;
/// Coincident faces are parallel up to 0.8°.
const LEAST_COSINE: f64 = 0.9999;
/// Points on the very edge of a triangle are moved inside by this share: there the next wall may
/// begin.
const INSET: f64 = 1e-6;

/// The faces of a scene.
#[derive(Debug)]
pub struct Surfaces {
    bvh: Bvh,
    /// In the order of the tree's leaves.
    triangles: Vec<[Vec3; 3]>,
    planes: Vec<Plane>,
    /// Corners of each polygon, to find a point on it again.
    polygons: Vec<([Vec3; 4], usize)>,
    /// The place of each polygon among those that may lie on it: less is on top.
    ranks: Vec<u32>,
}

/// Data of a triangle that a hit needs.
#[derive(Clone, Copy, Debug)]
struct Plane {
    normal: DVec3,
    /// How far it may lie from its place.
    tolerance: f64,
    polygon: u32,
}

/// A place on the bright side of a face from which light is looked for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Vertex {
    /// Position, on the face to double precision.
    pub position: DVec3,
    /// Unit normal of the bright side.
    pub normal: DVec3,
    /// Unit normal that cosines are taken to: the face's own, or an interpolated one.
    pub shading: DVec3,
    /// Index into [`Scene::polygons`].
    pub polygon: u32,
    /// How far the face may lie from its place.
    tolerance: f64,
}

/// Stands for the polygon of a place that lies on none.
const NO_POLYGON: u32 = u32::MAX;

impl Vertex {
    /// A place in the air, for rays along a direction.
    pub fn in_the_air(position: DVec3, direction: DVec3) -> Self {
        Self { position, normal: direction, shading: direction, polygon: NO_POLYGON, tolerance: 0.0 }
    }

    /// The place with an interpolated normal for cosines.
    pub fn shaded(self, shading: DVec3) -> Self {
        Self { shading, ..self }
    }

    /// The place, left through the back of its face.
    pub fn behind(self) -> Self {
        Self { normal: -self.normal, ..self }
    }
}

/// Hit of a ray.
#[derive(Clone, Copy, Debug)]
struct Hit {
    distance: f64,
    weights: [f64; 3],
    is_front: bool,
    triangle: u32,
}

impl Surfaces {
    /// Surfaces of a scene.
    pub fn new(scene: &Scene) -> Self {
        let polygons: Vec<_> = scene.polygons.iter().map(|polygon| scene.corner_positions(polygon)).collect();
        let mut corners = Vec::with_capacity(2 * polygons.len());
        let mut polygon_of = Vec::with_capacity(2 * polygons.len());
        for (index, (polygon, count)) in polygons.iter().enumerate() {
            for triangle in fan(polygon, *count).filter(|triangle| plane_normal(triangle) != DVec3::ZERO) {
                corners.push(triangle);
                polygon_of.push(index as u32);
            }
        }
        let bvh = Bvh::new(&corners);
        let triangles: Vec<[Vec3; 3]> = bvh.order.iter().map(|triangle| corners[*triangle as usize]).collect();
        let plane = |(triangle, index): (&[Vec3; 3], &u32)| Plane {
            normal: plane_normal(triangle),
            tolerance: tolerance(triangle),
            polygon: polygon_of[*index as usize],
        };
        let planes = triangles.iter().zip(&bvh.order).map(plane).collect();
        Self { bvh, triangles, planes, polygons, ranks: ranks(scene) }
    }

    /// The vertex at a point of a polygon, whose position is rounded.
    pub fn vertex(&self, point: &SurfacePoint) -> Vertex {
        let (normal, polygon) = (point.normal.as_dvec3(), point.polygon);
        let given = point.position.as_dvec3();
        let Some((corners, count)) = self.polygons.get(polygon as usize) else {
            return Vertex { position: given, normal, shading: normal, polygon, tolerance: 0.0 };
        };
        let least = |weights: &[f64; 3]| weights.iter().copied().fold(f64::INFINITY, f64::min);
        let places = fan(corners, *count).filter_map(|triangle| Some((triangle, weights_at(&triangle, given)?)));
        let place = places.max_by(|(_, one), (_, other)| least(one).total_cmp(&least(other)));
        let position = place.map_or(given, |(triangle, weights)| {
            let inside = weights.map(|weight| weight.max(INSET));
            let sum: f64 = inside.iter().sum();
            point_of(&triangle, inside.map(|weight| weight / sum))
        });
        Vertex { position, normal, shading: normal, polygon, tolerance: tolerance(&corners[..*count]) }
    }

    /// The bright side that a ray from a vertex meets, and how far away; `None` where it meets a
    /// dark back or leaves the scene.
    #[inline]
    pub fn meet(&self, from: &Vertex, direction: DVec3) -> Option<(f64, Vertex)> {
        let ray = Ray::new(from.position, direction);
        let cosine = direction.dot(from.normal);
        // The nearest of all, how far behind it another may coincide with it, and the nearest
        // bright side.
        let (mut nearest, mut limit, mut bright): (Option<Hit>, f64, Option<Hit>) = (None, f64::INFINITY, None);
        self.bvh.visit(&ray, limit, |range| {
            for triangle in range {
                let Some(meeting) = ray.meet(&self.triangles[triangle]) else { continue };
                let (distance, plane) = (meeting.distance, &self.planes[triangle]);
                if distance > limit || distance < 0.0 || self.is_left(from, plane, distance * cosine) {
                    continue;
                }
                let hit =
                    Hit { distance, weights: meeting.weights, is_front: meeting.is_front, triangle: triangle as u32 };
                if nearest.is_none_or(|nearest| distance < nearest.distance) {
                    nearest = Some(hit);
                    let slope = direction.dot(plane.normal).abs();
                    limit = limit.min(distance + 2.0 * self.tolerance() / slope.max(f64::MIN_POSITIVE));
                }
                if hit.is_front && bright.is_none_or(|other| self.is_met_before(&hit, &other, direction)) {
                    bright = Some(hit);
                }
            }
            limit
        });
        let (nearest, bright) = (nearest?, bright?);
        let plane = &self.planes[bright.triangle as usize];
        let behind = (bright.distance - nearest.distance) * direction.dot(plane.normal).abs();
        if !nearest.is_front && !coincide(&self.planes[nearest.triangle as usize], plane, behind) {
            return None;
        }
        Some((bright.distance, self.vertex_of(&bright)))
    }

    /// The bright side that a ray meets first, as a picture shows it: dark sides are looked
    /// through.
    pub fn look(&self, from: &Vertex, direction: DVec3) -> Option<Vertex> {
        let ray = Ray::new(from.position, direction);
        let cosine = direction.dot(from.normal);
        let (mut limit, mut bright): (f64, Option<Hit>) = (f64::INFINITY, None);
        self.bvh.visit(&ray, limit, |range| {
            for triangle in range {
                let Some(meeting) = ray.meet(&self.triangles[triangle]).filter(|meeting| meeting.is_front) else {
                    continue;
                };
                let (distance, plane) = (meeting.distance, &self.planes[triangle]);
                if distance > limit || distance < 0.0 || self.is_left(from, plane, distance * cosine) {
                    continue;
                }
                let hit = Hit { distance, weights: meeting.weights, is_front: true, triangle: triangle as u32 };
                if bright.is_none_or(|other| self.is_met_before(&hit, &other, direction)) {
                    bright = Some(hit);
                }
                let slope = direction.dot(plane.normal).abs();
                limit = limit.min(distance + 2.0 * self.tolerance() / slope.max(f64::MIN_POSITIVE));
            }
            limit
        });
        bright.map(|hit| self.vertex_of(&hit))
    }

    fn vertex_of(&self, hit: &Hit) -> Vertex {
        let position = point_of(&self.triangles[hit.triangle as usize], hit.weights);
        let Plane { normal, tolerance, polygon } = self.planes[hit.triangle as usize];
        Vertex { position, normal, shading: normal, polygon, tolerance }
    }

    /// Whether a vertex sees a point on the bright side of a polygon, towards which it looks, and
    /// not another face at the same place.
    #[inline]
    pub fn sees(&self, from: &Vertex, to: &Vertex) -> bool {
        let span = to.position - from.position;
        let length = span.length();
        let direction = span / length;
        let ray = Ray::new(from.position, direction);
        let (cosine, slope) = (direction.dot(from.normal), direction.dot(to.normal).abs());
        if length * cosine <= from.tolerance + to.tolerance && is_parallel(from.normal, to.normal) {
            // At the same place as the vertex itself.
            return false;
        }
        let limit = length + 2.0 * self.tolerance() / slope.max(f64::MIN_POSITIVE);
        let mut is_seen = true;
        self.bvh.visit(&ray, limit, |range| {
            for triangle in range {
                let plane = &self.planes[triangle];
                if plane.polygon == to.polygon {
                    continue;
                }
                let Some(meeting) = ray.meet(&self.triangles[triangle]) else { continue };
                let distance = meeting.distance;
                if distance > limit || distance < 0.0 || self.is_left(from, plane, distance * cosine) {
                    continue;
                }
                let before = length - distance;
                let is_at_end =
                    (before * slope).abs() <= plane.tolerance + to.tolerance && is_parallel(plane.normal, to.normal);
                let is_passed = if is_at_end {
                    // Another bright side at the same place may be met instead.
                    !meeting.is_front || self.rank(plane.polygon) > self.rank(to.polygon)
                } else {
                    before <= 0.0
                };
                if !is_passed {
                    is_seen = false;
                    return -1.0;
                }
            }
            limit
        });
        is_seen
    }

    /// Whether a ray from a vertex leaves the scene and meets no face, bright or dark.
    pub fn is_open(&self, from: &Vertex, direction: DVec3) -> bool {
        let ray = Ray::new(from.position, direction);
        let cosine = direction.dot(from.normal);
        let mut is_open = true;
        self.bvh.visit(&ray, f64::INFINITY, |range| {
            for triangle in range {
                let Some(meeting) = ray.meet(&self.triangles[triangle]) else { continue };
                let is_left = self.is_left(from, &self.planes[triangle], meeting.distance * cosine);
                if meeting.distance >= 0.0 && !is_left {
                    is_open = false;
                    return -1.0;
                }
            }
            f64::INFINITY
        });
        is_open
    }

    /// A vertex on a polygon at a position that is known to double precision.
    pub fn at(&self, polygon: u32, position: DVec3, normal: DVec3) -> Vertex {
        let (corners, count) = &self.polygons[polygon as usize];
        Vertex { position, normal, shading: normal, polygon, tolerance: tolerance(&corners[..*count]) }
    }

    /// Whether a ray has left this face when it starts at `from`: its own polygon, or one at the
    /// same place. `height` is that of the hit above the vertex.
    #[inline]
    fn is_left(&self, from: &Vertex, plane: &Plane, height: f64) -> bool {
        plane.polygon == from.polygon
            || (height <= from.tolerance + plane.tolerance && is_parallel(plane.normal, from.normal))
    }

    /// Which of two bright sides a ray meets: the nearer one, or, where they coincide, the one on
    /// top.
    #[inline]
    fn is_met_before(&self, hit: &Hit, other: &Hit, direction: DVec3) -> bool {
        let [one, two] = [hit, other].map(|hit| &self.planes[hit.triangle as usize]);
        let apart = (hit.distance - other.distance).abs() * direction.dot(one.normal).abs();
        if coincide(one, two, apart) && one.polygon != two.polygon {
            return self.rank(one.polygon) < self.rank(two.polygon);
        }
        hit.distance < other.distance
    }

    fn rank(&self, polygon: u32) -> u32 {
        self.ranks[polygon as usize]
    }

    /// The largest of all faces' tolerances.
    fn tolerance(&self) -> f64 {
        CORNER_ROUNDING * f64::from(self.bvh.extent)
    }
}

/// The order of polygons that lie on each other: the smaller is on top, of equal ones the first,
/// and the second sides of faces come after those that the file has.
fn ranks(scene: &Scene) -> Vec<u32> {
    let polygons = &scene.polygons;
    let mut order: Vec<u32> = (0..polygons.len() as u32).collect();
    let area = |polygon: u32| scene.area(&polygons[polygon as usize]);
    order.sort_by(|a, b| {
        let backs = [a, b].map(|polygon| polygons[*polygon as usize].is_back);
        backs[0].cmp(&backs[1]).then(area(*a).total_cmp(&area(*b))).then(a.cmp(b))
    });
    let mut ranks = vec![0; polygons.len()];
    for (rank, polygon) in order.into_iter().enumerate() {
        ranks[polygon as usize] = rank as u32;
    }
    ranks
}

fn is_parallel(one: DVec3, other: DVec3) -> bool {
    one.dot(other).abs() > LEAST_COSINE
}

/// Whether two planes that lie so far apart are meant to be at the same place.
fn coincide(one: &Plane, other: &Plane, apart: f64) -> bool {
    apart <= one.tolerance + other.tolerance && is_parallel(one.normal, other.normal)
}

fn tolerance(corners: &[Vec3]) -> f64 {
    let largest = corners.iter().fold(0.0_f32, |largest, corner| largest.max(corner.abs().max_element()));
    CORNER_ROUNDING * f64::from(largest)
}

/// The triangles of a polygon.
fn fan([a, b, c, d]: &[Vec3; 4], count: usize) -> impl Iterator<Item = [Vec3; 3]> {
    [[*a, *b, *c], [*a, *c, *d]].into_iter().take(count - 2)
}

fn plane_normal(triangle: &[Vec3; 3]) -> DVec3 {
    let [a, b, c] = triangle.map(|corner| corner.as_dvec3());
    (b - a).cross(c - a).normalize_or_zero()
}

/// Barycentric weights of the point of a triangle's plane that is nearest to this one; `None` where
/// the triangle has no area.
fn weights_at(triangle: &[Vec3; 3], point: DVec3) -> Option<[f64; 3]> {
    let [a, b, c] = triangle.map(|corner| corner.as_dvec3());
    let normal = (b - a).cross(c - a);
    let area = normal.length_squared();
    let of = |from: DVec3, to: DVec3| (to - from).cross(point - from).dot(normal) / area;
    (area > 0.0).then(|| [of(b, c), of(c, a), of(a, b)])
}

/// The corners of a polygon in double precision, and how many there are.
pub fn corners_of(scene: &Scene, polygon: &Polygon) -> ([DVec3; 4], usize) {
    let (corners, count) = scene.corner_positions(polygon);
    (corners.map(|corner| corner.as_dvec3()), count)
}
