//! Settings of a solution, as JSON that makes it again.
//!
//! A settings file holds `{"settings": {…}}`. Statistics carry the same key among theirs, so that
//! either file can be run again; other keys are passed over. Every key below may be left out.

use std::path::{Path, PathBuf};
use std::{fs, io};

use serde::{Deserialize, Serialize};
use serde_json::Value;

use crate::prepare::added_light::AddedLight;
use crate::scene::builtin::BuiltinScene;
use crate::scene::{FiledCamera, Reading, Source};
use crate::solve::params::ParamsError;
use crate::solve::{SolverParams, USUAL_ERROR};

/// Everything that decides a solution, and from where it was looked at.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Settings {
    /// Path of the scene's file, or the name of one of our own scenes.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub scene: Option<String>,
    /// How the scene's file is to be read.
    #[serde(skip_serializing_if = "Reading::is_empty")]
    pub reading: Reading,
    /// Light added to the scene.
    #[serde(skip_serializing_if = "AddedLight::is_empty")]
    pub light: AddedLight,
    /// The view.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub camera: Option<FiledCamera>,
    /// The solver's parameters.
    pub solver: SolverParams,
}

/// The file around settings.
#[derive(Serialize)]
struct SettingsFile<'a> {
    settings: &'a Settings,
}

/// A file of settings that cannot be used.
#[derive(Debug, thiserror::Error)]
#[error("{}: {fault}", path.display())]
pub struct SettingsError {
    path: PathBuf,
    fault: Fault,
}

/// Why a file of settings cannot be used.
#[derive(Debug, thiserror::Error)]
enum Fault {
    /// The file is not there or cannot be read.
    #[error("cannot be read ({0}); --settings takes a file of settings or statistics (JSON)")]
    Unreadable(#[from] io::Error),
    /// Not JSON, or a setting that there is not.
    #[error("not valid settings ({0}); write them anew with `selflink solve --stats`")]
    Syntax(#[from] serde_json::Error),
    /// JSON without settings.
    #[error("holds no `settings`; give a file that `selflink solve --stats` or the window wrote")]
    Missing,
    /// A number out of its range.
    #[error(transparent)]
    Value(#[from] ParamsError),
}

impl Settings {
    /// Name of a scene's source in settings; a path is made absolute, since a file of
    /// settings may be used elsewhere.
    pub fn name_of(source: &Source) -> String {
        match source {
            Source::Builtin(scene) => scene.name().to_owned(),
            Source::File(path) => {
                std::path::absolute(path).unwrap_or_else(|_| path.clone()).to_string_lossy().into_owned()
            }
        }
    }

    /// Where the scene comes from, if they name one.
    pub fn source(&self) -> Option<Source> {
        let name = self.scene.as_deref()?;
        Some(BuiltinScene::from_name(name).map_or_else(|| Source::File(name.into()), Source::Builtin))
    }

    /// Reads and checks a file of settings or statistics.
    ///
    /// # Errors
    /// Unreadable, not JSON, without settings, or a parameter out of its range.
    pub fn read(path: &Path) -> Result<Self, SettingsError> {
        let bytes = fs::read(path).map_err(Fault::from);
        let settings = bytes.and_then(|bytes| Self::of_file(&bytes));
        settings.map_err(|fault| SettingsError { path: path.to_owned(), fault })
    }

    fn of_file(bytes: &[u8]) -> Result<Self, Fault> {
        let mut file: Value = serde_json::from_slice(bytes)?;
        let settings = file.get_mut("settings").map(Value::take).ok_or(Fault::Missing)?;
        let asks = |key: &str| settings.get("solver").is_some_and(|solver| solver.get(key).is_some());
        let asks_nothing = !["error", "epsilon", "reconstruct"].into_iter().any(asks);
        let mut settings: Self = serde_json::from_value(settings)?;
        if asks_nothing {
            // As on the command line.
            settings.solver.error = Some(USUAL_ERROR);
        }
        settings.solver.validate()?;
        Ok(settings)
    }

    /// The text of a settings file.
    pub fn to_json(&self) -> serde_json::Result<String> {
        Ok(serde_json::to_string_pretty(&SettingsFile { settings: self })? + "\n")
    }
}

#[cfg(test)]
mod tests {
    use glam::{DVec3, Vec3};

    use super::*;
    use crate::prepare::added_light::CeilingLight;
    use crate::scene::outside::Daylight;
    use crate::scene::{FiledLuminaire, LuminaireShape, Unit, UpAxis};
    use crate::solve::{ClusteringMode, Epsilon};

    fn read(text: &str) -> Result<Settings, String> {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("settings.json");
        fs::write(&path, text).expect("a writable folder");
        Settings::read(&path).map_err(|error| error.to_string())
    }

    /// Truth: what was written, bit for bit.
    #[test]
    fn settings_come_back_as_they_were() {
        let settings = Settings {
            scene: Some("office".into()),
            reading: Reading {
                up: Some(UpAxis::Z),
                unit: Some(Unit::Inch),
                opaque: vec!["pane".into()],
                ignored: vec!["curtain".into()],
            },
            light: AddedLight {
                lamps_off: true,
                emitting: vec![("lamp".into(), Vec3::new(0.1, 2.0, 3.3))],
                luminaires: Some(vec![FiledLuminaire {
                    name: "strip".into(),
                    shape: LuminaireShape::Line,
                    centre: DVec3::new(1e6, 2.7, 0.1),
                    direction: -Vec3::Y,
                    turn_deg: 30.0,
                    size: 1.2,
                    exitance: Vec3::new(100.0, 90.0, 0.7),
                }]),
                ceiling: Some(CeilingLight { size: None, exitance: 0.7 }),
                daylight: Daylight {
                    sky: Some("clear:8500lx".parse().expect("a sky")),
                    sun: Some("az:200,el:40,60000lx".parse().expect("a sun")),
                },
            },
            camera: Some(FiledCamera { eye: DVec3::ONE, target: DVec3::ZERO, up: DVec3::Y, hfov_deg: 66.6 }),
            solver: SolverParams {
                epsilon: Epsilon::Watts(0.1 + 0.2),
                clustering: ClusteringMode::Octree,
                seed: u64::MAX,
                ..SolverParams::default()
            },
        };
        assert_eq!(read(&settings.to_json().expect("JSON")), Ok(settings));
    }

    #[test]
    fn what_is_left_out_is_usual() {
        let read = read(r#"{"rays": 5, "settings": {"solver": {"clustering": "groups"}}}"#).expect("settings");
        assert_eq!(read.solver, SolverParams { clustering: ClusteringMode::Groups, ..SolverParams::usual() });
        assert_eq!((read.scene, read.light), (None, AddedLight::default()));
    }

    /// Truth: files of older versions name the criterion of refinement; only one of the two is
    /// missed.
    #[test]
    fn a_former_criterion_is_read_and_reported() {
        for (criterion, is_missed) in [("energy", false), ("power", false), ("error", true), ("link-error", true)] {
            let text = format!(r#"{{"settings": {{"solver": {{"oracle": "{criterion}"}}}}}}"#);
            let mut settings = read(&text).expect("settings");
            assert_eq!(settings.solver.forget_criterion().is_some(), is_missed, "{criterion}");
            assert_eq!(settings.solver, SolverParams::usual());
        }
    }

    #[test]
    fn what_cannot_be_used_is_said() {
        for (text, part) in [
            ("", "not valid settings"),
            ("[1]", "no `settings`"),
            (r#"{"links": 5}"#, "no `settings`"),
            (r#"{"settings": {"solver": {"epsilom": 1}}}"#, "epsilom"),
            (r#"{"settings": {"solver": {"rays_min": 0}}}"#, "--rays-min"),
            (r#"{"settings": {"solver": {"seed": -1}}}"#, "invalid value"),
        ] {
            let said = read(text).expect_err("bad settings");
            assert!(said.contains(part) && !said.contains('\n'), "{text}: {said}");
        }
        let missing = Settings::read(Path::new("no/such.json")).expect_err("no file").to_string();
        assert!(missing.contains("no/such.json") && missing.contains("--settings"), "{missing}");
    }
}
