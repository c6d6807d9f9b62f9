//! The view of a scene that nothing lights: its surfaces' own colours, made once for each snapshot.

use std::sync::Arc;

use crate::app::view::paint::fresh_serial;
use crate::render::in_own_colours;
use crate::solve::Snapshot;
use crate::worker::SceneInfo;

/// The snapshot that was painted last.
#[derive(Default)]
pub struct OwnColours {
    painted: Option<Painted>,
}

struct Painted {
    of: (Arc<SceneInfo>, Arc<Snapshot>),
    snapshot: Arc<Snapshot>,
}

impl OwnColours {
    /// The snapshot with the colours of the scene's surfaces at its vertices; `None` where the
    /// scene has light.
    pub fn painted(&mut self, snapshot: &Arc<Snapshot>, info: Option<&Arc<SceneInfo>>) -> Option<Arc<Snapshot>> {
        let Some(info) = info.filter(|info| !info.has_light && info.generation <= snapshot.generation) else {
            self.painted = None;
            return None;
        };
        let is_of_this = |painted: &&Painted| Arc::ptr_eq(&painted.of.0, info) && Arc::ptr_eq(&painted.of.1, snapshot);
        if let Some(painted) = self.painted.as_ref().filter(is_of_this) {
            return Some(painted.snapshot.clone());
        }
        let coloured = Arc::new(Snapshot { serial: fresh_serial(), ..in_own_colours(snapshot, &info.scene) });
        self.painted = Some(Painted { of: (info.clone(), snapshot.clone()), snapshot: coloured.clone() });
        Some(coloured)
    }
}
