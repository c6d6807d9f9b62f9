//! Files that are written at once.

use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::Path;

/// Makes a file, or empties the one that is there, and writes it.
///
/// # Errors
/// It cannot be made, or whatever `content` says.
pub fn write(path: &Path, content: impl FnOnce(&mut BufWriter<File>) -> io::Result<()>) -> io::Result<()> {
    let mut writer = BufWriter::new(File::create(path)?);
    content(&mut writer)?;
    writer.flush()
}
