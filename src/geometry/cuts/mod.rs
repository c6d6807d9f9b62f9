//! Cuts: large surfaces are cut where a wall stands on them, so that no patch lies in two rooms.
//!
//! Refinement splits a patch in the middle of its edges, wherever walls stand. The leaves under the
//! foot of a wall would lie on both of its sides and show one light: a bright line in the dark
//! room. This is the discontinuity of order zero of [Heckbert 92; Lischinski, Tampieri, Greenberg
//! 92], which is cheap to find: the lines in which other faces meet a surface.
//!
//! A surface (coplanar polygons of one material that share edges) is cut along a line only where
//! tall faces cover much of the line's way through it, so that legs of furniture and low things cut
//! nothing; the parts are looked at again by themselves. Polygons stay triangles and quads, each in
//! its material and group.

mod line;

use glam::DVec3;
use rayon::prelude::*;
use rustc_hash::{FxHashMap, FxHashSet};

use super::parts::{Bits, Halves, Part, area, bits, edges, replace};
use crate::scene::{Polygon, Scene};
use line::{Line, foot};

/// Polygons of less than this share of the scene's area are not cut: leaves on them are small
/// anyhow.
const LEAST_POLYGON: f64 = 1.0 / 4_000.0;
/// Nor are surfaces of less than this share.
const LEAST_SURFACE: f64 = 1.0 / 60.0;
/// Faces of less than this share of the scene's area part nothing.
const LEAST_FACE: f64 = 1e-5;
/// Faces part a surface where they rise above it by this share of the root of its area: half a
/// metre over a floor of 25 m².
const LEAST_HEIGHT: f64 = 0.1;
/// Share of a line's way through a surface, or a part of one, that faces must cover.
const COVERED: f64 = 0.5;
/// A surface is cut only where one of the cuts leaves this share of it on either side: what stands
/// along its rim parts no rooms.
const LEAST_SIDE: f64 = 0.05;
/// An edge that is covered to this share parts what is shown on its sides.
const DISCONTINUOUS: f64 = 0.999;
/// Things nearer than this share of the scene's diagonal touch: a millimetre in a room of ten
/// metres.
const TOUCHING: f64 = 1e-4;
/// Corners nearer to a line than this share of the diagonal lie on it: no part is thinner, for its
/// area must have a meaning in f32.
const THINNEST: f64 = 1e-3;
/// Faces that meet a surface under a smaller angle than this (its sine) lie on it.
const LEAST_SINE: f64 = 0.2;
/// Polygons of one plane have normals with at least this cosine.
const SAME_PLANE: f64 = 1.0 - 1e-6;
/// Polygons that share an edge under a larger cosine look like one surface.
const SMOOTH: f64 = 0.766;
/// A surface is cut into no more parts than this.
const MOST_PARTS: usize = 64;

/// Cuts the surfaces of a scene where walls stand on them; returns how many polygons were cut. The
/// first part of a polygon takes its place, the others follow behind all polygons. `both_sides`
/// tells whether walls behind a face part it as well.
pub fn cut(scene: &mut Scene, both_sides: bool) -> usize {
    let all = scene.polygons.par_iter().enumerate();
    let faces: Vec<Face> = all.map(|(index, of)| Face::new(scene, index, of)).collect();
    let total: f64 = faces.iter().map(|face| face.area).sum();
    let (lower, upper) = scene.bounds();
    let diagonal = f64::from(lower.distance(upper));
    let cutter =
        Cutter { faces: &faces, total, touching: TOUCHING * diagonal, thinnest: THINNEST * diagonal, both_sides };
    let mut parts = Vec::new();
    let mut edges = Vec::new();
    for surface in cutter.surfaces(scene) {
        let divided = cutter.divide(&surface);
        if divided.parts.len() > surface.len() && !cutter.tears(scene, &surface, &divided.crossed) {
            parts.extend(divided.parts);
            edges.extend(divided.edges);
        }
    }
    scene.cut_edges.extend(edges.iter().map(|edge| edge.map(|end| end.as_vec3())));
    replace(scene, parts)
}

/// A polygon as it is looked at here.
struct Face {
    polygon: usize,
    corners: Vec<DVec3>,
    normal: DVec3,
    area: f64,
}

impl Face {
    fn new(scene: &Scene, polygon: usize, of: &Polygon) -> Self {
        let (corners, count) = scene.corner_positions(of);
        let corners: Vec<DVec3> = corners[..count].iter().map(|corner| corner.as_dvec3()).collect();
        let across = match *corners.as_slice() {
            [a, b, c, d] => 0.5 * (c - a).cross(d - b),
            [a, b, c] => 0.5 * (b - a).cross(c - a),
            _ => DVec3::ZERO,
        };
        Self { polygon, corners, normal: across.normalize_or_zero(), area: across.length() }
    }
}

struct Cutter<'a> {
    faces: &'a [Face],
    total: f64,
    touching: f64,
    thinnest: f64,
    both_sides: bool,
}

impl Cutter<'_> {
    /// Large coplanar polygons that share edges, by their places among the faces.
    fn surfaces(&self, scene: &Scene) -> Vec<Vec<usize>> {
        let can_be_cut = |face: &&Face| {
            let emits = scene.emits(&scene.polygons[face.polygon]);
            face.area >= LEAST_POLYGON * self.total && !emits && self.is_flat(face)
        };
        let large: Vec<&Face> = self.faces.iter().filter(can_be_cut).collect();
        let mut with_edge: FxHashMap<(Bits, Bits), usize> = FxHashMap::default();
        for (place, face) in large.iter().enumerate() {
            edges(&face.corners).for_each(|(from, to)| {
                with_edge.insert((bits(from), bits(to)), place);
            });
        }
        let mut is_taken = vec![false; large.len()];
        let mut surfaces = Vec::new();
        for first in 0..large.len() {
            let (mut surface, mut waiting) = (Vec::new(), vec![first]);
            while let Some(place) = waiting.pop() {
                if std::mem::replace(&mut is_taken[place], true) {
                    continue;
                }
                let face = large[place];
                surface.push(face.polygon);
                let neighbours =
                    edges(&face.corners).filter_map(|(from, to)| with_edge.get(&(bits(to), bits(from))).copied());
                let is_same = |other: &usize| {
                    let (a, b) = (&scene.polygons[face.polygon], &scene.polygons[large[*other].polygon]);
                    a.material == b.material && face.normal.dot(large[*other].normal) >= SAME_PLANE
                };
                waiting.extend(neighbours.filter(is_same));
            }
            let area: f64 = surface.iter().map(|&polygon| self.faces[polygon].area).sum();
            if area >= LEAST_SURFACE * self.total {
                surface.sort_unstable();
                surfaces.push(surface);
            }
        }
        surfaces
    }

    fn is_flat(&self, face: &Face) -> bool {
        let height = |corner: &DVec3| (*corner - face.corners[0]).dot(face.normal).abs();
        face.corners.iter().all(|corner| height(corner) <= 0.1 * self.touching)
    }

    /// Cuts a surface as often as it is to be.
    fn divide(&self, surface: &[usize]) -> Divided {
        let part = |&polygon: &usize| Part { polygon, corners: self.faces[polygon].corners.clone() };
        let whole: Vec<Part> = surface.iter().map(part).collect();
        let lines = self.lines_on(surface);
        let (mut crossed, mut edges) = (FxHashSet::default(), Vec::new());
        let mut done = Vec::new();
        let mut waiting = vec![whole];
        while let Some(parts) = waiting.pop() {
            let is_full = done.len() + waiting.len() >= MOST_PARTS;
            let least_side = if done.is_empty() && waiting.is_empty() { LEAST_SIDE } else { 0.0 };
            let line = if is_full { None } else { self.best(&lines, &parts, least_side) };
            let Some(line) = line else {
                done.extend(parts);
                continue;
            };
            let (mut below, mut above) = (Vec::new(), Vec::new());
            for part in parts {
                let sides = line.halves(&part, self.thinnest);
                crossed.extend(sides.crossed);
                let [(low, has_low), (high, has_high)] =
                    [(sides.below, sides.has_below), (sides.above, sides.has_above)];
                if let Some(edge) = sides.cut.filter(|edge| line.covers(edge) >= DISCONTINUOUS) {
                    edges.push(edge);
                }
                if has_low {
                    below.push(Part { polygon: part.polygon, corners: low });
                }
                if has_high {
                    above.push(Part { polygon: part.polygon, corners: high });
                }
            }
            waiting.extend([above, below]);
        }
        Divided { parts: done, crossed, edges }
    }

    /// The lines in which tall faces meet a surface.
    fn lines_on(&self, surface: &[usize]) -> Vec<Line> {
        let largest = surface.iter().copied().max_by(|a, b| self.faces[*a].area.total_cmp(&self.faces[*b].area));
        let Some(plane) = largest.map(|largest| &self.faces[largest]) else { return Vec::new() };
        let height = |corner: DVec3| (corner - plane.corners[0]).dot(plane.normal);
        let area: f64 = surface.iter().map(|&polygon| self.faces[polygon].area).sum();
        let least_rise = LEAST_HEIGHT * area.sqrt();
        let mut lines: Vec<Line> = Vec::new();
        for face in self.faces.iter().filter(|face| face.area >= LEAST_FACE * self.total) {
            let sine = face.normal.cross(plane.normal).length();
            let heights: Vec<f64> = face.corners.iter().map(|corner| height(*corner)).collect();
            let (lowest, highest) =
                heights.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), &at| (low.min(at), high.max(at)));
            let rise = if self.both_sides { highest.max(-lowest) } else { highest };
            if sine < LEAST_SINE || lowest > self.touching || highest < -self.touching || rise < least_rise {
                continue;
            }
            let Some([from, to]) = foot(&face.corners, &heights, self.touching) else { continue };
            let [from, to] = [from, to].map(|end| end - height(end) * plane.normal);
            if from.distance(to) <= 2.0 * self.touching {
                continue;
            }
            let normal = face.normal.reject_from(plane.normal).normalize();
            let is_same = |line: &&mut Line| {
                line.normal.dot(normal).abs() >= SAME_PLANE
                    && [from, to].iter().all(|end| line.distance(*end).abs() <= 0.5 * self.touching)
            };
            match lines.iter_mut().find(is_same) {
                Some(line) => line.cover(from, to),
                None => {
                    let direction = normal.cross(plane.normal);
                    let mut line =
                        Line { normal, offset: normal.dot(from), origin: from, direction, covered: Vec::new() };
                    line.cover(from, to);
                    lines.push(line);
                }
            }
        }
        lines
    }

    /// The line along which these parts are covered most, if enough for a cut that leaves so much
    /// of them on either side.
    fn best<'a>(&self, lines: &'a [Line], parts: &[Part], least_side: f64) -> Option<&'a Line> {
        let of_line = |line: &'a Line| {
            let sides: Vec<Halves> = parts.iter().map(|part| line.halves(part, self.thinnest)).collect();
            let below: f64 = sides.iter().map(|sides| area(&sides.below)).sum();
            let above: f64 = sides.iter().map(|sides| area(&sides.above)).sum();
            if below.min(above) < least_side * (below + above) {
                return None;
            }
            let cuts: Vec<_> = sides.into_iter().filter_map(|sides| sides.cut).collect();
            let length: f64 = cuts.iter().map(|[from, to]| from.distance(*to)).sum();
            let covered: f64 = cuts.iter().map(|edge| line.covers(edge) * edge[0].distance(edge[1])).sum();
            (length > 0.0 && covered >= COVERED * length).then_some((line, covered / length))
        };
        let all = lines.iter().filter_map(of_line);
        all.reduce(|best, next| if next.1 > best.1 { next } else { best }).map(|(line, _)| line)
    }

    /// Whether a cut would end at an edge beyond which a surface that looks like the same goes on
    /// uncut.
    fn tears(&self, scene: &Scene, surface: &[usize], crossed: &FxHashSet<(Bits, Bits)>) -> bool {
        let (of, normal) = (&scene.polygons[surface[0]], self.faces[surface[0]].normal);
        self.faces.iter().any(|face| {
            scene.polygons[face.polygon].material == of.material
                && face.normal.dot(normal) > SMOOTH
                && surface.binary_search(&face.polygon).is_err()
                && edges(&face.corners).any(|(from, to)| crossed.contains(&(bits(to), bits(from))))
        })
    }
}

/// A surface after it was cut.
struct Divided {
    parts: Vec<Part>,
    /// Edges of its polygons that cuts run through.
    crossed: FxHashSet<(Bits, Bits)>,
    /// Edges between parts that faces cover wholly.
    edges: Vec<[DVec3; 2]>,
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::orient;
    use crate::measure::stability::scenes::add_box;
    use crate::scene::{GroupId, MaterialId, Sides};
    use glam::{Vec3, vec3};

    /// A closed room of 4 × 3 × 3 m, of one material.
    fn room() -> Scene {
        let mut scene = Scene::new("room");
        scene.add_material("grey", Vec3::splat(0.5), Vec3::ZERO);
        add_box(&mut scene, (Vec3::ZERO, vec3(4.0, 3.0, 3.0)), true, (MaterialId(0), GroupId(0)));
        scene
    }

    fn with_box(lower: Vec3, upper: Vec3) -> Scene {
        let mut scene = room();
        add_box(&mut scene, (lower, upper), false, (MaterialId(0), GroupId(0)));
        scene
    }

    fn area(scene: &Scene) -> f64 {
        scene.polygons.iter().map(|polygon| f64::from(scene.area(polygon))).sum()
    }

    /// Whether a polygon of the room itself lies on both sides of the plane x = `at`.
    fn straddles(scene: &Scene, at: f32) -> bool {
        let reaches = |polygon: &Polygon| {
            let (corners, count) = scene.corner_positions(polygon);
            corners[..count].iter().any(|corner| corner.x < at) && corners[..count].iter().any(|corner| corner.x > at)
        };
        scene.polygons.iter().any(reaches)
    }

    /// Truth: a wall through the whole room stands on its floor, ceiling and two long walls; each
    /// becomes the part on its left, the part on its right and the strip under it, of 14.4 + 14.4 +
    /// 1.2 m² in all as before.
    #[test]
    fn a_wall_parts_what_it_stands_on() {
        let mut scene = with_box(vec3(1.7, 0.0, 0.0), vec3(1.8, 3.0, 3.0));
        let before = area(&scene);
        assert_eq!((cut(&mut scene, false), scene.polygons.len(), scene.cut_edges.len()), (4, 20, 8));
        assert!(!straddles(&scene, 1.7) && !straddles(&scene, 1.8));
        assert!((area(&scene) - before).abs() < 1e-4, "{} m²", area(&scene));
        let (first, material) = (scene.polygons[1], MaterialId(0));
        assert!(first.material == material && scene.polygons.iter().all(|polygon| polygon.is_quad()));
        assert_eq!(cut(&mut scene, false), 0, "what is cut is not cut again");
    }

    /// Truth: legs cover little of their lines, a board is not tall, what stands along a wall parts
    /// no rooms, and a wall in front of which faces turn their backs stands on the other side.
    #[test]
    fn furniture_cuts_nothing() {
        for (lower, upper) in [
            (vec3(1.7, 0.0, 1.0), vec3(1.8, 1.0, 1.1)),
            (vec3(0.5, 0.0, 0.0), vec3(3.5, 0.1, 3.0)),
            (vec3(0.0, 0.0, 0.0), vec3(0.05, 2.0, 3.0)),
            (vec3(1.7, 1.0, 1.0), vec3(1.8, 2.0, 2.0)),
            (vec3(1.7, -1.0, 0.5), vec3(1.8, 0.0, 2.5)),
        ] {
            assert_eq!(cut(&mut with_box(lower, upper), false), 0, "box from {lower} to {upper}");
        }
    }

    /// Truth: parts of two triangles that share an edge meet in one vertex, and their surfaces stay
    /// joined beside the wall.
    #[test]
    fn triangles_of_one_floor_are_cut_alike() {
        let mut scene = with_box(vec3(1.7, 0.0, 0.0), vec3(1.8, 3.0, 3.0));
        let floor = scene.polygons.iter().position(|polygon| scene.normal(polygon).y > 0.9).expect("a floor");
        let floor = scene.polygons.remove(floor);
        let [a, b, c, d] = scene.corner_positions(&floor).0;
        let first = scene.vertices.len() as u32;
        scene.vertices.extend([a, b, c, d]);
        scene.polygons.push(Polygon::triangle([first, first + 1, first + 2], MaterialId(0), GroupId(0)));
        scene.polygons.push(Polygon::triangle([first, first + 2, first + 3], MaterialId(0), GroupId(0)));
        assert_eq!(cut(&mut scene, false), 5);
        let on_floor = |polygon: &&Polygon| {
            scene.corner_positions(polygon).0[..3].iter().all(|corner| corner.y == 0.0) && scene.normal(polygon).y > 0.0
        };
        let inner = scene.polygons.iter().filter(on_floor).flat_map(|polygon| {
            polygon
                .corners()
                .iter()
                .map(|&corner| scene.vertices[corner as usize])
                .filter(|at| at.z > 0.0 && at.z < 3.0)
        });
        // The diagonal crosses each side of the wall once, and three polygons or four meet there.
        let mut places: Vec<Bits> = inner.map(|at| bits(at.as_dvec3())).collect();
        places.sort_unstable();
        places.dedup();
        assert_eq!(places.len(), 2);
    }

    /// Truth: the other side of a face is the same face turned round, part by part.
    #[test]
    fn both_sides_are_cut_alike() {
        let scene = with_box(vec3(1.7, 0.0, 0.0), vec3(1.8, 3.0, 3.0));
        let (both, _) = orient::apply(scene, Sides::Both);
        // The four strips under the wall's ends lie on these: each is the other's second side.
        assert_eq!(both.polygons.len(), 40 - 8);
        let (fronts, backs) = both.polygons.split_at(20);
        for back in backs {
            assert!(back.is_back && fronts.iter().any(|front| front.flipped().corners() == back.corners()));
        }
        assert_eq!(both.skipped.cut_faces, 4);
    }
}
