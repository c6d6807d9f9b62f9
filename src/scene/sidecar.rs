//! The sidecar `NAME.selflink.json` beside a scene: corrections that the scene's own format cannot
//! hold.
//!
//! ```json
//! { "materials": { "lamp": { "emission": [30, 30, 30] }, "poster": { "ignore": true }, "curtain": { "opaque": true } },
//!   "luminaires": [{ "name": "lamp", "shape": "disc", "centre": [1, 2.7, 1], "direction": [0, -1, 0], "size": 0.5,
//!                    "exitance": [100, 100, 100] }],
//!   "sky": "overcast:10000lx", "sun": "az:200,el:40,60000lx",
//!   "sides": "auto", "up": "z", "unit": "cm",
//!   "groups": [{ "lamps": ["desk_1/lamp", "desk_2/lamp"] }],
//!   "camera": { "eye": [0, 1, 3], "target": [0, 1, 0], "up": [0, 1, 0], "hfov_deg": 50 },
//!   "bookmarks": [{ "eye": [0, 1, 3], "target": [0, 1, 0], "up": [0, 1, 0], "hfov_deg": 50 }],
//!   "task_area": { "corners": [[0.5, 0.75, 0.5], [2, 0.75, 1.3]], "height": 0.75, "average_lux": 500, "uniformity": 0.6 } }
//! ```

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::{fs, io};

use glam::{DVec3, Vec3};
use serde::{Deserialize, Serialize};

use super::files::{FileError, MOST_TEXT_BYTES, SceneFiles, SceneFolder};
use super::outside::{Daylight, SkySpec, SunSpec};
use super::place::{FiledCamera, MAX_COORDINATE, is_usable};
use super::unit::Unit;
use super::up::UpAxis;
use super::{
    CEILING_LIGHT, CameraPose, EditError, FiledLuminaire, FiledTaskArea, GroupMember, LuminaireShape, Material,
    MaterialId, Scene, Sides, sanitize,
};

/// The largest reflectance that a sidecar may set; a light path then loses at least a hundredth at
/// each bounce.
pub const MAX_SIDECAR_REFLECTANCE: f32 = 0.99;

/// The largest emission B_e, W/m² (the sun's surface has 6e7): powers must stay finite in f32.
pub const MAX_EMISSION: f32 = 1e9;

/// The most lights that a sidecar may add; each is a material of its own.
const MOST_LIGHTS: usize = 1000;

/// Content of a sidecar; every part may be missing.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Sidecar {
    /// Corrections by material name.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub materials: BTreeMap<String, SidecarMaterial>,
    /// Luminaires to be added.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub luminaires: Vec<FiledLuminaire>,
    /// Square luminaires as they were written before there were others; empty once read.
    #[serde(default, skip_serializing)]
    ceiling_lights: Vec<CeilingLight>,
    /// The sky outside; a picture lies in the scene's folder.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sky: Option<SkySpec>,
    /// The sun outside.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sun: Option<SunSpec>,
    /// Which sides of faces are bright.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sides: Option<Sides>,
    /// The axis of the file that points up.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub up: Option<UpAxis>,
    /// The unit of the file's lengths; those of the sidecar are metres.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub unit: Option<Unit>,
    /// Groups made by hand.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub groups: Vec<GroupMember>,
    /// The view to open with.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub camera: Option<FiledCamera>,
    /// Further views.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub bookmarks: Vec<FiledCamera>,
    /// Where on the work plane a task is done, and what light it asks for.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub task_area: Option<FiledTaskArea>,
}

/// Statements of a sidecar on one material; what is missing stays as the scene file has it.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SidecarMaterial {
    /// Reflectance ρ per colour, 0 to 0.99.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub reflectance: Option<Vec3>,
    /// Emission B_e per colour, W/m² (exitance).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub emission: Option<Vec3>,
    /// Whether faces of this material are opaque whatever the file says.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub opaque: bool,
    /// Whether faces of this material are left out.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub ignore: bool,
}

/// A square luminaire as older sidecars have it, shining against `up`.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
struct CeilingLight {
    centre: DVec3,
    up: Vec3,
    size: f32,
    exitance: Vec3,
}

impl From<CeilingLight> for FiledLuminaire {
    fn from(CeilingLight { centre, up, size, exitance }: CeilingLight) -> Self {
        let (name, shape) = (CEILING_LIGHT.to_owned(), LuminaireShape::Square);
        Self { name, shape, centre, direction: -up, turn_deg: 0.0, size, exitance }
    }
}

/// A sidecar that cannot be read, used or written.
#[derive(Debug, thiserror::Error)]
#[error("{}: {fault}", path.display())]
pub struct SidecarError {
    /// The sidecar.
    pub path: PathBuf,
    /// Why.
    pub fault: SidecarFault,
}

/// Why a sidecar cannot be read, used or written.
#[derive(Debug, thiserror::Error)]
pub enum SidecarFault {
    /// The file is there but is not read.
    #[error("cannot be read ({0}); check its permissions or move it away")]
    Unreadable(FileError),
    /// Not JSON, or a field that a sidecar does not have; with line and column.
    #[error("not a valid settings file of a scene: {0}")]
    Syntax(String),
    /// A number out of its range: which, and what it may be.
    #[error("{0}")]
    Value(String),
    /// Somebody protected the file, which counts even where the system would let us write.
    #[error("is read-only and stays as it is; allow writing to it, or move it away, and save again")]
    ReadOnly,
    /// The file is a link to another place, a pipe or a device.
    #[error("is not written, for {0}; move it away and save again")]
    Elsewhere(FileError),
    /// The file cannot be written.
    #[error("cannot be written ({0}); choose another folder")]
    Unwritable(io::Error),
}

/// Says of which sidecar a fault is.
pub(super) fn of_sidecar(path: &Path) -> impl Fn(SidecarFault) -> SidecarError {
    |fault| SidecarError { path: path.to_owned(), fault }
}

impl Sidecar {
    /// Where the sidecar of a scene file lies: `room.obj` has `room.selflink.json`.
    pub fn path_for(scene: &Path) -> PathBuf {
        scene.with_extension("selflink.json")
    }

    /// All in which a scene differs from its file: reflectances, emissions, added lights, groups
    /// made by hand, sides and camera.
    ///
    /// A scene does not remember which materials a sidecar asked to ignore; where a sidecar is
    /// already there, read it and [`update`](Self::update) it instead.
    pub fn of(scene: &Scene) -> Self {
        let mut sidecar = Self::default();
        sidecar.update(scene);
        sidecar
    }

    /// Takes over what [`Sidecar::of`] tells of a scene, brings what was said already up to date
    /// and keeps all the rest.
    pub fn update(&mut self, scene: &Scene) {
        let is_added = |index: usize| scene.luminaire_of(MaterialId(index as u32)).is_some();
        for (index, material) in scene.materials.iter().enumerate().filter(|(index, _)| !is_added(*index)) {
            let filed = scene.filed_materials.get(index);
            let is_new = |new: Vec3, old: fn(&Material) -> Vec3| filed.is_none_or(|filed| old(filed) != new);
            let said = self.materials.get(&material.name);
            let says_reflectance = said.is_some_and(|said| said.reflectance.is_some());
            let says_emission = said.is_some_and(|said| said.emission.is_some());
            let reflectance = material.reflectance.clamp(Vec3::ZERO, Vec3::splat(MAX_SIDECAR_REFLECTANCE));
            if says_reflectance || is_new(reflectance, |filed| filed.reflectance) {
                self.materials.entry(material.name.clone()).or_default().reflectance = Some(reflectance);
            }
            if says_emission || is_new(material.emission, |filed| filed.emission) {
                self.materials.entry(material.name.clone()).or_default().emission = Some(material.emission);
            }
        }
        self.luminaires = scene.luminaires().iter().map(|luminaire| luminaire.in_file(scene)).collect();
        Daylight { sky: self.sky, sun: self.sun } = scene.daylight();
        for name in &scene.reading.opaque {
            self.materials.entry(name.clone()).or_default().opaque = true;
        }
        for name in &scene.reading.ignored {
            self.materials.entry(name.clone()).or_default().ignore = true;
        }
        self.up = scene.reading.up.or(self.up);
        // What lies beside the scene has lengths in metres, whatever would be guessed the next
        // time.
        let is_guessed = scene.frame.unit != Unit::Metre;
        self.unit = scene.reading.unit.or(self.unit).or_else(|| is_guessed.then_some(scene.frame.unit));
        if self.sides.is_some() || scene.sides != Sides::default() {
            self.sides = Some(scene.sides);
        }
        self.groups = scene.regrouping.clone();
        self.camera = scene.camera.map(|camera| camera.in_file(scene)).or(self.camera);
        self.bookmarks = scene.bookmarks.iter().map(|camera| camera.in_file(scene)).collect();
        self.task_area = scene.task_area.map(|area| area.in_file(scene));
    }

    /// Adds the luminaires to a scene.
    ///
    /// # Errors
    /// One that cannot be used; none of a sidecar that was [read](Self::read).
    pub fn add_lights_to(&self, scene: &mut Scene) -> Result<(), EditError> {
        self.luminaires.iter().try_for_each(|luminaire| scene.add_luminaire(&luminaire.in_scene(scene)))
    }

    /// The daylight that it tells of.
    pub fn daylight(&self) -> Daylight {
        Daylight { sky: self.sky.clone(), sun: self.sun }
    }

    /// Why a light or the view cannot be used in this scene, if so.
    pub(super) fn problem_in(&self, scene: &Scene) -> Option<String> {
        let is_far = |place: DVec3| scene.from_file(place).abs().max_element() > MAX_COORDINATE;
        let what = if self.luminaires.iter().any(|light| is_far(light.centre)) {
            "a luminaire"
        } else if self.task_area.is_some_and(|area| area.corners.into_iter().any(is_far)) {
            "the task area"
        } else if self.camera.iter().chain(&self.bookmarks).any(|camera| is_far(camera.eye) || is_far(camera.target)) {
            "the camera"
        } else {
            let mut views = self.camera.iter().chain(&self.bookmarks);
            return views.find_map(|camera| view_problem(&camera.in_scene(scene)));
        };
        Some(format!("{what} lies beyond 1e9 from the middle of the scene"))
    }

    /// Reads and checks a sidecar.
    ///
    /// # Errors
    /// Unreadable, not a sidecar, or a value out of its range.
    pub fn read(path: &Path) -> Result<Self, SidecarError> {
        let bytes = SceneFolder::of(path).read(Path::new(path.file_name().unwrap_or_default()), MOST_TEXT_BYTES);
        let bytes = bytes.map_err(SidecarFault::Unreadable).map_err(of_sidecar(path))?;
        Self::from_bytes(path, &bytes)
    }

    /// Checks the content of a sidecar; `path` names it and is not read.
    ///
    /// # Errors
    /// Not a sidecar, or a value out of its range.
    pub fn from_bytes(path: &Path, bytes: &[u8]) -> Result<Self, SidecarError> {
        let text = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
        let syntax = |error: serde_json::Error| SidecarFault::Syntax(sanitize::sentence(&error.to_string()));
        let mut sidecar: Self = serde_json::from_slice(text).map_err(syntax).map_err(of_sidecar(path))?;
        sidecar.luminaires.splice(0..0, std::mem::take(&mut sidecar.ceiling_lights).into_iter().map(Into::into));
        match sidecar.problem() {
            Some(problem) => Err(of_sidecar(path)(SidecarFault::Value(problem))),
            None => Ok(sidecar),
        }
    }

    /// Writes the sidecar.
    ///
    /// # Errors
    /// The file is protected or cannot be written.
    pub fn write(&self, path: &Path) -> Result<(), SidecarError> {
        self.write_to(path).map_err(of_sidecar(path))
    }

    fn write_to(&self, path: &Path) -> Result<(), SidecarFault> {
        if fs::metadata(path).is_ok_and(|present| present.permissions().readonly()) {
            return Err(SidecarFault::ReadOnly);
        }
        if fs::symlink_metadata(path).is_ok() {
            let real = SceneFolder::of(path).resolve(Path::new(path.file_name().unwrap_or_default()));
            if !real.map_err(SidecarFault::Elsewhere)?.is_file() {
                return Err(SidecarFault::Elsewhere(FileError::NotAFile));
            }
        }
        let text = serde_json::to_string_pretty(self).map_err(|error| SidecarFault::Unwritable(error.into()))?;
        fs::write(path, text + "\n").map_err(SidecarFault::Unwritable)
    }

    /// The first value that is out of its range, as a sentence.
    fn problem(&self) -> Option<String> {
        let of_materials = self.materials.iter().find_map(|(name, material)| {
            let reflectance = material.reflectance.filter(|value| !in_range(*value, MAX_SIDECAR_REFLECTANCE));
            let emission = material.emission.filter(|value| !in_range(*value, MAX_EMISSION));
            match (reflectance, emission) {
                (Some(value), _) => Some(format!(
                    "the reflectance {value} of material {} must lie between 0 and {MAX_SIDECAR_REFLECTANCE}",
                    sanitize::quoted(name)
                )),
                (_, Some(value)) => {
                    let name = sanitize::quoted(name);
                    Some(format!("the emission {value} of material {name} must lie between 0 and 1e9 W/m²"))
                }
                _ => None,
            }
        });
        let lights = self.luminaires.len();
        let too_many = || {
            (lights > MOST_LIGHTS).then(|| format!("{lights} luminaires are more than the {MOST_LIGHTS} there may be"))
        };
        let of_lights = || self.luminaires.iter().find_map(light_problem);
        let of_views = || self.camera.iter().chain(&self.bookmarks).find_map(camera_problem);
        let of_area = || self.task_area.as_ref().and_then(FiledTaskArea::problem);
        of_materials.or_else(too_many).or_else(of_lights).or_else(of_views).or_else(of_area)
    }
}

/// Whether every colour is finite and between 0 and `most`.
fn in_range(value: Vec3, most: f32) -> bool {
    value.is_finite() && value.min_element() >= 0.0 && value.max_element() <= most
}

/// Why a luminaire cannot be used.
fn light_problem(light: &FiledLuminaire) -> Option<String> {
    let FiledLuminaire { ref name, centre, direction, turn_deg, size, exitance, .. } = *light;
    let problem = if !(is_usable(centre) && direction.is_finite()) {
        "has a coordinate that is not finite or beyond 1e15".to_owned()
    } else if direction.try_normalize().is_none() {
        "has no direction (`direction`, or `up` of a ceiling light); [0, -1, 0] shines down".to_owned()
    } else if !(size > 0.0 && size <= MAX_COORDINATE) {
        format!("needs a size greater than 0 and at most 1e9 (it is {size})")
    } else if !turn_deg.is_finite() {
        "needs a finite turn_deg".to_owned()
    } else if !in_range(exitance, MAX_EMISSION) {
        format!("needs an exitance between 0 and 1e9 W/m² (it is {exitance})")
    } else {
        return None;
    };
    Some(format!("the luminaire {} {problem}", sanitize::quoted(name)))
}

/// Why a view cannot be used, whatever the scene.
fn camera_problem(camera: &FiledCamera) -> Option<String> {
    if is_usable(camera.eye) && is_usable(camera.target) && camera.up.is_finite() {
        let from_target = FiledCamera { eye: camera.eye - camera.target, target: DVec3::ZERO, ..*camera };
        return view_problem(&from_target.in_scene(&Scene::new("")));
    }
    Some("the camera has a coordinate that is not finite or beyond 1e15".to_owned())
}

/// Why one cannot look so.
fn view_problem(view: &CameraPose) -> Option<String> {
    let CameraPose { eye, target, up, hfov_deg } = *view;
    let forward = target - eye;
    let angle = forward.try_normalize().zip(up.try_normalize()).map(|(forward, up)| forward.cross(up).length());
    let problem = if forward.try_normalize().is_none() {
        "looks at the point where its eye is; give it another target"
    } else if up.try_normalize().is_none() {
        "has no up direction; [0, 1, 0] is usual"
    } else if angle.is_none_or(|sine| sine < 1e-5) {
        "looks along its up direction; turn up away from it"
    } else if !(hfov_deg > 0.0 && hfov_deg < 180.0) {
        "needs an hfov_deg between 0 and 180"
    } else {
        return None;
    };
    Some(format!("the camera {problem}"))
}
