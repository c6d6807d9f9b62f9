//! Choosing scenes: the path field, the system's dialog, and recent files.

use std::path::{Path, PathBuf};

use crate::app::widgets::dialog::PathField;

/// So many recent files are remembered.
const MOST_RECENT: usize = 6;

/// Extensions of scene files; some systems' dialogs tell capitals apart.
const EXTENSIONS: [&str; 10] = ["obj", "gltf", "glb", "ply", "stl", "OBJ", "GLTF", "GLB", "PLY", "STL"];

/// Advice where there is no dialog.
pub const NO_DIALOG: &str = "No file dialog answers on this system: type the path into the field beside Browse…, or drop the file on the window.";

/// State of the file controls.
pub struct Files {
    /// The path of a scene to open.
    pub field: PathField,
    recent: Vec<PathBuf>,
    /// A sidecar that is there already and is to be overwritten only if a person says so.
    pub sidecar_in_question: Option<PathBuf>,
}

impl Files {
    /// With the files of earlier runs.
    pub fn new(recent: Vec<PathBuf>) -> Self {
        Self { field: PathField::default(), recent, sidecar_in_question: None }
    }

    /// Files opened lately, the last one first.
    pub fn recent(&self) -> &[PathBuf] {
        &self.recent
    }

    /// Remembers a file that was opened.
    pub fn note_opened(&mut self, path: &Path) {
        // A relative path would mean another file after a start elsewhere.
        let path = std::path::absolute(path).unwrap_or_else(|_| path.to_owned());
        self.recent.retain(|other| *other != path);
        self.recent.insert(0, path);
        self.recent.truncate(MOST_RECENT);
    }

    /// Opens the system's dialog on a thread of its own, unless it is open.
    pub fn open_dialog(&mut self, ctx: &egui::Context) {
        self.field.dialog.open(ctx, || {
            rfd::FileDialog::new()
                .set_title("Open a scene")
                .add_filter("Scenes (OBJ, glTF, GLB, PLY, STL)", &EXTENSIONS)
                .add_filter("All files", &["*"])
                .pick_file()
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn recent_files_are_listed_once_and_the_last_comes_first() {
        let mut files = Files::new(Vec::new());
        for name in ["/a", "/b", "/c", "/d", "/e", "/f", "/g", "/b"] {
            files.note_opened(Path::new(name));
        }
        let expected: Vec<PathBuf> = ["/b", "/g", "/f", "/e", "/d", "/c"].map(PathBuf::from).into();
        assert_eq!(files.recent(), expected);
    }
}
