//! Geometry: rays and the faces that they leave and meet.
//!
//! [`Occluders`] tell which face a ray meets (`offset` tells how it leaves one), [`orient`] which
//! sides of faces are bright, [`overlaps`] removes faces that lie on each other, [`cuts`] parts
//! large surfaces where walls stand on them, and [`Reachability`] tells which parts of faces light
//! can reach; [`point_to_polygon`] is the form factor from a point. This module imports `base` and
//! `scene` alone.

pub mod cuts;
mod enclosure;
mod lambert;
mod occluders;
mod offset;
pub mod orient;
pub mod overlaps;
mod parts;
mod reachability;
mod wide_bvh;

pub use enclosure::{EnclosureTest, LampList};
pub use lambert::{AboveHorizon, lambert, point_to_polygon};
pub use occluders::{Hit, Occluders};
pub use reachability::{Cells, Reachability, Shares, quarter};
pub use wide_bvh::LastStop;
