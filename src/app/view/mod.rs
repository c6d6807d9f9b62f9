//! The picture, and what is drawn and dragged over it.

pub(in crate::app) mod best;
pub(in crate::app) mod camera_menu;
pub(in crate::app) mod cluster_view;
pub(in crate::app) mod colour_bar;
pub(in crate::app) mod divider;
pub(in crate::app) mod gathering;
pub(in crate::app) mod gizmo;
pub(in crate::app) mod highlight;
pub(in crate::app) mod line_labels;
pub(in crate::app) mod marks;
pub(in crate::app) mod measure_marks;
pub(in crate::app) mod metering;
pub(in crate::app) mod paint;
pub(in crate::app) mod viewport;
pub(in crate::app) mod walk;
