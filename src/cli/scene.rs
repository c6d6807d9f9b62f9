//! `selflink scene`: writes one of our own scenes as OBJ, MTL and sidecar.

use anyhow::bail;
use clap::{Arg, ArgMatches, Command};
use selflink::base::format::things;
use selflink::scene::{builtin::BuiltinScene, write_obj};

use super::options::{self, path, path_arg, value_arg};
use super::output::say;

/// The command's arguments.
pub fn command() -> Command {
    Command::new("scene")
        .about("Write a sample scene as OBJ, MTL and settings file")
        .arg(Arg::new("name").value_name("NAME").required(true).help(format!("One of {}", options::names())))
        .arg(
            value_arg("polygons", "N")
                .value_parser(options::whole::<usize>)
                .help("Draw the seminar room with so many polygons, or the tower with about so many"),
        )
        .arg(path_arg("out", "DIR").required(true).help("Folder to write to; it is made where it is missing"))
}

/// Runs it.
pub fn run(matches: &ArgMatches) -> anyhow::Result<()> {
    let name = matches.get_one::<String>("name").map_or("", String::as_str);
    let Some(mut builtin) = BuiltinScene::from_name(name) else {
        bail!("`{name}` is none of the sample scenes ({})", options::names());
    };
    if let Some(&wanted) = matches.get_one::<usize>("polygons") {
        let (range, polygons) = match &mut builtin {
            BuiltinScene::Seminar { polygons } => (BuiltinScene::SEMINAR_RANGE, polygons),
            BuiltinScene::Tower { polygons } => (BuiltinScene::TOWER_RANGE, polygons),
            BuiltinScene::Cornell | BuiltinScene::Office => {
                bail!("--polygons is for the seminar room and the tower, not for {name}")
            }
        };
        if !range.contains(&wanted) {
            bail!("--polygons must lie between {} and {} (it is {wanted})", range.start(), range.end());
        }
        *polygons = wanted;
    }
    let scene = builtin.build();
    let written = write_obj(&scene, &path(matches, "out").unwrap_or_default())?;
    say(&format!("{}: {}\n", written.display(), things(scene.polygons.len(), "polygon", "polygons")))
}
