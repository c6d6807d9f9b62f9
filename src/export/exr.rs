//! A view in physical units as OpenEXR: 32-bit floats, neither exposed nor bent.
//!
//! One part of scan lines, compressed without loss.

use std::io::{self, Write};

use exr::prelude::{AnyChannel, AnyChannels, Encoding, FlatSamples, Image, Layer, LayerAttributes, WritableImage};

use crate::read::picture::{Layers, LayersAt};

/// A picture of floats, rows from above.
#[derive(Clone, Debug, PartialEq)]
pub struct FloatPicture {
    /// Width and height, pixels.
    pub size: [u32; 2],
    /// Radiosity B per colour, W/m², and the share of the pixel that a surface covers; where that
    /// is 0 nothing is to be seen.
    pub pixels: Vec<[f32; 4]>,
}

/// Comment of the file: unit and meaning of its numbers.
const COMMENT: &str = "Selflink: R, G, B are the radiosity B in W/m2, linear, unexposed; the radiance of these diffuse surfaces is B/pi. \
     A is the share of the pixel that surfaces cover.";

/// Comment of a gathered picture's file: unit and meaning of its numbers.
const LAYERS_COMMENT: &str = "Selflink: R, G, B are the radiosity B in W/m2, linear, unexposed; the radiance of these diffuse surfaces is B/pi. \
     irradiance is E in W/m2, normal the mean unit normal, albedo the reflectance; all are multiplied by A, the share of the pixel that \
     surfaces cover. Z is the distance along the line of sight to the nearest surface, element.id the leaf there, 4294967295 for none.";

/// Writes a picture; R, G and B are radiosities in W/m², multiplied by the coverage A as the format
/// asks.
///
/// # Errors
/// Whatever the writer says.
pub fn write(writer: &mut impl Write, picture: &FloatPicture) -> io::Result<()> {
    let channels = [("R", 0), ("G", 1), ("B", 2), ("A", 3)].map(|(name, colour)| {
        AnyChannel::new(name, FlatSamples::F32(picture.pixels.iter().map(|pixel| pixel[colour]).collect()))
    });
    write_channels(writer, picture.size, channels.into_iter().collect(), COMMENT)
}

/// Writes a gathered picture: R, G, B, A as [`write()`] does, and layers of E, normal, albedo,
/// depth and element.
///
/// # Errors
/// Whatever the writer says.
pub fn write_layers(writer: &mut impl Write, layers: &Layers) -> io::Result<()> {
    let channel = |name: &str, value: &dyn Fn(&LayersAt) -> f32| {
        AnyChannel::new(name, FlatSamples::F32(layers.pixels.iter().map(value).collect()))
    };
    let mut channels = vec![
        channel("A", &|pixel| pixel.coverage),
        channel("Z", &|pixel| pixel.depth),
        AnyChannel::new(
            "element.id",
            FlatSamples::U32(layers.pixels.iter().map(|pixel| pixel.element.map_or(u32::MAX, |id| id.0)).collect()),
        ),
    ];
    type Of = fn(&LayersAt) -> glam::Vec3;
    let triples: [(&str, [&str; 3], Of); 4] = [
        ("", ["R", "G", "B"], |pixel| pixel.radiosity),
        ("irradiance.", ["R", "G", "B"], |pixel| pixel.irradiance),
        ("normal.", ["X", "Y", "Z"], |pixel| pixel.normal),
        ("albedo.", ["R", "G", "B"], |pixel| pixel.albedo),
    ];
    for (layer, names, of) in triples {
        for (axis, name) in names.into_iter().enumerate() {
            channels.push(channel(&format!("{layer}{name}"), &|pixel| of(pixel)[axis]));
        }
    }
    write_channels(writer, layers.size, channels, LAYERS_COMMENT)
}

fn write_channels(
    writer: &mut impl Write,
    size: [u32; 2],
    channels: Vec<AnyChannel<FlatSamples>>,
    comment: &str,
) -> io::Result<()> {
    let [width, height] = size.map(|side| side as usize);
    let attributes = LayerAttributes { comments: Some(comment.into()), ..LayerAttributes::default() };
    let channels = AnyChannels::sort(channels.into());
    let layer = Layer::new((width, height), attributes, Encoding::FAST_LOSSLESS, channels);
    // The crate goes back to where the header is.
    let mut file = io::Cursor::new(Vec::new());
    Image::from_layer(layer).write().to_buffered(&mut file).map_err(io::Error::other)?;
    writer.write_all(file.get_ref())
}

#[cfg(test)]
mod tests {
    use exr::prelude::{ReadChannels, ReadLayers, read};

    use super::*;

    /// Truth: another program's reader gives back every bit.
    #[test]
    fn another_reader_gets_the_same_bits() {
        let value = |index: u32| [1e-6 * index as f32, 1e5 + index as f32, 0.1 * index as f32, 1.0];
        let picture = FloatPicture { size: [7, 3], pixels: (0..21).map(value).collect() };
        let mut file = Vec::new();
        write(&mut file, &picture).expect("a Vec takes any bytes");
        let read = read()
            .no_deep_data()
            .largest_resolution_level()
            .rgba_channels(
                |size, _| vec![[0.0_f32; 4]; size.area()],
                |pixels, at, (r, g, b, a): (f32, f32, f32, f32)| pixels[at.y() * 7 + at.x()] = [r, g, b, a],
            )
            .first_valid_layer()
            .all_attributes()
            .from_buffered(std::io::Cursor::new(&file))
            .expect("a valid file");
        let layer = read.layer_data;
        assert_eq!((layer.size.0, layer.size.1), (7, 3));
        assert_eq!(layer.channel_data.pixels, picture.pixels);
        let comment = layer.attributes.comments.expect("a comment").to_string();
        assert!(comment.contains("W/m2"), "{comment}");
    }
}
