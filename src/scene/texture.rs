//! Mean colours of textures, decoded within bounds of memory and time.

use std::borrow::Cow;
use std::io::Cursor;

use glam::{Vec3, Vec4};
use image::{DynamicImage, ImageReader};
use rayon::prelude::*;

/// The most pixels of one texture: 16384 × 8192.
const MOST_PIXELS: u64 = 1 << 27;

/// The most pixels of all textures of a scene: a thousand of 2048 × 2048, which take half a minute or so.
const MOST_PIXELS_OF_ALL: u64 = 1 << 32;

/// The most bytes of all textures of a scene as they are encoded.
const MOST_BYTES_OF_ALL: u64 = 8 << 30;

/// Textures are decoded side by side until they have so many pixels together.
const PIXELS_AT_ONCE: u64 = MOST_PIXELS;

/// Textures wait to be decoded until they have so many bytes together.
const BYTES_AT_ONCE: usize = 256 << 20;

/// Mean linear colour and mean alpha of each of some encoded images; colours count by their alpha.
///
/// Each is read in turn and decoded with others in parallel. Once they have more pixels or bytes together than any scene needs, the rest is left out: which
/// ones does not depend on threads.
pub(super) fn mean_colours<'a, K>(
    keys: &[K],
    read: impl Fn(&K) -> Result<Cow<'a, [u8]>, String>,
) -> Vec<Result<Vec4, String>> {
    means_within(MOST_PIXELS_OF_ALL, MOST_BYTES_OF_ALL, keys, read)
}

fn means_within<'a, K>(
    mut pixels_left: u64,
    mut bytes_left: u64,
    keys: &[K],
    read: impl Fn(&K) -> Result<Cow<'a, [u8]>, String>,
) -> Vec<Result<Vec4, String>> {
    let mut means = Vec::with_capacity(keys.len());
    let mut waiting: Vec<Result<Cow<'a, [u8]>, String>> = Vec::new();
    let (mut pixels_waiting, mut bytes_waiting) = (0, 0);
    for key in keys {
        let encoded = if pixels_left == 0 || bytes_left == 0 {
            Err("the textures before it are as much as can be read".to_owned())
        } else {
            read(key)
        };
        let sized = encoded.and_then(|encoded| {
            bytes_left = bytes_left.saturating_sub(encoded.len() as u64);
            pixels_of(&encoded).map(|pixels| (encoded, pixels))
        });
        let (pixels, bytes) = sized.as_ref().map_or((0, 0), |(encoded, pixels)| (*pixels, encoded.len()));
        pixels_left = pixels_left.saturating_sub(pixels);
        if pixels_waiting + pixels > PIXELS_AT_ONCE || bytes_waiting + bytes > BYTES_AT_ONCE {
            means.par_extend(waiting.par_drain(..).map(decoded));
            (pixels_waiting, bytes_waiting) = (0, 0);
        }
        (pixels_waiting, bytes_waiting) = (pixels_waiting + pixels, bytes_waiting + bytes);
        waiting.push(sized.map(|(encoded, _)| encoded));
    }
    means.par_extend(waiting.into_par_iter().map(decoded));
    means
}

fn decoded(encoded: Result<Cow<'_, [u8]>, String>) -> Result<Vec4, String> {
    image::load_from_memory(&encoded?).map(|image| mean_of(&image)).map_err(|error| error.to_string())
}

/// The number of pixels that an image's header tells.
fn pixels_of(encoded: &[u8]) -> Result<u64, String> {
    let reader = ImageReader::new(Cursor::new(encoded)).with_guessed_format().map_err(|error| error.to_string())?;
    let (width, height) = reader.into_dimensions().map_err(|error| error.to_string())?;
    let pixels = u64::from(width) * u64::from(height);
    if pixels == 0 || pixels > MOST_PIXELS {
        return Err(format!(
            "its size of {width} × {height} pixels is not between 1 and {} megapixels",
            MOST_PIXELS >> 20
        ));
    }
    Ok(pixels)
}

fn mean_of(image: &DynamicImage) -> Vec4 {
    let linear: [f64; 256] = std::array::from_fn(|value| linear_from_srgb(value as f64 / 255.0));
    let pixels = image.to_rgba8();
    let mut weighted = [0.0; 3];
    let mut plain = [0.0; 3];
    let mut alpha_sum = 0.0;
    for pixel in pixels.pixels() {
        let alpha = f64::from(pixel.0[3]) / 255.0;
        alpha_sum += alpha;
        for colour in 0..3 {
            let value = linear[usize::from(pixel.0[colour])];
            weighted[colour] += alpha * value;
            plain[colour] += value;
        }
    }
    let count = f64::from(pixels.width()) * f64::from(pixels.height());
    let mean = if alpha_sum > 0.0 { weighted.map(|sum| sum / alpha_sum) } else { plain.map(|sum| sum / count) };
    Vec3::from_array(mean.map(|value| value as f32)).extend((alpha_sum / count) as f32)
}

/// The transfer function of IEC 61966-2-1.
fn linear_from_srgb(value: f64) -> f64 {
    if value <= 0.04045 { value / 12.92 } else { ((value + 0.055) / 1.055).powf(2.4) }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Truth: counted by hand; each picture has two pixels.
    #[test]
    fn textures_beyond_the_limits_are_left_out() {
        let mut encoded = Vec::new();
        let image = image::RgbImage::from_pixel(2, 1, image::Rgb([255; 3]));
        image.write_to(&mut Cursor::new(&mut encoded), image::ImageFormat::Png).expect("it can be encoded");
        let read = |key: &u32| if *key == 1 { Err("gone".to_owned()) } else { Ok(Cow::Borrowed(&encoded[..])) };
        let used = |pixels: u64, bytes: usize| -> Vec<bool> {
            means_within(pixels, bytes as u64, &[0, 1, 2, 3], read).iter().map(Result::is_ok).collect()
        };
        assert_eq!(used(100, 10_000), [true, false, true, true]);
        assert_eq!(used(4, 10_000), [true, false, true, false]);
        assert_eq!(used(100, encoded.len()), [true, false, false, false]);
        let mut header = encoded.clone();
        header[16..24].copy_from_slice(&[0, 0, 0xea, 0x60, 0, 0, 0xea, 0x60]);
        assert!(pixels_of(&header).is_err(), "60,000 × 60,000 pixels, whatever its checksum");
    }

    /// Truth: half white and half black is linear 0.5 (sRGB 188, not 128), and a clear pixel does not count.
    #[test]
    fn means_are_linear_and_weighted_by_alpha() {
        let mut image = image::RgbaImage::new(4, 1);
        for (x, pixel) in [[255, 255, 255, 255], [0, 0, 0, 255], [9, 99, 200, 0], [70, 1, 2, 0]].iter().enumerate() {
            image.put_pixel(x as u32, 0, image::Rgba(*pixel));
        }
        let mean = mean_of(&DynamicImage::ImageRgba8(image));
        assert!((mean - Vec4::splat(0.5)).abs().max_element() < 1e-6, "{mean}");
    }
}
