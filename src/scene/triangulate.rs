//! Polygons cut into what the solver takes: triangles, and quads where they are convex and nearly
//! planar.
//!
//! Anything else is cut by ear clipping in the plane of its Newell normal, so that concave and
//! slightly non-planar polygons come out right.

use std::collections::VecDeque;

use glam::{DVec2, DVec3, Vec3};

/// A quad's fourth corner may lie this share of the longer diagonal away from the plane of the
/// others.
const QUAD_WARP: f64 = 0.02;

/// Twice the area of a corner's triangle, relative to the squared longest edge, below which the
/// corner is straight.
const STRAIGHT: f64 = 1e-6;

/// Twice the area vector of a polygon (Newell): its direction is the best-fit normal.
pub(super) fn newell(positions: &[Vec3]) -> DVec3 {
    let origin = positions.first().copied().unwrap_or_default().as_dvec3();
    let next = positions.iter().cycle().skip(1);
    positions.iter().zip(next).map(|(a, b)| (a.as_dvec3() - origin).cross(b.as_dvec3() - origin)).sum()
}

/// Squared length of the longest edge.
pub(super) fn longest_edge_squared(positions: &[Vec3]) -> f64 {
    let next = positions.iter().cycle().skip(1);
    positions.iter().zip(next).map(|(a, b)| a.as_dvec3().distance_squared(b.as_dvec3())).fold(0.0, f64::max)
}

/// Whether four corners make a quad that can stay one: strictly convex and nearly planar.
pub(super) fn is_good_quad(corners: [Vec3; 4]) -> bool {
    let [a, b, c, d] = corners.map(Vec3::as_dvec3);
    let normal = newell(&corners).normalize_or_zero();
    let smallest_turn = STRAIGHT * longest_edge_squared(&corners);
    let turns = [[d, a, b], [a, b, c], [b, c, d], [c, d, a]];
    if turns.iter().any(|[before, at, after]| (at - before).cross(after - at).dot(normal) <= smallest_turn) {
        return false;
    }
    let plane = (b - a).cross(c - a).normalize_or_zero();
    let diagonal = a.distance(c).max(b.distance(d));
    (d - a).dot(plane).abs() < QUAD_WARP * diagonal
}

/// Passes over all corners before any corner may be clipped; outlines that do not cross themselves
/// need one or two.
const MOST_PASSES: usize = 32;

/// Most effort of cutting, in comparisons of a corner with an ear: some seconds for a whole scene.
/// A modeller's outline of n corners takes some n²; outlines that cross themselves everywhere, made
/// to be slow, take more than anyone would wait for.
pub(super) struct Effort(u64);

impl Effort {
    /// For all polygons of a scene together.
    pub fn of_a_scene() -> Self {
        Self(1 << 30)
    }

    /// Whether outlines are cut anyhow by now.
    pub fn is_spent(&self) -> bool {
        self.0 == 0
    }

    fn spend(&mut self, comparisons: usize) {
        self.0 = self.0.saturating_sub(comparisons as u64);
    }
}

/// Cuts a polygon into triangles of corner numbers, wound as the polygon is; triangles without area
/// are left out.
///
/// Once the effort is spent, the triangles are any that the corners allow.
pub(super) fn ear_clip(positions: &[Vec3], effort: &mut Effort) -> Vec<[usize; 3]> {
    EarClipper::new(positions).run(effort)
}

/// How strict the search for the next ear is; each level is tried when the one before finds none.
#[derive(Clone, Copy, PartialEq)]
enum Strictness {
    /// No other corner inside the ear or on its rim.
    Strict,
    /// No other corner inside; on the rim is allowed (holes joined by a bridge).
    Touching,
    /// Any corner: the polygon crosses itself, and every triangulation is a guess.
    Any,
}

impl Strictness {
    fn next(self) -> Self {
        match self {
            Self::Strict => Self::Touching,
            Self::Touching | Self::Any => Self::Any,
        }
    }
}

/// The remaining polygon as a doubly linked ring over its corners in the best-fit plane.
struct EarClipper {
    points: Vec<DVec2>,
    next: Vec<usize>,
    previous: Vec<usize>,
    /// Corners that turn the wrong way; only these can lie in another corner's ear.
    reflex: Vec<usize>,
    smallest_turn: f64,
}

impl EarClipper {
    fn new(positions: &[Vec3]) -> Self {
        let normal = newell(positions).normalize_or(DVec3::Z);
        let (right, up) = normal.any_orthonormal_pair();
        let origin = positions.first().copied().unwrap_or_default().as_dvec3();
        let flat = |position: &Vec3| {
            let offset = position.as_dvec3() - origin;
            DVec2::new(offset.dot(right), offset.dot(up))
        };
        let points: Vec<DVec2> = positions.iter().map(flat).collect();
        let count = points.len();
        let mut clipper = Self {
            next: (0..count).map(|corner| (corner + 1) % count).collect(),
            previous: (0..count).map(|corner| (corner + count - 1) % count).collect(),
            reflex: Vec::new(),
            smallest_turn: STRAIGHT * longest_edge_squared(positions),
            points,
        };
        clipper.reflex = (0..count).filter(|&corner| clipper.turn(corner) <= clipper.smallest_turn).collect();
        clipper
    }

    /// Clips ears until nothing is left.
    ///
    /// A corner is tried again when a neighbour has gone, and all of them in a further pass, so
    /// that the work stays near corners × reflex corners even for outlines made to be slow.
    fn run(mut self, effort: &mut Effort) -> Vec<[usize; 3]> {
        let count = self.points.len();
        let mut triangles = Vec::with_capacity(count.saturating_sub(2));
        // Every second corner first, then every second of the rest: a round outline gives no fan of
        // slivers.
        let mut order: Vec<usize> = (0..count).collect();
        order.sort_by_key(|corner| corner.trailing_zeros());
        let mut removed = vec![false; count];
        let mut waiting = vec![true; count];
        let mut queue: VecDeque<usize> = order.iter().copied().collect();
        let mut strictness = Strictness::Strict;
        let mut passes = 0;
        let mut found_any = false;
        let mut remaining = count;
        while remaining > 2 {
            let Some(corner) = queue.pop_front() else {
                if !found_any || passes >= MOST_PASSES {
                    strictness = strictness.next();
                }
                found_any = false;
                passes += 1;
                queue.extend(order.iter().filter(|&&corner| !removed[corner]));
                waiting.fill(true);
                continue;
            };
            waiting[corner] = false;
            if effort.is_spent() {
                strictness = Strictness::Any;
                self.reflex.clear();
            }
            if removed[corner] {
                continue;
            }
            if !(remaining == 3 || self.is_ear(corner, strictness, effort)) {
                continue;
            }
            effort.spend(1 + self.reflex.len());
            let (before, after) = (self.previous[corner], self.next[corner]);
            if self.turn(corner).abs() > 0.0 {
                triangles.push([before, corner, after]);
            }
            self.remove(corner);
            removed[corner] = true;
            remaining -= 1;
            found_any = true;
            for neighbour in [before, after] {
                if !std::mem::replace(&mut waiting[neighbour], true) {
                    queue.push_back(neighbour);
                }
            }
        }
        triangles
    }

    /// Twice the signed area of the triangle at a corner; positive where the polygon is convex.
    fn turn(&self, corner: usize) -> f64 {
        let [a, b, c] = [self.previous[corner], corner, self.next[corner]].map(|index| self.points[index]);
        (b - a).perp_dot(c - b)
    }

    fn is_ear(&self, corner: usize, strictness: Strictness, effort: &mut Effort) -> bool {
        if strictness == Strictness::Any {
            return true;
        }
        if self.turn(corner) <= self.smallest_turn {
            return false;
        }
        let [a, b, c] = [self.previous[corner], corner, self.next[corner]].map(|index| self.points[index]);
        let blocks = |point: DVec2| {
            if point == a || point == b || point == c {
                return false;
            }
            let inside = (b - a).perp_dot(point - a).min((c - b).perp_dot(point - b)).min((a - c).perp_dot(point - c));
            match strictness {
                Strictness::Strict => inside >= -self.smallest_turn,
                Strictness::Touching | Strictness::Any => inside > self.smallest_turn,
            }
        };
        let blocker = self.reflex.iter().position(|&other| blocks(self.points[other]));
        effort.spend(blocker.unwrap_or(self.reflex.len()));
        blocker.is_none()
    }

    fn remove(&mut self, corner: usize) {
        let (before, after) = (self.previous[corner], self.next[corner]);
        self.next[before] = after;
        self.previous[after] = before;
        let (turn_before, turn_after) = (self.turn(before), self.turn(after));
        let smallest = self.smallest_turn;
        self.reflex.retain(|&other| {
            other != corner
                && !(other == before && turn_before > smallest)
                && !(other == after && turn_after > smallest)
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn area_of(triangles: &[[usize; 3]], positions: &[Vec3]) -> f64 {
        let twice = |&[a, b, c]: &[usize; 3]| newell(&[positions[a], positions[b], positions[c]]).length();
        triangles.iter().map(|triangle| 0.5 * twice(triangle)).sum()
    }

    fn flat(outline: &[[f32; 2]]) -> Vec<Vec3> {
        outline.iter().map(|&[x, y]| Vec3::new(x, y, 0.25 * x)).collect()
    }

    /// Truth: the area of the polygon by the shoelace (Newell) formula, the winding of every
    /// triangle, and n − 2 triangles for a polygon without straight corners.
    #[test]
    fn concave_outlines_keep_area_and_winding() {
        let arrow = flat(&[[0.0, 0.0], [2.0, -1.0], [1.0, 0.0], [2.0, 1.0]]);
        let letter_l = flat(&[[0.0, 0.0], [3.0, 0.0], [3.0, 1.0], [1.0, 1.0], [1.0, 3.0], [0.0, 3.0]]);
        let comb = flat(&[
            [0.0, 0.0],
            [5.0, 0.0],
            [5.0, 3.0],
            [4.0, 3.0],
            [4.0, 1.0],
            [3.0, 1.0],
            [3.0, 3.0],
            [2.0, 3.0],
            [2.0, 1.0],
            [1.0, 1.0],
            [1.0, 3.0],
            [0.0, 3.0],
        ]);
        for outline in [arrow, letter_l, comb] {
            for turned in 0..outline.len() {
                let mut outline = outline.clone();
                outline.rotate_left(turned);
                let triangles = ear_clip(&outline, &mut Effort::of_a_scene());
                assert_eq!(triangles.len(), outline.len() - 2);
                let normal = newell(&outline);
                let area = area_of(&triangles, &outline);
                assert!((area - 0.5 * normal.length()).abs() < 1e-6 * area, "{area} of {}", 0.5 * normal.length());
                for &[a, b, c] in &triangles {
                    assert!(newell(&[outline[a], outline[b], outline[c]]).dot(normal) > 0.0);
                }
            }
        }
    }

    /// Truth: corners on a straight edge are kept as corners of triangles with area, none is lost.
    #[test]
    fn straight_corners_are_used() {
        let outline = flat(&[[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0]]);
        let triangles = ear_clip(&outline, &mut Effort::of_a_scene());
        assert_eq!(triangles.len(), 3);
        assert!(triangles.iter().all(|triangle| area_of(&[*triangle], &outline) > 0.1));
        assert!((0..5).all(|corner| triangles.iter().any(|triangle| triangle.contains(&corner))));
    }

    /// Truth: a square ring cut open by a bridge has area 9 − 1.
    #[test]
    fn a_hole_joined_by_a_bridge_stays_open() {
        let outline: Vec<Vec3> = [
            [0.0, 0.0],
            [3.0, 0.0],
            [3.0, 3.0],
            [0.0, 3.0],
            [0.0, 0.0],
            [1.0, 1.0],
            [1.0, 2.0],
            [2.0, 2.0],
            [2.0, 1.0],
            [1.0, 1.0],
        ]
        .iter()
        .map(|&[x, y]| Vec3::new(x, y, 0.0))
        .collect();
        assert!((area_of(&ear_clip(&outline, &mut Effort::of_a_scene()), &outline) - 8.0).abs() < 1e-9);
    }

    /// Truth: the area by the shoelace formula; two windings of a spiral corridor, and a star that
    /// crosses itself, both with thousands of corners, are cut with a part of the effort that a
    /// scene may take.
    #[test]
    fn long_outlines_are_quick() {
        let mut effort = Effort::of_a_scene();
        let on_spiral = |step: usize, offset: f32| {
            let angle = step as f32 * 0.01;
            let radius = offset + 0.5 * angle;
            Vec3::new(radius * angle.cos(), radius * angle.sin(), 0.0)
        };
        let there = (0..2000).map(|step| on_spiral(step, 1.0));
        let back = (0..2000).rev().map(|step| on_spiral(step, 2.0));
        let spiral: Vec<Vec3> = back.chain(there).collect();
        let triangles = ear_clip(&spiral, &mut effort);
        let (area, expected) = (area_of(&triangles, &spiral), 0.5 * newell(&spiral).length());
        assert!((area - expected).abs() < 1e-4 * expected, "{area} of {expected}");
        let star: Vec<Vec3> =
            (0..4001).map(|step| Vec3::new((step as f32 * 2.9).cos(), (step as f32 * 2.9).sin(), 0.0)).collect();
        ear_clip(&star, &mut effort);
        assert!(effort.0 > Effort::of_a_scene().0 / 2, "{} comparisons", Effort::of_a_scene().0 - effort.0);
    }

    /// Truth: n − 2 triangles over all corners, right or wrong; and no more comparisons than were
    /// allowed, but for one ear.
    #[test]
    fn cutting_ends_when_the_effort_is_spent() {
        let inward_arc = |step: usize| {
            let angle = step as f32 / 1000.0 * 1.5;
            if step == 0 { Vec3::ZERO } else { Vec3::new(10.0 - 9.0 * angle.cos(), 10.0 - 9.0 * angle.sin(), 0.0) }
        };
        let outline: Vec<Vec3> = (0..1000).map(inward_arc).collect();
        for allowed in [0, 1, 10_000, 1 << 30] {
            let mut effort = Effort(allowed);
            assert_eq!(ear_clip(&outline, &mut effort).len(), 998, "with {allowed}");
            assert_eq!(effort.is_spent(), allowed <= 10_000);
        }
    }

    /// Truth: whatever it is, an outline that crosses itself ends and gives at most n − 2
    /// triangles.
    #[test]
    fn crossing_outlines_end() {
        let bow = flat(&[[0.0, 0.0], [1.0, 1.0], [1.0, 0.0], [0.0, 1.0], [0.5, 3.0]]);
        assert!(ear_clip(&bow, &mut Effort::of_a_scene()).len() <= 3);
        assert!(ear_clip(&[Vec3::ONE; 7], &mut Effort::of_a_scene()).is_empty());
    }

    /// Truth: the definition, at both sides of its bounds (2 % of a diagonal of √2 is 0.028).
    #[test]
    fn quads_stay_where_convex_and_flat() {
        let quad = |x: f32, y: f32, z: f32| [Vec3::ZERO, Vec3::X, Vec3::new(1.0, 1.0, 0.0), Vec3::new(x, y, z)];
        assert!(is_good_quad(quad(0.0, 1.0, 0.0)));
        assert!(is_good_quad(quad(0.0, 1.0, 0.027)));
        assert!(!is_good_quad(quad(0.0, 1.0, 0.03)));
        assert!(!is_good_quad(quad(0.7, 0.3, 0.0)), "concave");
        assert!(!is_good_quad(quad(0.5, 0.5, 0.0)), "straight corner");
        assert!(!is_good_quad(quad(2.0, -0.5, 0.0)), "crossing");
    }
}
