//! Pictures gathered at every pixel: what is seen is known exactly, and its light is gathered there.
//!
//! A picture of the mesh interpolates light between vertices. Here camera rays find what each sample of
//! a pixel sees ([`Sights`]), a few rays gather its irradiance over the solved field ([`Light`]), a
//! filter shares what is known between samples of one surface ([`Filter`]), and only then come
//! reflectance, exposure and the mean over a pixel. Passes are repeated until the noise is below what
//! was asked for; the filter narrows as it falls, so that the picture converges.
//!
//! Imports `gather`, `scene`, `hierarchy`, `photometry` and `tone`; knows neither windows nor graphics
//! adapters.

mod develop;
mod filter;
mod gathered;
mod lens;
mod light;
mod sights;

pub use develop::{FalseColours, Shading};
pub use filter::{Filter, Share};
pub use gathered::{GatheredPicture, Layers, LayersAt, PixelLight, Start};
pub use lens::Lens;
pub use light::Light;
pub use sights::{Sight, Sights};
