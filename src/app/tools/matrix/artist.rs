//! The thread that draws rasters of the matrix, so that the window never waits for one.
//!
//! One order is under way at a time. Whoever gave it goes on with the last picture until the next
//! one is there, and then orders what is wanted by then: nothing queues up, however fast the view
//! moves or the solver refines.

use std::sync::Arc;
use std::sync::mpsc::{Receiver, Sender, channel};
use std::thread::Builder;

use crate::app::Wake;
use crate::app::tools::matrix::Look;
use crate::base::cancel::CancelToken;
use crate::read::matrix::{Facts, Palette, Raster, Request, View, facts, raster};
use crate::transport::SolutionView;

/// Pixels of a picture of the whole square that fills in while a part of it is moved.
const PIXELS_OF_WHOLE: usize = 512;

/// A picture that is to be drawn.
pub struct Order {
    pub look: Look,
    pub solution_view: Arc<SolutionView>,
    pub request: Request,
    /// Whether the whole square is wanted as well.
    pub wants_whole: bool,
}

/// A picture that was drawn.
pub struct Drawn {
    pub look: Look,
    pub request: Request,
    pub raster: Raster,
    /// The whole square, coarse, if it was wanted.
    pub whole: Option<Raster>,
    pub facts: Facts,
    pub palette: Arc<Palette>,
}

/// Facts that all pictures of one look have in common.
struct Known {
    look: Look,
    facts: Facts,
    palette: Arc<Palette>,
}

/// The window's side of the thread.
pub struct Artist {
    orders: Sender<Order>,
    drawn: Receiver<Drawn>,
    cancel: CancelToken,
    under_way: bool,
}

impl Artist {
    /// Starts the thread.
    ///
    /// # Errors
    /// The system gives no further thread.
    pub fn spawn(wake: Wake) -> std::io::Result<Self> {
        let (orders, taken) = channel::<Order>();
        let (done, drawn) = channel();
        let cancel = CancelToken::new();
        let token = cancel.clone();
        let work = move || {
            let mut known = None;
            while let Ok(order) = taken.recv() {
                let Some(picture) = draw(&order, &mut known, &token) else { return };
                if done.send(picture).is_err() {
                    return;
                }
                wake();
            }
        };
        Builder::new().name("link matrix".into()).spawn(work)?;
        Ok(Self { orders, drawn, cancel, under_way: false })
    }

    /// Whether it would take an order now.
    pub fn is_free(&self) -> bool {
        !self.under_way
    }

    /// Orders a picture.
    pub fn order(&mut self, order: Order) {
        self.under_way = self.orders.send(order).is_ok();
    }

    /// The picture that was ordered, once it is there.
    pub fn take(&mut self) -> Option<Drawn> {
        let drawn = self.drawn.try_recv().ok()?;
        self.under_way = false;
        Some(drawn)
    }
}

impl Drop for Artist {
    fn drop(&mut self) {
        self.cancel.cancel();
    }
}

fn draw(order: &Order, known: &mut Option<Known>, cancel: &CancelToken) -> Option<Drawn> {
    let Order { look, solution_view, request, wants_whole } = order;
    let former = known.take().filter(|known| known.look == *look);
    let Known { facts, palette, .. } = known.insert(former.unwrap_or_else(|| Known {
        look: *look,
        facts: facts(solution_view, request.room),
        palette: Arc::new(Palette::new(solution_view, look.colouring)),
    }));
    let drawn = raster(solution_view, palette, request, cancel)?;
    let of_whole = Request { view: View::WHOLE, pixels: PIXELS_OF_WHOLE, ..*request };
    let whole = if *wants_whole { Some(raster(solution_view, palette, &of_whole, cancel)?) } else { None };
    let (facts, palette) = (*facts, palette.clone());
    Some(Drawn { look: *look, request: *request, raster: drawn, whole, facts, palette })
}
