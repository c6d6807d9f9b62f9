//! The font that comes with the program, for text in pictures: they need no fonts of the system.

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
