//! The solver and its hierarchy against truths that do not depend on them: closed forms,
//! conservation, symmetry, bookkeeping. One program, so that the modules share [`support`].

mod balance;
mod closed_forms;
mod coarsening;
mod coincidence;
#[path = "../support/coverage.rs"]
mod coverage;
mod daylight;
mod display_mesh;
mod edges;
mod final_gather;
mod furnace;
mod hierarchy;
mod invariants;
mod live_edits;
mod memory;
mod reachability;
mod support;
