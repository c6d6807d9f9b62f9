//! MTL files by tobj: `Kd` is reflectance, `Ke` a radiance (B_e = π·Ke), a low dissolve a pane.
//!
//! tobj panics on a colour with fewer than three numbers and gives up a whole file for one bad number, so only sound
//! lines that matter here reach it.

use std::borrow::Cow;
use std::collections::HashMap;
use std::f32::consts::PI;

use glam::{DVec3, Vec3};

use super::Skipped;
use super::draft::{DraftMaterial, GREY};
use super::files::{FileError, MOST_BYTES, MOST_TEXT_BYTES, SceneFiles, name_of};
use super::said::quoted;
use super::texture::mean_colours;

/// More material files than this are no modeller's work; all of them together are no longer than a text file may be.
const MOST_FILES: usize = 1000;

/// Materials by name, and the mean colours of their textures.
#[derive(Default)]
pub(super) struct MaterialLibrary {
    by_name: HashMap<String, tobj::Material>,
    means: HashMap<String, Vec3>,
}

impl MaterialLibrary {
    /// Reads the material files and textures that a scene refers to.
    pub fn read(files: &dyn SceneFiles, references: &[String], skipped: &mut Skipped) -> Self {
        let mut library = Self::default();
        let mut bytes_left = MOST_TEXT_BYTES;
        for reference in references.iter().take(MOST_FILES) {
            library.read_file(files, reference, &mut bytes_left, skipped);
        }
        if references.len() > MOST_FILES {
            let count = references.len();
            skipped.note(format!("Of {count} material files the first {MOST_FILES} are read."));
        }
        library.read_textures(files, skipped);
        library
    }

    /// The material of a name, if any file defines it.
    pub fn get(&self, name: &str) -> Option<DraftMaterial> {
        let material = self.by_name.get(name)?;
        let emission = material.emissive.map_or(Vec3::ZERO, |radiance| PI * DVec3::from_array(radiance).as_vec3());
        let mean = material.diffuse_texture.as_ref().and_then(|texture| self.means.get(texture));
        let unsaid = match (mean, emission == Vec3::ZERO) {
            (Some(_), _) => Vec3::ONE,
            (None, true) => GREY,
            (None, false) => Vec3::ZERO,
        };
        let diffuse = material.diffuse.map_or(unsaid, |diffuse| DVec3::from_array(diffuse).as_vec3());
        let transparency = material.unknown_param.get("Tr").and_then(|value| value.parse::<f32>().ok());
        let dissolve =
            material.dissolve.map(|dissolve| dissolve as f32).or(transparency.map(|transparency| 1.0 - transparency));
        Some(DraftMaterial {
            name: name.to_owned(),
            reflectance: diffuse * mean.copied().unwrap_or(Vec3::ONE),
            emission,
            transparent: dissolve.is_some_and(|dissolve| dissolve < 0.5),
            defined: true,
        })
    }

    /// Every name that a file defines.
    pub fn names(&self) -> impl Iterator<Item = &String> {
        self.by_name.keys()
    }

    /// Reads a material file of at most `bytes_left` bytes, which become less by its length.
    fn read_file(&mut self, files: &dyn SceneFiles, reference: &str, bytes_left: &mut u64, skipped: &mut Skipped) {
        let file = quoted(reference);
        let bytes = match name_of(reference).and_then(|name| files.read(&name, *bytes_left)) {
            Ok(bytes) => bytes,
            Err(FileError::Outside) => {
                skipped.note(format!("The material file {file} lies outside the scene's folder and is not read."));
                return;
            }
            Err(error) => {
                skipped.note(format!("The material file {file} cannot be read ({error}): grey instead."));
                return;
            }
        };
        *bytes_left = bytes_left.saturating_sub(bytes.len() as u64);
        let text = sound_lines(&String::from_utf8_lossy(&bytes), &file, skipped);
        match tobj::load_mtl_buf(&mut text.as_bytes()) {
            Ok((materials, _)) => {
                self.by_name.extend(materials.into_iter().map(|material| (material.name.clone(), material)));
            }
            Err(error) => {
                skipped.note(format!("The material file {file} cannot be understood ({error}): grey instead."));
            }
        }
    }

    fn read_textures(&mut self, files: &dyn SceneFiles, skipped: &mut Skipped) {
        let mut names: Vec<&String> = self.by_name.values().filter_map(|it| it.diffuse_texture.as_ref()).collect();
        names.sort_unstable();
        names.dedup();
        let means = mean_colours(&names, |name| {
            let read = name_of(name).and_then(|name| files.read(&name, MOST_BYTES));
            read.map(Cow::Owned).map_err(|error| error.to_string())
        });
        let mut known = HashMap::new();
        for (name, mean) in names.into_iter().zip(means) {
            match mean {
                Ok(mean) => {
                    known.insert(name.clone(), mean.truncate());
                }
                Err(error) => skipped.note(format!("The texture {} is not used: {error}.", quoted(name))),
            }
        }
        self.means = known;
    }
}

/// The lines of an MTL file that matter here, in a form that tobj reads rightly.
fn sound_lines(text: &str, file: &str, skipped: &mut Skipped) -> String {
    let mut sound = String::with_capacity(text.len());
    let mut bad = Vec::new();
    for (index, line) in text.trim_start_matches('\u{feff}').lines().enumerate() {
        let line = line.trim();
        let (keyword, rest) = line.split_once(char::is_whitespace).unwrap_or((line, ""));
        let rest = rest.trim();
        let kept = match keyword {
            "newmtl" if !rest.is_empty() => Some(rest.to_owned()),
            "Kd" | "Ke" => colour(rest),
            "d" | "Tr" => number(rest.trim_start_matches("-halo").trim()),
            "map_Kd" => Some(texture_name(rest)).filter(|name| !name.is_empty()),
            "newmtl" => None,
            _ => continue,
        };
        match kept {
            Some(value) => {
                sound.push_str(keyword);
                sound.push(' ');
                sound.push_str(&value);
                sound.push('\n');
            }
            None => bad.push(index + 1),
        }
    }
    if let Some(first) = bad.first() {
        let count = bad.len();
        let lines = if count == 1 { "line is".to_owned() } else { format!("{count} lines are") };
        skipped.note(format!("In the material file {file} {lines} not understood and left out (first: line {first})."));
    }
    sound
}

/// Three finite numbers; one alone stands for all three.
fn colour(text: &str) -> Option<String> {
    let values: Vec<f32> = text.split_whitespace().map_while(|word| word.parse().ok()).take(3).collect();
    let [red, green, blue] = match values[..] {
        [red, green, blue] => [red, green, blue],
        [grey] => [grey; 3],
        _ => return None,
    };
    (red.is_finite() && green.is_finite() && blue.is_finite()).then(|| format!("{red} {green} {blue}"))
}

fn number(text: &str) -> Option<String> {
    let value: f32 = text.split_whitespace().next()?.parse().ok()?;
    value.is_finite().then(|| value.to_string())
}

/// The file name behind the options of a texture line (`-s 1 1 1 wood.png`); names may hold spaces.
fn texture_name(text: &str) -> String {
    let mut words = text.split_whitespace().peekable();
    if !text.starts_with('-') {
        return text.to_owned();
    }
    while let Some(option) = words.next_if(|word| word.starts_with('-')) {
        let numbers = match option {
            "-o" | "-s" | "-t" => 3,
            "-mm" => 2,
            _ => 1,
        };
        for taken in 0..numbers {
            // Vectors may be cut short; a mode such as `on` is a word, not a number.
            let belongs = |word: &&str| (numbers == 1 && taken == 0) || word.parse::<f32>().is_ok();
            if words.next_if(belongs).is_none() {
                break;
            }
        }
    }
    words.collect::<Vec<_>>().join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texture_options_are_not_part_of_the_name() {
        assert_eq!(texture_name("wood grain.png"), "wood grain.png");
        assert_eq!(texture_name("-s 2 2 2 wood.png"), "wood.png");
        assert_eq!(texture_name("-blendu off -o 0.5 -mm 0 1 dark wood.png"), "dark wood.png");
    }

    #[test]
    fn bad_lines_are_left_out_and_said() {
        let mut skipped = Skipped::default();
        let text = "newmtl a\nKd 0.1 0.2\nKd\nKe nan 0 0\nKd 0.5\nillum x\nd -halo 0.25\n";
        let sound = sound_lines(text, "`a.mtl`", &mut skipped);
        assert_eq!(sound, "newmtl a\nKd 0.5 0.5 0.5\nd 0.25\n");
        assert_eq!(
            skipped.notes,
            ["In the material file `a.mtl` 3 lines are not understood and left out (first: line 2)."]
        );
    }
}
