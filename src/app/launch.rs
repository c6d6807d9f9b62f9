//! Opening the window, and advice where there can be none.

use std::cell::Cell;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::rc::Rc;

use super::App;
use super::device::{Legacy, Will};
use crate::export::settings::Settings;
use crate::threads::lock;

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
    /// The driver loses one device after the other.
    #[error(
        "the window is closed, the graphics device was lost again and again ({reason}): update the graphics driver, or use `selflink solve`, which needs none"
    )]
    LostDevice {
        /// In the driver's words.
        reason: String,
    },
    /// The system gives no further thread.
    #[error("the solver's thread cannot be started ({0}): close other programs and try again")]
    NoThread(#[from] std::io::Error),
}

/// Windows that may lose their device one after the other before it is given up.
const MOST_LOSSES: usize = 3;

/// Opens the window with these settings and returns when it is closed; one that `resumes` goes on as it was left, where it was
/// open before. A window that loses its graphics device is replaced by another one.
///
/// # Errors
/// There is no display, no adapter, or a library of the window system is missing; or devices are lost again and again; each with
/// advice in one sentence.
pub fn run(settings: Settings, resumes: bool) -> Result<(), AppError> {
    let mut legacy: Option<Legacy> = None;
    for _ in 0..=MOST_LOSSES {
        let opening = match legacy {
            Some(legacy) => Opening::Succeed(legacy),
            None if resumes => Opening::Resume(settings.clone()),
            None => Opening::Open(settings.clone()),
        };
        legacy = run_once(opening)?;
        if legacy.is_none() {
            return Ok(());
        }
    }
    Err(AppError::LostDevice { reason: legacy.map(|legacy| legacy.reason).unwrap_or_default() })
}

/// How a window begins.
enum Opening {
    Open(Settings),
    Resume(Settings),
    Succeed(Legacy),
}

impl Opening {
    fn app(&self, cc: &eframe::CreationContext<'_>) -> Result<App, AppError> {
        match self {
            Self::Open(settings) => App::open(cc, settings),
            Self::Resume(settings) => App::resume(cc, settings),
            Self::Succeed(legacy) => App::succeed(cc, legacy),
        }
    }
}

/// Opens one window and returns when it is closed, with what it hands over where it lost its device.
fn run_once(opening: Opening) -> Result<Option<Legacy>, AppError> {
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
    let will = Will::default();
    let of_window = will.clone();
    let outcome = catch_unwind(AssertUnwindSafe(|| {
        eframe::run_native(
            "selflink",
            options,
            Box::new(move |cc| {
                let mut app = opening.app(cc)?;
                app.will = Some(of_window);
                creator_is_open.set(true);
                Ok(Box::new(app))
            }),
        )
    }));
    let legacy = lock(&will).take();
    match outcome {
        Ok(Ok(())) => Ok(legacy),
        // What the toolkit makes of a lost device is of no interest once another one is on its way.
        _ if legacy.is_some() => Ok(legacy),
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
