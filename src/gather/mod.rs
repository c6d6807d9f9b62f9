//! Light at points: irradiance and its standard error, gathered over a solved radiosity field.
//!
//! What the mesh shows is interpolated between its vertices; light at a point is looked for from the
//! point itself [a final gather over a coarse solution, Lischinski, Tampieri, Greenberg 93]: rays aimed at
//! the emitters, and cosine-distributed rays whose ends are read from the field. What lies nearer than the
//! field is fine is followed further, so that edges, crevices and contacts are right.
//!
//! This module reads a solution, and writes into none.

mod estimator;
mod facet;
mod field;
mod sources;

pub use estimator::{Budget, Depth, Irradiance, Rays};
pub use field::Field;
