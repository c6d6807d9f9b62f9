//! The font that comes with the program, for text in pictures: they need no fonts of the system.

use std::fmt::Display;
use std::sync::OnceLock;

use plotters::style::{FontStyle, register_font};

/// The family under which plotters knows it.
pub fn family() -> &'static str {
    static REGISTERED: OnceLock<bool> = OnceLock::new();
    const FAMILY: &str = "sans-serif";
    REGISTERED.get_or_init(|| {
        // Ubuntu Light, under the Ubuntu Font Licence.
        register_font(FAMILY, FontStyle::Normal, epaint_default_fonts::UBUNTU_LIGHT).is_ok()
    });
    FAMILY
}

/// What the drawing library could not draw, for want of a font or of room: what that means, and why.
#[derive(Debug, thiserror::Error)]
#[error("{0} ({1})")]
pub struct NotDrawn(&'static str, String);

impl NotDrawn {
    /// Says what a failure of the drawing library means.
    pub fn because<E: Display>(what: &'static str) -> impl Fn(E) -> Self {
        move |error| Self(what, error.to_string())
    }
}
