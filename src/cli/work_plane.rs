//! `selflink probe --work-plane`: illuminance on a level plane in the air.

use anyhow::bail;
use clap::{Arg, ArgMatches};
use selflink::base::format::{count, number, short, things};
use selflink::base::photometry::FORMULA;
use selflink::read::daylight_factor::NoDaylightFactor;
use selflink::read::survey::{LitMesh, PlaneReading, Summary, WorkPlane, measure, write_plane};
use selflink::scene::Scene;

use super::job::Order;
use super::options::{number as parse, path};
use super::output::{OutputFile, say};

/// The options of a work plane.
pub fn args() -> [Arg; 3] {
    let length = |name: &'static str, help: &'static str| {
        Arg::new(name).long(name).value_name("LENGTH").value_parser(parse).allow_hyphen_values(true).help(help)
    };
    [
        length(
            "work-plane",
            "Instead of points on surfaces: a level plane at this height above the floor, E in the air",
        ),
        length("spacing", "Distance between the points of the plane [default: as EN 12464-1 asks for the floor]")
            .requires("work-plane"),
        length("margin", "Strip along the rim of the floor that is left out [default: 0.5, less in small models]")
            .requires("work-plane"),
    ]
}

/// The plane that the arguments ask for; the scene tells what they do not say.
fn plane(matches: &ArgMatches, scene: &Scene) -> WorkPlane {
    let length = |name: &str, usual: f32| matches.get_one::<f64>(name).map_or(usual, |length| *length as f32);
    let WorkPlane { height, spacing, margin, .. } = WorkPlane::for_scene(scene);
    let (height, spacing) = (length("work-plane", height), length("spacing", spacing));
    WorkPlane { height, spacing, margin: length("margin", margin), area: None }
}

/// Measures a plane.
pub fn run(matches: &ArgMatches, order: Order) -> anyhow::Result<()> {
    let file = OutputFile::new(&path(matches, "out").unwrap_or_default(), &order.inputs())?;
    let job = order.load()?;
    let plane = plane(matches, &job.scene);
    // Before the long work, so that a plane that cannot be measured is reported soon.
    plane.grid(&job.scene)?;
    let solution = job.solve()?;
    let lit = LitMesh::new(job.scene.clone(), solution.snapshot.into());
    let error = super::probe::standard_error(matches, &job);
    let measured = job.pool.install(|| measure(&lit, plane, error))?;
    if measured.summary().points == 0 {
        bail!("every point of the work plane lies inside of something or outside of the room: choose another height");
    }
    file.write(|writer| write_plane(writer, &measured))?;
    say(&format!(
        "{}\n{}: {}\n",
        summary(&measured),
        file.path().display(),
        things(measured.values.len(), "point", "points")
    ))
}

/// Average, minimum, maximum and uniformity, on a line each.
fn summary(measured: &PlaneReading) -> String {
    let summary = measured.summary();
    let [columns, rows] = measured.grid.counts.map(count);
    let [across, along] = measured.grid.steps.map(|step| number(step.into()));
    let lux = |value: f32| number(value.into());
    [
        format!(
            "plane      {} above the floor, {columns} × {rows} cells of {across} × {along}",
            short(measured.plane.height.into())
        ),
        format!("left out   {} inside of things or outside of the room", things(summary.left_out, "point", "points")),
        format!("average    {} lx", lux(summary.average)),
        format!("minimum    {} lx", lux(summary.minimum)),
        format!("maximum    {} lx", lux(summary.maximum)),
        format!("uniformity {:.2} (minimum over average)", summary.uniformity),
    ]
    .into_iter()
    .chain(daylight(measured, &summary))
    .chain([format!("lux        {FORMULA}")])
    .collect::<Vec<_>>()
    .join("\n")
}

/// The line of the daylight factor; none where no sky shines.
fn daylight(measured: &PlaneReading, summary: &Summary) -> Option<String> {
    match (measured.open_ground, summary.daylight_factor) {
        (_, Some([mean, least])) => {
            Some(format!("daylight   factor {:.2} % on average, {:.2} % at least", 100.0 * mean, 100.0 * least))
        }
        (Err(NoDaylightFactor::NoSky), _) | (Ok(_), None) => None,
        (Err(missing), None) => Some(format!("daylight   {missing}")),
    }
}
