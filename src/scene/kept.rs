//! Parts of a sidecar that do not change the light: the view, further views, and the task area.

use glam::{DVec3, Vec3};
use serde::{Deserialize, Serialize};

use super::place::{FiledCamera, is_usable};
use super::{CameraPose, Scene};

/// View, bookmarks and task area of a scene.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Kept {
    /// The view to open with.
    pub camera: Option<CameraPose>,
    /// Further views.
    pub bookmarks: Vec<CameraPose>,
    /// Where on the work plane a task is done.
    pub task_area: Option<TaskArea>,
}

/// A level rectangle in which a task is done, and the light that it asks for (EN 12464-1).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TaskArea<Corner = Vec3> {
    /// Two opposite corners, in the scene's coordinates.
    pub corners: [Corner; 2],
    /// Height above the floor, in the scene's length unit.
    pub height: f32,
    /// Average illuminance Ē that is asked for, lx.
    pub average_lux: f32,
    /// Uniformity U₀ that is asked for.
    pub uniformity: f32,
}

/// A task area in a file's coordinates, as sidecars give it.
pub type FiledTaskArea = TaskArea<DVec3>;

impl FiledTaskArea {
    /// The area in the coordinates of a scene.
    pub fn in_scene(&self, scene: &Scene) -> TaskArea {
        let Self { corners, height, average_lux, uniformity } = *self;
        TaskArea { corners: corners.map(|corner| scene.from_file(corner)), height, average_lux, uniformity }
    }

    /// Why it cannot be used.
    pub(super) fn problem(&self) -> Option<String> {
        let is_number = |value: f32| value.is_finite() && value >= 0.0;
        let is_good = self.corners.into_iter().all(is_usable)
            && self.height.is_finite()
            && is_number(self.average_lux)
            && is_number(self.uniformity);
        (!is_good).then(|| {
            "the task area needs two corners within 1e15, a finite height, and an average_lux and a uniformity of 0 or more"
                .to_owned()
        })
    }
}

impl TaskArea {
    /// The area in the coordinates of a scene's file.
    pub fn in_file(&self, scene: &Scene) -> FiledTaskArea {
        let Self { corners, height, average_lux, uniformity } = *self;
        FiledTaskArea { corners: corners.map(|corner| scene.to_file(corner)), height, average_lux, uniformity }
    }
}

impl Scene {
    /// Takes over what a person keeps beside it; a view that is not given stays.
    pub fn keep(&mut self, kept: Kept) {
        self.camera = kept.camera.or(self.camera);
        (self.bookmarks, self.task_area) = (kept.bookmarks, kept.task_area);
    }

    /// As [`keep`](Self::keep), of further views and a task area that a file tells.
    pub(super) fn keep_filed(&mut self, bookmarks: &[FiledCamera], task_area: Option<&FiledTaskArea>) {
        self.bookmarks = bookmarks.iter().map(|camera| camera.in_scene(self)).collect();
        self.task_area = task_area.map(|area| area.in_scene(self));
    }
}
