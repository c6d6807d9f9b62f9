//! Readings off the surfaces in view: kept while neither the snapshot nor the settings change,
//! since a range looks at all leaves.

use crate::render::{Reading, ReadingSettings};
use crate::solve::Snapshot;

/// Generation and number of the snapshot, the light of open ground and the settings.
type MadeOf = (u64, u64, Option<f32>, ReadingSettings);

/// The reading of the snapshot in view.
#[derive(Default)]
pub struct ReadingInView {
    made_of: Option<MadeOf>,
    reading: Option<Reading>,
}

impl ReadingInView {
    /// Follows the snapshot and the settings; `open_ground` is the irradiance of open ground where
    /// the sky alone shines, W/m², weighted as the eye does.
    pub fn follow(
        &mut self,
        snapshot: &Snapshot,
        open_ground: Option<f32>,
        settings: &ReadingSettings,
    ) -> Option<Reading> {
        let is_of = |(generation, serial, open, of): &MadeOf| {
            (*generation, *serial, *open) == (snapshot.generation, snapshot.serial, open_ground) && of == settings
        };
        if !self.made_of.as_ref().is_some_and(is_of) {
            self.reading = settings.reading(snapshot, open_ground);
            self.made_of = Some((snapshot.generation, snapshot.serial, open_ground, settings.clone()));
        }
        self.reading
    }

    /// As it was last.
    pub fn last(&self) -> Option<Reading> {
        self.reading
    }
}
