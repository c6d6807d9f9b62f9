//! Overlaps: faces that lie on each other and face the same way, of which only one is seen.
//!
//! Exporters write a face and its triangles, floors drawn twice, decals and lamps flush with the
//! surface that they lie on. Counted twice, such a face would reflect twice what reaches it. Here
//! the smaller face lies on top (of equal ones the first), and what it covers of others is cut
//! away, exactly: a face is looked at with all that cover it, halved until few do, and what lies
//! outside of those is kept. Candidates are faces whose boxes touch (a BVH), so that the work grows
//! hardly faster than the scene.

use std::time::Duration;

use glam::{DVec3, Vec3A};
use obvhs::BvhBuildParams;
use obvhs::aabb::Aabb;
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::builder::build_bvh2;
use obvhs::bvh2::node::Bvh2Node;
use rayon::prelude::*;

use super::parts::{Halves, Part, area, edges, replace};
use crate::scene::{Polygon, Scene};

/// Faces nearer than this share of the scene's diagonal lie on each other, or beside: 0.04 mm in a
/// room of ten metres, less than its coordinates say where a file gives four digits behind the
/// point.
const NEAR: f64 = 4e-6;
/// Faces of one plane have normals with at least this cosine; their distance says the rest.
const SAME_WAY: f64 = 0.99;
/// A face is halved until no more than so many others cover a part of it.
const FEW: usize = 8;
/// Above so many the halves are looked at side by side.
const MANY: usize = 1024;
/// Halvings of one face.
const MOST_HALVINGS: u32 = 48;
/// Faces whose boxes touch those of a few; what has more is looked at from the others' side alone.
const MOST_TOUCHING: usize = 1 << 16;

/// Cuts away what lies under other faces of the same side; returns how many faces were cut or left
/// out.
pub fn remove(scene: &mut Scene) -> usize {
    let (lower, upper) = scene.bounds();
    let near = NEAR * f64::from(lower.distance(upper));
    let mut faces: Vec<Face> = scene.polygons.par_iter().map(|polygon| Face::new(scene, polygon)).collect();
    let covers = {
        let search = Search::new(&faces, near);
        search.covers(|cover, other| search.is_on(cover, other))
    };
    covers.iter().for_each(|(covered, _)| faces[*covered].is_covered = true);
    let of_polygon = |polygon: usize| (polygon, faces[polygon].clone());
    cut_away(scene, &faces, covers, near, of_polygon)
}

/// Cuts away what lies under other faces of second sides: those of the first polygons that have
/// one, in order, behind all of these.
pub fn remove_backs(scene: &mut Scene, fronts: usize) {
    if scene.polygons.len() == fronts {
        return;
    }
    let (lower, upper) = scene.bounds();
    let near = NEAR * f64::from(lower.distance(upper));
    let all = &scene.polygons[..fronts];
    let faces: Vec<Face> = all.par_iter().map(|polygon| Face::new(scene, polygon)).collect();
    let mut backs = fronts..scene.polygons.len();
    let back_of: Vec<Option<usize>> =
        all.iter().map(|polygon| if polygon.has_back { backs.next() } else { None }).collect();
    let covers = {
        let search = Search::new(&faces, near);
        search.covers(|cover, other| back_of[other as usize].is_some() && search.is_behind(cover, other))
    };
    let of_polygon = |polygon: usize| (back_of[polygon].unwrap_or(polygon), faces[polygon].flipped());
    cut_away(scene, &faces, covers, near, of_polygon);
}

/// Cuts away what others cover of faces; `of_polygon` names the polygon to be cut and how it lies.
/// Returns how many were cut or left out.
fn cut_away(
    scene: &mut Scene,
    faces: &[Face],
    covers: Vec<(usize, Vec<u32>)>,
    near: f64,
    of_polygon: impl Fn(usize) -> (usize, Face) + Sync,
) -> usize {
    if covers.is_empty() {
        return 0;
    }
    let cut = |(covered, covers): (usize, Vec<u32>)| {
        let (polygon, face) = of_polygon(covered);
        let covers: Vec<&Face> = covers.iter().map(|cover| &faces[*cover as usize]).collect();
        let cutter = Cutter { normal: face.normal, thinnest: near };
        let whole = Part { polygon, corners: face.corners().to_vec() };
        (polygon, face.area, cutter.uncovered(whole, &covers, MOST_HALVINGS))
    };
    let mut is_gone = vec![false; scene.polygons.len()];
    let (mut count, mut parts) = (0, Vec::new());
    for (polygon, area_of_whole, left) in covers.into_par_iter().map(cut).collect::<Vec<_>>() {
        let kept: f64 = left.iter().map(|part| area(&part.corners)).sum();
        if kept >= area_of_whole * (1.0 - 1e-9) {
            continue;
        }
        count += 1;
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
#[derive(Clone)]
struct Face {
    /// Three or four corners of the face; the last one stands for a missing fourth.
    all: [DVec3; 4],
    count: usize,
    normal: DVec3,
    area: f64,
    /// The box around it.
    lower: DVec3,
    upper: DVec3,
    /// How far corners lie off the face's mean plane.
    warp: f64,
    /// Whether others cover a part of it.
    is_covered: bool,
}

impl Face {
    fn new(scene: &Scene, polygon: &Polygon) -> Self {
        let (corners, count) = scene.corner_positions(polygon);
        let all = corners.map(|corner| corner.as_dvec3());
        let [a, b, c, d] = all;
        let across = if count == 4 { 0.5 * (c - a).cross(d - b) } else { 0.5 * (b - a).cross(c - a) };
        let (lower, upper) = bounds(&all[..count]);
        let mut face = Self {
            all,
            count,
            lower,
            upper,
            normal: across.normalize_or_zero(),
            area: across.length(),
            warp: 0.0,
            is_covered: false,
        };
        face.warp = face.corners().iter().map(|corner| face.height(*corner).abs()).fold(0.0, f64::max);
        face
    }

    fn corners(&self) -> &[DVec3] {
        &self.all[..self.count]
    }

    /// The face seen from behind; nothing covers it but the fronts of others.
    fn flipped(&self) -> Self {
        let mut flipped = Self { normal: -self.normal, is_covered: false, ..self.clone() };
        flipped.all[..self.count].reverse();
        flipped
    }

    fn middle(&self) -> DVec3 {
        self.corners().iter().sum::<DVec3>() / self.count as f64
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
    /// Around the faces and what is near them.
    boxes: Vec<Aabb>,
}

impl<'a> Search<'a> {
    fn new(faces: &'a [Face], near: f64) -> Self {
        let around = |face: &Face| {
            let near = near + face.warp;
            Aabb::new(Vec3A::from((face.lower - near).as_vec3()), Vec3A::from((face.upper + near).as_vec3()))
        };
        let boxes: Vec<Aabb> = faces.par_iter().map(around).collect();
        let bvh = build_bvh2(&boxes, BvhBuildParams::fast_build(), &mut Duration::default());
        Self { faces, near, bvh, boxes }
    }

    /// The faces that are covered in part, each with what covers it, as `is_on` tells of a cover
    /// and another face.
    fn covers(&self, is_on: impl Fn(u32, u32) -> bool + Sync) -> Vec<(usize, Vec<u32>)> {
        let leaves = self.bvh.nodes.par_iter().with_min_len(64).filter(|node| node.prim_count > 0);
        let mut pairs: Vec<(u32, u32)> = leaves.flat_map_iter(|leaf| self.under(leaf, &is_on)).collect();
        pairs.par_sort_unstable();
        let of_face = pairs.chunk_by(|a, b| a.0 == b.0);
        of_face.map(|pairs| (pairs[0].0 as usize, pairs.iter().map(|pair| pair.1).collect())).collect()
    }

    /// The faces that those of a leaf cover in part, each with what covers it: neighbours are
    /// looked for together.
    fn under(&self, leaf: &Bvh2Node, is_on: impl Fn(u32, u32) -> bool) -> Vec<(u32, u32)> {
        let (mut under, mut touching) = (Vec::new(), 0);
        self.bvh.aabb_traverse(leaf.aabb, |_, node| {
            let others = self.of_leaf(&self.bvh.nodes[node as usize]);
            for &cover in self.of_leaf(leaf) {
                let touches = |other: &u32| self.boxes[*other as usize].intersect_aabb(&self.boxes[cover as usize]);
                let found = others.iter().copied().filter(|other| touches(other) && is_on(cover, *other));
                under.extend(found.map(|other| (other, cover)));
            }
            touching += others.len();
            touching <= MOST_TOUCHING
        });
        under
    }

    fn of_leaf(&self, leaf: &Bvh2Node) -> &[u32] {
        let first = leaf.first_index as usize;
        &self.bvh.primitive_indices[first..first + leaf.prim_count as usize]
    }

    /// Whether a face lies on another of the same side and covers some of it.
    fn is_on(&self, cover: u32, other: u32) -> bool {
        let (top, below) = (&self.faces[cover as usize], &self.faces[other as usize]);
        let is_higher = top.area < below.area || (top.area == below.area && cover < other);
        is_higher
            && top.normal.dot(below.normal) >= SAME_WAY
            && self.is_in_plane(top, below)
            && self.covers_some(top, below)
    }

    /// Whether a face covers some of the second side of another.
    fn is_behind(&self, cover: u32, other: u32) -> bool {
        let (top, below) = (&self.faces[cover as usize], &self.faces[other as usize]);
        top.normal.dot(below.normal) <= -SAME_WAY
            && self.is_in_plane(top, below)
            && self.covers_some(top, &below.flipped())
    }

    fn is_in_plane(&self, top: &Face, below: &Face) -> bool {
        let most = self.near + below.warp;
        top.corners().iter().all(|corner| below.height(*corner).abs() <= most)
    }

    fn covers_some(&self, top: &Face, below: &Face) -> bool {
        let cutter = Cutter { normal: below.normal, thinnest: self.near };
        !cutter.are_apart(below.corners(), top.corners()) && cutter.inside(below.corners(), top).is_some()
    }
}

/// Cuts within the plane of a face.
struct Cutter {
    normal: DVec3,
    /// Parts thinner than this count as nothing.
    thinnest: f64,
}

impl Cutter {
    /// The part of convex corners that a face covers; `None` where it is thinner than anything that
    /// counts.
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

    /// Whether faces are known to cover the whole of convex corners: one does by itself, or they do
    /// not overlap and their areas add up.
    fn cover_all(&self, corners: &[DVec3], covers: &[&Face]) -> bool {
        let is_within = |inner: &[DVec3], outer: &[DVec3]| {
            edges(outer).all(|edge| {
                let off = self.off(edge);
                inner.iter().all(|corner| off(*corner) <= self.thinnest)
            })
        };
        if covers.iter().any(|cover| is_within(corners, cover.corners())) {
            return true;
        }
        if covers.iter().any(|cover| cover.is_covered) {
            return false;
        }
        let shared = |cover: &&Face| match is_within(cover.corners(), corners) {
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
        let covers: Vec<&Face> = touching.filter(|cover| !self.are_apart(&part.corners, cover.corners())).collect();
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
        edges(cover.corners()).map(|edge| self.off(edge))
    }

    /// Distance from the line of an edge; positive outside.
    fn off(&self, (from, to): (DVec3, DVec3)) -> impl Fn(DVec3) -> f64 + use<> {
        let outward = (to - from).cross(self.normal).normalize_or_zero();
        move |corner: DVec3| outward.dot(corner - from)
    }
}
