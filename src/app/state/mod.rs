//! State of the window, without a widget.

pub(in crate::app) mod comparison;
pub(in crate::app) mod device;
pub(in crate::app) mod documents;
pub(in crate::app) mod edits;
pub(in crate::app) mod exports;
pub(in crate::app) mod facts;
pub(in crate::app) mod files;
pub(in crate::app) mod inspection;
pub(in crate::app) mod lighting;
pub(in crate::app) mod measuring;
pub(in crate::app) mod messages;
pub(in crate::app) mod names;
pub(in crate::app) mod picked;
pub(in crate::app) mod pinned;
pub(in crate::app) mod playback;
pub(in crate::app) mod readings;
pub(in crate::app) mod selection;
pub(in crate::app) mod session;
pub(in crate::app) mod settings;
pub(in crate::app) mod time_left;
pub(in crate::app) mod undo;
pub(in crate::app) mod watch;
