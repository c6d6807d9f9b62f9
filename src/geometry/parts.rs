//! Parts: polygons of a scene cut along lines, and put back into it.

use glam::DVec3;
use rustc_hash::FxHashMap;

use crate::scene::Scene;

/// A position in the f32 bits that the scene holds of it.
pub(super) type Bits = [u32; 3];

/// The bits of a position; −0 is 0.
pub(super) fn bits(position: DVec3) -> Bits {
    (position.as_vec3() + glam::Vec3::ZERO).to_array().map(f32::to_bits)
}

/// A convex part of a polygon.
#[derive(Clone, Debug)]
pub(super) struct Part {
    pub polygon: usize,
    pub corners: Vec<DVec3>,
}

/// Where a cut leaves a part.
pub(super) struct Halves {
    pub below: Vec<DVec3>,
    pub above: Vec<DVec3>,
    pub has_below: bool,
    pub has_above: bool,
    /// The new edge, where the line runs through the part.
    pub cut: Option<[DVec3; 2]>,
    /// The part's edges that it runs through.
    pub crossed: Vec<(Bits, Bits)>,
}

impl Halves {
    /// Cuts convex corners along a line, by their distances from it; those that are nearer than
    /// `thinnest` lie on it.
    pub fn of(corners: &[DVec3], distance: impl Fn(DVec3) -> f64, thinnest: f64) -> Self {
        let distance = |corner: &DVec3| Some(distance(*corner)).filter(|off| off.abs() > thinnest).unwrap_or(0.0);
        let off: Vec<f64> = corners.iter().map(distance).collect();
        let (has_below, has_above) = (off.iter().any(|off| *off < 0.0), off.iter().any(|off| *off > 0.0));
        let mut halves = Self { below: vec![], above: vec![], has_below, has_above, cut: None, crossed: vec![] };
        let mut ends = Vec::new();
        for (index, &corner) in corners.iter().enumerate() {
            let next = (index + 1) % corners.len();
            if off[index] <= 0.0 {
                halves.below.push(corner);
            }
            if off[index] >= 0.0 {
                halves.above.push(corner);
            }
            if off[index] == 0.0 {
                ends.push(corner);
            }
            if off[index] * off[next] < 0.0 {
                let between = between((corner, off[index]), (corners[next], off[next]));
                halves.below.push(between);
                halves.above.push(between);
                ends.push(between);
                halves.crossed.push((bits(corner), bits(corners[next])));
            }
        }
        if let (true, true, [from, to]) = (has_below, has_above, ends.as_slice()) {
            halves.cut = Some([*from, *to]);
        }
        halves
    }
}

/// Where a line crosses an edge; the same bits from either side of the edge.
fn between(a: (DVec3, f64), b: (DVec3, f64)) -> DVec3 {
    let ((from, near), (to, far)) = if a.0.to_array() <= b.0.to_array() { (a, b) } else { (b, a) };
    // As the scene will hold it.
    (from + near / (near - far) * (to - from)).as_vec3().as_dvec3()
}

/// Area of a planar convex polygon.
pub(super) fn area(corners: &[DVec3]) -> f64 {
    let fan = corners.windows(2).skip(1).map(|edge| (edge[0] - corners[0]).cross(edge[1] - corners[0]));
    0.5 * fan.sum::<DVec3>().length()
}

/// The edges of a polygon.
pub(super) fn edges(corners: &[DVec3]) -> impl Iterator<Item = (DVec3, DVec3)> + '_ {
    (0..corners.len()).map(|index| (corners[index], corners[(index + 1) % corners.len()]))
}

/// Puts parts into the places of their polygons: the first part of each takes its place, the others
/// follow behind all polygons. Returns how many polygons became several.
pub(super) fn replace(scene: &mut Scene, mut parts: Vec<Part>) -> usize {
    parts.sort_by_key(|part| part.polygon);
    let mut vertex_at: FxHashMap<Bits, u32> = FxHashMap::default();
    for part in &parts {
        for &corner in scene.polygons[part.polygon].corners() {
            vertex_at.insert(bits(scene.vertices[corner as usize].as_dvec3()), corner);
        }
    }
    let mut pieces: FxHashMap<usize, u32> = FxHashMap::default();
    for part in &parts {
        let vertices = &mut scene.vertices;
        let mut vertex = |corner: &DVec3| {
            *vertex_at.entry(bits(*corner)).or_insert_with(|| {
                vertices.push(corner.as_vec3());
                vertices.len() as u32 - 1
            })
        };
        let corners: Vec<u32> = part.corners.iter().map(&mut vertex).collect();
        let of = scene.polygons[part.polygon];
        // Quads and triangles around the first corner.
        for start in (1..corners.len().saturating_sub(1)).step_by(2) {
            let last = (start + 2).min(corners.len() - 1);
            let made = of.part(&[&corners[..1], &corners[start..=last]].concat());
            let count = pieces.entry(part.polygon).or_default();
            *count += 1;
            match *count {
                1 => scene.polygons[part.polygon] = made,
                _ => scene.polygons.push(made),
            }
        }
    }
    pieces.values().filter(|count| **count > 1).count()
}
