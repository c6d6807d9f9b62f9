//! When the exposure of the view is metered: while the camera moves or somebody drags a lamp it
//! holds, so that nothing flickers, and dimming is seen.

use std::sync::Arc;

use crate::render::{self, Camera, LightMeter};
use crate::solve::Snapshot;
use crate::worker::SceneInfo;

/// The exposure that is in force, and what it was metered for.
#[derive(Default)]
pub struct Metering {
    metered: Option<Metered>,
    /// The camera of the frame before.
    last: Option<Camera>,
    /// The meter of a snapshot, by its generation and serial number.
    meter: Option<((u64, u64), LightMeter)>,
}

struct Metered {
    snapshot: (u64, u64),
    camera: Camera,
    aspect: f32,
    exposure: render::Metered,
}

impl Metering {
    /// The factor on radiosities, m²/W, of a view. One `held` stays as it was for the scene, once
    /// there is one.
    pub fn follow(
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
                return metered.exposure.factor;
            }
        }
        let exposure = self.meter(snapshot, info, camera, aspect);
        self.metered = Some(Metered { snapshot: key, camera: *camera, aspect, exposure });
        exposure.factor
    }

    /// Whether next to no light reaches what was seen when the view was metered last.
    pub fn is_dark(&self) -> bool {
        self.metered.as_ref().is_some_and(|metered| metered.exposure.is_dark)
    }

    /// Whether the view has moved since it was metered: another frame is wanted once it stands
    /// still.
    pub fn is_behind(&self) -> bool {
        self.metered.as_ref().zip(self.last.as_ref()).is_some_and(|(metered, last)| metered.camera != *last)
    }

    fn meter(&mut self, snapshot: &Snapshot, info: &SceneInfo, camera: &Camera, aspect: f32) -> render::Metered {
        let key = (snapshot.generation, snapshot.serial);
        let (_, meter) = match self.meter.take().filter(|(of, _)| *of == key) {
            Some(known) => self.meter.insert(known),
            None => self.meter.insert((key, LightMeter::new(snapshot, &info.scene))),
        };
        meter.exposure(snapshot, &info.occluders, camera, aspect)
    }
}
