//! A view in W/m²: the mesh alone, drawn into 32-bit floats.
//!
//! Float targets take no several samples a pixel, so the picture is drawn a few times, each a
//! fraction of a pixel aside, and the mean taken.

use bytemuck::cast_slice;
use glam::{Mat4, Vec2, Vec3};

use super::buffer::GrowingBuffer;
use super::pipelines;
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
        let pipeline = pipeline(device);
        let layout = pipeline.get_bind_group_layout(0);
        let (uniform, binding) = pipelines::uniform(device, "clip from world", size_of::<Mat4>(), &layout);
        let mut positions = GrowingBuffer::new("mesh vertices", wgpu::BufferUsages::VERTEX);
        let mut radiosities = GrowingBuffer::new("vertex radiosities", wgpu::BufferUsages::VERTEX);
        let mut indices = GrowingBuffer::new("mesh triangles", wgpu::BufferUsages::INDEX);
        positions.write(device, queue, cast_slice(&snapshot.mesh.positions))?;
        radiosities.write(device, queue, cast_slice(&snapshot.vertex_radiosity))?;
        indices.write(device, queue, cast_slice(&snapshot.mesh.triangles))?;
        let index_count = 3 * snapshot.mesh.triangles.len() as u32;
        let target = Target::new(device, size, 1, FORMAT);
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
            depth_stencil_attachment: Some(self.target.fresh_depth()),
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

fn pipeline(device: &wgpu::Device) -> wgpu::RenderPipeline {
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
    device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some("radiosities"),
        layout: None,
        vertex: wgpu::VertexState {
            module: &module,
            entry_point: Some("radiosity_vertex"),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            buffers: &[per_vertex(&positions), per_vertex(&radiosities)],
        },
        // As in the picture: faces have one bright side.
        primitive: wgpu::PrimitiveState { cull_mode: Some(wgpu::Face::Back), ..Default::default() },
        depth_stencil: Some(pipelines::depth(true, wgpu::CompareFunction::Greater)),
        multisample: wgpu::MultisampleState::default(),
        fragment: Some(wgpu::FragmentState {
            module: &module,
            entry_point: Some("radiosity_fragment"),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            targets: &[Some(FORMAT.into())],
        }),
        multiview_mask: None,
        cache: None,
    })
}
