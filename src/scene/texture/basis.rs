//! Basis Universal textures in KTX2 files, as `KHR_texture_basisu` has them: one picture, ETC1S or
//! UASTC.
//!
//! The decoder trusts lengths and offsets; here they are compared with what is there first.

use basisu::{DecodeFlags, TargetFormat, Transcoder};
use image::RgbaImage;

/// The first bytes of a KTX2 file (KTX 2.0, section 3.1).
pub(super) const MARK: &[u8] = b"\xabKTX 20\xbb\r\n\x1a\n";

/// Values of the header that are read (KTX 2.0, section 3).
struct Header<'a> {
    bytes: &'a [u8],
}

/// Places of the header's values.
const LAYERS: usize = 32;
const FACES: usize = 36;
const LEVELS: usize = 40;
const SUPERCOMPRESSION: usize = 44;
const DESCRIPTOR: usize = 48;
const KEYS_LENGTH: usize = 60;
const GLOBAL_DATA: usize = 64;
const FIRST_LEVEL: usize = 80;

/// Schemes of supercompression.
const BASIS_LZ: u32 = 1;
const ZSTANDARD: u32 = 2;

/// Colour models of the data format descriptor.
const ETC1S: u8 = 163;
const UASTC: u8 = 166;

/// Bytes of the global data of BasisLZ before its descriptions of images, and of one such
/// description.
const LZ_HEAD: u64 = 20;
const LZ_IMAGE: u64 = 20;

impl Header<'_> {
    fn u32(&self, at: usize) -> Option<u32> {
        self.bytes.get(at..)?.first_chunk().copied().map(u32::from_le_bytes)
    }

    fn u64(&self, at: usize) -> Option<u64> {
        self.bytes.get(at..)?.first_chunk().copied().map(u64::from_le_bytes)
    }

    /// Whether so many bytes are there from an offset on.
    fn holds(&self, offset: u64, length: u64) -> bool {
        offset.checked_add(length).is_some_and(|end| end <= self.bytes.len() as u64)
    }

    /// Whether everything that the decoder takes for granted is so.
    fn is_sound(&self) -> Option<bool> {
        let [width, height] = [self.u32(20)?, self.u32(24)?].map(u64::from);
        let levels = self.u32(LEVELS)?;
        let is_one_picture = self.u32(LAYERS)? <= 1 && self.u32(FACES)? == 1 && (1..=16).contains(&levels);
        let [descriptor, descriptor_length] = [self.u32(DESCRIPTOR)?, self.u32(DESCRIPTOR + 4)?].map(u64::from);
        if !is_one_picture || !self.holds(descriptor, descriptor_length.max(44)) {
            return Some(false);
        }
        // Levels follow each other's descriptions, 24 bytes each.
        let level = |level: u32, at: usize| self.u64(FIRST_LEVEL + 24 * level as usize + at);
        for number in 0..levels {
            if !self.holds(level(number, 0)?, level(number, 8)?) {
                return Some(false);
            }
        }
        let blocks = 16 * width.div_ceil(4) * height.div_ceil(4);
        let model = *self.bytes.get(descriptor as usize + 12)?;
        Some(match (model, self.u32(SUPERCOMPRESSION)?) {
            (UASTC, 0) => level(0, 8)? == blocks,
            (UASTC, ZSTANDARD) => level(0, 16)? == blocks,
            (ETC1S, BASIS_LZ) => self.has_global_data(levels)?,
            _ => false,
        })
    }

    /// Whether the global data of BasisLZ is as long as it says, and so are the slices of its first
    /// image.
    fn has_global_data(&self, levels: u32) -> Option<bool> {
        let [offset, length] = [self.u64(GLOBAL_DATA)?, self.u64(GLOBAL_DATA + 8)?];
        if !self.holds(offset, length) || length < LZ_HEAD {
            return Some(false);
        }
        let at = offset as usize;
        let lengths = [self.u32(at + 4)?, self.u32(at + 8)?, self.u32(at + 12)?].map(u64::from);
        let [codes, colour, colour_length, alpha, alpha_length] = [
            lengths.iter().sum::<u64>() + LZ_HEAD + LZ_IMAGE * u64::from(levels),
            self.u32(at + 24)?.into(),
            self.u32(at + 28)?.into(),
            self.u32(at + 32)?.into(),
            self.u32(at + 36)?.into(),
        ];
        let level = self.u64(FIRST_LEVEL)?;
        let is_there = |from: u64, length: u64| level.checked_add(from).is_some_and(|at| self.holds(at, length));
        Some(codes <= length && is_there(colour, colour_length) && is_there(alpha, alpha_length))
    }
}

/// Width and height, pixels, by the header (KTX 2.0, sections 3.5 and 3.6).
///
/// # Errors
/// One sentence if the header is not whole.
pub(super) fn size(bytes: &[u8]) -> Result<(u32, u32), String> {
    let header = Header { bytes };
    header.u32(20).zip(header.u32(24)).ok_or_else(|| "its header is cut off; export it again".to_owned())
}

/// The picture at full size.
///
/// # Errors
/// One sentence if the file is damaged, or its pixels are no Basis Universal texture.
pub(super) fn decode(bytes: &[u8]) -> Result<RgbaImage, String> {
    let unread = || "no Basis texture is in its KTX2 file; convert it to PNG, JPEG or WebP".to_owned();
    let (width, height) = size(bytes)?;
    if !(Header { bytes }).is_sound().unwrap_or(false) {
        return Err(unread());
    }
    // Nothing of its keys and values is needed, and the decoder trusts their lengths.
    let mut bytes = bytes.to_vec();
    bytes[KEYS_LENGTH..KEYS_LENGTH + 4].fill(0);
    let transcoder = Transcoder::new(&bytes).map_err(|_| unread())?;
    let pixels = transcoder.transcode(0, TargetFormat::Rgba32, DecodeFlags::NONE).map_err(|_| unread())?;
    RgbaImage::from_raw(width, height, pixels).ok_or_else(|| "its pixels are cut off; export it again".to_owned())
}
