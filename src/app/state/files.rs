//! Choosing scenes: the path field, the system's dialog, and recent files.

use std::path::{Path, PathBuf};

use crate::app::format::things;
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

/// Of files dropped together the one to open, a scene before its materials and textures, and a
/// sentence when others of them are scenes too.
pub fn choose_dropped(dropped: &[PathBuf]) -> Option<(&Path, Option<String>)> {
    let is_scene =
        |path: &Path| path.extension().is_some_and(|extension| EXTENSIONS.iter().any(|known| extension == *known));
    let scenes: Vec<&PathBuf> = dropped.iter().filter(|path| is_scene(path)).collect();
    let chosen = scenes.first().copied().or(dropped.first())?;
    let remark = (scenes.len() > 1).then(|| {
        let others = things(scenes.len() - 1, "other scene", "other scenes");
        let name = chosen.file_name().unwrap_or_default().to_string_lossy();
        format!("Only {name} is opened, not the {others} dropped with it: the window shows one at a time.")
    });
    Some((chosen, remark))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn of_dropped_files_the_scene_is_opened_and_further_scenes_are_reported() {
        let paths = |names: &[&str]| -> Vec<PathBuf> { names.iter().map(PathBuf::from).collect() };
        let chosen =
            |names: &[&str]| choose_dropped(&paths(names)).map(|(path, remark)| (path.to_owned(), remark.is_some()));
        assert_eq!(chosen(&[]), None);
        assert_eq!(chosen(&["a.mtl", "b.png", "a.obj"]), Some(("a.obj".into(), false)));
        assert_eq!(chosen(&["notes.txt", "b.png"]), Some(("notes.txt".into(), false)));
        assert_eq!(chosen(&["a.OBJ", "b.glb"]), Some(("a.OBJ".into(), true)));
    }

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
