//! State of the window, without a widget.

pub mod comparison;
pub mod device;
pub mod documents;
pub mod edits;
pub mod exports;
pub mod facts;
pub mod files;
pub mod inspection;
pub mod lighting;
pub mod measuring;
pub mod messages;
pub mod names;
pub mod picked;
pub mod pinned;
pub mod playback;
pub mod readings;
pub mod selection;
pub mod session;
pub mod settings;
pub mod time_left;
pub mod undo;
pub mod watch;
