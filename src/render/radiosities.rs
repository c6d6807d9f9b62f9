//! A view in W/m²: the mesh alone, drawn into 32-bit floats.
//!
//! Float targets take no several samples a pixel, so the picture is drawn a few times, each a
//! fraction of a pixel aside, and the mean taken.

use bytemuck::cast_slice;
use glam::{Mat4, Vec2, Vec3};

use super::buffer::GrowingBuffer;
use super::pipelines::{DEPTH_FORMAT, uniform_layout};
use super::target::Target;
use super::{Camera, RenderError};
use crate::solve::snapshot::Snapshot;

/// Holds what is drawn: radiosity and coverage.
const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba32Float;

/// Where in the pixel it is drawn, pixels from its middle: four places no two of which share a row
/// or a column.
pub(super) const PLACES: [Vec2; 4] =
    [Vec2::new(-0.125, -0.375), Vec2::new(0.375, -0.125), Vec2::new(-0.375, 0.125), Vec2::new(0.125, 0.375)];

/// All that is needed to draw one snapshot so.
pub(super) struct RadiosityPass {
    pipeline: wgpu::RenderPipeline,
    uniform: wgpu::Buffer,
    binding: wgpu::BindGroup,
    positions: GrowingBuffer,
    radiosities: GrowingBuffer,
    indices: GrowingBuffer,
    index_count: u32,
    target: Target,
}

impl RadiosityPass {
    /// Uploads a snapshot and makes the target.
    ///
    /// # Errors
    /// A mesh that the adapter cannot hold.
    pub(super) fn new(
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        snapshot: &Snapshot,
        size: [u32; 2],
    ) -> Result<Self, RenderError> {
        let (layout, pipeline) = pipeline(device);
        let uniform = device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("clip from world"),
            size: size_of::<Mat4>() as u64,
            usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        let binding = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("clip from world"),
            layout: &layout,
            entries: &[wgpu::BindGroupEntry { binding: 0, resource: uniform.as_entire_binding() }],
        });
        let mut positions = GrowingBuffer::new("mesh vertices", wgpu::BufferUsages::VERTEX);
        let mut radiosities = GrowingBuffer::new("vertex radiosities", wgpu::BufferUsages::VERTEX);
        let mut indices = GrowingBuffer::new("mesh triangles", wgpu::BufferUsages::INDEX);
        positions.write(device, queue, cast_slice(&snapshot.mesh.positions))?;
        radiosities.write(device, queue, cast_slice(&snapshot.vertex_radiosity))?;
        indices.write(device, queue, cast_slice(&snapshot.mesh.triangles))?;
        let index_count = 3 * snapshot.mesh.triangles.len() as u32;
        let target = Target::with_format(device, size, 1, FORMAT);
        Ok(Self { pipeline, uniform, binding, positions, radiosities, indices, index_count, target })
    }

    /// Records one drawing, aside by a part of a pixel.
    pub(super) fn draw(&self, queue: &wgpu::Queue, encoder: &mut wgpu::CommandEncoder, camera: &Camera, aside: Vec2) {
        let [width, height] = self.target.size.map(|side| side as f32);
        let shift = Vec3::new(2.0 * aside.x / width, 2.0 * aside.y / height, 0.0);
        let clip_from_world = Mat4::from_translation(shift) * camera.clip_from_world(width / height);
        queue.write_buffer(&self.uniform, 0, cast_slice(&clip_from_world.to_cols_array()));
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("radiosities"),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: &self.target.picture_view,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations {
                    load: wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT),
                    store: wgpu::StoreOp::Store,
                },
            })],
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: &self.target.depth_view,
                depth_ops: Some(wgpu::Operations { load: wgpu::LoadOp::Clear(0.0), store: wgpu::StoreOp::Discard }),
                stencil_ops: None,
            }),
            ..Default::default()
        });
        if let (Some(positions), Some(radiosities), Some(indices)) =
            (self.positions.contents(), self.radiosities.contents(), self.indices.contents())
        {
            pass.set_pipeline(&self.pipeline);
            pass.set_bind_group(0, &self.binding, &[]);
            pass.set_vertex_buffer(0, positions);
            pass.set_vertex_buffer(1, radiosities);
            pass.set_index_buffer(indices, wgpu::IndexFormat::Uint32);
            pass.draw_indexed(0..self.index_count, 0, 0..1);
        }
    }

    /// The picture that was drawn.
    pub(super) fn picture(&self) -> &wgpu::Texture {
        &self.target.picture
    }
}

fn pipeline(device: &wgpu::Device) -> (wgpu::BindGroupLayout, wgpu::RenderPipeline) {
    let bindings = uniform_layout(device, "clip from world", wgpu::ShaderStages::VERTEX);
    let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
        label: Some("radiosities"),
        bind_group_layouts: &[Some(&bindings)],
        immediate_size: 0,
    });
    let module = device.create_shader_module(wgpu::include_wgsl!("radiosity.wgsl"));
    let positions = wgpu::vertex_attr_array![0 => Float32x3];
    let radiosities = wgpu::vertex_attr_array![1 => Float32x3];
    let per_vertex = |attributes| {
        Some(wgpu::VertexBufferLayout {
            array_stride: size_of::<[f32; 3]>() as u64,
            step_mode: wgpu::VertexStepMode::Vertex,
            attributes,
        })
    };
    let pipeline = device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some("radiosities"),
        layout: Some(&layout),
        vertex: wgpu::VertexState {
            module: &module,
            entry_point: Some("radiosity_vertex"),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            buffers: &[per_vertex(&positions), per_vertex(&radiosities)],
        },
        // As in the picture: faces have one bright side.
        primitive: wgpu::PrimitiveState { cull_mode: Some(wgpu::Face::Back), ..Default::default() },
        depth_stencil: Some(wgpu::DepthStencilState {
            format: DEPTH_FORMAT,
            depth_write_enabled: Some(true),
            depth_compare: Some(wgpu::CompareFunction::Greater),
            stencil: wgpu::StencilState::default(),
            bias: wgpu::DepthBiasState::default(),
        }),
        multisample: wgpu::MultisampleState::default(),
        fragment: Some(wgpu::FragmentState {
            module: &module,
            entry_point: Some("radiosity_fragment"),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            targets: &[Some(FORMAT.into())],
        }),
        multiview_mask: None,
        cache: None,
    });
    (bindings, pipeline)
}
