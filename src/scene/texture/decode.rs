//! Textures decoded within bounds of memory and time.

use std::borrow::Cow;
use std::io::Cursor;
use std::sync::Arc;

use image::{ImageFormat, ImageReader, Limits};
use rayon::prelude::*;

use super::{Texture, basis};

/// The most pixels of one texture: 16384 × 8192.
const MOST_PIXELS: u64 = 1 << 27;

/// So many pixels, 4096 × 4096, may be of one colour and so in a file of any length.
const PIXELS_OF_ONE_COLOUR: u64 = 1 << 24;

/// The most pixels that a byte holds beyond that: twice what PNG can of two colours. A file of a
/// few bytes would else take seconds.
const PIXELS_PER_BYTE: u64 = 1 << 14;

/// The longest side, pixels: sums along a row must fit.
const LONGEST_SIDE: u32 = 1 << 16;

/// The most pixels of all textures of a scene: a thousand of 2048 × 2048, which take half a minute
/// or so.
const MOST_PIXELS_OF_ALL: u64 = 1 << 32;

/// The most bytes of all textures of a scene as they are encoded.
const MOST_BYTES_OF_ALL: u64 = 8 << 30;

/// Textures are decoded side by side until they have so many pixels together.
const PIXELS_AT_ONCE: u64 = MOST_PIXELS;

/// Textures wait to be decoded until they have so many bytes together.
const BYTES_AT_ONCE: usize = 256 << 20;

/// The most pixels that are kept of all textures of a scene: half a gigabyte.
const MOST_PIXELS_KEPT: u64 = 1 << 27;

/// A texture may be halved to this many pixels where there are so many that all of them together
/// would not fit.
const LEAST_PIXELS_KEPT: u64 = 1 << 14;

/// The most memory that a decoder may take.
const MOST_MEMORY: u64 = 1 << 30;

/// An encoded picture and the end of its name, where it has one: not every format begins with a
/// mark.
pub(in super::super) struct Encoded<'a> {
    /// The file's content.
    pub bytes: Cow<'a, [u8]>,
    /// The extension, or the last part of a media type.
    pub extension: String,
}

/// Each of some encoded pictures, decoded.
///
/// Each is read in turn and decoded with others in parallel. Once they have more pixels or bytes
/// together than any scene needs, the rest is left out; which ones does not depend on threads.
/// Large ones are halved where all of them together take too much memory.
pub(in super::super) fn decode_all<'a, K>(
    keys: &[K],
    read: impl Fn(&K) -> Result<Encoded<'a>, String>,
) -> Vec<Result<Arc<Texture>, String>> {
    decode_within([MOST_PIXELS_OF_ALL, MOST_BYTES_OF_ALL, MOST_PIXELS_KEPT], keys, read)
}

/// How a picture is encoded.
#[derive(Debug, Clone, Copy)]
enum Format {
    Image(ImageFormat),
    /// Basis Universal in a KTX2 file.
    Basis,
}

/// A picture that waits to be decoded, and how many pixels of it are kept.
type Waiting<'a> = Result<(Encoded<'a>, Format, u64), String>;

fn decode_within<'a, K>(
    [mut pixels_left, mut bytes_left, mut kept_left]: [u64; 3],
    keys: &[K],
    read: impl Fn(&K) -> Result<Encoded<'a>, String>,
) -> Vec<Result<Arc<Texture>, String>> {
    let mut textures = Vec::with_capacity(keys.len());
    let mut waiting: Vec<Waiting<'a>> = Vec::new();
    let (mut pixels_waiting, mut bytes_waiting) = (0, 0);
    for key in keys {
        let encoded = if pixels_left == 0 || bytes_left == 0 {
            Err("the textures before it are as much as can be read".to_owned())
        } else {
            read(key)
        };
        let sized = encoded.and_then(|encoded| {
            bytes_left = bytes_left.saturating_sub(encoded.bytes.len() as u64);
            let format = format_of(&encoded)?;
            pixels_of(&encoded.bytes, format).map(|pixels| (encoded, format, pixels))
        });
        let (pixels, bytes) = sized.as_ref().map_or((0, 0), |(encoded, _, pixels)| (*pixels, encoded.bytes.len()));
        pixels_left = pixels_left.saturating_sub(pixels);
        if pixels_waiting + pixels > PIXELS_AT_ONCE || bytes_waiting + bytes > BYTES_AT_ONCE {
            textures.par_extend(waiting.par_drain(..).map(decoded));
            (pixels_waiting, bytes_waiting) = (0, 0);
        }
        (pixels_waiting, bytes_waiting) = (pixels_waiting + pixels, bytes_waiting + bytes);
        waiting.push(sized.map(|(encoded, format, pixels)| {
            let kept = (kept_left / 4).max(LEAST_PIXELS_KEPT).min(pixels);
            kept_left = kept_left.saturating_sub(kept);
            (encoded, format, kept)
        }));
    }
    textures.par_extend(waiting.into_par_iter().map(decoded));
    textures
}

/// The format by the first bytes, or else by the name.
fn format_of(encoded: &Encoded<'_>) -> Result<Format, String> {
    if encoded.bytes.starts_with(basis::MARK) {
        return Ok(Format::Basis);
    }
    let by_name = || ImageFormat::from_extension(&encoded.extension);
    let format = image::guess_format(&encoded.bytes).ok().or_else(by_name);
    let format = format.ok_or_else(|| "its format is not known; convert it to PNG, JPEG or WebP".to_owned())?;
    // The crate denies that it reads DDS (0.25.10), but does.
    if format.reading_enabled() || format == ImageFormat::Dds {
        return Ok(Format::Image(format));
    }
    let name = format.extensions_str().first().copied().unwrap_or_default().to_uppercase();
    Err(format!("{name} is not read; convert it to PNG, JPEG or WebP"))
}

/// A reader of a picture that takes no more memory than this.
pub(in crate::scene) fn reader(bytes: &[u8], format: ImageFormat, most_memory: u64) -> ImageReader<Cursor<&[u8]>> {
    let mut reader = ImageReader::with_format(Cursor::new(bytes), format);
    let mut limits = Limits::default();
    limits.max_alloc = Some(most_memory);
    reader.limits(limits);
    reader
}

fn decoded(waiting: Waiting<'_>) -> Result<Arc<Texture>, String> {
    let (encoded, format, kept) = waiting?;
    let pixels = match format {
        Format::Image(format) => {
            reader(&encoded.bytes, format, MOST_MEMORY).decode().map_err(|error| error.to_string())?.into_rgba8()
        }
        Format::Basis => basis::decode(&encoded.bytes)?,
    };
    let (width, height) = pixels.dimensions();
    if width == 0 || height == 0 {
        return Err("it has no pixels".to_owned());
    }
    let mut texture = Texture::new(width, height, pixels.as_chunks::<4>().0.to_vec());
    while texture.texels.len() as u64 > kept && texture.size() != [1, 1] {
        texture = texture.halved();
    }
    Ok(Arc::new(texture))
}

/// The number of pixels that an image's header tells.
fn pixels_of(bytes: &[u8], format: Format) -> Result<u64, String> {
    let (width, height) = match format {
        Format::Image(format) => {
            reader(bytes, format, MOST_MEMORY).into_dimensions().map_err(|error| error.to_string())?
        }
        Format::Basis => basis::size(bytes)?,
    };
    let pixels = u64::from(width) * u64::from(height);
    if pixels == 0 || pixels > MOST_PIXELS || width.max(height) > LONGEST_SIDE {
        return Err(format!(
            "its size of {width} × {height} pixels is not between 1 and {} megapixels",
            MOST_PIXELS >> 20
        ));
    }
    if pixels > PIXELS_OF_ONE_COLOUR.max(PIXELS_PER_BYTE * bytes.len() as u64) {
        let bytes = bytes.len();
        return Err(format!("it claims {width} × {height} pixels in {bytes} bytes; export it again"));
    }
    Ok(pixels)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn encoded(bytes: &[u8]) -> Encoded<'_> {
        Encoded { bytes: Cow::Borrowed(bytes), extension: String::new() }
    }

    fn png(width: u32, height: u32) -> Vec<u8> {
        let mut encoded = Vec::new();
        let image = image::RgbImage::from_pixel(width, height, image::Rgb([255; 3]));
        image.write_to(&mut Cursor::new(&mut encoded), ImageFormat::Png).expect("it can be encoded");
        encoded
    }

    /// Truth: a GIF of 35 bytes tells of a canvas of 120 megapixels; as many of 4096 × 4096 may be
    /// of one colour.
    #[test]
    fn a_few_bytes_hold_no_large_picture() {
        let gif = |width: u16, height: u16| {
            let [[a, b], [c, d]] = [width, height].map(u16::to_le_bytes);
            let mut bytes = b"GIF89a".to_vec();
            bytes.extend([
                a, b, c, d, 0x80, 0, 0, 0, 0, 0, 255, 255, 255, 0x2c, 0, 0, 0, 0, 1, 0, 1, 0, 0, 2, 2, 0x44, 1, 0, 0x3b,
            ]);
            bytes
        };
        assert_eq!(pixels_of(&gif(4096, 4096), Format::Image(ImageFormat::Gif)), Ok(1 << 24));
        let said = pixels_of(&gif(15_000, 8000), Format::Image(ImageFormat::Gif)).expect_err("too many");
        assert!(said.contains("claims 15000 × 8000 pixels"), "{said}");
    }

    /// Truth: counted by hand; each picture has two pixels.
    #[test]
    fn textures_beyond_the_limits_are_left_out() {
        let picture = png(2, 1);
        let read = |key: &u32| if *key == 1 { Err("gone".to_owned()) } else { Ok(encoded(&picture)) };
        let used = |pixels: u64, bytes: usize| -> Vec<bool> {
            decode_within([pixels, bytes as u64, 100], &[0, 1, 2, 3], read).iter().map(Result::is_ok).collect()
        };
        assert_eq!(used(100, 10_000), [true, false, true, true]);
        assert_eq!(used(4, 10_000), [true, false, true, false]);
        assert_eq!(used(100, picture.len()), [true, false, false, false]);
        let mut header = picture.clone();
        header[16..24].copy_from_slice(&[0, 0, 0xea, 0x60, 0, 0, 0xea, 0x60]);
        assert!(
            pixels_of(&header, Format::Image(ImageFormat::Png)).is_err(),
            "60,000 × 60,000 pixels, whatever its checksum"
        );
    }

    /// Truth: a quarter of what is left is kept of each at most; 256 × 256 halved once has 128 ×
    /// 128 pixels.
    #[test]
    fn large_textures_are_halved_where_there_are_many() {
        let picture = png(256, 256);
        let sides = |kept: u64| -> Vec<u32> {
            let textures = decode_within([1 << 32, 1 << 32, kept], &[0, 1, 2], |_| Ok(encoded(&picture)));
            textures.iter().map(|texture| texture.as_ref().expect("a picture").size()[0]).collect()
        };
        assert_eq!(sides(1 << 20), [256, 256, 256]);
        assert_eq!(sides(1 << 18), [256, 128, 128]);
        assert_eq!(sides(0), [128, 128, 128], "a texture is never halved below its least");
    }
}
