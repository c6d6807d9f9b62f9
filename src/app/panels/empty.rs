//! Texts of the view when there is no picture, while a scene is being loaded, and while a file
//! hovers over it.

use std::time::Duration;

use egui::{Align2, Rect, RichText, Ui};

use crate::app::widgets::theme;
use crate::app::{Outbox, Shown, words};
use crate::scene::Source;
use crate::scene::builtin::BuiltinScene;
use crate::worker::Command;

/// Time between two dots of the loading message, seconds.
const DOT_SECONDS: f64 = 0.4;

/// In place of the first picture: how to get one.
pub fn show(ui: &Ui, shown: &Shown, rect: Rect, outbox: &mut Outbox) {
    egui::Area::new(egui::Id::unique("empty")).pivot(Align2::CENTER_CENTER).fixed_pos(rect.center()).show(
        ui.ctx(),
        |ui| {
            theme::over_the_view(ui);
            ui.set_width(rect.width().min(420.0));
            ui.vertical_centered(|ui| match &shown.status.loading {
                Some(name) => {
                    loading_label(ui, name, 15.0);
                }
                None => {
                    ui.label(RichText::new(words::OPEN_A_ROOM).size(20.0).strong());
                    ui.label(theme::weak(
                        "Drop an OBJ, glTF, GLB, PLY or STL file here, or start with a sample scene:",
                    ));
                    ui.add_space(8.0);
                    ui.columns(BuiltinScene::ALL.len(), |columns| {
                        for (column, scene) in columns.iter_mut().zip(BuiltinScene::ALL) {
                            let size = egui::vec2(column.available_width(), 30.0);
                            if column.add_sized(size, egui::Button::new(scene.name())).clicked() {
                                outbox.push(Command::load(Source::Builtin(scene)));
                            }
                        }
                    });
                }
            });
        },
    );
}

/// Over the present picture: what is being loaded, and a way out.
pub fn show_loading(ui: &Ui, shown: &Shown, rect: Rect, outbox: &mut Outbox) {
    let Some(name) = &shown.status.loading else { return };
    let at = rect.center_top() + egui::vec2(0.0, 12.0);
    egui::Area::new(egui::Id::unique("loading")).pivot(Align2::CENTER_TOP).fixed_pos(at).show(ui.ctx(), |ui| {
        theme::over_the_view(ui);
        egui::Frame::popup(ui.style()).show(ui, |ui| {
            ui.horizontal(|ui| {
                loading_label(ui, name, 13.0);
                if ui.button(words::CANCEL).on_hover_text("Keep the scene that is in view").clicked() {
                    outbox.push(Command::CancelLoad);
                }
            });
        });
    });
}

/// One to three dots in turn show that something goes on; a spinner would repaint the window at
/// full speed, and on software adapters that takes the loader's cores.
fn loading_label(ui: &mut Ui, name: &str, size: f32) {
    let dots = 1 + (ui.input(|input| input.time) / DOT_SECONDS) as usize % 3;
    let text = format!("Loading {name} {:<3}", ".".repeat(dots));
    ui.label(RichText::new(text).size(size));
    ui.ctx().request_repaint_after(Duration::from_secs_f64(DOT_SECONDS));
}

/// While a file hovers over the window.
pub fn show_drop_hint(ui: &Ui, rect: Rect) {
    if ui.input(|input| input.raw.hovered_files.is_empty()) {
        return;
    }
    let painter = ui.painter_at(rect);
    painter.rect_filled(rect, 0.0, egui::Color32::from_black_alpha(160));
    let font = egui::FontId::proportional(20.0);
    painter.text(rect.center(), Align2::CENTER_CENTER, "Drop to open this scene", font, theme::TEXT_STRONG);
}
