//! The wgpu pipelines: background, mesh, lines and the blit into a window.

use super::overlay::Line;

/// Format of the finished picture; holds gamma-encoded colour, as egui's textures do.
pub(super) const COLOUR_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8Unorm;
/// Reversed depth needs floats to hold its precision far away.
pub(super) const DEPTH_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;

/// Opacity of the links where something hides them.
const HIDDEN_LINK_OPACITY: f64 = 0.3;

/// All that is made once per device.
pub(super) struct Pipelines {
    /// Layout of the one uniform binding of the scene's pipelines.
    pub(super) view_layout: wgpu::BindGroupLayout,
    /// The gradient behind everything.
    pub(super) background: wgpu::RenderPipeline,
    /// Bright sides of the leaves.
    pub(super) mesh: wgpu::RenderPipeline,
    /// Bright sides of the leaves, pushed back where slanted, so that they do not cut the outlines
    /// drawn in them.
    pub(super) mesh_behind_outlines: wgpu::RenderPipeline,
    /// Both kinds of leaves without colour: they hide lines over a gathered picture.
    pub(super) depth: wgpu::RenderPipeline,
    pub(super) depth_behind_outlines: wgpu::RenderPipeline,
    /// A gathered picture, in place of background and mesh.
    pub(super) underlay: wgpu::RenderPipeline,
    /// Lines where nothing hides them.
    pub(super) lines: wgpu::RenderPipeline,
    /// Lines seen faintly through everything.
    pub(super) lines_through: wgpu::RenderPipeline,
    /// Picture into a window's pass.
    pub(super) blit: wgpu::RenderPipeline,
}

/// Difference between the pipelines of the scene.
#[derive(Clone, Copy)]
struct Stage<'a> {
    name: &'a str,
    entry_points: [&'a str; 2],
    buffers: &'a [Option<wgpu::VertexBufferLayout<'a>>],
    topology: wgpu::PrimitiveTopology,
    cull: Option<wgpu::Face>,
    writes_depth: bool,
    depth_compare: wgpu::CompareFunction,
    blend: Option<wgpu::BlendState>,
    colours: wgpu::ColorWrites,
    bias: wgpu::DepthBiasState,
    constants: &'a [(&'a str, f64)],
}

/// A uniform of so many bytes, and its binding.
pub(super) fn uniform(
    device: &wgpu::Device,
    what: &str,
    bytes: usize,
    layout: &wgpu::BindGroupLayout,
) -> (wgpu::Buffer, wgpu::BindGroup) {
    let buffer = device.create_buffer(&wgpu::BufferDescriptor {
        label: Some(what),
        size: bytes as u64,
        usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    });
    let binding = device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: Some(what),
        layout,
        entries: &[wgpu::BindGroupEntry { binding: 0, resource: buffer.as_entire_binding() }],
    });
    (buffer, binding)
}

/// The binding of a picture and its sampler for a pipeline that shows it.
pub(super) fn picture_binding(
    device: &wgpu::Device,
    pipeline: &wgpu::RenderPipeline,
    view: &wgpu::TextureView,
    sampler: &wgpu::Sampler,
) -> wgpu::BindGroup {
    device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: Some("picture"),
        layout: &pipeline.get_bind_group_layout(0),
        entries: &[
            wgpu::BindGroupEntry { binding: 0, resource: wgpu::BindingResource::TextureView(view) },
            wgpu::BindGroupEntry { binding: 1, resource: wgpu::BindingResource::Sampler(sampler) },
        ],
    })
}

/// What a pipeline does with depth.
pub(super) fn depth(writes: bool, compare: wgpu::CompareFunction) -> wgpu::DepthStencilState {
    wgpu::DepthStencilState {
        format: DEPTH_FORMAT,
        depth_write_enabled: Some(writes),
        depth_compare: Some(compare),
        stencil: wgpu::StencilState::default(),
        bias: wgpu::DepthBiasState::default(),
    }
}

impl Pipelines {
    /// Compiles everything for a number of samples and a window's format.
    pub(super) fn new(device: &wgpu::Device, samples: u32, blit_format: wgpu::TextureFormat) -> Self {
        let view_layout = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("view"),
            entries: &[wgpu::BindGroupLayoutEntry {
                binding: 0,
                visibility: wgpu::ShaderStages::VERTEX_FRAGMENT,
                ty: wgpu::BindingType::Buffer {
                    ty: wgpu::BufferBindingType::Uniform,
                    has_dynamic_offset: false,
                    min_binding_size: None,
                },
                count: None,
            }],
        });
        let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some("scene"),
            bind_group_layouts: &[Some(&view_layout)],
            immediate_size: 0,
        });
        let module = device.create_shader_module(wgpu::include_wgsl!("scene.wgsl"));
        let scene_pipeline = |stage: &Stage<'_>| {
            let compilation_options =
                || wgpu::PipelineCompilationOptions { constants: stage.constants, ..Default::default() };
            device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
                label: Some(stage.name),
                layout: Some(&layout),
                vertex: wgpu::VertexState {
                    module: &module,
                    entry_point: Some(stage.entry_points[0]),
                    compilation_options: compilation_options(),
                    buffers: stage.buffers,
                },
                primitive: wgpu::PrimitiveState {
                    topology: stage.topology,
                    cull_mode: stage.cull,
                    ..Default::default()
                },
                depth_stencil: Some(wgpu::DepthStencilState {
                    bias: stage.bias,
                    ..depth(stage.writes_depth, stage.depth_compare)
                }),
                multisample: wgpu::MultisampleState { count: samples, ..Default::default() },
                fragment: Some(wgpu::FragmentState {
                    module: &module,
                    entry_point: Some(stage.entry_points[1]),
                    compilation_options: compilation_options(),
                    targets: &[Some(wgpu::ColorTargetState {
                        format: COLOUR_FORMAT,
                        blend: stage.blend,
                        write_mask: stage.colours,
                    })],
                }),
                multiview_mask: None,
                cache: None,
            })
        };

        let background = scene_pipeline(&Stage {
            name: "background",
            entry_points: ["background_vertex", "background_fragment"],
            buffers: &[],
            topology: wgpu::PrimitiveTopology::TriangleList,
            cull: None,
            writes_depth: false,
            depth_compare: wgpu::CompareFunction::Always,
            blend: None,
            colours: wgpu::ColorWrites::ALL,
            bias: wgpu::DepthBiasState::default(),
            constants: &[],
        });
        let positions = wgpu::vertex_attr_array![0 => Float32x3];
        let radiosities = wgpu::vertex_attr_array![1 => Float32x3];
        let measured = wgpu::vertex_attr_array![2 => Float32];
        let per_vertex = |array_stride, attributes| wgpu::VertexBufferLayout {
            array_stride,
            step_mode: wgpu::VertexStepMode::Vertex,
            attributes,
        };
        let of_three = size_of::<[f32; 3]>() as u64;
        let mesh = Stage {
            name: "mesh",
            entry_points: ["mesh_vertex", "mesh_fragment"],
            buffers: &[
                Some(per_vertex(of_three, &positions)),
                Some(per_vertex(of_three, &radiosities)),
                Some(per_vertex(size_of::<f32>() as u64, &measured)),
            ],
            topology: wgpu::PrimitiveTopology::TriangleList,
            // Faces have one bright side: from outside one looks into the room.
            cull: Some(wgpu::Face::Back),
            writes_depth: true,
            depth_compare: wgpu::CompareFunction::Greater,
            blend: None,
            colours: wgpu::ColorWrites::ALL,
            bias: wgpu::DepthBiasState::default(),
            constants: &[],
        };
        let behind_outlines = Stage {
            name: "mesh behind outlines",
            // Away from the eye by the depth that changes across a pixel. Not without outlines: a
            // face seen edge-on would fall behind the wall at its back.
            bias: wgpu::DepthBiasState { slope_scale: -1.0, ..Default::default() },
            ..mesh
        };
        let without_colour = |stage| scene_pipeline(&Stage { colours: wgpu::ColorWrites::empty(), ..stage });
        let (depth, depth_behind_outlines) = (without_colour(mesh), without_colour(behind_outlines));
        let (mesh, mesh_behind_outlines) = (scene_pipeline(&mesh), scene_pipeline(&behind_outlines));
        let line_attributes = wgpu::vertex_attr_array![0 => Float32x3, 1 => Float32x3, 2 => Float32, 3 => Unorm8x4];
        let line_buffers = [Some(wgpu::VertexBufferLayout {
            array_stride: size_of::<Line>() as u64,
            step_mode: wgpu::VertexStepMode::Instance,
            attributes: &line_attributes,
        })];
        let lines = Stage {
            name: "lines",
            entry_points: ["line_vertex", "line_fragment"],
            buffers: &line_buffers,
            topology: wgpu::PrimitiveTopology::TriangleStrip,
            cull: None,
            writes_depth: false,
            depth_compare: wgpu::CompareFunction::GreaterEqual,
            blend: Some(wgpu::BlendState::ALPHA_BLENDING),
            colours: wgpu::ColorWrites::ALL,
            bias: wgpu::DepthBiasState::default(),
            constants: &[],
        };
        let lines_through = scene_pipeline(&Stage {
            name: "lines through everything",
            depth_compare: wgpu::CompareFunction::Always,
            constants: &[("line_opacity", HIDDEN_LINK_OPACITY)],
            ..lines
        });
        let lines = scene_pipeline(&lines);
        let blit = blit_pipeline(device, blit_format, None);
        let underlay = blit_pipeline(device, COLOUR_FORMAT, Some(samples));
        Self {
            view_layout,
            background,
            mesh,
            mesh_behind_outlines,
            depth,
            depth_behind_outlines,
            underlay,
            lines,
            lines_through,
            blit,
        }
    }
}

/// Copies a picture into a pass: a window's, or the scene's of so many samples, whose depth stays.
fn blit_pipeline(
    device: &wgpu::Device,
    format: wgpu::TextureFormat,
    scene_samples: Option<u32>,
) -> wgpu::RenderPipeline {
    let module = device.create_shader_module(wgpu::include_wgsl!("blit.wgsl"));
    let encodes = f64::from(u8::from(format.is_srgb()));
    device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some("blit"),
        layout: None,
        vertex: wgpu::VertexState {
            module: &module,
            entry_point: Some("blit_vertex"),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            buffers: &[],
        },
        primitive: wgpu::PrimitiveState::default(),
        depth_stencil: scene_samples.map(|_| depth(false, wgpu::CompareFunction::Always)),
        multisample: wgpu::MultisampleState { count: scene_samples.unwrap_or(1), ..Default::default() },
        fragment: Some(wgpu::FragmentState {
            module: &module,
            entry_point: Some("blit_fragment"),
            compilation_options: wgpu::PipelineCompilationOptions {
                constants: &[("target_encodes", encodes)],
                ..Default::default()
            },
            targets: &[Some(format.into())],
        }),
        multiview_mask: None,
        cache: None,
    })
}
