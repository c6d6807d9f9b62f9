//! The window's way: the renderer draws on a foreign encoder, and its picture is blitted into a
//! foreign pass.
//!
//! Where there is no graphics adapter the test says so and checks nothing.
#![cfg(feature = "gui")]

#[path = "support/left_out.rs"]
mod left_out;

use std::sync::Arc;

use glam::Vec3;
use selflink::render::{Camera, Display, Frame, Overlay, SceneRenderer, sample_count};
use selflink::scene::CameraPose;
use selflink::solve::{Mesh, Snapshot, Stats};

const SIDE: u32 = 64;

fn device() -> Option<(wgpu::Adapter, wgpu::Device, wgpu::Queue)> {
    let instance = wgpu::Instance::default();
    let adapter = pollster::block_on(instance.request_adapter(&wgpu::RequestAdapterOptions::default()));
    let Ok(adapter) = adapter else {
        left_out::left_out("a blit; no graphics adapter draws it (install mesa-vulkan-drivers)");
        return None;
    };
    let (device, queue) =
        pollster::block_on(adapter.request_device(&wgpu::DeviceDescriptor::default())).expect("the default limits");
    Some((adapter, device, queue))
}

/// A triangle that fills the upper left half of the picture with one radiosity, W/m².
fn upper_left(radiosity: [f32; 3], serial: u64, mesh: &Arc<Mesh>) -> Snapshot {
    Snapshot {
        generation: 1,
        serial,
        mesh: mesh.clone(),
        vertex_radiosity: vec![radiosity; 3],
        vertex_irradiance: vec![[0.0; 3]; 3],
        leaf_irradiance: Vec::new(),
        leaf_radiosity: Vec::new(),
        clusters: Arc::default(),
        former_step: None,
        field: None,
        solution_view: None,
        stats: Stats::default(),
    }
}

fn read(device: &wgpu::Device, queue: &wgpu::Queue, texture: &wgpu::Texture) -> Vec<[u8; 4]> {
    let buffer = device.create_buffer(&wgpu::BufferDescriptor {
        label: None,
        size: u64::from(4 * SIDE * SIDE),
        usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
        mapped_at_creation: false,
    });
    let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    let layout = wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(4 * SIDE), rows_per_image: None };
    encoder.copy_texture_to_buffer(
        texture.as_image_copy(),
        wgpu::TexelCopyBufferInfo { buffer: &buffer, layout },
        texture.size(),
    );
    queue.submit([encoder.finish()]);
    buffer.map_async(wgpu::MapMode::Read, .., |result| result.expect("a fresh buffer can be mapped"));
    device.poll(wgpu::PollType::wait_indefinitely()).expect("the device works");
    let bytes = buffer.get_mapped_range(..).expect("mapped above");
    bytes.chunks_exact(4).map(|pixel| [pixel[0], pixel[1], pixel[2], pixel[3]]).collect()
}

#[test]
fn a_window_shows_the_picture_upright_and_in_its_colours_whatever_its_format() {
    let Some((adapter, device, queue)) = device() else { return };
    let pose = CameraPose { eye: Vec3::new(0.0, 0.0, 1.0), target: Vec3::ZERO, up: Vec3::Y, hfov_deg: 90.0 };
    let camera = Camera::from_pose(&pose, 1.0, (Vec3::splat(-1.0), Vec3::splat(1.0)));
    let mesh = Arc::new(Mesh {
        positions: vec![[-1.0, -1.0, 0.0], [1.0, 1.0, 0.0], [-1.0, 1.0, 0.0]],
        triangles: vec![[0, 1, 2]],
        triangle_leaf: vec![0],
        ..Mesh::default()
    });
    for format in [wgpu::TextureFormat::Rgba8Unorm, wgpu::TextureFormat::Rgba8UnormSrgb] {
        let samples = sample_count(&adapter);
        let mut renderer = SceneRenderer::new(device.clone(), queue.clone(), samples, format);
        let window = device.create_texture(&wgpu::TextureDescriptor {
            label: None,
            size: wgpu::Extent3d { width: SIDE, height: SIDE, depth_or_array_layers: 1 },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format,
            usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::COPY_SRC,
            view_formats: &[],
        });
        let view = window.create_view(&wgpu::TextureViewDescriptor::default());
        let mut show = |snapshot: &Snapshot| {
            let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
            let (display, overlay) = (&Display::default(), &Overlay::default());
            let frame =
                Frame { snapshot, camera: &camera, display, overlay, size: [SIDE; 2], outside: None, gathered: None };
            renderer.draw(&mut encoder, &frame).expect("a small picture");
            let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
                color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                    view: &view,
                    depth_slice: None,
                    resolve_target: None,
                    ops: wgpu::Operations::default(),
                })],
                ..Default::default()
            });
            renderer.blit(&mut pass);
            drop(pass);
            queue.submit([encoder.finish()]);
            let picture = renderer.picture().expect("drawn above");
            (read(&device, &queue, picture), read(&device, &queue, &window))
        };

        let (picture, window) = show(&upper_left([0.1, 0.5, 2.0], 1, &mesh));
        // Truth: the picture itself, byte by byte; an sRGB target encodes anew and may round by 1.
        let differ = picture.as_flattened().iter().zip(window.as_flattened()).map(|(a, b)| a.abs_diff(*b)).max();
        assert!(differ <= Some(u8::from(format.is_srgb())), "{format:?}: {differ:?}");
        let (upper_left_pixel, lower_right_pixel) = (10 * SIDE as usize + 10, 53 * SIDE as usize + 53);
        assert!(window[upper_left_pixel][2] > 200 && window[lower_right_pixel][2] < 100);

        // New radiosities of the same mesh are taken up by their serial; the same serial is not
        // uploaded again.
        let (_, brighter) = show(&upper_left([2.0, 0.5, 0.1], 2, &mesh));
        assert!(brighter[upper_left_pixel][0] > 200);
        let (_, unchanged) = show(&upper_left([0.0; 3], 2, &mesh));
        assert_eq!(unchanged, brighter);
        // A new mesh is taken up whatever its serial says.
        let (_, other) = show(&upper_left([0.1, 2.0, 0.1], 2, &Arc::new((*mesh).clone())));
        assert!(other[upper_left_pixel][1] > 200 && other[upper_left_pixel][0] < 200);
    }
}
