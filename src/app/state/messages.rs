//! The bar over the view: sentences that stay until they are dismissed, or until something newer is
//! known of what they are about.

use crate::app::widgets::{rows, theme};
use crate::app::words;

/// No more than these are shown; older ones make room.
const MOST: usize = 4;
/// Room kept for the button beside a sentence, points.
const BUTTON_ROOM: f32 = 80.0;

#[derive(Clone, Copy, PartialEq, Eq)]
enum Kind {
    Error,
    Note,
}

/// Action that a sentence is about. The outcome of a later one takes the place of the former's.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Topic {
    /// Reading a scene.
    Opening,
    /// Writing the settings file beside a scene.
    Saving,
    /// Writing a table.
    Writing,
    /// Solving with other settings.
    Solving,
    /// Drawing the view.
    Drawing,
    /// Making a reference.
    Reference,
    /// A remark about the scene or the program, which none other replaces.
    Remark,
}

struct Entry {
    kind: Kind,
    topic: Topic,
    sentence: String,
}

/// Sentences that wait to be read.
#[derive(Default)]
pub struct Messages {
    entries: Vec<Entry>,
}

impl Messages {
    /// Something that was asked for cannot be done.
    pub fn error(&mut self, topic: Topic, sentence: String) {
        self.push(Kind::Error, topic, sentence);
    }

    /// Something worth knowing.
    pub fn note(&mut self, topic: Topic, sentence: String) {
        self.push(Kind::Note, topic, sentence);
    }

    /// Takes back what could not be done; for a scene that came after it, it no longer matters.
    pub fn forget_errors(&mut self) {
        self.entries.retain(|entry| entry.kind != Kind::Error);
    }

    /// Withdraws the sentence about an action that has succeeded since, or is being tried again.
    pub fn resolve(&mut self, topic: Topic) {
        self.entries.retain(|entry| entry.topic != topic);
    }

    fn push(&mut self, kind: Kind, topic: Topic, sentence: String) {
        let sentence = as_sentence(&crate::app::format::without_os_codes(&sentence));
        if topic != Topic::Remark {
            self.resolve(topic);
        }
        self.entries.retain(|entry| entry.sentence != sentence);
        self.entries.push(Entry { kind, topic, sentence });
        let surplus = self.entries.len().saturating_sub(MOST);
        self.entries.drain(..surplus);
    }

    /// Draws the bar; nothing when there is nothing to say.
    pub fn show(&mut self, ui: &mut egui::Ui) {
        let mut dismissed = None;
        for (index, Entry { kind, sentence, .. }) in self.entries.iter().enumerate() {
            let palette = theme::palette(ui.visuals());
            let (fill, mark) = match kind {
                Kind::Error => (palette.error_fill, theme::ERROR),
                Kind::Note => (palette.note_fill, theme::ACCENT),
            };
            let say = |ui: &mut egui::Ui| {
                ui.scope(|ui| {
                    ui.set_max_width(ui.available_width() - BUTTON_ROOM);
                    rows::sentence(ui, egui::RichText::new(sentence).strong());
                });
            };
            rows::bar(ui, fill, mark, say, |ui| {
                if ui.button(words::DISMISS).clicked() {
                    dismissed = Some(index);
                }
            });
        }
        if let Some(index) = dismissed {
            self.entries.remove(index);
        }
    }
}

/// Errors of the library begin in lower case and end without a stop.
fn as_sentence(text: &str) -> String {
    let mut letters = text.chars();
    let first: String = letters.next().map(|letter| letter.to_uppercase().collect()).unwrap_or_default();
    let stop = if text.ends_with(['.', '!', '?']) { "" } else { "." };
    format!("{first}{}{stop}", letters.as_str())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn remarks_are_said_once_and_the_oldest_make_room() {
        let mut messages = Messages::default();
        for number in [1, 2, 3, 4, 5, 5] {
            messages.note(Topic::Remark, format!("remark {number}"));
        }
        assert_eq!(texts(&messages), ["Remark 2.", "Remark 3.", "Remark 4.", "Remark 5."]);
    }

    fn texts(messages: &Messages) -> Vec<&str> {
        messages.entries.iter().map(|entry| entry.sentence.as_str()).collect()
    }

    /// Truth: a person who fails twice and then succeeds has nothing left to read but that.
    #[test]
    fn a_later_outcome_takes_the_place_of_an_earlier_one() {
        let mut messages = Messages::default();
        messages.error(Topic::Opening, "a is broken".into());
        messages.error(Topic::Saving, "the disk is full".into());
        messages.error(Topic::Opening, "b is not there".into());
        assert_eq!(texts(&messages), ["The disk is full.", "B is not there."]);
        messages.note(Topic::Saving, "saved".into());
        messages.resolve(Topic::Opening);
        assert_eq!(texts(&messages), ["Saved."]);
        messages.error(Topic::Solving, "too little memory".into());
        messages.forget_errors();
        assert_eq!(texts(&messages), ["Saved."]);
    }
}
