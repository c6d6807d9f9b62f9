//! Stamps: what the files of a scene looked like from outside when they were read, so that a change
//! on disk is distinguished from what is in view.

use std::path::{Path, PathBuf};
use std::time::SystemTime;

use crate::scene::Sidecar;

/// A file of a scene, and what the system says of it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FileStamp {
    /// The file.
    pub path: PathBuf,
    /// Time of its last change and its length, bytes; `None` where it is not there.
    pub seen: Option<(SystemTime, u64)>,
}

impl FileStamp {
    /// As the file is now. Asks the system, which on a network's disk may take its time.
    pub fn of(path: PathBuf) -> Self {
        let seen = std::fs::metadata(&path).ok().map(|found| {
            // A file system without times still has lengths.
            (found.modified().unwrap_or(SystemTime::UNIX_EPOCH), found.len())
        });
        Self { path, seen }
    }

    /// The scene's file, its sidecar, and what exporters write beside it by the same name:
    /// materials of an OBJ file, buffers of a glTF file.
    pub(super) fn of_scene(path: &Path) -> Vec<Self> {
        let extension = path.extension().unwrap_or_default().to_string_lossy().to_lowercase();
        let beside = match extension.as_str() {
            "obj" => Some(path.with_extension("mtl")),
            "gltf" => Some(path.with_extension("bin")),
            _ => None,
        };
        [Some(path.to_owned()), Some(Sidecar::path_for(path)), beside].into_iter().flatten().map(Self::of).collect()
    }

    /// The file as it is now.
    pub fn again(&self) -> Self {
        Self::of(self.path.clone())
    }
}
