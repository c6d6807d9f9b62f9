//! Selflink: hierarchical radiosity with isotropic clusters, refined from the root's self-link.
#[cfg(feature = "gui")]
pub mod app;
pub mod cancel;
pub mod ceiling;
pub mod export;
pub mod format;
pub mod hierarchy;
pub mod orient;
pub mod probe;
#[cfg(feature = "gui")]
pub mod render;
pub mod scene;
pub mod solver;
pub mod visibility;
pub mod worker;
