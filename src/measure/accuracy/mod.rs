//! How far a solution is from the truth: closed forms, and the error against a path-traced
//! [`Reference`](crate::measure::reference::Reference).
//!
//! [`closed_forms`] holds the formulas, [`cases`] makes scenes of them that the reference and the
//! solver are put to, and [`ErrorMeter`] measures a snapshot against a reference.

pub mod cases;
mod checks;
pub mod closed_forms;
mod contrast;
mod error;
mod field;
mod local_error;
mod locate;
mod spread;

pub use checks::{Measured, by_reference, by_solver};
pub use contrast::{Contrast, contrast};
pub use error::{ErrorMeter, Measure, SolutionError, of_standard_errors};
pub use field::ScatteredField;
pub use local_error::{Compared, LocalError};
