//! The view as an egui callback: `prepare` draws offscreen with our renderer, `paint` blits the picture.
//!
//! A picture is drawn again only when something in it changed, however often egui repaints the panels around it.

use std::sync::Arc;
use std::sync::mpsc::Sender;

use egui_wgpu::{CallbackResources, CallbackTrait, RenderState, ScreenDescriptor};

use crate::render::{self, Camera, Display, Frame, Overlay, SceneRenderer};
use crate::solver::Snapshot;

/// What one picture shows.
pub(super) struct Picture {
    pub snapshot: Arc<Snapshot>,
    pub camera: Camera,
    pub display: Display,
    pub overlay: Overlay,
    /// Width and height, pixels.
    pub size: [u32; 2],
}

/// The renderer beside egui's own resources, and what it drew last.
struct Stage {
    renderer: SceneRenderer,
    drawn: Option<Key>,
    failures: Sender<String>,
    ctx: egui::Context,
}

/// Tells pictures apart.
#[derive(PartialEq)]
struct Key {
    generation: u64,
    serial: u64,
    camera: Camera,
    display: Display,
    overlay: Overlay,
    size: [u32; 2],
}

/// Sets up the renderer; what cannot be drawn is told through `failures`.
pub(super) fn install(render_state: &RenderState, failures: Sender<String>, ctx: egui::Context) {
    let samples = render::sample_count(&render_state.adapter);
    let (device, queue) = (render_state.device.clone(), render_state.queue.clone());
    let renderer = SceneRenderer::new(device, queue, samples, render_state.target_format);
    let stage = Stage { renderer, drawn: None, failures, ctx };
    render_state.renderer.write().callback_resources.insert(stage);
}

impl Picture {
    /// Adds the picture to what is painted into `rect`.
    pub(super) fn add_to(self, painter: &egui::Painter, rect: egui::Rect) {
        painter.add(egui_wgpu::Callback::new_paint_callback(rect, self));
    }

    fn key(&self) -> Key {
        Key {
            generation: self.snapshot.generation,
            serial: self.snapshot.serial,
            camera: self.camera,
            display: self.display,
            overlay: self.overlay.clone(),
            size: self.size,
        }
    }
}

impl CallbackTrait for Picture {
    fn prepare(
        &self,
        _device: &wgpu::Device,
        _queue: &wgpu::Queue,
        _screen: &ScreenDescriptor,
        encoder: &mut wgpu::CommandEncoder,
        resources: &mut CallbackResources,
    ) -> Vec<wgpu::CommandBuffer> {
        let Some(stage) = resources.get_mut::<Stage>() else { return Vec::new() };
        let key = self.key();
        if stage.drawn.as_ref() != Some(&key) {
            let frame = Frame {
                snapshot: &self.snapshot,
                camera: &self.camera,
                display: &self.display,
                overlay: &self.overlay,
                size: self.size,
            };
            if let Err(error) = stage.renderer.draw(encoder, &frame) {
                // A window that is gone wants no message.
                let _ = stage.failures.send(error.to_string());
                stage.ctx.request_repaint();
            }
            stage.drawn = Some(key);
        }
        Vec::new()
    }

    fn paint(
        &self,
        _info: egui::PaintCallbackInfo,
        pass: &mut wgpu::RenderPass<'static>,
        resources: &CallbackResources,
    ) {
        if let Some(stage) = resources.get::<Stage>() {
            stage.renderer.blit(pass);
        }
    }
}
