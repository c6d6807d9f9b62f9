//! Probing: irradiance and radiosity at points on surfaces, interpolated as the picture shows them.
//!
//! Both come from vertex values (a vertex is the weighted mean of the leaves around it) by the
//! barycentric weights of the triangle that holds the point.

use std::time::Duration;

use glam::{Vec3, Vec3A};
use obvhs::BvhBuildParams;
use obvhs::aabb::Aabb;
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::builder::build_bvh2_from_tris;
use obvhs::triangle::Triangle;

use crate::solve::{Mesh, barycentric};

/// A point farther than this share of the scene's size (the diagonal of its box) from every surface
/// lies on none.
const TOLERANCE: f32 = 1e-3;

/// A lit mesh in which points are looked up.
pub struct Probe<'a> {
    mesh: &'a Mesh,
    /// E and B of each vertex, W/m².
    irradiance: &'a [[f32; 3]],
    radiosity: &'a [[f32; 3]],
    bvh: Bvh2,
    /// Largest distance between a point and its surface, in the scene's length unit.
    tolerance: f32,
}

/// Light that a surface receives and sends at a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    /// Irradiance E, W/m².
    pub irradiance: Vec3,
    /// Radiosity B, W/m².
    pub radiosity: Vec3,
}

/// The point of a triangle nearest to another point.
struct Nearest {
    distance_squared: f32,
    /// Barycentric weights of the three corners.
    weights: Vec3,
}

impl<'a> Probe<'a> {
    /// A probe of a mesh; `irradiance` and `radiosity` are those of its vertices, W/m².
    pub fn new(mesh: &'a Mesh, irradiance: &'a [[f32; 3]], radiosity: &'a [[f32; 3]]) -> Self {
        let triangles: Vec<Triangle> = (0..mesh.triangles.len())
            .map(|index| {
                let [v0, v1, v2] = mesh.corners(mesh.triangles[index]).map(Vec3A::from);
                Triangle { v0, v1, v2 }
            })
            .collect();
        let bvh = build_bvh2_from_tris(&triangles, BvhBuildParams::fast_build(), &mut Duration::default());
        let positions = mesh.positions.iter().map(|position| Vec3::from(*position));
        let bounds = positions.fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(lower, upper), position| {
            (lower.min(position), upper.max(position))
        });
        let size = if mesh.positions.is_empty() { 0.0 } else { (bounds.1 - bounds.0).length() };
        Self { mesh, irradiance, radiosity, bvh, tolerance: TOLERANCE * size }
    }

    /// E and B on the nearest surface that is bright towards `normal` (of any length); `None` where
    /// the point lies on no surface or on ones that face away only.
    pub fn at(&self, point: Vec3, normal: Vec3) -> Option<Sample> {
        let (triangle, nearest) = self.nearest(point, normal)?;
        let interpolated = |values: &[[f32; 3]]| {
            let corners = self.mesh.triangles[triangle].map(|vertex| Vec3::from(values[vertex as usize]));
            nearest.weights.x * corners[0] + nearest.weights.y * corners[1] + nearest.weights.z * corners[2]
        };
        Some(Sample { irradiance: interpolated(self.irradiance), radiosity: interpolated(self.radiosity) })
    }

    /// The nearest place on a surface that is bright towards `normal` (of any length), and the
    /// polygon of the scene that it lies on.
    pub fn place(&self, point: Vec3, normal: Vec3) -> Option<(Vec3, u32)> {
        let (triangle, nearest) = self.nearest(point, normal)?;
        let [a, b, c] = self.mesh.corners(self.mesh.triangles[triangle]);
        let weights = nearest.weights;
        let leaf = self.mesh.triangle_leaf[triangle] as usize;
        Some((weights.x * a + weights.y * b + weights.z * c, self.mesh.leaves[leaf].polygon))
    }

    fn nearest(&self, point: Vec3, normal: Vec3) -> Option<(usize, Nearest)> {
        let around = Aabb::new((point - self.tolerance).into(), (point + self.tolerance).into());
        let mut best: Option<(usize, Nearest)> = None;
        self.bvh.aabb_traverse(around, |bvh, node| {
            let node = &bvh.nodes[node as usize];
            let primitives = node.first_index as usize..(node.first_index + node.prim_count) as usize;
            for &triangle in &bvh.primitive_indices[primitives] {
                let triangle = triangle as usize;
                let corners = self.mesh.corners(self.mesh.triangles[triangle]);
                if facing(corners, normal) <= 0.0 {
                    continue;
                }
                let found = nearest_on_triangle(corners, point);
                // Between equals, on an edge, the first of the file: the result does not depend on
                // the tree.
                let key = |index: usize, nearest: &Nearest| (nearest.distance_squared, index);
                if best.as_ref().is_none_or(|(index, nearest)| key(triangle, &found) < key(*index, nearest)) {
                    best = Some((triangle, found));
                }
            }
            true
        });
        best.filter(|(_, nearest)| nearest.distance_squared <= self.tolerance * self.tolerance)
    }
}

/// Positive where the bright side of a triangle looks along `normal`.
fn facing([a, b, c]: [Vec3; 3], normal: Vec3) -> f32 {
    (b - a).cross(c - a).dot(normal)
}

/// The nearest point of a triangle: its projection where that lies inside, else the nearest point
/// of an edge.
fn nearest_on_triangle([a, b, c]: [Vec3; 3], point: Vec3) -> Nearest {
    let across = (b - a).cross(c - a);
    let area_squared = across.length_squared();
    let weights = barycentric([a, b, c], point);
    if area_squared > 0.0 && weights.min_element() >= 0.0 {
        let distance = (point - a).dot(across) / area_squared.sqrt();
        return Nearest { distance_squared: distance * distance, weights };
    }
    let edges = [(a, b, Vec3::X, Vec3::Y), (b, c, Vec3::Y, Vec3::Z), (c, a, Vec3::Z, Vec3::X)];
    let on_edges = edges.map(|(from, to, from_weight, to_weight)| {
        let length_squared = (to - from).length_squared();
        let along = if length_squared > 0.0 { (point - from).dot(to - from) / length_squared } else { 0.0 };
        let along = along.clamp(0.0, 1.0);
        let distance_squared = point.distance_squared(from.lerp(to, along));
        Nearest { distance_squared, weights: from_weight.lerp(to_weight, along) }
    });
    let [first, second, third] = on_edges;
    let nearer = |a: Nearest, b: Nearest| if b.distance_squared < a.distance_squared { b } else { a };
    nearer(nearer(first, second), third)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two unit squares of one triangle pair each, facing +z at z = 0 and −z at z = −0.5.
    fn mesh() -> Mesh {
        Mesh {
            positions: [(0.0, 1.0), (-0.5, 1.0)]
                .iter()
                .flat_map(|&(z, side)| [[0.0, 0.0, z], [side, 0.0, z], [side, side, z], [0.0, side, z]])
                .collect(),
            triangles: vec![[0, 1, 2], [0, 2, 3], [4, 6, 5], [4, 7, 6]],
            ..Mesh::default()
        }
    }

    /// Truth: barycentric interpolation reproduces a linear function exactly (f32 rounding only).
    #[test]
    fn linear_values_come_back() {
        let mesh = mesh();
        let value = |[x, y, z]: [f32; 3]| [1.0 + x, 2.0 * y - x, 4.0 + z];
        let radiosity: Vec<[f32; 3]> = mesh.positions.iter().map(|position| value(*position)).collect();
        let irradiance: Vec<[f32; 3]> = radiosity.iter().map(|value| value.map(|value| 2.0 * value)).collect();
        let probe = Probe::new(&mesh, &irradiance, &radiosity);
        for (x, y) in [(0.3, 0.2), (0.2, 0.7), (0.5, 0.5), (0.0, 0.0), (1.0, 0.25)] {
            let sample = probe.at(Vec3::new(x, y, 0.0), Vec3::Z).expect("a point on the square");
            let expected = Vec3::from(value([x, y, 0.0]));
            assert!((sample.radiosity - expected).length() < 1e-5, "{x} {y}: {sample:?}");
            assert!((sample.irradiance - 2.0 * expected).length() < 1e-5);
        }
    }

    /// Truth: the definition; the scene's size is that of a box of 1 × 1 × ½, 1.5.
    #[test]
    fn points_off_the_surfaces_or_behind_them_have_no_value() {
        let mesh = mesh();
        let values = vec![[1.0; 3]; mesh.positions.len()];
        let probe = Probe::new(&mesh, &values, &values);
        let at = |x: f32, z: f32, normal: Vec3| probe.at(Vec3::new(x, 0.5, z), normal).is_some();
        assert!(at(0.5, 0.0, Vec3::Z) && at(0.5, 0.001, Vec3::Z) && at(0.5, -0.001, Vec3::new(2.0, 0.0, 0.1)));
        assert!(at(1.001, 0.0, Vec3::Z), "just beside the rim");
        assert!(!at(0.5, 0.002, Vec3::Z) && !at(1.002, 0.0, Vec3::Z), "too far away");
        assert!(!at(0.5, 0.0, Vec3::NEG_Z), "from behind");
        assert!(at(0.5, -0.5, Vec3::NEG_Z) && !at(0.5, -0.5, Vec3::Z));
        assert!(Probe::new(&Mesh::default(), &[], &[]).at(Vec3::ZERO, Vec3::Z).is_none());
    }
}
