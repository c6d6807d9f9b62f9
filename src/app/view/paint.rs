//! The view as an egui callback: `prepare` draws offscreen with our renderer, `paint` blits the
//! picture.
//!
//! A picture is drawn again only when something in it changed, however often egui repaints the
//! panels around it.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::mpsc::Sender;

use egui_wgpu::{CallbackResources, CallbackTrait, RenderState, ScreenDescriptor};

use crate::render::{self, Camera, Display, Frame, Marks, Overlay, Pixels, RenderError, SceneRenderer};
use crate::scene::outside::Outside;
use crate::solve::Snapshot;

/// Content of one picture.
#[derive(Clone)]
pub struct Picture {
    pub snapshot: Arc<Snapshot>,
    /// Sky and sun behind the scene.
    pub outside: Option<Arc<Outside>>,
    pub camera: Camera,
    pub display: Display,
    pub overlay: Overlay,
    /// Width and height, pixels.
    pub size: [u32; 2],
    /// A gathered picture of the same view and its number, in place of the mesh.
    pub gathered: Option<(u64, Arc<Pixels>)>,
    /// Noise that suffices for a gathered picture, as a share of the local light; `None` where the
    /// mesh is asked for.
    pub noise: Option<f32>,
    /// Another solution at the left.
    pub beside: Option<Beside>,
}

/// A serial for a snapshot that is painted otherwise than a solver made it, which no other has:
/// solves count from 0 and come nowhere near.
pub fn fresh_serial() -> u64 {
    static NEXT: AtomicU64 = AtomicU64::new(1 << 62);
    NEXT.fetch_add(1, Ordering::Relaxed)
}

/// A solution that covers the left of a picture.
#[derive(Clone)]
pub struct Beside {
    pub snapshot: Arc<Snapshot>,
    /// Share of the picture's width that it covers.
    pub share: f32,
}

/// The renderer beside egui's own resources, and what it drew last.
struct Stage {
    renderer: SceneRenderer,
    /// For the solution at the left; made when there is one.
    beside: Option<SceneRenderer>,
    make: Box<dyn Fn() -> SceneRenderer + Send + Sync>,
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
    gathered: Option<u64>,
    /// Generation and serial of the solution at the left.
    beside: Option<(u64, u64)>,
}

/// Sets up the renderer; what cannot be drawn is reported through `failures`.
pub fn install(render_state: &RenderState, failures: Sender<String>, ctx: egui::Context) {
    let samples = render::sample_count(&render_state.adapter);
    let (device, queue) = (render_state.device.clone(), render_state.queue.clone());
    let format = render_state.target_format;
    let make = Box::new(move || SceneRenderer::new(device.clone(), queue.clone(), samples, format));
    let stage = Stage { renderer: make(), beside: None, make, drawn: None, failures, ctx };
    render_state.renderer.write().callback_resources.insert(stage);
}

impl Picture {
    /// Adds the picture to what is painted into `rect`.
    pub fn add_to(self, painter: &egui::Painter, rect: egui::Rect) {
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
            gathered: self.gathered.as_ref().map(|(serial, _)| *serial),
            beside: self.beside.as_ref().map(|beside| (beside.snapshot.generation, beside.snapshot.serial)),
        }
    }
}

impl Stage {
    fn draw(&mut self, encoder: &mut wgpu::CommandEncoder, picture: &Picture) -> Result<(), RenderError> {
        let frame = Frame {
            snapshot: &picture.snapshot,
            outside: picture.outside.as_ref(),
            camera: &picture.camera,
            display: &picture.display,
            gathered: picture.gathered.as_ref().map(|(_, pixels)| pixels),
            overlay: &picture.overlay,
            size: picture.size,
        };
        self.renderer.draw(encoder, &frame)?;
        match &picture.beside {
            Some(beside) => {
                let left = self.beside.get_or_insert_with(&self.make);
                let overlay = beside.overlay(picture);
                left.draw(encoder, &Frame { snapshot: &beside.snapshot, overlay: &overlay, gathered: None, ..frame })
            }
            None => {
                // What it holds on the device is wanted no more.
                self.beside = None;
                Ok(())
            }
        }
    }
}

impl Beside {
    /// Drawings over the left side: what is pointed at belongs to the solution at the right.
    pub fn overlay(&self, picture: &Picture) -> Overlay {
        Overlay { marks: Marks::default(), ..picture.overlay.clone() }
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
            if let Err(error) = stage.draw(encoder, self) {
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
        info: egui::PaintCallbackInfo,
        pass: &mut wgpu::RenderPass<'static>,
        resources: &CallbackResources,
    ) {
        if let Some(stage) = resources.get::<Stage>() {
            stage.renderer.blit(pass);
            if let (Some(left), Some(beside)) = (&stage.beside, &self.beside) {
                let (view, clip) = (info.viewport_in_pixels(), info.clip_rect_in_pixels());
                let end = view.left_px + (beside.share * view.width_px as f32).round() as i32;
                let width = (end - clip.left_px).clamp(0, clip.width_px);
                let [x, y, width, height] =
                    [clip.left_px, clip.top_px, width, clip.height_px].map(|px| px.max(0) as u32);
                if width > 0 {
                    pass.set_scissor_rect(x, y, width, height);
                    left.blit(pass);
                }
            }
        }
    }
}
