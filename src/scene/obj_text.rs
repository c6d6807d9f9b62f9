//! An OBJ file's text checked line by line and put in a form that tobj reads rightly.
//!
//! tobj names no lines in its errors, takes `l` lines for faces, keeps no name of an undefined material, and does not
//! know indented keywords, line continuations, comments behind data or text in Latin-1. So each line is checked here,
//! with its number, and what tobj gets is plain: vertices first, then faces by positive indices.

use std::collections::HashSet;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use glam::DVec3;

use super::files::name_of;
use super::load_error::LoadError;
use super::place::{Reach, is_usable};
use super::said::quoted;

/// A face with more corners than this is no modeller's work.
const MOST_CORNERS: usize = 4096;

/// Name given to tobj where a file names neither object nor group.
pub(super) const UNNAMED: &str = "unnamed_object";

/// What an OBJ file holds, besides what tobj makes of it.
#[derive(Default)]
pub(super) struct ObjText {
    /// Text for tobj.
    pub plain: String,
    /// Material files as the scene names them, in order and each once.
    pub material_files: Vec<String>,
    /// Material names in the order of their first use.
    pub material_names: Vec<String>,
    /// Number of faces.
    pub faces: usize,
    /// Lines and points that have no area.
    pub lines_and_points: usize,
}

/// Checks and rewrites a whole file.
///
/// # Errors
/// The first line that cannot be used.
pub(super) fn plain_text(path: &Path, bytes: &[u8]) -> Result<ObjText, LoadError> {
    let text = String::from_utf8_lossy(bytes);
    let mut reader = LineReader::new(path);
    let mut joined = String::new();
    for (index, line) in text.trim_start_matches('\u{feff}').lines().enumerate() {
        reader.line = index + 1;
        let line = line.trim_end();
        if let Some(begun) = line.strip_suffix('\\') {
            joined.push_str(begun);
            joined.push(' ');
        } else if joined.is_empty() {
            reader.read(line)?;
        } else {
            joined.push_str(line);
            reader.read(&std::mem::take(&mut joined))?;
        }
    }
    reader.read(&joined)?;
    reader.finish()
}

struct LineReader<'a> {
    path: &'a Path,
    line: usize,
    vertices: String,
    vertex_count: usize,
    /// How far vertices reach, by their lines and numbers.
    reach: Reach<(usize, usize)>,
    faces: String,
    /// Group and material of the next face, as statements that are not written yet: most files have some that no face follows.
    pending: [String; 2],
    /// The largest index so far, with its line: it may come before its vertex.
    largest_index: (i64, usize),
    known_names: HashSet<String>,
    known_files: HashSet<PathBuf>,
    corners: Vec<i64>,
    found: ObjText,
}

impl<'a> LineReader<'a> {
    fn new(path: &'a Path) -> Self {
        Self {
            path,
            line: 0,
            vertices: String::new(),
            vertex_count: 0,
            reach: Reach::new(),
            faces: String::new(),
            pending: [String::new(), String::new()],
            largest_index: (0, 0),
            known_names: HashSet::new(),
            known_files: HashSet::new(),
            corners: Vec::new(),
            found: ObjText::default(),
        }
    }

    fn read(&mut self, line: &str) -> Result<(), LoadError> {
        let line = line.trim();
        let (keyword, rest) = line.split_once(char::is_whitespace).unwrap_or((line, ""));
        match keyword {
            "v" => self.vertex(rest),
            "f" => self.face(rest),
            "o" | "g" => {
                let name = rest.trim();
                self.pending[0] = format!("{keyword} {}\n", if name.is_empty() { UNNAMED } else { name });
                Ok(())
            }
            "usemtl" => {
                self.use_material(rest.trim());
                Ok(())
            }
            "mtllib" => {
                self.material_file(rest.trim());
                Ok(())
            }
            "l" | "p" => {
                self.found.lines_and_points += 1;
                Ok(())
            }
            _ => Ok(()),
        }
    }

    /// Position alone: neither weights nor colours matter for polygons.
    fn vertex(&mut self, rest: &str) -> Result<(), LoadError> {
        self.vertex_count += 1;
        self.vertices.push('v');
        let mut words = rest.split_whitespace();
        let mut position = DVec3::ZERO;
        for axis in 0..3 {
            let word = words.next().ok_or_else(|| self.problem("a vertex needs three coordinates"))?;
            let value: f64 = word.parse().map_err(|_| self.problem(format!("{} is not a coordinate", quoted(word))))?;
            if !is_usable(value) {
                return Err(self.coordinate_error((self.line, self.vertex_count)));
            }
            position[axis] = value;
            self.vertices.push(' ');
            self.vertices.push_str(word);
        }
        self.vertices.push('\n');
        self.reach.add(position, (self.line, self.vertex_count));
        Ok(())
    }

    fn face(&mut self, rest: &str) -> Result<(), LoadError> {
        let rest = rest.split_once('#').map_or(rest, |(face, _)| face);
        let mut corners = std::mem::take(&mut self.corners);
        corners.clear();
        for word in rest.split_whitespace() {
            corners.push(self.corner(word)?);
        }
        match corners.len() {
            0 => return Err(self.problem("a face needs at least three corners")),
            1 | 2 => self.found.lines_and_points += 1,
            count if count > MOST_CORNERS => {
                return Err(self.problem(format!("a face has {count} corners; cut it into smaller ones")));
            }
            _ => {
                self.found.faces += 1;
                for statement in &mut self.pending {
                    self.faces.push_str(statement);
                    statement.clear();
                }
                self.faces.push('f');
                for index in &corners {
                    // Writing to a string cannot fail.
                    let _ = write!(self.faces, " {index}");
                }
                self.faces.push('\n');
            }
        }
        self.corners = corners;
        Ok(())
    }

    /// The vertex index of a corner `v/vt/vn`, counted from 1.
    fn corner(&mut self, word: &str) -> Result<i64, LoadError> {
        let vertex = word.split('/').next().unwrap_or_default();
        let given: i64 = vertex.parse().map_err(|_| self.problem(format!("{} is not a face corner", quoted(word))))?;
        let index = if given < 0 { (self.vertex_count as i64).saturating_add(given).saturating_add(1) } else { given };
        if index < 1 {
            return Err(self.index_error(given, self.line));
        }
        if index > self.largest_index.0 {
            self.largest_index = (index, self.line);
        }
        Ok(index)
    }

    fn use_material(&mut self, name: &str) {
        if self.known_names.insert(name.to_owned()) {
            self.found.material_names.push(name.to_owned());
        }
        self.pending[1] = format!("usemtl {}\n", material_key(name));
    }

    fn material_file(&mut self, names: &str) {
        // One name may hold spaces, or several may stand on a line.
        let several = names.split_whitespace().all(|name| name.to_lowercase().ends_with(".mtl"));
        let files: Vec<&str> = if several { names.split_whitespace().collect() } else { vec![names] };
        for file in files {
            let name = name_of(file).unwrap_or_else(|_| file.into());
            if !file.is_empty() && self.known_files.insert(name) {
                self.found.material_files.push(file.to_owned());
            }
        }
    }

    fn finish(mut self) -> Result<ObjText, LoadError> {
        let (index, line) = self.largest_index;
        if index > self.vertex_count as i64 {
            return Err(self.index_error(index, line));
        }
        if let Some(place) = self.reach.too_far() {
            return Err(self.coordinate_error(place));
        }
        // tobj asks for the materials when it meets this line; the name is not looked at.
        let mut plain = String::from("mtllib materials\n");
        plain.push_str(&self.vertices);
        plain.push_str(&self.faces);
        self.found.plain = plain;
        Ok(self.found)
    }

    fn place(&self) -> String {
        format!("line {}", self.line)
    }

    fn problem(&self, problem: impl Into<String>) -> LoadError {
        LoadError::Parse { path: self.path.to_owned(), place: self.place(), problem: problem.into() }
    }

    fn coordinate_error(&self, (line, vertex): (usize, usize)) -> LoadError {
        let (place, vertex) = (format!("line {line}"), format!("vertex {vertex}"));
        LoadError::Coordinate { path: self.path.to_owned(), place, vertex }
    }

    fn index_error(&self, index: i64, line: usize) -> LoadError {
        let place = format!("line {line}");
        LoadError::FaceIndex { path: self.path.to_owned(), place, index, count: self.vertex_count }
    }
}

/// The name under which tobj knows a material; `usemtl` without a name is allowed.
pub(super) fn material_key(name: &str) -> String {
    if name.is_empty() { "(unnamed)".to_owned() } else { name.to_owned() }
}
