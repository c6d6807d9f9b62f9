//! Where results go: stdout, and files that are known to be writable before any work is done.

use std::fs::{self, File, OpenOptions};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use anyhow::{Context, anyhow, bail};
use image::{ImageBuffer, ImageFormat, Pixel, PixelWithColorType};
use selflink::base::file;

/// Writes to stdout. Whoever reads it may have gone away, which is no fault.
pub fn say(text: &str) -> anyhow::Result<()> {
    let mut stdout = io::stdout().lock();
    match stdout.write_all(text.as_bytes()).and_then(|()| stdout.flush()) {
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => Err(anyhow!("stdout cannot be written ({error})")),
        _ => Ok(()),
    }
}

/// Makes a folder where it is missing.
pub fn make_folder(folder: &Path) -> anyhow::Result<()> {
    fs::create_dir_all(folder)
        .map_err(|error| anyhow!("{}: cannot be made ({error}); choose another folder", folder.display()))
}

/// A file to be written when the work is done.
pub struct OutputFile(PathBuf);

impl OutputFile {
    /// Makes sure that the file can be written, and that it is none of the files read; a file that
    /// is there keeps its content until then.
    pub fn new(path: &Path, inputs: &[&Path]) -> anyhow::Result<Self> {
        let same = |input: &&&Path| matches!((input.canonicalize(), path.canonicalize()), (Ok(a), Ok(b)) if a == b);
        if let Some(input) = inputs.iter().find(same) {
            bail!("{} would overwrite what is read from {}; choose another file", path.display(), input.display());
        }
        let is_new = !path.exists();
        OpenOptions::new().append(true).create(true).open(path).map_err(|error| unwritable(path, &error))?;
        if is_new {
            fs::remove_file(path).map_err(|error| unwritable(path, &error))?;
        }
        Ok(Self(path.to_owned()))
    }

    /// Path of the file.
    pub fn path(&self) -> &Path {
        &self.0
    }

    /// Writes the content.
    pub fn write(&self, content: impl FnOnce(&mut BufWriter<File>) -> io::Result<()>) -> anyhow::Result<()> {
        file::write(&self.0, content).map_err(|error| unwritable(&self.0, &error))?;
        tracing::info!(file = %self.0.display(), "written");
        Ok(())
    }

    /// Writes a text.
    pub fn write_text(&self, text: &str) -> anyhow::Result<()> {
        self.write(|writer| writer.write_all(text.as_bytes()))
    }

    /// Writes a picture as PNG.
    pub fn write_png<P>(&self, picture: &ImageBuffer<P, Vec<u8>>) -> anyhow::Result<()>
    where
        P: Pixel<Subpixel = u8> + PixelWithColorType,
    {
        self.write(|writer| picture.write_to(writer, ImageFormat::Png).map_err(io::Error::other))
    }
}

fn unwritable(path: &Path, error: &io::Error) -> anyhow::Error {
    anyhow!("{}: cannot be written ({error}); choose a file in a folder that you may write to", path.display())
}

/// Writes JSON with a line for each key.
pub fn json(value: &impl serde::Serialize) -> anyhow::Result<String> {
    Ok(serde_json::to_string_pretty(value).context("the statistics cannot be written as JSON")? + "\n")
}
