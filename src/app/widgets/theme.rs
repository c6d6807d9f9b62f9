//! Colours, spacing and text sizes of the dark and the light theme.
//!
//! Everything over the view is dark in either, so that the picture is the brightest thing there: it
//! uses the constants below, or [`over_the_view`]. Panels take their colours from egui's style, or
//! from [`palette`].

use egui::{Color32, CornerRadius, FontFamily, FontId, Stroke, Style, TextStyle, Theme, Ui, Visuals};

/// The colours of a theme.
pub struct Palette {
    /// Text that can be acted upon.
    pub accent: Color32,
    error: Color32,
    /// Behind a failure's sentence.
    pub error_fill: Color32,
    /// Behind a remark.
    pub note_fill: Color32,
    /// Titles and values.
    pub text_strong: Color32,
    text: Color32,
    /// Units, hints and names of values.
    pub text_weak: Color32,
    panel: Color32,
    /// Behind every other row of a table.
    stripe: Color32,
    /// Inside text fields.
    well: Color32,
    selection: Color32,
    rule: Color32,
    /// Fills of what can be clicked: sliders, buttons, and buttons under the pointer.
    buttons: [Color32; 3],
}

const DARK: Palette = Palette {
    accent: ACCENT,
    error: ERROR,
    error_fill: Color32::from_rgb(62, 30, 29),
    note_fill: Color32::from_rgb(46, 42, 34),
    text_strong: TEXT_STRONG,
    text: TEXT,
    text_weak: TEXT_WEAK,
    panel: PANEL,
    stripe: Color32::from_rgb(34, 36, 41),
    well: WELL,
    selection: Color32::from_rgb(116, 84, 36),
    rule: Color32::from_rgb(48, 51, 57),
    buttons: [Color32::from_rgb(58, 62, 69), Color32::from_rgb(48, 51, 58), Color32::from_rgb(62, 66, 74)],
};

/// Text has a contrast of 4.5 or more to what is behind it.
const LIGHT: Palette = Palette {
    accent: Color32::from_rgb(146, 84, 0),
    error: Color32::from_rgb(176, 32, 22),
    error_fill: Color32::from_rgb(250, 222, 218),
    note_fill: Color32::from_rgb(250, 240, 218),
    text_strong: Color32::from_rgb(20, 22, 26),
    text: Color32::from_rgb(52, 55, 61),
    text_weak: Color32::from_rgb(96, 101, 110),
    panel: Color32::from_rgb(245, 245, 243),
    stripe: Color32::from_rgb(235, 235, 232),
    well: Color32::from_rgb(255, 255, 255),
    selection: Color32::from_rgb(250, 214, 150),
    rule: Color32::from_rgb(212, 212, 208),
    buttons: [Color32::from_rgb(208, 208, 204), Color32::from_rgb(226, 226, 222), Color32::from_rgb(212, 212, 208)],
};

/// Colour of all that can be acted upon, and of what is chosen: the warm white of a lamp.
pub const ACCENT: Color32 = Color32::from_rgb(240, 178, 84);
/// A failure's mark.
pub const ERROR: Color32 = Color32::from_rgb(240, 100, 88);
/// Titles and values over the view.
pub const TEXT_STRONG: Color32 = Color32::from_rgb(236, 237, 240);
/// Running text over the view.
pub const TEXT: Color32 = Color32::from_rgb(204, 207, 213);
/// Units, hints and names of values over the view.
pub const TEXT_WEAK: Color32 = Color32::from_rgb(146, 151, 161);
/// Behind cards over the view.
pub const PANEL: Color32 = Color32::from_rgb(29, 31, 35);
/// Behind the view while nothing is shown.
pub const WELL: Color32 = Color32::from_rgb(18, 19, 22);
/// Done.
pub const DONE: Color32 = Color32::from_rgb(112, 190, 128);

/// Width of the left panel, points: a label, a slider, its value and the mark of its cost.
pub const PANEL_WIDTH: f32 = 374.0;
/// Width of a slider at first, points.
pub const SLIDER_WIDTH: f32 = 96.0;
/// Least width of the value beside a slider, points, so that values stand in a column.
pub const VALUE_WIDTH: f32 = 84.0;

/// Gives a context both themes.
pub fn apply(ctx: &egui::Context) {
    ctx.style_mut_of(Theme::Dark, |style| style_with(style, Visuals::dark(), &DARK));
    ctx.style_mut_of(Theme::Light, |style| style_with(style, Visuals::light(), &LIGHT));
}

/// The colours that are in force.
pub fn palette(visuals: &Visuals) -> &'static Palette {
    if visuals.dark_mode { &DARK } else { &LIGHT }
}

/// Gives what is drawn over the view the dark theme.
pub fn over_the_view(ui: &mut Ui) {
    let dark = ui.ctx().style_of(Theme::Dark);
    ui.set_style(dark);
}

fn style_with(style: &mut Style, base: Visuals, palette: &Palette) {
    style.visuals = base;
    let visuals = &mut style.visuals;
    visuals.panel_fill = palette.panel;
    visuals.window_fill = palette.panel;
    visuals.extreme_bg_color = palette.well;
    visuals.faint_bg_color = palette.stripe;
    visuals.weak_text_color = Some(palette.text_weak);
    visuals.hyperlink_color = palette.accent;
    visuals.selection.bg_fill = palette.selection;
    visuals.selection.stroke = Stroke::new(1.0, palette.text_strong);
    visuals.error_fg_color = palette.error;
    visuals.slider_trailing_fill = true;
    visuals.window_corner_radius = CornerRadius::same(6);
    let widgets = &mut visuals.widgets;
    widgets.noninteractive.fg_stroke.color = palette.text;
    widgets.noninteractive.bg_stroke = Stroke::new(1.0, palette.rule);
    widgets.inactive.fg_stroke.color = palette.text;
    [widgets.inactive.bg_fill, widgets.inactive.weak_bg_fill, widgets.hovered.weak_bg_fill] = palette.buttons;
    // Strong text has this colour too.
    widgets.active.fg_stroke.color = palette.text_strong;
    for widget in [
        &mut widgets.noninteractive,
        &mut widgets.inactive,
        &mut widgets.hovered,
        &mut widgets.active,
        &mut widgets.open,
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
}

/// A value that changes while one looks: monospace, so that it stays in place.
pub fn value(text: impl Into<String>) -> egui::RichText {
    egui::RichText::new(text).monospace().strong()
}

/// The name of a value.
pub fn weak(text: impl Into<String>) -> egui::RichText {
    egui::RichText::new(text).weak()
}

/// Text that a person should not overlook.
pub fn notice(ui: &Ui, text: impl Into<String>) -> egui::RichText {
    egui::RichText::new(text).color(palette(ui.visuals()).accent)
}

/// A colour that the renderer uses, gamma-encoded.
pub fn rgb([r, g, b]: [u8; 3]) -> Color32 {
    Color32::from_rgb(r, g, b)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Truth: the contrast ratio of WCAG 2.1, 4.5 for text.
    #[test]
    fn text_can_be_read_in_either_theme() {
        let luminance = |colour: Color32| {
            let [r, g, b, _] = egui::Rgba::from(colour).to_array();
            0.2126 * r + 0.7152 * g + 0.0722 * b
        };
        let contrast = |one: Color32, other: Color32| {
            let (one, other) = (luminance(one), luminance(other));
            (one.max(other) + 0.05) / (one.min(other) + 0.05)
        };
        for (name, palette) in [("dark", &DARK), ("light", &LIGHT)] {
            let texts = [palette.accent, palette.text_strong, palette.text, palette.text_weak, palette.error];
            for (number, text) in texts.into_iter().enumerate() {
                for behind in [palette.panel, palette.stripe, palette.well] {
                    let contrast = contrast(text, behind);
                    assert!(contrast >= 4.5, "{name}: text {number} on {behind:?}: {contrast}");
                }
            }
            for behind in [palette.error_fill, palette.note_fill, palette.selection] {
                assert!(contrast(palette.text_strong, behind) >= 4.5, "{name}: {behind:?}");
            }
        }
    }
}
