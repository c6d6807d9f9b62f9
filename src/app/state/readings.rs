//! Readings off the surfaces in view: kept while neither the snapshot nor the settings change, since a range looks at all leaves.

use crate::render::{Reading, ReadingSettings};
use crate::solve::Snapshot;

/// The reading of the snapshot in view.
#[derive(Default)]
pub(in crate::app) struct ReadingInView {
    made_of: Option<(u64, u64, ReadingSettings)>,
    reading: Option<Reading>,
}

impl ReadingInView {
    /// Follows the snapshot and the settings.
    pub(in crate::app) fn follow(&mut self, snapshot: &Snapshot, settings: &ReadingSettings) -> Option<Reading> {
        let is_of = |(generation, serial, of): &(u64, u64, ReadingSettings)| {
            (*generation, *serial) == (snapshot.generation, snapshot.serial) && of == settings
        };
        if !self.made_of.as_ref().is_some_and(is_of) {
            self.reading = settings.reading(snapshot);
            self.made_of = Some((snapshot.generation, snapshot.serial, settings.clone()));
        }
        self.reading
    }

    /// As it was last.
    pub(in crate::app) fn last(&self) -> Option<Reading> {
        self.reading
    }
}
