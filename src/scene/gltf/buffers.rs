//! The bytes behind a glTF document, every access checked: a damaged file gives a sentence, never a
//! panic.
//!
//! The readers of the `gltf` crate trust offsets and counts; here they are compared with what is
//! there first.

use std::array;
use std::borrow::Cow;
use std::collections::HashMap;

use gltf::json::accessor::{Accessor, ComponentType, Type};
use gltf::json::validation::Checked;
use gltf::json::{Index, Root, buffer, image};
use percent_encoding::percent_decode_str;

use super::compression::{MOST_DECODED, Meshopt};
use crate::scene::draft::MOST_POLYGONS;
use crate::scene::files::{FileError, MOST_BYTES, SceneFiles, find, name_of};
use crate::scene::sanitize::quoted;

/// An accessor without data holds zeros, but for what is listed: more of them would only be one
/// point again and again.
const MOST_ZEROS: usize = 1 << 16;

/// Description of a fault, without the file and the place.
pub(super) type Problem = String;

/// A glTF document's JSON and its binary data.
pub(super) struct GltfData<'a> {
    pub root: &'a Root,
    files: &'a dyn SceneFiles,
    /// Contents that were read, each file once; buffers are numbers into it.
    contents: Vec<Vec<u8>>,
    buffers: Vec<usize>,
    /// Content of the views that are compressed, or why it cannot be used.
    decoded: HashMap<usize, Result<Vec<u8>, Problem>>,
}

/// Marks a buffer without data, which may stand in for what is compressed.
const NO_CONTENT: usize = usize::MAX;

impl<'a> GltfData<'a> {
    /// Reads every buffer; `blob` is the binary chunk of a GLB file.
    pub fn read(files: &'a dyn SceneFiles, root: &'a Root, blob: Option<Vec<u8>>) -> Result<Self, Problem> {
        let mut blob = blob;
        let mut bytes_left = MOST_BYTES;
        let mut contents: Vec<Vec<u8>> = Vec::new();
        let mut buffers = Vec::with_capacity(root.buffers.len());
        // Many buffers can name one file.
        let mut known: HashMap<Option<&str>, usize> = HashMap::new();
        for (index, buffer) in root.buffers.iter().enumerate() {
            let uri = buffer.uri.as_deref();
            if uri.is_none() && (index > 0 || blob.is_none()) && is_stand_in(buffer) {
                buffers.push(NO_CONTENT);
                continue;
            }
            let content = match known.get(&uri) {
                Some(&content) => content,
                None => {
                    let bytes = match uri {
                        Some(uri) => read_uri(files, uri, bytes_left),
                        None => blob.take().ok_or_else(|| "it has no data".to_owned()),
                    };
                    let bytes = bytes.map_err(|problem| format!("buffer {index}: {problem}"))?;
                    bytes_left = bytes_left.saturating_sub(bytes.len() as u64);
                    known.insert(uri, contents.len());
                    contents.push(bytes);
                    contents.len() - 1
                }
            };
            let bytes = &contents[content];
            if (bytes.len() as u64) < buffer.byte_length.0 {
                let (needed, there) = (buffer.byte_length.0, bytes.len());
                return Err(format!("buffer {index} should hold {needed} bytes but has {there}; the file is cut off"));
            }
            buffers.push(content);
        }
        let mut data = Self { root, files, contents, buffers, decoded: HashMap::new() };
        data.decode_views();
        Ok(data)
    }

    /// Decodes the views that are compressed.
    fn decode_views(&mut self) {
        let mut bytes_left = MOST_DECODED;
        for (number, view) in self.root.buffer_views.iter().enumerate() {
            let Some(compressed) = Meshopt::of(view) else { continue };
            let decoded = compressed.and_then(|compressed| {
                bytes_left = bytes_left
                    .checked_sub(compressed.decoded_bytes())
                    .ok_or_else(|| format!("more than {} MiB are compressed", MOST_DECODED >> 20))?;
                let content = self.content(compressed.buffer);
                let bytes = content.and_then(|it| slice(it, compressed.byte_offset, compressed.byte_length));
                compressed.decode(bytes.ok_or("it reaches past its buffer; the file is damaged or cut off")?)
            });
            self.decoded.insert(number, decoded.map_err(|problem| format!("buffer view {number}: {problem}")));
        }
    }

    /// The bytes of a buffer, if there are any.
    fn content(&self, buffer: usize) -> Option<&[u8]> {
        self.buffers.get(buffer).and_then(|content| self.contents.get(*content)).map(Vec::as_slice)
    }

    /// Elements of `N` components; integers are scaled as `normalized` says.
    pub fn vectors<const N: usize>(&self, index: Index<Accessor>) -> Result<Vec<[f64; N]>, Problem> {
        let accessor = self.accessor(index)?;
        if self.components(index) != Some(N) {
            return Err(format!("accessor {} does not hold {N} numbers for each element", index.value()));
        }
        self.elements(index, accessor, |element| element)
    }

    /// Number of components of an accessor's elements.
    pub fn components(&self, index: Index<Accessor>) -> Option<usize> {
        match self.root.accessors.get(index.value())?.type_ {
            Checked::Valid(Type::Scalar) => Some(1),
            Checked::Valid(Type::Vec2) => Some(2),
            Checked::Valid(Type::Vec3) => Some(3),
            Checked::Valid(Type::Vec4 | Type::Mat2) => Some(4),
            Checked::Valid(Type::Mat3) => Some(9),
            Checked::Valid(Type::Mat4) => Some(16),
            Checked::Invalid => None,
        }
    }

    /// The bytes of a buffer view.
    pub fn view_bytes(&self, index: Index<buffer::View>) -> Result<&[u8], Problem> {
        Ok(self.view(index)?.0)
    }

    /// Vertex indices of a primitive.
    pub fn indices(&self, index: Index<Accessor>) -> Result<Vec<u32>, Problem> {
        let accessor = self.accessor(index)?;
        let component = component_type(accessor)?;
        let is_index = matches!(component, ComponentType::U8 | ComponentType::U16 | ComponentType::U32);
        if !matches!(accessor.type_, Checked::Valid(Type::Scalar)) || !is_index || accessor.normalized {
            return Err(format!("accessor {} holds no vertex indices", index.value()));
        }
        self.elements(index, accessor, |[value]| value as u32)
    }

    /// The encoded bytes of an image.
    pub fn image(&self, image: &image::Image) -> Result<Cow<'_, [u8]>, Problem> {
        match (&image.buffer_view, &image.uri) {
            (Some(view), _) => Ok(Cow::Borrowed(self.view(*view)?.0)),
            (None, Some(uri)) => read_uri(self.files, uri, MOST_BYTES).map(Cow::Owned),
            (None, None) => Err("the image has no data".to_owned()),
        }
    }

    fn accessor(&self, index: Index<Accessor>) -> Result<&'a Accessor, Problem> {
        self.root.accessors.get(index.value()).ok_or_else(|| format!("there is no accessor {}", index.value()))
    }

    /// The bytes of a buffer view, and its stride if it has one.
    fn view(&self, index: Index<buffer::View>) -> Result<(&[u8], Option<usize>), Problem> {
        let number = index.value();
        let view = self.root.buffer_views.get(number).ok_or_else(|| format!("there is no buffer view {number}"))?;
        if let Some(decoded) = self.decoded.get(&number) {
            let stride = view.byte_stride.map(|stride| stride.0);
            return decoded.as_ref().map(|bytes| (&bytes[..], stride)).map_err(Clone::clone);
        }
        let bytes = self.content(view.buffer.value()).ok_or_else(|| format!("view {number} has no buffer"))?;
        slice(bytes, view.byte_offset.map_or(0, |offset| offset.0), view.byte_length.0)
            .map(|bytes| (bytes, view.byte_stride.map(|stride| stride.0)))
            .ok_or_else(|| format!("buffer view {number} reaches past its buffer; the file is damaged or cut off"))
    }

    /// All elements of an accessor with `N` components, sparse replacements included.
    fn elements<const N: usize, T: Clone>(
        &self,
        index: Index<Accessor>,
        accessor: &Accessor,
        from: impl Fn([f64; N]) -> T,
    ) -> Result<Vec<T>, Problem> {
        let number = index.value();
        let past = || format!("accessor {number} reaches past its data; the file is damaged or cut off");
        let component = component_type(accessor)?;
        let count = usize::try_from(accessor.count.0).map_err(|_| past())?;
        if count > 3 * MOST_POLYGONS {
            return Err(past());
        }
        let element = |bytes: &[u8]| -> T {
            let size = component.size();
            from(array::from_fn(|at| decode(component, accessor.normalized, &bytes[at * size..(at + 1) * size])))
        };
        let mut elements = match accessor.buffer_view {
            Some(view) => {
                let (bytes, stride) = self.view(view)?;
                let offset = accessor.byte_offset.map_or(0, |offset| offset.0);
                let items = Strided::new(bytes, offset, stride, N * component.size(), count).ok_or_else(past)?;
                items.iter().map(element).collect()
            }
            None if accessor.sparse.is_some() && count <= MOST_ZEROS => vec![from([0.0; N]); count],
            None => return Err(format!("accessor {number} has no data")),
        };
        let Some(sparse) = &accessor.sparse else { return Ok(elements) };
        let replaced = usize::try_from(sparse.count.0).map_err(|_| past())?;
        let Checked::Valid(index_type) = sparse.indices.component_type else {
            return Err(format!("accessor {number} has sparse indices of an unknown type"));
        };
        let (index_bytes, index_stride) = self.view(sparse.indices.buffer_view)?;
        let index_size = index_type.0.size();
        let (value_bytes, value_stride) = self.view(sparse.values.buffer_view)?;
        let value_size = N * component.size();
        let indices = Strided::new(index_bytes, sparse.indices.byte_offset.0, index_stride, index_size, replaced);
        let values = Strided::new(value_bytes, sparse.values.byte_offset.0, value_stride, value_size, replaced);
        for (at, value) in indices.ok_or_else(past)?.iter().zip(values.ok_or_else(past)?.iter()) {
            let slot = elements.get_mut(decode(index_type.0, false, at) as usize).ok_or_else(past)?;
            *slot = element(value);
        }
        Ok(elements)
    }
}

/// Whether a buffer without data only stands in for one that is compressed.
fn is_stand_in(buffer: &buffer::Buffer) -> bool {
    let others = buffer.extensions.as_ref().map(|it| &it.others);
    others.is_some_and(|it| it.keys().any(|name| name.ends_with("_meshopt_compression")))
}

/// Equally spaced items in a byte slice, all inside it.
struct Strided<'a> {
    bytes: &'a [u8],
    stride: usize,
    size: usize,
    count: usize,
}

impl<'a> Strided<'a> {
    /// `None` if an item would reach past the end.
    fn new(bytes: &'a [u8], offset: u64, stride: Option<usize>, size: usize, count: usize) -> Option<Self> {
        let stride = stride.unwrap_or(size);
        let bytes = bytes.get(usize::try_from(offset).ok()?..)?;
        let end = match count.checked_sub(1) {
            Some(last) => last.checked_mul(stride)?.checked_add(size)?,
            None => 0,
        };
        (stride >= size && end <= bytes.len()).then_some(Self { bytes, stride, size, count })
    }

    fn iter(&self) -> impl Iterator<Item = &'a [u8]> {
        let Self { bytes, stride, size, count } = *self;
        (0..count).map(move |item| &bytes[item * stride..item * stride + size])
    }
}

fn slice(bytes: &[u8], offset: u64, length: u64) -> Option<&[u8]> {
    let (offset, end) = (usize::try_from(offset).ok()?, usize::try_from(offset.checked_add(length)?).ok()?);
    bytes.get(offset..end)
}

fn component_type(accessor: &Accessor) -> Result<ComponentType, Problem> {
    match accessor.component_type {
        Checked::Valid(component) => Ok(component.0),
        Checked::Invalid => Err("an accessor has an unknown component type".to_owned()),
    }
}

/// One little-endian component, mapped to −1..1 or 0..1 where it is a normalised integer.
fn decode(component: ComponentType, normalized: bool, bytes: &[u8]) -> f64 {
    let (value, most) = match (component, bytes) {
        (ComponentType::I8, &[a]) => (f64::from(a as i8), f64::from(i8::MAX)),
        (ComponentType::U8, &[a]) => (f64::from(a), f64::from(u8::MAX)),
        (ComponentType::I16, &[a, b]) => (f64::from(i16::from_le_bytes([a, b])), f64::from(i16::MAX)),
        (ComponentType::U16, &[a, b]) => (f64::from(u16::from_le_bytes([a, b])), f64::from(u16::MAX)),
        (ComponentType::U32, &[a, b, c, d]) => (f64::from(u32::from_le_bytes([a, b, c, d])), f64::from(u32::MAX)),
        (ComponentType::F32, &[a, b, c, d]) => return f64::from(f32::from_le_bytes([a, b, c, d])),
        _ => (f64::NAN, 1.0),
    };
    if normalized { (value / most).max(-1.0) } else { value }
}

/// The bytes behind a URI: embedded, or a file in the scene's folder.
fn read_uri(files: &dyn SceneFiles, uri: &str, most: u64) -> Result<Vec<u8>, Problem> {
    if uri.starts_with("data:") {
        let data = gltf::buffer::Data::from_source(gltf::buffer::Source::Uri(uri), None);
        return data.map(|data| data.0).map_err(|error| format!("the embedded data cannot be decoded ({error})"));
    }
    // Some exporters write names as they are, percent signs included.
    let reference = percent_decode_str(uri).decode_utf8().unwrap_or(Cow::Borrowed(uri));
    if reference != uri
        && let Ok(bytes) = name_of(uri).and_then(|name| files.read(&name, most))
    {
        return Ok(bytes);
    }
    find(files, &reference, most).map_err(|error| match error {
        FileError::Outside => format!("{} lies outside the scene's folder", quoted(&reference)),
        error => format!("{} cannot be read ({error})", quoted(&reference)),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn items_never_reach_past_the_end() {
        let bytes = [0_u8; 10];
        let fits = |offset, stride, size, count| Strided::new(&bytes, offset, stride, size, count).is_some();
        assert!(fits(0, None, 5, 2) && fits(2, Some(6), 2, 2) && fits(10, None, 4, 0));
        assert!(!fits(1, None, 5, 2) && !fits(11, None, 1, 0) && !fits(0, Some(1), 2, 2));
        assert!(!fits(0, None, 12, usize::MAX) && !fits(u64::MAX, None, 1, 1));
    }
}
