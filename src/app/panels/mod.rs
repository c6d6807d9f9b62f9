//! The panels around the view: each takes what it shows and writes commands into the outbox.

pub mod accuracy;
pub mod appearance;
pub mod controls;
pub mod costs;
pub mod display;
pub mod empty;
pub mod hint;
pub mod legend;
pub mod light;
pub mod links;
pub mod parameters;
pub mod picked;
pub mod quality;
mod readings;
pub mod readout;
pub mod scene;
pub mod statistics;
pub mod status_bar;
pub mod step;
pub mod tag;
