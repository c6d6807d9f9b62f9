//! The export tool: pictures, meshes, links, numbers, and the scene for programs that check its
//! light.

use std::path::{Path, PathBuf};

use egui::{Button, DragValue, RichText, Ui};

use crate::app::actions::{Action, Outbox};
use crate::app::state::exports::{self, Exports, Item, PictureSize, Target};
use crate::app::view::viewport::Viewport;
use crate::app::widgets::dialog::DialogAnswer;
use crate::app::widgets::{rows, theme};
use crate::app::{Shown, Wake, format};
use crate::export::MeshFormat;
use crate::export::peers::Peer;
use crate::export::settings::Settings;
use crate::render::MAX_SIZE;

/// Text of a button, the item that it writes, and a hint about it.
type Offer = (Item, &'static str, &'static str);

const PICTURES: [Offer; 2] = [
    (Item::Png, "Picture (PNG)", "What the view shows: exposed and tone-mapped, overlays and colours included"),
    (Item::Exr, "Radiosities (EXR)", "What the view sees as radiosity B in W/m², 32-bit floats, linear and unexposed"),
];
const MESHES: [Offer; 2] = [
    (
        Item::Mesh(MeshFormat::Glb),
        "Mesh (GLB)",
        "Vertices with tone-mapped colours, which other programs show, and radiosities in W/m²",
    ),
    (Item::Mesh(MeshFormat::Ply), "Mesh (PLY)", "Vertices with radiosities in W/m² and tone-mapped colours, binary"),
];
const NUMBERS: [Offer; 3] = [
    (Item::Links, "Links (CSV)", "Every link: both ends, form factor F, visibility V, rays and power in W"),
    (
        Item::Settings,
        "Settings (JSON)",
        "Scene, added light, view and parameters; `selflink solve --settings` solves it again",
    ),
    (Item::Statistics, "Statistics (JSON)", "Counts and times, with the settings that they belong to"),
];
const PEERS: [Offer; 2] = [
    (
        Item::Peer(Peer::Mitsuba),
        "Scene (Mitsuba 3)",
        "A folder with geometry, reflectances, emission and camera, and a script that traces the light again (docs/accuracy/check.md)",
    ),
    (
        Item::Peer(Peer::Radiance),
        "Scene (Radiance)",
        "A folder with geometry, reflectances, emission and view for oconv and rtrace (docs/accuracy/check.md)",
    ),
];

/// Draws the tool; `view` is the size of what is drawn there, pixels.
pub fn show(ui: &mut Ui, shown: &Shown, exports: &mut Exports, view: [u32; 2], outbox: &mut Outbox) {
    if shown.info.is_none() || shown.snapshot.is_none() {
        ui.label(theme::weak("Nothing to export yet: open a scene."));
        return;
    }
    show_name(exports, ui);
    ui.add_space(6.0);
    let mut wanted = None;
    let is_idle = exports.writing().is_none();
    heading(ui, "The view");
    show_size(exports, ui, view);
    buttons(ui, is_idle, &PICTURES, &mut wanted);
    for (title, offers) in [("The lit mesh", &MESHES[..]), ("Numbers", &NUMBERS), ("For other programs", &PEERS)] {
        heading(ui, title);
        buttons(ui, is_idle, offers, &mut wanted);
    }
    ui.add_space(6.0);
    if let Some(item) = wanted {
        ask(exports, item, outbox);
    }
    show_question(exports, ui, outbox);
    show_state(exports, ui);
}

fn heading(ui: &mut Ui, text: &str) {
    ui.add_space(6.0);
    ui.label(RichText::new(text).strong());
}

fn show_name(exports: &mut Exports, ui: &mut Ui) {
    if let Some(answer) = exports.dialog.poll() {
        match answer {
            DialogAnswer::Chosen(path) => exports.name = path.with_extension("").to_string_lossy().into_owned(),
            DialogAnswer::NoDialog => {
                let sentence = "No file dialog answers on this system: type folder and name into the field.";
                exports.outcome = Some(Err(sentence.into()));
            }
        }
    }
    ui.label(theme::weak("Folder and name; each file adds its own ending"));
    ui.horizontal(|ui| {
        let choose = ui.add_enabled(!exports.dialog.is_open(), Button::new("Choose…"));
        if choose.on_hover_text("Choose folder and name with the system's dialog").clicked() {
            let present = PathBuf::from(&exports.name);
            let folder = present.parent().map(Path::to_owned).unwrap_or_default();
            let name = present.file_name().unwrap_or_default().to_string_lossy().into_owned();
            exports.dialog.open(ui.ctx(), move || {
                let dialog = rfd::FileDialog::new().set_title("Folder and name of the files");
                dialog.set_directory(folder).set_file_name(name).save_file()
            });
        }
        let field = egui::TextEdit::singleline(&mut exports.name).desired_width(ui.available_width() - 4.0);
        let response = ui.add(field).accessible_name("Name of the files");
        let _ = response.on_hover_text(exports.name.as_str());
    });
}

fn show_size(exports: &mut Exports, ui: &mut Ui, view: [u32; 2]) {
    let text = |size: PictureSize, own: [u32; 2]| {
        let named = |name: &str, [width, height]: [u32; 2]| format!("{name}{width} × {height}");
        match size {
            PictureSize::AsShown => named("As shown: ", view),
            PictureSize::FullHd | PictureSize::FourK => named("", pixels(size, own, view)),
            PictureSize::Own => "Custom…".to_owned(),
        }
    };
    let (own, sizes) =
        (exports.own_size, [PictureSize::AsShown, PictureSize::FullHd, PictureSize::FourK, PictureSize::Own]);
    rows::choice(ui, "Size in pixels", &mut exports.size, sizes, |size| text(*size, own));
    if exports.size == PictureSize::Own {
        let [width, height] = &mut exports.own_size;
        for (value, name) in [(width, "Width"), (height, "Height")] {
            rows::row(ui, name, |ui| ui.add(DragValue::new(value).range(1..=MAX_SIZE).suffix(" pixels")));
        }
    }
}

fn pixels(size: PictureSize, own: [u32; 2], view: [u32; 2]) -> [u32; 2] {
    match size {
        PictureSize::AsShown => view,
        PictureSize::FullHd => [1920, 1080],
        PictureSize::FourK => [3840, 2160],
        PictureSize::Own => own,
    }
}

fn buttons(ui: &mut Ui, is_idle: bool, offers: &[Offer], wanted: &mut Option<Item>) {
    ui.horizontal_wrapped(|ui| {
        for (item, name, hint) in offers {
            if ui.add_enabled(is_idle, Button::new(*name)).on_hover_text(*hint).clicked() {
                *wanted = Some(*item);
            }
        }
    });
}

/// Writes a file, or asks first where one is there.
fn ask(exports: &mut Exports, item: Item, outbox: &mut Outbox) {
    exports.in_question = None;
    match exports.path(item) {
        Some(path) if path.exists() => exports.in_question = Some(item),
        Some(_) => outbox.act(Action::Export(item)),
        None => exports.outcome = Some(Err("Give the files a name first, such as /home/me/room.".into())),
    }
}

fn show_question(exports: &mut Exports, ui: &mut Ui, outbox: &mut Outbox) {
    let Some((item, path)) = exports.in_question.and_then(|item| Some((item, exports.path(item)?))) else { return };
    ui.label(format!("{} already exists.", path.file_name().unwrap_or(path.as_os_str()).to_string_lossy()));
    ui.horizontal(|ui| {
        let overwrite = ui.button("Overwrite it").clicked();
        if overwrite {
            outbox.act(Action::Export(item));
        }
        if ui.button("Keep it").clicked() || overwrite {
            exports.in_question = None;
        }
    });
}

fn show_state(exports: &mut Exports, ui: &mut Ui) {
    if let Some((path, since)) = exports.writing() {
        let name = path.file_name().unwrap_or(path.as_os_str()).to_string_lossy();
        let text = format!("Writing {name}, {}…", format::seconds(since.elapsed().as_secs_f64()));
        let is_given_up = ui.horizontal(|ui| {
            ui.label(text);
            ui.button("Cancel").on_hover_text("Do not write this file").clicked()
        });
        if is_given_up.inner {
            exports.cancel();
        }
        ui.ctx().request_repaint_after(std::time::Duration::from_millis(250));
    }
    match &exports.outcome {
        Some(Ok(sentence)) => {
            rows::sentence(ui, sentence.as_str());
        }
        Some(Err(sentence)) => {
            let sentence = format::without_os_codes(sentence);
            rows::failure(ui, sentence);
        }
        None => {}
    }
}

/// Writes a file and returns what to say of it.
type Write = Box<dyn FnOnce(&Target) -> Result<String, String> + Send>;

/// Hands a file to its thread.
pub fn begin(exports: &mut Exports, item: Item, shown: &Shown, viewport: &Viewport, settings: Settings, wake: &Wake) {
    let (Some(path), Some(info), Some(snapshot)) = (exports.path(item), &shown.info, &shown.snapshot) else { return };
    let (scene, snapshot) = (info.scene.clone(), snapshot.clone());
    let picture = viewport.picture(pixels(exports.size, exports.own_size, viewport.pixels()));
    let write: Write = match (item, picture) {
        (Item::Png, Some(picture)) => Box::new(move |to| exports::write_png(to, &picture)),
        (Item::Exr, Some(picture)) => Box::new(move |to| exports::write_exr(to, &picture, &snapshot)),
        (Item::Png | Item::Exr, None) => {
            exports.outcome = Some(Err("Nothing has been drawn yet.".into()));
            return;
        }
        (Item::Mesh(form), _) => Box::new(move |to| exports::write_mesh(to, form, &snapshot, &scene)),
        (Item::Links, _) => Box::new(move |to| exports::write_links(to, &snapshot)),
        (Item::Peer(peer), _) => Box::new(move |to| exports::write_peer(to, peer, &scene)),
        (Item::Settings, _) => {
            Box::new(move |to| exports::write_text(to, &settings.to_json().map_err(|error| error.to_string())?))
        }
        (Item::Statistics, _) => Box::new(move |to| {
            let report = serde_json::json!({
                "scene": scene.name, "settings": settings, "statistics": snapshot.stats,
            });
            let text = serde_json::to_string_pretty(&report).map_err(|error| error.to_string())?;
            exports::write_text(to, &(text + "\n"))
        }),
    };
    exports.begin(path, wake, write);
}
