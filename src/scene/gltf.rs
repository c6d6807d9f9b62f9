//! glTF
use std::path::Path;
use super::draft::Draft;
use super::load::LoadError;
pub(super) fn read(path: &Path, _bytes: &[u8]) -> Result<Draft, LoadError> {
    Err(LoadError::Missing { path: path.to_owned() })
}
