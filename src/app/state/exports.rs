//! Files that the window writes, each on a thread of its own: pictures, meshes, links, settings and
//! statistics.
//!
//! One file is written at a time; the window goes on meanwhile and says what came of it. Whoever
//! tires of waiting may cancel.

use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::task::Poll;
use std::time::Instant;

use image::{ImageFormat, RgbaImage};

use crate::app::view::gathering::gather_for_file;
use crate::app::view::paint::Picture;
use crate::app::widgets::dialog::Dialog;
use crate::app::{Wake, format};
use crate::base::cancel::CancelToken;
use crate::base::file;
use crate::base::threads::Background;
use crate::export::peers::Peer;
use crate::export::{LitMesh, MeshFormat, exr, file_name, links};
use crate::read::picture::GatheredPicture;
use crate::render::{Display, Frame, Offscreen, Overlay, Pixels, RenderError, annotate, developed};
use crate::scene::Scene;
use crate::solve::Snapshot;

/// Size of a picture that is to be written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PictureSize {
    /// As the view has it.
    AsShown,
    FullHd,
    FourK,
    /// As a person says.
    Own,
}

/// One file that can be written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Item {
    Png,
    Exr,
    Mesh(MeshFormat),
    Links,
    Settings,
    Statistics,
    /// The scene for another program: a folder of files.
    Peer(Peer),
}

impl Item {
    /// Ending of the file or folder, behind the name that a person chose.
    pub fn ending(self) -> &'static str {
        match self {
            Self::Png => ".png",
            Self::Exr => ".exr",
            Self::Mesh(MeshFormat::Ply) => ".ply",
            Self::Mesh(MeshFormat::Glb) => ".glb",
            Self::Links => ".links.csv",
            Self::Settings => ".settings.json",
            Self::Statistics => ".statistics.json",
            Self::Peer(Peer::Mitsuba) => ".mitsuba",
            Self::Peer(Peer::Radiance) => ".radiance",
        }
    }
}

/// State of the exports.
pub struct Exports {
    /// Folder and beginning of every file's name, as typed.
    pub name: String,
    pub size: PictureSize,
    /// Width and height where the size is a person's own, pixels.
    pub own_size: [u32; 2],
    pub dialog: Dialog,
    /// A file that is there already and is to be overwritten only if a person says so.
    pub in_question: Option<Item>,
    writing: Option<Writing>,
    /// Outcome of the last export.
    pub outcome: Option<Result<String, String>>,
}

struct Writing {
    path: PathBuf,
    cancel: CancelToken,
    since: Instant,
    answer: Background<Result<String, String>>,
}

impl Default for Exports {
    fn default() -> Self {
        Self {
            name: String::new(),
            size: PictureSize::AsShown,
            own_size: [2560, 1600],
            dialog: Dialog::default(),
            in_question: None,
            writing: None,
            outcome: None,
        }
    }
}

impl Exports {
    /// A name in the present folder for another scene, unless a person chose one.
    pub fn suggest(&mut self, scene: &str, former: Option<&str>) {
        if self.name.is_empty() || former.is_some_and(|former| self.name == suggested(former)) {
            self.name = suggested(scene);
        }
        (self.outcome, self.in_question) = (None, None);
    }

    /// Where a file goes.
    pub fn path(&self, item: Item) -> Option<PathBuf> {
        let name = self.name.trim().trim_matches(['"', '\'']);
        // A folder alone is no name.
        (!name.is_empty() && !name.ends_with(['/', '\\'])).then(|| PathBuf::from(format!("{name}{}", item.ending())))
    }

    /// The file that is being written, and since when.
    pub fn writing(&self) -> Option<(&Path, Instant)> {
        self.writing.as_ref().map(|writing| (writing.path.as_path(), writing.since))
    }

    /// Gives up on the file that is being written: nobody waits for its thread, which stops before
    /// it writes.
    pub fn cancel(&mut self) {
        if let Some(writing) = self.writing.take() {
            writing.cancel.cancel();
        }
    }

    /// Writes a file on a thread of its own; `write` returns what to say of it.
    pub fn begin(
        &mut self,
        path: PathBuf,
        wake: &Wake,
        write: impl FnOnce(&Target) -> Result<String, String> + Send + 'static,
    ) {
        let cancel = CancelToken::new();
        let (wake, target) = (wake.clone(), Target { path: path.clone(), cancel: cancel.clone() });
        self.outcome = None;
        match Background::start("export", move || wake(), move || write(&target)) {
            Ok(answer) => self.writing = Some(Writing { path, cancel, since: Instant::now(), answer }),
            Err(error) => {
                self.outcome = Some(Err(format!("{}: no thread is left to write it ({error})", path.display())));
            }
        }
    }

    /// Takes up what came of a file.
    pub fn poll(&mut self) {
        let Some(writing) = &self.writing else { return };
        let Poll::Ready(outcome) = writing.answer.poll() else { return };
        let broken = || Err(format!("{}: was not written, the thread broke", writing.path.display()));
        let outcome = outcome.unwrap_or_else(broken);
        self.writing = None;
        self.outcome = Some(outcome);
    }
}

fn suggested(scene: &str) -> String {
    let folder = std::env::current_dir().unwrap_or_default();
    folder.join(file_name(scene)).to_string_lossy().into_owned()
}

/// Writes a picture as it is shown.
pub fn write_png(target: &Target, picture: &Picture) -> Result<String, String> {
    let gathered = gathered(target, picture)?;
    let drawn = draw(picture, gathered.as_ref())?;
    let mut encoded = io::Cursor::new(Vec::new());
    drawn.write_to(&mut encoded, ImageFormat::Png).map_err(|error| error.to_string())?;
    target.write(|writer| writer.write_all(encoded.get_ref()))?;
    let [width, height] = picture.size;
    Ok(target.saved(&format!("{width} × {height} pixels")))
}

/// The picture gathered in the size of the file, where the view shows such.
fn gathered(target: &Target, picture: &Picture) -> Result<Option<GatheredPicture>, String> {
    let Some((error, field)) = picture.noise.zip(picture.snapshot.field.as_ref()) else { return Ok(None) };
    let has_lines = picture.display.reading.is_some_and(|reading| !reading.isolines.values().is_empty());
    let gathered = gather_for_file(field, &picture.camera, picture.size, error, has_lines, &target.cancel);
    // Whoever cancelled it waits for no sentence.
    gathered.map(Some).ok_or_else(String::new)
}

/// Draws what the window shows, both sides of a split view included.
fn draw(picture: &Picture, gathered: Option<&GatheredPicture>) -> Result<RgbaImage, String> {
    let in_words = |error: RenderError| error.to_string();
    let Display { exposure, reading, .. } = picture.display;
    let gathered = gathered.and_then(|gathered| developed(gathered, exposure, reading.as_ref())).map(Arc::new);
    let mut offscreen = Offscreen::new().map_err(in_words)?;
    let mut draw = |snapshot: &Snapshot, overlay: &Overlay, gathered: Option<&Arc<Pixels>>| {
        let Picture { camera, display, size, outside, .. } = picture;
        let outside = outside.as_ref();
        let frame = Frame { snapshot, outside, camera, display, gathered, overlay, size: *size };
        offscreen.picture_over(&frame).map_err(in_words)
    };
    let mut drawn = draw(&picture.snapshot, &picture.overlay, gathered.as_ref())?;
    if let Some(beside) = &picture.beside {
        let left = draw(&beside.snapshot, &beside.overlay(picture), None)?;
        let [width, height] = picture.size;
        let covered = (beside.share * width as f32).round() as u32;
        let left = image::imageops::crop_imm(&left, 0, 0, covered, height).to_image();
        image::imageops::replace(&mut drawn, &left, 0, 0);
    }
    if let Some(reading) = &reading {
        let labels = gathered.as_ref().map_or(&[][..], |pixels| &pixels.labels);
        annotate(&mut drawn, reading, labels, true).map_err(|error| error.to_string())?;
    }
    Ok(drawn)
}

/// Writes what the view shows as radiosities in W/m².
pub fn write_exr(target: &Target, picture: &Picture, lit: &Snapshot) -> Result<String, String> {
    let layers = gathered(target, picture)?.and_then(|gathered| gathered.layers());
    match layers {
        Some(layers) => target.write(|writer| exr::write_layers(writer, &layers))?,
        None => {
            let drawn = Offscreen::new()
                .and_then(|mut offscreen| offscreen.radiosities(lit, &picture.camera, picture.size))
                .map_err(|error| error.to_string())?;
            target.write(|writer| exr::write(writer, &drawn))?;
        }
    }
    let [width, height] = picture.size;
    Ok(target.saved(&format!("{width} × {height} pixels, W/m²")))
}

/// Writes the lit mesh.
pub fn write_mesh(target: &Target, form: MeshFormat, snapshot: &Snapshot, scene: &Scene) -> Result<String, String> {
    let lit = LitMesh::of(snapshot, scene);
    target.write(|writer| form.write(writer, &lit))?;
    Ok(target.saved(&format::things(snapshot.mesh.triangles.len(), "triangle", "triangles")))
}

/// Writes the links of a snapshot that carries its solution view.
pub fn write_links(target: &Target, snapshot: &Arc<Snapshot>) -> Result<String, String> {
    let solution_view = snapshot.solution_view.as_ref().ok_or("the links are not there yet: try again")?;
    target.write(|writer| links::write(writer, solution_view))?;
    Ok(target.saved(&format::things(solution_view.links().len(), "link", "links")))
}

/// Writes a text that is there already.
pub fn write_text(target: &Target, text: &str) -> Result<String, String> {
    target.write(|writer| writer.write_all(text.as_bytes()))?;
    Ok(target.saved(&format::bytes(text.len())))
}

/// Writes the scene into a folder as another program reads it.
pub fn write_peer(target: &Target, peer: Peer, scene: &Scene) -> Result<String, String> {
    if target.cancel.is_cancelled() {
        return Err(String::new());
    }
    peer.write(scene, &target.path).map_err(|error| format!("{error}."))?;
    Ok(target.saved(&format::things(scene.polygons.len(), "polygon", "polygons")))
}

/// Where a thread writes, unless somebody gave up on it.
pub struct Target {
    path: PathBuf,
    cancel: CancelToken,
}

impl Target {
    fn saved(&self, what: &str) -> String {
        format!("Saved {} ({what}).", self.path.display())
    }

    fn write(&self, content: impl FnOnce(&mut BufWriter<File>) -> io::Result<()>) -> Result<(), String> {
        if self.cancel.is_cancelled() {
            return Err(String::new());
        }
        file::write(&self.path, content).map_err(|error| {
            let path = self.path.display();
            format!("{path}: cannot be written ({error}); choose a folder that you may write to.")
        })?;
        tracing::info!(file = %self.path.display(), "written");
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_follow_the_scene_until_a_person_chooses_one() {
        let mut exports = Exports::default();
        exports.suggest("my room", None);
        assert!(exports.name.ends_with("my_room"), "{}", exports.name);
        exports.suggest("hall", Some("my room"));
        assert!(exports.name.ends_with("hall"), "{}", exports.name);
        exports.name = "/tmp/mine".into();
        exports.suggest("my room", Some("hall"));
        assert_eq!(exports.path(Item::Links), Some(PathBuf::from("/tmp/mine.links.csv")));
        for name in ["", "  ", "/tmp/"] {
            exports.name = name.into();
            assert_eq!(exports.path(Item::Png), None, "{name}");
        }
    }
}
