//! Why a scene cannot be loaded.

use std::path::PathBuf;

use super::draft::MOST_POLYGONS;
use super::files::FileError;
use super::sidecar::SidecarError;

/// A scene that cannot be loaded: what, where, and what to do.
#[derive(Debug, thiserror::Error)]
pub enum LoadError {
    /// The scene's file cannot be used.
    #[error("{}{fault}", path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// Why.
        fault: Fault,
    },
    /// The sidecar cannot be used.
    #[error(transparent)]
    Sidecar(#[from] SidecarError),
}

/// A fault of a scene's file, in words that stand behind its path. A place is a line of a text file
/// or a part of a glTF file.
#[derive(Debug, thiserror::Error)]
pub enum Fault {
    /// There is no such file.
    #[error(": no such file; check the path")]
    Missing,
    /// The file is there but cannot be read, and why.
    #[error(": cannot be read ({0}); check that it is a file and its permissions")]
    Unreadable(FileError),
    /// The file is longer than any scene that can be lit; the limit, MiB.
    #[error(": the file is longer than {0} MiB, the most that can be loaded; export less, or as GLB")]
    TooLong(u64),
    /// The file has no content.
    #[error(": the file is empty; Selflink reads OBJ, glTF, GLB, PLY and STL scenes")]
    Empty,
    /// The file is something else, and what it seems to be.
    #[error(": this is {0}, not a scene; Selflink reads OBJ, glTF, GLB, PLY and STL scenes")]
    NotAScene(String),
    /// The content cannot be understood: the place, the problem, and what would be right.
    #[error(", {0}: {1}")]
    Parse(String, String),
    /// A coordinate is NaN, infinite or too large: the place, and which vertex.
    #[error(
        ", {0}: {1} has a coordinate that is not finite, or beyond 1e9 from the middle of the scene; export the scene again"
    )]
    Coordinate(String, String),
    /// A face refers to a vertex that is not there: the place, the index as the file has it, and
    /// the number of vertices.
    #[error(", {0}: a face refers to vertex {1}, but there are {2}; the file is damaged or cut off")]
    FaceIndex(String, i64, usize),
    /// Nothing to light; why, in brackets, or nothing.
    #[error(": the scene has no polygons to light{0}")]
    NoPolygons(String),
    /// More polygons than memory can take: their number.
    #[error(": the scene has {0} polygons, more than the {MOST_POLYGONS} that can be loaded")]
    TooLarge(usize),
}
