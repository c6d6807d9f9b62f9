//! Colours, spacing and text sizes: one dark theme, so that the picture is the brightest thing in the window.

use egui::{Color32, CornerRadius, FontFamily, FontId, Stroke, TextStyle};

/// What can be acted upon, and what is chosen: the warm white of a lamp.
pub(super) const ACCENT: Color32 = Color32::from_rgb(240, 178, 84);
/// A failure's mark.
pub(super) const ERROR: Color32 = Color32::from_rgb(240, 100, 88);
/// Behind a failure's sentence.
pub(super) const ERROR_FILL: Color32 = Color32::from_rgb(62, 30, 29);
/// Behind a remark.
pub(super) const NOTE_FILL: Color32 = Color32::from_rgb(46, 42, 34);
/// Titles and values.
pub(super) const TEXT_STRONG: Color32 = Color32::from_rgb(236, 237, 240);
/// Running text.
pub(super) const TEXT: Color32 = Color32::from_rgb(204, 207, 213);
/// Units, hints and names of values.
pub(super) const TEXT_WEAK: Color32 = Color32::from_rgb(146, 151, 161);
/// Behind the panels.
pub(super) const PANEL: Color32 = Color32::from_rgb(29, 31, 35);
/// Behind the view while nothing is shown, and inside text fields.
pub(super) const WELL: Color32 = Color32::from_rgb(18, 19, 22);
/// Done.
pub(super) const DONE: Color32 = Color32::from_rgb(112, 190, 128);

/// Width of the left panel, points: a label, a slider, its value and the mark of its cost.
pub(super) const PANEL_WIDTH: f32 = 374.0;
/// Width of the labels in the left panel, points.
pub(super) const LABEL_WIDTH: f32 = 132.0;
const SLIDER_WIDTH: f32 = 96.0;
/// Least width of the value beside a slider, points, so that values stand in a column.
const VALUE_WIDTH: f32 = 84.0;

/// Gives a context this theme.
pub(super) fn apply(ctx: &egui::Context) {
    ctx.set_theme(egui::Theme::Dark);
    ctx.all_styles_mut(|style| {
        let visuals = &mut style.visuals;
        *visuals = egui::Visuals::dark();
        visuals.panel_fill = PANEL;
        visuals.window_fill = PANEL;
        visuals.extreme_bg_color = WELL;
        visuals.faint_bg_color = Color32::from_rgb(34, 36, 41);
        visuals.weak_text_color = Some(TEXT_WEAK);
        visuals.hyperlink_color = ACCENT;
        visuals.selection.bg_fill = Color32::from_rgb(116, 84, 36);
        visuals.selection.stroke = Stroke::new(1.0, TEXT_STRONG);
        visuals.slider_trailing_fill = true;
        visuals.window_corner_radius = CornerRadius::same(6);
        visuals.widgets.noninteractive.fg_stroke.color = TEXT;
        visuals.widgets.noninteractive.bg_stroke = Stroke::new(1.0, Color32::from_rgb(48, 51, 57));
        visuals.widgets.inactive.fg_stroke.color = TEXT;
        visuals.widgets.inactive.bg_fill = Color32::from_rgb(58, 62, 69);
        visuals.widgets.inactive.weak_bg_fill = Color32::from_rgb(48, 51, 58);
        visuals.widgets.hovered.weak_bg_fill = Color32::from_rgb(62, 66, 74);
        for widget in [
            &mut visuals.widgets.noninteractive,
            &mut visuals.widgets.inactive,
            &mut visuals.widgets.hovered,
            &mut visuals.widgets.active,
            &mut visuals.widgets.open,
        ] {
            widget.corner_radius = CornerRadius::same(4);
        }
        style.text_styles = [
            (TextStyle::Small, FontId::new(11.0, FontFamily::Proportional)),
            (TextStyle::Body, FontId::new(13.0, FontFamily::Proportional)),
            (TextStyle::Button, FontId::new(13.0, FontFamily::Proportional)),
            (TextStyle::Heading, FontId::new(16.0, FontFamily::Proportional)),
            (TextStyle::Monospace, FontId::new(12.0, FontFamily::Monospace)),
        ]
        .into();
        let spacing = &mut style.spacing;
        spacing.item_spacing = egui::vec2(8.0, 4.0);
        spacing.button_padding = egui::vec2(8.0, 2.0);
        spacing.interact_size.y = 21.0;
        spacing.slider_width = SLIDER_WIDTH;
        spacing.combo_width = SLIDER_WIDTH + VALUE_WIDTH + 8.0;
        spacing.indent = 12.0;
        spacing.tooltip_width = 320.0;
    });
}

/// A value that changes while one looks: monospace, so that it stays in place.
pub(super) fn value(text: impl Into<String>) -> egui::RichText {
    egui::RichText::new(text).monospace().color(TEXT_STRONG)
}

/// The name of a value.
pub(super) fn weak(text: impl Into<String>) -> egui::RichText {
    egui::RichText::new(text).color(TEXT_WEAK)
}

/// A labelled row of the left panel; the label names the widget for assistive technology too.
pub(super) fn row(
    ui: &mut egui::Ui,
    label: &str,
    widget: impl FnOnce(&mut egui::Ui) -> egui::Response,
) -> egui::Response {
    let row = ui.horizontal(|ui| {
        let label = ui
            .scope(|ui| {
                ui.set_min_width(LABEL_WIDTH);
                ui.set_max_width(LABEL_WIDTH);
                ui.add(egui::Label::new(label).truncate())
            })
            .inner;
        ui.spacing_mut().interact_size.x = VALUE_WIDTH;
        let widget = widget(ui).labelled_by(label.id);
        (label, widget)
    });
    row.inner.0 | row.inner.1
}
