//! Files that a scene may read: plain files of its own folder, none longer than memory can take.
//!
//! A scene file comes from anywhere and names other files. None of these names, links included,
//! leads out of the scene's folder, and nothing that is no plain file (a pipe, a device) is ever
//! opened: reading it might never end.

use std::collections::BTreeMap;
use std::fs::{self, File};
use std::io::{self, Read};
use std::path::{Component, Path, PathBuf};
use std::sync::OnceLock;

/// The longest scene file, buffer or texture, bytes. The largest scene that can be lit needs less.
pub(super) const MOST_BYTES: u64 = 2 << 30;

/// The longest material file or sidecar, bytes.
pub(super) const MOST_TEXT_BYTES: u64 = 64 << 20;

/// Why a file is not read.
#[derive(Debug, thiserror::Error)]
pub enum FileError {
    /// There is none.
    #[error("there is no such file")]
    Missing,
    /// The file's name, or a link on the way to it, leads elsewhere.
    #[error("it lies outside the scene's folder")]
    Outside,
    /// A folder, a pipe or a device.
    #[error("it is not a plain file")]
    NotAFile,
    /// More than is ever needed.
    #[error("it is longer than {} MiB", most >> 20)]
    TooLong {
        /// The limit, bytes.
        most: u64,
    },
    /// Error of the system.
    #[error("{0}")]
    System(io::Error),
}

impl From<io::Error> for FileError {
    fn from(error: io::Error) -> Self {
        match error.kind() {
            io::ErrorKind::NotFound => Self::Missing,
            _ => Self::System(error),
        }
    }
}

/// Where the files come from that a scene file refers to: material files, textures, buffers and the
/// sidecar.
pub trait SceneFiles: Sync {
    /// The content of a file; `name` is relative to the scene's folder and has neither `.` nor `..`
    /// in it.
    ///
    /// # Errors
    /// Why it is not read; [`FileError::TooLong`] beyond `most` bytes.
    fn read(&self, name: &Path, most: u64) -> Result<Vec<u8>, FileError>;

    /// The names of all files, as far as they are few enough to be listed.
    fn names(&self) -> Vec<PathBuf>;
}

/// The content of a file that a scene refers to. One that is not there may lie elsewhere in the
/// folder, under a name that differs in case: exporters write the paths of their own machines.
///
/// # Errors
/// Why it is not read.
pub(super) fn find(files: &dyn SceneFiles, reference: &str, most: u64) -> Result<Vec<u8>, FileError> {
    let first = name_of(reference).and_then(|name| files.read(&name, most));
    let Err(FileError::Missing | FileError::Outside) = first else { return first };
    let base = |name: &str| name.rsplit('/').next().unwrap_or_default().to_lowercase();
    let wanted = base(&reference.replace('\\', "/"));
    let mut alike = files.names();
    alike.retain(|name| base(&name.to_string_lossy()) == wanted);
    match &alike[..] {
        [only] if !wanted.is_empty() => files.read(only, most),
        _ => first,
    }
}

/// Files in memory, by name.
impl SceneFiles for BTreeMap<PathBuf, Vec<u8>> {
    fn read(&self, name: &Path, most: u64) -> Result<Vec<u8>, FileError> {
        match self.get(name) {
            Some(bytes) if bytes.len() as u64 > most => Err(FileError::TooLong { most }),
            Some(bytes) => Ok(bytes.clone()),
            None => Err(FileError::Missing),
        }
    }

    fn names(&self) -> Vec<PathBuf> {
        self.keys().cloned().collect()
    }
}

/// So many files and folders of a scene's folder are listed at most, and so deep.
const MOST_NAMES: usize = 10_000;
const MOST_LEVELS: usize = 4;

/// A folder on disk.
pub struct SceneFolder {
    path: PathBuf,
    /// Filled when they are asked for.
    names: OnceLock<Vec<PathBuf>>,
}

impl SceneFolder {
    /// The folder that a scene file lies in.
    pub fn of(scene: &Path) -> Self {
        match scene.parent() {
            Some(folder) if !folder.as_os_str().is_empty() => Self::at(folder.to_owned()),
            _ => Self::at(PathBuf::from(".")),
        }
    }

    fn at(path: PathBuf) -> Self {
        Self { path, names: OnceLock::new() }
    }

    /// Plain files of the folder and of those in it, links left out.
    fn listed(&self) -> Vec<PathBuf> {
        let mut names = Vec::new();
        let mut waiting = vec![(PathBuf::new(), 0)];
        let mut seen = 0;
        while let Some((folder, level)) = waiting.pop() {
            let Ok(entries) = fs::read_dir(self.path.join(&folder)) else { continue };
            for entry in entries.flatten() {
                seen += 1;
                if seen > MOST_NAMES {
                    return names;
                }
                let name = folder.join(entry.file_name());
                match entry.file_type() {
                    Ok(kind) if kind.is_file() => names.push(name),
                    Ok(kind) if kind.is_dir() && level < MOST_LEVELS => waiting.push((name, level + 1)),
                    _ => {}
                }
            }
        }
        names
    }

    /// Where a file of this folder really lies.
    ///
    /// # Errors
    /// It is not there, or a link on the way to it leads out of the folder.
    pub(super) fn resolve(&self, name: &Path) -> Result<PathBuf, FileError> {
        let folder = fs::canonicalize(&self.path)?;
        let path = fs::canonicalize(folder.join(name))?;
        if path.starts_with(&folder) { Ok(path) } else { Err(FileError::Outside) }
    }
}

impl SceneFiles for SceneFolder {
    fn read(&self, name: &Path, most: u64) -> Result<Vec<u8>, FileError> {
        read_plain_file(&self.resolve(name)?, most)
    }

    fn names(&self) -> Vec<PathBuf> {
        self.names.get_or_init(|| self.listed()).clone()
    }
}

/// The content of a plain file of at most `most` bytes.
///
/// # Errors
/// Why it is not read; it is not even opened unless it is a plain file, since opening a pipe waits
/// for its other end.
pub(super) fn read_plain_file(path: &Path, most: u64) -> Result<Vec<u8>, FileError> {
    if !fs::metadata(path)?.is_file() {
        return Err(FileError::NotAFile);
    }
    let file = File::open(path)?;
    let length = file.metadata()?.len();
    if length > most {
        return Err(FileError::TooLong { most });
    }
    let mut bytes = Vec::with_capacity(length as usize);
    // It may have grown meanwhile.
    if file.take(most + 1).read_to_end(&mut bytes)? as u64 > most {
        return Err(FileError::TooLong { most });
    }
    Ok(bytes)
}

/// The name of a file that a scene refers to, relative to its folder and the same for all ways to
/// write it.
///
/// # Errors
/// The reference leads out of the folder.
pub(super) fn name_of(reference: &str) -> Result<PathBuf, FileError> {
    let reference = reference.replace('\\', "/");
    if reference.as_bytes().get(1) == Some(&b':') {
        return Err(FileError::Outside);
    }
    let mut name = PathBuf::new();
    for part in Path::new(&reference).components() {
        match part {
            Component::Normal(part) => name.push(part),
            Component::CurDir => {}
            _ => return Err(FileError::Outside),
        }
    }
    if name.as_os_str().is_empty() { Err(FileError::NotAFile) } else { Ok(name) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn references_stay_in_the_folder_and_are_written_alike() {
        let name = |reference: &str| name_of(reference).ok();
        assert_eq!(name("maps/wood.png"), Some(PathBuf::from("maps/wood.png")));
        assert_eq!(name(".\\maps\\\\./wood.png"), Some(PathBuf::from("maps/wood.png")));
        for escape in ["../wood.png", "/etc/passwd", "maps/../../x", "maps/../x", "C:\\x.png", "\\\\server\\x", "", "."]
        {
            assert_eq!(name(escape), None, "{escape}");
        }
    }

    #[test]
    fn a_scene_without_a_folder_lies_in_the_present_one() {
        assert_eq!(SceneFolder::of(Path::new("room.obj")).path, Path::new("."));
        assert_eq!(SceneFolder::of(Path::new("a/room.obj")).path, Path::new("a"));
    }
}
