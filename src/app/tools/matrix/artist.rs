//! Draws rasters of the matrix on a thread, so that the window never waits for one.
//!
//! One order is under way at a time. Whoever gave it goes on with the last picture until the next
//! one is there, and then orders what is wanted by then: nothing queues up, however fast the view
//! moves or the solver refines.

use std::sync::Arc;
use std::task::Poll;

use crate::app::Wake;
use crate::app::tools::matrix::Look;
use crate::base::cancel::CancelToken;
use crate::base::threads::Background;
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
    /// Facts and colours that an earlier picture of this kind found.
    pub known: Option<(Facts, Arc<Palette>)>,
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

/// The window's side of the thread.
#[derive(Default)]
pub struct Artist {
    under_way: Option<Background<Option<Drawn>>>,
    cancel: CancelToken,
}

impl Artist {
    /// Whether it would take an order now.
    pub fn is_free(&self) -> bool {
        self.under_way.is_none()
    }

    /// Orders a picture.
    ///
    /// # Errors
    /// The system gives no further thread.
    pub fn order(&mut self, order: Order, wake: Wake) -> std::io::Result<()> {
        let cancel = self.cancel.clone();
        self.under_way = Some(Background::start("link matrix", move || wake(), move || draw(order, &cancel))?);
        Ok(())
    }

    /// The picture that was ordered, once it is there.
    pub fn take(&mut self) -> Option<Drawn> {
        // What broke stays under way: it would break again.
        let Poll::Ready(Some(drawn)) = self.under_way.as_ref()?.poll() else { return None };
        self.under_way = None;
        drawn
    }
}

impl Drop for Artist {
    fn drop(&mut self) {
        self.cancel.cancel();
    }
}

fn draw(order: Order, cancel: &CancelToken) -> Option<Drawn> {
    let Order { look, solution_view, request, wants_whole, known } = order;
    let (facts, palette) = known.unwrap_or_else(|| {
        (facts(&solution_view, request.room), Arc::new(Palette::new(&solution_view, look.colouring)))
    });
    let drawn = raster(&solution_view, &palette, &request, cancel)?;
    let of_whole = Request { view: View::WHOLE, pixels: PIXELS_OF_WHOLE, ..request };
    let whole = if wants_whole { Some(raster(&solution_view, &palette, &of_whole, cancel)?) } else { None };
    Some(Drawn { look, request, raster: drawn, whole, facts, palette })
}
