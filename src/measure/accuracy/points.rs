//! Reference points at the vertices of a lit mesh, for differences that a view draws.

use glam::Vec3;

use crate::measure::reference::SurfacePoint;
use crate::scene::Scene;
use crate::solve::Mesh;

/// How far from its vertex towards the middle of a triangle a point lies: at the vertex itself the
/// next wall may begin.
const INSET: f32 = 0.02;

/// One point for each mesh vertex, in the order of [`Mesh::positions`], a little inside one of its
/// triangles.
pub fn vertex_points(scene: &Scene, mesh: &Mesh) -> Vec<SurfacePoint> {
    let mut points: Vec<Option<SurfacePoint>> = vec![None; mesh.positions.len()];
    let position = |vertex: u32| Vec3::from(mesh.positions[vertex as usize]);
    for (triangle, leaf) in mesh.triangles.iter().zip(&mesh.triangle_leaf) {
        let polygon = mesh.leaves[*leaf as usize].polygon;
        let middle = triangle.map(position).iter().sum::<Vec3>() / 3.0;
        for &vertex in triangle {
            let at = || SurfacePoint::on(scene, polygon, position(vertex).lerp(middle, INSET));
            points[vertex as usize].get_or_insert_with(at);
        }
    }
    // A vertex without a triangle is drawn nowhere; any point does.
    let nowhere =
        SurfacePoint { position: Vec3::ZERO, normal: Vec3::Z, polygon: 0, reflectance: Vec3::ZERO, weight: 1.0 };
    points.into_iter().map(|point| point.unwrap_or(nowhere)).collect()
}
