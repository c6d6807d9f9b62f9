//! The wgpu view of a snapshot: mesh, overlays, camera, picking and pictures without a window.
//!
//! Physics stays out: a [`Snapshot`] brings linear radiosities in W/m², and only here are they
//! exposed, bent by the tone curve and gamma-encoded ([`Display`]). The module knows nothing of
//! windows or panels.
//!
//! A picture that was gathered at its pixels ([`crate::read::picture`]) is drawn in place of the
//! mesh, which then only hides lines.
//!
//! The window and a picture on disk go the same way: [`SceneRenderer::draw`] renders into its own
//! multisampled target and resolves it to one `Rgba8Unorm` texture, which a window blits into its
//! pass and [`Offscreen`] reads back.

mod buffer;
mod camera;
mod clusters;
mod display;
mod gathered;
mod legend;
mod links;
mod meter;
mod offscreen;
mod outline;
mod overlay;
mod own_colours;
mod pick;
mod pipelines;
mod radiosities;
mod reading;
mod reading_settings;
mod renderer;
mod target;
mod underlay;

pub use camera::Camera;
pub use clusters::{ApartMesh, ClusterParts, ClusterView, by_clusters, cluster_colours};
pub use display::Display;
pub use gathered::{Pixels, developed};
pub use legend::annotate;
pub use links::{ChosenLinks, LinkColour, LinkFilter, LinkStyle, Seen, USUAL_LINKS, level_colour};
pub use meter::{LightMeter, Metered};
pub use offscreen::Offscreen;
pub use outline::{box_edges, element_outline};
pub use overlay::{Line, Marks, Overlay, picked_leaf, picked_marks, picked_rim, power_colour};
pub use own_colours::in_own_colours;
pub use pick::{Picked, pick};
pub use reading::{ColourScale, Isolines, MOST_ISOLINES, Reading, Spacing, upper_end};
pub use reading_settings::{IsolinesWanted, Mark, ReadingSettings, Show};
pub use renderer::{Frame, SceneRenderer, sample_count};

pub use crate::read::ramp::{BLUE_WHITE_RED, CIVIDIS, Ramp, VIRIDIS, along_ramp};
pub use crate::read::tone::{Exposure, auto_exposure, encode_gamma, tone_curve};

#[cfg(doc)]
use crate::solve::snapshot::Snapshot;

/// Widest and highest picture that can be asked for, pixels.
pub const MAX_SIZE: u32 = 16_384;

/// Why something cannot be drawn.
#[derive(Debug, thiserror::Error)]
pub enum RenderError {
    /// No Vulkan, Metal, DirectX or GL adapter answers.
    #[error(
        "no graphics adapter was found: install a graphics driver, or software rendering (Debian and Ubuntu: apt install mesa-vulkan-drivers); `selflink solve` needs none"
    )]
    NoAdapter,
    /// The adapter gives no device.
    #[error("the graphics adapter {adapter} gives no device: {reason}")]
    NoDevice {
        /// The adapter's name.
        adapter: String,
        /// The driver's message.
        reason: String,
    },
    /// A picture of no or too many pixels.
    #[error("a picture of {width}×{height} pixels cannot be drawn: choose 1 to {limit} pixels each way")]
    Size {
        /// Width asked for, pixels.
        width: u32,
        /// Height asked for, pixels.
        height: u32,
        /// The most that can be drawn, pixels.
        limit: u32,
    },
    /// A mesh that the adapter cannot hold, or a picture that it cannot hand back.
    #[error(
        "{what} a graphics buffer of {needed_mib} MiB, but the adapter takes at most {limit_mib} MiB: choose {remedy}"
    )]
    TooLarge {
        /// What needs the buffer, in words.
        what: String,
        /// Size needed, MiB.
        needed_mib: u64,
        /// The adapter's limit, MiB.
        limit_mib: u64,
        /// What to choose instead.
        remedy: &'static str,
    },
    /// The graphics device gave up on a picture, for want of memory for one.
    #[error("the graphics adapter could not draw the picture, a smaller one may succeed: {reason}")]
    Device {
        /// The driver's message.
        reason: String,
    },
}
