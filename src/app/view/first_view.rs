//! The first view of a scene: it suits itself to the room that panels leave, for they find their
//! places in the frames after the first picture.

use crate::render::Camera;
use crate::scene::CameraPose;

/// Frames in which it does.
const FRAMES: u8 = 4;

/// A first view, taken up or not.
#[derive(Default)]
pub struct FirstView {
    /// Pose of the first view, where it is not the scene's start.
    pose: Option<CameraPose>,
    /// The camera as it was made last, and frames in which it may be made anew.
    made: Option<(Camera, u8)>,
}

impl FirstView {
    /// From this pose, or from the scene's start.
    pub fn of(pose: Option<CameraPose>) -> Self {
        Self { pose, made: None }
    }

    /// The camera of this frame: made by `suited`, unless there is one that has been moved or has
    /// had its first frames.
    pub fn follow(&mut self, camera: Option<Camera>, suited: impl Fn(Option<&CameraPose>) -> Camera) -> Option<Camera> {
        let left = match (camera, self.made) {
            (None, _) => FRAMES,
            (Some(camera), Some((made, left))) if camera == made && left > 0 => left - 1,
            _ => {
                *self = Self::default();
                return camera;
            }
        };
        let made = suited(self.pose.as_ref());
        self.made = Some((made, left));
        Some(made)
    }
}
