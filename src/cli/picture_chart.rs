//! `selflink chart --picture`: ꟻLIP and the local error of pictures over time.

use std::path::Path;
use std::sync::Arc;

use anyhow::bail;
use clap::{ArgMatches, Command};
use selflink::base::cancel::CancelToken;
use selflink::measure::chart::{
    MeshPainter, PictureChart, PictureDrawing, PictureMetric, PictureSweep, draw_png, draw_svg, picture_csv,
    picture_table,
};
use selflink::render::{Camera, Display, Frame, Offscreen, Overlay};
use selflink::scene::outside::Outside;
use selflink::solve::Snapshot;

use super::chart::{ChartFiles, limit};
use super::job::{Job, Order};
use super::options::{self, flag_arg, path, value_arg};
use super::output::{json, make_folder, say};
use super::{progress, render};

/// Pixels when nothing is said.
const SIZE: [u32; 2] = [320, 200];
/// Samples a pixel of the converged picture when nothing is said, and at most.
const SAMPLES: u32 = 1024;
const MOST_SAMPLES: u32 = 1 << 20;
/// Target errors when nothing is said.
const ERRORS: [f64; 4] = [0.1, 0.05, 0.03, 0.02];

/// Adds the arguments that charts of pictures have.
pub fn with_args(command: Command) -> Command {
    let of_points = ["epsilons", "settings", "points", "noise", "cache", "no-cache"];
    command
        .arg(
            flag_arg("picture")
                .conflicts_with_all(of_points)
                .help("Chart pictures instead: mean ꟻLIP, and the local error of E at the pixels, of the mesh, the gathered picture and a path tracer over time, against a converged picture by paths; writes SCENE-picture.csv, .json and SCENE-picture-….svg and .png"),
        )
        .arg(
            value_arg("size", "WxH")
                .requires("picture")
                .help("Pixels of the pictures [default: 320x200]"),
        )
        .arg(
            value_arg("errors", "LIST")
                .requires("picture")
                .help("Target errors of the pictures [default: 0.1,0.05,0.03,0.02]"),
        )
        .arg(
            value_arg("samples", "N")
                .requires("picture")
                .value_parser(options::whole::<u32>)
                .help("Samples a pixel of the converged picture, a power of two; the path tracer is charted up to a quarter of them [default: 1024]"),
        )
}

/// Runs it.
pub fn run(matches: &ArgMatches) -> anyhow::Result<()> {
    let orders = Order::of_scenes(matches)?;
    let limit = limit(matches)?;
    let size = matches.get_one::<String>("size").map_or(Ok(SIZE), |text| render::size(text))?;
    let errors = errors(matches)?;
    let samples = matches.get_one::<u32>("samples").copied().unwrap_or(SAMPLES);
    if !(samples.is_power_of_two() && (4..=MOST_SAMPLES).contains(&samples)) {
        bail!("--samples must be a power of two between 4 and {MOST_SAMPLES} (it is {samples})");
    }
    let folder = path(matches, "out").unwrap_or_default();
    make_folder(&folder)?;
    let mut offscreen = match Offscreen::new() {
        Ok(offscreen) => Some(offscreen),
        Err(error) => {
            eprintln!("note: pictures of the mesh are left out: {error}");
            None
        }
    };
    for order in orders {
        let job = order.load()?;
        let params = job.settings.solver;
        let sweep = PictureSweep { params, errors: errors.clone(), size, samples, limit };
        let chart = chart(&job, &sweep, offscreen.as_mut())?;
        write(&chart, &folder)?;
        say(&format!("{}\n\n{}\n", chart.scene, picture_table(&chart)))?;
        for skipped in &chart.skipped {
            eprintln!("note: {skipped}.");
        }
    }
    Ok(())
}

fn errors(matches: &ArgMatches) -> anyhow::Result<Vec<f64>> {
    let must_be = "numbers between 0 and 1 with commas between them, such as 0.1,0.05";
    let given = options::number_list(matches, "errors", must_be, |number| number > 0.0 && number < 1.0)?;
    Ok(given.unwrap_or_else(|| ERRORS.to_vec()))
}

fn chart(job: &Job, sweep: &PictureSweep, offscreen: Option<&mut Offscreen>) -> anyhow::Result<PictureChart> {
    let aspect = sweep.size[0] as f32 / sweep.size[1] as f32;
    let camera = job.settings.camera.map_or_else(
        || Camera::of_scene(&job.scene, aspect),
        |pose| Camera::from_pose(&pose.in_scene(&job.scene), aspect, job.scene.bounds()),
    );
    let bar = progress::spinner();
    let report = |next: &str| {
        bar.set_message(next.to_owned());
        bar.tick();
    };
    let mut painter = offscreen.map(|offscreen| Painter {
        offscreen,
        outside: job.scene.outside(),
        camera: &camera,
        size: sweep.size,
    });
    let mesh = painter.as_mut().map(|painter| painter as &mut (dyn MeshPainter + Send));
    let lens = camera.lens(aspect);
    Ok(job.pool.install(|| sweep.run(&job.scene, &job.occluders, &lens, mesh, &CancelToken::new(), report))?)
}

fn write(chart: &PictureChart, folder: &Path) -> anyhow::Result<()> {
    let files = ChartFiles { folder, scene: &chart.scene };
    files.text("-picture.csv", &picture_csv(chart))?;
    files.text("-picture.json", &json(chart)?)?;
    for metric in PictureMetric::ALL {
        let ending = |kind: &str| format!("-picture-{}.{kind}", metric.name());
        let drawing = PictureDrawing { chart, metric };
        files.text(&ending("svg"), &draw_svg(&drawing)?)?;
        files.picture(&ending("png"), &draw_png(&drawing)?)?;
    }
    Ok(())
}

/// Draws the mesh without a window.
struct Painter<'a> {
    offscreen: &'a mut Offscreen,
    outside: Option<&'a Arc<Outside>>,
    camera: &'a Camera,
    size: [u32; 2],
}

impl MeshPainter for Painter<'_> {
    fn shown(&mut self, snapshot: &Snapshot, exposure: f32) -> Result<Vec<[u8; 3]>, String> {
        let display = Display { exposure, ..Display::default() };
        let (outside, camera, size) = (self.outside, self.camera, self.size);
        let overlay = &Overlay::default();
        let frame = Frame { snapshot, outside, camera, display: &display, gathered: None, overlay, size };
        let drawn = self.offscreen.picture_over(&frame);
        let picture = drawn.map_err(|error| error.to_string())?;
        Ok(picture.pixels().map(|pixel| [pixel.0[0], pixel.0[1], pixel.0[2]]).collect())
    }

    fn irradiance(&mut self, snapshot: &Snapshot) -> Result<Vec<[f32; 4]>, String> {
        // Drawn as if what arrives were what leaves.
        let received = Snapshot { vertex_radiosity: snapshot.vertex_irradiance.clone(), ..snapshot.clone() };
        let drawn = self.offscreen.radiosities(&received, self.camera, self.size);
        Ok(drawn.map_err(|error| error.to_string())?.pixels)
    }
}
