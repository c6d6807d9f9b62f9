//! Sidecar.
/// Placeholder.
pub struct Sidecar;
/// Placeholder.
pub struct SidecarMaterial;
