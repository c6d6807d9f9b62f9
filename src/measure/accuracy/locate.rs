//! Where points lie in a lit mesh.

use rayon::prelude::*;

use glam::Vec3;

use crate::measure::reference::SurfacePoint;
use crate::solve::{Mesh, place_among};

/// A point's triangle and its barycentric weights there.
#[derive(Clone, Copy, Debug)]
pub struct Place {
    /// Index into [`Mesh::triangles`].
    pub triangle: u32,
    /// Weights of its three corners; they sum to 1.
    pub weights: Vec3,
}

/// The place of each point among the triangles of its own polygon; `None` where the mesh has none
/// of these.
pub fn locate(points: &[SurfacePoint], mesh: &Mesh) -> Vec<Option<Place>> {
    let polygon_of = |triangle: usize| mesh.leaves[mesh.triangle_leaf[triangle] as usize].polygon as usize;
    let polygons = mesh.leaves.iter().map(|leaf| leaf.polygon as usize + 1).max().unwrap_or(0);
    // Triangles sorted by polygon.
    let mut starts = vec![0_u32; polygons + 1];
    (0..mesh.triangles.len()).for_each(|triangle| starts[polygon_of(triangle) + 1] += 1);
    (0..polygons).for_each(|polygon| starts[polygon + 1] += starts[polygon]);
    let mut next = starts.clone();
    let mut sorted = vec![0_u32; mesh.triangles.len()];
    for triangle in 0..mesh.triangles.len() {
        let place = &mut next[polygon_of(triangle)];
        sorted[*place as usize] = triangle as u32;
        *place += 1;
    }
    let place = |point: &SurfacePoint| {
        let polygon = point.polygon as usize;
        let range = *starts.get(polygon)? as usize..*starts.get(polygon + 1)? as usize;
        let (triangle, weights) = place_among(mesh, sorted[range].iter().copied(), point.position)?;
        Some(Place { triangle, weights })
    };
    points.par_iter().map(place).collect()
}
