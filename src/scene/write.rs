//! Writing.
/// Placeholder.
pub struct WriteError;
/// Placeholder.
pub fn write_obj() {}
