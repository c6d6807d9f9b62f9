//! The wgpu view.
