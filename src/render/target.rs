//! The textures that one picture is drawn into.

use super::pipelines::DEPTH_FORMAT;

/// Multisampled colour and depth, and the finished picture; made anew when the size changes.
pub(super) struct Target {
    /// Width and height, pixels.
    pub(super) size: [u32; 2],
    /// The finished picture.
    pub(super) picture: wgpu::Texture,
    /// View of the finished picture.
    pub(super) picture_view: wgpu::TextureView,
    /// Several samples a pixel, resolved into the picture; `None` where there is one.
    pub(super) samples_view: Option<wgpu::TextureView>,
    /// Depth, as many samples as colour.
    pub(super) depth_view: wgpu::TextureView,
}

impl Target {
    /// Textures of a size that the device takes.
    pub(super) fn new(device: &wgpu::Device, size: [u32; 2], samples: u32, colour_format: wgpu::TextureFormat) -> Self {
        let texture = |label, format, sample_count, usage| {
            device.create_texture(&wgpu::TextureDescriptor {
                label: Some(label),
                size: wgpu::Extent3d { width: size[0], height: size[1], depth_or_array_layers: 1 },
                mip_level_count: 1,
                sample_count,
                dimension: wgpu::TextureDimension::D2,
                format,
                usage: wgpu::TextureUsages::RENDER_ATTACHMENT | usage,
                view_formats: &[],
            })
        };
        let view = |texture: &wgpu::Texture| texture.create_view(&wgpu::TextureViewDescriptor::default());
        let read = wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_SRC;
        let picture = texture("picture", colour_format, 1, read);
        let multisampled = samples > 1;
        let samples_view = multisampled
            .then(|| view(&texture("picture samples", colour_format, samples, wgpu::TextureUsages::empty())));
        let depth_view = view(&texture("depth", DEPTH_FORMAT, samples, wgpu::TextureUsages::empty()));
        Self { size, picture_view: view(&picture), picture, samples_view, depth_view }
    }

    /// Depth that begins at infinity and is not kept.
    pub(super) fn fresh_depth(&self) -> wgpu::RenderPassDepthStencilAttachment<'_> {
        wgpu::RenderPassDepthStencilAttachment {
            view: &self.depth_view,
            depth_ops: Some(wgpu::Operations { load: wgpu::LoadOp::Clear(0.0), store: wgpu::StoreOp::Discard }),
            stencil_ops: None,
        }
    }
}
