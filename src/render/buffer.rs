//! A graphics buffer that grows with what is written into it.

use super::RenderError;

/// Spare room that a buffer gets when it has to grow, as a divisor of its size: a refining mesh
/// seldom allocates.
const SPARE: u64 = 2;

/// Holds one array; its contents are replaced as a whole.
pub(super) struct GrowingBuffer {
    what: &'static str,
    usage: wgpu::BufferUsages,
    buffer: Option<wgpu::Buffer>,
    used: u64,
}

impl GrowingBuffer {
    /// An empty buffer for `what` (a plural, for error sentences).
    pub(super) fn new(what: &'static str, usage: wgpu::BufferUsages) -> Self {
        Self { what, usage: usage | wgpu::BufferUsages::COPY_DST, buffer: None, used: 0 }
    }

    /// Replaces the contents.
    ///
    /// # Errors
    /// More than the adapter's largest buffer; the old contents stay.
    pub(super) fn write(
        &mut self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        contents: &[u8],
    ) -> Result<(), RenderError> {
        let needed = contents.len() as u64;
        let limit = device.limits().max_buffer_size & !(wgpu::COPY_BUFFER_ALIGNMENT - 1);
        if needed > limit {
            return Err(RenderError::TooLarge {
                what: format!("the {} need", self.what),
                needed_mib: needed.div_ceil(1 << 20),
                limit_mib: limit >> 20,
                remedy: "a larger ε or a smaller scene",
            });
        }
        if self.buffer.as_ref().is_none_or(|buffer| buffer.size() < needed) {
            let roomy = (needed + needed / SPARE).next_multiple_of(wgpu::COPY_BUFFER_ALIGNMENT).clamp(1 << 10, limit);
            self.buffer = Some(device.create_buffer(&wgpu::BufferDescriptor {
                label: Some(self.what),
                size: roomy,
                usage: self.usage,
                mapped_at_creation: false,
            }));
        }
        if let Some(buffer) = &self.buffer
            && needed > 0
        {
            queue.write_buffer(buffer, 0, contents);
        }
        self.used = needed;
        Ok(())
    }

    /// The contents; `None` when there are none.
    pub(super) fn contents(&self) -> Option<wgpu::BufferSlice<'_>> {
        let buffer = self.buffer.as_ref().filter(|_| self.used > 0)?;
        Some(buffer.slice(..self.used))
    }
}
