//! OBJ, line by line: every line is checked, with its number, and faces of one object or group name
//! belong together.
//!
//! `o` and `g` count alike, the last one names the faces; `/` in a name separates the levels of the
//! scene's hierarchy.

use std::collections::{HashMap, HashSet};
use std::path::PathBuf;

use glam::{Vec2, Vec3};

use super::GroupId;
use super::draft::{Draft, DraftMaterial, MOST_POLYGONS, NO_MATERIAL};
use super::face::{packed_colour, packed_normal};
use super::files::{SceneFiles, name_of};
use super::load_error::Fault;
use super::mtl::{MaterialLibrary, text_of};
use super::sanitize::{self, quoted};
use super::unit::Unit;

/// A face with more corners than this is no modeller's work.
const MOST_CORNERS: usize = 1 << 16;

/// Reads an OBJ file and its material files.
///
/// # Errors
/// The first line that cannot be used.
pub(super) fn read(name: &str, bytes: &[u8], files: &dyn SceneFiles) -> Result<Draft, Fault> {
    let text = text_of(bytes);
    let mut reader = LineReader { draft: Draft::new(name), ..LineReader::default() };
    let mut joined = String::new();
    for (index, line) in text.trim_start_matches('\u{feff}').lines().enumerate() {
        reader.line = index + 1;
        if let Some(comment) = line.trim_start().strip_prefix('#') {
            reader.unit = reader.unit.or_else(|| Unit::of_comment(comment));
        }
        // What goes on is no name.
        let line =
            if joined.is_empty() { data_of(line) } else { line.split('#').next().unwrap_or_default().trim_end() };
        match line.strip_suffix('\\').filter(|_| !joined.is_empty() || goes_on(line)) {
            Some(begun) => {
                joined.push_str(begun);
                joined.push(' ');
            }
            None if joined.is_empty() => reader.read(line)?,
            None => {
                joined.push_str(line);
                reader.read(data_of(&std::mem::take(&mut joined)))?;
            }
        }
    }
    reader.read(data_of(&joined))?;
    reader.finish(files)
}

fn keyword_of(line: &str) -> &str {
    line.trim_start().split(char::is_whitespace).next().unwrap_or_default()
}

/// A line without a comment behind its data; `#` may be part of a name.
fn data_of(line: &str) -> &str {
    let data = match keyword_of(line) {
        "o" | "g" | "usemtl" | "mtllib" => line,
        _ => line.split_once('#').map_or(line, |(data, _)| data),
    };
    data.trim_end()
}

/// Whether `\` at a line's end means that the next one belongs to it: in names it is a part of a
/// path.
fn goes_on(line: &str) -> bool {
    !matches!(keyword_of(line), "" | "o" | "g" | "usemtl" | "mtllib")
}

/// Attribute numbers of a corner, counted from 0.
#[derive(Clone, Copy)]
struct Corner {
    vertex: i64,
    uv: Option<usize>,
    normal: Option<usize>,
}

/// Goes through the lines.
#[derive(Default)]
struct LineReader {
    line: usize,
    draft: Draft,
    uvs: Vec<Vec2>,
    normals: Vec<Option<[i16; 2]>>,
    /// As long as the vertices where any has a colour.
    colours: Vec<Vec3>,
    /// The line of each vertex.
    vertex_lines: Vec<u32>,
    /// The largest vertex index that a face refers to, counted from 1, and its line.
    largest_index: (i64, usize),
    group: Option<GroupId>,
    material: Option<u32>,
    material_names: Vec<String>,
    material_numbers: HashMap<String, u32>,
    material_files: Vec<String>,
    known_files: HashSet<PathBuf>,
    lines_and_points: usize,
    curves_and_surfaces: usize,
    /// Lines that bring in another file.
    calls: usize,
    unit: Option<Unit>,
    corners: Vec<Corner>,
}

impl LineReader {
    fn read(&mut self, line: &str) -> Result<(), Fault> {
        let line = line.trim();
        let (keyword, rest) = line.split_once(char::is_whitespace).unwrap_or((line, ""));
        match keyword {
            "v" => self.vertex(rest)?,
            "vt" => {
                let [u, v] = numbers(rest);
                self.uvs.push(Vec2::new(u, 1.0 - if v.is_nan() { 0.0 } else { v }));
            }
            "vn" => {
                let normal = Vec3::from_array(numbers(rest));
                self.normals.push(packed_normal(normal).filter(|_| normal.is_finite()));
            }
            "f" | "fo" => self.face(rest)?,
            "o" | "g" => self.group = Some(self.draft.group_at(rest.trim())),
            "usemtl" => self.use_material(rest.trim()),
            "mtllib" => self.material_file(rest.trim()),
            "l" | "p" => self.lines_and_points += 1,
            // The last ones are how older files write them.
            "curv" | "curv2" | "surf" | "bsp" | "bzp" | "cdc" | "cdp" => self.curves_and_surfaces += 1,
            "call" => self.calls += 1,
            _ => {}
        }
        Ok(())
    }

    /// A position, with a colour where three numbers more stand behind it.
    fn vertex(&mut self, rest: &str) -> Result<(), Fault> {
        let mut position = [0.0_f64; 3];
        let mut words = rest.split_whitespace();
        for value in &mut position {
            let word = words.next().ok_or_else(|| self.problem("a vertex needs three coordinates"))?;
            *value = word.parse().map_err(|_| self.problem(format!("{} is not a coordinate", quoted(word))))?;
        }
        let number = self.draft.vertices.len();
        let rest: Vec<f32> = words.map_while(|word| word.parse().ok()).take(5).collect();
        let colour = match rest[..] {
            [r, g, b] | [_, r, g, b] => Some(Vec3::new(r, g, b)).filter(|colour| colour.is_finite()),
            _ => None,
        };
        if let Some(colour) = colour {
            self.colours.resize(number, Vec3::ONE);
            self.colours.push(colour);
        }
        self.draft.vertices.push(position.into());
        self.vertex_lines.push(self.line as u32);
        Ok(())
    }

    fn face(&mut self, rest: &str) -> Result<(), Fault> {
        let mut corners = std::mem::take(&mut self.corners);
        corners.clear();
        for word in rest.split_whitespace() {
            corners.push(self.corner(word)?);
        }
        match corners.len() {
            0 => return Err(self.problem("a face needs at least three corners")),
            1 | 2 => self.lines_and_points += 1,
            count if count > MOST_CORNERS => {
                return Err(self.problem(format!("a face has {count} corners; cut it into smaller ones")));
            }
            _ => self.add_face(&corners)?,
        }
        self.corners = corners;
        Ok(())
    }

    fn add_face(&mut self, corners: &[Corner]) -> Result<(), Fault> {
        if self.draft.faces.len() >= MOST_POLYGONS {
            return Err(Fault::TooLarge(self.draft.faces.len() + 1));
        }
        let material = match self.material {
            Some(material) => material,
            None => self.material_number(NO_MATERIAL),
        };
        let vertices = corners.iter().map(|corner| corner.vertex as u32);
        self.draft.add_face_of(vertices, material, self.group.unwrap_or(GroupId(0)));
        if corners.iter().any(|corner| corner.uv.is_some()) {
            let uv = |corner: &Corner| corner.uv.and_then(|uv| self.uvs.get(uv)).copied().unwrap_or(Vec2::NAN);
            self.draft.add_uvs(corners.iter().map(uv));
        }
        if corners.iter().any(|corner| corner.normal.is_some()) {
            let normal = |corner: &Corner| corner.normal.and_then(|normal| self.normals.get(normal)).copied().flatten();
            self.draft.add_normals(corners.iter().map(normal));
        }
        Ok(())
    }

    /// A corner `v/vt/vn`; the numbers of what is not there yet, or not at all, are absent but for
    /// the vertex's.
    fn corner(&mut self, word: &str) -> Result<Corner, Fault> {
        let mut parts = word.split('/');
        let vertex = parts.next().unwrap_or_default();
        let given: i64 = vertex.parse().map_err(|_| self.problem(format!("{} is not a face corner", quoted(word))))?;
        let from_one = |given: i64, count: usize| {
            if given < 0 { (count as i64).saturating_add(given).saturating_add(1) } else { given }
        };
        let index = from_one(given, self.draft.vertices.len());
        if index < 1 {
            return Err(self.index_error(given, self.line));
        }
        if index > self.largest_index.0 {
            self.largest_index = (index, self.line);
        }
        let mut other = |count: usize| {
            let given = parts.next()?.parse().ok()?;
            usize::try_from(from_one(given, count) - 1).ok()
        };
        let (uv, normal) = (other(self.uvs.len()), other(self.normals.len()));
        Ok(Corner { vertex: index - 1, uv, normal })
    }

    fn use_material(&mut self, name: &str) {
        self.material = Some(self.material_number(if name.is_empty() { "(unnamed)" } else { name }));
    }

    fn material_number(&mut self, name: &str) -> u32 {
        if let Some(&number) = self.material_numbers.get(name) {
            return number;
        }
        let number = self.material_names.len() as u32;
        self.material_names.push(name.to_owned());
        self.material_numbers.insert(name.to_owned(), number);
        number
    }

    fn material_file(&mut self, names: &str) {
        // Names may hold spaces, and several may stand on a line.
        let mut name = String::new();
        for word in names.split_whitespace() {
            if !name.is_empty() {
                name.push(' ');
            }
            name.push_str(word);
            if word.to_lowercase().ends_with(".mtl") {
                self.note_material_file(std::mem::take(&mut name));
            }
        }
        self.note_material_file(name);
    }

    fn note_material_file(&mut self, file: String) {
        let name = name_of(&file).unwrap_or_else(|_| file.as_str().into());
        if !file.is_empty() && self.known_files.insert(name) {
            self.material_files.push(file);
        }
    }

    fn finish(mut self, files: &dyn SceneFiles) -> Result<Draft, Fault> {
        let (index, line) = self.largest_index;
        if index > self.draft.vertices.len() as i64 {
            return Err(self.index_error(index, line));
        }
        if let Some(vertex) = self.draft.unusable_vertex() {
            let line = self.vertex_lines[vertex as usize];
            return Err(Fault::Coordinate(format!("line {line}"), format!("vertex {}", u64::from(vertex) + 1)));
        }
        self.colour_corners();
        let skipped = &mut self.draft.skipped;
        skipped.lines_and_points = self.lines_and_points;
        skipped.curves_and_surfaces = self.curves_and_surfaces;
        if self.calls > 0 {
            skipped.note(format!(
                "Files that the scene calls are not read (`call`, {}); export it as one file.",
                self.calls
            ));
        }
        self.draft.unit = self.unit;
        self.add_materials(files);
        Ok(self.draft)
    }

    /// Gives each corner its vertex's colour.
    fn colour_corners(&mut self) {
        if self.colours.is_empty() {
            return;
        }
        self.colours.resize(self.draft.vertices.len(), Vec3::ONE);
        // Some exporters count to 255.
        let largest = self.colours.iter().map(|colour| colour.max_element()).fold(0.0, f32::max);
        let scale = if largest > 1.001 { 1.0 / largest.max(255.0) } else { 1.0 };
        let colour = |vertex: &u32| Some(packed_colour((scale * self.colours[*vertex as usize]).extend(1.0)));
        self.draft.colours = self.draft.corners.iter().map(colour).collect();
    }

    /// All materials that faces use, in that order.
    fn add_materials(&mut self, files: &dyn SceneFiles) {
        let skipped = &mut self.draft.skipped;
        let library = MaterialLibrary::read(files, &self.material_files, &self.material_names, skipped);
        let is_named = |name: &&String| name.as_str() != NO_MATERIAL;
        if self.material_files.is_empty() && self.material_names.iter().any(|name| is_named(&name)) {
            skipped.note("The scene names no material file; its materials are grey.");
        }
        let mut unknown = Vec::new();
        for name in &self.material_names {
            self.draft.materials.push(library.get(name).unwrap_or_else(|| {
                if is_named(&name) {
                    unknown.push(quoted(name));
                }
                DraftMaterial::undefined(name)
            }));
        }
        if !self.draft.colours.is_empty() {
            // Colours of vertices alone are colours of what has no other.
            for material in self.draft.materials.iter_mut().filter(|material| !material.defined) {
                (material.reflectance, material.defined) = (Vec3::ONE, true);
            }
        }
        self.draft.unused_materials = library.names().cloned().collect();
        if !unknown.is_empty() && !self.material_files.is_empty() {
            let names = sanitize::list(unknown, 5);
            self.draft.skipped.note(format!("No material file defines {names}: grey instead."));
        }
    }

    fn problem(&self, problem: impl Into<String>) -> Fault {
        Fault::Parse(format!("line {}", self.line), problem.into())
    }

    fn index_error(&self, index: i64, line: usize) -> Fault {
        Fault::FaceIndex(format!("line {line}"), index, self.draft.vertices.len())
    }
}

/// So many numbers at the start of a line; NaN for those that are not there.
fn numbers<const N: usize>(text: &str) -> [f32; N] {
    let mut words = text.split_whitespace();
    std::array::from_fn(|_| words.next().and_then(|word| word.parse().ok()).unwrap_or(f32::NAN))
}
