//! Gathered pictures as the window and files show them.

use glam::Vec3;

use super::{Reading, reading};
use crate::read::picture::{FalseColours, GatheredPicture, LineLabel, Shading};

/// A finished picture, gamma-encoded, rows from above.
#[derive(Clone, Debug, PartialEq)]
pub struct Pixels {
    /// Width and height.
    pub size: [u32; 2],
    /// Red, green, blue and opacity.
    pub pixels: Vec<[u8; 4]>,
    /// Where the values of its lines can be written along them.
    pub labels: Vec<LineLabel>,
}

/// The picture with an exposure (m²/W) and what is read off the surfaces; `None` before its first
/// pass has ended.
pub fn developed(picture: &GatheredPicture, exposure: f32, reading: Option<&Reading>) -> Option<Pixels> {
    let encoded = |colour: [u8; 3]| Vec3::from(colour.map(|channel| f32::from(channel) / 255.0));
    let colour = reading.map(|reading| move |value: f32| encoded(reading.scale.colour(value)));
    let lines: Vec<(f32, Vec3)> = reading.map_or(Vec::new(), |reading| {
        reading.isolines.values().iter().map(|&value| (value, encoded(reading::line_colour(reading, value)))).collect()
    });
    let read = reading.zip(colour.as_ref()).map(|(reading, colour)| FalseColours {
        quantity: reading.quantity,
        colour: reading.fills.then_some(colour),
        lines: &lines,
    });
    let pixels = picture.develop(&Shading { exposure, read })?;
    let labels = reading.map_or(Vec::new(), |reading| picture.line_labels(reading.quantity, reading.isolines.values()));
    Some(Pixels { size: picture.size(), pixels, labels })
}
