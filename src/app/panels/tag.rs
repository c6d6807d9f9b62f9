//! The tag of the selected element, beside the point that was clicked: its name and its light. The
//! card tells more, on request.

use egui::{Align2, Rect, RichText, Ui, vec2};

use crate::app::actions::{Action, Outbox};
use crate::app::state::measuring::lux_in_words;
use crate::app::state::settings::LinksOf;
use crate::app::tools::Tools;
use crate::app::view::View;
use crate::app::view::overlays::Place;
use crate::app::widgets::theme;
use crate::app::{Shown, format, words};

/// Width of the tag at most, points.
const MOST_WIDTH: f32 = 230.0;
/// Name of the overlay.
const NAME: &str = "tag";
/// From the point to the tag's corner, points.
const ASIDE: egui::Vec2 = vec2(14.0, 10.0);

/// Draws it; nothing where nothing is selected.
pub fn show(
    ui: &Ui,
    rect: Rect,
    shown: &Shown,
    view: &mut View,
    tools: &mut Tools,
    links_of: LinksOf,
    outbox: &mut Outbox,
) {
    let (Some(picked), Some(facts)) = (&shown.picked, &tools.inspection.facts) else { return };
    let Some(at) = view.viewport.project(picked.point).filter(|at| rect.contains(*at)) else { return };
    // What stands before the point does not bear its numbers.
    let is_seen = view.clusters.is_exploded()
        || shown.info.as_ref().is_none_or(|info| view.viewport.sees(picked.point, &info.occluders));
    let place = match is_seen {
        true => Place {
            name: NAME,
            view: rect,
            align: Align2::LEFT_TOP,
            at: at + ASIDE,
            is_interactable: true,
            is_needed: true,
        },
        false => Place::at_rim(NAME, rect, Align2::RIGHT_TOP),
    };
    let (element, mean) = (picked.element, facts.illuminance());
    let name = tools.inspection.name(element);
    let light = match tools.measuring.at_selection() {
        Some(reading) if tools.measuring.is_stale() => {
            format!("E {} ({})", lux_in_words(&reading), words::EARLIER_PICTURE)
        }
        Some(reading) => format!("E {}", lux_in_words(&reading)),
        None => format!("E {} lx (mean)", format::number(mean.into())),
    };
    view.overlays.card(ui, place, 7, |ui| {
        ui.set_max_width(MOST_WIDTH);
        ui.spacing_mut().item_spacing.y = 2.0;
        ui.add(egui::Label::new(RichText::new(name).strong()).truncate());
        ui.label(theme::value(light)).on_hover_text("Illuminance at the point that was clicked, ± its standard error");
        ui.horizontal(|ui| {
            if ui.small_button(words::DETAILS).on_hover_text("What it is and what lights it").clicked() {
                outbox.act(Action::ShowCard);
            }
            let button = egui::Button::new("Links").small().selected(links_of == LinksOf::Picked);
            if ui.add(button).on_hover_text("Draw the links that bring it light").clicked() {
                outbox.act(Action::ToggleLinks);
            }
        });
    });
}
