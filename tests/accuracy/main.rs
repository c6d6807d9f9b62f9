//! The reference and the solver against closed forms, the solver against the reference, and
//! properties of the reference: the same for any number of threads, never stale, stopped at once.
//! One program, so that it is linked once.

mod closed_forms;
mod coincident;
mod coverage;
#[path = "../support/dice.rs"]
mod dice;
mod mitsuba;
#[path = "../support/mitsuba.rs"]
mod mitsuba_figures;
mod random_rooms;
mod reference;
mod solver_error;
