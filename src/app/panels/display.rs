//! The display section: readings, exposure and overlays.

use egui::{Slider, Ui};

use crate::app::panels::readings;
use crate::app::state::settings::DisplaySettings;
use crate::app::widgets::{rows, theme};
use crate::app::{Shown, words};
use crate::render::Reading;

/// Exposures a slider offers, stops.
const STOPS: std::ops::RangeInclusive<f32> = -12.0..=12.0;

/// Draws the section.
pub fn show(ui: &mut Ui, shown: &Shown, display: &mut DisplaySettings, reading: Option<&Reading>, metered: f32) {
    show_picture(ui, display);
    readings::show(ui, display, reading, shown.info.as_ref().and_then(|info| info.open_ground.err()));
    ui.add_space(4.0);
    show_exposure(ui, display, metered);
    ui.add_space(4.0);
    ui.checkbox(&mut display.show_elements, words::ELEMENT_OUTLINES);
    show_clusters(ui, shown, display);
    ui.add_space(4.0);
    crate::app::panels::links::show(ui, shown, &mut display.links);
}

/// Shows the choice between a gathered picture and the mesh.
fn show_picture(ui: &mut Ui, display: &mut DisplaySettings) {
    rows::choice(ui, words::PICTURE, &mut display.is_gathered, [true, false], |is_gathered| match is_gathered {
        true => words::GATHERED,
        false => words::MESH,
    })
    .on_hover_text(
        "Gathered: light is looked for at every pixel while the camera stands still and the solution is finished, coarse \
         first. Mesh: light between the vertices, as while the camera moves",
    );
}

fn show_exposure(ui: &mut Ui, display: &mut DisplaySettings, metered: f32) {
    let mut is_locked = !display.auto_exposure;
    let hint =
        "Keeps the exposure while light and view change; otherwise the median of what is seen, lamps aside, is metered";
    if ui.checkbox(&mut is_locked, words::LOCK_EXPOSURE).on_hover_text(hint).changed() {
        if is_locked {
            display.manual_stops = metered.log2() + display.auto_stops;
        }
        display.auto_exposure = !is_locked;
    }
    let (stops, hint) = match display.auto_exposure {
        true => (&mut display.auto_stops, "Correction of the automatic exposure; one stop is a factor of 2"),
        false => (&mut display.manual_stops, "0 stops shows 1 W/m² as white before the tone curve"),
    };
    let slider = Slider::new(stops, STOPS).clamping(egui::SliderClamping::Edits).fixed_decimals(1).suffix(" stops");
    rows::widget(ui, words::EXPOSURE, slider.trailing_fill(false), hint);
}

fn show_clusters(ui: &mut Ui, shown: &Shown, display: &mut DisplaySettings) {
    ui.checkbox(&mut display.show_clusters, words::CLUSTER_BOXES);
    let Some(snapshot) = &shown.snapshot else { return };
    let Some(deepest) = snapshot.clusters.iter().map(|cluster| cluster.level).max() else {
        ui.label(theme::weak("There are no clusters."));
        return;
    };
    ui.add_enabled_ui(display.show_clusters, |ui| {
        rows::row(ui, "Cluster level", |ui| rows::level(ui, &mut display.cluster_level, deepest));
    });
}
