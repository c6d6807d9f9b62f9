//! The raster of a link matrix: each pixel has the mean of the blocks that it covers, weighted by the room that they take of it.
//!
//! By power that mean is a density, so that what flows through a pixel is right at any magnification; all other colours are mixed as
//! light. What no link covers is [`EMPTY`].

use super::colour::{Colouring, EMPTY, Palette, Tone, light};
use crate::cancel::CancelToken;
use crate::hierarchy::Room;
use crate::solver::Anatomy;

/// Blocks with shorter sides than this have no gap around them, pixels.
const GAP_FROM: f32 = 7.0;
/// Blocks with longer ones have all of it.
const GAP_FULL: f32 = 22.0;
/// Room between two blocks and their common border, pixels.
const GAP: f32 = 0.5;
/// Receivers between two looks at the token.
const RECEIVERS_PER_LOOK: u32 = 256;

/// The part of the square that is in view, a square as well: places from 0 to 1, as all room is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    /// Left edge, among the sources.
    pub left: f64,
    /// Upper edge, among the receivers.
    pub top: f64,
    /// Length of its sides.
    pub size: f64,
}

impl View {
    /// All of it.
    pub const WHOLE: Self = Self { left: 0.0, top: 0.0, size: 1.0 };
    /// No smaller part can be looked at: a thousandth of a leaf of the largest scenes.
    pub const SMALLEST: f64 = 1e-7;

    /// A part of the square, moved and cut so that it lies inside.
    pub fn new(left: f64, top: f64, size: f64) -> Self {
        let size = size.clamp(Self::SMALLEST, 1.0);
        Self { left: left.clamp(0.0, 1.0 - size), top: top.clamp(0.0, 1.0 - size), size }
    }

    /// Magnified by a factor about a place, which stays where it is.
    pub fn zoomed(self, factor: f64, [column, row]: [f64; 2]) -> Self {
        let size = (self.size / factor).clamp(Self::SMALLEST, 1.0);
        let shrunk = size / self.size;
        Self::new(column - (column - self.left) * shrunk, row - (row - self.top) * shrunk, size)
    }

    /// Whether all of the square is in view.
    pub fn is_whole(&self) -> bool {
        self.size >= 1.0
    }
}

/// What is to be drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Request {
    /// What elements get room for.
    pub room: Room,
    /// What colours stand for.
    pub colouring: Colouring,
    /// The part in view.
    pub view: View,
    /// Pixels along each side.
    pub pixels: usize,
    /// Whether blocks that are large enough are set apart by hair-thin gaps.
    pub has_gaps: bool,
}

/// A part of the matrix as pixels.
#[derive(Clone, Debug, PartialEq)]
pub struct Raster {
    /// Pixels along each side.
    pub size: usize,
    /// Gamma-encoded colours, row by row.
    pub pixels: Vec<[u8; 3]>,
    /// Share of each pixel that links cover, 0..=1.
    pub covered: Vec<f32>,
}

/// Draws a part of the matrix; `None` where it was cancelled.
pub fn raster(anatomy: &Anatomy, request: &Request, cancel: &CancelToken) -> Option<Raster> {
    let order = anatomy.order(request.room);
    let palette = Palette::new(anatomy, request.colouring);
    let View { left, top, size } = request.view;
    let scale = request.pixels as f64 / size;
    let pixels = |[start, end]: [f64; 2], from: f64| [(scale * (start - from)) as f32, (scale * (end - from)) as f32];
    let is_in = |[start, end]: [f64; 2], from: f64| start < from + size && end > from;
    let mut canvas = Canvas::new(request.pixels);
    for receiver in anatomy.hierarchy().ids().filter(|&id| is_in(order.span(id), top)) {
        if receiver.0.is_multiple_of(RECEIVERS_PER_LOOK) && cancel.is_cancelled() {
            return None;
        }
        let rows = pixels(order.span(receiver), top);
        for link in anatomy.links_of(receiver).filter(|link| is_in(order.span(link.source), left)) {
            let columns = pixels(order.span(link.source), left);
            let gap = if request.has_gaps { gap(rows, columns) } else { 0.0 };
            let inside = |[start, end]: [f32; 2]| [start + gap, end - gap];
            canvas.add(inside(rows), inside(columns), palette.tone(anatomy, &link));
        }
    }
    Some(canvas.resolve(&palette))
}

/// The gap inside of a block's border, pixels.
fn gap(rows: [f32; 2], columns: [f32; 2]) -> f32 {
    let shorter = (rows[1] - rows[0]).min(columns[1] - columns[0]);
    GAP * ((shorter - GAP_FROM) / (GAP_FULL - GAP_FROM)).clamp(0.0, 1.0)
}

/// What has been added to each pixel: its tone, and the share that was covered.
struct Canvas {
    size: usize,
    sums: Vec<[f32; 4]>,
}

impl Canvas {
    fn new(size: usize) -> Self {
        Self { size, sums: vec![[0.0; 4]; size * size] }
    }

    /// Adds a rectangle, given in pixels.
    fn add(&mut self, rows: [f32; 2], columns: [f32; 2], tone: Tone) {
        let most = self.size as f32;
        let [top, bottom] = rows.map(|place| place.clamp(0.0, most));
        let [left, right] = columns.map(|place| place.clamp(0.0, most));
        let (first, last) = (left as usize, (right.ceil() as usize).min(self.size));
        for row in top as usize..(bottom.ceil() as usize).min(self.size) {
            let share = within(row, top, bottom);
            let line = &mut self.sums[row * self.size..][..self.size];
            for (column, sum) in line.iter_mut().enumerate().take(last).skip(first) {
                let share = share * within(column, left, right);
                for (sum, tone) in sum.iter_mut().zip(tone) {
                    *sum += share * tone;
                }
                sum[3] += share;
            }
        }
    }

    fn resolve(self, palette: &Palette) -> Raster {
        let empty = EMPTY.map(light);
        let mut covered = Vec::with_capacity(self.sums.len());
        let pixels = self.sums.into_iter().map(|[r, g, b, share]| {
            // While a wave goes on, rows of siblings that wait stand for more than is left of them.
            covered.push(share.min(1.0));
            if share <= 0.0 {
                return EMPTY;
            }
            let colour = palette.resolve([r, g, b].map(|sum| sum / share)).map(light);
            let share = share.min(1.0);
            std::array::from_fn(|channel| {
                let mixed = empty[channel] + share * (colour[channel] - empty[channel]);
                (255.0 * mixed.sqrt()).round() as u8
            })
        });
        let pixels = pixels.collect();
        Raster { size: self.size, pixels, covered }
    }
}

/// The share of a pixel that lies between two places.
fn within(pixel: usize, start: f32, end: f32) -> f32 {
    let pixel = pixel as f32;
    ((pixel + 1.0).min(end) - pixel.max(start)).max(0.0)
}

/// Numbers of a whole matrix.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Facts {
    /// Links.
    pub links: usize,
    /// Share of the square that they cover, 0..=1.
    pub covered: f64,
}

/// Counts the links and what they cover.
pub fn facts(anatomy: &Anatomy, room: Room) -> Facts {
    let order = anatomy.order(room);
    let width = |id| {
        let [start, end] = order.span(id);
        end - start
    };
    let links = anatomy.all_links().map(|link| width(link.receiver) * width(link.source));
    let (links, covered) = links.fold((0, 0.0), |(count, sum), room| (count + 1, sum + room));
    Facts { links, covered: covered.min(1.0) }
}
