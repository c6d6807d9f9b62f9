//! The program as a person runs it: commands, files written, and one sentence for what cannot be
//! done.

mod export;
#[path = "../support/folder.rs"]
mod folder;
mod input;
#[cfg(feature = "gui")]
#[path = "../support/left_out.rs"]
mod left_out;
mod log;
mod man;
mod memory;
mod no_graphics;
mod pictures;
mod readings;
mod selftest;
mod solving;
mod support;
mod truth;
