//! The tag of the selected element, beside the point that was clicked: its name and its light. The
//! card tells more, on request.

use egui::{Align2, Rect, RichText, Ui, vec2};

use crate::app::state::measuring::lux_in_words;
use crate::app::state::settings::LinksOf;
use crate::app::tools::Tool;
use crate::app::view::overlays::Place;
use crate::app::widgets::theme;
use crate::app::{App, format, words};

/// Width of the tag at most, points.
const MOST_WIDTH: f32 = 230.0;
/// Name of the overlay.
const NAME: &str = "tag";
/// From the point to the tag's corner, points.
const ASIDE: egui::Vec2 = vec2(14.0, 10.0);

/// Draws it; nothing where nothing is selected, or more is shown elsewhere.
pub(in crate::app) fn show(app: &mut App, ui: &Ui, view: Rect) {
    let tells_more = app.layout.is_card_open || app.tools.open == Some(Tool::Inspector);
    let (Some(picked), Some(facts), false) = (&app.picked, &app.tools.inspection.facts, tells_more) else { return };
    let Some(at) = app.view.viewport.project(picked.point).filter(|at| view.contains(*at)) else { return };
    // What stands before the point does not bear its numbers.
    let is_seen = app.view.clusters.is_exploded()
        || app.shown.info.as_ref().is_none_or(|info| app.view.viewport.sees(picked.point, &info.occluders));
    let place = match is_seen {
        true => {
            Place { name: NAME, view, align: Align2::LEFT_TOP, at: at + ASIDE, is_interactable: true, is_needed: true }
        }
        false => Place::at_rim(NAME, view, Align2::RIGHT_TOP),
    };
    let (element, mean) = (picked.element, facts.illuminance());
    let name = app.tools.inspection.name(element);
    let light = match app.tools.measuring.at_selection() {
        Some(reading) if app.tools.measuring.is_stale() => {
            format!("E {} ({})", lux_in_words(&reading), words::EARLIER_PICTURE)
        }
        Some(reading) => format!("E {}", lux_in_words(&reading)),
        None => format!("E {} lx (mean)", format::number(mean.into())),
    };
    let (mut details, mut links) = (false, false);
    app.view.overlays.show(ui.ctx(), place, |ui| {
        let frame = egui::Frame::popup(ui.style()).fill(theme::PANEL.gamma_multiply(0.94)).inner_margin(7);
        frame.show(ui, |ui| {
            ui.set_max_width(MOST_WIDTH);
            ui.spacing_mut().item_spacing.y = 2.0;
            ui.add(egui::Label::new(RichText::new(name).strong()).truncate());
            ui.label(theme::value(light))
                .on_hover_text("Illuminance at the point that was clicked, ± its standard error");
            ui.horizontal(|ui| {
                details = ui.small_button(words::DETAILS).on_hover_text("What it is and what lights it").clicked();
                let are_shown = app.edits.display.links.of == LinksOf::Picked;
                let button = egui::Button::new(words::LINKS).small().selected(are_shown);
                links = ui.add(button).on_hover_text("Draw the links that bring it light").clicked();
            });
        });
    });
    app.layout.is_card_open |= details;
    if links {
        let of = &mut app.edits.display.links.of;
        *of = if *of == LinksOf::Picked { LinksOf::Nothing } else { LinksOf::Picked };
    }
}
