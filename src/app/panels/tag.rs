//! The tag of the selected element, beside the point that was clicked: its name and its light. The card tells more, on request.

use egui::{Align2, Rect, RichText, Ui, vec2};

use crate::app::state::settings::LinksOf;
use crate::app::tools::Tool;
use crate::app::widgets::theme;
use crate::app::{App, format, words};
use crate::base::photometry::lux;

/// Width of the tag at most, points.
const MOST_WIDTH: f32 = 230.0;
/// From the point to the tag's corner, points.
const ASIDE: egui::Vec2 = vec2(14.0, 10.0);

/// Draws it; nothing where nothing is selected, or more is told elsewhere.
pub(in crate::app) fn show(app: &mut App, ui: &Ui, view: Rect) {
    let tells_more = app.layout.is_card_open || app.tools.open == Some(Tool::Inspector);
    let (Some(picked), Some(facts), false) = (&app.picked, &app.tools.inspection.facts, tells_more) else { return };
    let Some(at) = app.view.viewport.project(picked.point).filter(|at| view.contains(*at)) else { return };
    let name = facts.name();
    let light = match app.tools.measuring.at_selection() {
        Some((irradiance, Some(standard_error))) => {
            format!("E {} lx", format::plus_minus(lux(irradiance.into()).into(), lux(standard_error.into()).into()))
        }
        Some((irradiance, None)) => format!("E {} lx", format::number(lux(irradiance.into()).into())),
        None => format!("E {} lx (mean)", format::number(facts.illuminance().into())),
    };
    let (mut details, mut links) = (false, false);
    let area = egui::Area::new(egui::Id::unique("tag")).pivot(Align2::LEFT_TOP).fixed_pos(at + ASIDE);
    area.constrain_to(view).show(ui.ctx(), |ui| {
        theme::over_the_view(ui);
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
