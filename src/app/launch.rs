//! Opening the window, and advice where there can be none.

use std::cell::Cell;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::process::Command;
use std::rc::Rc;

use crate::app::App;
use crate::app::state::device::{DeviceLossState, HandedOver};
use crate::app::state::messages::Topic;
use crate::base::panic_report;
use crate::base::threads::lock;
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
        /// The part that is missing.
        reason: String,
    },
    /// No graphics adapter draws to the display.
    #[error(
        "no window can be opened, no graphics adapter draws to this display: install a graphics driver or software rendering (Debian and Ubuntu: apt install mesa-vulkan-drivers), or use `selflink solve`"
    )]
    NoDevice,
    /// The graphics device was lost, and no other window could take its place for long.
    #[error(
        "the window is closed, the graphics device was lost ({reason}): update the graphics driver, or use `selflink solve`, which needs none"
    )]
    LostDevice {
        /// In the driver's words.
        reason: String,
    },
    /// The system gives no further thread.
    #[error("the solver's thread cannot be started ({0}): close other programs and try again")]
    NoThread(#[from] std::io::Error),
}

/// Tells a program that was started anew how many devices were lost before it.
const LOSSES: &str = "SELFLINK_LOST_DEVICES";
/// Devices that may be lost one after the other before it is given up.
const MOST_LOSSES: u32 = 3;

/// Opens the window with these settings and returns when it is closed; one that `resumes` goes on
/// as it was left, where it was open before. Where it loses its graphics device, another window
/// takes its place.
///
/// # Errors
/// There is no display, no adapter, or a library of the window system is missing; or devices are
/// lost again and again; each with advice in one sentence.
pub fn run(settings: Settings, resumes: bool) -> Result<(), AppError> {
    let losses = std::env::var(LOSSES).ok().and_then(|text| text.parse().ok()).unwrap_or(0);
    match run_once(settings, resumes, losses > 0)? {
        Some(handed_over) if losses < MOST_LOSSES => start_anew(handed_over, losses + 1),
        Some(handed_over) => Err(AppError::LostDevice { reason: handed_over.reason }),
        None => Ok(()),
    }
}

/// Opens one window and returns when it is closed, with what it hands over where it lost its
/// device.
fn run_once(settings: Settings, resumes: bool, was_lost: bool) -> Result<Option<HandedOver>, AppError> {
    let options = eframe::NativeOptions {
        viewport: egui::ViewportBuilder::default()
            .with_title("Selflink")
            .with_app_id("selflink")
            .with_icon(crate::app::widgets::icon::pixels())
            .with_inner_size(FIRST_SIZE)
            .with_min_inner_size(LEAST_SIZE)
            .with_drag_and_drop(true),
        renderer: eframe::Renderer::Wgpu,
        ..eframe::NativeOptions::default()
    };
    let is_open = Rc::new(Cell::new(false));
    let creator_is_open = is_open.clone();
    let loss = DeviceLossState::default();
    let loss_of_window = loss.clone();
    // winit panics where a library of the window system is missing; a panic of the open window is a
    // fault of ours.
    panic_report::expect(true);
    let outcome = catch_unwind(AssertUnwindSafe(|| {
        eframe::run_native(
            "selflink",
            options,
            Box::new(move |cc| {
                let mut app = if resumes { App::resume(cc, &settings)? } else { App::open(cc, &settings)? };
                app.graphics.loss = Some(loss_of_window);
                if was_lost {
                    app.messages.note(
                        Topic::Remark,
                        "The graphics device was lost and has been set up again; the scene is being solved again."
                            .into(),
                    );
                }
                creator_is_open.set(true);
                panic_report::expect(false);
                Ok(Box::new(app))
            }),
        )
    }));
    panic_report::expect(false);
    let handed_over = lock(&loss).take();
    match outcome {
        // What the toolkit made of a lost device is of no interest.
        _ if handed_over.is_some() => Ok(handed_over),
        Ok(Ok(())) => Ok(None),
        Ok(Err(error)) => Err(advice(error)),
        Err(panic) if is_open.get() => resume_unwind(panic),
        Err(panic) => {
            let text = panic.downcast_ref::<String>().map(String::as_str);
            let text = text.or_else(|| panic.downcast_ref::<&str>().copied());
            Err(AppError::NoDisplay { reason: text.unwrap_or("the window system broke off").to_owned() })
        }
    }
}

/// Starts the program anew with what the window showed, and waits until it ends.
fn start_anew(handed_over: HandedOver, losses: u32) -> Result<(), AppError> {
    let HandedOver { settings, reason } = handed_over;
    let path = std::env::temp_dir().join(format!("selflink-{}.settings.json", std::process::id()));
    let ended = settings.to_json().map_err(std::io::Error::other).and_then(|text| {
        std::fs::write(&path, text)?;
        let program = std::env::current_exe()?;
        Command::new(program).arg("--settings").arg(&path).env(LOSSES, losses.to_string()).status()
    });
    // Where it cannot be removed it does no harm.
    let _ = std::fs::remove_file(&path);
    match ended {
        Ok(status) if status.success() => Ok(()),
        Ok(_) | Err(_) => Err(AppError::LostDevice { reason }),
    }
}

/// Advice on an error that keeps the window from opening.
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
