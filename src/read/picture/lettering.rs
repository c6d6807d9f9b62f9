//! Values along the lines of equal value of a gathered picture, drawn into it.

use glam::{Vec2, vec2};
use image::{Rgb, RgbImage, Rgba, RgbaImage};
use plotters::backend::BitMapBackend;
use plotters::drawing::IntoDrawingArea;
use plotters::element::Text;
use plotters::style::text_anchor::{HPos, Pos, VPos};
use plotters::style::{IntoFont, TextStyle, WHITE};

use super::{LABEL_RIM, LineLabel};
use crate::base::font::{NotDrawn, family};
use crate::base::format;
use crate::base::photometry::ShownIn;

/// Height of the letters, pixels.
const HEIGHT: f64 = 14.0;
/// A value is written so many times as large and then averaged, so that it can be turned.
const FINE: u32 = 3;
/// How dark the rim of the letters is.
const RIM_OPACITY: f32 = 0.8;

/// Writes them, white with a dark rim, so that they can be read over bright and dark.
///
/// # Errors
/// The letters cannot be drawn, for want of a font.
pub fn write_labels(picture: &mut RgbaImage, labels: &[LineLabel], shown_in: ShownIn) -> Result<(), NotDrawn> {
    for label in labels {
        let written = Written::new(&format::short((shown_in.per_watt() * label.value).into()))?;
        let reach = 0.5 * vec2(written.fine.width() as f32, written.fine.height() as f32).length() / FINE as f32 + 2.0;
        // Along the line and downwards from it; rows count downwards.
        let (sine, cosine) = label.angle.sin_cos();
        let (along, down) = (vec2(cosine, -sine), vec2(sine, cosine));
        let limit = |value: f32, size: u32| value.clamp(0.0, size as f32) as u32;
        let (width, height) = picture.dimensions();
        for y in limit(label.at.y - reach, height)..limit(label.at.y + reach + 1.0, height) {
            for x in limit(label.at.x - reach, width)..limit(label.at.x + reach + 1.0, width) {
                let aside = vec2(x as f32 + 0.5, y as f32 + 0.5) - label.at;
                let place = vec2(aside.dot(along), aside.dot(down));
                let rim = LABEL_RIM.iter().map(|by| written.cover(place + Vec2::from(*by))).fold(0.0, f32::max);
                let letters = written.cover(place);
                let Rgba([r, g, b, opacity]) = *picture.get_pixel(x, y);
                let mixed = [r, g, b].map(|channel| {
                    let behind = f32::from(channel) * (1.0 - RIM_OPACITY * rim);
                    (behind + letters * (255.0 - behind)).round() as u8
                });
                picture.put_pixel(x, y, Rgba([mixed[0], mixed[1], mixed[2], opacity]));
            }
        }
    }
    Ok(())
}

/// A value, white on black, finer than it is shown.
struct Written {
    fine: RgbImage,
    /// Middle of what the letters cover: a font's own line has room for more below than above.
    middle: Vec2,
}

impl Written {
    fn new(text: &str) -> Result<Self, NotDrawn> {
        let failed = NotDrawn::because("values cannot be written along lines");
        let style = TextStyle::from((family(), HEIGHT * f64::from(FINE)).into_font())
            .color(&WHITE)
            .pos(Pos::new(HPos::Center, VPos::Center));
        // As wide as letters can be.
        let height = 2 * HEIGHT as u32 * FINE;
        let width = height * (1 + text.chars().count() as u32);
        let mut fine = RgbImage::from_pixel(width, height, Rgb([0; 3]));
        let area = BitMapBackend::with_buffer(&mut fine, (width, height)).into_drawing_area();
        let middle = (width as i32 / 2, height as i32 / 2);
        area.draw(&Text::new(text.to_owned(), middle, style)).map_err(&failed)?;
        area.present().map_err(&failed)?;
        drop(area);
        let inked = fine.enumerate_pixels().filter(|(.., pixel)| pixel.0[0] > 0);
        let corners = inked.map(|(x, y, _)| vec2(x as f32 + 0.5, y as f32 + 0.5));
        let (low, high) =
            corners.fold((Vec2::INFINITY, Vec2::NEG_INFINITY), |(low, high), at| (low.min(at), high.max(at)));
        let middle = if low.x <= high.x { 0.5 * (low + high) } else { 0.5 * vec2(width as f32, height as f32) };
        Ok(Self { fine, middle })
    }

    /// How much of a pixel the letters cover, its middle given from that of the text.
    fn cover(&self, at: Vec2) -> f32 {
        let corner = FINE as f32 * (at - 0.5) + self.middle;
        let texel = |index: u32| {
            let place = corner + vec2((index % FINE) as f32, (index / FINE) as f32) + 0.5;
            if place.min_element() < 0.0 {
                return 0.0;
            }
            self.fine.get_pixel_checked(place.x as u32, place.y as u32).map_or(0.0, |Rgb([grey, ..])| f32::from(*grey))
        };
        (0..FINE * FINE).map(texel).sum::<f32>() / (255 * FINE * FINE) as f32
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::photometry::Unit;

    /// Truth: the letters' own spread, of a number that is the same from either end. White pixels
    /// lie along its line, to either side of its middle, with dark ones around; what is far from it
    /// stays.
    #[test]
    fn values_lie_along_their_lines() {
        for angle in [-1.2_f32, -0.5, 0.0, 0.9] {
            let mut picture = RgbaImage::from_pixel(90, 80, Rgba([120, 130, 140, 255]));
            let at = vec2(40.0, 45.0);
            write_labels(&mut picture, &[LineLabel { at, angle, value: 808.0 }], ShownIn::Unit(Unit::Watts))
                .expect("drawn");
            let (along, across) = (vec2(angle.cos(), -angle.sin()), vec2(angle.sin(), angle.cos()));
            let of = |wanted: fn(u8) -> bool| {
                let pixels = picture.enumerate_pixels().filter(move |(.., pixel)| wanted(pixel.0[0]));
                pixels.map(|(x, y, _)| vec2(x as f32 + 0.5, y as f32 + 0.5) - at).collect::<Vec<_>>()
            };
            let white = of(|red| red > 200);
            // Strokes are a pixel or two wide: turned, each digit has but some pixels that are all
            // white.
            assert!(white.len() > 12 && of(|red| red < 60).len() > 20, "{angle}: {} white", white.len());
            let most = |axis: Vec2| white.iter().map(|aside| aside.dot(axis).abs()).fold(0.0, f32::max);
            assert!((8.0..16.0).contains(&most(along)) && most(across) < 8.0, "{} {}", most(along), most(across));
            let mean = white.iter().sum::<Vec2>() / white.len() as f32;
            assert!(mean.length() < 1.0, "{angle}: {mean}");
            assert_eq!(picture.get_pixel(2, 2), &Rgba([120, 130, 140, 255]));
        }
    }
}
