//! The raster of a link matrix: each pixel has the mean of the blocks that it covers, weighted by
//! the room that they take of it.
//!
//! By power that mean is a density, so that what flows through a pixel is right at any
//! magnification; all other colours are mixed as light. What no link covers is [`EMPTY`].

use super::colour::{EMPTY, Palette, Tone, light};
use crate::base::cancel::CancelToken;
use crate::hierarchy::Room;
use crate::transport::SolutionView;

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

/// Request for a raster.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Request {
    /// Measure by which elements get room.
    pub room: Room,
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
}

/// Draws a part of the matrix; `None` where it was cancelled.
pub fn raster(
    solution_view: &SolutionView,
    palette: &Palette,
    request: &Request,
    cancel: &CancelToken,
) -> Option<Raster> {
    Some(canvas(solution_view, palette, request, cancel)?.resolve(palette))
}

/// Paints the links of a part of the matrix.
fn canvas(solution_view: &SolutionView, palette: &Palette, request: &Request, cancel: &CancelToken) -> Option<Canvas> {
    let order = solution_view.order(request.room);
    let View { left, top, size } = request.view;
    let scale = request.pixels as f64 / size;
    let pixels = |[start, end]: [f64; 2], from: f64| [(scale * (start - from)) as f32, (scale * (end - from)) as f32];
    let is_in = |[start, end]: [f64; 2], from: f64| start < from + size && end > from;
    let rim = request.pixels as f32;
    let mut canvas = Canvas::new(request.pixels);
    for receiver in solution_view.hierarchy().ids().filter(|&id| is_in(order.span(id), top)) {
        if receiver.0.is_multiple_of(RECEIVERS_PER_LOOK) && cancel.is_cancelled() {
            return None;
        }
        let rows = pixels(order.span(receiver), top);
        for link in solution_view.links_of(receiver).filter(|link| is_in(order.span(link.source), left)) {
            let columns = pixels(order.span(link.source), left);
            let gap = if request.has_gaps { gap(rows, columns) } else { 0.0 };
            // The rim of the square is nobody's common border.
            let inside = |[start, end]: [f32; 2]| {
                [if start > 0.0 { start + gap } else { start }, if end < rim { end - gap } else { end }]
            };
            canvas.add(inside(rows), inside(columns), palette.tone(solution_view, &link));
        }
    }
    Some(canvas)
}

/// The gap inside of a block's border, pixels.
fn gap(rows: [f32; 2], columns: [f32; 2]) -> f32 {
    let shorter = (rows[1] - rows[0]).min(columns[1] - columns[0]);
    GAP * ((shorter - GAP_FROM) / (GAP_FULL - GAP_FROM)).clamp(0.0, 1.0)
}

/// Sum of each pixel: tone, and the share that was covered.
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
        let pixels = self.sums.into_iter().map(|[r, g, b, share]| {
            if share <= 0.0 {
                return EMPTY;
            }
            let colour = palette.resolve([r, g, b].map(|sum| sum / share)).map(light);
            // While a wave goes on, rows of siblings that wait stand for more than is left of them.
            let share = share.min(1.0);
            std::array::from_fn(|channel| {
                let mixed = empty[channel] + share * (colour[channel] - empty[channel]);
                (255.0 * mixed.sqrt()).round() as u8
            })
        });
        Raster { size: self.size, pixels: pixels.collect() }
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
pub fn facts(solution_view: &SolutionView, room: Room) -> Facts {
    let order = solution_view.order(room);
    let width = |id| {
        let [start, end] = order.span(id);
        end - start
    };
    let links = solution_view.all_links().map(|link| width(link.receiver) * width(link.source));
    let (links, covered) = links.fold((0, 0.0), |(count, sum), room| (count + 1, sum + room));
    Facts { links, covered: covered.min(1.0) }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use glam::Vec3;

    use super::*;
    use crate::geometry::Occluders;
    use crate::hierarchy::Hierarchy;
    use crate::measure::stability::scenes::empty_room;
    use crate::read::matrix::{Colouring, pair_at};
    use crate::solve::{Solver, SolverParams, Step};

    /// Of a closed cube that nothing stands in; one of its faces shines.
    fn solver() -> Solver {
        let mut scene = empty_room(0.5, 0.0);
        scene.polygons[0].material = scene.add_material("lamp", Vec3::splat(0.5), Vec3::ONE);
        let scene = Arc::new(scene);
        let occluders = Arc::new(Occluders::new(&scene));
        let params = SolverParams::with_epsilon(3e-3);
        let mut solver = Solver::new(scene, occluders, params, 1).expect("the parameters are valid");
        solver.show_solution_view(true);
        solver
    }

    fn solution_view(solver: &mut Solver) -> Arc<SolutionView> {
        solver.snapshot().solution_view.expect("it was asked for")
    }

    fn request(room: Room, pixels: usize) -> Request {
        Request { room, view: View::WHOLE, pixels, has_gaps: false }
    }

    fn drawn(solution_view: &SolutionView, colouring: Colouring, request: &Request) -> Raster {
        let palette = Palette::new(solution_view, colouring);
        raster(solution_view, &palette, request, &CancelToken::new()).expect("nobody cancelled it")
    }

    /// The share of each pixel that links cover.
    fn covered(solution_view: &SolutionView, colouring: Colouring, request: &Request) -> Vec<f32> {
        let palette = Palette::new(solution_view, colouring);
        let canvas = canvas(solution_view, &palette, request, &CancelToken::new()).expect("nobody cancelled it");
        canvas.sums.iter().map(|sum| sum[3].min(1.0)).collect()
    }

    /// Truth: two blocks by hand, one of whole pixels and one that covers a quarter of its pixel.
    #[test]
    fn blocks_cover_their_pixels() {
        let mut canvas = Canvas::new(4);
        canvas.add([0.0, 2.0], [1.0, 4.0], [1.0, 0.25, 0.0]);
        canvas.add([3.5, 4.0], [0.0, 0.5], [0.0, 1.0, 0.0]);
        let covered: Vec<f32> = canvas.sums.iter().map(|sum| sum[3]).collect();
        #[rustfmt::skip]
        assert_eq!(covered, [
            0.0, 1.0, 1.0, 1.0,
            0.0, 1.0, 1.0, 1.0,
            0.0, 0.0, 0.0, 0.0,
            0.25, 0.0, 0.0, 0.0,
        ]);
        assert_eq!(canvas.sums[1], [1.0, 0.25, 0.0, 1.0]);
        assert_eq!(canvas.sums[12], [0.0, 0.25, 0.0, 0.25]);
    }

    /// Truth: at first there is one link, as large as the square.
    #[test]
    fn the_first_square_is_full() {
        let solution_view = solution_view(&mut solver());
        assert_eq!(facts(&solution_view, Room::Area), Facts { links: 1, covered: 1.0 });
        for colouring in Colouring::ALL {
            let request = Request { has_gaps: true, ..request(Room::Area, 50) };
            assert!(covered(&solution_view, colouring, &request).iter().all(|&covered| covered == 1.0));
            let raster = drawn(&solution_view, colouring, &request);
            assert!(raster.pixels.iter().all(|&pixel| pixel == raster.pixels[0] && pixel != EMPTY), "{colouring:?}");
        }
    }

    /// Truth: in an empty cube each face sees the five others and not itself, so that after each
    /// wave, as at the end, five sixths of the square are covered, none of it twice; pictures cover
    /// what the blocks do.
    #[test]
    fn blocks_tile_the_square() {
        let mut solver = solver();
        let never = CancelToken::new();
        let mut waves = 0;
        loop {
            match solver.step(&never) {
                Step::Refined { wave_ended: true } => {
                    waves += 1;
                    let covered = facts(&solution_view(&mut solver), Room::Area).covered;
                    assert!(covered >= 5.0 / 6.0 - 1e-6, "wave {waves}: {covered}");
                }
                Step::Finished => break,
                _ => {}
            }
        }
        let solution_view = solution_view(&mut solver);
        assert!(waves > 2 && solution_view.links().len() > 100);
        for room in Room::ALL {
            let order = solution_view.order(room);
            let width = |id| order.span(id)[1] - order.span(id)[0];
            let faces = solution_view.hierarchy().initial_patches();
            let expected = 1.0 - faces.iter().map(|&face| width(face) * width(face)).sum::<f64>();
            assert!((facts(&solution_view, room).covered - expected).abs() < 1e-6, "{room:?}");
            let covered = covered(&solution_view, Colouring::Power, &request(room, 96));
            let mean = covered.iter().map(|&covered| f64::from(covered)).sum::<f64>() / (96.0 * 96.0);
            assert!((mean - expected).abs() < 1e-4, "{room:?}: {mean} instead of {expected}");
        }
    }

    /// Truth: a magnified part is made of the same blocks; each lies where the pair is found.
    #[test]
    fn a_part_shows_what_lies_there() {
        let mut solver = solver();
        assert!(solver.run(&CancelToken::new()));
        let solution_view = solution_view(&mut solver);
        let view = View::new(0.25, 0.5, 0.25);
        let part = drawn(&solution_view, Colouring::Level, &Request { view, ..request(Room::Area, 64) });
        let all = drawn(&solution_view, Colouring::Level, &request(Room::Area, 256));
        for row in 0..64 {
            assert_eq!(part.pixels[64 * row..][..64], all.pixels[256 * (128 + row) + 64..][..64]);
        }
        let order = solution_view.order(Room::Leaves);
        let middle = |id| 0.5 * (order.span(id)[0] + order.span(id)[1]);
        for link in solution_view.all_links().step_by(7) {
            let pair = pair_at(&solution_view, Room::Leaves, [middle(link.source), middle(link.receiver)]);
            let found = pair.link.map(|found| (found.receiver, found.source));
            assert_eq!(found, Some((link.receiver, link.source)));
        }
        let face = solution_view.hierarchy().initial_patches()[0];
        assert!(pair_at(&solution_view, Room::Leaves, [middle(face); 2]).link.is_none(), "a face does not see itself");
        assert_eq!(pair_at(&solution_view, Room::Area, [0.0, 1.0]).receivers[0], Hierarchy::ROOT);
    }

    /// Truth: what is under the mouse stays there, and nothing outside of the square comes into
    /// view.
    #[test]
    fn views_stay_inside() {
        let zoomed = View::WHOLE.zoomed(4.0, [0.9, 0.1]);
        assert!((zoomed.size - 0.25).abs() < 1e-12);
        assert!(((0.9 - zoomed.left) / zoomed.size - 0.9).abs() < 1e-12);
        assert_eq!(zoomed.zoomed(0.01, [0.9, 0.1]), View::WHOLE);
        assert_eq!(View::new(-3.0, 7.0, 0.5), View { left: 0.0, top: 0.5, size: 0.5 });
    }
}
