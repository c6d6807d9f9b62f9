//! Lines on a surface, and the faces that cover them.

use glam::DVec3;

use super::super::parts::{Halves, Part};

/// A plane through which cuts run, and where faces stand along its line on a surface.
pub(super) struct Line {
    pub(super) normal: DVec3,
    pub(super) offset: f64,
    pub(super) origin: DVec3,
    pub(super) direction: DVec3,
    /// Covered stretches by their distances from the origin.
    pub(super) covered: Vec<[f64; 2]>,
}

impl Line {
    pub(super) fn distance(&self, position: DVec3) -> f64 {
        self.normal.dot(position) - self.offset
    }

    pub(super) fn cover(&mut self, from: DVec3, to: DVec3) {
        let [a, b] = [from, to].map(|end| self.direction.dot(end - self.origin));
        self.covered.push([a.min(b), a.max(b)]);
    }

    /// Share of an edge on this line that faces cover.
    pub(super) fn covers(&self, edge: &[DVec3; 2]) -> f64 {
        let [a, b] = edge.map(|end| self.direction.dot(end - self.origin));
        let (first, last) = (a.min(b), a.max(b));
        let mut stretches: Vec<[f64; 2]> =
            self.covered.iter().map(|[from, to]| [from.max(first), to.min(last)]).filter(|[a, b]| a < b).collect();
        stretches.sort_unstable_by(|a, b| a[0].total_cmp(&b[0]));
        let (mut sum, mut reached) = (0.0, first);
        for [from, to] in stretches {
            sum += (to - from.max(reached)).max(0.0);
            reached = reached.max(to);
        }
        sum / (last - first)
    }

    /// Parts of a face on either side of the line; corners that are nearer lie on it.
    pub(super) fn halves(&self, part: &Part, thinnest: f64) -> Halves {
        Halves::of(&part.corners, |corner| self.distance(corner), thinnest)
    }
}

/// The stretch along which a face meets a plane, by the heights of its corners above it.
pub(super) fn foot(corners: &[DVec3], heights: &[f64], touching: f64) -> Option<[DVec3; 2]> {
    let mut meeting = Vec::with_capacity(4);
    for (index, &corner) in corners.iter().enumerate() {
        let next = (index + 1) % corners.len();
        let (here, there) = (heights[index], heights[next]);
        if here.abs() <= touching {
            meeting.push(corner);
        } else if there.abs() > touching && here * there < 0.0 {
            meeting.push(corner + here / (here - there) * (corners[next] - corner));
        }
    }
    let first = *meeting.first()?;
    let farthest = |from: DVec3| {
        meeting.iter().copied().max_by(|a, b| a.distance_squared(from).total_cmp(&b.distance_squared(from)))
    };
    let from = farthest(first)?;
    Some([from, farthest(from)?])
}
