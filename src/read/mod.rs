//! Readings of a solution: values at points and on planes, colours, names, the link matrix,
//! gathered pictures.

pub mod daylight_factor;
pub mod matrix;
pub mod names;
pub mod picture;
pub mod probe;
pub mod ramp;
pub mod survey;
pub mod tone;
