//! Why a scene cannot be loaded.

use std::path::PathBuf;

use super::files::FileError;
use super::sidecar::SidecarError;

/// A scene that cannot be loaded: what, where, and what to do.
#[derive(Debug, thiserror::Error)]
pub enum LoadError {
    /// There is no such file.
    #[error("{}: no such file; check the path", path.display())]
    Missing {
        /// The file asked for.
        path: PathBuf,
    },
    /// The file is there but cannot be read.
    #[error("{}: cannot be read ({source}); check that it is a file and its permissions", path.display())]
    Unreadable {
        /// The file.
        path: PathBuf,
        /// Why.
        source: FileError,
    },
    /// The file is longer than any scene that can be lit.
    #[error("{}: the file is longer than {most_mib} MiB, the most that can be loaded; export less, or as GLB", path.display())]
    TooLong {
        /// The file.
        path: PathBuf,
        /// The limit, MiB.
        most_mib: u64,
    },
    /// The file has no content.
    #[error("{}: the file is empty; Selflink reads OBJ, glTF, GLB, PLY and STL scenes", path.display())]
    Empty {
        /// The file.
        path: PathBuf,
    },
    /// The file is something else.
    #[error("{}: this is {what}, not a scene; Selflink reads OBJ, glTF, GLB, PLY and STL scenes", path.display())]
    NotAScene {
        /// The file.
        path: PathBuf,
        /// Format that the file seems to have.
        what: String,
    },
    /// The content cannot be understood.
    #[error("{}, {place}: {problem}", path.display())]
    Parse {
        /// The file.
        path: PathBuf,
        /// Line of a text file, or the part of a glTF file.
        place: String,
        /// Description of the fault, and of what would be right.
        problem: String,
    },
    /// A coordinate is NaN, infinite or too large.
    #[error("{}, {place}: {vertex} has a coordinate that is not finite, or beyond 1e9 from the middle of the scene; export the scene again", path.display())]
    Coordinate {
        /// The file.
        path: PathBuf,
        /// Line of a text file, or the part of a glTF file.
        place: String,
        /// Which vertex.
        vertex: String,
    },
    /// A face refers to a vertex that is not there.
    #[error("{}, {place}: a face refers to vertex {index}, but there are {count}; the file is damaged or cut off", path.display())]
    FaceIndex {
        /// The file.
        path: PathBuf,
        /// Line of a text file, or the part of a glTF file.
        place: String,
        /// The index as the file has it.
        index: i64,
        /// Number of vertices.
        count: usize,
    },
    /// Nothing to light.
    #[error("{}: the scene has no polygons to light{why}", path.display())]
    NoPolygons {
        /// The file.
        path: PathBuf,
        /// Reason for their absence, in brackets, or empty.
        why: String,
    },
    /// More polygons than memory can take.
    #[error("{}: the scene has {count} polygons, more than the {most} that can be loaded", path.display())]
    TooLarge {
        /// The file.
        path: PathBuf,
        /// Number of polygons.
        count: usize,
        /// The limit.
        most: usize,
    },
    /// The sidecar cannot be used.
    #[error(transparent)]
    Sidecar(#[from] SidecarError),
}
