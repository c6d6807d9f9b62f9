//! STL, as text or binary: triangles of one material, each solid a group.
//!
//! Read here and not by a crate: those at hand stop at the first of several solids, or take a
//! binary file whose header begins with `solid` for text.

use glam::{DVec3, Vec3};

use super::GroupId;
use super::draft::{Draft, DraftMaterial, MOST_POLYGONS, NO_MATERIAL};
use super::load_error::Fault;
use super::mtl::text_of;
use super::sanitize::quoted;

/// Bytes of a binary file before its first triangle: a text of any kind and the number of
/// triangles.
const HEAD: usize = 84;

/// Bytes of a triangle: normal, three corners, and two bytes that some programs write colours into.
const TRIANGLE: usize = 50;

/// Whether a file is binary STL by its length, which its number of triangles tells; some writers
/// add a line break.
pub(super) fn is_binary(bytes: &[u8]) -> bool {
    told_triangles(bytes).is_some_and(|count| {
        let length = HEAD as u64 + u64::from(count) * TRIANGLE as u64;
        count > 0 && (length..=length + 2).contains(&(bytes.len() as u64))
    })
}

/// Whether a file begins as STL written as text.
pub(super) fn is_text(bytes: &[u8]) -> bool {
    let start = bytes.trim_ascii_start();
    let begins = start.get(..5).is_some_and(|word| word.eq_ignore_ascii_case(b"solid"));
    begins && start.get(5).is_none_or(u8::is_ascii_whitespace) && !bytes.iter().take(8192).any(|&byte| byte == 0)
}

fn told_triangles(bytes: &[u8]) -> Option<u32> {
    bytes.get(HEAD - 4..HEAD).map(|count| u32::from_le_bytes([count[0], count[1], count[2], count[3]]))
}

/// Reads an STL file.
///
/// # Errors
/// The first line or triangle that cannot be used.
pub(super) fn read(name: &str, bytes: &[u8]) -> Result<Draft, Fault> {
    let mut reader = Reader { draft: Draft::new(name), corners: Vec::new(), against: 0, dotted: 0 };
    if is_text(bytes) && !is_binary(bytes) {
        reader.text(bytes)?
    } else {
        reader.binary(bytes)?
    }
    let Reader { mut draft, against, dotted, .. } = reader;
    if against > 0 {
        draft
            .skipped
            .note(format!("Normals that point against their facet's corners: {against}; the order of corners counts."));
    }
    if dotted > 0 {
        draft.skipped.note(format!("Colours of facets are not read ({dotted} facets have some)."));
    }
    draft.materials.push(DraftMaterial::undefined(NO_MATERIAL));
    match draft.unusable_vertex() {
        Some(vertex) => Err(Fault::Coordinate("as STL".into(), format!("corner {}", u64::from(vertex) + 1))),
        None => Ok(draft),
    }
}

struct Reader {
    draft: Draft,
    /// The present facet's.
    corners: Vec<DVec3>,
    /// Facets whose normal points against their winding.
    against: usize,
    /// Facets with something in their last two bytes.
    dotted: usize,
}

impl Reader {
    fn binary(&mut self, bytes: &[u8]) -> Result<(), Fault> {
        let Some(count) = told_triangles(bytes) else {
            return Err(problem("as STL", "it is shorter than the head of a binary STL file; it is cut off"));
        };
        let there = (bytes.len() - HEAD) / TRIANGLE;
        if there < count as usize {
            let said = format!("the head tells of {count} triangles but there are {there}; the file is cut off");
            return Err(problem("as STL", said));
        }
        for (number, triangle) in bytes[HEAD..].chunks_exact(TRIANGLE).take(count as usize).enumerate() {
            let value = |at: usize| {
                let word = &triangle[4 * at..4 * at + 4];
                f32::from_le_bytes([word[0], word[1], word[2], word[3]])
            };
            let vector = |at: usize| Vec3::new(value(3 * at), value(3 * at + 1), value(3 * at + 2));
            self.corners.clear();
            self.corners.extend((1..4).map(|corner| vector(corner).as_dvec3()));
            self.dotted += usize::from(triangle[TRIANGLE - 2..] != [0, 0]);
            self.add(vector(0).as_dvec3(), GroupId(0), || format!("triangle {}", number + 1))?;
        }
        Ok(())
    }

    fn text(&mut self, bytes: &[u8]) -> Result<(), Fault> {
        let text = text_of(bytes);
        let mut group = GroupId(0);
        let (mut normal, mut is_open) = (DVec3::ZERO, false);
        for (index, line) in text.lines().enumerate() {
            let place = || format!("line {}", index + 1);
            let mut words = line.split_whitespace();
            let keyword = words.next().unwrap_or_default().to_ascii_lowercase();
            match keyword.as_str() {
                "solid" => {
                    let name = line.trim_start().get(5..).unwrap_or_default().trim();
                    group = if name.is_empty() { GroupId(0) } else { self.draft.add_group(name, GroupId(0)) };
                }
                "facet" => {
                    let numbers: Vec<f64> = words.skip(1).map_while(|word| word.parse().ok()).collect();
                    normal = <[f64; 3]>::try_from(numbers).map_or(DVec3::ZERO, DVec3::from);
                    self.corners.clear();
                    is_open = true;
                }
                "vertex" => {
                    let numbers: Vec<f64> = words.map_while(|word| word.parse().ok()).collect();
                    let Ok(corner) = <[f64; 3]>::try_from(numbers) else {
                        return Err(problem(place(), format!("{} is no vertex x y z", quoted(line.trim()))));
                    };
                    self.corners.push(corner.into());
                }
                "endloop" => self.add(normal, group, place)?,
                "endfacet" => is_open = false,
                "outer" | "endsolid" | "" | "color" => {}
                _ => {
                    return Err(problem(place(), format!("{} is not a line of an STL file", quoted(line.trim()))));
                }
            }
        }
        if is_open {
            return Err(problem("at its end", "the last facet is not complete; the file is cut off"));
        }
        Ok(())
    }

    /// Adds the present facet.
    fn add(&mut self, normal: DVec3, group: GroupId, place: impl Fn() -> String) -> Result<(), Fault> {
        if self.draft.faces.len() >= MOST_POLYGONS {
            return Err(Fault::TooLarge(self.draft.faces.len() + 1));
        }
        let (&[a, b, c], rest) = self
            .corners
            .split_first_chunk()
            .ok_or_else(|| problem(place(), format!("a facet has {} corners; it needs three", self.corners.len())))?;
        let is_against = (b - a).cross(c - a).dot(normal) < 0.0;
        self.against += usize::from(is_against && rest.is_empty());
        let first = self.draft.vertices.len() as u32;
        self.draft.vertices.append(&mut self.corners);
        let end = self.draft.vertices.len() as u32;
        self.draft.add_face_of(first..end, 0, group);
        Ok(())
    }
}

fn problem(place: impl Into<String>, problem: impl Into<String>) -> Fault {
    Fault::Parse(place.into(), problem.into())
}
