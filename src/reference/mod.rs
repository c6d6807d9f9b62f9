//! A truth to measure by: path-traced irradiance at points on surfaces, with a standard error for each.
//!
//! The paper measured no error "due to the lack of a good reference solution"; this is one. It shares the scene, its
//! occluders, materials and bright sides with the solver and none of the solver's code: its estimates are unbiased,
//! of any number of bounces, and say how far they may be off. [`ReferenceRun`] makes them better pass by pass and keeps what it knows
//! in a [`Cache`]. Imports `scene` and `visibility`, never `solver`.
//!
//! ```
//! use std::sync::Arc;
//!
//! use selflink::cancel::CancelToken;
//! use selflink::reference::{ReferenceRun, random_points};
//! use selflink::scene::{Sides, builtin::BuiltinScene};
//!
//! let (scene, occluders) = selflink::geometry::orient::apply(BuiltinScene::Cornell.build(), Sides::Front);
//! let occluders = Arc::new(occluders);
//! let points = random_points(&scene, &occluders, 20, 1);
//! let mut run = ReferenceRun::new(&scene, occluders, points.into(), 1);
//! for _ in 0..4 {
//!     run.pass(&CancelToken::new());
//! }
//! let reference = run.reference();
//! assert!(reference.noise() < 0.3);
//! println!("E = {} ± {} W/m²", reference.irradiance[0], reference.standard_error[0]);
//! ```

mod cache;
mod compute;
mod glow;
mod key;
mod lamps;
mod path;
mod points;
mod run;
mod sequence;
mod share;
mod sums;

pub use cache::Cache;
pub use compute::{Outcome, Target, compute};
pub use key::Key;
pub use lamps::point_on_polygon;
pub use points::{SurfacePoint, random_points, random_points_on};
pub use run::{Reference, ReferenceRun};
