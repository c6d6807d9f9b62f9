//! The panels around the view: each takes what it shows and writes commands into the outbox.

pub(in crate::app) mod accuracy;
pub(in crate::app) mod appearance;
pub(in crate::app) mod controls;
pub(in crate::app) mod costs;
pub(in crate::app) mod display;
pub(in crate::app) mod empty;
pub(in crate::app) mod hint;
pub(in crate::app) mod legend;
pub(in crate::app) mod light;
pub(in crate::app) mod links;
pub(in crate::app) mod parameters;
pub(in crate::app) mod picked;
pub(in crate::app) mod quality;
mod readings;
pub(in crate::app) mod readout;
pub(in crate::app) mod scene;
pub(in crate::app) mod statistics;
pub(in crate::app) mod status_bar;
pub(in crate::app) mod step;
pub(in crate::app) mod tag;
