//! `selflink export`: a scene as Mitsuba or Radiance read it, so that anyone can check its light.

use clap::builder::PossibleValuesParser;
use clap::{ArgMatches, Command};
use selflink::base::format::things;
use selflink::export::peers::Peer;
use selflink::solve::ParameterId;

use super::job::Order;
use super::options::{self, path, path_arg, value_arg};
use super::output::say;

/// The command's arguments.
pub fn command() -> Command {
    let of_scene = |id| matches!(id, ParameterId::Sides);
    Command::new("export")
        .about("Write a scene as other programs read it: geometry, reflectances, emission and camera")
        .arg(options::scene_arg().required(true))
        .arg(
            value_arg("to", "PROGRAM")
                .required(true)
                .value_parser(PossibleValuesParser::new(Peer::ALL.map(Peer::name)))
                .help("Mitsuba 3 (XML and PLY) or Radiance (RAD)"),
        )
        .arg(
            path_arg("folder", "DIR")
                .long(None)
                .index(2)
                .required(true)
                .help("Folder to write to; it is made where it is missing"),
        )
        .args(options::scene_args())
        .args(options::solver_args_where(of_scene))
}

/// Runs it.
pub fn run(matches: &ArgMatches) -> anyhow::Result<()> {
    let peer = matches.get_one::<String>("to").and_then(|name| Peer::from_name(name));
    let peer = peer.expect("the parser takes these names alone");
    let job = Order::from_matches(matches)?.load()?;
    let written = peer.write(&job.scene, &path(matches, "folder").unwrap_or_default())?;
    say(&format!("{}: {}\n", written.display(), things(job.scene.polygons.len(), "polygon", "polygons")))
}
