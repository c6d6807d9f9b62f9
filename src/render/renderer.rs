//! Draws snapshots with wgpu: uploads what changed, records one pass, keeps the finished picture.

use std::sync::Arc;

use bytemuck::cast_slice;

use super::buffer::GrowingBuffer;
use super::gathered::Pixels;
use super::overlay::{self, Line};
use super::pipelines::{COLOUR_FORMAT, DEPTH_FORMAT, Pipelines, picture_binding, uniform};
use super::reading::{MOST_ISOLINES, Reading, Spacing, at_vertices, line_colour};
use super::target::Target;
use super::underlay::Underlay;
use super::{Camera, Display, MAX_SIZE, Marks, Overlay, RenderError};
use crate::base::photometry::Quantity;
use crate::read::picture::sky_behind;
use crate::scene::outside::Outside;
use crate::solve::snapshot::{ClusterBox, Mesh, Snapshot};

/// Samples per pixel where drawing is cheap.
pub(super) const SAMPLES: u32 = 4;

/// Pixels of a picture for each of the sky behind it, each way.
const SKY_STEP: u32 = 4;

/// Lines are cut this many near planes before the eye: nearer, they would be wider than the
/// picture.
const LINE_NEAR: f32 = 100.0;

/// Content of one picture.
#[derive(Clone, Copy)]
pub struct Frame<'a> {
    /// The solution; distinguished from the one before by mesh, generation and serial, so that only
    /// what changed is uploaded.
    pub snapshot: &'a Snapshot,
    /// From where.
    pub camera: &'a Camera,
    /// How bright.
    pub display: &'a Display,
    /// Sky and sun behind the scene, where they shine.
    pub outside: Option<&'a Arc<Outside>>,
    /// A picture of this view and size that was gathered, in place of the mesh.
    pub gathered: Option<&'a Arc<Pixels>>,
    /// With what drawn over it.
    pub overlay: &'a Overlay,
    /// Width and height, pixels.
    pub size: [u32; 2],
}

/// Samples per pixel that suit a window on an adapter: 1 on software ones, where drawing takes the
/// solver's cores, otherwise 4.
pub fn sample_count(adapter: &wgpu::Adapter) -> u32 {
    let is_software = adapter.get_info().device_type == wgpu::DeviceType::Cpu;
    if is_software { 1 } else { supported_samples(adapter) }
}

/// 4 samples where the adapter takes them for colour and depth, otherwise 1.
pub(super) fn supported_samples(adapter: &wgpu::Adapter) -> u32 {
    let supported = [COLOUR_FORMAT, DEPTH_FORMAT]
        .iter()
        .all(|&format| adapter.get_texture_format_features(format).flags.sample_count_supported(SAMPLES));
    if supported { SAMPLES } else { 1 }
}

/// The uniform `Reading` of scene.wgsl.
#[derive(Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
struct ReadingUniform {
    ends: [f32; 2],
    fills: u32,
    is_logarithmic: u32,
    line_count: u32,
    padding: [u32; 3],
    lines: [[f32; 4]; MOST_ISOLINES],
    stops: [[f32; 4]; 10],
}

impl ReadingUniform {
    fn new(reading: &Reading) -> Self {
        let Reading { scale, fills, isolines, .. } = reading;
        let encoded = |colour: [u8; 3]| colour.map(|channel| f32::from(channel) / 255.0);
        let with = |[r, g, b]: [f32; 3], value: f32| [r, g, b, value];
        let mut lines = [[0.0; 4]; MOST_ISOLINES];
        for (line, &value) in lines.iter_mut().zip(isolines.values()) {
            *line = with(encoded(line_colour(reading, value)), value);
        }
        Self {
            ends: scale.ends(),
            fills: u32::from(*fills),
            is_logarithmic: u32::from(scale.spacing == Spacing::Logarithmic),
            line_count: isolines.values().len() as u32,
            padding: [0; 3],
            lines,
            stops: scale.ramp.stops().map(|stop| with(encoded(stop), 1.0)),
        }
    }
}

/// The uniform `View` of scene.wgsl.
#[derive(Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
struct ViewUniform {
    clip_from_world: [[f32; 4]; 4],
    size: [f32; 2],
    exposure: f32,
    line_near: f32,
    reading: ReadingUniform,
}

/// In place of an exposure: vertices carry colours.
const COLOURS_AS_THEY_ARE: f32 = -1.0;

/// Lines on the graphics device and what they were made from.
struct LineSet<Key> {
    buffer: GrowingBuffer,
    count: u32,
    key: Option<Key>,
}

impl<Key: PartialEq> LineSet<Key> {
    fn new(what: &'static str) -> Self {
        Self { buffer: GrowingBuffer::new(what, wgpu::BufferUsages::VERTEX), count: 0, key: None }
    }

    fn clear(&mut self) {
        (self.count, self.key) = (0, None);
    }

    /// Makes and uploads the lines unless those of the key are there.
    fn update<Made: AsRef<[Line]>>(
        &mut self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        key: Key,
        make: impl FnOnce() -> Made,
    ) -> Result<(), RenderError> {
        if self.key.as_ref() != Some(&key) {
            self.clear();
            let lines = make();
            let lines = lines.as_ref();
            self.buffer.write(device, queue, cast_slice(lines))?;
            self.count = lines.len() as u32;
            self.key = Some(key);
        }
        Ok(())
    }

    fn draw(&self, pass: &mut wgpu::RenderPass<'_>, pipeline: &wgpu::RenderPipeline) {
        if self.count > 0
            && let Some(lines) = self.buffer.contents()
        {
            pass.set_pipeline(pipeline);
            pass.set_vertex_buffer(0, lines);
            pass.draw(0..4, 0..self.count);
        }
    }
}

/// Tells shared data apart by where it lies; holding it keeps the place from being used again.
struct Same<T>(Arc<T>);

impl<T> PartialEq for Same<T> {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.0, &other.0)
    }
}

/// Owns what the picture needs on the graphics device.
pub struct SceneRenderer {
    device: wgpu::Device,
    queue: wgpu::Queue,
    samples: u32,
    pipelines: Pipelines,
    view_buffer: wgpu::Buffer,
    view_binding: wgpu::BindGroup,
    sampler: wgpu::Sampler,
    target: Option<(Target, wgpu::BindGroup)>,

    positions: GrowingBuffer,
    radiosities: GrowingBuffer,
    indices: GrowingBuffer,
    index_count: u32,
    mesh: Option<Same<Mesh>>,
    /// Generation and serial of the radiosities on the device.
    shown: Option<(u64, u64)>,
    /// The quantity that is read off the surfaces, and what it is there.
    measured: GrowingBuffer,
    measured_as: Option<Quantity>,
    underlay: Option<Underlay>,
    /// The sky behind a picture of the mesh.
    sky: Option<Underlay>,
    smooth_sampler: wgpu::Sampler,

    outlines: LineSet<Same<Mesh>>,
    boxes: LineSet<(Same<Vec<ClusterBox>>, u16)>,
    marks: LineSet<Marks>,
}

impl SceneRenderer {
    /// A renderer with so many samples per pixel ([`sample_count`]), which can blit into targets of
    /// one format.
    pub fn new(device: wgpu::Device, queue: wgpu::Queue, samples: u32, blit_format: wgpu::TextureFormat) -> Self {
        let pipelines = Pipelines::new(&device, samples, blit_format);
        let (view_buffer, view_binding) = uniform(&device, "view", size_of::<ViewUniform>(), &pipelines.view_layout);
        let sampler = device.create_sampler(&wgpu::SamplerDescriptor { label: Some("picture"), ..Default::default() });
        let smooth_sampler = device.create_sampler(&wgpu::SamplerDescriptor {
            label: Some("sky"),
            mag_filter: wgpu::FilterMode::Linear,
            ..Default::default()
        });
        Self {
            device,
            queue,
            samples,
            pipelines,
            view_buffer,
            view_binding,
            sampler,
            target: None,
            positions: GrowingBuffer::new("mesh vertices", wgpu::BufferUsages::VERTEX),
            radiosities: GrowingBuffer::new("vertex radiosities", wgpu::BufferUsages::VERTEX),
            indices: GrowingBuffer::new("mesh triangles", wgpu::BufferUsages::INDEX),
            index_count: 0,
            mesh: None,
            shown: None,
            measured: GrowingBuffer::new("vertex readings", wgpu::BufferUsages::VERTEX),
            measured_as: None,
            underlay: None,
            sky: None,
            smooth_sampler,
            outlines: LineSet::new("element outlines"),
            boxes: LineSet::new("cluster boxes"),
            marks: LineSet::new("marks"),
        }
    }

    /// Uploads what changed and records the drawing of one picture into the renderer's own texture.
    ///
    /// # Errors
    /// A size of zero or beyond the adapter's limits, or a mesh beyond them; the picture before
    /// stays.
    pub fn draw(&mut self, encoder: &mut wgpu::CommandEncoder, frame: &Frame<'_>) -> Result<(), RenderError> {
        self.check_size(frame.size)?;
        self.upload(frame.snapshot)?;
        let reading = frame.display.reading.filter(|_| !frame.display.as_colours);
        self.upload_reading(frame.snapshot, reading.map(|reading| reading.quantity))?;
        self.upload_lines(frame.snapshot, frame.overlay)?;
        self.upload_gathered(frame.gathered.filter(|pixels| pixels.size == frame.size));
        self.upload_sky(frame);
        let [width, height] = frame.size.map(|side| side as f32);
        let view = ViewUniform {
            clip_from_world: frame.camera.clip_from_world(width / height).to_cols_array_2d(),
            size: [width, height],
            exposure: match frame.display.as_colours {
                true => COLOURS_AS_THEY_ARE,
                false => frame.display.exposure,
            },
            line_near: LINE_NEAR * frame.camera.near(),
            reading: reading.as_ref().map_or(bytemuck::Zeroable::zeroed(), ReadingUniform::new),
        };
        self.queue.write_buffer(&self.view_buffer, 0, bytemuck::bytes_of(&view));
        if self.target.as_ref().is_none_or(|(target, _)| target.size != frame.size) {
            self.target = Some(self.make_target(frame.size));
        }
        if let Some((target, _)) = &self.target {
            self.record(encoder, target);
        }
        Ok(())
    }

    /// Fills the viewport of a pass with the last picture; nothing before the first one.
    pub fn blit(&self, pass: &mut wgpu::RenderPass<'_>) {
        if let Some((_, binding)) = &self.target {
            pass.set_pipeline(&self.pipelines.blit);
            pass.set_bind_group(0, binding, &[]);
            pass.draw(0..3, 0..1);
        }
    }

    /// The last picture, `Rgba8Unorm`, gamma-encoded.
    pub fn picture(&self) -> Option<&wgpu::Texture> {
        self.target.as_ref().map(|(target, _)| &target.picture)
    }

    /// Forgets which snapshot is shown, so that the next one is uploaded whatever its generation
    /// and serial say.
    pub fn forget(&mut self) {
        self.shown = None;
    }

    /// # Errors
    /// A size of zero or beyond the adapter's limits.
    pub(super) fn check_size(&self, [width, height]: [u32; 2]) -> Result<(), RenderError> {
        let limit = self.device.limits().max_texture_dimension_2d.min(MAX_SIZE);
        let allowed = 1..=limit;
        if allowed.contains(&width) && allowed.contains(&height) {
            Ok(())
        } else {
            Err(RenderError::Size { width, height, limit })
        }
    }

    fn upload(&mut self, snapshot: &Snapshot) -> Result<(), RenderError> {
        let (device, queue) = (&self.device, &self.queue);
        let mesh = Same(snapshot.mesh.clone());
        if self.mesh.as_ref() != Some(&mesh) {
            (self.mesh, self.shown, self.index_count) = (None, None, 0);
            self.positions.write(device, queue, cast_slice(&mesh.0.positions))?;
            self.indices.write(device, queue, cast_slice(&mesh.0.triangles))?;
            self.index_count = 3 * mesh.0.triangles.len() as u32;
            self.mesh = Some(mesh);
        }
        let identity = (snapshot.generation, snapshot.serial);
        if self.shown != Some(identity) {
            self.radiosities.write(device, queue, cast_slice(&snapshot.vertex_radiosity))?;
            self.shown = Some(identity);
            self.measured_as = None;
        }
        Ok(())
    }

    /// Uploads what is read off the surfaces of the snapshot on the device.
    fn upload_reading(&mut self, snapshot: &Snapshot, quantity: Option<Quantity>) -> Result<(), RenderError> {
        if let Some(quantity) = quantity
            && self.measured_as != Some(quantity)
        {
            self.measured_as = None;
            self.measured.write(&self.device, &self.queue, cast_slice(&at_vertices(snapshot, quantity)))?;
            self.measured_as = Some(quantity);
        }
        Ok(())
    }

    /// Uploads a gathered picture, or forgets the one before.
    fn upload_gathered(&mut self, pixels: Option<&Arc<Pixels>>) {
        let is_there = |underlay: &Underlay| pixels.is_some_and(|pixels| underlay.is_of(pixels));
        if !self.underlay.as_ref().is_some_and(is_there) {
            let looks = (&self.pipelines.underlay, &self.sampler);
            self.underlay = pixels.map(|pixels| Underlay::new(&self.device, &self.queue, looks, pixels));
        }
    }

    /// Uploads the sky behind a picture of the mesh, coarser than the picture: it is smooth.
    fn upload_sky(&mut self, frame: &Frame<'_>) {
        let is_seen = self.underlay.is_none() && !frame.display.as_colours;
        let outside = frame.outside.filter(|outside| is_seen && outside.has_sky());
        self.sky = outside.map(|outside| {
            let size = frame.size.map(|side| side.div_ceil(SKY_STEP).max(2));
            let [width, height] = frame.size.map(|side| side as f32);
            let pixels = sky_behind(outside, &frame.camera.lens(width / height), frame.display.exposure, size);
            let pixels = Arc::new(Pixels { size, pixels, labels: Vec::new() });
            Underlay::new(&self.device, &self.queue, (&self.pipelines.underlay, &self.smooth_sampler), &pixels)
        });
    }

    fn upload_lines(&mut self, snapshot: &Snapshot, overlay: &Overlay) -> Result<(), RenderError> {
        let (device, queue) = (&self.device, &self.queue);
        if overlay.elements {
            let mesh = &snapshot.mesh;
            self.outlines.update(device, queue, Same(mesh.clone()), || overlay::element_outlines(mesh))?;
        } else {
            self.outlines.clear();
        }
        if let Some(level) = overlay.clusters {
            let clusters = &snapshot.clusters;
            let key = (Same(clusters.clone()), level);
            self.boxes.update(device, queue, key, || overlay::cluster_boxes(clusters, level))?;
        } else {
            self.boxes.clear();
        }
        if let Some(lines) = &overlay.marks.0 {
            self.marks.update(device, queue, overlay.marks.clone(), || lines.as_slice())?;
        } else {
            self.marks.clear();
        }
        Ok(())
    }

    fn make_target(&self, size: [u32; 2]) -> (Target, wgpu::BindGroup) {
        let target = Target::new(&self.device, size, self.samples, COLOUR_FORMAT);
        let binding = picture_binding(&self.device, &self.pipelines.blit, &target.picture_view, &self.sampler);
        (target, binding)
    }

    /// Background or sky, and mesh, or a gathered picture and the depth of the mesh, then lines:
    /// those in surfaces where they are seen, links faintly through everything as well.
    fn record(&self, encoder: &mut wgpu::CommandEncoder, target: &Target) {
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("scene"),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: target.samples_view.as_ref().unwrap_or(&target.picture_view),
                depth_slice: None,
                resolve_target: target.samples_view.as_ref().map(|_| &target.picture_view),
                ops: wgpu::Operations {
                    load: wgpu::LoadOp::Clear(wgpu::Color::BLACK),
                    store: if target.samples_view.is_some() { wgpu::StoreOp::Discard } else { wgpu::StoreOp::Store },
                },
            })],
            depth_stencil_attachment: Some(target.fresh_depth()),
            ..Default::default()
        });
        if let Some(underlay) = &self.underlay {
            underlay.draw(&mut pass, &self.pipelines.underlay);
            pass.set_bind_group(0, &self.view_binding, &[]);
        } else if let Some(sky) = &self.sky {
            sky.draw(&mut pass, &self.pipelines.underlay);
            pass.set_bind_group(0, &self.view_binding, &[]);
        } else {
            pass.set_bind_group(0, &self.view_binding, &[]);
            pass.set_pipeline(&self.pipelines.background);
            pass.draw(0..3, 0..1);
        }
        if let (Some(positions), Some(radiosities), Some(indices)) =
            (self.positions.contents(), self.radiosities.contents(), self.indices.contents())
        {
            let outlined = self.outlines.count > 0;
            pass.set_pipeline(match (&self.underlay, outlined) {
                (Some(_), true) => &self.pipelines.depth_behind_outlines,
                (Some(_), false) => &self.pipelines.depth,
                (None, true) => &self.pipelines.mesh_behind_outlines,
                (None, false) => &self.pipelines.mesh,
            });
            pass.set_vertex_buffer(0, positions);
            pass.set_vertex_buffer(1, radiosities);
            // Where nothing is read, anything of that size will do.
            let measured = self.measured.contents().filter(|_| self.measured_as.is_some());
            pass.set_vertex_buffer(2, measured.unwrap_or(radiosities));
            pass.set_index_buffer(indices, wgpu::IndexFormat::Uint32);
            pass.draw_indexed(0..self.index_count, 0, 0..1);
        }
        let lines = &self.pipelines.lines;
        self.outlines.draw(&mut pass, lines);
        self.boxes.draw(&mut pass, lines);
        self.marks.draw(&mut pass, &self.pipelines.lines_through);
        self.marks.draw(&mut pass, lines);
    }
}
