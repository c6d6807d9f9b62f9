//! A truth to measure by: path-traced irradiance at points on surfaces, with a standard error for
//! each.
//!
//! The paper measured no error "due to the lack of a good reference solution"; this is one. It
//! shares the scene with the solver and nothing else: its own tree of boxes and its own test of
//! rays against faces, its own idea of faces at the same place, its own list of emitters, hash,
//! random numbers and points on polygons. They are copies on purpose, so that what blinds the one
//! does not blind the other. Its estimates are unbiased, of any number of
//! bounces, and say how far they may be off. [`ReferenceRun`] makes them better pass by pass and
//! keeps what it knows in a [`Cache`].
//!
//! ```
//! use selflink::base::cancel::CancelToken;
//! use selflink::measure::reference::{ReferenceRun, random_points};
//! use selflink::scene::{Sides, builtin::BuiltinScene};
//!
//! let (scene, _) = selflink::geometry::orient::apply(BuiltinScene::Cornell.build(), Sides::Front);
//! let points = random_points(&scene, 20, 1);
//! let mut run = ReferenceRun::new(&scene, points.into(), 1);
//! for _ in 0..4 {
//!     run.pass(&CancelToken::new());
//! }
//! let reference = run.reference();
//! assert!(reference.noise() < 0.3);
//! println!("E = {} ± {} W/m²", reference.irradiance[0], reference.standard_error[0]);
//! ```

mod bvh;
mod cache;
mod compute;
mod glow;
mod key;
mod lamps;
mod outside;
mod path;
mod points;
mod run;
mod sequence;
mod share;
mod sums;
mod surfaces;
mod triangle;
mod view;

pub use cache::Cache;
pub(super) use compute::SAVE_EVERY;
pub use compute::{LEAST_PASSES, Outcome, Target, Wish, compute};
pub use key::Key;
pub use lamps::point_on_polygon;
pub use path::Tracer;
pub use points::{SurfacePoint, random_points, random_points_on};
pub use run::{Reference, ReferenceRun};
pub use view::{View, ViewPixel, ViewRun};
