//! Pictures without a window, on whatever adapter answers, software ones included.
//!
//! As they are shown, or as radiosities in W/m².

use std::sync::mpsc;

use image::RgbaImage;

use super::pipelines::COLOUR_FORMAT;
use super::radiosities::{PLACES, RadiosityPass};
use super::renderer::supported_samples;
use super::{Camera, Display, Frame, Overlay, RenderError, SceneRenderer};
use crate::export::exr::FloatPicture;
use crate::solve::snapshot::Snapshot;

/// Bytes of a pixel of the finished picture.
const PIXEL_BYTES: u32 = 4;

/// A graphics device of its own and a renderer on it.
pub struct Offscreen {
    device: wgpu::Device,
    queue: wgpu::Queue,
    samples: u32,
    renderer: SceneRenderer,
    adapter: String,
}

impl Offscreen {
    /// Takes the first adapter that answers. Not for threads of a pool: nobody waits until they
    /// have ended, and a driver whose data of a thread are freed while the process ends may free
    /// them twice.
    ///
    /// # Errors
    /// No adapter, or one that gives no device.
    pub fn new() -> Result<Self, RenderError> {
        debug_assert!(rayon::current_thread_index().is_none(), "drawn on a pool's thread, which may end too late");
        let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle_from_env());
        let options = |force_fallback_adapter| wgpu::RequestAdapterOptions {
            power_preference: wgpu::PowerPreference::HighPerformance,
            force_fallback_adapter,
            ..Default::default()
        };
        let adapter = pollster::block_on(instance.request_adapter(&options(false)))
            .or_else(|_| pollster::block_on(instance.request_adapter(&options(true))))
            .map_err(|_| RenderError::NoAdapter)?;
        let name = adapter.get_info().name;
        let descriptor = wgpu::DeviceDescriptor {
            label: Some("offscreen"),
            // All that the adapter has: pictures and meshes may be larger than the defaults.
            required_limits: adapter.limits(),
            ..Default::default()
        };
        let (device, queue) = pollster::block_on(adapter.request_device(&descriptor))
            .map_err(|error| RenderError::NoDevice { adapter: name.clone(), reason: error.to_string() })?;
        // A picture to keep is worth the time of several samples, on a software adapter too.
        let samples = supported_samples(&adapter);
        let renderer = new_renderer(&device, &queue, samples);
        Ok(Self { device, queue, samples, renderer, adapter: name })
    }

    /// Name of the graphics adapter.
    pub fn adapter(&self) -> &str {
        &self.adapter
    }

    /// Draws one picture, without what lies behind the scene.
    ///
    /// # Errors
    /// A size of zero or beyond the adapter's limits, a mesh beyond them, or a failed read-back.
    pub fn picture(
        &mut self,
        snapshot: &Snapshot,
        camera: &Camera,
        display: &Display,
        overlay: &Overlay,
        size: [u32; 2],
    ) -> Result<RgbaImage, RenderError> {
        self.picture_over(&Frame { snapshot, camera, display, overlay, size, outside: None, gathered: None })
    }

    /// Draws one picture, over one that was gathered where the frame has such.
    ///
    /// # Errors
    /// As [`Self::picture`].
    pub fn picture_over(&mut self, frame: &Frame<'_>) -> Result<RgbaImage, RenderError> {
        self.guarded(|offscreen| offscreen.draw_and_read(frame))
    }

    /// Draws what each pixel sees as radiosity in W/m², linear and without overlays; four samples a
    /// pixel.
    ///
    /// # Errors
    /// As [`Self::picture`].
    pub fn radiosities(
        &mut self,
        snapshot: &Snapshot,
        camera: &Camera,
        size: [u32; 2],
    ) -> Result<FloatPicture, RenderError> {
        self.renderer.check_size(size)?;
        self.guarded(|offscreen| {
            let pass = RadiosityPass::new(&offscreen.device, &offscreen.queue, snapshot, size)?;
            let mut pixels = vec![[0.0_f32; 4]; size[0] as usize * size[1] as usize];
            for aside in PLACES {
                let mut encoder = offscreen.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
                pass.draw(&offscreen.queue, &mut encoder, camera, aside);
                let bytes = offscreen.read_back(encoder, pass.picture(), size_of::<[f32; 4]>() as u32)?;
                for (sum, drawn) in pixels.iter_mut().zip(bytes.as_chunks::<16>().0) {
                    let drawn: [f32; 4] = bytemuck::cast(*drawn);
                    *sum = std::array::from_fn(|channel| sum[channel] + drawn[channel] / PLACES.len() as f32);
                }
            }
            Ok(FloatPicture { size, pixels })
        })
    }

    /// Draws; without this, running out of graphics memory would end the program, and what then
    /// fails to be used is reported as invalid.
    fn guarded<T>(&mut self, draw: impl FnOnce(&mut Self) -> Result<T, RenderError>) -> Result<T, RenderError> {
        let memory = self.device.push_error_scope(wgpu::ErrorFilter::OutOfMemory);
        let validity = self.device.push_error_scope(wgpu::ErrorFilter::Validation);
        let picture = draw(self);
        let invalid = pollster::block_on(validity.pop());
        let exhausted = pollster::block_on(memory.pop());
        match exhausted.or(invalid) {
            Some(error) => {
                // Its textures and buffers may be unusable.
                self.renderer = new_renderer(&self.device, &self.queue, self.samples);
                Err(RenderError::Device { reason: error.to_string() })
            }
            None => picture,
        }
    }

    fn draw_and_read(&mut self, frame: &Frame<'_>) -> Result<RgbaImage, RenderError> {
        let mut encoder = self.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        // Each picture stands for itself: two snapshots of different solves may carry the same
        // numbers.
        self.renderer.forget();
        self.renderer.draw(&mut encoder, frame)?;
        let texture = self.renderer.picture().ok_or_else(|| failed("nothing was drawn"))?;
        let pixels = self.read_back(encoder, texture, PIXEL_BYTES)?;
        let [width, height] = frame.size;
        RgbaImage::from_raw(width, height, pixels).ok_or_else(|| failed("too few pixels came back"))
    }

    /// Submits what was recorded and hands the pixels of a texture back, row by row.
    fn read_back(
        &self,
        mut encoder: wgpu::CommandEncoder,
        texture: &wgpu::Texture,
        pixel_bytes: u32,
    ) -> Result<Vec<u8>, RenderError> {
        let (width, height) = (texture.width(), texture.height());
        let row_bytes = width * pixel_bytes;
        let padded_row_bytes = row_bytes.next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT);
        let bytes = u64::from(padded_row_bytes) * u64::from(height);
        let limit = self.device.limits().max_buffer_size;
        if bytes > limit {
            return Err(RenderError::TooLarge {
                what: format!("a picture of {width}×{height} pixels needs"),
                needed_mib: bytes.div_ceil(1 << 20),
                limit_mib: limit >> 20,
                remedy: "a smaller picture",
            });
        }
        let buffer = self.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("read-back"),
            size: bytes,
            usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
            mapped_at_creation: false,
        });
        encoder.copy_texture_to_buffer(
            texture.as_image_copy(),
            wgpu::TexelCopyBufferInfo {
                buffer: &buffer,
                layout: wgpu::TexelCopyBufferLayout {
                    offset: 0,
                    bytes_per_row: Some(padded_row_bytes),
                    rows_per_image: None,
                },
            },
            texture.size(),
        );
        self.queue.submit([encoder.finish()]);

        let (sender, receiver) = mpsc::channel();
        // The receiver outlives the wait below; a failed send could only mean that nobody waits any
        // more.
        buffer.map_async(wgpu::MapMode::Read, .., move |result| drop(sender.send(result)));
        self.device.poll(wgpu::PollType::wait_indefinitely()).map_err(failed)?;
        let mapped = receiver.recv().map_err(|_| failed("the device gave no answer"))?;
        mapped.map_err(failed)?;
        let rows = buffer.get_mapped_range(..).map_err(failed)?;
        Ok(rows.chunks_exact(padded_row_bytes as usize).flat_map(|row| &row[..row_bytes as usize]).copied().collect())
    }
}

fn failed(reason: impl ToString) -> RenderError {
    RenderError::Device { reason: reason.to_string() }
}

fn new_renderer(device: &wgpu::Device, queue: &wgpu::Queue, samples: u32) -> SceneRenderer {
    SceneRenderer::new(device.clone(), queue.clone(), samples, COLOUR_FORMAT)
}
