//! Values in a picture: those of isolux lines along them, and the legend of false colours and
//! lines in the lower left corner.

use image::{Rgb, RgbImage, Rgba, RgbaImage, imageops};
use plotters::backend::BitMapBackend;
use plotters::drawing::IntoDrawingArea;
use plotters::element::Text;
use plotters::style::text_anchor::{HPos, Pos, VPos};
use plotters::style::{IntoFont, RGBColor, TextStyle};

use super::Reading;
use crate::base::font::{NotDrawn, family};
use crate::read::picture::{LineLabel, write_labels};

/// Sizes for a picture of 800 lines; larger ones have larger legends.
const USUAL_HEIGHT: f32 = 800.0;
const CARD: [f32; 2] = [380.0, 88.0];
const MARGIN: f32 = 12.0;
const BAR: [f32; 2] = [340.0, 14.0];

const PANEL: Rgb<u8> = Rgb([29, 31, 35]);
const TEXT: RGBColor = RGBColor(236, 237, 240);
const WEAK: RGBColor = RGBColor(160, 165, 175);

/// Writes the values of lines along them into a picture and, if it is to have one, the legend of
/// what is read off it.
///
/// # Errors
/// The letters cannot be drawn, for want of a font.
pub fn annotate(
    picture: &mut RgbaImage,
    reading: &Reading,
    labels: &[LineLabel],
    has_legend: bool,
) -> Result<(), NotDrawn> {
    write_labels(picture, labels, reading.shown_in)?;
    if has_legend { draw_legend(picture, reading) } else { Ok(()) }
}

/// Draws the legend; nothing where the picture is too small to hold it.
fn draw_legend(picture: &mut RgbaImage, reading: &Reading) -> Result<(), NotDrawn> {
    let scale = (picture.height() as f32 / USUAL_HEIGHT).clamp(0.8, 4.0);
    let pixels = |length: f32| (scale * length).round() as u32;
    let [width, height] = CARD.map(pixels);
    let margin = pixels(MARGIN);
    if width + 2 * margin > picture.width() || height + 2 * margin > picture.height() {
        return Ok(());
    }
    let mut card = RgbImage::from_pixel(width, height, PANEL);
    let [left, top] = [(CARD[0] - BAR[0]) / 2.0, 28.0].map(pixels);
    let [bar_width, bar_height] = BAR.map(pixels);
    let marks = reading.marks();
    for x in 0..bar_width {
        let along = (x as f32 + 0.5) / bar_width as f32;
        let colour = Rgb(reading.scale.ramp.at(along));
        (0..bar_height).for_each(|y| card.put_pixel(left + x, top + y, colour));
    }
    let place = |along: f32| left + (along.clamp(0.0, 1.0) * (bar_width - 1) as f32).round() as u32;
    for mark in &marks {
        let (colour, upto) = if mark.is_line { (Rgb([250; 3]), 0) } else { (Rgb([146, 151, 161]), bar_height) };
        (upto..bar_height + pixels(4.0)).for_each(|y| card.put_pixel(place(mark.along), top + y, colour));
    }
    write(
        &mut card,
        reading,
        (scale, &marks.iter().map(|mark| (place(mark.along), mark.label.as_str())).collect::<Vec<_>>()),
    )?;
    let at_y = picture.height() - height - margin;
    let card = RgbaImage::from_fn(width, height, |x, y| {
        let Rgb([r, g, b]) = *card.get_pixel(x, y);
        Rgba([r, g, b, 255])
    });
    imageops::replace(picture, &card, margin.into(), at_y.into());
    Ok(())
}

/// Title, values and convention.
fn write(card: &mut RgbImage, reading: &Reading, (scale, labels): (f32, &[(u32, &str)])) -> Result<(), NotDrawn> {
    let (width, height) = card.dimensions();
    let failed = NotDrawn::because("the legend cannot be drawn");
    let area = BitMapBackend::with_buffer(card, (width, height)).into_drawing_area();
    let style = |size: f32, colour: &'static RGBColor, horizontal: HPos| {
        TextStyle::from((family(), f64::from(size * scale)).into_font())
            .color(colour)
            .pos(Pos::new(horizontal, VPos::Top))
    };
    let say = |text: &str, (x, y): (i32, f32), style: TextStyle<'_>| {
        area.draw(&Text::new(text.to_owned(), (x, (y * scale) as i32), style)).map_err(&failed)
    };
    let left = (20.0 * scale) as i32;
    say(&reading.title(), (left, 7.0), style(16.0, &TEXT, HPos::Left))?;
    say(reading.shown_in.remark(), (left, 68.0), style(12.0, &WEAK, HPos::Left))?;
    let mut free_from = 0;
    for (place, label) in labels {
        let (text_width, _) = area.estimate_text_size(label, &style(13.0, &TEXT, HPos::Center)).map_err(&failed)?;
        let begin = *place as i32 - text_width as i32 / 2;
        if begin >= free_from {
            say(label, (*place as i32, 50.0), style(13.0, &TEXT, HPos::Center))?;
            free_from = begin + text_width as i32 + (6.0 * scale) as i32;
        }
    }
    area.present().map_err(&failed)
}
