//! How wide the panels beside the view may be: the view keeps at least half of the window.
//!
//! Where settings and an open tool do not both fit beside it, the one that was asked for last takes
//! the place of the other.

use crate::app::appearance::Appearance;
use crate::app::state::settings::LinksOf;
use crate::app::tools::{Tool, WIDTHS};
use crate::render::Show;

/// The view's share of the window's width.
const VIEW_SHARE: f32 = 0.5;
/// Width that the settings need, points.
pub const LEAST_SETTINGS: f32 = 300.0;

/// Parts of the window that are shown, and how.
pub struct Layout {
    /// Scale, theme.
    pub appearance: Appearance,
    /// Whether the list of keys is open.
    pub are_keys_shown: bool,
    /// Whether panels, bars and dock are hidden.
    pub is_full_picture: bool,
    /// Whether the settings at the left are wanted.
    pub shows_settings: bool,
    /// Width that they take, points; 0 where they are hidden.
    pub settings_width: f32,
    /// Whether the card of the selected element is open.
    pub is_card_open: bool,
    /// Whether the fold of the method's parameters is to be opened.
    pub opens_method: bool,
    /// Display before a study drew the links of a level over the lit scene, while it goes on.
    pub before_study: Option<(LinksOf, Show)>,
}

impl Layout {
    /// As it is at first.
    pub fn new(appearance: Appearance) -> Self {
        Self {
            appearance,
            are_keys_shown: false,
            is_full_picture: false,
            shows_settings: true,
            settings_width: 0.0,
            is_card_open: false,
            opens_method: false,
            before_study: None,
        }
    }

    /// Greatest widths of the panels beside the view while a tool is open, or none.
    pub fn sides(&self, ctx: &egui::Context, tool: Option<Tool>) -> Sides {
        Sides::new(ctx.content_rect().width(), tool, self.shows_settings)
    }

    /// Shows the settings, in place of a tool where both have no room, or hides them.
    pub fn toggle_settings(&mut self, ctx: &egui::Context, tool: &mut Option<Tool>) {
        self.shows_settings = self.sides(ctx, *tool).settings.is_none();
        if self.shows_settings && self.sides(ctx, *tool).settings.is_none() {
            *tool = None;
        }
    }
}

/// Greatest widths of the panels that are shown, points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sides {
    /// The settings at the left.
    pub settings: Option<f32>,
    /// The settings and the tool together.
    pub all: f32,
}

impl Sides {
    fn new(width: f32, tool: Option<Tool>, wants_settings: bool) -> Self {
        let all = (1.0 - VIEW_SHARE) * width;
        let left = if tool.is_some() { all - WIDTHS.start() } else { all };
        let fits = tool.is_none() || left >= LEAST_SETTINGS;
        Self { settings: (wants_settings && fits).then_some(left), all }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Truth: half of the window, by hand.
    #[test]
    fn the_view_keeps_half_of_the_window() {
        let sides = |width, tool| Sides::new(width, tool, true);
        assert_eq!(sides(1280.0, None), Sides { settings: Some(640.0), all: 640.0 });
        assert_eq!(sides(1280.0, Some(Tool::Measure)).settings, Some(300.0));
        assert_eq!(sides(1024.0, Some(Tool::Measure)), Sides { settings: None, all: 512.0 });
        assert_eq!(Sides::new(2000.0, None, false).settings, None);
    }
}
