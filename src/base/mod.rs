//! The lowest layer: long work that can be stopped, numbers for people, random numbers, memory,
//! files, reports of panics.

pub mod actor;
pub mod cancel;
pub mod file;
pub mod font;
pub mod format;
pub mod memory;
pub mod mixing;
pub mod panic_report;
pub mod photometry;
pub mod random;
pub mod threads;
