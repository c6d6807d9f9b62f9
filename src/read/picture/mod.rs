//! Pictures gathered at every pixel: what is seen is known exactly, and its light is gathered
//! there.
//!
//! A picture of the mesh interpolates light between vertices. Here camera rays find what each
//! sample of a pixel sees ([`VisibleSurfaces`]), textures and interpolated normals included; a few
//! rays gather the irradiance of one sample of each pixel over the solved field ([`Light`]), a
//! filter shares what is known between samples of one surface ([`Filter`]), direct light less
//! widely than indirect light, and only then come reflectance, exposure and the mean over a pixel.
//! Passes are repeated where the noise is still above what was asked for; the filter narrows as it
//! falls, so that the picture converges.

mod develop;
mod filter;
mod gathered;
mod labels;
mod lens;
mod lettering;
mod light;
mod sky;
mod visible_surfaces;

pub use develop::{FalseColours, Shading, ground};
pub use filter::{Filter, Share};
pub use gathered::{GatheredPicture, Layers, LayersAt, PixelLight, Start};
pub use labels::{LABEL_RIM, LineLabel};
pub use lens::Lens;
pub use lettering::write_labels;
pub use light::{Light, Tiles};
pub use sky::sky_behind;
pub use visible_surfaces::{VisibleSurface, VisibleSurfaces};
