//! The system's file dialog, on a thread of its own.

use std::path::PathBuf;
use std::sync::mpsc::{Receiver, TryRecvError, channel};
use std::thread::Builder;
use std::time::{Duration, Instant};

/// Nobody cancels a dialog as fast as this: there was none.
const TOO_FAST: Duration = Duration::from_millis(200);

/// What came of the system's dialog.
pub(in crate::app) enum DialogAnswer {
    Chosen(PathBuf),
    NoDialog,
}

/// A dialog that may be open.
#[derive(Default)]
pub(in crate::app) struct Dialog(Option<Receiver<Closed>>);

struct Closed {
    path: Option<PathBuf>,
    after: Duration,
}

impl Dialog {
    /// Whether it is open.
    pub(in crate::app) fn is_open(&self) -> bool {
        self.0.is_some()
    }

    /// Opens it; `ask` shows it and waits for the answer.
    pub(in crate::app) fn open(&mut self, ctx: &egui::Context, ask: impl FnOnce() -> Option<PathBuf> + Send + 'static) {
        let (answer, answers) = channel();
        let ctx = ctx.clone();
        let ask = move || {
            let opened = Instant::now();
            let path = ask();
            // The window may be gone by now.
            let _ = answer.send(Closed { path, after: opened.elapsed() });
            ctx.request_repaint();
        };
        if Builder::new().name("file-dialog".into()).spawn(ask).is_ok() {
            self.0 = Some(answers);
        }
    }

    /// What came of it, once it is closed with something to say.
    pub(in crate::app) fn poll(&mut self) -> Option<DialogAnswer> {
        let closed = match self.0.as_ref()?.try_recv() {
            Ok(closed) => closed,
            Err(TryRecvError::Empty) => return None,
            // The dialog's thread broke.
            Err(TryRecvError::Disconnected) => Closed { path: None, after: Duration::ZERO },
        };
        self.0 = None;
        match closed {
            Closed { path: Some(path), .. } => Some(DialogAnswer::Chosen(path)),
            Closed { after, .. } if after < TOO_FAST => Some(DialogAnswer::NoDialog),
            Closed { .. } => None,
        }
    }
}
