//! Rows that many panels have: labelled widgets, lists, alternatives, levels, sentences.

use egui::{Color32, ComboBox, Label, Response, RichText, Slider, Ui, Widget, WidgetText};

use crate::app::widgets::theme::{self, SLIDER_WIDTH, VALUE_WIDTH};

/// Width of the labels in the left panel, points.
pub const LABEL_WIDTH: f32 = 132.0;
/// Widths between which a slider follows its panel, points.
const LEAST_SLIDER: f32 = 40.0;
const MOST_SLIDER: f32 = 240.0;
/// Room at the right end of a row for the mark of a cost, points.
const MARK_WIDTH: f32 = 18.0;

/// A labelled row of a panel; the label names the widget for assistive technology too. Sliders and
/// lists take the width that there is.
pub fn row(ui: &mut Ui, label: &str, widget: impl FnOnce(&mut Ui) -> Response) -> Response {
    let row = ui.horizontal(|ui| {
        let label = row_label(ui, label);
        let spacing = ui.spacing_mut();
        spacing.interact_size.x = VALUE_WIDTH;
        let between = spacing.item_spacing.x;
        let room = ui.available_width() - MARK_WIDTH;
        let spacing = ui.spacing_mut();
        spacing.slider_width = (room - VALUE_WIDTH - between).clamp(LEAST_SLIDER, MOST_SLIDER);
        spacing.combo_width = room.clamp(LEAST_SLIDER, SLIDER_WIDTH + VALUE_WIDTH + between);
        let widget = widget(ui).labelled_by(label.id);
        (label, widget)
    });
    row.inner.0 | row.inner.1
}

/// A labelled row with a widget of its own kind, and a hint to it.
pub fn widget(ui: &mut Ui, label: &str, widget: impl Widget, hint: &str) -> Response {
    row(ui, label, |ui| ui.add(widget).on_hover_text(hint))
}

/// The label at the left of a row, on several lines where it is long.
pub fn row_label(ui: &mut Ui, label: &str) -> Response {
    let width = LABEL_WIDTH.min(0.45 * ui.available_width());
    let scope = ui.scope(|ui| {
        ui.set_min_width(width);
        ui.set_max_width(width);
        ui.add(Label::new(label).wrap())
    });
    scope.inner
}

/// A row with a list to choose from.
pub fn choice<T: PartialEq, N: Into<WidgetText>>(
    ui: &mut Ui,
    label: &str,
    chosen: &mut T,
    all: impl IntoIterator<Item = T>,
    name: impl Fn(&T) -> N,
) -> Response {
    row(ui, label, |ui| {
        let list = ComboBox::from_id_salt(label).selected_text(name(chosen));
        let choices = |ui: &mut Ui| {
            for one in all {
                let name = name(&one);
                ui.selectable_value(chosen, one, name);
            }
        };
        list.show_ui(ui, choices).response
    })
}

/// Alternatives side by side, each with its name and a hint.
pub fn alternatives<T: Copy + PartialEq>(ui: &mut Ui, chosen: &mut T, all: &[(T, &str, &str)]) {
    for (value, name, hint) in all {
        ui.selectable_value(chosen, *value, *name).on_hover_text(*hint);
    }
}

/// A slider over the levels of a hierarchy; a level that was chosen for a deeper one comes back
/// with it.
pub fn level(ui: &mut Ui, level: &mut u16, deepest: u16) -> Response {
    let mut shown = (*level).min(deepest);
    let slider = Slider::new(&mut shown, 0..=deepest).suffix(format!(" of {deepest}"));
    let response = ui.add_enabled(deepest > 0, slider);
    if response.changed() {
        *level = shown;
    }
    response
}

/// A sentence on as many lines as it takes.
pub fn sentence(ui: &mut Ui, text: impl Into<WidgetText>) -> Response {
    ui.add(Label::new(text).wrap())
}

/// A sentence that a person should not overlook.
pub fn notice(ui: &mut Ui, text: impl Into<String>) -> Response {
    let text = theme::notice(ui, text);
    sentence(ui, text)
}

/// A sentence on what could not be done.
pub fn failure(ui: &mut Ui, text: impl Into<String>) -> Response {
    let text = RichText::new(text).color(ui.visuals().error_fg_color);
    sentence(ui, text)
}

/// The heading of a part of a panel.
pub fn heading(ui: &mut Ui, text: &str) -> Response {
    ui.label(RichText::new(text).strong())
}

/// A dot that says how something stands.
pub fn dot(ui: &mut Ui, room: f32, colour: Color32) {
    let (dot, _) = ui.allocate_exact_size(egui::Vec2::splat(room), egui::Sense::hover());
    ui.painter().circle_filled(dot.center(), 4.0, colour);
}

/// A bar over the view that says something, with buttons at its right.
pub fn bar(ui: &mut Ui, fill: Color32, mark: Color32, say: impl FnOnce(&mut Ui), buttons: impl FnOnce(&mut Ui)) {
    egui::Frame::new().fill(fill).inner_margin(egui::Margin::symmetric(12, 8)).show(ui, |ui| {
        ui.horizontal(|ui| {
            dot(ui, 8.0, mark);
            say(ui);
            ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), buttons);
        });
    });
}
