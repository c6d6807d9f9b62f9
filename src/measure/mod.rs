//! How right, and how fast: a reference, errors against it, charts, the paper run again, places
//! where methods fail.

pub mod accuracy;
pub mod chart;
pub mod records;
pub mod reference;
pub mod reference_worker;
pub mod stability;
pub mod tables;
