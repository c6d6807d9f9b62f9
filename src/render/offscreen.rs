//! Pictures without a window.

use super::{Camera, Display, Overlay, RenderError};
use crate::solver::snapshot::Snapshot;

/// A graphics device of its own and a renderer on it.
pub struct Offscreen {}

impl Offscreen {
    /// Takes the first adapter that answers, software ones included.
    ///
    /// # Errors
    /// No adapter, or one that gives no device.
    pub fn new() -> Result<Self, RenderError> {
        Err(RenderError::NoAdapter)
    }

    /// Draws one picture.
    ///
    /// # Errors
    /// A size of zero or beyond the adapter's limits, a mesh beyond them, or a failed read-back.
    pub fn picture(
        &mut self,
        _snapshot: &Snapshot,
        _camera: &Camera,
        _display: &Display,
        _overlay: &Overlay,
        _size: [u32; 2],
    ) -> Result<image::RgbaImage, RenderError> {
        Err(RenderError::NoAdapter)
    }
}
