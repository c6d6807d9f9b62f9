//! A finished picture on the graphics device, drawn in place of the mesh.

use std::sync::Arc;

use bytemuck::cast_slice;
use wgpu::util::DeviceExt as _;

use super::gathered::Pixels;
use super::pipelines::{COLOUR_FORMAT, picture_binding};

/// The texture of a picture.
pub(super) struct Underlay {
    pixels: Arc<Pixels>,
    binding: wgpu::BindGroup,
}

impl Underlay {
    /// Uploads a picture for a pipeline that shows it; its size must be one that the device takes.
    pub(super) fn new(
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        (pipeline, sampler): (&wgpu::RenderPipeline, &wgpu::Sampler),
        pixels: &Arc<Pixels>,
    ) -> Self {
        let [width, height] = pixels.size;
        let descriptor = wgpu::TextureDescriptor {
            label: Some("gathered picture"),
            size: wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: COLOUR_FORMAT,
            usage: wgpu::TextureUsages::TEXTURE_BINDING,
            view_formats: &[],
        };
        let texture = device.create_texture_with_data(
            queue,
            &descriptor,
            wgpu::util::TextureDataOrder::default(),
            cast_slice(&pixels.pixels),
        );
        let view = texture.create_view(&wgpu::TextureViewDescriptor::default());
        Self { pixels: pixels.clone(), binding: picture_binding(device, pipeline, &view, sampler) }
    }

    /// Whether this is that picture.
    pub(super) fn is_of(&self, pixels: &Arc<Pixels>) -> bool {
        Arc::ptr_eq(&self.pixels, pixels)
    }

    /// Draws it over everything so far; depth stays.
    pub(super) fn draw(&self, pass: &mut wgpu::RenderPass<'_>, pipeline: &wgpu::RenderPipeline) {
        pass.set_pipeline(pipeline);
        pass.set_bind_group(0, &self.binding, &[]);
        pass.draw(0..3, 0..1);
    }
}
