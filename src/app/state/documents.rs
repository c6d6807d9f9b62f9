//! Files: where the scene in view came from, those that were open, and what is written.

use crate::app::state::exports::Exports;
use crate::app::state::files::Files;
use crate::app::state::session::Opened;
use crate::app::state::watch::Watch;

/// Files that the window reads and writes.
pub struct Documents {
    /// Recent files, and the dialog that opens another.
    pub files: Files,
    /// Where the scene in view came from.
    pub opened: Opened,
    /// Whether its file has changed since.
    pub watch: Watch,
    /// Files that are being written.
    pub exports: Exports,
}

impl Documents {
    /// Nothing is open; these were.
    pub fn new(recent: Vec<std::path::PathBuf>) -> Self {
        Self {
            files: Files::new(recent),
            opened: Opened::default(),
            watch: Watch::default(),
            exports: Exports::default(),
        }
    }
}
