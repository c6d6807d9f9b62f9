//! Compressed geometry: buffer views by meshopt (EXT_meshopt_compression), primitives by Draco
//! (KHR_draco_mesh_compression).
//!
//! Both decoders check their input; how much they may make of it is bounded here.

use draco_core::{DecodeLimits, DecoderBuffer, MeshDecoder};
use gltf::json::buffer::View;
use meshoptimizer_rs::Workspace;
use meshoptimizer_rs::codec::{BufferView, Filter, Mode};
use serde::Deserialize;

use super::buffers::Problem;
use crate::scene::draft::MOST_POLYGONS;
use crate::scene::sanitize;

/// The most bytes that a view or a primitive may become.
pub(super) const MOST_DECODED: usize = 1 << 30;

/// A view's compressed content.
#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Meshopt {
    pub buffer: usize,
    #[serde(default)]
    pub byte_offset: u64,
    pub byte_length: u64,
    byte_stride: usize,
    count: usize,
    mode: String,
    #[serde(default)]
    filter: Option<String>,
}

impl Meshopt {
    /// Compression of a view, if it is compressed.
    pub fn of(view: &View) -> Option<Result<Self, Problem>> {
        let others = &view.extensions.as_ref()?.others;
        let said =
            ["EXT_meshopt_compression", "KHR_meshopt_compression"].into_iter().find_map(|name| others.get(name))?;
        Some(Self::deserialize(said).map_err(|error| format!("its compression is not understood ({error})")))
    }

    /// Bytes that it becomes.
    pub fn decoded_bytes(&self) -> usize {
        self.count.saturating_mul(self.byte_stride)
    }

    /// Decodes its content.
    pub fn decode(&self, bytes: &[u8]) -> Result<Vec<u8>, Problem> {
        let damaged = |error: meshoptimizer_rs::Error| format!("its compressed data is damaged ({error:?})");
        let mode = Mode::parse(&self.mode).map_err(damaged)?;
        let filter = Filter::parse(self.filter.as_deref().unwrap_or("NONE")).map_err(damaged)?;
        let view = BufferView::new(mode, filter, self.count, self.byte_stride).map_err(damaged)?;
        view.decode(bytes, &mut Workspace::default()).map_err(damaged)
    }
}

/// A decoded primitive: triangles, and values of its attributes by the numbers that the file gives
/// them.
pub(super) struct DracoMesh {
    mesh: draco_core::Mesh,
}

impl DracoMesh {
    /// Decodes a primitive.
    pub fn decode(bytes: &[u8]) -> Result<Self, Problem> {
        let limits = DecodeLimits::default()
            .with_max_points(3 * MOST_POLYGONS as u64)
            .with_max_faces(MOST_POLYGONS as u64)
            .with_max_decoded_bytes(MOST_DECODED as u64);
        let mut mesh = draco_core::Mesh::new();
        let mut buffer = DecoderBuffer::new(bytes).with_limits(limits);
        let decoded = MeshDecoder::new().decode(&mut buffer, &mut mesh);
        decoded.map_err(|error| {
            // The decoder's own words may run over several lines.
            sanitize::sentence(&format!("its compressed data is damaged or of an unknown kind ({error})"))
        })?;
        Ok(Self { mesh })
    }

    /// Vertices.
    pub fn count(&self) -> usize {
        self.mesh.num_points()
    }

    /// Vertex indices, three for each triangle.
    pub fn indices(&self) -> Vec<u32> {
        self.mesh.faces().iter().flatten().map(|point| point.0).collect()
    }

    /// `N` values of each vertex, mapped to 0..1 or −1..1 where they are normalised integers.
    pub fn values<const N: usize>(&self, id: u32, normalized: bool) -> Option<Vec<[f32; N]>> {
        let attribute = self.mesh.attribute_by_unique_id(id)?;
        let most = match attribute.data_type() {
            _ if !normalized => 1.0,
            draco_core::DataType::Int8 => f32::from(i8::MAX),
            draco_core::DataType::Uint8 => f32::from(u8::MAX),
            draco_core::DataType::Int16 => f32::from(i16::MAX),
            draco_core::DataType::Uint16 => f32::from(u16::MAX),
            _ => 1.0,
        };
        let values = attribute.read_f32s(self.count(), N);
        Some(values.as_chunks::<N>().0.iter().map(|value| value.map(|value| (value / most).max(-1e30))).collect())
    }

    /// Number of values of each vertex.
    pub fn components(&self, id: u32) -> Option<u8> {
        Some(self.mesh.attribute_by_unique_id(id)?.num_components())
    }
}
