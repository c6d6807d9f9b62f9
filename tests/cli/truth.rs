//! Probes, references and charts.

use selflink::scene::load_file;
use serde_json::Value;

use crate::support::*;

/// Truth: a scene whose exact values are known. The floor's radiosity is that of its irradiance, B
/// = ρE (grey ρ = 0.5 of faces without an MTL), at every point, since both are interpolated by the
/// same weights.
#[test]
fn probed_points_come_back_with_irradiance_and_radiosity() {
    let folder = Folder::new();
    let scene = folder.write("box.obj", SQUARE);
    let points = folder.write(
        "points.csv",
        "x,y,z,nx,ny,nz\n0.5,0.5,0,0,0,1\n0.5,0.5,0.5,0,0,1\n0.5,0.5,0,0,0,-1\n0.25,0.75,1,0,0,-3\n",
    );
    let out = folder.path("out.csv");
    let args = ["probe", name(&scene), "--emit", "roof=10,20,40", "--points", name(&points), "--out", name(&out)];
    let (_, stderr) = succeed(&[&args[..], &["--epsilon", "1e-3"]].concat());
    assert!(stderr.contains("2 rows lie on no surface"), "{stderr}");
    let written = std::fs::read_to_string(out).expect("the table was written");
    let rows: Vec<Vec<&str>> = written.lines().map(|line| line.split(',').collect()).collect();
    assert_eq!(rows[0].join(","), "x,y,z,nx,ny,nz,E_r,E_g,E_b,B_r,B_g,B_b,se_r,se_g,se_b");
    assert_eq!(rows.len(), 5);
    assert!(rows.iter().all(|row| row.len() == 15), "{written}");
    assert_eq!(rows[1][..6], ["0.5", "0.5", "0", "0", "0", "1"]);
    for row in [&rows[2], &rows[3]] {
        assert!(row[6..].iter().all(|field| field.is_empty()), "{written}");
    }
    let number = |field: &str| field.parse::<f64>().expect("a number");
    let reflectance = f64::from(load_file(&scene).expect("the scene loads").materials[0].reflectance.x);
    for colour in 0..3 {
        let (e, b) = (number(rows[1][6 + colour]), number(rows[1][9 + colour]));
        assert!(e > 0.0 && (b / (reflectance * e) - 1.0).abs() < 1e-4, "{written}");
        // The roof emits and reflects.
        let (e, b) = (number(rows[4][6 + colour]), number(rows[4][9 + colour]));
        let emission = [10.0, 20.0, 40.0][colour];
        assert!((b / (emission + reflectance * e) - 1.0).abs() < 1e-4, "{written}");
    }
}

/// Truth: what was asked for. The standard error of each row is at most the share of E + E₀ that
/// `--se` says, E₀ being a tenth of the median E and so at most a tenth of the largest; and a row
/// depends neither on the others nor on its place.
#[test]
fn probes_are_as_exact_as_is_asked_for_and_independent_of_each_other() {
    let folder = Folder::new();
    let rows: Vec<String> = (1..20).map(|index| format!("{},0.7,0,0,0,1", f64::from(index) / 20.0)).collect();
    let probed = |rows: &[String], error: &str| -> Vec<String> {
        let (points, out) = (folder.write("points.csv", rows.join("\n")), folder.path("out.csv"));
        let scene = folder.write("box.obj", SQUARE);
        let args = ["probe", name(&scene), "--emit", "roof=10,20,40", "--points", name(&points), "--out", name(&out)];
        succeed(&[&args[..], &["--error", "0.1", "--se", error]].concat());
        let written = std::fs::read_to_string(out).expect("the table was written");
        written.lines().skip(1).map(str::to_owned).collect()
    };
    for error in [0.05, 0.01] {
        let found = probed(&rows, &error.to_string());
        let backwards: Vec<String> = rows.iter().rev().step_by(2).cloned().collect();
        let again = probed(&backwards, &error.to_string());
        assert!(again.iter().eq(found.iter().rev().step_by(2)), "{found:?} {again:?}");
        let grey = |row: &str, from: usize| -> f64 {
            row.split(',').skip(from).take(3).map(|field| field.parse::<f64>().expect("a number")).sum::<f64>() / 3.0
        };
        let most = found.iter().map(|row| grey(row, 6)).fold(0.0, f64::max);
        assert!(found.iter().all(|row| grey(row, 12) <= error * (grey(row, 6) + 0.1 * most)), "{error}: {found:?}");
        assert!(found.iter().any(|row| grey(row, 12) > 0.0), "{found:?}");
    }
}

/// Truth: a second run reads what the first one kept, and says so; rows hold their errors beside
/// their values.
#[test]
fn a_reference_is_written_and_kept_for_the_next_time() {
    let folder = Folder::new();
    let (out, cache) = (folder.path("points.csv"), folder.path("cache"));
    let args =
        ["reference", "cornell", "--points", "50", "--noise", "0.1", "--out", name(&out), "--cache", name(&cache)];
    let (first, _) = succeed(&args);
    assert!(first.starts_with("cornell: 50 points, ") && !first.contains("cache"), "{first}");
    let written = std::fs::read_to_string(&out).expect("the table was written");
    let (second, _) = succeed(&args);
    assert!(second.contains("all from the cache"), "{second}");
    assert_eq!(std::fs::read_to_string(&out).expect("the table was written"), written);
    let rows: Vec<Vec<f64>> = written
        .lines()
        .skip(1)
        .map(|row| row.split(',').map(|cell| cell.parse().expect("a number")).collect())
        .collect();
    assert!(written.starts_with("x,y,z,nx,ny,nz,weight,polygon,rho_r,"), "{written}");
    assert!(rows.len() == 50 && rows.iter().all(|row| row.len() == 17), "{written}");
    assert!(rows.iter().any(|row| row[11] > 0.0 && row[14] > 0.0 && row[14] < row[11]), "{written}");
    // Points by A·B² count less, those by area more; together they stand for as many as there are.
    let weights: Vec<f64> = rows.iter().map(|row| row[6]).collect();
    let mean = weights.iter().sum::<f64>() / 50.0;
    assert!((mean - 1.0).abs() < 0.15 && weights.iter().any(|weight| (weight / mean - 1.0).abs() > 0.1), "{weights:?}");
    let (finer, _) = succeed(&[&args[..4], &["--noise", "0.01"], &args[6..]].concat());
    assert!(finer.contains(" % from the cache"), "{finer}");
}

#[test]
fn a_reference_that_runs_out_of_time_says_so() {
    let (stdout, stderr) = succeed(&["reference", "cornell", "--noise", "1e-6", "--seconds", "0.2", "--no-cache"]);
    assert!(stderr.contains("the time was over") && stdout.contains("1,000 points"), "{stdout}{stderr}");
}

/// Truth: a row for each run with every parameter; pictures of the size asked for that show
/// something.
#[test]
fn a_chart_is_tables_and_pictures() {
    let folder = Folder::new();
    let (out, cache) = (folder.path("made/charts"), folder.path("cache"));
    let (table, _) = succeed(&[
        "chart",
        "cornell",
        "--out",
        name(&out),
        "--epsilons",
        "1e-3,1e-2",
        "--settings",
        "adaptive,none",
        "--points",
        "400",
        "--noise",
        "0.05",
        "--seconds",
        "2",
        "--cache",
        name(&cache),
        "--rays-min",
        "3",
    ]);
    assert!(table.contains("| adaptive, immediate |") && table.contains("| none |"), "{table}");
    let read = |file: &str| std::fs::read_to_string(out.join(file)).expect("it was written");
    let csv = read("cornell.csv");
    let solved: Vec<&str> = csv.lines().filter(|row| !row.contains("path tracer")).collect();
    assert_eq!(solved.len(), 1 + 3 * 2, "{csv}");
    let columns = |row: &str| row.replace(", ", "; ").split(',').count();
    assert!(csv.lines().all(|row| columns(row) == columns(solved[0])), "{csv}");
    assert!(csv.contains("path tracer"), "{csv}");
    let chart: Value = serde_json::from_str(&read("cornell.json")).expect("JSON");
    let runs = chart["runs"].as_array().expect("runs");
    assert!(runs.iter().all(|run| run["params"]["rays_min"] == 3 && run["converged"] == true), "{chart}");
    let error = |index: usize| runs[index]["error"]["displayed"]["rms"].as_f64().expect("an error");
    assert!(error(1) < error(0), "a finer threshold is more accurate: {chart}");
    assert!(runs.iter().any(|run| run["pareto"] == true), "{chart}");
    for name in ["seconds", "links", "rays", "rms"] {
        let picture = image::open(out.join(format!("cornell-{name}.png"))).expect("a PNG").to_rgb8();
        let colours: std::collections::HashSet<_> = picture.pixels().collect();
        assert!(picture.dimensions() == (1200, 800) && colours.len() > 50, "{name}: {} colours", colours.len());
        let drawn = read(&format!("cornell-{name}.svg"));
        assert!(drawn.contains("Pareto front") && drawn.contains("±1 standard error"));
    }
    assert!(read("cornell-seconds.svg").contains("|ΔE|/(E + E0)") && read("cornell-rms.svg").contains("RMS of ΔB"));
    assert!(table.contains("|ΔE|/(E + E0)") && table.contains("RMS of B"), "{table}");
    assert!(table.contains(" ± "), "{table}");
    for (file, error, noise) in [
        ("cornell-seconds.svg", "/local/p90", "/local/p90_noise"),
        ("cornell-rms.svg", "/displayed/rms", "/displayed/rms_noise"),
    ] {
        let of = |name: &str, run: &Value| run["error"].pointer(name).and_then(Value::as_f64).expect("a number");
        let errors: Vec<_> = runs.iter().map(|run| (of(error, run), of(noise, run))).collect();
        assert!(errors.iter().all(|(error, noise)| *noise > 0.0 && noise < error), "{errors:?}");
        bars_are_standard_errors(&read(file), &errors);
    }
}

/// Truth: the noise of paths falls with the root of their number; a picture gathered over a solve
/// to 10 % is far nearer to the converged one than one path a pixel is. All is the same for any
/// number of threads, so nothing here is by chance.
#[cfg(feature = "gui")]
#[test]
fn a_chart_of_pictures_tells_how_near_they_are() {
    let folder = Folder::new();
    let out = folder.path("charts");
    let chart = ["chart", "cornell", "--picture", "--size", "40x30", "--errors", "0.1", "--samples", "128"];
    let (table, _) = succeed(&[&chart[..], &["--out", name(&out)]].concat());
    assert!(table.contains("| gathered, 10.0 % |") && table.contains("| path tracer, 32 samples |"), "{table}");
    let read = |file: &str| std::fs::read_to_string(out.join(file)).expect("it was written");
    let csv = read("cornell-picture.csv");
    let columns = |row: &str| row.split(',').count();
    assert!(csv.lines().all(|row| columns(row) == 18) && csv.contains("reference_flip_of_halves"), "{csv}");
    let chart: Value = serde_json::from_str(&read("cornell-picture.json")).expect("JSON");
    let pictures = chart["pictures"].as_array().expect("pictures");
    let find = |kind: &str, samples: Value| {
        let found = pictures.iter().find(|picture| picture["kind"] == kind && picture["samples"] == samples);
        let of = |picture: &Value, name: &str| picture.pointer(name).and_then(Value::as_f64).expect("a number");
        found.map(|picture| ["/flip", "/local/p90", "/seconds"].map(|name| of(picture, name)))
    };
    let gathered = find("gathered", Value::Null).expect("it was made");
    let [few, many] = [1, 32].map(|samples: u32| find("paths", samples.into()).expect("they were traced"));
    assert!((0..2).all(|k| few[k] > 2.0 * many[k]) && many[2] > 0.0 && few[2] > 0.0, "{few:?} {many:?}");
    assert!((0..2).all(|k| gathered[k] < 0.5 * few[k]), "{gathered:?} {few:?}");
    match find("mesh", Value::Null) {
        // The same light, coarser.
        Some(mesh) => assert!(mesh[0] < few[0] && mesh[1] < few[1], "{mesh:?} {few:?}"),
        None => crate::left_out::left_out("the mesh; no graphics adapter draws it"),
    }
    for file in ["flip", "local"] {
        let picture = image::open(out.join(format!("cornell-picture-{file}.png"))).expect("a PNG");
        assert_eq!((picture.width(), picture.height()), (1200, 800));
        assert!(read(&format!("cornell-picture-{file}.svg")).contains("path tracer, by samples a pixel"));
    }
}

/// Truth: on a logarithmic axis a bar from e − s to e + s is as long as the logarithm of their
/// ratio, and the tops of two bars are as far apart as that of theirs, in the same number of pixels
/// each; two pixels are rounding. Bars are the vertical lines of one pixel in a curve's colour.
fn bars_are_standard_errors(svg: &str, errors: &[(f64, f64)]) {
    let is_bar = |line: &&str| {
        ["#0072B2", "#009E73"].iter().any(|colour| line.contains(&format!("stroke=\"{colour}\" stroke-width=\"1\"")))
    };
    let ends = |line: &str| {
        let points = line.split("points=\"").nth(1)?.split('"').next()?;
        let numbers: Vec<f64> = points.split([',', ' ']).filter_map(|number| number.parse().ok()).collect();
        (numbers.len() == 4 && numbers[0] == numbers[2]).then(|| (numbers[1], numbers[3]))
    };
    let bars: Vec<(f64, f64)> = svg.lines().filter(is_bar).filter_map(ends).collect();
    assert_eq!(bars.len(), errors.len(), "a bar for each run: {bars:?}");
    // From the coarse run to the fine one.
    let pixels = (bars[1].1 - bars[0].1) / ((errors[0].0 + errors[0].1) / (errors[1].0 + errors[1].1)).ln();
    for ((low, high), (error, noise)) in bars.iter().zip(errors) {
        let length = pixels * ((error + noise) / (error - noise)).ln();
        assert!((low - high - length).abs() <= 2.0, "{length} pixels: {bars:?} for {errors:?}");
    }
}
