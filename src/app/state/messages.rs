//! The bar over the view: sentences that stay until they are dismissed.

use crate::app::widgets::theme;

/// No more than these are shown; older ones make room.
const MOST: usize = 4;
/// Room kept for the button beside a sentence, points.
const BUTTON_ROOM: f32 = 80.0;

#[derive(Clone, Copy, PartialEq, Eq)]
enum Kind {
    Error,
    Note,
}

/// Sentences that wait to be read.
#[derive(Default)]
pub(in crate::app) struct Messages {
    entries: Vec<(Kind, String)>,
}

impl Messages {
    /// Something that was asked for cannot be done.
    pub(in crate::app) fn error(&mut self, sentence: String) {
        self.push(Kind::Error, sentence);
    }

    /// Something worth knowing.
    pub(in crate::app) fn note(&mut self, sentence: String) {
        self.push(Kind::Note, sentence);
    }

    /// Takes back what could not be done; for a scene that came after it, it no longer matters.
    pub(in crate::app) fn forget_errors(&mut self) {
        self.entries.retain(|(kind, _)| *kind != Kind::Error);
    }

    fn push(&mut self, kind: Kind, sentence: String) {
        let sentence = as_sentence(&crate::app::format::without_os_codes(&sentence));
        self.entries.retain(|(_, entry)| *entry != sentence);
        self.entries.push((kind, sentence));
        let surplus = self.entries.len().saturating_sub(MOST);
        self.entries.drain(..surplus);
    }

    /// Draws the bar; nothing when there is nothing to say.
    pub(in crate::app) fn show(&mut self, ui: &mut egui::Ui) {
        let mut dismissed = None;
        for (index, (kind, sentence)) in self.entries.iter().enumerate() {
            let palette = theme::palette(ui.visuals());
            let (fill, mark) = match kind {
                Kind::Error => (palette.error_fill, theme::ERROR),
                Kind::Note => (palette.note_fill, theme::ACCENT),
            };
            egui::Frame::new().fill(fill).inner_margin(egui::Margin::symmetric(12, 8)).show(ui, |ui| {
                ui.horizontal(|ui| {
                    let (dot, _) = ui.allocate_exact_size(egui::vec2(8.0, 8.0), egui::Sense::hover());
                    ui.painter().circle_filled(dot.center(), 4.0, mark);
                    let text = egui::RichText::new(sentence).strong();
                    ui.scope(|ui| {
                        ui.set_max_width(ui.available_width() - BUTTON_ROOM);
                        ui.add(egui::Label::new(text).wrap());
                    });
                    ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
                        if ui.button("Dismiss").clicked() {
                            dismissed = Some(index);
                        }
                    });
                });
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
    fn sentences_are_said_once_and_the_oldest_make_room() {
        let mut messages = Messages::default();
        for number in [1, 2, 3, 4, 5, 5] {
            messages.error(format!("number {number} failed"));
        }
        let texts: Vec<_> = messages.entries.iter().map(|(_, text)| text.as_str()).collect();
        assert_eq!(texts, ["Number 2 failed.", "Number 3 failed.", "Number 4 failed.", "Number 5 failed."]);
        messages.note("saved".into());
        messages.forget_errors();
        let texts: Vec<_> = messages.entries.iter().map(|(_, text)| text.as_str()).collect();
        assert_eq!(texts, ["Saved."]);
    }
}
