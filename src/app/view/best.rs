//! The best picture of a scene: a finished one stays in view while a better one of the same light
//! is being made.

use std::sync::Arc;

use crate::solve::{Phase, Snapshot};
use crate::worker::SceneInfo;

/// The last finished picture, and the scene with its lamps and materials that it shows.
#[derive(Default)]
pub struct BestPicture {
    finished: Option<(Arc<SceneInfo>, Arc<Snapshot>)>,
}

impl BestPicture {
    /// Snapshot that is to be drawn while `latest` is the newest one.
    ///
    /// A solve to another target error begins with links that are coarser than the light that was
    /// gathered before. One by ε, and a former step, are looked at for their own sake.
    pub fn follow(&mut self, latest: &Arc<Snapshot>, info: Option<&Arc<SceneInfo>>) -> Arc<Snapshot> {
        let Some(info) = info else { return latest.clone() };
        let is_done = latest.stats.phase == Phase::Done;
        if is_done && latest.former_step.is_none() && latest.field.is_some() {
            self.finished = Some((info.clone(), latest.clone()));
        }
        let is_of_this = |(of, finished): &&(Arc<SceneInfo>, Arc<Snapshot>)| {
            Arc::ptr_eq(of, info) && finished.generation == latest.generation
        };
        let is_under_way = !is_done && latest.former_step.is_none() && latest.stats.error_asked.is_some();
        match self.finished.as_ref().filter(is_of_this) {
            Some((_, finished)) if is_under_way => finished.clone(),
            _ => latest.clone(),
        }
    }
}
