//! The program as a person runs it: commands, files written, and one sentence for what cannot be done.

mod doctor;
mod export;
mod input;
mod memory;
mod no_graphics;
mod pictures;
mod readings;
mod solving;
mod support;
mod truth;
