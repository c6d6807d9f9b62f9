//! Options that several commands share: the scene, added light, and the solver's parameters.

mod solver;

use std::path::{Path, PathBuf};
use std::str::FromStr;
use std::time::Duration;

use anyhow::{anyhow, bail};
use clap::{Arg, ArgAction, ArgMatches, Command, value_parser};
use glam::Vec3;
use selflink::export::settings::Settings;
use selflink::prepare::added_light::{AddedLight, CeilingLight};
use selflink::scene::outside::{Daylight, SkyKind, SkySpec, SunSpec};
use selflink::scene::{Reading, Source, Unit, UpAxis, builtin::BuiltinScene};

use solver::solver_params_over;
pub use solver::{former_arg, solver_args, solver_args_where, solver_params};

/// Reads a number; what is none is reported in a person's words.
pub fn number(text: &str) -> Result<f64, String> {
    text.parse().map_err(|_| "it must be a number".to_owned())
}

/// Reads a number of things, likewise.
pub fn whole<T: FromStr>(text: &str) -> Result<T, String> {
    text.parse().map_err(|_| match text.parse::<u64>() {
        Ok(_) => "it is too large".to_owned(),
        Err(_) => "it must be a whole number, 0 or more".to_owned(),
    })
}

/// Whether an option was given; a command need not know it.
fn has(matches: &ArgMatches, flag: &str) -> bool {
    matches.try_contains_id(flag).unwrap_or(false)
}

/// The unit of a file's lengths.
pub fn unit_arg() -> Arg {
    value_arg("unit", "m|cm|mm|in|ft")
        .value_parser(Unit::ALL.map(Unit::symbol))
        .action(ArgAction::Append)
        .help("The unit of the file's lengths; all readings are in metres [default: as the file says, or guessed by the size of a room]")
}

/// How the scene's file is read, and light that is added to it.
pub fn scene_args() -> [Arg; 9] {
    [
        value_arg("up", "y|z")
            .value_parser(["y", "z"])
            .help("The axis of the file that points up [default: as the file says, or as the scene looks]"),
        unit_arg(),
        value_arg("opaque", "MATERIAL")
            .action(ArgAction::Append)
            .help("Keep the faces of a material that is transparent by the file. May be given several times"),
        value_arg("ignore", "MATERIAL")
            .action(ArgAction::Append)
            .help("Leave out the faces of a material, such as panes that daylight is to pass. May be given several times"),
        flag_arg("lamps-off")
            .help("Switch the lamps of the scene's file off; --emit and --ceiling-light shine all the same"),
        value_arg("emit", "MATERIAL=R,G,B")
            .action(ArgAction::Append)
            .help("Make a material emit; exitance per colour in W/m². May be given several times"),
        value_arg("ceiling-light", "SIZE:W_PER_M2")
            .num_args(0..=1)
            .default_missing_value("")
            .help("Add a square lamp under the ceiling: its side in the scene's unit and its exitance [default: a quarter of the room, 100 W/m²]"),
        value_arg("sky", "KIND:AMOUNT")
            .value_parser(|text: &str| text.parse::<SkySpec>())
            .help("Let a sky shine in: uniform, overcast, clear, cie1 to cie15, cie=A/B/C/D/E, perez=DIRECT/DIFFUSE (W/m²), or a picture all around (.hdr, .exr, .png, .jpg; north in its middle), with its horizontal illuminance or irradiance, such as overcast:10000lx or uniform:50W"),
        value_arg("sun", "az:A,el:E,AMOUNT")
            .value_parser(|text: &str| text.parse::<SunSpec>())
            .help("Let the sun shine in: degrees from north (-z, or y where z is up) over east and above the horizon, or date and place (2026-06-21T12:00+02:00,lat:48.1,lon:11.6,north:0); and what it brings to a face turned to it, such as 60000lx [default: as on a clear day]"),
    ]
}

/// The scene, light added to it, the solver's parameters and the time it may take: what every
/// command that solves takes.
pub fn solving(command: Command) -> Command {
    command
        .arg(scene_arg().required_unless_present(SETTINGS))
        .arg(settings_arg())
        .args(scene_args())
        .arg(seconds_arg("Stop after so many seconds of solving and use the solution that is there"))
        .args(solver_args())
}

/// The option that names a file of settings, `--settings`; `chart` has another of that name.
const SETTINGS: &str = "settings-file";

/// A file of settings.
pub fn settings_arg() -> Arg {
    path_arg(SETTINGS, "FILE.json").long("settings").help(
        "Solve as a file of settings or statistics says, which `solve --stats` and the window write: scene, added light and parameters; options given beside it count more",
    )
}

/// The path of the settings that the arguments name; a command need not know the option.
pub fn settings_path(matches: &ArgMatches) -> Option<PathBuf> {
    matches.try_get_one::<PathBuf>(SETTINGS).ok().flatten().cloned()
}

/// The settings of the file that the arguments name.
pub fn filed_settings(matches: &ArgMatches) -> anyhow::Result<Option<Settings>> {
    let Some(path) = settings_path(matches) else { return Ok(None) };
    let mut settings = Settings::read(&path)?;
    if let Some(sentence) = settings.solver.forget_criterion() {
        eprintln!("warning: {}: {sentence}.", path.display());
    }
    Ok(Some(settings))
}

/// How long something may take.
pub fn seconds_arg(help: &'static str) -> Arg {
    value_arg("seconds", "T").value_parser(number).allow_hyphen_values(true).help(help)
}

/// The time limit given, if one was.
pub fn seconds(matches: &ArgMatches) -> anyhow::Result<Option<Duration>> {
    if !has(matches, "seconds") {
        return Ok(None);
    }
    let Some(&seconds) = matches.get_one::<f64>("seconds") else { return Ok(None) };
    let limit = Duration::try_from_secs_f64(seconds);
    Ok(Some(limit.map_err(|_| anyhow!("--seconds must be a number of seconds, not {seconds}"))?))
}

/// The time limit given for each of several runs, if one was.
pub fn seconds_of_a_run(matches: &ArgMatches) -> anyhow::Result<Option<Duration>> {
    let limit = seconds(matches)?;
    if limit.is_some_and(|limit| limit.is_zero()) {
        bail!("--seconds must be greater than 0: every run needs some time");
    }
    Ok(limit)
}

/// The scene, by path or name.
pub fn scene_arg() -> Arg {
    Arg::new("scene").value_name("SCENE").help(scene_help())
}

/// Help for the argument that names a scene.
pub fn scene_help() -> String {
    format!("An OBJ, glTF, GLB, PLY or STL file, or a sample scene: {}", names())
}

/// The names of our own scenes.
pub fn names() -> String {
    BuiltinScene::named().map(|scene| scene.name()).collect::<Vec<_>>().join(", ")
}

/// Where a scene of this name or path comes from.
pub fn source(text: &str) -> anyhow::Result<Source> {
    if let Some(scene) = BuiltinScene::from_name(text) {
        return Ok(Source::Builtin(scene));
    }
    let path = Path::new(text);
    if path.extension().is_none() && path.components().count() <= 1 && !path.exists() {
        bail!("`{text}` is neither a file nor a sample scene ({})", names());
    }
    Ok(Source::File(path.to_owned()))
}

/// The path of an option that takes one.
pub fn path(matches: &ArgMatches, name: &str) -> Option<PathBuf> {
    matches.get_one::<PathBuf>(name).cloned()
}

/// An option that takes a value.
pub fn value_arg(name: &'static str, value_name: &'static str) -> Arg {
    Arg::new(name).long(name).value_name(value_name)
}

/// An option that takes none.
pub fn flag_arg(name: &'static str) -> Arg {
    Arg::new(name).long(name).action(ArgAction::SetTrue)
}

/// An argument that takes a file or folder.
pub fn path_arg(name: &'static str, value_name: &'static str) -> Arg {
    value_arg(name, value_name).value_parser(value_parser!(PathBuf))
}

/// Exitance of a lamp that nothing is said about, W/m²: a bright office ceiling panel.
const USUAL_EXITANCE: f32 = 100.0;

/// How the arguments want the scene's file to be read.
pub fn reading(matches: &ArgMatches) -> Reading {
    let words = |name: &str| matches.get_many::<String>(name).unwrap_or_default();
    Reading {
        up: words("up").find_map(|letter| UpAxis::from_letter(letter)),
        unit: words("unit").find_map(|symbol| Unit::from_symbol(symbol)),
        opaque: words("opaque").cloned().collect(),
        ignored: words("ignore").cloned().collect(),
    }
}

/// The light that the arguments add.
pub fn added_light(matches: &ArgMatches) -> anyhow::Result<AddedLight> {
    let emitting = matches.get_many::<String>("emit").unwrap_or_default();
    let emitting = emitting.map(|text| emission(text)).collect::<anyhow::Result<_>>()?;
    let ceiling = matches.get_one::<String>("ceiling-light").map(|text| ceiling_light(text)).transpose()?;
    let sky = matches.get_one::<SkySpec>("sky").cloned().map(absolute);
    Ok(AddedLight {
        lamps_off: has(matches, "lamps-off") && matches.get_flag("lamps-off"),
        emitting,
        luminaires: None,
        ceiling,
        daylight: Daylight { sky, sun: matches.get_one::<SunSpec>("sun").copied() },
    })
}

/// A sky whose picture is named in full: settings may be used elsewhere.
fn absolute(mut sky: SkySpec) -> SkySpec {
    if let SkyKind::Picture(name) = &mut sky.kind
        && let Ok(path) = std::path::absolute(&*name)
    {
        *name = path.to_string_lossy().into_owned();
    }
    sky
}

/// All that decides a solution: the arguments, and where they say nothing the file of settings that
/// they name. Another scene than the file's has neither its light nor its camera.
pub fn settings(scene: Option<&str>, matches: &ArgMatches) -> anyhow::Result<Settings> {
    let filed = filed_settings(matches)?;
    let solver = solver_params_over(filed.as_ref().map(|filed| filed.solver), matches)?;
    let given = scene.map(source).transpose()?.map(|source| Settings::name_of(&source));
    let filed = filed.unwrap_or_default();
    let filed_name = filed.source().map(|source| Settings::name_of(&source));
    let same_scene = given.is_none() || given == filed_name;
    let light = added_light(matches)?;
    let light = if light.is_empty() && same_scene { filed.light } else { light };
    let reading = reading(matches);
    let reading = if reading.is_empty() && same_scene { filed.reading } else { reading };
    Ok(Settings { scene: given.or(filed_name), reading, light, camera: filed.camera.filter(|_| same_scene), solver })
}

fn emission(text: &str) -> anyhow::Result<(String, Vec3)> {
    // A name may hold an equals sign, numbers do not.
    let parts = text.rsplit_once('=').and_then(|(name, rgb)| Some((name, numbers::<3>(rgb, ',')?)));
    let Some((name, rgb)) = parts else {
        bail!("--emit must be MATERIAL=r,g,b with three numbers in W/m² (it is `{text}`)");
    };
    Ok((name.to_owned(), Vec3::from(rgb)))
}

fn ceiling_light(text: &str) -> anyhow::Result<CeilingLight> {
    let light = match (text, numbers::<1>(text, ':'), numbers::<2>(text, ':')) {
        ("", ..) => CeilingLight { size: None, exitance: USUAL_EXITANCE },
        (_, Some([size]), _) => CeilingLight { size: Some(size), exitance: USUAL_EXITANCE },
        (_, _, Some([size, exitance])) => CeilingLight { size: Some(size), exitance },
        _ => bail!("--ceiling-light must be SIZE:W_PER_M2, such as 1.5:100 (it is `{text}`)"),
    };
    Ok(light)
}

/// So many finite numbers between separators.
pub fn numbers<const N: usize>(text: &str, separator: char) -> Option<[f32; N]> {
    let numbers = coordinates::<N>(text, separator)?.map(|number| number as f32);
    numbers.iter().all(|number| number.is_finite()).then_some(numbers)
}

/// The numbers of an option, with commas between them; `must_be` tells which are good.
pub fn number_list(
    matches: &ArgMatches,
    name: &str,
    must_be: &str,
    is_good: impl Fn(f64) -> bool,
) -> anyhow::Result<Option<Vec<f64>>> {
    let Some(list) = matches.get_one::<String>(name) else { return Ok(None) };
    let good = |part: &str| part.trim().parse::<f64>().ok().filter(|number| is_good(*number));
    match list.split(',').map(good).collect() {
        Some(numbers) => Ok(Some(numbers)),
        None => bail!("--{name} must be {must_be} (it is `{list}`)"),
    }
}

/// So many finite numbers with all the digits that the coordinates of a file may need.
pub fn coordinates<const N: usize>(text: &str, separator: char) -> Option<[f64; N]> {
    let parsed: Option<Vec<f64>> =
        text.split(separator).map(|part| f64::from_str(part.trim()).ok().filter(|number| number.is_finite())).collect();
    parsed?.try_into().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn added_light_is_read() {
        assert_eq!(emission("a=b=1,2,3").expect("good"), ("a=b".to_owned(), Vec3::new(1.0, 2.0, 3.0)));
        for text in ["wall", "wall=1,2", "wall=1,2,x", "wall=1,2,NaN"] {
            assert!(emission(text).is_err(), "{text}");
        }
        assert_eq!(ceiling_light("2:50").expect("good"), CeilingLight { size: Some(2.0), exitance: 50.0 });
        assert_eq!(ceiling_light("2").expect("good"), CeilingLight { size: Some(2.0), exitance: USUAL_EXITANCE });
        assert!(ceiling_light("room.obj").is_err());
    }
}
