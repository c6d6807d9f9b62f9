//! Where methods of this family fail: every row of `selflink selftest` as a test of its own, random
//! scenes against invariants, and that the list of limits says what is known.

mod closed_rooms;
#[path = "../support/coverage.rs"]
mod coverage;
mod random_scenes;
mod rows;
