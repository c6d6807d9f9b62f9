//! The scene section: what is in view, and ways to open something else.

use std::path::PathBuf;

use egui::{ComboBox, RichText, Ui};

use crate::app::actions::{Action, Outbox};
use crate::app::state::files::Files;
use crate::app::widgets::{rows, theme};
use crate::app::{Shown, format, words};
use crate::scene::builtin::BuiltinScene;
use crate::scene::{Sidecar, Source, Unit, UpAxis};
use crate::worker::{Command, SceneInfo};

/// Draws the section.
pub fn show(ui: &mut Ui, shown: &Shown, files: &mut Files, outbox: &mut Outbox) {
    match &shown.info {
        Some(info) => {
            show_present(ui, info);
            if info.path.is_some() {
                show_frame(ui, info, outbox);
            }
        }
        None => {
            ui.label(theme::weak("No scene is open."));
        }
    }
    ui.add_space(4.0);
    show_path_field(ui, files, outbox);
    ui.horizontal_wrapped(|ui| {
        rows::row_label(ui, "Sample scenes");
        for scene in BuiltinScene::ALL {
            if ui.button(scene.name()).clicked() {
                outbox.push(Command::load(Source::Builtin(scene)));
            }
        }
    });
    ui.horizontal(|ui| {
        show_recent(ui, files, outbox);
        let hint = "Writes NAME.selflink.json beside the scene: what was changed of materials, luminaires, sides, the present camera, bookmarks and the task area. What it says already stays.";
        if sidecar_of(shown).is_some() && ui.button(words::SAVE_SCENE_SETTINGS).on_hover_text(hint).clicked() {
            outbox.act(Action::SaveSettings { overwrites: false });
        }
    });
    show_question(ui, sidecar_of(shown), files, outbox);
}

/// Up axis, length unit and views of the file.
fn show_frame(ui: &mut Ui, info: &SceneInfo, outbox: &mut Outbox) {
    let scene = &info.scene;
    let mut reading = scene.reading.clone();
    ui.horizontal_wrapped(|ui| {
        rows::row_label(ui, "Up and unit");
        let mut up = scene.frame.up.unwrap_or_default();
        let combo = ComboBox::from_id_salt("up axis").width(44.0).selected_text(up.letter());
        let shown = combo.show_ui(ui, |ui| {
            for axis in [UpAxis::Y, UpAxis::Z] {
                ui.selectable_value(&mut up, axis, axis.letter());
            }
        });
        shown.response.on_hover_text("The axis of the file that points up; another one reads the file again");
        if up != scene.frame.up.unwrap_or_default() {
            reading.up = Some(up);
        }
        let mut unit = scene.frame.unit;
        let combo = ComboBox::from_id_salt("length unit").width(54.0).selected_text(unit.symbol());
        let shown = combo.show_ui(ui, |ui| {
            for each in Unit::ALL {
                ui.selectable_value(&mut unit, each, format!("{} ({})", each.symbol(), each.name()));
            }
        });
        let hint = "The unit of the file's lengths; another one reads the file again. Readings are in metres";
        shown.response.on_hover_text(hint);
        if unit != scene.frame.unit {
            reading.unit = Some(unit);
        }
        if !scene.cameras.is_empty() {
            ui.menu_button("Cameras", |ui| {
                for camera in &scene.cameras {
                    if ui.button(camera.name.as_str()).clicked() {
                        outbox.act(Action::GoTo(camera.pose));
                        ui.close();
                    }
                }
            });
        }
    });
    if reading != scene.reading {
        outbox.act(Action::Read(reading));
    }
}

fn show_present(ui: &mut Ui, info: &SceneInfo) {
    ui.horizontal(|ui| {
        let name = RichText::new(&info.scene.name).strong();
        let label = ui.add(egui::Label::new(name).truncate());
        if let Some(path) = &info.path {
            label.on_hover_text(path.display().to_string());
        }
    });
    let polygons = format::things(info.scene.polygons.len(), "polygon", "polygons");
    let materials = format::things(info.scene.materials.len(), "material", "materials");
    ui.label(theme::weak(format!("{polygons}, {materials}, loaded in {}", format::seconds(info.load_seconds))));
    if !info.skipped.is_empty() {
        let title = format::things(info.skipped.len(), "remark from loading", "remarks from loading");
        egui::CollapsingHeader::new(theme::notice(ui, title))
            .id_salt(("remarks", info.generation))
            .default_open(info.skipped.len() <= 3)
            .show(ui, |ui| {
                for sentence in &info.skipped {
                    rows::sentence(ui, theme::weak(sentence));
                }
            });
    }
}

fn show_path_field(ui: &mut Ui, files: &mut Files, outbox: &mut Outbox) {
    ui.horizontal(|ui| {
        let browse = egui::Button::new("Browse…");
        if ui
            .add_enabled(!files.field.dialog.is_open(), browse)
            .on_hover_text("Choose a file (OBJ, glTF, GLB, PLY, STL)")
            .clicked()
        {
            files.open_dialog(ui.ctx());
        }
        let width = ui.available_width() - 64.0;
        let id = ui.make_persistent_id("scene path");
        // While nobody types, the end of a long path tells more than its start.
        let is_typed = ui.memory(|memory| memory.has_focus(id));
        let mut end = if is_typed { None } else { end_that_fits(ui, &files.field.text, width - PATH_MARGIN) };
        let is_cut = end.is_some();
        let field = egui::TextEdit::singleline(end.as_mut().unwrap_or(&mut files.field.text))
            .id(id)
            .hint_text("path of an OBJ, glTF, GLB, PLY or STL file")
            .desired_width(width);
        let mut response = ui.add(field);
        if is_cut {
            response = response.on_hover_text(files.field.text.as_str());
        }
        let response = response.accessible_name(words::SCENE_PATH);
        let entered = response.lost_focus() && ui.input(|input| input.key_pressed(egui::Key::Enter));
        let can_open = files.field.typed().is_some();
        let open = ui.add_enabled(can_open, egui::Button::new(words::OPEN)).clicked();
        if (entered || open)
            && let Some(path) = files.field.typed()
        {
            outbox.push(Command::load(Source::File(path)));
        }
    });
}

/// Room that a text field keeps free beside its text, points.
const PATH_MARGIN: f32 = 12.0;

/// The end of a text behind an ellipsis, where the whole is wider than `width`.
fn end_that_fits(ui: &Ui, text: &str, width: f32) -> Option<String> {
    let font = egui::TextStyle::Body.resolve(ui.style());
    let width_of = |letter: char| ui.ctx().fonts_mut(|fonts| fonts.glyph_width(&font, letter));
    if text.chars().map(width_of).sum::<f32>() <= width {
        return None;
    }
    let mut left = width - width_of('…');
    let fits = |letter: &char| {
        left -= width_of(*letter);
        left >= 0.0
    };
    let backwards: Vec<char> = text.chars().rev().take_while(fits).collect();
    Some(std::iter::once('…').chain(backwards.into_iter().rev()).collect())
}

fn show_recent(ui: &mut Ui, files: &Files, outbox: &mut Outbox) {
    if files.recent().is_empty() {
        return;
    }
    let mut chosen: Option<PathBuf> = None;
    ui.menu_button("Recent files", |ui| {
        for path in files.recent() {
            let name = path.file_name().unwrap_or(path.as_os_str()).to_string_lossy();
            if ui.button(name).on_hover_text(path.display().to_string()).clicked() {
                chosen = Some(path.clone());
            }
        }
    });
    outbox.extend(chosen.map(|path| Command::load(Source::File(path))));
}

/// Where the sidecar of the scene in view lies, or would lie.
pub fn sidecar_of(shown: &Shown) -> Option<PathBuf> {
    shown.info.as_ref().and_then(|info| info.path.as_deref()).map(Sidecar::path_for)
}

/// Asks before a sidecar that is there already is overwritten.
fn show_question(ui: &mut Ui, present: Option<PathBuf>, files: &mut Files, outbox: &mut Outbox) {
    // Another scene makes the question pointless.
    let Some(path) = files.sidecar_in_question.take_if(|path| present.as_ref() == Some(path)) else { return };
    let name = path.file_name().unwrap_or(path.as_os_str()).to_string_lossy();
    rows::notice(ui, format!("Overwrite {name}?"));
    let (overwrite, cancel) =
        ui.horizontal(|ui| (ui.button(words::OVERWRITE).clicked(), ui.button(words::CANCEL).clicked())).inner;
    if overwrite {
        outbox.act(Action::SaveSettings { overwrites: true });
    } else if !cancel {
        files.sidecar_in_question = Some(path);
    }
}
