//! How two lit meshes of one scene differ, whatever their subdivision.

use glam::Vec3;
use rayon::prelude::*;

use crate::base::photometry::weighted;
use crate::read::probe::Probe;
use crate::solve::{Mesh, Snapshot};

/// Differences are relative to the former's luminance, but to no less than this share of its mean:
/// where next to no light is, any is many times as much.
const LEAST_SHARE: f32 = 0.01;
/// Vertices are looked up this far towards the middle of a triangle, as a share of the way: on an
/// edge between two materials either could answer.
const INWARDS: f32 = 0.02;

/// The difference between two solutions.
#[derive(Clone, Debug, PartialEq)]
pub struct Contrast {
    /// (B − A) / A in luminance at each vertex of B's mesh; NaN where A has no surface.
    pub at_vertices: Vec<f32>,
    /// RMS of B − A over the area that both have, all colours together, as a share of A's RMS.
    pub rms: f64,
}

/// Looks up solution `a` at the vertices of solution `b`.
pub fn contrast(a: &Snapshot, b: &Snapshot) -> Contrast {
    let probe = Probe::new(&a.mesh, &a.vertex_radiosity, &a.vertex_radiosity);
    let floor = LEAST_SHARE * mean_luminance(a);
    let mesh = &b.mesh;
    let pairs: Vec<Option<[Vec3; 2]>> = triangle_of_vertices(mesh)
        .par_iter()
        .enumerate()
        .with_min_len(256)
        .map(|(vertex, &triangle)| {
            let corners = mesh.triangles.get(triangle as usize)?;
            let mean =
                |values: &[[f32; 3]]| corners.iter().map(|&at| Vec3::from(values[at as usize])).sum::<Vec3>() / 3.0;
            let inwards = |values: &[[f32; 3]]| Vec3::from(values[vertex]).lerp(mean(values), INWARDS);
            let [p, q, r] = mesh.corners(*corners);
            let of_a = probe.at(inwards(&mesh.positions), (q - p).cross(r - p))?.radiosity;
            Some([of_a, inwards(&b.vertex_radiosity)])
        })
        .collect();
    let relative = |pair: &Option<[Vec3; 2]>| {
        pair.map_or(f32::NAN, |[a, b]| (luminance(b) - luminance(a)) / luminance(a).max(floor).max(f32::MIN_POSITIVE))
    };
    Contrast { at_vertices: pairs.iter().map(relative).collect(), rms: rms(mesh, &pairs) }
}

/// A triangle of each vertex; beyond the last where there is none.
fn triangle_of_vertices(mesh: &Mesh) -> Vec<u32> {
    let mut triangles = vec![u32::MAX; mesh.positions.len()];
    for (index, corners) in (0_u32..).zip(&mesh.triangles) {
        corners.iter().for_each(|&vertex| triangles[vertex as usize] = index);
    }
    triangles
}

/// Root of the mean square difference over the triangles, each by its corners, over that of A; 0
/// where A is dark.
fn rms(mesh: &Mesh, pairs: &[Option<[Vec3; 2]>]) -> f64 {
    let (mut squares, mut reference) = (0.0, 0.0);
    for corners in &mesh.triangles {
        let [p, q, r] = mesh.corners(*corners);
        let area = f64::from((q - p).cross(r - p).length());
        for [a, b] in corners.iter().filter_map(|&vertex| pairs[vertex as usize]) {
            squares += area * f64::from((b - a).length_squared());
            reference += area * f64::from(a.length_squared());
        }
    }
    if reference > 0.0 { (squares / reference).sqrt() } else { 0.0 }
}

/// Over the leaves' area, W/m².
fn mean_luminance(snapshot: &Snapshot) -> f32 {
    let leaves = snapshot.mesh.leaves.iter().zip(&snapshot.leaf_radiosity);
    let (light, area) = leaves.fold((0.0_f64, 0.0_f64), |(light, area), (leaf, radiosity)| {
        let own = f64::from(leaf.area);
        (light + own * f64::from(luminance(Vec3::from(*radiosity))), area + own)
    });
    if area > 0.0 { (light / area) as f32 } else { 0.0 }
}

fn luminance(radiosity: Vec3) -> f32 {
    weighted(radiosity.to_array())
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::solve::Leaf;

    /// A square of side 1 at z = 0 in n × n quads, lit by a function of x.
    fn lit(n: usize, light: impl Fn(f32) -> f32) -> Snapshot {
        let at = |index: usize| [(index % (n + 1)) as f32 / n as f32, (index / (n + 1)) as f32 / n as f32, 0.0];
        let positions: Vec<[f32; 3]> = (0..(n + 1) * (n + 1)).map(at).collect();
        let quad = |index: usize| {
            let low = ((index / n) * (n + 1) + index % n) as u32;
            let high = low + n as u32 + 1;
            [[low, low + 1, high + 1], [low, high + 1, high]]
        };
        let vertex_radiosity = positions.iter().map(|[x, ..]| [light(*x); 3]).collect();
        let leaf = Leaf::square_metre(1, 0);
        let triangles: Vec<[u32; 3]> = (0..n * n).flat_map(quad).collect();
        let triangle_leaf = vec![0; triangles.len()];
        Snapshot {
            mesh: Arc::new(Mesh { positions, triangles, triangle_leaf, leaves: vec![leaf], ..Mesh::default() }),
            vertex_radiosity,
            leaf_irradiance: vec![[1.0; 3]],
            leaf_radiosity: vec![[1.0; 3]],
            ..Snapshot::default()
        }
    }

    /// Truth: the functions. Linear light is interpolated exactly on either mesh.
    #[test]
    fn meshes_of_other_subdivision_are_compared_where_they_are() {
        let (a, b) = (lit(3, |x| 1.0 + x), lit(7, |x| 1.5 * (1.0 + x)));
        let found = contrast(&a, &b);
        assert!(found.at_vertices.iter().all(|value| (value - 0.5).abs() < 1e-4), "{:?}", found.at_vertices);
        assert!((found.rms - 0.5).abs() < 1e-4, "{}", found.rms);
        let same = contrast(&a, &lit(5, |x| 1.0 + x));
        assert!(same.rms < 1e-5, "{}", same.rms);
    }

    #[test]
    fn what_one_of_them_lacks_is_unknown() {
        let mut elsewhere = lit(2, |_| 1.0);
        let mesh = Arc::make_mut(&mut elsewhere.mesh);
        mesh.positions.iter_mut().for_each(|position| position[2] = 5.0);
        let found = contrast(&lit(2, |_| 1.0), &elsewhere);
        assert!(found.at_vertices.iter().all(|value| value.is_nan()) && found.rms == 0.0);
    }
}
