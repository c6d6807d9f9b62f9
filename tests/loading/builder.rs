//! glTF files in the making: the unit square of `support` as accessors 0 (positions) and 1
//! (indices), and whatever is added.

use crate::support::{glb, square_bytes};

/// A GLB file that grows.
pub struct Gltf {
    binary: Vec<u8>,
    views: Vec<String>,
    accessors: Vec<String>,
}

/// Component types of accessors.
pub const I8: u32 = 5120;
pub const U8: u32 = 5121;
pub const I16: u32 = 5122;
pub const U16: u32 = 5123;
pub const F32: u32 = 5126;

impl Gltf {
    pub fn square() -> Self {
        let square = square_bytes();
        let mut it = Self { binary: Vec::new(), views: Vec::new(), accessors: Vec::new() };
        it.accessor(&square[..48], F32, 4, "VEC3", "");
        it.accessor(&square[48..], U16, 6, "SCALAR", "");
        it
    }

    /// Adds a buffer view and gives its number.
    pub fn view(&mut self, bytes: &[u8]) -> usize {
        self.binary.resize(self.binary.len().next_multiple_of(4), 0);
        let at = self.binary.len();
        self.views.push(format!(r#"{{"buffer": 0, "byteOffset": {at}, "byteLength": {}}}"#, bytes.len()));
        self.binary.extend(bytes);
        self.views.len() - 1
    }

    /// Adds an accessor and gives its number; `more` begins with a comma.
    pub fn accessor(&mut self, bytes: &[u8], component: u32, count: usize, kind: &str, more: &str) -> usize {
        let view = self.view(bytes);
        self.accessors.push(format!(
            r#"{{"bufferView": {view}, "componentType": {component}, "count": {count}, "type": "{kind}"{more}}}"#
        ));
        self.accessors.len() - 1
    }

    /// Adds an accessor of so many values, each of so many bytes, that meshopt packed with a
    /// filter; integers are normalised.
    pub fn meshopt(
        &mut self,
        packed: &[u8],
        filter: &str,
        [count, stride]: [usize; 2],
        component: u32,
        kind: &str,
    ) -> usize {
        let view = self.view(packed);
        let plain = self.views[view].trim_end_matches('}').to_owned();
        let place = plain.trim_start_matches('{');
        self.views[view] = format!(
            r#"{plain}, "byteStride": {stride}, "extensions": {{"EXT_meshopt_compression": {{{place}, "byteStride": {stride},
            "count": {count}, "mode": "ATTRIBUTES", "filter": "{filter}"}}}}}}"#
        );
        let normalized = component != F32;
        self.accessors.push(format!(
            r#"{{"bufferView": {view}, "componentType": {component}, "count": {count}, "type": "{kind}", "normalized": {normalized}}}"#
        ));
        self.accessors.len() - 1
    }

    /// Adds an accessor of floats.
    pub fn floats<const N: usize>(&mut self, values: &[[f32; N]]) -> usize {
        let bytes: Vec<u8> = values.as_flattened().iter().flat_map(|value| value.to_le_bytes()).collect();
        let kind = if N == 16 { "MAT4".to_owned() } else { format!("VEC{N}") };
        self.accessor(&bytes, F32, values.len(), &kind, "")
    }

    /// The file; `rest` holds meshes, nodes, materials and whatever else, and starts with none of
    /// them.
    pub fn file(&self, rest: &str) -> Vec<u8> {
        let (views, accessors, length) = (self.views.join(", "), self.accessors.join(", "), self.binary.len());
        let json = format!(
            r#"{{"asset": {{"version": "2.0"}}, "buffers": [{{"byteLength": {length}}}], "bufferViews": [{views}],
            "accessors": [{accessors}], {rest}}}"#
        );
        glb(&json, &self.binary)
    }
}

/// One mesh of one primitive with further attributes (`, "COLOR_0": 2`) and a material, at one
/// node; `more` begins with a comma.
pub fn one_mesh(attributes: &str, material: &str, more: &str) -> String {
    format!(
        r#""meshes": [{{"primitives": [{{"attributes": {{"POSITION": 0{attributes}}}, "indices": 1, "material": 0}}]}}],
        "materials": [{{"name": "paint"{material}}}], "nodes": [{{"mesh": 0}}], "scenes": [{{"nodes": [0]}}]{more}"#
    )
}
