//! What everything else stands on: long work that can be stopped, numbers for people, random ones, memory.

pub mod cancel;
pub mod font;
pub mod format;
pub mod memory;
pub mod photometry;
pub mod random;
pub mod threads;
