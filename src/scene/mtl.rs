//! MTL files: `Kd` is reflectance, `Ke` a radiance (B_e = π·Ke), `d` and `Tr` opacity, `map_Kd`,
//! `map_Ke` and `map_d` textures.

use std::borrow::Cow;
use std::collections::HashMap;
use std::collections::hash_map::Entry;
use std::f32::consts::PI;
use std::path::Path;
use std::sync::Arc;

use glam::{Affine2, Vec2, Vec3};

use super::Skipped;
use super::draft::{DraftMaterial, GREY};
use super::files::{FileError, MOST_BYTES, MOST_TEXT_BYTES, SceneFiles, find};
use super::sanitize::quoted;
use super::texture::decode::{Encoded, decode_all};
use super::texture::{Opacity, Texture, TextureMap, Wrap};

/// More material files than this are no modeller's work; all of them together are no longer than a
/// text file may be.
const MOST_FILES: usize = 1000;

/// A material as its lines say; what no line says is absent.
#[derive(Clone, Debug, Default, PartialEq)]
struct Statement {
    diffuse: Option<Vec3>,
    radiance: Option<Vec3>,
    dissolve: Option<f32>,
    transparency: Option<f32>,
    diffuse_map: Option<MapStatement>,
    radiance_map: Option<MapStatement>,
    dissolve_map: Option<MapStatement>,
}

/// A texture line.
#[derive(Clone, Debug, PartialEq)]
struct MapStatement {
    file: String,
    /// `-s` and `-o`.
    transform: Affine2,
    is_clamped: bool,
}

/// Materials by name.
#[derive(Default)]
pub(super) struct MaterialLibrary {
    by_name: HashMap<String, Statement>,
    textures: HashMap<String, Arc<Texture>>,
    /// Textures of `map_d` in files of their own, their values as alpha.
    opacities: HashMap<String, Arc<Texture>>,
    /// Whether opaque is what `d 0` means here.
    d_means_clear: bool,
    /// Whether opaque is what `Tr 1` means here.
    tr_means_opaque: bool,
}

impl MaterialLibrary {
    /// Reads the material files and textures that a scene refers to; textures only of materials
    /// that it uses.
    pub fn read(files: &dyn SceneFiles, references: &[String], used: &[String], skipped: &mut Skipped) -> Self {
        let mut library = Self::default();
        let mut bytes_left = MOST_TEXT_BYTES;
        for reference in references.iter().take(MOST_FILES) {
            library.read_file(files, reference, &mut bytes_left, skipped);
        }
        if references.len() > MOST_FILES {
            let count = references.len();
            skipped.note(format!("Of {count} material files the first {MOST_FILES} are read."));
        }
        library.settle_transparency(skipped);
        library.read_textures(files, used, skipped);
        library
    }

    /// The material of a name, if any file defines it.
    pub fn get(&self, name: &str) -> Option<DraftMaterial> {
        let said = self.by_name.get(name)?;
        let map = |said: &Option<MapStatement>, textures: &HashMap<String, Arc<Texture>>| {
            let said = said.as_ref()?;
            let texture = textures.get(&said.file)?.clone();
            let wrap = if said.is_clamped { Wrap::Clamp } else { Wrap::Repeat };
            Some(TextureMap { texture, transform: said.transform, wrap: [wrap; 2] })
        };
        let [reflectance_map, emission_map] =
            [&said.diffuse_map, &said.radiance_map].map(|said| map(said, &self.textures));
        let unsaid = match (&said.diffuse_map, said.radiance.unwrap_or_default() == Vec3::ZERO) {
            (Some(_), _) => Vec3::ONE,
            (None, true) => GREY,
            (None, false) => Vec3::ZERO,
        };
        let unread = said.diffuse_map.is_some() && reflectance_map.is_none();
        let reflectance = said.diffuse.unwrap_or(unsaid) * if unread { GREY } else { Vec3::ONE };
        let radiance = match (&said.radiance_map, said.radiance) {
            // Exporters write `Ke 0 0 0` beside a texture that stands for it.
            (Some(_), None | Some(Vec3::ZERO)) => Vec3::ONE,
            (_, radiance) => radiance.unwrap_or_default(),
        };
        let is_dark = said.radiance_map.is_some() && emission_map.is_none();
        let dissolve_in_colour = said.has_dissolve_in_colour();
        let opacity_map = map(&said.dissolve_map, &self.opacities).filter(|_| !dissolve_in_colour);
        Some(DraftMaterial {
            reflectance,
            emission: if is_dark { Vec3::ZERO } else { PI * radiance },
            alpha: self.opacity(said),
            // Alpha of a colour's texture counts where the file says that it is one: exporters
            // leave all kinds of things there.
            opacity: if dissolve_in_colour || reflectance_map.is_none() { Opacity::Blend } else { Opacity::Opaque },
            transmits: self.opacity(said) < 0.5,
            reflectance_map,
            emission_map,
            opacity_map,
            ..DraftMaterial::new(name)
        })
    }

    /// Every name that a file defines.
    pub fn names(&self) -> impl Iterator<Item = &String> {
        self.by_name.keys()
    }

    /// How much of what lies behind a material hides. `d` counts where it disagrees with `Tr`.
    fn opacity(&self, said: &Statement) -> f32 {
        let by_transparency = said.transparency.map(|tr| if self.tr_means_opaque { tr } else { 1.0 - tr });
        let by_dissolve = said.dissolve.map(|d| if self.d_means_clear { 1.0 - d } else { d });
        by_dissolve.or(by_transparency).unwrap_or(1.0)
    }

    /// Decides what `Tr` means: how transparent a material is, or, for some exporters, how opaque.
    fn settle_transparency(&mut self, skipped: &mut Skipped) {
        let all = self.by_name.values();
        let alone = all.clone().filter(|said| said.dissolve.is_none()).filter_map(|said| said.transparency);
        let opaque = alone.filter(|tr| *tr >= 0.5).count();
        let both = all.clone().filter_map(|said| said.dissolve.zip(said.transparency));
        let (agree, disagree): (Vec<_>, Vec<_>) = both.partition(|(d, tr)| (d + tr - 1.0).abs() < 0.01);
        let equal = disagree.iter().filter(|(d, tr)| (d - tr).abs() < 0.01).count();
        // Exporters that write one number twice mean transparency where it is 0 nearly everywhere.
        let zeros = disagree.iter().filter(|(d, tr)| d.abs().max(tr.abs()) < 0.01).count();
        self.d_means_clear = agree.is_empty() && 2 * zeros > self.by_name.len();
        if self.d_means_clear {
            skipped.note("`d` and `Tr` are taken for transparency: else nearly everything would be clear.");
            return;
        }
        // Where most materials are at 1, nothing would be left to be seen; a few among many are
        // panes.
        self.tr_means_opaque = agree.is_empty() && (equal > 0 || 2 * opaque > self.by_name.len());
        if self.tr_means_opaque {
            skipped.note("`Tr` is taken for opacity, as its exporter means it: else nearly everything would be clear.");
            return;
        }
        let conflicts = disagree.iter().filter(|(d, tr)| (*d < 0.5) != (*tr > 0.5)).count();
        if conflicts > 0 {
            skipped.note(format!("`d` counts where `Tr` says something else ({conflicts} materials)."));
        }
    }

    /// Reads a material file of at most `bytes_left` bytes, which become less by its length.
    fn read_file(&mut self, files: &dyn SceneFiles, reference: &str, bytes_left: &mut u64, skipped: &mut Skipped) {
        let file = quoted(reference);
        let bytes = match find(files, reference, *bytes_left) {
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
        let read = statements(&text_of(&bytes));
        if let Some(first) = read.bad.first() {
            skipped.note(match read.bad.len() {
                1 => format!("Line {first} of the material file {file} is not understood and left out."),
                count => format!(
                    "In the material file {file}, {count} lines are not understood and left out; the first is line {first}."
                ),
            });
        }
        for (name, statement) in read.materials {
            match self.by_name.entry(name) {
                Entry::Occupied(known) => {
                    let name = quoted(known.key());
                    skipped.note(format!("The material {name} is defined twice; its first definition counts."));
                }
                Entry::Vacant(free) => {
                    free.insert(statement);
                }
            }
        }
    }

    fn read_textures(&mut self, files: &dyn SceneFiles, used: &[String], skipped: &mut Skipped) {
        let used: Vec<&Statement> = used.iter().filter_map(|name| self.by_name.get(name)).collect();
        let maps = used.iter().flat_map(|said| [&said.diffuse_map, &said.radiance_map]).flatten();
        let (names, textures) = decoded(files, maps);
        let of_opacity =
            used.iter().filter(|said| !said.has_dissolve_in_colour()).filter_map(|said| said.dissolve_map.as_ref());
        let (opacity_names, opacities) = decoded(files, of_opacity);
        for (name, texture) in names.into_iter().zip(textures) {
            match texture {
                Ok(texture) => {
                    self.textures.insert(name, texture);
                }
                Err(error) => skipped.unread_texture(quoted(&name), error),
            }
        }
        for (name, texture) in opacity_names.into_iter().zip(opacities) {
            match texture {
                Ok(texture) => {
                    self.opacities.insert(name, Arc::new(texture.as_opacity()));
                }
                Err(error) => {
                    let name = quoted(&name);
                    skipped
                        .note(format!("The opacity texture {name} is not used: {error}. Its faces are as `d` says."));
                }
            }
        }
    }
}

impl Statement {
    /// Whether alpha of the colour's texture is what `map_d` names.
    fn has_dissolve_in_colour(&self) -> bool {
        let maps = self.dissolve_map.as_ref().zip(self.diffuse_map.as_ref());
        maps.is_some_and(|(dissolve, diffuse)| dissolve.file == diffuse.file)
    }
}

/// The textures that some lines name, each once, and what comes of them.
fn decoded<'a>(
    files: &dyn SceneFiles,
    maps: impl Iterator<Item = &'a MapStatement>,
) -> (Vec<String>, Vec<Result<Arc<Texture>, String>>) {
    let mut names: Vec<String> = maps.map(|map| map.file.clone()).collect();
    names.sort_unstable();
    names.dedup();
    let decoded = decode_all(&names, |name| {
        let bytes = find(files, name, MOST_BYTES).map_err(|error| error.to_string())?;
        let extension = Path::new(&name.replace('\\', "/")).extension().unwrap_or_default().to_string_lossy().into();
        Ok(Encoded { bytes: Cow::Owned(bytes), extension })
    });
    (names, decoded)
}

/// Text as UTF-8, or else as Latin-1, so that names that differ in one byte stay different.
pub(super) fn text_of(bytes: &[u8]) -> Cow<'_, str> {
    match str::from_utf8(bytes) {
        Ok(text) => Cow::Borrowed(text),
        Err(_) => Cow::Owned(bytes.iter().map(|&byte| char::from(byte)).collect()),
    }
}

/// Statements of a material file.
#[derive(Default)]
struct Statements {
    /// In order; names may come twice.
    materials: Vec<(String, Statement)>,
    /// Numbers of lines that matter and are not understood.
    bad: Vec<usize>,
}

fn statements(text: &str) -> Statements {
    let mut read = Statements::default();
    for (index, line) in text.trim_start_matches('\u{feff}').lines().enumerate() {
        let line = line.trim();
        let (keyword, rest) = line.split_once(char::is_whitespace).unwrap_or((line, ""));
        let rest = rest.trim();
        if keyword.eq_ignore_ascii_case("newmtl") {
            match rest {
                "" => read.bad.push(index + 1),
                name => read.materials.push((name.to_owned(), Statement::default())),
            }
            continue;
        }
        let mut nobody = Statement::default();
        let material = read.materials.last_mut().map_or(&mut nobody, |(_, material)| material);
        let is_good = match keyword.to_ascii_lowercase().as_str() {
            "kd" => set(&mut material.diffuse, colour(rest)),
            "ke" => set(&mut material.radiance, colour(rest)),
            "d" => set(&mut material.dissolve, number(rest.trim_start_matches("-halo").trim())),
            "tr" => set(&mut material.transparency, number(rest)),
            "map_kd" => set(&mut material.diffuse_map, texture(rest)),
            "map_ke" | "map_emissive" => set(&mut material.radiance_map, texture(rest)),
            "map_d" => set(&mut material.dissolve_map, texture(rest)),
            _ => true,
        };
        if !is_good {
            read.bad.push(index + 1);
        }
    }
    read
}

fn set<T>(slot: &mut Option<T>, value: Option<T>) -> bool {
    let is_good = value.is_some();
    if is_good {
        *slot = value;
    }
    is_good
}

/// Three finite numbers; one alone stands for all three.
fn colour(text: &str) -> Option<Vec3> {
    let values: Vec<f32> = text.split_whitespace().map_while(|word| word.parse().ok()).take(3).collect();
    let colour = match values[..] {
        [red, green, blue] => Vec3::new(red, green, blue),
        [grey] => Vec3::splat(grey),
        _ => return None,
    };
    colour.is_finite().then_some(colour)
}

fn number(text: &str) -> Option<f32> {
    text.split_whitespace().next()?.parse().ok().filter(|value: &f32| value.is_finite())
}

/// A texture's file name with its options, which stand before it or, as some exporters have it,
/// behind; names may hold spaces.
fn texture(text: &str) -> Option<MapStatement> {
    let mut words = text.split_whitespace().peekable();
    let mut name: Vec<&str> = Vec::new();
    let (mut scale, mut offset, mut is_clamped) = (Vec2::ONE, Vec2::ZERO, false);
    while let Some(word) = words.next() {
        let numbers = match word {
            "-o" | "-s" | "-t" => 3,
            "-mm" => 2,
            "-blendu" | "-blendv" | "-boost" | "-cc" | "-clamp" | "-imfchan" | "-texres" | "-bm" | "-type" => 1,
            _ => {
                name.push(word);
                continue;
            }
        };
        let mut values = Vec::new();
        for taken in 0..numbers {
            // Vectors may be cut short; a mode such as `on` is a word, not a number.
            let belongs = |word: &&str| (numbers == 1 && taken == 0) || word.parse::<f32>().is_ok();
            match words.next_if(belongs) {
                Some(value) => values.push(value),
                None => break,
            }
        }
        let number = |index: usize, unsaid: f32| values.get(index).and_then(|word| word.parse().ok()).unwrap_or(unsaid);
        match word {
            "-s" => scale = Vec2::new(number(0, 1.0), number(1, 1.0)),
            "-o" => offset = Vec2::new(number(0, 0.0), number(1, 0.0)),
            "-clamp" => is_clamped = values.first() == Some(&"on"),
            _ => {}
        }
    }
    let is_sound = scale.is_finite() && offset.is_finite();
    // Coordinates were turned round in v: 1 − (s(1 − v) + o) = s·v + (1 − s − o).
    let moved = Vec2::new(offset.x, 1.0 - scale.y - offset.y);
    let transform = Affine2::from_scale_angle_translation(scale, 0.0, moved);
    (!name.is_empty() && is_sound).then(|| MapStatement { file: name.join(" "), transform, is_clamped })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texture_options_are_not_part_of_the_name() {
        let name = |text: &str| texture(text).map(|map| map.file);
        assert_eq!(name("wood grain.png").as_deref(), Some("wood grain.png"));
        assert_eq!(name("-s 2 2 2 wood.png").as_deref(), Some("wood.png"));
        assert_eq!(name("wood.png -s 2 2 2").as_deref(), Some("wood.png"));
        assert_eq!(name("-blendu off -o 0.5 -mm 0 1 dark wood.png").as_deref(), Some("dark wood.png"));
        assert_eq!(name("my -new wood.png").as_deref(), Some("my -new wood.png"));
        assert_eq!((name(""), name("-s 1 1")), (None, None));
    }

    /// Truth: the definition, with v upwards: 2·0.25 + 0.1 = 0.6, seen from the top 0.4.
    #[test]
    fn options_scale_and_move_the_texture() {
        let map = texture("-s 2 2 1 -o 0.3 0.1 a.png").expect("a texture");
        let at = map.transform.transform_point2(Vec2::new(0.25, 1.0 - 0.25));
        assert!(at.distance(Vec2::new(0.8, 0.4)) < 1e-6, "{at}");
    }

    #[test]
    fn bad_lines_are_left_out_and_said() {
        let read = statements("newmtl a\nKd 0.1 0.2\nKd\nKe nan 0 0\nKd 0.5\nillum x\nd -halo 0.25\n");
        assert_eq!(read.bad, [2, 3, 4]);
        let (name, material) = &read.materials[0];
        assert_eq!((name.as_str(), material.diffuse, material.dissolve), ("a", Some(Vec3::splat(0.5)), Some(0.25)));
    }

    /// Truth: how exporters mean it: `Tr` is 1 − `d` unless nearly everything would be clear.
    #[test]
    fn tr_is_opacity_where_else_all_would_be_clear() {
        let opacities = |text: &str| -> Vec<f32> {
            let read = statements(text);
            let mut library = MaterialLibrary { by_name: read.materials.into_iter().collect(), ..Default::default() };
            library.settle_transparency(&mut Skipped::default());
            let mut names: Vec<&String> = library.names().collect();
            names.sort();
            names.iter().map(|name| library.opacity(&library.by_name[*name])).collect()
        };
        assert_eq!(opacities("newmtl a\nTr 1\n"), [1.0]);
        assert_eq!(opacities("newmtl a\nTr 0\nnewmtl b\nTr 0\nnewmtl c\nTr 1"), [1.0, 1.0, 0.0]);
        assert_eq!(opacities("newmtl a\nTr 1\nd 1\nnewmtl b\nTr 0.9"), [1.0, 0.9]);
        assert_eq!(opacities("newmtl a\nTr 0\nd 0\nnewmtl b\nTr 0.75\nd 0.75\nnewmtl c\nd 0\nTr 0"), [1.0, 0.25, 1.0]);
        assert_eq!(opacities("newmtl a\nTr 0.75\nd 0.25\nnewmtl b\nTr 1"), [0.25, 0.0]);
    }
}
