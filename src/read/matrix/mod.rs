//! The link matrix: the block structure of the transport operator as a picture.
//!
//! Rows are receivers, from top to bottom, columns are sources, both in the order of the hierarchy
//! ([`crate::hierarchy::Order`]). Each link is a rectangle as large as its ends: the root's
//! self-link is the whole square, with which a solve begins, and its refinements tile it. Pairs
//! that exchange no light have no link and stay dark.
//!
//! [`raster`] draws the blocks of any part of the square, [`pair_at`] says what lies at a place,
//! [`brackets`] which elements to name along its edges, and [`draw`] makes a whole picture with
//! axes and legend. Window and command line share all of them. Nothing here knows a window.

mod axis;
mod colour;
mod pair;
mod picture;
mod raster;

pub use axis::{Bracket, brackets, fitting_name};
pub use colour::{Colouring, EMPTY, FULLY_VISIBLE, HIDDEN, Legend, LegendEntry, NOT_TESTED, PARTLY_VISIBLE, Palette};
pub use pair::{Pair, pair_at};
pub use picture::{DrawError, Drawing, draw};
pub use raster::{Facts, Raster, Request, View, facts, raster};
