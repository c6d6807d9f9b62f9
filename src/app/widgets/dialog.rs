//! The system's file dialog, on a thread of its own.

use std::path::PathBuf;
use std::task::Poll;
use std::time::{Duration, Instant};

use crate::base::threads::Background;

/// Nobody cancels a dialog as fast as this: there was none.
const TOO_FAST: Duration = Duration::from_millis(200);

/// Answer of the system's dialog.
pub enum DialogAnswer {
    Chosen(PathBuf),
    NoDialog,
}

/// A dialog that may be open.
#[derive(Default)]
pub struct Dialog(Option<Background<Closed>>);

struct Closed {
    path: Option<PathBuf>,
    after: Duration,
}

impl Dialog {
    /// Whether it is open.
    pub fn is_open(&self) -> bool {
        self.0.is_some()
    }

    /// Opens it unless it is open; `ask` shows it and waits for the answer.
    pub fn open(&mut self, ctx: &egui::Context, ask: impl FnOnce() -> Option<PathBuf> + Send + 'static) {
        if self.is_open() {
            return;
        }
        let ctx = ctx.clone();
        let ask = move || {
            let opened = Instant::now();
            Closed { path: ask(), after: opened.elapsed() }
        };
        if let Ok(dialog) = Background::start("file-dialog", move || ctx.request_repaint(), ask) {
            self.0 = Some(dialog);
        }
    }

    /// Answer of the dialog, once it is closed with something to say.
    pub fn poll(&mut self) -> Option<DialogAnswer> {
        let Poll::Ready(closed) = self.0.as_ref()?.poll() else { return None };
        // Without an answer the dialog's thread broke.
        let closed = closed.unwrap_or(Closed { path: None, after: Duration::ZERO });
        self.0 = None;
        match closed {
            Closed { path: Some(path), .. } => Some(DialogAnswer::Chosen(path)),
            Closed { after, .. } if after < TOO_FAST => Some(DialogAnswer::NoDialog),
            Closed { .. } => None,
        }
    }
}

/// A path that is typed, or chosen with the system's dialog.
#[derive(Default)]
pub struct PathField {
    pub text: String,
    pub dialog: Dialog,
}

impl PathField {
    /// The path that was typed, without the blanks and quotes that come with pasting.
    pub fn typed(&self) -> Option<PathBuf> {
        let text = self.text.trim().trim_matches(['"', '\'']);
        (!text.is_empty()).then(|| PathBuf::from(text))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pasted_paths_lose_blanks_and_quotes() {
        let mut field = PathField::default();
        assert_eq!(field.typed(), None);
        field.text = " \"/rooms/my room.obj\" ".into();
        assert_eq!(field.typed(), Some(PathBuf::from("/rooms/my room.obj")));
    }
}
