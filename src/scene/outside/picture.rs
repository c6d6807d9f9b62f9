//! A sky as an equirectangular picture: Radiance HDR, OpenEXR, or an ordinary picture in sRGB.

use std::f64::consts::{PI, TAU};
use std::io::Cursor;

use exr::meta::MetaData;
use exr::prelude::{ReadChannels as _, ReadLayers as _};
use glam::{DVec3, Vec3};
use image::ImageFormat;

use crate::scene::texture::decode::reader;

/// The most pixels of a picture as it is kept; a larger one is halved.
const MOST_KEPT: usize = 2048 * 1024;
/// The most pixels that are read.
const MOST_READ: u64 = 1 << 27;
/// The most memory that a decoder may take.
const MOST_MEMORY: u64 = 4 << 30;
/// The largest radiance of a pixel, W/(m²·sr).
const MOST_RADIANCE: f32 = 1e9;

/// Radiances all around, rows from the zenith down; north is in the middle, west on the left.
#[derive(Clone, Debug, PartialEq)]
pub struct SkyPicture {
    width: usize,
    height: usize,
    texels: Vec<Vec3>,
}

impl SkyPicture {
    /// A picture of texels row by row from the zenith; `None` where their number is none or not
    /// width × height.
    pub fn new(width: usize, height: usize, texels: Vec<Vec3>) -> Option<Self> {
        let sound = |texel: Vec3| texel.map(|value| if value.is_nan() { 0.0 } else { value.clamp(0.0, MOST_RADIANCE) });
        let texels: Vec<Vec3> = texels.into_iter().map(sound).collect();
        let mut picture =
            (width * height == texels.len() && !texels.is_empty()).then_some(Self { width, height, texels })?;
        while picture.texels.len() > MOST_KEPT && picture.width > 1 && picture.height > 1 {
            picture = picture.halved();
        }
        Some(picture)
    }

    /// Reads a file's content.
    ///
    /// # Errors
    /// Why it is no picture, as a clause.
    pub fn read(bytes: &[u8], name: &str) -> Result<Self, String> {
        const EXR: [u8; 4] = [0x76, 0x2f, 0x31, 0x01];
        let nothing = || "it has no pixels".to_owned();
        if bytes.starts_with(&EXR) {
            return read_exr(bytes)?.ok_or_else(nothing);
        }
        let by_name = || ImageFormat::from_path(name).ok();
        let format = image::guess_format(bytes).ok().or_else(by_name).ok_or("its format is not known")?;
        let open = || reader(bytes, format, MOST_MEMORY);
        let (width, height) = open().into_dimensions().map_err(|error| error.to_string())?;
        check_size(width.into(), height.into())?;
        let image = open().decode().map_err(|error| error.to_string())?;
        let is_linear = matches!(format, ImageFormat::Hdr);
        let texels: Vec<Vec3> = if is_linear {
            image.into_rgb32f().pixels().map(|pixel| Vec3::from_array(pixel.0)).collect()
        } else {
            let linear = |pixel: &image::Rgb<u8>| Vec3::from_array(pixel.0.map(super::super::texture::linear_step));
            image.into_rgb8().pixels().map(linear).collect()
        };
        Self::new(width as usize, height as usize, texels).ok_or_else(nothing)
    }

    /// Width and height, texels.
    pub fn size(&self) -> [usize; 2] {
        [self.width, self.height]
    }

    /// Memory, bytes.
    pub fn bytes(&self) -> usize {
        size_of_val(&self.texels[..])
    }

    /// Radiance of a direction in the sky's own frame (east, north, up).
    pub fn at(&self, direction: DVec3) -> Vec3 {
        let azimuth = direction.x.atan2(direction.y);
        let column = ((azimuth / TAU + 0.5) * self.width as f64) as usize;
        let row = (direction.z.clamp(-1.0, 1.0).acos() / PI * self.height as f64) as usize;
        self.texels[row.min(self.height - 1) * self.width + column.min(self.width - 1)]
    }

    /// Irradiance of open horizontal ground, the sum over the texels above the horizon.
    pub fn horizontal_irradiance(&self) -> Vec3 {
        let mut sum = Vec3::ZERO;
        for (row, texels) in self.texels.chunks_exact(self.width).enumerate() {
            // ∫cosθ dω over a band is half of 2π times the difference of the squared sines.
            let [upper, lower] = [row, row + 1].map(|row| (PI * row as f64 / self.height as f64).cos().max(0.0));
            let weight = 0.5 * TAU * (upper * upper - lower * lower) / self.width as f64;
            sum += weight as f32 * texels.iter().sum::<Vec3>();
        }
        sum
    }

    fn halved(&self) -> Self {
        let (width, height) = (self.width / 2, self.height / 2);
        let texel = |index: usize| {
            let (x, y) = (2 * (index % width), 2 * (index / width));
            let at = |dx: usize, dy: usize| self.texels[(y + dy) * self.width + x + dx];
            0.25 * (at(0, 0) + at(1, 0) + at(0, 1) + at(1, 1))
        };
        Self { width, height, texels: (0..width * height).map(texel).collect() }
    }
}

/// Refuses what would take too much memory before any is taken.
fn check_size(width: u64, height: u64) -> Result<(), String> {
    let is_small = width.saturating_mul(height) <= MOST_READ;
    if is_small { Ok(()) } else { Err(format!("its {width} × {height} pixels are too many")) }
}

fn read_exr(bytes: &[u8]) -> Result<Option<SkyPicture>, String> {
    let layers = MetaData::read_from_buffered(Cursor::new(bytes), false).map_err(|error| error.to_string())?.headers;
    // The reader takes memory for all pixels of a layer that a header tells of.
    layers
        .iter()
        .try_for_each(|layer| check_size(layer.layer_size.width() as u64, layer.layer_size.height() as u64))?;
    let read = exr::prelude::read()
        .no_deep_data()
        .largest_resolution_level()
        .rgba_channels(
            |size, _| (size.width(), vec![Vec3::ZERO; size.area()]),
            |(width, texels), position, (r, g, b, _): (f32, f32, f32, f32)| {
                texels[position.y() * *width + position.x()] = Vec3::new(r, g, b);
            },
        )
        .first_valid_layer()
        .all_attributes()
        .from_buffered(Cursor::new(bytes))
        .map_err(|error| error.to_string())?;
    let (width, texels) = read.layer_data.channel_data.pixels;
    let height = texels.len().checked_div(width).unwrap_or(0);
    Ok(SkyPicture::new(width, height, texels))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Truth: a hemisphere of radiance L brings πL to open ground, whatever is below.
    #[test]
    fn a_grey_picture_brings_pi_times_its_radiance() {
        let picture = SkyPicture::new(64, 32, vec![Vec3::new(1.0, 2.0, 0.5); 64 * 32]).expect("texels");
        let found = picture.horizontal_irradiance();
        assert!(found.distance(PI as f32 * Vec3::new(1.0, 2.0, 0.5)) < 1e-4, "{found}");
    }

    /// Truth: the convention: north in the middle, east a quarter to the right, the zenith in the
    /// first row.
    #[test]
    fn north_is_in_the_middle() {
        let texels = (0..8 * 4).map(|index| Vec3::splat(index as f32)).collect();
        let picture = SkyPicture::new(8, 4, texels).expect("texels");
        let at = |x: f64, y: f64, z: f64| picture.at(DVec3::new(x, y, z).normalize()).x;
        assert_eq!(at(0.01, 1.0, -0.01), 20.0);
        assert_eq!(at(1.0, -0.01, -0.01), 22.0);
        assert_eq!(at(-1.0, 0.01, -0.01), 18.0);
        assert!(at(0.1, 0.1, 1.0) < 8.0);
    }

    #[test]
    fn pictures_are_read_from_their_files() {
        let mut png = Vec::new();
        let image = image::RgbImage::from_pixel(4, 2, image::Rgb([255, 0, 188]));
        image.write_to(&mut Cursor::new(&mut png), ImageFormat::Png).expect("it can be encoded");
        let read = SkyPicture::read(&png, "sky.png").expect("a picture");
        assert_eq!(read.size(), [4, 2]);
        let texel = read.at(DVec3::Y);
        assert!((texel.x - 1.0).abs() < 1e-6 && texel.y == 0.0 && (texel.z - 0.503).abs() < 1e-3, "{texel}");
        assert!(SkyPicture::read(b"no picture", "sky.hdr").is_err());
        assert!(SkyPicture::read(&[0x76, 0x2f, 0x31, 0x01, 0, 0], "sky.exr").is_err());
    }

    /// Truth: a picture of 4 × 2 pixels whose header tells of 16,384 × 8,200, 1.6 GB as they are
    /// read.
    #[test]
    fn what_the_header_of_an_exr_claims_is_not_taken_on_trust() {
        use exr::prelude::{Image, SpecificChannels, WritableImage};
        let mut file = Cursor::new(Vec::new());
        let channels = SpecificChannels::rgb(|_| (1.0_f32, 2.0_f32, 3.0_f32));
        Image::from_channels((4, 2), channels).write().to_buffered(&mut file).expect("it can be encoded");
        let mut bytes = file.into_inner();
        assert_eq!(SkyPicture::read(&bytes, "sky.exr").expect("a picture").size(), [4, 2]);
        let name = b"dataWindow\0box2i\0";
        let at = bytes.windows(name.len()).position(|window| window == name).expect("every file has one");
        // Behind the name the length of the value, the lowest and then the highest column and row.
        let highest = at + name.len() + 4 + 8;
        bytes[highest..][..4].copy_from_slice(&16_383_i32.to_le_bytes());
        bytes[highest + 4..][..4].copy_from_slice(&8_199_i32.to_le_bytes());
        let said = SkyPicture::read(&bytes, "sky.exr").expect_err("no memory is taken for it");
        assert_eq!(said, "its 16384 × 8200 pixels are too many");
    }
}
