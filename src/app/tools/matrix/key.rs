//! Meaning of the colours of the matrix, and its numbers.

use egui::{Align2, Color32, FontId, Sense, Stroke, StrokeKind, Ui, pos2, vec2};

use crate::app::format;
use crate::app::tools::matrix::LinkMatrix;
use crate::app::view::colour_bar;
use crate::app::widgets::{rows, theme};
use crate::read::matrix::{EMPTY, Legend, Palette, View};

/// Size of the ramp, points.
const RAMP: egui::Vec2 = vec2(200.0, 11.0);
/// Side of the square of a colour of its own, points.
const SWATCH: f32 = 11.0;

impl LinkMatrix {
    /// Draws key and numbers of the last picture.
    pub fn show_key(&mut self, ui: &mut Ui) {
        let Some(shown) = &self.shown else { return };
        ui.add_space(4.0);
        rows::sentence(ui, theme::weak(&shown.legend.title));
        ui.horizontal_wrapped(|ui| {
            if !shown.legend.ticks.is_empty() {
                ramp(ui, &shown.palette, &shown.legend);
            }
            for entry in &shown.legend.entries {
                let [r, g, b] = entry.colour;
                swatch(ui, Color32::from_rgb(r, g, b), entry.colour == EMPTY, entry.name);
            }
        });
        let facts = shown.facts;
        ui.horizontal_wrapped(|ui| {
            let links = format::things(facts.links, "link", "links");
            ui.label(theme::value(links)).on_hover_text("Blocks of the matrix, links to test among them");
            ui.label(theme::weak("·"));
            let empty = format!("{:.0} % empty", 100.0 * (1.0 - facts.covered));
            let hint = "Share of the square where no link is: these pairs face away from each other or nothing is seen";
            ui.label(theme::value(empty)).on_hover_text(hint);
            let hint = "Show the whole matrix again (double-click or Home); the wheel zooms, a drag moves";
            let label = format!("Show all (×{})", format::number(self.view.size.recip()));
            if !self.view.is_whole() && ui.button(label).on_hover_text(hint).clicked() {
                self.view = View::WHOLE;
            }
        });
    }
}

/// The ramp with its ticks below.
fn ramp(ui: &mut Ui, palette: &Palette, legend: &Legend) {
    let (rect, _) = ui.allocate_exact_size(RAMP + vec2(0.0, 16.0), Sense::hover());
    let bar = egui::Rect::from_min_size(rect.min, RAMP);
    ui.painter().add(colour_bar::shape(bar, |along| palette.along(along)));
    let last = (legend.ticks.len() - 1).max(1);
    for (number, tick) in legend.ticks.iter().enumerate() {
        let align = match number {
            0 => Align2::LEFT_TOP,
            number if number == last => Align2::RIGHT_TOP,
            _ => Align2::CENTER_TOP,
        };
        let x = bar.left() + bar.width() * number as f32 / last as f32;
        ui.painter().text(
            pos2(x, bar.bottom() + 2.0),
            align,
            tick,
            FontId::proportional(11.0),
            ui.visuals().text_color(),
        );
    }
}

/// A colour and its meaning.
fn swatch(ui: &mut Ui, colour: Color32, is_empty: bool, name: &str) {
    ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = 4.0;
        let (rect, _) = ui.allocate_exact_size(vec2(SWATCH, SWATCH), Sense::hover());
        ui.painter().rect_filled(rect, 2.0, colour);
        if is_empty {
            ui.painter().rect_stroke(rect, 2.0, Stroke::new(1.0, theme::TEXT_WEAK), StrokeKind::Inside);
        }
        ui.label(egui::RichText::new(name).size(12.0));
    });
}
