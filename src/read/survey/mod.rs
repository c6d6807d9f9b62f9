//! Survey: a solution read at places that a person chooses, on surfaces and in the air.
//!
//! [`LitMesh`] finds what a ray meets in a snapshot and what light is there. [`WorkPlane`] measures
//! the irradiance of a level plane in the air, where no surface is: each point of a grid asks the
//! gather, or looks around itself for the radiosity of what it sees. The [`Surveyor`] does both on
//! a thread beside a window.

mod csv;
mod floor;
mod grid;
mod lit_mesh;
mod plane;
mod surveyor;

pub use csv::{NamedReading, write_plane, write_probes};
pub use floor::{Floor, floor};
pub use grid::{Grid, GridError, MOST_POINTS, WorkPlane};
pub use lit_mesh::{LitMesh, SurfaceReading};
pub use plane::{Measuring, PlaneReading, Summary, measure};
pub use surveyor::{Looked, Probed, Ray, Report, Surveyor};
