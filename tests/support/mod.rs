//! Small scene files for the tests, written to a temporary folder.

mod folder;

pub use folder::Folder;

/// A GLB file of a JSON text and a binary chunk.
pub fn glb(json: &str, binary: &[u8]) -> Vec<u8> {
    let chunk = |kind: &[u8; 4], content: &[u8], filler: u8| {
        let mut padded = content.to_vec();
        padded.resize(content.len().next_multiple_of(4), filler);
        [&(padded.len() as u32).to_le_bytes()[..], kind, &padded].concat()
    };
    let chunks = [chunk(b"JSON", json.as_bytes(), b' '), chunk(b"BIN\0", binary, 0)].concat();
    let length = 12 + chunks.len() as u32;
    [b"glTF", &2_u32.to_le_bytes()[..], &length.to_le_bytes()[..], &chunks].concat()
}

/// Four corners of a unit square in the plane z = 0 and the indices of its two triangles (as u16),
/// facing +z.
pub fn square_bytes() -> Vec<u8> {
    let corners: [[f32; 3]; 4] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
    let indices: [u16; 6] = [0, 1, 2, 0, 2, 3];
    let corners = corners.iter().flatten().flat_map(|value| value.to_le_bytes());
    corners.chain(indices.iter().flat_map(|index| index.to_le_bytes())).collect()
}

/// A glTF text around [`square_bytes`]; `rest` holds nodes, materials and whatever else.
pub fn square_json(rest: &str) -> String {
    format!(
        r#"{{"asset": {{"version": "2.0"}}, "scene": 0,
        "buffers": [{{"byteLength": 60}}],
        "bufferViews": [{{"buffer": 0, "byteLength": 48}}, {{"buffer": 0, "byteOffset": 48, "byteLength": 12}}],
        "accessors": [
            {{"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3"}},
            {{"bufferView": 1, "componentType": 5123, "count": 6, "type": "SCALAR"}}],
        {rest}}}"#
    )
}
