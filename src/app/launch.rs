//! Opening the window, and advice where there can be none.

use std::cell::Cell;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::rc::Rc;

use super::App;
use crate::export::settings::Settings;

/// Size of the window when it is opened for the first time, points.
const FIRST_SIZE: [f32; 2] = [1280.0, 800.0];
/// Below this, panels would crowd out the view, points.
const LEAST_SIZE: [f32; 2] = [860.0, 540.0];

/// Why there is no window.
#[derive(Debug, thiserror::Error)]
pub enum AppError {
    /// Neither X11 nor Wayland answers, or a library of theirs is missing.
    #[error(
        "no window can be opened, {reason}: start the program from a desktop session (Debian and Ubuntu may lack libxkbcommon-x11-0), or use `selflink solve` and `selflink render`"
    )]
    NoDisplay {
        /// What is missing.
        reason: String,
    },
    /// No graphics adapter draws to the display.
    #[error(
        "no window can be opened, no graphics adapter draws to this display: install a graphics driver or software rendering (Debian and Ubuntu: apt install mesa-vulkan-drivers), or use `selflink solve`"
    )]
    NoDevice,
    /// The system gives no further thread.
    #[error("the solver's thread cannot be started ({0}): close other programs and try again")]
    NoThread(#[from] std::io::Error),
}

/// Opens the window with these settings and returns when it is closed; one that `resumes` goes on as it was left, where it was
/// open before.
///
/// # Errors
/// There is no display, no adapter, or a library of the window system is missing; each with advice in one sentence.
pub fn run(settings: Settings, resumes: bool) -> Result<(), AppError> {
    let options = eframe::NativeOptions {
        viewport: egui::ViewportBuilder::default()
            .with_title("Selflink")
            .with_app_id("selflink")
            .with_inner_size(FIRST_SIZE)
            .with_min_inner_size(LEAST_SIZE)
            .with_drag_and_drop(true),
        renderer: eframe::Renderer::Wgpu,
        ..eframe::NativeOptions::default()
    };
    let is_open = Rc::new(Cell::new(false));
    let creator_is_open = is_open.clone();
    let outcome = catch_unwind(AssertUnwindSafe(|| {
        eframe::run_native(
            "selflink",
            options,
            Box::new(move |cc| {
                let app = if resumes { App::resume(cc, &settings)? } else { App::open(cc, &settings)? };
                creator_is_open.set(true);
                Ok(Box::new(app))
            }),
        )
    }));
    match outcome {
        Ok(Ok(())) => Ok(()),
        Ok(Err(error)) => Err(advice(error)),
        // winit panics where a library of the window system is missing; a panic of the open window is a fault of ours.
        Err(panic) if is_open.get() => resume_unwind(panic),
        Err(panic) => {
            let text = panic.downcast_ref::<String>().map(String::as_str);
            let text = text.or_else(|| panic.downcast_ref::<&str>().copied());
            Err(AppError::NoDisplay { reason: text.unwrap_or("the window system broke off").to_owned() })
        }
    }
}

/// What a person can do about it.
fn advice(error: eframe::Error) -> AppError {
    match error {
        eframe::Error::AppCreation(error) => match error.downcast::<AppError>() {
            Ok(error) => *error,
            Err(error) => AppError::NoDisplay { reason: error.to_string() },
        },
        eframe::Error::Wgpu(_) => AppError::NoDevice,
        eframe::Error::Winit(_) | eframe::Error::WinitEventLoop(_) => {
            AppError::NoDisplay { reason: "no display answers".to_owned() }
        }
    }
}
