//! Parts that several panels use.

pub(in crate::app) mod dialog;
pub(in crate::app) mod icon;
pub(in crate::app) mod save_dialog;
pub(in crate::app) mod theme;
