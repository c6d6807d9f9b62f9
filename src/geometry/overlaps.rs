//! Overlaps: faces that lie on each other and face the same way, of which only one is seen.
//!
//! Exporters write a face and its triangles, floors drawn twice, decals and lamps flush with the surface that they lie on. Counted
//! twice, such a face would reflect twice what reaches it. Here the smaller face lies on top (of equal ones the first), and
//! what it covers of others is cut away, exactly: a face is looked at with all that cover it, halved until few do, and what
//! lies outside of those is kept. Candidates are faces whose boxes touch (a BVH), so that the work grows hardly faster than the scene.

use std::time::Duration;

use glam::{DVec3, Vec3A};
use obvhs::BvhBuildParams;
use obvhs::aabb::Aabb;
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::builder::build_bvh2;
use rayon::prelude::*;

use super::parts::{Halves, Part, area, edges, replace};
use crate::scene::{Polygon, Scene};

/// Faces nearer than this share of the scene's diagonal lie on each other, or beside: 0.04 mm in a room of ten metres, less than its
/// coordinates say where a file gives four digits behind the point.
const NEAR: f64 = 4e-6;
/// Faces of one plane have normals with at least this cosine; their distance says the rest.
const SAME_WAY: f64 = 0.99;
/// A face is halved until no more than so many others cover a part of it.
const FEW: usize = 8;
/// Above so many the halves are looked at side by side.
const MANY: usize = 1024;
/// Halvings of one face.
const MOST_HALVINGS: u32 = 48;
/// Faces whose boxes touch that of one face; what has more is looked at from the others' side alone.
const MOST_TOUCHING: usize = 1 << 16;

/// Cuts away what lies under other faces; returns how many faces were cut or left out, those that are others' backs aside.
pub fn remove(scene: &mut Scene) -> usize {
    let (lower, upper) = scene.bounds();
    let near = NEAR * f64::from(lower.distance(upper));
    let mut faces: Vec<Face> = scene.polygons.par_iter().map(|polygon| Face::new(scene, polygon)).collect();
    let covers = Search::new(&faces, near).covers();
    if covers.is_empty() {
        return 0;
    }
    covers.iter().for_each(|(covered, _)| faces[*covered].is_covered = true);
    let faces = faces;
    let cut = |(polygon, covers): (usize, Vec<u32>)| {
        let whole = Part { polygon, corners: faces[polygon].corners.clone() };
        let covers: Vec<&Face> = covers.iter().map(|cover| &faces[*cover as usize]).collect();
        let cutter = Cutter { normal: faces[polygon].normal, thinnest: near };
        (polygon, cutter.uncovered(whole, &covers, MOST_HALVINGS))
    };
    let mut is_gone = vec![false; faces.len()];
    let (mut count, mut parts) = (0, Vec::new());
    for (polygon, left) in covers.into_par_iter().map(cut).collect::<Vec<_>>() {
        let kept: f64 = left.iter().map(|part| area(&part.corners)).sum();
        if kept >= faces[polygon].area * (1.0 - 1e-9) {
            continue;
        }
        count += usize::from(!faces[polygon].is_back);
        is_gone[polygon] = left.is_empty();
        parts.extend(left);
    }
    replace(scene, parts);
    let mut polygon = 0;
    scene.polygons.retain(|_| {
        polygon += 1;
        !is_gone.get(polygon - 1).copied().unwrap_or(false)
    });
    count
}

/// A polygon as it is looked at here.
struct Face {
    corners: Vec<DVec3>,
    normal: DVec3,
    area: f64,
    /// The box around it.
    lower: DVec3,
    upper: DVec3,
    /// How far corners lie off the face's mean plane.
    warp: f64,
    /// Whether others cover a part of it.
    is_covered: bool,
    is_back: bool,
}

impl Face {
    fn new(scene: &Scene, polygon: &Polygon) -> Self {
        let (corners, count) = scene.corner_positions(polygon);
        let corners: Vec<DVec3> = corners[..count].iter().map(|corner| corner.as_dvec3()).collect();
        let across = match *corners.as_slice() {
            [a, b, c, d] => 0.5 * (c - a).cross(d - b),
            [a, b, c] => 0.5 * (b - a).cross(c - a),
            _ => DVec3::ZERO,
        };
        let (lower, upper) = bounds(&corners);
        let mut face = Self {
            corners,
            lower,
            upper,
            normal: across.normalize_or_zero(),
            area: across.length(),
            warp: 0.0,
            is_covered: false,
            is_back: polygon.is_back,
        };
        face.warp = face.corners.iter().map(|corner| face.height(*corner).abs()).fold(0.0, f64::max);
        face
    }

    fn middle(&self) -> DVec3 {
        self.corners.iter().sum::<DVec3>() / self.corners.len() as f64
    }

    fn height(&self, point: DVec3) -> f64 {
        (point - self.middle()).dot(self.normal)
    }
}

fn bounds(corners: &[DVec3]) -> (DVec3, DVec3) {
    corners.iter().fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(lower, upper), at| (lower.min(*at), upper.max(*at)))
}

/// The search for pairs of faces that overlap.
struct Search<'a> {
    faces: &'a [Face],
    near: f64,
    bvh: Bvh2,
}

impl<'a> Search<'a> {
    fn new(faces: &'a [Face], near: f64) -> Self {
        let around = |face: &Face| {
            Aabb::new(Vec3A::from((face.lower - near).as_vec3()), Vec3A::from((face.upper + near).as_vec3()))
        };
        let boxes: Vec<Aabb> = faces.par_iter().map(around).collect();
        let bvh = build_bvh2(&boxes, BvhBuildParams::fast_build(), &mut Duration::default());
        Self { faces, near, bvh }
    }

    /// The faces that are covered in part, each with what covers it.
    fn covers(&self) -> Vec<(usize, Vec<u32>)> {
        let pairs = (0..self.faces.len() as u32).into_par_iter().with_min_len(64);
        let mut pairs: Vec<(u32, u32)> =
            pairs.flat_map_iter(|face| self.under(face).map(move |it| (it, face))).collect();
        pairs.par_sort_unstable();
        let of_face = pairs.chunk_by(|a, b| a.0 == b.0);
        of_face.map(|pairs| (pairs[0].0 as usize, pairs.iter().map(|pair| pair.1).collect())).collect()
    }

    /// The faces that one covers in part.
    fn under(&self, cover: u32) -> impl Iterator<Item = u32> + use<> {
        let face = &self.faces[cover as usize];
        let (mut under, mut touching) = (Vec::new(), 0);
        self.bvh.aabb_traverse(Aabb::new(face.lower.as_vec3().into(), face.upper.as_vec3().into()), |bvh, node| {
            let node = &bvh.nodes[node as usize];
            let primitives = node.first_index as usize..(node.first_index + node.prim_count) as usize;
            let found = bvh.primitive_indices[primitives].iter();
            under.extend(found.filter(|other| self.is_on(cover, **other)));
            touching += node.prim_count as usize;
            touching <= MOST_TOUCHING
        });
        under.into_iter()
    }

    /// Whether a face lies on another and covers some of it.
    fn is_on(&self, cover: u32, other: u32) -> bool {
        let (top, below) = (&self.faces[cover as usize], &self.faces[other as usize]);
        let rank = |face: &Face, index: u32| (face.is_back, face.area, index);
        let ranks = (rank(top, cover), rank(below, other));
        if ranks.0.partial_cmp(&ranks.1) != Some(std::cmp::Ordering::Less) || top.normal.dot(below.normal) < SAME_WAY {
            return false;
        }
        let most = self.near + below.warp;
        if top.corners.iter().any(|corner| below.height(*corner).abs() > most) {
            return false;
        }
        let cutter = Cutter { normal: below.normal, thinnest: self.near };
        !cutter.are_apart(&below.corners, &top.corners) && cutter.inside(&below.corners, top).is_some()
    }
}

/// Cuts within the plane of a face.
struct Cutter {
    normal: DVec3,
    /// Parts thinner than this count as nothing.
    thinnest: f64,
}

impl Cutter {
    /// The part of convex corners that a face covers; `None` where it is thinner than anything that counts.
    fn inside(&self, corners: &[DVec3], cover: &Face) -> Option<Vec<DVec3>> {
        let mut inside = corners.to_vec();
        for line in self.lines(cover) {
            let halves = Halves::of(&inside, line, self.thinnest);
            if !halves.has_below {
                return None;
            }
            inside = halves.below;
        }
        let rim: f64 = edges(&inside).map(|(from, to)| from.distance(to)).sum();
        (area(&inside) > self.thinnest * rim).then_some(inside)
    }

    /// Whether an edge of one face parts it from another in the same plane.
    fn are_apart(&self, one: &[DVec3], other: &[DVec3]) -> bool {
        let parts = |of: &[DVec3], from: &[DVec3]| {
            edges(of).any(|edge| {
                let off = self.off(edge);
                from.iter().all(|corner| off(*corner) > -self.thinnest)
            })
        };
        parts(one, other) || parts(other, one)
    }

    /// Whether faces are known to cover the whole of convex corners: one does by itself, or they do not overlap and their areas add up.
    fn cover_all(&self, corners: &[DVec3], covers: &[&Face]) -> bool {
        let is_within = |inner: &[DVec3], outer: &[DVec3]| {
            edges(outer).all(|edge| {
                let off = self.off(edge);
                inner.iter().all(|corner| off(*corner) <= self.thinnest)
            })
        };
        if covers.iter().any(|cover| is_within(corners, &cover.corners)) {
            return true;
        }
        if covers.iter().any(|cover| cover.is_covered) {
            return false;
        }
        let shared = |cover: &&Face| match is_within(&cover.corners, corners) {
            true => cover.area,
            false => self.inside(corners, cover).map_or(0.0, |inside| area(&inside)),
        };
        let rim: f64 = edges(corners).map(|(from, to)| from.distance(to)).sum();
        area(corners) - covers.iter().map(shared).sum::<f64>() <= self.thinnest * rim
    }

    /// The rest of a part outside of all these faces.
    fn uncovered(&self, part: Part, covers: &[&Face], halvings: u32) -> Vec<Part> {
        let (lower, upper) = bounds(&part.corners);
        let (lower, upper) = (lower - self.thinnest, upper + self.thinnest);
        let touches = |cover: &&Face| cover.lower.cmple(upper).all() && cover.upper.cmpge(lower).all();
        let touching = covers.iter().copied().filter(touches);
        let covers: Vec<&Face> = touching.filter(|cover| !self.are_apart(&part.corners, &cover.corners)).collect();
        if self.cover_all(&part.corners, &covers) {
            return Vec::new();
        }
        if covers.len() > FEW && halvings > 0 {
            let halves = self.halved(&part.corners);
            let half = |corners: Vec<DVec3>| match corners.len() {
                0..=2 => Vec::new(),
                _ => self.uncovered(Part { polygon: part.polygon, corners }, &covers, halvings - 1),
            };
            let (mut below, above) = if covers.len() > MANY {
                rayon::join(|| half(halves.below), || half(halves.above))
            } else {
                (half(halves.below), half(halves.above))
            };
            below.extend(above);
            return below;
        }
        let outside =
            |rest: Vec<Part>, cover: &Face| rest.into_iter().flat_map(|part| self.outside(part, cover)).collect();
        covers.into_iter().fold(vec![part], outside)
    }

    /// The rest of a part outside of a face, as convex parts.
    fn outside(&self, part: Part, cover: &Face) -> Vec<Part> {
        let Part { polygon, corners: whole } = part;
        if self.inside(&whole, cover).is_none() {
            return vec![Part { polygon, corners: whole }];
        }
        let (mut outside, mut inside) = (Vec::new(), whole);
        for line in self.lines(cover) {
            let halves = Halves::of(&inside, line, self.thinnest);
            if !halves.has_above {
                continue;
            }
            outside.push(Part { polygon, corners: halves.above });
            if !halves.has_below {
                break;
            }
            inside = halves.below;
        }
        outside
    }

    /// Corners cut across the middle of their longer side.
    fn halved(&self, corners: &[DVec3]) -> Halves {
        let longest = edges(corners).map(|(from, to)| to - from).max_by(|a, b| a.length().total_cmp(&b.length()));
        let along = longest.unwrap_or(DVec3::X).normalize_or_zero();
        let across = self.normal.cross(along);
        let extent = |axis: DVec3| {
            let reaches = corners.iter().map(|corner| axis.dot(*corner));
            reaches.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), at| (low.min(at), high.max(at)))
        };
        let (by_along, by_across) = (extent(along), extent(across));
        let (axis, (low, high)) =
            if by_along.1 - by_along.0 >= by_across.1 - by_across.0 { (along, by_along) } else { (across, by_across) };
        Halves::of(corners, |corner| axis.dot(corner) - 0.5 * (low + high), self.thinnest)
    }

    /// Distances from the edges of a face, within the plane; positive outside.
    fn lines<'a>(&'a self, cover: &'a Face) -> impl Iterator<Item = impl Fn(DVec3) -> f64 + use<>> + 'a {
        edges(&cover.corners).map(|edge| self.off(edge))
    }

    /// Distance from the line of an edge; positive outside.
    fn off(&self, (from, to): (DVec3, DVec3)) -> impl Fn(DVec3) -> f64 + use<> {
        let outward = (to - from).cross(self.normal).normalize_or_zero();
        move |corner: DVec3| outward.dot(corner - from)
    }
}
