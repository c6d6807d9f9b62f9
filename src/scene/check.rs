//! Counts of what loading skipped, clamped or ignored, shown once to a person.

use serde::Serialize;

use super::sanitize;

/// So many remarks are kept, the rest is counted: a file can give cause for millions.
const MOST_NOTES: usize = 50;
/// So many textures that are not used are kept, the rest is counted.
const MOST_TEXTURES: usize = 1000;

/// Counts of everything that loading changed or left out; all zero for a flawless file.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Skipped {
    /// Faces without area or with repeated corners.
    pub degenerate_faces: usize,
    /// Faces listed twice with the same winding.
    pub duplicate_faces: usize,
    /// Faces of materials that are panes (dissolve under ½, transmission, alpha BLEND).
    pub transparent_faces: usize,
    /// Materials of these faces.
    pub transparent_materials: Vec<String>,
    /// Faces whose material the sidecar tells to ignore.
    pub ignored_faces: usize,
    /// Materials whose reflectance was clamped.
    pub clamped_materials: usize,
    /// Faces without a (known) material, shown grey.
    pub faces_without_material: usize,
    /// Lights that are left out (directional ones of KHR_lights_punctual beside the sun).
    pub ignored_lights: usize,
    /// Lines and points, which have no area.
    pub lines_and_points: usize,
    /// Free-form curves and surfaces of OBJ.
    pub curves_and_surfaces: usize,
    /// Cameras without perspective.
    pub ignored_cameras: usize,
    /// Animations; the scene is shown at rest.
    pub animations: usize,
    /// Polygons that were cut into triangles (more than four corners, concave or not planar).
    pub triangulated_polygons: usize,
    /// Faces that the inside of the scene sees from behind.
    pub faces_seen_from_behind: usize,
    /// Faces that `Sides::Auto` turned round.
    pub turned_faces: usize,
    /// Faces that lie under others, wholly or in part, and count once
    /// ([`crate::geometry::overlaps`]).
    pub covered_faces: usize,
    /// Faces cut where a wall stands on them ([`crate::geometry::cuts`]).
    pub cut_faces: usize,
    /// Textures that are not used.
    pub unread_textures: Vec<UnreadTexture>,
    /// Extensions of glTF that are not read.
    pub unread_extensions: Vec<UnreadExtension>,
    /// Further remarks, each one sentence (a missing MTL file, a face that is no face).
    pub notes: Vec<String>,
    /// Remarks beyond those in [`notes`](Self::notes).
    pub further_notes: usize,
}

/// A texture that is not used; a grey of one half stands for it.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct UnreadTexture {
    /// Name of the texture in backquotes, or another way to identify it.
    pub name: String,
    /// Why it is not used, and what to do.
    pub problem: String,
}

/// An extension of glTF that is not read.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct UnreadExtension {
    /// Name of the extension.
    pub name: String,
    /// Whether the file says that it cannot be shown without.
    pub is_required: bool,
    /// A sentence about what that means, if there is more to say.
    pub remark: Option<String>,
}

/// So many names of extensions stand in a sentence, the rest is counted.
const EXTENSIONS_SAID: usize = 5;

/// So many names stand in a sentence, the rest is counted.
const NAMES_SAID: usize = 3;

impl Skipped {
    /// Adds a texture that is not used.
    pub(crate) fn unread_texture(&mut self, name: String, problem: impl AsRef<str>) {
        if self.unread_textures.len() < MOST_TEXTURES {
            self.unread_textures.push(UnreadTexture { name, problem: sanitize::sentence(problem.as_ref()) });
        } else {
            self.further_notes += 1;
        }
    }

    /// One sentence for each kind of problem, in the order in which they came.
    fn said_of_textures(&self) -> Vec<String> {
        // Problems that differ only in names that they quote are of one kind.
        let kind = |problem: &str| -> String { problem.split('`').step_by(2).collect() };
        let mut kinds: Vec<(String, Vec<&UnreadTexture>)> = Vec::new();
        for texture in &self.unread_textures {
            let of = kind(&texture.problem);
            match kinds.iter_mut().find(|(known, _)| *known == of) {
                Some((_, textures)) => textures.push(texture),
                None => kinds.push((of, vec![texture])),
            }
        }
        let sentence = |(_, textures): (String, Vec<&UnreadTexture>)| match textures[..] {
            [] => String::new(),
            [UnreadTexture { name, problem }] => {
                format!("The texture {name} is not used: {problem}. A grey of one half stands for it.")
            }
            [UnreadTexture { problem, .. }, ..] => {
                let mut names: Vec<&str> =
                    textures.iter().map(|texture| texture.name.as_str()).take(NAMES_SAID).collect();
                let more = match textures.len() - names.len() {
                    0 => names.pop().unwrap_or_default().to_owned(),
                    more => format!("{more} more"),
                };
                let (count, names) = (textures.len(), names.join(", "));
                format!(
                    "{count} textures ({names} and {more}) are not used: {problem}. A grey of one half stands for each."
                )
            }
        };
        kinds.into_iter().map(sentence).collect()
    }

    /// One sentence for those that the file needs, one for others, and what there is to say of
    /// single ones.
    fn said_of_extensions(&self) -> Vec<String> {
        let named = |is_required: bool| {
            let plain = |it: &&UnreadExtension| it.is_required == is_required && it.remark.is_none();
            let names = self.unread_extensions.iter().filter(plain).map(|it| sanitize::quoted(&it.name));
            Some(sanitize::list(names, EXTENSIONS_SAID)).filter(|names| !names.is_empty())
        };
        let needed = named(true).map(|names| {
            format!("The file needs extensions that are not read, so parts may be missing; export it without {names}.")
        });
        let used = named(false).map(|names| format!("Extensions that are not read: {names}."));
        let remarks = self.unread_extensions.iter().filter_map(|it| it.remark.clone());
        needed.into_iter().chain(used).chain(remarks).collect()
    }

    /// Adds a remark, one sentence.
    pub(crate) fn note(&mut self, remark: impl AsRef<str>) {
        if self.notes.len() < MOST_NOTES {
            self.notes.push(sanitize::sentence(remark.as_ref()));
        } else {
            self.further_notes += 1;
        }
    }

    /// One sentence for each thing that happened; empty when nothing did.
    pub fn sentences(&self) -> Vec<String> {
        let counted = [
            (self.degenerate_faces, "degenerate face skipped", "degenerate faces skipped"),
            (self.duplicate_faces, "face listed twice skipped", "faces listed twice skipped"),
            (self.transparent_faces, "transparent face left out", "transparent faces left out"),
            (self.ignored_faces, "face excluded by settings file", "faces excluded by settings file"),
            (self.clamped_materials, "material's reflectance clamped", "materials' reflectances clamped"),
            (self.faces_without_material, "face without a material shown grey", "faces without a material shown grey"),
            (
                self.lines_and_points,
                "line or point left out, which has no area",
                "lines and points left out, which have no area",
            ),
            (
                self.curves_and_surfaces,
                "curve or curved surface left out (make polygons of it before exporting)",
                "curves and curved surfaces left out (make polygons of them before exporting)",
            ),
            (self.ignored_cameras, "camera without perspective left out", "cameras without perspective left out"),
            (self.animations, "animation left out: shown at rest", "animations left out: shown at rest"),
            (self.triangulated_polygons, "polygon cut into triangles", "polygons cut into triangles"),
            (self.faces_seen_from_behind, "face seen from behind", "faces seen from behind (try sides: auto or both)"),
            (self.turned_faces, "face turned round", "faces turned round"),
            (self.covered_faces, "face under another counted once", "faces under others counted once"),
            (self.cut_faces, "face cut where a wall stands on it", "faces cut where walls stand on them"),
        ];
        let clear = (!self.transparent_materials.is_empty()).then(|| {
            let names = sanitize::list(self.transparent_materials.iter().map(|name| sanitize::quoted(name)), 5);
            format!("Transparent: {names}; *Material* in the section Light, or `\"opaque\": true` in the settings file, brings them back.")
        });
        let sentences = counted.iter().filter(|(count, ..)| *count > 0).map(|(count, one, many)| match count {
            1 => format!("1 {one}."),
            _ => format!("{count} {many}."),
        });
        let further = (self.further_notes > 0).then(|| format!("Further remarks left out: {}.", self.further_notes));
        let of_file = self.said_of_textures().into_iter().chain(self.said_of_extensions());
        sentences.chain(clear).chain(of_file).chain(self.notes.iter().cloned()).chain(further).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Truth: three kinds of problems are three sentences, however many textures have them, and
    /// each says how many.
    #[test]
    fn textures_that_are_not_used_are_said_once_for_each_kind_of_problem() {
        let mut skipped = Skipped::default();
        for index in 0..30 {
            skipped.unread_texture(format!("`t{index}`"), "KTX2 is not read; convert it to PNG");
            if index < 2 {
                skipped.unread_texture(
                    format!("`m{index}`"),
                    format!("`m{index}.png` cannot be read (there is no such file)"),
                );
            }
        }
        skipped.unread_texture("`odd`".into(), "it is no picture");
        assert_eq!(
            skipped.sentences(),
            [
                "30 textures (`t0`, `t1`, `t2` and 27 more) are not used: KTX2 is not read; convert it to PNG. A grey of one half stands for each.",
                "2 textures (`m0` and `m1`) are not used: `m0.png` cannot be read (there is no such file). A grey of one half stands for each.",
                "The texture `odd` is not used: it is no picture. A grey of one half stands for it.",
            ]
        );
    }
}
