//! Pictures: sizes, overlays, the link matrix, and a machine without a display.

#[cfg(feature = "gui")]
use std::path::Path;
use std::process::Command;

use crate::support::*;

#[cfg(feature = "gui")]
#[test]
fn bad_pictures_are_refused() {
    let folder = Folder::new();
    let (picture, nowhere, jpeg) = (folder.path("out.png"), folder.path("no/out.png"), folder.path("out.jpg"));
    let picture = name(&picture);
    let cases: Vec<(Vec<&str>, &str)> = vec![
        (vec!["--out", name(&nowhere)], "cannot be written"),
        (vec!["--out", name(&jpeg)], ".png"),
        (vec!["--out", picture, "--size", "0x10"], "--size"),
        (vec!["--out", picture, "--size", "big"], "--size"),
        (vec!["--out", picture, "--size", "100000x100000"], "--size"),
        (vec!["--out", picture, "--camera", "1,2,3"], "--camera"),
        (vec!["--out", picture, "--camera", "1,2,3:1,2,3"], "--camera"),
        (vec!["--out", picture, "--camera", "door"], "it has none (it is `door`)"),
        (vec!["--out", picture, "--exposure", "bright"], "--exposure"),
        (vec!["--out", picture, "--overlay", "boxes"], "--overlay"),
        (vec!["--out", picture, "--overlay", "links:9999,1"], "outside the picture"),
    ];
    for (args, part) in cases {
        let said = refused(&[&["render", "cornell"], &args[..]].concat());
        assert!(said.contains(part), "{args:?}: `{part}` is not in: {said}");
    }
    assert!(!Path::new(picture).exists(), "no picture is left behind");
}

#[cfg(feature = "gui")]
#[test]
fn a_picture_has_the_size_asked_for_and_shows_the_overlays() {
    if let Err(error) = selflink::render::Offscreen::new() {
        return crate::left_out::left_out(&format!("pictures, {error}"));
    }
    let folder = Folder::new();
    let draw = |file: &str, args: &[&str]| {
        let path = folder.path(file);
        succeed(&[&["render", "cornell", "--size", "96x64", "--out", name(&path)], &COARSE[..], args].concat());
        image::open(path).expect("a PNG").to_rgba8()
    };
    let plain = draw("plain.png", &[]);
    assert_eq!(plain.dimensions(), (96, 64));
    let colours: std::collections::HashSet<_> = plain.pixels().collect();
    assert!(colours.len() > 50, "a lit room has many shades, not {}", colours.len());
    for (file, overlay) in [
        ("elements.png", "elements"),
        ("clusters.png", "clusters:0"),
        ("links.png", "links:48,50"),
        ("level.png", "level-links:2"),
    ] {
        assert!(draw(file, &["--overlay", overlay]) != plain, "{overlay} is not to be seen");
    }
    let deep = folder.path("deep.png");
    let (_, said) =
        succeed(&["render", "cornell", "--out", name(&deep), "--overlay", "clusters:99", "--epsilon", "1e-2"]);
    assert!(said.contains("note: there are no clusters of level 99"), "{said}");
    assert!(draw("camera.png", &["--camera", "0.1,0.2,0.7:0.3,0.3,0"]) != plain, "the camera has not moved");
    // Truth: the background, which no light reaches, is all that stays.
    let brightest = |picture: &image::RgbaImage| picture.pixels().map(|pixel| pixel.0[0]).max();
    assert!(brightest(&draw("dim.png", &["--exposure", "-20"])) < brightest(&plain), "by hand it is dark");
}

/// Truth: a picture of the mesh and one that is gathered show the same room, as bright, and are not
/// the same; a file in physical units has the layers that another reader finds by name.
#[cfg(feature = "gui")]
#[test]
fn pictures_are_gathered_unless_the_mesh_is_asked_for() {
    let folder = Folder::new();
    let draw = |file: &str, args: &[&str]| {
        let path = folder.path(file);
        let asked = ["render", "cornell", "--size", "96x64", "--error", "0.1", "--out", name(&path)];
        let (said, remarks) = succeed(&[&asked[..], args].concat());
        (path, said, remarks)
    };
    let (gathered, said, _) = draw("gathered.png", &[]);
    assert!(said.contains("gathered, noise") && !said.contains("drawn by"), "no adapter is needed: {said}");
    let (layers, ..) = draw("layers.exr", &[]);
    let file = exr::prelude::read_first_flat_layer_from_file(layers).expect("a valid file");
    let names: Vec<String> = file.layer_data.channel_data.list.iter().map(|channel| channel.name.to_string()).collect();
    for name in ["R", "G", "B", "A", "Z", "irradiance.R", "normal.X", "albedo.B", "element.id"] {
        assert!(names.iter().any(|other| other == name), "{name} is not among {names:?}");
    }
    // On the back wall above the boxes, which neither shines nor has an edge there: a unit normal
    // towards the eye, B = ρ·E, and as far away as the wall is.
    let on_wall = 16 * 96 + 52;
    let at = |name: &str| {
        let channel = file.layer_data.channel_data.list.iter().find(|channel| channel.name.to_string() == name);
        channel.expect("it is there").sample_data.value_by_flat_index(on_wall).to_f32()
    };
    let of = |layer: &str, axes: [&str; 3]| glam::Vec3::from(axes.map(|axis| at(&format!("{layer}{axis}"))));
    let colours = ["R", "G", "B"];
    let (b, e, albedo) = (of("", colours), of("irradiance.", colours), of("albedo.", colours));
    let normal = of("normal.", ["X", "Y", "Z"]);
    let scene = selflink::scene::builtin::BuiltinScene::Cornell.build();
    let camera = scene.camera.expect("ours has a view");
    let towards = (camera.eye - camera.target).normalize();
    assert!((normal.length() - 1.0).abs() < 1e-3 && normal.dot(towards) > 0.99, "{normal} {towards}");
    assert!((b - albedo * e).length() < 1e-3 * b.length() && e.min_element() > 0.0, "{b} {albedo} {e}");
    let (lower, upper) = scene.bounds();
    let far = [lower, upper].map(|corner| (camera.eye - corner).dot(normal).abs()).into_iter().fold(0.0, f32::max);
    assert!((at("Z") / far - 1.0).abs() < 0.01, "{} {far}", at("Z"));
    assert!(at("A") == 1.0 && at("element.id") < 4e9);
    let path = folder.path("threshold.png");
    let by_threshold = ["render", "cornell", "--epsilon", "1e-2", "--picture", "gathered", "--out", name(&path)];
    let refused =
        refused(&["render", "cornell", "--show", "clusters:2", "--picture", "gathered", "--out", name(&path)]);
    assert!(refused.contains("clusters show the mesh"), "{refused}");
    if let Err(error) = selflink::render::Offscreen::new() {
        return crate::left_out::left_out(&format!("pictures of the mesh, {error}"));
    }
    let (_, remarks) = succeed(&by_threshold);
    assert!(remarks.contains("warning: light can be gathered at pixels only"), "{remarks}");
    let (mesh, said, _) = draw("mesh.png", &["--picture", "mesh"]);
    assert!(said.contains("drawn by") && !said.contains("gathered"), "{said}");
    let [gathered, mesh] = [gathered, mesh].map(|path| image::open(path).expect("a PNG").to_rgb8());
    let mean = |picture: &image::RgbImage| {
        picture.as_raw().iter().map(|channel| f64::from(*channel)).sum::<f64>() / picture.as_raw().len() as f64
    };
    assert!(gathered != mesh);
    // The same exposure: nothing jumps when the one takes the other's place.
    assert!((mean(&gathered) - mean(&mesh)).abs() < 3.0, "{} {}", mean(&gathered), mean(&mesh));
    let (outlined, said, _) = draw("outlined.png", &["--overlay", "elements"]);
    assert!(said.contains("gathered") && said.contains("drawn by"), "{said}");
    assert!(image::open(outlined).expect("a PNG").to_rgb8() != gathered, "outlines lie over it");
}

/// Truth: at first there is the root's self-link alone, one colour from corner to corner; later
/// there are many, and what is no picture is refused.
#[test]
fn a_link_matrix_starts_as_one_square() {
    let folder = Folder::new();
    let colours = |file: &str, args: &[&str]| {
        let path = folder.path(file);
        succeed(&[&["matrix", "cornell", "--size", "200", "--out", name(&path)], &COARSE[..], args].concat());
        let picture = image::open(path).expect("a PNG").to_rgb8();
        // The square, which lies at the right and has the legend below.
        let (left, top) = (picture.width() - 230, picture.height() - 296);
        let square = image::imageops::crop_imm(&picture, left, top, 200, 200).to_image();
        square.pixels().copied().collect::<std::collections::HashSet<_>>().len()
    };
    for colour in ["power", "visibility", "level", "rays"] {
        assert_eq!(colours("first.png", &["--waves", "0", "--colour", colour]), 1, "{colour}");
        assert!(colours("last.png", &["--row-height", "leaves", "--colour", colour]) > 3, "{colour}");
    }
    let (picture, jpeg) = (folder.path("out.png"), folder.path("out.jpg"));
    for (args, part) in [
        (["--out", name(&jpeg), "--size", "200"], ".png"),
        (["--out", name(&picture), "--size", "9"], "--size"),
        (["--out", name(&picture), "--row-height", "kitchen"], "--row-height"),
        (["--out", name(&picture), "--waves", "-1"], "--waves"),
    ] {
        let said = refused(&[&["matrix", "cornell"], &args[..]].concat());
        assert!(said.contains(part), "{args:?}: `{part}` is not in: {said}");
    }
}

/// Without a display the main job is done all the same.
#[test]
fn without_a_display_the_scene_is_solved_into_a_picture() {
    let folder = Folder::new();
    let output = Command::new(env!("CARGO_BIN_EXE_selflink"))
        .args([&["cornell"], &COARSE[..]].concat())
        .env_remove("DISPLAY")
        .env_remove("WAYLAND_DISPLAY")
        .env_remove("WAYLAND_SOCKET")
        .current_dir(folder.path(""))
        .output()
        .expect("the program runs");
    let (stdout, stderr) = (text(&output.stdout), text(&output.stderr));
    assert_eq!(output.status.code(), Some(0), "{stderr}");
    assert!(stderr.contains("no window can be opened"), "{stderr}");
    assert!(stdout.starts_with("cornell: 20 polygons"), "{stdout}");
    let picture = folder.path("selflink-cornell.png");
    assert!(
        picture.exists() || stderr.contains("no picture was drawn") || cfg!(not(feature = "gui")),
        "{stdout}{stderr}"
    );
}
