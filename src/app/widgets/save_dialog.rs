//! Where a file is to be written: a path field beside the system's dialog.

use std::path::PathBuf;

use crate::app::widgets::dialog::{Dialog, DialogAnswer};

/// State of the controls that choose a file to write.
#[derive(Default)]
pub struct SaveDialog {
    /// The path field.
    pub path_text: String,
    dialog: Dialog,
}

impl SaveDialog {
    /// The path that was typed, without the blanks and quotes that come with pasting.
    pub fn typed_path(&self) -> Option<PathBuf> {
        let text = self.path_text.trim().trim_matches(['"', '\'']);
        (!text.is_empty()).then(|| PathBuf::from(text))
    }

    /// Whether the system's dialog is open.
    pub fn is_open(&self) -> bool {
        self.dialog.is_open()
    }

    /// Opens the system's dialog with a name to begin with.
    pub fn open(&mut self, ctx: &egui::Context, title: &'static str, name: String) {
        self.dialog.open(ctx, move || rfd::FileDialog::new().set_title(title).set_file_name(name).save_file());
    }

    /// Answer of the dialog, once it is closed with something to say.
    pub fn poll(&mut self) -> Option<DialogAnswer> {
        self.dialog.poll()
    }
}
