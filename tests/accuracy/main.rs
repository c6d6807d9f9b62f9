//! The reference and the solver against closed forms, and the solver against the reference. One program, so that the
//! modules share their scenes.

mod closed_forms;
