//! How a picture shows radiosities; exposure and tone curve are those of [`crate::read::tone`].

use super::reading::Reading;

/// How radiosities become colours.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Display {
    /// The factor on radiosities, m²/W.
    pub exposure: f32,
    /// The vertices carry gamma-encoded colours, 0..=1, instead of radiosities: they are shown as
    /// they are.
    pub as_colours: bool,
    /// Reading of the surfaces, as false colours or lines of equal value; none where vertices carry
    /// colours.
    pub reading: Option<Reading>,
}

impl Default for Display {
    fn default() -> Self {
        Self { exposure: 1.0, as_colours: false, reading: None }
    }
}
