//! A whole picture of a link matrix: the square, brackets with names along its edges, a legend and
//! the numbers.

use image::RgbImage;
use plotters::coord::Shift;
use plotters::prelude::*;
use plotters::style::FontTransform;
use plotters::style::text_anchor::{HPos, Pos, VPos};

use super::axis::{Bracket, brackets, fitting_name};
use super::colour::{Legend, Palette};
use super::raster::{Request, View, facts, raster};
use super::{Colouring, EMPTY};
use crate::base::cancel::CancelToken;
use crate::base::font::family;
use crate::base::format;
use crate::hierarchy::Room;
use crate::read::names::Names;
use crate::scene::Scene;
use crate::transport::SolutionView;

/// Room around the square, pixels: title and names above, names at the left, air at the right,
/// legend below.
const MARGINS: [u32; 4] = [150, 86, 30, 96];
/// Width of a tier of brackets, pixels, and the gap behind it.
const TIER: i32 = 26;
const TIER_GAP: i32 = 3;
const TIERS: usize = 2;
/// Size of the legend's ramp, pixels.
const RAMP: (i32, i32) = (360, 16);

const PAPER: RGBColor = RGBColor(24, 26, 29);
const INK: RGBColor = RGBColor(230, 231, 235);
const FAINT: RGBColor = RGBColor(150, 155, 165);
const BRACKETS: [RGBColor; 2] = [RGBColor(52, 56, 63), RGBColor(42, 45, 51)];

/// Request for a picture of the matrix.
#[derive(Clone, Copy)]
pub struct Drawing<'a> {
    /// The state of the solution.
    pub solution_view: &'a SolutionView,
    /// Names of its elements.
    pub names: &'a Names,
    /// Scene of the solution.
    pub scene: &'a Scene,
    /// Measure by which elements get room.
    pub room: Room,
    /// Quantity that colours stand for.
    pub colouring: Colouring,
    /// Pixels along the sides of the square.
    pub pixels: u32,
}

/// What the drawing library says of a matrix that it cannot draw.
#[derive(Debug, thiserror::Error)]
#[error("the link matrix cannot be drawn ({0}); try a smaller picture")]
pub struct DrawError(String);

/// The picture, larger than the square by its margins.
///
/// # Errors
/// The drawing library failed.
pub fn draw(drawing: Drawing<'_>) -> Result<RgbImage, DrawError> {
    let [above, left, right, below] = MARGINS;
    let palette = Palette::new(drawing.solution_view, drawing.colouring);
    let (width, height) = (left + drawing.pixels + right, above + drawing.pixels + below);
    let mut pixels = vec![0; 3 * (width * height) as usize];
    {
        let root = BitMapBackend::with_buffer(&mut pixels, (width, height)).into_drawing_area();
        paint(drawing, &palette, &root).map_err(|error| DrawError(error.to_string()))?;
    }
    blit(drawing, &palette, &mut pixels, width);
    RgbImage::from_raw(width, height, pixels).ok_or_else(|| DrawError("its size is wrong".into()))
}

/// Copies the square into the picture.
fn blit(drawing: Drawing<'_>, palette: &Palette, pixels: &mut [u8], width: u32) {
    let Drawing { solution_view, room, .. } = drawing;
    let size = drawing.pixels as usize;
    let request = Request { room, view: View::WHOLE, pixels: size, has_gaps: true };
    let Some(raster) = raster(solution_view, palette, &request, &CancelToken::new()) else { return };
    for (row, line) in raster.pixels.chunks(size).enumerate() {
        let start = 3 * ((MARGINS[0] as usize + row) * width as usize + MARGINS[1] as usize);
        pixels[start..start + 3 * size].copy_from_slice(line.as_flattened());
    }
}

type Area<'a, 'b> = DrawingArea<BitMapBackend<'b>, Shift>;
type Failure<'b> = DrawingAreaErrorKind<<BitMapBackend<'b> as DrawingBackend>::ErrorType>;

fn paint<'b>(drawing: Drawing<'_>, palette: &Palette, root: &Area<'_, 'b>) -> Result<(), Failure<'b>> {
    let Drawing { solution_view, room, colouring, .. } = drawing;
    root.fill(&PAPER)?;
    let (left, top, size) = (MARGINS[1] as i32, MARGINS[0] as i32, drawing.pixels as i32);
    let facts = facts(solution_view, room);
    let of_room = match room {
        Room::Area => "area",
        Room::Polygons => "polygons",
        Room::Leaves => "leaves",
    };
    let title = format!("{}: links by {}", drawing.scene.name, colouring.name());
    let subtitle = format!(
        "{}; {:.0} % of the square is empty; room by {of_room}",
        format::things(facts.links, "link", "links"),
        100.0 * (1.0 - facts.covered)
    );
    root.draw(&Text::new(title, (left, 18), text(30.0, INK)))?;
    root.draw(&Text::new(subtitle, (left, 54), text(18.0, FAINT)))?;
    root.draw(&Rectangle::new([(left - 1, top - 1), (left + size, top + size)], FAINT.mix(0.6)))?;

    let all = brackets(solution_view.hierarchy(), solution_view.order(room), [0.0, 1.0], size as f32, TIERS);
    for (place, bracket) in all.iter().enumerate() {
        bracket_along_both_edges(drawing, root, bracket, place)?;
    }
    let upright = text(17.0, FAINT).transform(FontTransform::Rotate270).pos(Pos::new(HPos::Center, VPos::Center));
    root.draw(&Text::new("receivers", (left - 70, top + size / 2), upright))?;
    let middle = text(17.0, FAINT).pos(Pos::new(HPos::Center, VPos::Center));
    root.draw(&Text::new("sources", (left + size / 2, top - 70), middle))?;
    legend(root, palette, (left, top + size + 18))
}

/// An element's bracket above its columns and beside its rows.
fn bracket_along_both_edges<'b>(
    drawing: Drawing<'_>,
    root: &Area<'_, 'b>,
    bracket: &Bracket,
    place: usize,
) -> Result<(), Failure<'b>> {
    let (left, top, size) = (MARGINS[1] as i32, MARGINS[0] as i32, f64::from(drawing.pixels));
    let [start, end] = bracket.span.map(|place| (place * size).round() as i32);
    let outer = -(TIERS as i32 - bracket.tier as i32) * (TIER + TIER_GAP);
    let thick = (bracket.last_tier - bracket.tier) as i32 * (TIER + TIER_GAP) + TIER;
    let colour = BRACKETS[place % BRACKETS.len()].filled();
    root.draw(&Rectangle::new([(left + start, top + outer), (left + end - 1, top + outer + thick)], colour))?;
    root.draw(&Rectangle::new([(left + outer, top + start), (left + outer + thick, top + end - 1)], colour))?;
    let centred = || text(15.0, INK).pos(Pos::new(HPos::Center, VPos::Center));
    let fits =
        |name: &str| root.estimate_text_size(name, &centred()).is_ok_and(|(width, _)| width as i32 + 8 <= end - start);
    let named = fitting_name(drawing.names, drawing.solution_view, bracket, fits);
    if let Some(name) = named {
        let (along, across) = ((start + end) / 2, outer + thick / 2);
        root.draw(&Text::new(name.as_str(), (left + along, top + across), centred()))?;
        let upright = centred().transform(FontTransform::Rotate270);
        root.draw(&Text::new(name.as_str(), (left + across, top + along), upright))?;
    }
    Ok(())
}

/// The ramp with its ticks, and colours of their own.
fn legend<'b>(root: &Area<'_, 'b>, palette: &Palette, (left, top): (i32, i32)) -> Result<(), Failure<'b>> {
    let Legend { title, ticks, entries } = palette.legend();
    root.draw(&Text::new(title, (left, top), text(17.0, FAINT)))?;
    let mut x = left;
    if !ticks.is_empty() {
        for step in 0..RAMP.0 {
            let [r, g, b] = palette.along(step as f32 / (RAMP.0 - 1) as f32);
            let column = [(left + step, top + 26), (left + step + 1, top + 26 + RAMP.1)];
            root.draw(&Rectangle::new(column, RGBColor(r, g, b).filled()))?;
        }
        let last = (ticks.len() - 1).max(1) as i32;
        for (number, tick) in ticks.into_iter().enumerate() {
            let number = number as i32;
            let align = match number {
                0 => HPos::Left,
                number if number == last => HPos::Right,
                _ => HPos::Center,
            };
            let style = text(15.0, INK).pos(Pos::new(align, VPos::Top));
            root.draw(&Text::new(tick, (left + RAMP.0 * number / last, top + 46), style))?;
        }
        x += RAMP.0 + 36;
    }
    for entry in entries {
        let [r, g, b] = entry.colour;
        let (from, to) = ((x, top + 26), (x + RAMP.1, top + 26 + RAMP.1));
        root.draw(&Rectangle::new([from, to], RGBColor(r, g, b).filled()))?;
        root.draw(&Rectangle::new([from, to], if entry.colour == EMPTY { FAINT } else { RGBColor(r, g, b) }))?;
        let style = text(15.0, INK).pos(Pos::new(HPos::Left, VPos::Center));
        let (width, _) = root.estimate_text_size(entry.name, &style)?;
        root.draw(&Text::new(entry.name, (x + RAMP.1 + 8, top + 26 + RAMP.1 / 2), style))?;
        x += RAMP.1 + width as i32 + 30;
    }
    Ok(())
}

fn text(size: f64, colour: RGBColor) -> TextStyle<'static> {
    (family(), size).into_font().color(&colour)
}
