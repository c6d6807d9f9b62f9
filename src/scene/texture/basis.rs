//! Basis Universal textures in KTX2 files, as `KHR_texture_basisu` has them.

use basisu::{DecodeFlags, TargetFormat, Transcoder};
use image::RgbaImage;

/// The first bytes of a KTX2 file (KTX 2.0, section 3.1).
pub(super) const MARK: &[u8] = b"\xabKTX 20\xbb\r\n\x1a\n";

/// Width and height, pixels, by the header (KTX 2.0, sections 3.5 and 3.6).
///
/// # Errors
/// One sentence if the header is not whole.
pub(super) fn size(bytes: &[u8]) -> Result<(u32, u32), String> {
    let side = |at: usize| bytes.get(at..)?.first_chunk().copied().map(u32::from_le_bytes);
    side(20).zip(side(24)).ok_or_else(|| "its header is cut off; export it again".to_owned())
}

/// The picture at full size.
///
/// # Errors
/// One sentence if the file is damaged, or its pixels are no Basis Universal texture.
pub(super) fn decode(bytes: &[u8]) -> Result<RgbaImage, String> {
    let unread = |_| "no Basis texture is in its KTX2 file; convert it to PNG, JPEG or WebP".to_owned();
    let (width, height) = size(bytes)?;
    let transcoder = Transcoder::new(bytes).map_err(unread)?;
    let pixels = transcoder.transcode(0, TargetFormat::Rgba32, DecodeFlags::NONE).map_err(unread)?;
    RgbaImage::from_raw(width, height, pixels).ok_or_else(|| "its pixels are cut off; export it again".to_owned())
}
