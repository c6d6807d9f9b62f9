//! Points on elements: area-weighted over a cluster's polygons, uniform on a patch.

use glam::Vec3;

use super::{ElementId, Hierarchy, Shape};

/// A point on a bright side.
#[derive(Clone, Copy, Debug)]
pub struct SurfacePoint {
    /// Position.
    pub position: Vec3,
    /// Unit normal of the bright side.
    pub normal: Vec3,
}

impl Hierarchy {
    /// The point of an element at `(u, v)` in the unit square; equal areas of the square are equal areas of the element.
    #[inline]
    pub fn point_on(&self, id: ElementId, u: f32, v: f32) -> SurfacePoint {
        let element = self.element(id);
        match &element.shape {
            Shape::Patch(patch) => {
                let (corners, count) = self.corner_positions(patch);
                let position = point_on_polygon(&corners[..count], u, v);
                SurfacePoint { position, normal: patch.normal }
            }
            Shape::Cluster(cluster) => {
                let first = cluster.first_patch as usize;
                let last = first + cluster.patch_count as usize;
                let (start, end) = (self.area_before[first], self.area_before[last]);
                let wanted = start + f64::from(u) * (end - start);
                let above = self.area_before[first + 1..last].partition_point(|&area| area <= wanted);
                let index = first + above;
                let (before, after) = (self.area_before[index], self.area_before[index + 1]);
                let rest = if after > before { (wanted - before) / (after - before) } else { 0.5 };
                self.point_on(self.initial_patches[index], (rest as f32).clamp(0.0, 1.0), v)
            }
        }
    }
}

/// The point of a triangle or convex quad at `(u, v)`, uniform by area.
fn point_on_polygon(corners: &[Vec3], u: f32, v: f32) -> Vec3 {
    match *corners {
        [a, b, c] => point_on_triangle(a, b, c, u, v),
        [a, b, c, d] => {
            let (first, second) = ((b - a).cross(c - a).length(), (c - a).cross(d - a).length());
            let share = first / (first + second);
            if (share - 0.5).abs() < 1e-4 && ((b - a) - (c - d)).length_squared() < 1e-8 * (c - a).length_squared() {
                // A parallelogram: keep the stratification of the square.
                a + u * (b - a) + v * (d - a)
            } else if u < share {
                point_on_triangle(a, b, c, u / share, v)
            } else {
                point_on_triangle(a, c, d, (u - share) / (1.0 - share), v)
            }
        }
        _ => unreachable!("a patch has three or four corners"),
    }
}

fn point_on_triangle(a: Vec3, b: Vec3, c: Vec3, u: f32, v: f32) -> Vec3 {
    let root = u.max(0.0).sqrt();
    a + root * ((1.0 - v) * (b - a) + v * (c - a))
}
