//! Values at scattered points spread over a lit mesh, for a picture.

use glam::Vec3;
use rayon::prelude::*;
use rustc_hash::FxHashMap;

use crate::measure::reference::SurfacePoint;
use crate::solve::Mesh;

/// A vertex takes the values of so many points at most, the nearest.
const NEAREST: usize = 4;
/// Points are looked for within this many times their mean spacing.
const REACH: f32 = 2.0;
/// Points this near, as a share of the reach, count alike.
const BLUR: f32 = 0.15;
/// Points of faces turned farther apart than this cosine say nothing about each other.
const LEAST_COSINE: f32 = 0.9;
/// Nor do points that lie off the vertex's plane by more than this share of the reach.
const MOST_OFF_PLANE: f32 = 0.15;

/// Which points each vertex of a mesh takes its value from, and by what weights.
pub struct ScatteredField(Vec<[(u32, f32); NEAREST]>);

impl ScatteredField {
    /// Finds the points near each vertex that lie on surfaces like its own.
    pub fn new(points: &[SurfacePoint], mesh: &Mesh) -> Self {
        let area: f32 = mesh.leaves.iter().map(|leaf| leaf.area).sum();
        let reach = REACH * (area / points.len().max(1) as f32).sqrt().max(f32::MIN_POSITIVE);
        let cell_of = |position: Vec3| (position / reach).floor().as_ivec3();
        let mut cells: FxHashMap<glam::IVec3, Vec<u32>> = FxHashMap::default();
        for (index, point) in points.iter().enumerate() {
            cells.entry(cell_of(point.position)).or_default().push(index as u32);
        }
        let near = |(position, normal): (&[f32; 3], &Vec3)| {
            let position = Vec3::from(*position);
            let mut found = [(0, f32::INFINITY); NEAREST];
            for offset in 0..27 {
                let cell = cell_of(position) + glam::IVec3::new(offset % 3 - 1, offset / 3 % 3 - 1, offset / 9 - 1);
                for &index in cells.get(&cell).into_iter().flatten() {
                    let point = &points[index as usize];
                    let span = point.position - position;
                    let fits = point.normal.dot(*normal) >= LEAST_COSINE
                        && span.dot(point.normal).abs() <= MOST_OFF_PLANE * reach;
                    let distance = span.length_squared();
                    let place = found.partition_point(|&(_, other)| other <= distance);
                    if fits && distance <= reach * reach && place < NEAREST {
                        found[place..].rotate_right(1);
                        found[place] = (index, distance);
                    }
                }
            }
            let blur = (BLUR * reach).powi(2);
            found.map(|(index, distance)| (index, (distance + blur).recip()))
        };
        let normals = vertex_normals(mesh);
        Self(mesh.positions.par_iter().zip(&normals).with_min_len(256).map(near).collect())
    }

    /// The value at each vertex; NaN where no point is near.
    pub fn at_vertices(&self, values: &[f32]) -> Vec<f32> {
        let mean = |near: &[(u32, f32); NEAREST]| {
            let known = near.iter().filter(|(_, weight)| *weight > 0.0);
            let (sum, weight) = known
                .map(|&(index, weight)| (values[index as usize], weight))
                .filter(|(value, _)| value.is_finite())
                .fold((0.0, 0.0), |(sum, total), (value, weight)| (sum + weight * value, total + weight));
            if weight > 0.0 { sum / weight } else { f32::NAN }
        };
        self.0.par_iter().with_min_len(1024).map(mean).collect()
    }
}

fn vertex_normals(mesh: &Mesh) -> Vec<Vec3> {
    let mut normals = vec![Vec3::ZERO; mesh.positions.len()];
    for triangle in &mesh.triangles {
        let [a, b, c] = mesh.corners(*triangle);
        let across = (b - a).cross(c - a);
        triangle.iter().for_each(|&vertex| normals[vertex as usize] += across);
    }
    normals.into_iter().map(Vec3::normalize_or_zero).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::solve::Leaf;

    /// Two squares back to back: each takes the values of its own points only, and one without
    /// points knows nothing.
    #[test]
    fn values_stay_on_their_own_side() {
        let leaf = |polygon| Leaf::square_metre(polygon, polygon);
        let corners = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
        let mesh = Mesh {
            positions: corners.into_iter().chain(corners).chain(corners.map(|[x, y, _]| [x, y, 50.0])).collect(),
            triangles: vec![[0, 1, 2], [0, 2, 3], [6, 5, 4], [7, 6, 4], [8, 9, 10], [8, 10, 11]],
            triangle_leaf: vec![0, 0, 1, 1, 2, 2],
            leaves: vec![leaf(0), leaf(1), leaf(2)],
            ..Mesh::default()
        };
        let point = |z: f32| SurfacePoint {
            position: Vec3::new(0.5, 0.5, 0.0),
            normal: z * Vec3::Z,
            polygon: 0,
            reflectance: Vec3::ONE,
            weight: 1.0,
        };
        let field = ScatteredField::new(&[point(1.0), point(-1.0)], &mesh);
        let values = field.at_vertices(&[3.0, -2.0]);
        let are = |values: &[f32], truth: f32| values.iter().all(|value| (value - truth).abs() < 1e-5);
        assert!(are(&values[..4], 3.0) && are(&values[4..8], -2.0), "{values:?}");
        assert!(values[8..].iter().all(|value| value.is_nan()), "{values:?}");
    }
}
