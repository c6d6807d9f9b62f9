//! Tooltip of the block under the mouse.

use egui::{Color32, Grid, RichText, Ui};

use crate::app::tools::matrix::Looked;
use crate::app::view::highlight::{RECEIVER, SOURCE};
use crate::app::widgets::theme;
use crate::app::{format, words};
use crate::hierarchy::ElementId;
use crate::read::matrix::Pair;
use crate::transport::{LinkView, VisibilitySource};

/// Draws it.
pub fn show(ui: &mut Ui, looked: Looked<'_>, pair: &Pair) {
    let name = |id: Option<ElementId>| match id {
        Some(id) => looked.names.full(looked.solution_view, id),
        None => String::new(),
    };
    let (receiver, source) = match &pair.link {
        Some(link) => (Some(link.receiver), Some(link.source)),
        None => (pair.receivers.last().copied(), pair.sources.last().copied()),
    };
    Grid::new("block").num_columns(2).spacing([10.0, 3.0]).show(ui, |ui| {
        for (what, id, [r, g, b, _]) in [("Receiver", receiver, RECEIVER), ("Source", source, SOURCE)] {
            ui.label(RichText::new(what).color(Color32::from_rgb(r, g, b)));
            ui.label(RichText::new(name(id)).strong());
            ui.end_row();
        }
        if let Some(link) = &pair.link {
            let epsilon = looked.solution_view.epsilon_watts();
            for (what, value) in facts(link, epsilon) {
                ui.label(theme::weak(what));
                ui.label(theme::value(value));
                ui.end_row();
            }
        }
    });
    match &pair.link {
        None => ui.label("No link: they face away from each other, or no ray came through."),
        Some(link) if link.receiver == link.source => ui.label("Light that it exchanges within itself."),
        Some(_) => ui.label(theme::weak("Click: select the receiver · Shift-click: the source")),
    };
}

/// Names and values of what a link is.
fn facts(link: &LinkView, epsilon: f64) -> [(&'static str, String); 4] {
    let visibility = match link.visibility_source {
        VisibilitySource::None => format!("{:.2}, {}", link.visibility, words::NOT_TESTED),
        VisibilitySource::Rays(rays) => {
            format!("{:.2} by {}", link.visibility, format::things(rays.into(), "ray", "rays"))
        }
        VisibilitySource::Clear(rays) => format!("{:.2}, all of {rays} rays came through", link.visibility),
        VisibilitySource::Inherited => format!("{:.2}, inherited from the element that holds it", link.visibility),
    };
    let share =
        if epsilon > 0.0 { format::number(f64::from(link.power.max_element()) / epsilon) } else { "–".into() };
    [
        (words::FORM_FACTOR, format::number(link.form_factor.into())),
        ("Visibility V", visibility),
        ("Power B·F·V·A", format::quantity(link.power.element_sum().into(), "W")),
        (words::STRONGEST_CHANNEL, format!("{share} ε")),
    ]
}
