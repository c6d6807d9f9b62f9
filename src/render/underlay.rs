//! A finished picture on the graphics device, drawn in place of the mesh.

use std::sync::Arc;

use bytemuck::cast_slice;

use super::gathered::Pixels;
use super::pipelines::COLOUR_FORMAT;

/// The texture of a picture.
pub(super) struct Underlay {
    pixels: Arc<Pixels>,
    binding: wgpu::BindGroup,
}

impl Underlay {
    /// Uploads a picture; its size must be one that the device takes.
    pub(super) fn new(
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        (layout, sampler): (&wgpu::BindGroupLayout, &wgpu::Sampler),
        pixels: &Arc<Pixels>,
    ) -> Self {
        let [width, height] = pixels.size;
        let size = wgpu::Extent3d { width, height, depth_or_array_layers: 1 };
        let texture = device.create_texture(&wgpu::TextureDescriptor {
            label: Some("gathered picture"),
            size,
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: COLOUR_FORMAT,
            usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
            view_formats: &[],
        });
        queue.write_texture(
            texture.as_image_copy(),
            cast_slice(&pixels.pixels),
            wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(4 * width), rows_per_image: None },
            size,
        );
        let view = texture.create_view(&wgpu::TextureViewDescriptor::default());
        let binding = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("gathered picture"),
            layout,
            entries: &[
                wgpu::BindGroupEntry { binding: 0, resource: wgpu::BindingResource::TextureView(&view) },
                wgpu::BindGroupEntry { binding: 1, resource: wgpu::BindingResource::Sampler(sampler) },
            ],
        });
        Self { pixels: pixels.clone(), binding }
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
