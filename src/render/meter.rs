//! The exposure meter of a view: what is seen is brought to the key, lamps aside.
//!
//! Rays through a coarse grid of the view tell which faces are seen; the median of what they send out is what is metered.

use glam::Vec2;

use super::Camera;
use crate::base::photometry::weighted;
use crate::geometry::Occluders;
use crate::read::tone::{auto_exposure, exposure_of_seen};
use crate::scene::Scene;
use crate::solve::snapshot::Snapshot;

/// Rays in each direction of the view.
const GRID: [u32; 2] = [32, 20];

/// A meter of the light in one snapshot.
pub struct LightMeter {
    /// Mean radiosity of each polygon that does not emit, weighted as the eye does, W/m².
    of_polygons: Vec<Option<f32>>,
}

impl LightMeter {
    /// Prepares to meter views of a snapshot.
    pub fn new(snapshot: &Snapshot, scene: &Scene) -> Self {
        let mut sums = vec![(0.0_f64, 0.0_f64); scene.polygons.len()];
        for (leaf, radiosity) in snapshot.mesh.leaves.iter().zip(&snapshot.leaf_radiosity) {
            if let Some((sent, area)) = sums.get_mut(leaf.polygon as usize) {
                *sent += f64::from(leaf.area * weighted(*radiosity));
                *area += f64::from(leaf.area);
            }
        }
        let emits = |polygon: usize| {
            let material = scene.polygons[polygon].material.0 as usize;
            scene.materials.get(material).is_some_and(|material| material.emission.max_element() > 0.0)
        };
        let mean = |(polygon, (sent, area)): (usize, &(f64, f64))| {
            (*area > 0.0 && !emits(polygon)).then(|| (sent / area) as f32)
        };
        Self { of_polygons: sums.iter().enumerate().map(mean).collect() }
    }

    /// The factor on radiosities, m²/W, that exposes a view of the snapshot well; that of the whole scene where nothing lit is seen.
    pub fn exposure(&self, snapshot: &Snapshot, occluders: &Occluders, camera: &Camera, aspect: f32) -> f32 {
        let [columns, rows] = GRID;
        let place = |index: u32| {
            let share = |at: u32, of: u32| (at as f32 + 0.5) / of as f32;
            let at = Vec2::new(share(index % columns, columns), share(index / columns, rows));
            let (origin, direction) = camera.ray(2.0 * at - Vec2::ONE, aspect);
            let hit = occluders.first_front(origin, direction)?;
            self.of_polygons.get(hit.polygon as usize).copied().flatten()
        };
        let mut seen: Vec<f32> = (0..columns * rows).filter_map(place).collect();
        exposure_of_seen(&mut seen).unwrap_or_else(|| auto_exposure(snapshot))
    }
}
