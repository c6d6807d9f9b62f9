//! obvhs without us.

use std::time::Duration;

use glam::{Vec3, Vec3A};
use obvhs::BvhBuildParams;
use obvhs::cwbvh::{CwBvh, builder::build_cwbvh_from_tris};
use obvhs::ray::{Ray, RayHit};
use obvhs::triangle::Triangle;
use selflink::scene::Scene;

use super::rooms::FaceRay;

/// Rays that leave a face start so far in front of it, in the size that the scene has here.
const LIFT: f32 = 1e-4;

/// The faces of a scene in obvhs' compressed tree, and rays that wait to be traced.
pub struct Alone {
    bvh: CwBvh,
    triangles: Vec<Triangle>,
    rays: Vec<Ray>,
    scale: f32,
}

impl Alone {
    /// Makes the tree and the rays ready.
    pub fn new(scene: &Scene, segments: &[[Vec3; 2]]) -> Self {
        let (lower, upper) = scene.bounds();
        let extent = lower.abs().max(upper.abs()).max_element();
        let scale = 32.0 * (-extent.log2().floor()).exp2();
        let in_bvh = |point: Vec3| Vec3A::from(scale * point);
        let mut triangles = Vec::new();
        for polygon in scene.polygons.iter().filter(|polygon| !polygon.is_back) {
            let ([a, b, c, d], count) = scene.corner_positions(polygon);
            for corners in [[a, b, c], [a, c, d]].into_iter().take(count - 2) {
                let [v0, v1, v2] = corners.map(in_bvh);
                triangles.push(Triangle { v0, v1, v2 });
            }
        }
        let params = BvhBuildParams {
            search_depth_threshold: 0,
            reinsertion_batch_ratio: 0.5,
            ..BvhBuildParams::medium_build()
        };
        let bvh = build_cwbvh_from_tris(&triangles, params, &mut Duration::default());
        let triangles = bvh.primitive_indices.iter().map(|index| triangles[*index as usize]).collect();
        let ray = |[from, to]: &[Vec3; 2]| {
            let from = in_bvh(*from);
            let span = in_bvh(*to) - from;
            let length = span.length();
            // Adding zero makes +0 of −0, at which obvhs errs.
            Ray::new(from, span / length + Vec3A::ZERO, 0.0, length)
        };
        Self { bvh, triangles, rays: segments.iter().map(ray).collect(), scale }
    }

    /// The same tree with rays that leave faces.
    pub fn of_rays(self, rays: &[FaceRay]) -> Self {
        let ray = |[point, normal, direction]: &FaceRay| {
            let from = Vec3A::from(self.scale * *point + LIFT * *normal);
            Ray::new(from, Vec3A::from(*direction) + Vec3A::ZERO, 0.0, f32::INFINITY)
        };
        Self { rays: rays.iter().map(ray).collect(), ..self }
    }

    /// How many of the rays meet a face, for each of which the first is looked for.
    pub fn count_met(&self) -> usize {
        let meets = |ray: &&Ray| {
            let mut hit = RayHit::none();
            self.bvh.ray_traverse(**ray, &mut hit, |ray, index| self.triangles[index].intersect(ray))
        };
        self.rays.iter().filter(meets).count()
    }

    /// How many of the segments meet a face.
    pub fn count_occluded(&self) -> usize {
        let misses = |ray: &&Ray| self.bvh.ray_traverse_miss(**ray, |ray, index| self.triangles[index].intersect(ray));
        self.rays.len() - self.rays.iter().filter(misses).count()
    }
}
