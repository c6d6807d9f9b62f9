//! Loading: a scene comes from an OBJ, glTF, GLB, PLY or STL file with its sidecar, by extension
//! and content.

use std::path::{Path, PathBuf};

use super::assemble::assemble;
use super::builtin::BuiltinScene;
use super::draft::Draft;
use super::files::{FileError, MOST_BYTES, MOST_TEXT_BYTES, SceneFiles, SceneFolder, read_plain_file};
use super::load_error::{Fault, LoadError};
use super::outside::DaylightError;
use super::sidecar::{Sidecar, SidecarFault, of_sidecar};
use super::{Reading, Scene, gltf, obj, ply, sanitize, stl};

/// So many objects of the sidecar that are not there are named, the rest is counted.
const MOST_REMARKS: usize = 5;

/// Where a scene comes from.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Source {
    /// A file: OBJ, glTF, GLB, PLY or STL.
    File(PathBuf),
    /// One of our own scenes, drawn by code.
    Builtin(BuiltinScene),
}

/// Loads a scene from wherever it comes, a file read as a person says; one of our own scenes is as
/// it is.
///
/// # Errors
/// As [`load_file`].
pub fn load_with(source: &Source, reading: &Reading) -> Result<Scene, LoadError> {
    match source {
        Source::File(path) => load_file_with(path, reading),
        Source::Builtin(scene) => {
            let mut scene = scene.build();
            scene.leave_out(&reading.ignored);
            Ok(scene)
        }
    }
}

/// Loads a scene file with its sidecar; what was skipped, clamped or ignored stands in
/// [`Scene::skipped`].
///
/// Nothing is read but plain files of the scene's own folder.
///
/// # Errors
/// One sentence with the file, the place in it and what to do.
pub fn load_file(path: &Path) -> Result<Scene, LoadError> {
    load_file_with(path, &Reading::default())
}

fn load_file_with(path: &Path, reading: &Reading) -> Result<Scene, LoadError> {
    let bytes = read_plain_file(path, MOST_BYTES).map_err(|error| match error {
        FileError::Missing => of_file(path)(Fault::Missing),
        FileError::TooLong { most } => of_file(path)(Fault::TooLong(most >> 20)),
        error => of_file(path)(Fault::Unreadable(error)),
    })?;
    load_bytes_with(path, bytes, &SceneFolder::of(path), reading)
}

/// Loads a scene from the content of its file; `path` names it and is not read, what it refers to
/// comes from `files`.
///
/// # Errors
/// As [`load_file`].
pub fn load_bytes(path: &Path, bytes: Vec<u8>, files: &dyn SceneFiles) -> Result<Scene, LoadError> {
    load_bytes_with(path, bytes, files, &Reading::default())
}

/// Says of which file a fault is.
fn of_file(path: &Path) -> impl Fn(Fault) -> LoadError {
    |fault| LoadError::File { path: path.to_owned(), fault }
}

fn load_bytes_with(path: &Path, bytes: Vec<u8>, files: &dyn SceneFiles, reading: &Reading) -> Result<Scene, LoadError> {
    let name = path.file_stem().map_or("scene".into(), |stem| stem.to_string_lossy());
    let draft = read(path, &name, &bytes, files).map_err(of_file(path))?;
    drop(bytes);
    let sidecar_path = Sidecar::path_for(path);
    let sidecar = match files.read(Path::new(sidecar_path.file_name().unwrap_or_default()), MOST_TEXT_BYTES) {
        Ok(bytes) => Sidecar::from_bytes(&sidecar_path, &bytes)?,
        Err(FileError::Missing) => Sidecar::default(),
        Err(error) => return Err(of_sidecar(&sidecar_path)(SidecarFault::Unreadable(error)).into()),
    };
    let mut scene = assemble(&name, draft, &sidecar, reading);
    if scene.polygons.is_empty() {
        let mut said = scene.skipped.sentences();
        said.truncate(4);
        let why = if said.is_empty() { String::new() } else { format!(" ({})", said.join(" ")) };
        return Err(of_file(path)(Fault::NoPolygons(why)));
    }
    let unusable = |problem: String| of_sidecar(&sidecar_path)(SidecarFault::Value(problem));
    if let Some(problem) = sidecar.problem_in(&scene) {
        return Err(unusable(problem).into());
    }
    sidecar.add_lights_to(&mut scene).map_err(|error| unusable(error.to_string()))?;
    scene.keep_filed(&sidecar.bookmarks, sidecar.task_area.as_ref());
    let read = |name: &Path| {
        let outside = || format!("{}; it must lie in the scene's folder", FileError::Missing);
        if name.is_absolute() {
            Err(outside())
        } else {
            files.read(name, MOST_BYTES).map_err(|error| error.to_string())
        }
    };
    match scene.add_daylight_from(&sidecar.daylight(), read) {
        // As with a texture, the rest is worth seeing.
        Err(error @ DaylightError::Picture { .. }) => scene.skipped.note(format!("Without a sky: {error}.")),
        Err(error) => return Err(unusable(error.to_string()).into()),
        Ok(()) => {}
    }
    let remarks = scene.regroup(sidecar.groups);
    let more = remarks.len().saturating_sub(MOST_REMARKS);
    for remark in remarks.iter().take(MOST_REMARKS) {
        scene.skipped.note(remark);
    }
    if more > 0 {
        scene.skipped.note(format!("{more} more objects of the settings file's groups could not be placed either."));
    }
    Ok(scene)
}

/// Reads the content of a file by its format.
fn read(path: &Path, name: &str, bytes: &[u8], files: &dyn SceneFiles) -> Result<Draft, Fault> {
    if bytes.iter().all(u8::is_ascii_whitespace) {
        return Err(Fault::Empty);
    }
    match format_of(path, bytes)? {
        Format::Obj => obj::read(name, bytes, files),
        Format::Gltf => gltf::read(name, bytes, files),
        Format::Ply => ply::read(name, bytes),
        Format::Stl => stl::read(name, bytes),
    }
}

#[derive(Debug, PartialEq)]
enum Format {
    Obj,
    Gltf,
    Ply,
    Stl,
}

/// Decides by content where that is clear, else by extension.
fn format_of(path: &Path, bytes: &[u8]) -> Result<Format, Fault> {
    // What a binary STL begins with may be anything.
    if stl::is_binary(bytes) {
        return Ok(Format::Stl);
    }
    let not_a_scene = |what: String| Err(Fault::NotAScene(what));
    if let Ok(image) = image::guess_format(bytes)
        && !bytes.starts_with(b"P")
    {
        let extension = image.extensions_str().first().copied().unwrap_or_default();
        return not_a_scene(format!("an image ({})", extension.to_uppercase()));
    }
    let known: [(&[u8], &str); 7] = [
        (b"%PDF", "a PDF document"),
        (b"PK\x03\x04", "a ZIP archive (unpack it first)"),
        (b"\x1f\x8b", "a compressed file (unpack it first)"),
        (b"BLENDER", "a Blender file (export it as glTF)"),
        (b"\x28\xb5\x2f\xfd", "a compressed file (unpack it first)"),
        (b"Kaydara FBX", "an FBX file (convert it to glTF)"),
        (b"\x7fELF", "a program"),
    ];
    if let Some((_, what)) = known.iter().find(|(magic, _)| bytes.starts_with(magic)) {
        return not_a_scene((*what).to_owned());
    }
    let extension = path.extension().unwrap_or_default().to_string_lossy().to_lowercase();
    if bytes.starts_with(b"glTF") {
        return Ok(Format::Gltf);
    }
    if ply::is_ply(bytes) {
        return Ok(Format::Ply);
    }
    if extension == "stl" || stl::is_text(bytes) {
        return Ok(Format::Stl);
    }
    if bytes.iter().take(8192).any(|&byte| byte == 0) {
        return not_a_scene("a binary file of an unknown kind".to_owned());
    }
    match extension.as_str() {
        "obj" => Ok(Format::Obj),
        "gltf" => Ok(Format::Gltf),
        "glb" => not_a_scene("a file without the header of a GLB file".to_owned()),
        "ply" => not_a_scene("a file without the header of a PLY file".to_owned()),
        _ if bytes.trim_ascii_start().starts_with(b"{") => Ok(Format::Gltf),
        _ if bytes.split(|&byte| byte == b'\n').any(|line| line.trim_ascii_start().starts_with(b"v ")) => {
            Ok(Format::Obj)
        }
        "" => not_a_scene("a file without a known extension".to_owned()),
        other => not_a_scene(format!("a {} file", sanitize::name(&format!(".{other}")))),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn content_decides_before_the_extension() {
        let of = |name: &str, bytes: &[u8]| format_of(Path::new(name), bytes).ok();
        assert_eq!(of("a.obj", b"v 0 0 0\n"), Some(Format::Obj));
        assert_eq!(of("a.obj", b"glTF\x02\0\0\0"), Some(Format::Gltf));
        assert_eq!(of("a.txt", b"# by hand\n v 0 0 0\n"), Some(Format::Obj));
        assert_eq!(of("a", b" {\"asset\": {}}"), Some(Format::Gltf));
        assert_eq!(of("a.obj", b"\x89PNG\r\n\x1a\n"), None);
        assert_eq!(of("a.txt", b"hello"), None);
        assert_eq!(of("a.obj", b"ply\nformat ascii 1.0\n"), Some(Format::Ply));
        assert_eq!(of("a", b"solid\nfacet normal 0 0 1\n"), Some(Format::Stl));
        assert_eq!(of("a.ply", b"v 0 0 0\n"), None);
    }
}
