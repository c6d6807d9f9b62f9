//! Lines on a surface, the faces that cover them, and the parts that they cut.

use glam::DVec3;

/// A position in the f32 bits that the scene holds of it.
pub(super) type Bits = [u32; 3];

/// A convex part of a polygon.
#[derive(Clone, Debug)]
pub(super) struct Part {
    pub(super) polygon: usize,
    pub(super) corners: Vec<DVec3>,
}

/// A plane through which cuts run, and where faces stand along its line on a surface.
pub(super) struct Line {
    pub(super) normal: DVec3,
    pub(super) offset: f64,
    pub(super) origin: DVec3,
    pub(super) direction: DVec3,
    /// Covered stretches by their distances from the origin.
    pub(super) covered: Vec<[f64; 2]>,
}

/// The bits of a position; −0 is 0.
pub(super) fn bits(position: DVec3) -> Bits {
    (position.as_vec3() + glam::Vec3::ZERO).to_array().map(f32::to_bits)
}

/// Where a cut leaves a part.
pub(super) struct Sides {
    pub(super) below: Vec<DVec3>,
    pub(super) above: Vec<DVec3>,
    pub(super) has_below: bool,
    pub(super) has_above: bool,
    /// The new edge, where the line runs through the part.
    pub(super) cut: Option<[DVec3; 2]>,
    /// The part's edges that it runs through.
    pub(super) crossed: Vec<(Bits, Bits)>,
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

    /// What lies on either side of the line; corners that are nearer lie on it.
    pub(super) fn sides(&self, part: &Part, thinnest: f64) -> Sides {
        let distance = |corner: &DVec3| Some(self.distance(*corner)).filter(|off| off.abs() > thinnest).unwrap_or(0.0);
        let off: Vec<f64> = part.corners.iter().map(distance).collect();
        let (has_below, has_above) = (off.iter().any(|off| *off < 0.0), off.iter().any(|off| *off > 0.0));
        let mut sides = Sides { below: vec![], above: vec![], has_below, has_above, cut: None, crossed: vec![] };
        let mut ends = Vec::new();
        for (index, &corner) in part.corners.iter().enumerate() {
            let next = (index + 1) % part.corners.len();
            if off[index] <= 0.0 {
                sides.below.push(corner);
            }
            if off[index] >= 0.0 {
                sides.above.push(corner);
            }
            if off[index] == 0.0 {
                ends.push(corner);
            }
            if off[index] * off[next] < 0.0 {
                let between = between((corner, off[index]), (part.corners[next], off[next]));
                sides.below.push(between);
                sides.above.push(between);
                ends.push(between);
                sides.crossed.push((bits(corner), bits(part.corners[next])));
            }
        }
        if let (true, true, [from, to]) = (has_below, has_above, ends.as_slice()) {
            sides.cut = Some([*from, *to]);
        }
        sides
    }
}

/// Where a line crosses an edge; the same bits from either side of the edge.
pub(super) fn between(a: (DVec3, f64), b: (DVec3, f64)) -> DVec3 {
    let ((from, near), (to, far)) = if a.0.to_array() <= b.0.to_array() { (a, b) } else { (b, a) };
    // As the scene will hold it.
    (from + near / (near - far) * (to - from)).as_vec3().as_dvec3()
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

/// Area of a planar convex polygon.
pub(super) fn area(corners: &[DVec3]) -> f64 {
    let fan = corners.windows(2).skip(1).map(|edge| (edge[0] - corners[0]).cross(edge[1] - corners[0]));
    0.5 * fan.sum::<DVec3>().length()
}

pub(super) fn edges(corners: &[DVec3]) -> impl Iterator<Item = (DVec3, DVec3)> + '_ {
    (0..corners.len()).map(|index| (corners[index], corners[(index + 1) % corners.len()]))
}
