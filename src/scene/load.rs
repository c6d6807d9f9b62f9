//! Loading.
/// Placeholder.
pub struct LoadError;
/// Placeholder.
pub struct Source;
/// Placeholder.
pub fn load() {}
/// Placeholder.
pub fn load_file() {}
