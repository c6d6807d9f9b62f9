//! Watching the files of the scene in view: what changes on disk is offered, what vanishes is said
//! once.
//!
//! A thread of its own asks the system twice a second how long the files are and when they were
//! written. Notices of the file system would come sooner, but never from a network's disk, which
//! may also keep a question waiting for long: the window must not be the one who asks.

use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::thread::Builder;
use std::time::Duration;

use egui::Ui;

use crate::app::actions::Action;
use crate::app::widgets::{rows, theme};
use crate::app::{Outbox, Wake};
use crate::scene::Source;
use crate::worker::{FileStamp, SceneInfo};

/// Time between two looks at the files.
const INTERVAL: Duration = Duration::from_millis(500);

/// Change of a scene's files.
#[derive(Clone, Debug, PartialEq, Eq)]
enum News {
    /// This file is another one than was read, and has stayed so for a while: nobody is writing it.
    Changed(PathBuf),
    /// This file is there no more.
    Vanished(PathBuf),
}

/// Watches the files of the scene in view.
#[derive(Default)]
pub struct Watch {
    watcher: Option<Watcher>,
    /// A file that has changed, until somebody says what to do.
    changed: Option<PathBuf>,
    /// The scene in view that is being read anew.
    reloading: Option<Source>,
}

/// The ends of the thread's channels; it ends when they are dropped.
struct Watcher {
    accept: Sender<PathBuf>,
    news: Receiver<News>,
}

impl Watch {
    /// Watches another scene's files, or none.
    pub fn start_with(&mut self, info: &SceneInfo, wake: &Wake) {
        self.changed = None;
        // Without a thread nothing is watched, and nothing else is lost.
        self.watcher = spawn(info.stamps.clone(), wake.clone());
    }

    /// Takes a file that the window itself wrote for no change.
    pub fn accept(&self, path: &Path) {
        if let Some(watcher) = &self.watcher {
            // A thread that has ended watches nothing.
            let _ = watcher.accept.send(path.to_owned());
        }
    }

    /// Takes up what the thread found; a sentence where a file has vanished.
    pub fn poll(&mut self) -> Option<String> {
        let mut sentence = None;
        while let Some(news) = self.watcher.as_ref().and_then(|watcher| watcher.news.try_recv().ok()) {
            match news {
                News::Changed(path) => self.changed = Some(path),
                News::Vanished(path) => {
                    self.changed.take_if(|changed| *changed == path);
                    sentence =
                        Some(format!("The file {} is gone from the disk; its scene stays in view.", name_of(&path)));
                }
            }
        }
        sentence
    }

    /// Whether the scene that came is the former one, read anew; reported once.
    pub fn take_reloading(&mut self) -> bool {
        self.reloading.take().is_some()
    }

    /// A scene is asked for; any other than the one that is read anew makes that pointless.
    pub fn note_asked(&mut self, source: &Source) {
        self.reloading.take_if(|reloading| reloading != source);
    }

    /// The scene in view is read anew.
    pub fn note_reloading(&mut self, source: Source) {
        self.reloading = Some(source);
    }

    /// A scene could not be read.
    pub fn forget_reload(&mut self) {
        self.reloading = None;
    }
}

fn name_of(path: &Path) -> String {
    path.file_name().unwrap_or(path.as_os_str()).to_string_lossy().into_owned()
}

fn spawn(stamps: Vec<FileStamp>, wake: Wake) -> Option<Watcher> {
    if stamps.is_empty() {
        return None;
    }
    let (accept, accepted) = channel();
    let (sender, news) = channel();
    let watch = move || {
        let mut files: Vec<Watched> = stamps.into_iter().map(Watched::new).collect();
        loop {
            match accepted.recv_timeout(INTERVAL) {
                Ok(path) => files.iter_mut().filter(|file| file.known.path == path).for_each(Watched::accept),
                Err(RecvTimeoutError::Disconnected) => return,
                Err(RecvTimeoutError::Timeout) => {
                    for news in files.iter_mut().filter_map(|file| file.look(file.known.again())) {
                        // Nobody watches any more.
                        if sender.send(news).is_err() {
                            return;
                        }
                        wake();
                    }
                }
            }
        }
    };
    Builder::new().name("watcher".into()).spawn(watch).ok()?;
    Some(Watcher { accept, news })
}

/// A file, as it was read and as it was last seen.
struct Watched {
    known: FileStamp,
    last: FileStamp,
}

impl Watched {
    fn new(known: FileStamp) -> Self {
        Self { last: known.clone(), known }
    }

    /// Takes the file as it is now for what was read.
    fn accept(&mut self) {
        *self = Self::new(self.known.again());
    }

    /// Takes up another look. What differs is believed when it looks alike twice: a file that is
    /// being written grows, and one that is being replaced is gone for a moment. Reported once.
    fn look(&mut self, now: FileStamp) -> Option<News> {
        let is_settled = now == self.last;
        self.last = now;
        if !is_settled || self.last == self.known {
            return None;
        }
        self.known = self.last.clone();
        let path = self.known.path.clone();
        Some(if self.known.seen.is_some() { News::Changed(path) } else { News::Vanished(path) })
    }
}

/// Draws the bar over the view that offers to read a changed file again.
pub fn show(ui: &mut Ui, watch: &mut Watch, outbox: &mut Outbox) {
    let Some(path) = &watch.changed else { return };
    let name = name_of(path);
    let fill = theme::palette(ui.visuals()).note_fill;
    let [mut reload, mut keep] = [false; 2];
    let say = |ui: &mut Ui| {
        ui.add(egui::Label::new(egui::RichText::new(format!("{name} has changed on disk.")).strong()).truncate());
    };
    rows::bar(ui, fill, theme::ACCENT, say, |ui| {
        let hint = "Goes on with the scene as it is in view; what changes after this is reported again.";
        keep = ui.button("Keep").on_hover_text(hint).clicked();
        let hint = "Reads the file again. Camera, lamps and settings stay; materials and groups that were changed here and not saved do not.";
        reload = ui.button("Reload").on_hover_text(hint).clicked();
    });
    if keep || reload {
        watch.changed = None;
    }
    if reload {
        outbox.act(Action::Reload);
    }
}

#[cfg(test)]
mod tests {
    use std::time::SystemTime;

    use super::*;

    fn stamp(length: Option<u64>) -> FileStamp {
        FileStamp { path: "room.obj".into(), seen: length.map(|length| (SystemTime::UNIX_EPOCH, length)) }
    }

    /// Truth: the rules of `look`, on the looks that an editor's save gives.
    #[test]
    fn a_file_is_believed_to_have_changed_when_it_keeps_still() {
        let mut file = Watched::new(stamp(Some(100)));
        // It is emptied, grows, and is whole.
        for length in [100, 0, 40, 80, 120] {
            assert_eq!(file.look(stamp(Some(length))), None);
        }
        assert_eq!(file.look(stamp(Some(120))), Some(News::Changed("room.obj".into())));
        assert_eq!(file.look(stamp(Some(120))), None, "reported once");
        // It is replaced: gone for a moment, and then as it was.
        assert_eq!([None, Some(120), Some(120)].map(|length| file.look(stamp(length))), [None, None, None]);
        // It is gone for good, and then comes back.
        assert_eq!(file.look(stamp(None)), None);
        assert_eq!(file.look(stamp(None)), Some(News::Vanished("room.obj".into())));
        assert_eq!(file.look(stamp(None)), None, "reported once");
        assert_eq!(file.look(stamp(Some(120))), None);
        assert_eq!(file.look(stamp(Some(120))), Some(News::Changed("room.obj".into())));
    }
}
