//! Files beside a scene, which must not lead out of its folder, and the mean colour of a texture.

use std::path::{Component, Path, PathBuf};

use glam::{Vec3, Vec4};
use image::DynamicImage;

/// The path of a file that a scene refers to, if it stays inside the scene's folder.
pub(super) fn beside(scene: &Path, reference: &str) -> Option<PathBuf> {
    let reference = reference.replace('\\', "/");
    let relative = Path::new(&reference);
    let inside = relative.components().all(|part| matches!(part, Component::Normal(_) | Component::CurDir));
    let is_drive = reference.as_bytes().get(1) == Some(&b':');
    (inside && !is_drive && !reference.is_empty())
        .then(|| scene.parent().unwrap_or_else(|| Path::new("")).join(relative))
}

/// Mean linear colour and mean alpha of an encoded image; colours count by their alpha.
///
/// # Errors
/// Why the image cannot be decoded.
pub(super) fn mean_colour(encoded: &[u8]) -> Result<Vec4, String> {
    image::load_from_memory(encoded).map(|image| mean_of(&image)).map_err(|error| error.to_string())
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

    #[test]
    fn references_stay_in_the_folder() {
        let scene = Path::new("/scenes/room.obj");
        assert_eq!(beside(scene, "maps/wood.png"), Some(PathBuf::from("/scenes/maps/wood.png")));
        assert_eq!(beside(scene, "maps\\wood.png"), Some(PathBuf::from("/scenes/maps/wood.png")));
        assert_eq!(beside(Path::new("room.obj"), "a.mtl"), Some(PathBuf::from("a.mtl")));
        for escape in ["../wood.png", "/etc/passwd", "maps/../../x", "C:\\x.png", "", "\\\\server\\x"] {
            assert_eq!(beside(scene, escape), None, "{escape}");
        }
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
