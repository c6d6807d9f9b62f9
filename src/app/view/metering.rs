//! The exposure meter of the view: what is seen is brought to the key, lamps aside.
//!
//! Rays through a coarse grid of the view tell which faces are seen; the median of what they send out is what is metered. While the
//! camera moves or somebody drags a lamp, the exposure holds: nothing flickers, and dimming is seen.

use std::sync::Arc;

use glam::Vec2;

use crate::base::photometry::weighted;
use crate::render::{Camera, auto_exposure, exposure_of_seen};
use crate::solve::Snapshot;
use crate::worker::SceneInfo;

/// Rays in each direction of the view.
const GRID: [u32; 2] = [32, 20];

/// The exposure that is in force, and what it was metered for.
#[derive(Default)]
pub(in crate::app) struct Metering {
    metered: Option<Metered>,
    /// The camera of the frame before.
    last: Option<Camera>,
    means: Option<Means>,
}

struct Metered {
    snapshot: (u64, u64),
    camera: Camera,
    aspect: f32,
    /// Factor on radiosities, m²/W.
    factor: f32,
}

/// Mean radiosity of each polygon that does not emit, weighted as the eye does, W/m².
struct Means {
    snapshot: (u64, u64),
    of_polygons: Vec<Option<f32>>,
}

impl Metering {
    /// The factor on radiosities, m²/W, of a view. One `held` stays as it was for the scene, once there is one.
    pub(in crate::app) fn follow(
        &mut self,
        snapshot: &Snapshot,
        info: &Arc<SceneInfo>,
        camera: &Camera,
        aspect: f32,
        is_held: bool,
    ) -> f32 {
        let key = (snapshot.generation, snapshot.serial);
        let is_still = self.last.replace(*camera).is_none_or(|last| last == *camera);
        let known = self.metered.as_ref().filter(|metered| metered.snapshot.0 >= info.generation);
        if let Some(metered) = known {
            let is_same = (metered.snapshot, metered.camera, metered.aspect) == (key, *camera, aspect);
            if is_same || is_held || !is_still {
                return metered.factor;
            }
        }
        let factor = self.meter(snapshot, info, camera, aspect);
        self.metered = Some(Metered { snapshot: key, camera: *camera, aspect, factor });
        factor
    }

    /// Whether the view has moved since it was metered: another frame is wanted once it stands still.
    pub(in crate::app) fn is_behind(&self) -> bool {
        self.metered.as_ref().zip(self.last.as_ref()).is_some_and(|(metered, last)| metered.camera != *last)
    }

    fn meter(&mut self, snapshot: &Snapshot, info: &SceneInfo, camera: &Camera, aspect: f32) -> f32 {
        let key = (snapshot.generation, snapshot.serial);
        let means = match self.means.take().filter(|means| means.snapshot == key) {
            Some(means) => means,
            None => Means { snapshot: key, of_polygons: means_of(snapshot, info) },
        };
        let [columns, rows] = GRID;
        let place = |index: u32| {
            let share = |at: u32, of: u32| (at as f32 + 0.5) / of as f32;
            let at = Vec2::new(share(index % columns, columns), share(index / columns, rows));
            let (origin, direction) = camera.ray(2.0 * at - Vec2::ONE, aspect);
            let hit = info.occluders.first_front(origin, direction)?;
            means.of_polygons.get(hit.polygon as usize).copied().flatten()
        };
        let mut seen: Vec<f32> = (0..columns * rows).filter_map(place).collect();
        let exposure = exposure_of_seen(&mut seen).unwrap_or_else(|| auto_exposure(snapshot));
        self.means = Some(means);
        exposure
    }
}

fn means_of(snapshot: &Snapshot, info: &SceneInfo) -> Vec<Option<f32>> {
    let mut sums = vec![(0.0_f64, 0.0_f64); info.scene.polygons.len()];
    for (leaf, radiosity) in snapshot.mesh.leaves.iter().zip(&snapshot.leaf_radiosity) {
        if let Some((sent, area)) = sums.get_mut(leaf.polygon as usize) {
            *sent += f64::from(leaf.area * weighted(*radiosity));
            *area += f64::from(leaf.area);
        }
    }
    let emits = |polygon: usize| {
        let material = info.scene.polygons[polygon].material.0 as usize;
        info.scene.materials.get(material).is_some_and(|material| material.emission.max_element() > 0.0)
    };
    let mean =
        |(polygon, (sent, area)): (usize, &(f64, f64))| (*area > 0.0 && !emits(polygon)).then(|| (sent / area) as f32);
    sums.iter().enumerate().map(mean).collect()
}
