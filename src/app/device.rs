//! The graphics device may be lost while the window is open: a driver is updated or reset, an adapter is taken away.
//!
//! Nothing can be drawn with a lost device, and the toolkit makes no other one for an open window. So the window hands what it shows
//! over to another one, which takes its place ([`super::launch`]).

use std::sync::{Arc, Mutex};

use super::dock::Tool;
use crate::export::settings::Settings;
use crate::threads::lock;

/// What a window that lost its device hands over to the next one.
#[derive(Clone, Debug)]
pub(super) struct Legacy {
    /// Scene, light, view and parameters.
    pub settings: Settings,
    /// The open tool.
    pub tool: Option<Tool>,
    /// Why the device was lost, in the driver's words.
    pub reason: String,
}

/// Where a window leaves its legacy, for whoever opens the next one.
pub(super) type Will = Arc<Mutex<Option<Legacy>>>;

/// Knows whether the device was lost.
#[derive(Clone, Default)]
pub(super) struct DeviceState(Arc<Mutex<Option<String>>>);

impl DeviceState {
    /// Asks the device to tell when it is lost; `ctx` then draws a frame, so that the window notices.
    pub(super) fn watch(device: &wgpu::Device, ctx: egui::Context) -> Self {
        let state = Self::default();
        let told = state.clone();
        device.set_device_lost_callback(move |_, reason| {
            let reason = reason.trim_end_matches('.').to_owned();
            *lock(&told.0) = Some(if reason.is_empty() { "no reason was given".into() } else { reason });
            ctx.request_repaint();
        });
        state
    }

    /// Why the device was lost, if it was.
    pub(super) fn lost(&self) -> Option<String> {
        lock(&self.0).clone()
    }
}
