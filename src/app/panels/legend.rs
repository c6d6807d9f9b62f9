//! The legend over the view where colours stand for something: a ramp with marks below it.

use egui::{Align2, Color32, FontId, Label, Rect, RichText, Ui, UiBuilder, pos2, vec2};

use crate::app::state::comparison::{FULL_SCALE, Shading};
use crate::app::tools::Tools;
use crate::app::view::overlays::{Overlays, Place};
use crate::app::view::{View, colour_bar};
use crate::app::widgets::theme;
use crate::base::photometry::{CONVENTION, ShownIn, Unit};
use crate::render::{Mark, Reading, ReadingSettings};

/// Size of the bar, points.
const BAR: egui::Vec2 = vec2(264.0, 12.0);
/// Height of the row of labels, points.
const LABELS: f32 = 22.0;
/// Least room between two labels, points.
const GAP: f32 = 5.0;

/// Content of a legend.
struct Legend<'a> {
    title: String,
    remark: &'a str,
    hint: &'a str,
    colour: &'a dyn Fn(f32) -> [u8; 3],
    marks: Vec<Mark>,
}

/// Shows the meaning of the surfaces' colours, where they have one.
pub fn show_meaning(ui: &Ui, rect: Rect, view: &mut View, tools: &Tools, settings: &ReadingSettings) {
    let overlays = &mut view.overlays;
    if tools.pinned.painted().is_some() {
        show_difference(overlays, ui, rect);
    } else if tools.comparison.error().is_some() && tools.comparison.shading != Shading::Lit {
        show_error(overlays, ui, rect, tools.comparison.shading);
    } else if let Some(reading) = view.reading.last() {
        let remark = match (reading.fills, settings.range) {
            (false, _) => "lines",
            (true, Some(_)) => "locked range",
            (true, None) => "",
        };
        show_reading(overlays, ui, rect, &reading, remark);
    } else if let Some(reading) = tools.measuring.plane_scale(None).filter(|_| tools.measuring.shows_points) {
        let reading = Reading { shown_in: ShownIn::Unit(settings.unit), ..reading };
        show_reading(overlays, ui, rect, &reading, "work plane");
    }
}

/// The legend of the difference between two solutions.
fn show_difference(overlays: &mut Overlays, ui: &Ui, view: Rect) {
    let hint = "Difference of the radiosities, relative to that of A at the same point";
    show_shading(overlays, ui, view, Shading::Difference, ("B darker – brighter", hint));
}

/// The legend of errors; nothing for light.
fn show_error(overlays: &mut Overlays, ui: &Ui, view: Rect, shading: Shading) {
    let title = match shading {
        Shading::Lit => return,
        Shading::Error => "relative error",
        Shading::Difference => "too dark – too bright",
    };
    let hint = "Error of the radiosity by the reference, relative to each point's own radiosity";
    show_shading(overlays, ui, view, shading, (title, hint));
}

fn show_shading(overlays: &mut Overlays, ui: &Ui, view: Rect, shading: Shading, (title, hint): (&str, &str)) {
    let (first, labels) = match shading {
        Shading::Lit | Shading::Error => (0.0, ["0 %", "25 %", "50 %"]),
        Shading::Difference => (-FULL_SCALE, ["−50 %", "0 %", "+50 %"]),
    };
    let colour = |along: f32| shading.colour(first + along * (FULL_SCALE - first));
    let places = [0.0, 0.5, 1.0];
    let marks = places.into_iter().zip(labels);
    let marks = marks.map(|(along, label)| Mark { along, label: label.to_owned(), is_line: false }).collect();
    show(
        overlays,
        ui,
        view,
        &Legend { title: title.to_owned(), remark: "grey: unknown", hint, colour: &colour, marks },
    );
}

/// The legend of a quantity.
fn show_reading(overlays: &mut Overlays, ui: &Ui, view: Rect, reading: &Reading, remark: &str) {
    let colour = |along: f32| reading.scale.ramp.at(along);
    let hint = match reading.shown_in {
        ShownIn::Unit(Unit::Lumens) => CONVENTION,
        ShownIn::DaylightFactor { .. } => {
            "Illuminance over that of open horizontal ground under the same sky, % (EN 17037)"
        }
        ShownIn::Unit(Unit::Watts) => "The three colours weighed as the eye does: 0.2126 R + 0.7152 G + 0.0722 B",
    };
    let marks = reading.marks();
    show(overlays, ui, view, &Legend { title: reading.title(), remark, hint, colour: &colour, marks });
}

/// Draws a legend into the view's lower left corner.
fn show(overlays: &mut Overlays, ui: &Ui, view: Rect, legend: &Legend<'_>) {
    let place = Place { is_needed: false, ..Place::at_rim("legend", view, Align2::LEFT_BOTTOM) };
    overlays.card(ui, place, egui::Margin::symmetric(26, 7), |ui| {
        ui.set_width(BAR.x);
        ui.spacing_mut().item_spacing.y = 3.0;
        ui.horizontal(|ui| {
            ui.label(RichText::new(&legend.title).color(theme::TEXT_STRONG)).on_hover_text(legend.hint);
            ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
                ui.label(theme::weak(legend.remark).small());
            });
        });
        let (bar, response) = ui.allocate_exact_size(BAR, egui::Sense::hover());
        response.on_hover_text(legend.hint);
        ui.painter().add(colour_bar::shape(bar, legend.colour));
        let (row, _) = ui.allocate_exact_size(vec2(BAR.x, LABELS), egui::Sense::hover());
        draw_labels(ui, row, bar, &legend.marks);
    });
}

/// Marks and their values; a value that has no room is left out, those at the ends and of lines
/// last.
fn draw_labels(ui: &mut Ui, row: Rect, bar: Rect, marks: &[Mark]) {
    let place = |along: f32| bar.left() + along.clamp(0.0, 1.0) * bar.width();
    let font = FontId::proportional(12.0);
    let mut taken: Vec<(f32, f32)> = Vec::new();
    let matters = |(index, mark): &(usize, &Mark)| (!mark.is_line, *index != 0 && index + 1 != marks.len());
    let mut order: Vec<(usize, &Mark)> = marks.iter().enumerate().collect();
    order.sort_by_key(matters);
    for (_, mark) in order {
        let x = place(mark.along);
        let (top, colour) = if mark.is_line { (bar.top(), Color32::WHITE) } else { (bar.bottom(), theme::TEXT_WEAK) };
        ui.painter().vline(x, top..=bar.bottom() + 4.0, egui::Stroke::new(1.0, colour));
        let width = ui.ctx().fonts_mut(|fonts| mark.label.chars().map(|c| fonts.glyph_width(&font, c)).sum::<f32>());
        let (from, to) = (x - 0.5 * width - GAP, x + 0.5 * width + GAP);
        if taken.iter().any(|(left, right)| from < *right && to > *left) {
            continue;
        }
        taken.push((from + GAP, to - GAP));
        let rect = Rect::from_center_size(pos2(x, row.bottom() - 8.0), vec2(width + 2.0 * GAP, 14.0));
        let text = RichText::new(&mark.label).font(font.clone()).color(theme::TEXT);
        let mut place = ui.new_child(
            UiBuilder::new().max_rect(rect).layout(egui::Layout::centered_and_justified(egui::Direction::TopDown)),
        );
        place.add(Label::new(text).extend());
    }
}
