//! The solver's thread: commands go in, events and the latest snapshot come out.
//!
//! The window owns no solver state and never waits: bulk results lie in a slot that holds the newest
//! `Arc<Snapshot>`, what must not be lost comes as an [`Event`] on a channel.
