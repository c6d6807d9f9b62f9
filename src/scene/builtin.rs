//! Our own scenes.
