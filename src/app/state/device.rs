//! The graphics device may be lost while the window is open: a driver is updated or reset, an
//! adapter is taken away.
//!
//! Nothing can be drawn with a lost device, the toolkit makes no other one for an open window, and
//! where it breaks off the event loop cannot be run again. So the program is started anew with the
//! settings of the window ([`crate::app::launch`]).

use std::sync::mpsc::Receiver;
use std::sync::{Arc, Mutex};

use crate::app::App;
use crate::base::threads::lock;
use crate::export::settings::Settings;

/// State that a window which lost its device hands over to the next one.
#[derive(Clone, Debug)]
pub struct HandedOver {
    /// Scene, light, view and parameters.
    pub settings: Settings,
    /// Why the device was lost, in the driver's words.
    pub reason: String,
}

/// Where a window leaves what it hands over, for whoever opens the next one.
pub type DeviceLossState = Arc<Mutex<Option<HandedOver>>>;

/// The graphics device, and what becomes of the window without it.
pub struct Graphics {
    /// Why the view could not be drawn.
    pub drawing_failures: Receiver<String>,
    /// Whether the device was lost.
    pub state: DeviceState,
    /// Where the window leaves what it shows when it loses its device.
    pub loss: Option<DeviceLossState>,
}

/// Knows whether the device was lost.
pub struct DeviceState {
    device: wgpu::Device,
    lost: Arc<Mutex<Option<String>>>,
}

impl DeviceState {
    /// Asks the device to tell when it is lost; `ctx` then draws a frame, so that the window
    /// notices.
    pub fn watch(device: &wgpu::Device, ctx: egui::Context) -> Self {
        let lost = Arc::<Mutex<Option<String>>>::default();
        let shared = lost.clone();
        device.set_device_lost_callback(move |_, reason| {
            let reason = reason.trim_end_matches('.').to_owned();
            *lock(&shared) = Some(if reason.is_empty() { "no reason was given".into() } else { reason });
            ctx.request_repaint();
        });
        Self { device: device.clone(), lost }
    }

    /// Why the device was lost, as far as it was reported.
    pub fn lost(&self) -> Option<String> {
        lock(&self.lost).clone()
    }

    /// Reason for which the device is lost, by asking the device.
    pub fn is_it_lost(&self) -> Option<String> {
        // A lost device may have nothing to say to this either.
        let _ = self.device.poll(wgpu::PollType::Poll);
        self.lost()
    }
}

/// Whether the toolkit closes a window that lost its device or breaks off with it, what it showed
/// is kept.
impl Drop for App {
    fn drop(&mut self) {
        if let (Some(loss), Some(reason)) = (&self.graphics.loss, self.graphics.state.is_it_lost()) {
            *lock(loss) = Some(HandedOver { settings: self.settings(), reason });
        }
    }
}
