//! Where a file is to be written: a path field, and the system's dialog on a thread of its own.

use std::path::PathBuf;
use std::sync::mpsc::{Receiver, TryRecvError, channel};
use std::thread::Builder;
use std::time::{Duration, Instant};

/// Nobody cancels a dialog as fast as this: there was none.
const TOO_FAST: Duration = Duration::from_millis(200);

/// What came of the dialog.
pub(super) enum Answer {
    Chosen(PathBuf),
    NoDialog,
}

/// State of the controls that choose a file to write.
#[derive(Default)]
pub(super) struct SaveDialog {
    /// The path field.
    pub path_text: String,
    dialog: Option<Receiver<(Option<PathBuf>, Duration)>>,
}

impl SaveDialog {
    /// The path that was typed, without the blanks and quotes that come with pasting.
    pub(super) fn typed_path(&self) -> Option<PathBuf> {
        let text = self.path_text.trim().trim_matches(['"', '\'']);
        (!text.is_empty()).then(|| PathBuf::from(text))
    }

    /// Whether the system's dialog is open.
    pub(super) fn is_open(&self) -> bool {
        self.dialog.is_some()
    }

    /// Opens the system's dialog with a name to begin with.
    pub(super) fn open(&mut self, ctx: &egui::Context, title: &'static str, name: String) {
        let (answer, answers) = channel();
        let ctx = ctx.clone();
        let ask = move || {
            let opened = Instant::now();
            let path = rfd::FileDialog::new().set_title(title).set_file_name(name).save_file();
            // The window may be gone by now.
            let _ = answer.send((path, opened.elapsed()));
            ctx.request_repaint();
        };
        if Builder::new().name("file-dialog".into()).spawn(ask).is_ok() {
            self.dialog = Some(answers);
        }
    }

    /// What came of the dialog, once it is closed with something to say.
    pub(super) fn poll(&mut self) -> Option<Answer> {
        let closed = match self.dialog.as_ref()?.try_recv() {
            Ok(closed) => closed,
            Err(TryRecvError::Empty) => return None,
            // The dialog's thread broke.
            Err(TryRecvError::Disconnected) => (None, Duration::ZERO),
        };
        self.dialog = None;
        match closed {
            (Some(path), _) => Some(Answer::Chosen(path)),
            (None, after) if after < TOO_FAST => Some(Answer::NoDialog),
            (None, _) => None,
        }
    }
}
