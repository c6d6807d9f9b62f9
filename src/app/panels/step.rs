//! The event of the step of the solve that is in view, in a few words over it: for whoever
//! studies the method.

use egui::{Align2, Rect, Ui};

use crate::app::view::overlays::{Overlays, Place};
use crate::app::widgets::rows;
use crate::app::{Shown, format, words};
use crate::solve::{TimelineStep, TimelineStepKind};

/// Width at most, points.
const WIDTH: f32 = 430.0;

/// Draws it while a former step is in view.
pub fn show(ui: &Ui, view: Rect, shown: &Shown, overlays: &mut Overlays) {
    let in_view = shown.snapshot.as_ref().and_then(|snapshot| snapshot.former_step);
    let Some(step) = in_view.and_then(|step| shown.status.steps.get(step)) else { return };
    let text = in_words(step);
    let at_rim = Place::at_rim("step", view, Align2::CENTER_TOP);
    let place = Place { is_interactable: false, is_needed: false, ..at_rim };
    overlays.note(ui, place, 0.9, [10, 6], |ui| {
        ui.set_max_width(WIDTH.min(view.width() - 40.0).max(80.0));
        rows::sentence(ui, text);
    });
}

fn in_words(step: &TimelineStep) -> String {
    let stats = &step.stats;
    let links = format::things(stats.all_links(), "link", "links");
    match step.kind {
        TimelineStepKind::Start => words::STEP_SELF_LINK.to_owned(),
        TimelineStepKind::Wave => format!(
            "Wave {}: each link that carries more power than ε gave way to links with the parts of its larger end. There are {links} between clusters and {}.",
            stats.wave,
            format::things(stats.patches, "patch", "patches")
        ),
        TimelineStepKind::Round => format!(
            "Iteration {}: light went over all {links}; it is handed up and down the clusters until nothing changes, and then links are tested again with it.",
            stats.iterations
        ),
        TimelineStepKind::Pass => "Final gather: rays look for light from the surfaces themselves; what they meet is as bright as the links have lit it.".to_owned(),
    }
}
