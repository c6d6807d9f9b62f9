//! Readings on the command line: a work plane as CSV, false colours and their legend in a picture.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use glam::DVec3;
use selflink::measure::accuracy::closed_forms::point_to_polygon;
#[cfg(feature = "gui")]
use selflink::render::VIRIDIS;

/// A floor of 4 × 4 below a roof at a height of 3, with nothing between.
const HALL: &str = "o floor
usemtl floor
v -2 0 -2
v -2 0 2
v 2 0 2
v 2 0 -2
f 1 2 3 4
o roof
usemtl roof
v -2 3 -2
v 2 3 -2
v 2 3 2
v -2 3 2
f 5 6 7 8
";
const MATERIALS: &str = "newmtl floor\nKd 0 0 0\nnewmtl roof\nKd 0 0 0\n";

fn selflink(args: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_selflink")).args(args).output().expect("the program runs")
}

fn hall(folder: &Path) -> PathBuf {
    let path = folder.join("hall.obj");
    std::fs::write(&path, format!("mtllib hall.mtl\n{HALL}")).expect("a writable folder");
    std::fs::write(folder.join("hall.mtl"), MATERIALS).expect("a writable folder");
    path
}

/// Truth: Lambert's formula; nothing is reflected, so E is what the roof sends, and a gather knows
/// it without noise.
#[test]
fn a_work_plane_is_written_and_summed_up() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let (scene, out) = (hall(folder.path()), folder.path().join("grid.csv"));
    let [scene, out] = [&scene, &out].map(|path| path.to_str().expect("a plain name"));
    let plane = ["--work-plane", "0.8", "--spacing", "1", "--margin", "0.5"];
    for (is_gathered, asked) in [(false, ["--epsilon", "1e-2"]), (true, ["--error", "0.05"])] {
        let light = ["--emit", "roof=100,100,100"];
        let output = selflink(&[&["probe", scene, "--out", out], &plane[..], &light[..], &asked[..]].concat());
        let said = String::from_utf8_lossy(&output.stdout);
        assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
        let text = std::fs::read_to_string(out).expect("written");
        let rows: Vec<&str> = text.lines().collect();
        assert_eq!((rows[0], rows.len()), ("x,y,z,E_r,E_g,E_b,E_lx,se_r,se_g,se_b", 10));
        let corner = |x: f64, z: f64| DVec3::new(x, 3.0, z);
        let roof = [corner(-2.0, -2.0), corner(2.0, -2.0), corner(2.0, 2.0), corner(-2.0, 2.0)];
        let mut lux = Vec::new();
        for row in &rows[1..] {
            let fields: Vec<Option<f64>> = row.split(',').map(|field| field.parse().ok()).collect();
            let [Some(x), Some(y), Some(z), _, Some(green), _, Some(lx), _, error, _] = fields[..] else {
                panic!("{row}");
            };
            let truth = 100.0 * point_to_polygon(DVec3::new(x, y, z), DVec3::Y, &roof);
            assert!((green / truth - 1.0).abs() < 1e-3 && (lx / truth / 179.0 - 1.0).abs() < 1e-3, "{row}: {truth}");
            assert_eq!(error.map(|error| error < 1e-3 * truth), is_gathered.then_some(true), "{row}");
            lux.push(lx);
        }
        let mean = lux.iter().sum::<f64>() / 9.0;
        let least = lux.iter().copied().fold(f64::INFINITY, f64::min);
        assert!(said.contains(&format!("uniformity {:.2}", least / mean)), "{said}");
        assert!(said.contains("3 × 3 cells of 1.00 × 1.00") && said.contains("179 lm/W"), "{said}");
    }
}

#[test]
fn planes_and_readings_that_cannot_be_had_are_refused_in_a_sentence() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let (scene, out) = (hall(folder.path()), folder.path().join("grid.csv"));
    let [scene, out] = [&scene, &out].map(|path| path.to_str().expect("a plain name"));
    let cases: [(&[&str], &str); 7] = [
        (&["probe", scene, "--out", out], "--points"),
        (&["probe", scene, "--out", out, "--spacing", "1"], "--work-plane"),
        (&["probe", scene, "--out", out, "--work-plane", "1", "--spacing", "0"], "spacing above 0"),
        (&["probe", scene, "--out", out, "--work-plane", "1", "--margin", "2"], "choose a smaller one"),
        (&["probe", scene, "--out", out, "--work-plane", "1", "--spacing", "1e-3"], "choose a larger one"),
        (&["probe", scene, "--out", out, "--work-plane", "50", "--epsilon", "1e-2"], "choose another height"),
        (&["probe", scene, "--out", out, "--work-plane", "1", "--points", out], "cannot be used with"),
    ];
    for (args, part) in cases {
        let output = selflink(args);
        let said = String::from_utf8_lossy(&output.stderr);
        let is_refused = output.status.code() == Some(2) && said.contains(part) && !said.contains("panicked");
        assert!(is_refused && !Path::new(out).exists(), "{args:?}: {said}");
    }
}

/// Truth: the ramp's own colours at the ends of the legend's bar, and none of it where it is not
/// wanted.
#[test]
#[cfg(feature = "gui")]
fn a_legend_is_drawn_into_the_picture() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let out = folder.path().join("false.png");
    let path = out.to_str().expect("a plain name");
    let picture = |more: &[&str]| {
        let args = ["render", "cornell", "--epsilon", "1e-2", "--show", "irradiance", "--isolux=60,120", "--out", path];
        let output = selflink(&[&args[..], more].concat());
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        match output.status.code() {
            Some(0) => Some(image::open(&out).expect("a picture").to_rgb8()),
            _ if said.contains("no graphics adapter") => None,
            code => panic!("{code:?}: {said}"),
        }
    };
    let Some(with_legend) = picture(&[]) else {
        return crate::left_out::left_out("a legend; no graphics adapter draws it (install mesa-vulkan-drivers)");
    };
    // A card of 380 × 88 pixels, 12 from the corner, with a bar of 340 × 14 in it.
    let is = |picture: &image::RgbImage, x: u32, colour: [u8; 3]| {
        let pixel = picture.get_pixel(x, 735).0;
        pixel.iter().zip(colour).all(|(is, should)| is.abs_diff(should) <= 4)
    };
    assert!(
        is(&with_legend, 33, VIRIDIS[0]) && is(&with_legend, 370, VIRIDIS[9]) && is(&with_legend, 20, [29, 31, 35])
    );
    let bare = picture(&["--no-legend"]).expect("there was an adapter before");
    assert!(!is(&bare, 370, VIRIDIS[9]) && !is(&bare, 20, [29, 31, 35]));
}

/// Truth: under a uniform sky a point of the black floor gets all of what open ground gets but the
/// roof's form factor, however bright the sky is. 2 % of the range: four times the noise of the
/// mean of 81 pixels, of 1.7 % each, and a step of the ramp.
#[test]
#[cfg(feature = "gui")]
fn daylight_factors_are_shown_in_false_colours() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let (scene, out) = (hall(folder.path()), folder.path().join("factor.png"));
    let [scene, path] = [&scene, &out].map(|path| path.to_str().expect("a plain name"));
    let view = ["--camera", "0,1.8,3.9:0,0,0", "--size", "200x150", "--show", "daylight-factor", "--range", "0:100"];
    let args =
        [&["render", scene, "--no-legend", "--sky", "uniform:7000lx", "--error", "0.05", "--out", path], &view[..]];
    let output = selflink(&args.concat());
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    let picture = image::open(&out).expect("a picture").to_rgb8();
    let mut mean = [0.0; 3];
    for place in 0..81 {
        let pixel = picture.get_pixel(96 + place % 9, 71 + place / 9).0;
        mean.iter_mut().zip(pixel).for_each(|(sum, channel)| *sum += f64::from(channel) / 81.0);
    }
    let unlike = |step: &u32| {
        let colour = selflink::render::Ramp::Viridis.at(*step as f32 / 1000.0);
        let difference = |(mean, colour): (f64, u8)| (mean - f64::from(colour)).powi(2);
        mean.into_iter().zip(colour).map(difference).sum::<f64>()
    };
    let found = (0..=1000).min_by(|a, b| unlike(a).total_cmp(&unlike(b))).expect("many steps");
    let corner = |x: f64, z: f64| DVec3::new(x, 3.0, z);
    let roof = [corner(-2.0, -2.0), corner(2.0, -2.0), corner(2.0, 2.0), corner(-2.0, 2.0)];
    let truth = 1.0 - point_to_polygon(DVec3::ZERO, DVec3::Y, &roof);
    assert!((f64::from(found) / 1000.0 - truth).abs() < 0.02, "{found} {truth}");
}

/// A daylight factor is by the sky alone: beside a sun, beside lamps and without a sky there is
/// none, and both ways of reading it say why.
#[test]
fn where_more_than_the_sky_shines_there_is_no_daylight_factor() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let (scene, out) = (hall(folder.path()), folder.path().join("grid.csv"));
    std::fs::write(folder.path().join("hall.mtl"), format!("{MATERIALS}Ke 1 1 1\n")).expect("a writable folder");
    let [scene, out] = [&scene, &out].map(|path| path.to_str().expect("a plain name"));
    let lights: [(&[&str], &str); 3] = [
        (&["--sky", "clear", "--sun", "az:180,el:40", "--lamps-off"], "the sun shines too"),
        (&["--sky", "overcast"], "lamps shine too"),
        (&["--sky", "overcast", "--lamps-off"], "on average"),
    ];
    for (light, part) in lights {
        let plane = ["probe", scene, "--out", out, "--work-plane", "0.8", "--spacing", "2", "--epsilon", "1e-2"];
        let output = selflink(&[&plane, light].concat());
        let said = String::from_utf8_lossy(&output.stdout);
        assert!(said.lines().any(|line| line.starts_with("daylight   ") && line.contains(part)), "{light:?}: {said}");
    }
    #[cfg(feature = "gui")]
    for (light, part) in [lights[0], lights[1], (&[], "none shines")] {
        let picture = ["render", scene, "--out", "none.png", "--show", "daylight-factor", "--epsilon", "1e-2"];
        let output = selflink(&[&picture, light].concat());
        let said = String::from_utf8_lossy(&output.stderr);
        let is_refused = output.status.code() == Some(2) && said.contains(part);
        assert!(is_refused && !Path::new("none.png").exists(), "{light:?}: {said}");
    }
}
