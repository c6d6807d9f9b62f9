//! How a picture shows radiosities; exposure and tone curve are those of [`crate::read::tone`].

use super::reading::Reading;
use crate::read::tone::Exposure;

/// How radiosities become colours.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Display {
    /// How bright the picture is made.
    pub exposure: Exposure,
    /// The vertices carry gamma-encoded colours, 0..=1, instead of radiosities: they are shown as
    /// they are.
    pub as_colours: bool,
    /// Reading of the surfaces, as false colours or lines of equal value; none where vertices carry
    /// colours.
    pub reading: Option<Reading>,
}
