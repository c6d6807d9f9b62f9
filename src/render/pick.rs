//! Which leaf lies under the mouse.

use glam::Vec3;
use rayon::prelude::*;

use crate::solve::snapshot::Mesh;

/// Triangles that one task looks at.
const CHUNK: usize = 1 << 14;

/// Where a ray first meets a bright side.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Picked {
    /// Index into [`Mesh::leaves`].
    pub leaf: u32,
    /// The point met.
    pub point: Vec3,
    /// Distance from the ray's origin, in lengths of its direction.
    pub distance: f32,
}

/// The first leaf along a ray that turns its bright side to it, as the picture shows it: backs are
/// looked through.
pub fn pick(mesh: &Mesh, origin: Vec3, direction: Vec3) -> Option<Picked> {
    let nearest = |(chunk, triangles): (usize, &[[u32; 3]])| {
        let met = triangles.iter().enumerate().filter_map(|(index, corners)| {
            let corners = mesh.corners(*corners);
            front_hit(corners, origin, direction).map(|distance| (distance, chunk * CHUNK + index))
        });
        met.min_by(nearer)
    };
    let (distance, triangle) = mesh.triangles.par_chunks(CHUNK).enumerate().filter_map(nearest).min_by(nearer)?;
    let leaf = mesh.triangle_leaf[triangle];
    Some(Picked { leaf, point: origin + distance * direction, distance })
}

/// By distance, then by index, so that the choice between equals does not depend on the threads.
fn nearer(a: &(f32, usize), b: &(f32, usize)) -> std::cmp::Ordering {
    a.0.total_cmp(&b.0).then(a.1.cmp(&b.1))
}

/// Distance to the front of a triangle, in lengths of the direction (Möller and Trumbore, JGT 2(1),
/// 1997).
fn front_hit([a, b, c]: [Vec3; 3], origin: Vec3, direction: Vec3) -> Option<f32> {
    let (ab, ac) = (b - a, c - a);
    let across = direction.cross(ac);
    let determinant = ab.dot(across);
    // Negative from behind, zero along the plane.
    if determinant <= 0.0 {
        return None;
    }
    let from_a = origin - a;
    let u = from_a.dot(across);
    let turned = from_a.cross(ab);
    let v = direction.dot(turned);
    if u < 0.0 || v < 0.0 || u + v > determinant {
        return None;
    }
    let distance = ac.dot(turned) / determinant;
    // What is not a number passed every test so far, but not this one.
    (distance > 0.0 && distance.is_finite()).then_some(distance)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Squares of side 2 around the z axis at these heights, facing +z, one leaf each.
    fn squares(heights: &[f32]) -> Mesh {
        let mut mesh = Mesh::default();
        for (leaf, &z) in heights.iter().enumerate() {
            let first = mesh.positions.len() as u32;
            mesh.positions.extend([[-1.0, -1.0, z], [1.0, -1.0, z], [1.0, 1.0, z], [-1.0, 1.0, z]]);
            mesh.triangles.extend([[first, first + 1, first + 2], [first, first + 2, first + 3]]);
            mesh.triangle_leaf.extend([leaf as u32; 2]);
        }
        mesh
    }

    #[test]
    fn the_nearest_front_is_picked() {
        let mesh = squares(&[0.0, 3.0, 1.0]);
        let picked = pick(&mesh, Vec3::new(0.2, 0.1, 5.0), -2.0 * Vec3::Z).expect("the ray meets all three");
        assert_eq!(picked, Picked { leaf: 1, point: Vec3::new(0.2, 0.1, 3.0), distance: 1.0 });
    }

    #[test]
    fn backs_misses_and_what_lies_behind_are_not_picked() {
        let mesh = squares(&[0.0]);
        assert_eq!(pick(&mesh, Vec3::new(0.0, 0.0, -5.0), Vec3::Z), None);
        assert_eq!(pick(&mesh, Vec3::new(1.5, 0.0, 5.0), -Vec3::Z), None);
        assert_eq!(pick(&mesh, Vec3::new(0.0, 0.0, 5.0), Vec3::Z), None);
        assert_eq!(pick(&mesh, Vec3::new(0.0, 0.0, 5.0), Vec3::NAN), None);
        assert_eq!(pick(&Mesh::default(), Vec3::ZERO, Vec3::Z), None);
    }
}
