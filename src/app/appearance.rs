//! How the window looks to a person: theme, UI scale, and whether the first hint was
//! read. Kept between runs.

use egui::{Context, ThemePreference};
use serde::{Deserialize, Serialize};

use crate::app::widgets::theme;

/// Key under which the storage keeps it.
const KEY: &str = "appearance";
/// Sizes that a person may choose, as factors.
pub const SCALES: std::ops::RangeInclusive<f32> = 0.5..=3.0;
/// A screen of so many points in height is a 4K one that the system does not scale.
const TALL_SCREEN: f32 = 1900.0;
/// The UI scale on it at first.
const TALL_SCREEN_SCALE: f32 = 2.0;

/// Appearance that a person chose.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Appearance {
    /// Dark, light or as the system has it.
    pub theme: ThemePreference,
    /// The UI scale; `None` until one was chosen.
    pub scale: Option<f32>,
    /// Whether the three lines of the first start are over the view.
    pub is_hint_shown: bool,
}

impl Default for Appearance {
    fn default() -> Self {
        Self { theme: ThemePreference::Dark, scale: None, is_hint_shown: false }
    }
}

impl Appearance {
    /// Puts the appearance that was kept into force.
    pub fn restore(ctx: &Context, storage: Option<&dyn eframe::Storage>) -> Self {
        let appearance: Self = storage.and_then(|storage| eframe::get_value(storage, KEY)).unwrap_or_default();
        theme::apply(ctx);
        ctx.set_theme(appearance.theme);
        if let Some(scale) = appearance.scale.filter(|scale| SCALES.contains(scale)) {
            ctx.set_zoom_factor(scale);
        }
        appearance
    }

    /// Takes up what the keys changed (Ctrl with plus, minus and zero), and makes everything larger
    /// where a large screen asks for it.
    pub fn follow(&mut self, ctx: &Context) {
        let scale = ctx.zoom_factor();
        let screen = ctx.input(|input| input.viewport().monitor_size);
        match self.scale {
            None if screen.is_some_and(|screen| screen.y * scale > TALL_SCREEN) && ctx.pixels_per_point() <= 1.0 => {
                ctx.set_zoom_factor(TALL_SCREEN_SCALE);
                self.scale = Some(TALL_SCREEN_SCALE);
            }
            None if scale != 1.0 => self.scale = Some(scale),
            None => {}
            Some(_) => self.scale = Some(scale),
        }
    }

    /// Keeps it.
    pub fn keep(&self, storage: &mut dyn eframe::Storage) {
        eframe::set_value(storage, KEY, self);
    }
}
