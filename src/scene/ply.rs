//! PLY, as text or binary: faces of one material, with the colours and normals of its vertices.

use std::io::Cursor;

use glam::{DVec3, Vec3};
use ply_rs_bw::parser::{ParseError, Parser, Reader};
use ply_rs_bw::ply::{
    ElementDef, Encoding, Header, Property, PropertyAccess, PropertyAccessResult, PropertyType, ScalarType,
};

use super::GroupId;
use super::draft::{Draft, DraftMaterial, MOST_POLYGONS, NO_MATERIAL};
use super::face::{packed_colour, packed_normal};
use super::load_error::Fault;
use super::sanitize::{quoted, sentence};
use super::texture::linear_step;
use super::unit::Unit;

/// More of any element than this are refused.
const MOST_ELEMENTS: usize = 3 * MOST_POLYGONS;

/// Whether a file begins as PLY.
pub(super) fn is_ply(bytes: &[u8]) -> bool {
    bytes.starts_with(b"ply\n") || bytes.starts_with(b"ply\r")
}

/// Reads a PLY file.
///
/// # Errors
/// The part of the file that cannot be used.
pub(super) fn read(name: &str, bytes: &[u8]) -> Result<Draft, Fault> {
    let problem = |problem: String| Fault::Parse("as PLY".into(), problem);
    let mut reader = Reader::new(Cursor::new(bytes));
    let header = Parser::<Rest>::new().read_header(&mut reader).map_err(|error| problem(said(&error)))?;
    if let Some(faces) = header.elements.get("face").filter(|faces| faces.count > MOST_POLYGONS) {
        return Err(Fault::TooLarge(faces.count));
    }
    check_counts(&header, bytes.len()).map_err(problem)?;
    let mut draft = Draft::new(name);
    let (mut vertices, mut faces) = (Vec::new(), Vec::new());
    let mut left_out = Vec::new();
    for (name, element) in &header.elements {
        let elements = Elements { reader: &mut reader, header: &header, element };
        match name.as_str() {
            "vertex" => vertices = elements.read::<Vertex>().map_err(problem)?,
            "face" => faces = elements.read::<Face>().map_err(problem)?,
            other => {
                elements.read::<Rest>().map_err(problem)?;
                match other {
                    "edge" => draft.skipped.lines_and_points += element.count,
                    _ if element.count > 0 => left_out.push(format!("{} {}", element.count, quoted(name))),
                    _ => {}
                }
            }
        }
    }
    if faces.is_empty() && !vertices.is_empty() {
        let count = vertices.len();
        draft.skipped.note(format!("There are {count} points and no faces: make a mesh of them first."));
    }
    if !left_out.is_empty() {
        left_out.truncate(5);
        draft.skipped.note(format!("Left out, as only vertices and faces are read: {}.", left_out.join(", ")));
    }
    read_comments(&mut draft, &header);
    fill(&mut draft, &vertices, &faces)?;
    match draft.unusable_vertex() {
        Some(vertex) => Err(Fault::Coordinate("as PLY".into(), format!("vertex {}", u64::from(vertex) + 1))),
        None => Ok(draft),
    }
}

/// Message of the parser, on one line.
fn said(error: &ParseError) -> String {
    let said = error.to_string();
    let said: Vec<&str> = said.split_whitespace().collect();
    format!("not understood ({}); the file is damaged or cut off", sentence(&said.join(" ")))
}

/// The elements of one kind, next in the file.
struct Elements<'a, 'b> {
    reader: &'a mut Reader<Cursor<&'b [u8]>>,
    header: &'a Header,
    element: &'a ElementDef,
}

impl Elements<'_, '_> {
    fn read<E: PropertyAccess>(self) -> Result<Vec<E>, String> {
        Parser::new().read_payload_for_element(self.reader, self.element, self.header).map_err(|error| said(&error))
    }
}

/// Compares what the header tells of with the length of the file, before anything is read.
fn check_counts(header: &Header, length: usize) -> Result<(), String> {
    let mut bytes = 0_usize;
    for (name, element) in &header.elements {
        if element.count > MOST_ELEMENTS {
            return Err(format!(
                "it has {} of {}, more than the {MOST_ELEMENTS} that can be loaded",
                element.count,
                quoted(name)
            ));
        }
        let properties = element.properties.values();
        let least = match header.encoding {
            // A digit and a space or line break each; the last one may have none.
            Encoding::Ascii => (2 * properties.len()).saturating_sub(1).max(1),
            _ => properties.map(|property| least_bytes(&property.data_type)).sum(),
        };
        bytes = bytes.saturating_add(element.count.saturating_mul(least));
    }
    if bytes > length {
        return Err(format!("its head tells of {bytes} bytes or more but there are {length}; the file is cut off"));
    }
    Ok(())
}

/// Bytes that a property has at least in a binary file.
fn least_bytes(property: &PropertyType) -> usize {
    let (PropertyType::Scalar(scalar) | PropertyType::List(scalar, _)) = property;
    match scalar {
        ScalarType::Char | ScalarType::UChar => 1,
        ScalarType::Short | ScalarType::UShort => 2,
        ScalarType::Int | ScalarType::UInt | ScalarType::Float => 4,
        ScalarType::Double => 8,
    }
}

/// Takes the unit from a comment, and tells of a texture.
fn read_comments(draft: &mut Draft, header: &Header) {
    for comment in header.comments.iter().chain(&header.obj_infos) {
        draft.unit = draft.unit.or_else(|| Unit::of_comment(comment));
        if let Some(texture) = comment.trim().strip_prefix("TextureFile") {
            let texture = quoted(texture.trim());
            draft.skipped.note(format!("The texture {texture} is not read: export as glTF or OBJ to keep it."));
        }
    }
}

/// Fills the draft.
///
/// # Errors
/// A face with a corner that is not there.
fn fill(draft: &mut Draft, vertices: &[Vertex], faces: &[Face]) -> Result<(), Fault> {
    draft.vertices = vertices.iter().map(|vertex| vertex.position).collect();
    let has_colours = vertices.iter().any(|it| it.colour.is_some()) || faces.iter().any(|it| it.colour.is_some());
    let has_normals = vertices.iter().any(|vertex| vertex.normal != Vec3::ZERO);
    let material = DraftMaterial::undefined(NO_MATERIAL);
    draft.materials.push(match has_colours {
        // They are the colours of what has no other.
        true => DraftMaterial { reflectance: Vec3::ONE, defined: true, ..material },
        false => material,
    });
    for (number, face) in faces.iter().enumerate() {
        if let Some(&index) = face.corners.iter().find(|&&corner| corner as usize >= vertices.len()) {
            let index = if index == ABSENT { -1 } else { i64::from(index) };
            return Err(Fault::FaceIndex(format!("face {}", number + 1), index, vertices.len()));
        }
        if face.corners.len() < 3 {
            draft.skipped.lines_and_points += 1;
            continue;
        }
        draft.add_face(&face.corners, 0, GroupId(0));
        let corners = face.corners.iter().map(|&corner| &vertices[corner as usize]);
        if has_normals {
            draft.add_normals(corners.clone().map(|it| packed_normal(it.normal).filter(|_| it.normal.is_finite())));
        }
        if has_colours {
            let colour = |vertex: &Vertex| face.colour.or(vertex.colour).unwrap_or(Vec3::ONE).extend(1.0);
            draft.add_colours(corners.map(|vertex| Some(packed_colour(colour(vertex)))));
        }
    }
    Ok(())
}

/// Stands for a negative index.
const ABSENT: u32 = u32::MAX;

#[derive(Default)]
struct Vertex {
    position: DVec3,
    normal: Vec3,
    colour: Option<Vec3>,
}

#[derive(Default)]
struct Face {
    corners: Vec<u32>,
    colour: Option<Vec3>,
}

/// Content of a PLY file that is not read.
struct Rest;

impl PropertyAccess for Rest {
    fn new() -> Self {
        Self
    }
}

impl PropertyAccess for Vertex {
    fn new() -> Self {
        Self::default()
    }

    fn set_property(&mut self, name: &str, property: Property) -> PropertyAccessResult {
        let Some(value) = number(&property) else { return PropertyAccessResult::Ignored };
        match name {
            "x" => self.position.x = value,
            "y" => self.position.y = value,
            "z" => self.position.z = value,
            "nx" => self.normal.x = value as f32,
            "ny" => self.normal.y = value as f32,
            "nz" => self.normal.z = value as f32,
            _ => return set_colour(&mut self.colour, name, &property),
        }
        PropertyAccessResult::Set
    }
}

impl PropertyAccess for Face {
    fn new() -> Self {
        Self::default()
    }

    fn set_property(&mut self, name: &str, property: Property) -> PropertyAccessResult {
        if !matches!(name, "vertex_indices" | "vertex_index") {
            return set_colour(&mut self.colour, name, &property);
        }
        let of_i32 = |index: i32| u32::try_from(index).unwrap_or(ABSENT);
        self.corners = match property {
            Property::ListInt(list) => list.into_iter().map(of_i32).collect(),
            Property::ListUInt(list) => list,
            Property::ListShort(list) => list.into_iter().map(|index| of_i32(index.into())).collect(),
            Property::ListUShort(list) => list.into_iter().map(u32::from).collect(),
            Property::ListChar(list) => list.into_iter().map(|index| of_i32(index.into())).collect(),
            Property::ListUChar(list) => list.into_iter().map(u32::from).collect(),
            _ => return PropertyAccessResult::UnsupportedType,
        };
        PropertyAccessResult::Set
    }
}

/// Sets one component of a colour: whole numbers are steps of sRGB, as in pictures, others linear.
fn set_colour(colour: &mut Option<Vec3>, name: &str, property: &Property) -> PropertyAccessResult {
    let component = match name.strip_prefix("diffuse_").unwrap_or(name) {
        "red" | "r" => 0,
        "green" | "g" => 1,
        "blue" | "b" => 2,
        _ => return PropertyAccessResult::Ignored,
    };
    let value = match (property, number(property)) {
        (Property::Float(_) | Property::Double(_), Some(value)) if value.is_finite() => value as f32,
        (Property::UShort(value), _) => f32::from(*value) / 65535.0,
        (_, Some(value)) if value.is_finite() => linear_step(value.clamp(0.0, 255.0) as u8),
        _ => return PropertyAccessResult::Ignored,
    };
    colour.get_or_insert(Vec3::ZERO)[component] = value;
    PropertyAccessResult::Set
}

fn number(property: &Property) -> Option<f64> {
    match *property {
        Property::Char(value) => Some(value.into()),
        Property::UChar(value) => Some(value.into()),
        Property::Short(value) => Some(value.into()),
        Property::UShort(value) => Some(value.into()),
        Property::Int(value) => Some(value.into()),
        Property::UInt(value) => Some(value.into()),
        Property::Float(value) => Some(value.into()),
        Property::Double(value) => Some(value),
        _ => None,
    }
}
