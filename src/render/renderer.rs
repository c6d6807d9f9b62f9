//! Draws snapshots with wgpu.

use super::{Camera, Display, Overlay, RenderError};
use crate::solver::snapshot::Snapshot;

/// What one picture shows.
#[derive(Clone, Copy)]
pub struct Frame<'a> {
    /// The solution; told from the one before by mesh, generation and serial, so that only what changed is uploaded.
    pub snapshot: &'a Snapshot,
    /// From where.
    pub camera: &'a Camera,
    /// How bright.
    pub display: &'a Display,
    /// With what drawn over it.
    pub overlay: &'a Overlay,
    /// Width and height, pixels.
    pub size: [u32; 2],
}

/// Samples per pixel that suit an adapter: 1 on software ones, where drawing takes the solver's cores, otherwise 4.
pub fn sample_count(_adapter: &wgpu::Adapter) -> u32 {
    1
}

/// Owns what the picture needs on the graphics device.
pub struct SceneRenderer {}

impl SceneRenderer {
    /// A renderer with so many samples per pixel ([`sample_count`]), which can blit into targets of one format.
    pub fn new(_device: wgpu::Device, _queue: wgpu::Queue, _samples: u32, _blit_format: wgpu::TextureFormat) -> Self {
        Self {}
    }

    /// Uploads what changed and records the drawing of one picture into the renderer's own texture.
    ///
    /// # Errors
    /// A size of zero or beyond the adapter's limits, or a mesh beyond them; the picture before stays.
    pub fn draw(&mut self, _encoder: &mut wgpu::CommandEncoder, _frame: &Frame<'_>) -> Result<(), RenderError> {
        Ok(())
    }

    /// Fills the viewport of a pass with the last picture; nothing before the first one.
    pub fn blit(&self, _pass: &mut wgpu::RenderPass<'_>) {}

    /// The last picture, `Rgba8Unorm`, gamma-encoded.
    pub fn picture(&self) -> Option<&wgpu::Texture> {
        None
    }
}
